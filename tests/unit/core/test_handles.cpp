// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "c3de/core/handle.h"
#include "support/catch.h"

using namespace c3de;

TEST_CASE("a handle to a removed object is stale, also when its slot is used again") {
  HandleTable<int> table;
  const Handle a = table.add(1);
  CHECK(table.remove(a));
  const Handle b = table.add(2);
  CHECK(b.index == a.index);
  CHECK(table.find(a) == nullptr);
  CHECK(*table.find(b) == 2);
  CHECK_FALSE(table.remove(a));
  CHECK(table.size() == 1);
}

TEST_CASE("the null handle finds nothing and bits travel both ways") {
  HandleTable<int> table;
  CHECK(table.find(Handle{}) == nullptr);
  const Handle a = table.add(1);
  CHECK(Handle::fromBits(a.bits()) == a);
  CHECK(table.find(Handle::fromBits(0xffffffffffffffffull)) == nullptr);
}

TEST_CASE("handles of two kinds are never equal, however often their slots are used again") {
  HandleTable<int, HandleKind::mesh> meshes;
  HandleTable<int, HandleKind::tree> trees;
  for (int round = 0; round < 1000; ++round) {
    const Handle mesh = meshes.add(round), tree = trees.add(round);
    CHECK(mesh.kind() == HandleKind::mesh);
    CHECK(tree.kind() == HandleKind::tree);
    CHECK(mesh != tree);
    CHECK(trees.find(mesh) == nullptr);
    CHECK(meshes.find(tree) == nullptr);
    CHECK(Handle::fromBits(mesh.bits()).kind() == HandleKind::mesh);
    meshes.remove(mesh);
    trees.remove(tree);
  }
  CHECK(std::string(nameOf(HandleKind::labelMap)) == "label map");
}
