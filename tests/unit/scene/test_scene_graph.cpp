// SPDX-License-Identifier: Apache-2.0
#include "c3de/scene/scene_graph.h"
#include "support/catch.h"

using namespace c3de;
using scene::SceneGraph;

namespace {

Mat4 translation(const Vec3 &by) {
  Mat4 m = kIdentity4;
  m[12] = by[0];
  m[13] = by[1];
  m[14] = by[2];
  return m;
}

Mat4 scaling(double factor) {
  Mat4 m = kIdentity4;
  m[0] = m[5] = m[10] = factor;
  return m;
}

}  // namespace

TEST_CASE("A node below a node that is gone is refused") {
  SceneGraph graph;
  const Handle parent = graph.add({}, "parent");
  REQUIRE(graph.remove(parent));
  CHECK(graph.add(parent, "child").isNull());
  CHECK_FALSE(graph.remove(parent));
}

TEST_CASE("Removing a node takes everything below it and nothing beside it") {
  SceneGraph graph;
  const Handle a = graph.add({}, "a");
  const Handle b = graph.add({}, "b");
  const Handle child = graph.add(a, "child");
  const Handle grandchild = graph.add(child, "grandchild");
  REQUIRE(graph.remove(a));
  CHECK(std::as_const(graph).find(child) == nullptr);
  CHECK(std::as_const(graph).find(grandchild) == nullptr);
  CHECK(std::as_const(graph).find(b) != nullptr);
  CHECK(graph.rows().size() == 1);
}

TEST_CASE("A handle of a removed node stays stale when its place is used again") {
  SceneGraph graph;
  const Handle old = graph.add({}, "old");
  graph.remove(old);
  const Handle next = graph.add({}, "next");
  CHECK(next.index == old.index);
  CHECK(std::as_const(graph).find(old) == nullptr);
}

TEST_CASE("Rows come depth first, children in the order they were added") {
  SceneGraph graph;
  const Handle a = graph.add({}, "a");
  const Handle b = graph.add({}, "b");
  const Handle a1 = graph.add(a, "a1");
  const Handle a2 = graph.add(a, "a2");
  const Handle deep = graph.add(a1, "deep");
  const auto rows = graph.rows();
  REQUIRE(rows.size() == 5);
  const Handle order[] = {a, a1, deep, a2, b};
  const int depths[] = {0, 1, 2, 1, 0};
  for (std::size_t i = 0; i < 5; ++i) {
    CHECK(rows[i].node == order[i]);
    CHECK(rows[i].depth == depths[i]);
  }
}

TEST_CASE("The world transform applies the node first and its parents after it") {
  SceneGraph graph;
  const Handle parent = graph.add({}, "simulation");
  const Handle child = graph.add(parent, "body");
  graph.find(parent)->parentFromNode = scaling(1000.0);
  graph.find(child)->parentFromNode = translation({0.1, 0.0, 0.0});
  const Vec3 world = transformPoint(graph.worldFromNode(child), {0.0, 0.2, 0.0});
  CHECK_THAT(world[0], WithinAbs(100.0, 1e-9));
  CHECK_THAT(world[1], WithinAbs(200.0, 1e-9));
}

TEST_CASE("A node below a hidden one is not visible, and nor is a stale one") {
  SceneGraph graph;
  const Handle parent = graph.add({}, "parent");
  const Handle child = graph.add(parent, "child");
  CHECK(graph.isVisible(child));
  graph.find(parent)->visible = false;
  CHECK_FALSE(graph.isVisible(child));
  graph.remove(child);
  CHECK_FALSE(graph.isVisible(child));
}

TEST_CASE("World bounds enclose the visible nodes that have bounds") {
  SceneGraph graph;
  CHECK_FALSE(graph.bounds().has_value());
  const Handle a = graph.add({}, "a");
  graph.find(a)->parentFromNode = scaling(-2.0);
  graph.find(a)->hasBounds = true;
  graph.find(a)->boundsMin = {1.0, 0.0, 0.0};
  graph.find(a)->boundsMax = {2.0, 1.0, 3.0};
  const Handle hidden = graph.add({}, "hidden");
  graph.find(hidden)->hasBounds = true;
  graph.find(hidden)->boundsMax = {1e6, 1e6, 1e6};
  graph.find(hidden)->visible = false;
  const auto bounds = graph.bounds();
  REQUIRE(bounds.has_value());
  // Mirrored by the negative scale, so the corners are swapped.
  CHECK(bounds->min == Vec3{-4.0, -2.0, -6.0});
  CHECK(bounds->max == Vec3{-2.0, 0.0, 0.0});
}

TEST_CASE("The generation grows when nodes come and go") {
  SceneGraph graph;
  const auto empty = graph.generation();
  const Handle a = graph.add({}, "a");
  const auto added = graph.generation();
  CHECK(added > empty);
  graph.remove(a);
  CHECK(graph.generation() > added);
}
