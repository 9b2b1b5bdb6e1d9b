// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/tissue_tracker.h"

#include <chrono>
#include <functional>
#include <thread>

#include "c3de/session/displacement_sampler.h"
#include "support/catch.h"
#include "support/recording_simulator.h"

using namespace c3de;
using namespace c3de::session;
using c3de::test::cubeBody;
using c3de::test::RecordingSimulator;

namespace {

/// A cube of 40 mm with a label of 8 ml in its middle.
std::vector<TissueVoxels> onePlace() {
  TissueVoxels places;
  places.body = "body";
  places.voxel_mm3 = 8.0;
  LabelVoxels label;
  label.name = "liver";
  label.value = 1;
  label.voxels = 1000;
  for (int i = 0; i < 10; ++i)
    for (int j = 0; j < 10; ++j)
      for (int k = 0; k < 10; ++k) label.sample.push_back({11.0 + 2 * i, 11.0 + 2 * j, 11.0 + 2 * k});
  scene::SceneTissue tissue;
  tissue.label = "liver";
  places.tissues.push_back(tissue);
  places.labels.push_back(label);
  return {places};
}

struct Fixture {
  RecordingSimulator simulator;
  std::unique_ptr<scene::Simulation> simulation;
  std::atomic<int> renewed{0};
  TissueTracker tissues{[this] { ++renewed; }};

  Fixture() {
    simulator.bodies = {cubeBody(0.04, {0, 0, 0}, {0.003, 0, 0.004})};
    simulator.displacement_m = {0.003, 0, 0.004};
    simulation = std::move(*scene::Simulation::create(simulator.object()));
    simulation->call([] {});
  }
  bool waitFor(const std::function<bool()> &met) {
    for (int i = 0; i < 2000 && !met(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    return met();
  }
};

}  // namespace

TEST_CASE("Labels are followed beside the simulation while somebody looks", "[live_tissues]") {
  Fixture f;
  f.tissues.want(true);
  f.tissues.onPublished(*f.simulation);  // there are no such bodies
  CHECK(f.simulator.grids.empty());
  CHECK_FALSE(f.tissues.isBehind());
  f.tissues.want(false);
  f.tissues.begin(onePlace());
  f.tissues.onPublished(*f.simulation);
  CHECK(f.simulator.grids.empty());
  CHECK_FALSE(f.tissues.newest());
  f.tissues.want(true);
  CHECK(f.tissues.isBehind());
  f.tissues.onPublished(*f.simulation);
  REQUIRE(f.waitFor([&] { return f.renewed == 1; }));
  CHECK_FALSE(f.tissues.isBehind());
  const auto newest = f.tissues.newest();
  REQUIRE(newest);
  REQUIRE(newest->size() == 1);
  const LabelMotion &liver = newest->front().labels.front();
  CHECK(liver.followed == 1000);
  CHECK(liver.reference_m3 == Approx(8e-6));
  CHECK(liver.end_m3 == Approx(8e-6));
  CHECK(liver.meanDisplacement_m() == Approx(0.005));
  CHECK(f.tissues.following_ms() > 0.0);
  // Another simulation has none of it.
  f.tissues.begin(onePlace());
  CHECK_FALSE(f.tissues.newest());
  f.simulator.fail("displacement", -1);
  f.tissues.onPublished(*f.simulation);
  CHECK_FALSE(f.tissues.newest());
  CHECK_FALSE(f.tissues.isBehind());  // it is not requested repeatedly
  f.tissues.begin({});
  CHECK_FALSE(f.tissues.bodies());
}

TEST_CASE("A displacement that others have asked for serves the labels too", "[live_tissues]") {
  Fixture f;
  DisplacementSampler image;
  imaging::VolumeGeometry grid{{60, 60, 60}, kIdentity4};
  image.want(true, 10.0, grid);
  f.tissues.want(true);
  f.tissues.begin(onePlace());
  auto u = std::make_shared<imaging::DisplacementGrid>(*image.onPublished(*f.simulation));
  // The static part of the image does not affect the tissue.
  u->bodies = std::make_shared<imaging::Mask>(
      imaging::Mask{grid, std::vector<std::uint8_t>(grid.voxelCount(), imaging::kFixedVoxel)});
  u->hasFixedRegions = true;
  REQUIRE(f.simulator.grids.size() == 1);
  f.simulation->transport(C3DE_TRANSPORT_PLAY);
  REQUIRE(f.waitFor([&] { return f.simulation->state().mode == C3DE_SIM_PLAYING; }));
  f.tissues.onPublished(*f.simulation, nullptr, true);  // the next snapshot has one
  CHECK(f.simulator.grids.size() == 1);
  CHECK(f.tissues.isBehind());
  f.tissues.onPublished(*f.simulation, u, true);
  REQUIRE(f.waitFor([&] { return f.renewed == 1; }));
  CHECK(f.simulator.grids.size() == 1);
  CHECK_FALSE(f.tissues.isBehind());
  const LabelMotion liver = f.tissues.newest()->front().labels.front();
  CHECK(liver.followed == 1000);
  CHECK(liver.end_m3 == Approx(8e-6));
  CHECK(liver.meanDisplacement_m() == Approx(0.005));
  // A displacement that never arrives is requested once the simulation is paused. One that does not contain all bodies
  // is not used.
  f.simulation->transport(C3DE_TRANSPORT_PAUSE);
  REQUIRE(f.waitFor([&] { return f.simulation->state().mode != C3DE_SIM_PLAYING; }));
  f.tissues.onPublished(*f.simulation, nullptr, true);
  CHECK(f.simulator.grids.size() == 2);
  REQUIRE(f.waitFor([&] { return f.renewed == 2; }));
  u->geometry.indexToWorld[12] += 40.0;
  f.tissues.onPublished(*f.simulation, u, true);
  CHECK(f.simulator.grids.size() == 3);
  REQUIRE(f.waitFor([&] { return f.renewed == 3; }));
  CHECK(f.tissues.newest()->front().labels.front().followed == 1000);
}

TEST_CASE("While it plays labels are read at most twice a second", "[live_tissues]") {
  Fixture f;
  f.tissues.begin(onePlace());
  f.tissues.want(true);
  f.simulation->transport(C3DE_TRANSPORT_PLAY);
  REQUIRE(f.waitFor([&] { return f.simulation->state().mode == C3DE_SIM_PLAYING; }));
  f.tissues.onPublished(*f.simulation);
  REQUIRE(f.waitFor([&] { return f.renewed == 1; }));
  const auto from = std::chrono::steady_clock::now();
  const std::size_t read = f.simulator.grids.size();
  while (std::chrono::steady_clock::now() - from < std::chrono::milliseconds(200)) f.tissues.onPublished(*f.simulation);
  CHECK(f.simulator.grids.size() == read);
  CHECK(f.tissues.isBehind());
  f.simulation->transport(C3DE_TRANSPORT_PAUSE);
  REQUIRE(f.waitFor([&] { return f.simulation->state().mode != C3DE_SIM_PLAYING; }));
  f.tissues.onPublished(*f.simulation);
  CHECK(f.simulator.grids.size() == read + 1);
}

TEST_CASE("One that ends does not wait for what is followed", "[live_tissues]") {
  std::vector<TissueVoxels> many = onePlace();
  for (int i = 0; i < 1500; ++i) many.front().labels.push_back(many.front().labels.front());
  RecordingSimulator simulator;
  simulator.bodies = {cubeBody(0.04, {0, 0, 0}, {0.003, 0, 0.004})};
  simulator.displacement_m = {0.003, 0, 0.004};
  const auto snapshot = readTissues(simulator.table(), simulator.object(), TissueDetail::live);
  REQUIRE(snapshot);
  const auto full = readTissues(simulator.table(), simulator.object());
  REQUIRE(full);
  CHECK(full->u->geometry.voxelCount() > 4 * snapshot->u->geometry.voxelCount());
  using Clock = std::chrono::steady_clock;
  const auto begun = Clock::now();
  REQUIRE(followTissues(*snapshot, many));
  const auto whole = Clock::now() - begun;
  int asked = 0;
  const auto ended = followTissues(*snapshot, many, [&] { return ++asked < 3; });
  REQUIRE_FALSE(ended);
  CHECK(ended.error().code == ErrorCode::cancelled);
  CHECK(asked == 3);
  auto f = std::make_unique<Fixture>();
  f->tissues.begin(many);
  f->tissues.want(true);
  f->tissues.onPublished(*f->simulation);
  std::this_thread::sleep_for(whole / 4);  // it has begun
  const auto from = Clock::now();
  f.reset();
  // Half allows for other load on the machine.
  CHECK(Clock::now() - from < whole / 2);
}

TEST_CASE("Surfaces are followed ten times a second while somebody looks, and labels with them twice",
          "[live_tissues]") {
  Fixture f;
  f.tissues.begin(onePlace());
  const auto surfaces = std::make_shared<std::vector<TissueSurface>>(1);
  surfaces->front().body = "body";
  surfaces->front().reference.vertices = {{10, 10, 10}, {30, 10, 10}, {10, 30, 10}};
  f.tissues.onPublished(*f.simulation);
  CHECK(f.simulator.grids.empty());
  f.tissues.follow(surfaces);
  CHECK(f.tissues.isBehind());
  f.tissues.onPublished(*f.simulation);
  REQUIRE(f.waitFor([&] { return f.renewed == 1; }));
  auto places = f.tissues.places();
  REQUIRE(places);
  CHECK(places->of == surfaces);
  REQUIRE(places->vertices.front().size() == 3);
  CHECK(places->vertices.front()[1][0] == Approx(33.0));
  CHECK(places->vertices.front()[1][2] == Approx(14.0));
  CHECK_FALSE(f.tissues.newest());  // the labels are not requested
  CHECK_FALSE(f.tissues.isBehind());
  f.tissues.want(true);
  CHECK(f.tissues.isBehind());
  f.tissues.onPublished(*f.simulation);
  REQUIRE(f.waitFor([&] { return f.renewed == 2; }));
  CHECK(f.tissues.newest());
  CHECK_FALSE(f.tissues.isBehind());
  places = f.tissues.places();
  f.simulation->transport(C3DE_TRANSPORT_PLAY);
  REQUIRE(f.waitFor([&] { return f.simulation->state().mode == C3DE_SIM_PLAYING; }));
  // Independent of the time that a slow machine needs for a reading: both are at least followed, labels less often.
  int labels = 0, times = 0;
  auto last = f.tissues.newest();
  const auto until = std::chrono::steady_clock::now() + std::chrono::milliseconds(1400);
  while (std::chrono::steady_clock::now() < until) {
    f.tissues.onPublished(*f.simulation);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    if (f.tissues.places() != places) ++times, places = f.tissues.places();
    if (f.tissues.newest() != last) ++labels, last = f.tissues.newest();
  }
  CHECK(labels >= 1);
  CHECK(labels <= 3);
  CHECK(times > labels);
  CHECK(times <= 15);
  // Another simulation has other tissues.
  f.simulation->transport(C3DE_TRANSPORT_PAUSE);
  f.tissues.begin(onePlace());
  CHECK_FALSE(f.tissues.places());
}
