// SPDX-License-Identifier: Apache-2.0
#include "c3de/scene/mesh_store.h"
#include "c3de/scene/simulation_directory.h"
#include "support/catch.h"

#include <thread>

using namespace c3de;

namespace {

/// A tetrahedron with edges of about 10 mm.
geometry::LoadedMesh tetrahedron() {
  geometry::LoadedMesh loaded;
  loaded.mesh.vertices = {{0, 0, 0}, {10, 0, 0}, {0, 10, 0}, {0, 0, 10}};
  loaded.mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  return loaded;
}

}  // namespace

TEST_CASE("A stored mesh is found until it is removed, and lives on while somebody holds it") {
  scene::MeshStore store;
  const Handle handle = store.add(tetrahedron());
  const auto held = store.find(handle);
  REQUIRE(held != nullptr);
  CHECK(store.remove(handle));
  CHECK_FALSE(store.remove(handle));
  CHECK(store.find(handle) == nullptr);
  CHECK(held->loaded.mesh.vertices.size() == 4);
}

TEST_CASE("The winding numbers of a stored mesh can be asked for from several threads at once") {
  scene::MeshStore store;
  const auto mesh = store.find(store.add(tetrahedron()));
  double inside[4] = {};
  std::vector<std::thread> threads;
  for (double &out : inside) threads.emplace_back([&] { out = mesh->windingNumber().at({1, 1, 1}); });
  for (std::thread &thread : threads) thread.join();
  for (const double value : inside) CHECK_THAT(value, WithinAbs(1.0, 1e-6));
  CHECK_THAT(mesh->windingNumber().at({20, 20, 20}), WithinAbs(0.0, 1e-2));
}

TEST_CASE("The directory finds a simulation by its node and forgets it") {
  scene::SimulationDirectory directory;
  const std::shared_ptr<scene::Simulation> simulation(reinterpret_cast<scene::Simulation *>(0x10),
                                                      [](scene::Simulation *) {});  // only stored, never dereferenced
  const Handle node{3, 7};
  CHECK(directory.find(node) == nullptr);
  directory.add(node, "test", simulation);
  CHECK(directory.find(node) == simulation);
  CHECK(directory.find({3, 8}) == nullptr);
  directory.remove(node);
  CHECK(directory.find(node) == nullptr);
}
