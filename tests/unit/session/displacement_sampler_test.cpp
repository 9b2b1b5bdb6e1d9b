// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/displacement_sampler.h"

#include <algorithm>
#include <thread>

#include "c3de/imaging/masks.h"
#include "c3de/session/body_displacement.h"
#include "support/catch.h"
#include "support/recording_simulator.h"

using namespace c3de;
using namespace c3de::session;
using c3de::test::cubeBody;
using c3de::test::RecordingSimulator;

namespace {

/// 40 voxels of 1 mm along each axis, centres from -9.5 mm: none on the face of a cube of whole millimetres.
imaging::VolumeGeometry imageGrid() {
  return {{40, 40, 40}, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -9.5, -9.5, -9.5, 1}};
}

std::size_t fixedVoxels(const imaging::DisplacementGrid &grid) {
  return static_cast<std::size_t>(
      std::count(grid.bodies->voxels.begin(), grid.bodies->voxels.end(), imaging::kFixedVoxel));
}

/// A cube of 20 mm that has moved by 2 mm along x, and a paused simulation.
struct Fixture {
  RecordingSimulator simulator;
  std::unique_ptr<scene::Simulation> simulation;
  DisplacementSampler sampler;

  Fixture() {
    simulator.bodies = {cubeBody(0.02, {0, 0, 0}, {0.002, 0, 0})};
    simulator.displacement_m = {0.002, 0, 0};
    simulator.gap_m = 0.003;
    simulation = std::move(*scene::Simulation::create(simulator.object()));
    simulation->call([] {});  // it is paused: tests may change the simulator's results
  }
};

}  // namespace

TEST_CASE("Bodies as they are now: the box around them and the finest spacing, in mm") {
  RecordingSimulator simulator;
  simulator.bodies = {cubeBody(0.02, {0, 0, 0}, {0.1, 0, 0}), cubeBody(0.01, {0, 0.05, 0}, {0, 0, 0})};
  simulator.bodies[0].spacing_m = 0.004;
  simulator.bodies[1].spacing_m = 0.002;
  const PresentBodies bodies = presentBodies(simulator.table(), simulator.object());
  CHECK_THAT(bodies.spacing_mm, WithinAbs(2.0, 1e-12));
  CHECK(norm(bodies.box.low) < 1e-9);
  CHECK(norm(bodies.box.high - Vec3{120, 60, 20}) < 1e-9);
}

TEST_CASE("Bodies in the reference are where they were, all of them on the grid of the image") {
  RecordingSimulator simulator;
  simulator.bodies = {cubeBody(0.02, {0, 0, 0}, {0.5, 0, 0}), cubeBody(0.006, {0, 0, -0.008}, {0, 0, 0.1})};
  auto mask = referenceBodies(simulator.object(), imageGrid());
  REQUIRE(mask);
  CHECK(imaging::voxelCount(*mask) == 20 * 20 * 20 + 6 * 6 * 6);
  CHECK(mask->voxels[10 + 40 * (10 + 40 * 10)] == imaging::kBodyVoxel);
  CHECK(mask->voxels[9 + 40 * (10 + 40 * 10)] == 0);
  CHECK_FALSE(referenceBodies(simulator.object(), {{0, 0, 0}, kIdentity4}));
  // A body without triangles has no inside.
  simulator.bodies[0].triangles.clear();
  mask = referenceBodies(simulator.object(), imageGrid());
  REQUIRE(mask);
  CHECK(imaging::voxelCount(*mask) == 6 * 6 * 6);
  simulator.bodies[1].triangles.clear();
  CHECK_FALSE(referenceBodies(simulator.object(), imageGrid()));
}

TEST_CASE("A displacement is asked for in metres and told in mm") {
  RecordingSimulator simulator;
  simulator.displacement_m = {0.001, -0.002, 0.003};
  simulator.gap_m = 0.004;
  imaging::DisplacementGrid grid;
  grid.geometry = {{2, 3, 4}, {5, 0, 0, 0, 0, 5, 0, 0, 0, 0, 5, 0, 100, 0, 0, 1}};
  REQUIRE(readDisplacement(simulator.table(), simulator.object(), 10.0, grid));
  REQUIRE(simulator.grids.size() == 1);
  CHECK(simulator.grids[0].points[2] == 4);
  CHECK_THAT(simulator.grids[0].step_i_m[0], WithinAbs(0.005, 1e-15));
  CHECK_THAT(simulator.grids[0].origin_m[0], WithinAbs(0.1, 1e-15));
  CHECK_THAT(simulator.rims_m[0], WithinAbs(0.01, 1e-15));
  REQUIRE(grid.xyz_mm.size() == 72);
  CHECK_THAT(grid.xyz_mm[71], WithinAbs(3.0f, 1e-5));
  CHECK_THAT(grid.xyz_mm[1], WithinAbs(-2.0f, 1e-5));
  REQUIRE(grid.gap_mm.size() == 24);
  CHECK_THAT(grid.gap_mm[23], WithinAbs(4.0f, 1e-5));

  simulator.fail("displacement", C3DE_E_UNSUPPORTED);
  CHECK_FALSE(readDisplacement(simulator.table(), simulator.object(), 10.0, grid));
  simulator.failNowhere();
  grid.geometry.size = {0, 0, 0};
  CHECK_FALSE(readDisplacement(simulator.table(), simulator.object(), 10.0, grid));
  RecordingSimulator without;
  without.hasDisplacement = false;
  grid.geometry.size = {2, 3, 4};
  CHECK_FALSE(readDisplacement(without.table(), without.object(), 10.0, grid));
  CHECK(simulator.grids.size() == 1);
}

TEST_CASE("The simulator is asked while somebody wants it, and each displacement is taken once") {
  Fixture f;
  f.sampler.onPublished(*f.simulation);
  CHECK(f.simulator.rims_m.empty());
  CHECK_FALSE(f.sampler.take());
  f.sampler.want(true, 5.0, imageGrid());
  CHECK(f.sampler.wanted());
  f.sampler.onPublished(*f.simulation);
  REQUIRE(f.simulator.rims_m.size() == 1);
  CHECK_THAT(f.simulator.rims_m[0], WithinAbs(0.005, 1e-15));
  CHECK(f.sampler.milliseconds() > 0.0);
  const auto grid = f.sampler.take();
  REQUIRE(grid);
  CHECK_THAT(grid->xyz_mm.front(), WithinAbs(2.0f, 1e-5));
  CHECK_THAT(grid->gap_mm.front(), WithinAbs(3.0f, 1e-5));
  CHECK_FALSE(grid->hasFixedRegions);
  REQUIRE(grid->bodies);
  CHECK(imaging::voxelCount(*grid->bodies) == 20 * 20 * 20);
  // It contains the body with its rim.
  CHECK(imaging::boxOf(grid->geometry).holds(presentBodies(f.simulator.table(), f.simulator.object()).box.grown(5.0)));
  CHECK_FALSE(f.sampler.take());
  f.sampler.want(false, 5.0, imageGrid());
  f.sampler.onPublished(*f.simulation);
  CHECK(f.simulator.rims_m.size() == 1);
}

TEST_CASE("A simulation that begins anew drops what was not taken, and lays the reference anew") {
  Fixture f;
  f.sampler.want(true, 5.0, imageGrid());
  f.sampler.onPublished(*f.simulation);
  f.sampler.begin();
  CHECK_FALSE(f.sampler.take());
  f.simulator.bodies = {cubeBody(0.01, {0, 0, 0}, {0, 0, 0})};
  f.sampler.onPublished(*f.simulation);
  const auto grid = f.sampler.take();
  REQUIRE(grid);
  CHECK(imaging::voxelCount(*grid->bodies) == 10 * 10 * 10);
  // The same for another image.
  imaging::VolumeGeometry other = imageGrid();
  other.size = {40, 40, 15};
  f.sampler.want(true, 5.0, other);
  f.sampler.onPublished(*f.simulation);
  const auto onOther = f.sampler.take();
  REQUIRE(onOther);
  CHECK(imaging::voxelCount(*onOther->bodies) == 10 * 10 * 5);
}

TEST_CASE("What stays is marked around the bodies, and a change of it counts at once") {
  Fixture f;
  auto image = std::make_shared<scene::StoredImage>();
  image->volume.geometry = imageGrid();
  std::vector<std::int16_t> voxels(40 * 40 * 40, 0);
  voxels[0] = 1000;                         // bone next to the body
  voxels[15 + 40 * (15 + 40 * 15)] = 1000;  // and within it
  image->volume.voxels = voxels;
  FixedRegions still;
  still.image = image;
  still.rule.above = 200.0;
  f.sampler.want(true, 5.0, imageGrid(), still);
  f.sampler.onPublished(*f.simulation);
  auto grid = f.sampler.take();
  REQUIRE(grid);
  CHECK(grid->hasFixedRegions);
  CHECK(fixedVoxels(*grid) == 1);
  CHECK(grid->bodies->voxels[0] == imaging::kFixedVoxel);
  CHECK(grid->bodies->voxels[15 + 40 * (15 + 40 * 15)] == imaging::kBodyVoxel);
  still.rule.above = 2000.0;
  still.rule.outside = true;
  f.sampler.want(true, 5.0, imageGrid(), still);
  f.sampler.onPublished(*f.simulation);
  grid = f.sampler.take();
  REQUIRE(grid);
  CHECK(fixedVoxels(*grid) == 40 * 40 * 40 - 20 * 20 * 20);
  f.sampler.want(true, 5.0, imageGrid());
  f.sampler.onPublished(*f.simulation);
  grid = f.sampler.take();
  REQUIRE(grid);
  CHECK_FALSE(grid->hasFixedRegions);
  CHECK(fixedVoxels(*grid) == 0);
  // Rigid tissue of the bodies.
  TissueVoxels places;
  places.tissues.resize(2);
  places.tissues[1].isRigid = true;
  imaging::LabelMap map{imageGrid(), std::vector<std::uint16_t>(imageGrid().voxelCount(), 1), {}};
  map.voxels[15 + 40 * (15 + 40 * 15)] = 2;
  places.map = std::make_shared<const imaging::LabelMap>(std::move(map));
  FixedRegions rigid;
  rigid.tissues = std::make_shared<const std::vector<TissueVoxels>>(std::vector{places});
  f.sampler.want(true, 5.0, imageGrid(), rigid);
  f.sampler.onPublished(*f.simulation);
  grid = f.sampler.take();
  REQUIRE(grid);
  CHECK(grid->hasFixedRegions);
  CHECK(grid->bodies->voxels[15 + 40 * (15 + 40 * 15)] == imaging::kRigidVoxel);
  CHECK(grid->bodies->voxels[16 + 40 * (15 + 40 * 15)] == imaging::kBodyVoxel);
}

TEST_CASE("A simulator that cannot say leaves nothing to take") {
  Fixture f;
  f.sampler.want(true, 5.0, imageGrid());
  f.simulator.fail("displacement", C3DE_E_INTERNAL);
  f.sampler.onPublished(*f.simulation);
  CHECK_FALSE(f.sampler.take());
}

TEST_CASE("While it plays the simulator is asked at most every 50 ms, and the one left out is told") {
  Fixture f;
  f.sampler.want(true, 5.0, imageGrid());
  f.simulation->transport(C3DE_TRANSPORT_PLAY);
  for (int i = 0; i < 1000 && f.simulation->state().mode != C3DE_SIM_PLAYING; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  REQUIRE(f.simulation->state().mode == C3DE_SIM_PLAYING);
  f.sampler.onPublished(*f.simulation);
  CHECK_FALSE(f.sampler.isBehind());
  // On a busy machine 50 ms may pass between two calls, not between all.
  std::size_t asked = 0;
  for (int i = 0; i < 50 && !f.sampler.isBehind(); ++i) {
    asked = f.simulator.rims_m.size();
    f.sampler.onPublished(*f.simulation);
  }
  CHECK(f.sampler.isBehind());
  CHECK(f.simulator.rims_m.size() == asked);
  f.simulation->transport(C3DE_TRANSPORT_PAUSE);
  for (int i = 0; i < 1000 && f.simulation->state().mode == C3DE_SIM_PLAYING; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  f.sampler.onPublished(*f.simulation);
  CHECK_FALSE(f.sampler.isBehind());
  CHECK(f.simulator.rims_m.size() == asked + 1);
}

namespace {

/// The corners of a cube of 20 mm as its points, with a stress of 500 Pa.
c3de::test::ReportedBody cubeWithPoints() {
  c3de::test::ReportedBody body = cubeBody(0.02, {0, 0, 0}, {0.002, 0, 0});
  body.points = 8;
  body.spacing_m = 0.02;
  body.inside = body.skin;
  body.inside.push_back({C3DE_SIM_FIELD_MASS, "kg", std::vector<double>(8, 1e-3)});
  body.inside.push_back({C3DE_SIM_FIELD_VOLUME, "m^3", std::vector<double>(8, 1e-6)});
  body.inside.push_back({"stress_of_it", "Pa", std::vector<double>(8, 500.0)});
  body.inside.push_back({"heat", "K", std::vector<double>(8, 310.0)});
  return body;
}

}  // namespace

TEST_CASE("Fields of the tissue are read while somebody looks at them, and told by the name that they have") {
  Fixture f;
  f.simulator.bodies = {cubeWithPoints()};
  f.simulator.gap_m = 0.0;
  f.sampler.want(true, 5.0, imageGrid());
  CHECK(f.sampler.offered().empty());
  f.sampler.onPublished(*f.simulation);
  CHECK(f.sampler.offered() == std::vector<PointField>{{"stress_of_it", "Pa"}, {"heat", "K"}});
  CHECK(f.sampler.take()->fields.empty());
  f.sampler.requestFields({true, ""});
  f.sampler.onPublished(*f.simulation);
  auto grid = f.sampler.take();
  REQUIRE(grid->fields.size() == 2);
  CHECK(grid->fields[0].name == imaging::kVolumeRatio);
  CHECK(grid->fields[1].name == "stress_of_it");
  CHECK(grid->fields[1].unit == "Pa");
  CHECK(grid->fields[1].low == 500.0);
  CHECK(grid->fields[1].high == 500.0);
  // It has moved as a whole, by 2 mm.
  const auto ratio = grid->valueOf(grid->fields[0], {12, 10, 10}),
             stress = grid->valueOf(grid->fields[1], {12, 10, 10});
  REQUIRE(ratio);
  REQUIRE(stress);
  CHECK_THAT(*ratio, WithinAbs(1.0, 1e-6));
  CHECK_THAT(*stress, WithinAbs(500.0, 1e-3));
  CHECK_FALSE(grid->valueOf(grid->fields[1], {26, 10, 10}));
  f.sampler.requestFields({true, "heat"});
  f.sampler.onPublished(*f.simulation);
  grid = f.sampler.take();
  REQUIRE(grid->field("heat"));
  CHECK_FALSE(grid->field("stress_of_it"));
  f.sampler.requestFields({true, "unknown"});
  f.sampler.onPublished(*f.simulation);
  CHECK(f.sampler.take()->fields.size() == 1);
  // A body without the field has no value, the others keep theirs.
  f.simulator.bodies.push_back(cubeBody(0.01, {0, 0.06, 0}, {0, 0, 0}));
  f.sampler.begin();
  CHECK(f.sampler.offered().empty());
  f.sampler.requestFields({true, "heat"});
  f.sampler.onPublished(*f.simulation);
  CHECK(f.sampler.take()->field("heat")->high == 310.0);
}
