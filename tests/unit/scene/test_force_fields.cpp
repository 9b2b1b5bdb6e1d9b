// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <chrono>
#include <limits>
#include <numeric>
#include <thread>

#include "c3de/scene/force_fields.h"
#include "c3de/scene/simulation.h"
#include "support/catch.h"
#include "support/recording_simulator.h"

using namespace c3de;
using scene::ForceFields;
using test::RecordingSimulator;

namespace {

constexpr std::size_t kPoints = 4;                // of each body
constexpr double kNumbers = 2.0 * 3.0 * kPoints;  // of both bodies

struct Fixture {
  Fixture() { simulator.bodies = {test::pointBody("first", kPoints), test::pointBody("second", kPoints)}; }
  [[nodiscard]] Expected<void> apply(Handle node = {}) {
    return fields.apply(node, simulator.object(), simulator.table());
  }
  Handle addPush(double force, Handle node = {}, const std::string &owner = "org.test") {
    return fields.add({"push",
                       owner,
                       node,
                       [force](const c3de_force_call &call) -> c3de_status {
                         for (std::uint64_t i = 0; i < 3 * call.count; ++i) call.forces_N[i] += force;
                         return C3DE_OK;
                       },
                       {}});
  }
  [[nodiscard]] double sum() const {
    double all = 0.0;
    for (const test::ReportedBody &body : simulator.bodies)
      all += std::accumulate(body.forces_N.begin(), body.forces_N.end(), 0.0);
    return all;
  }

  RecordingSimulator simulator;
  ForceFields fields;
};

}  // namespace

TEST_CASE("Force fields add up on every body, in each step anew") {
  Fixture f;
  f.addPush(1.0);
  f.addPush(0.5);
  for (int step = 0; step < 3; ++step) {
    REQUIRE(f.apply());
    CHECK(f.sum() == 1.5 * kNumbers);
  }
}

TEST_CASE("A force field of one simulation does not act in another") {
  Fixture f;
  f.addPush(1.0, Handle{7, 1});
  REQUIRE(f.apply(Handle{8, 1}));
  CHECK(f.sum() == 0.0);
  REQUIRE(f.apply(Handle{7, 1}));
  CHECK(f.sum() == kNumbers);
}

TEST_CASE("Only its owner removes a force field") {
  Fixture f;
  const Handle mine = f.addPush(1.0, {}, "org.mine");
  CHECK(f.fields.remove(mine, "org.other") == ForceFields::Removal::stale);
  CHECK(f.fields.remove(mine, "org.mine") == ForceFields::Removal::done);
  CHECK(f.fields.remove(mine, "org.mine") == ForceFields::Removal::stale);
  f.addPush(1.0, {}, "org.mine");
  f.addPush(1.0, {}, "org.other");
  f.fields.removeOwnedBy("org.mine");
  REQUIRE(f.apply());
  CHECK(f.sum() == kNumbers);
}

TEST_CASE("A force field that fails is removed, is named with its plugin, and leaves no force behind") {
  Fixture f;
  f.addPush(1.0);
  int calls = 0;
  f.fields.add({"second thoughts",
                "org.bad",
                {},
                [&](const c3de_force_call &call) -> c3de_status {
                  call.forces_N[0] += 3.0;
                  return ++calls == 2 ? C3DE_E_INTERNAL : C3DE_OK;  // for the second body
                },
                [] { return std::string("it has run out"); }});
  const auto failed = f.apply();
  REQUIRE_FALSE(failed);
  CHECK_THAT(failed.error().message,
             Contains("second thoughts") && Contains("org.bad") && Contains("'second'") && Contains("it has run out"));
  CHECK(f.sum() == 0.0);
  REQUIRE(f.apply());
  CHECK(f.sum() == kNumbers);
}

TEST_CASE("A force that is not finite is found, with its point") {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Fixture f;
    f.fields.add({"bad",
                  "org.bad",
                  {},
                  [bad](const c3de_force_call &call) -> c3de_status {
                    call.forces_N[3 * 2 + 1] = bad;
                    return C3DE_OK;
                  },
                  {}});
    const auto failed = f.apply();
    REQUIRE_FALSE(failed);
    CHECK_THAT(failed.error().message, Contains("point 2"));
    CHECK(f.sum() == 0.0);
    CHECK(f.apply());
  }
}

TEST_CASE("A simulator that takes no forces is said, once") {
  Fixture f;
  f.simulator.hasPoints = false;
  f.addPush(1.0);
  const Handle elsewhere = f.addPush(1.0, Handle{7, 1});
  const auto failed = f.apply();
  REQUIRE_FALSE(failed);
  CHECK_THAT(failed.error().message, Contains("takes no forces from outside (points() of"));
  CHECK(f.apply());
  CHECK(f.fields.remove(elsewhere, "org.test") == ForceFields::Removal::done);
}

TEST_CASE("No force field is added or removed by who is applying one, and removal waits for another thread's") {
  Fixture f;
  Handle field;
  std::atomic<bool> running{false}, mayEnd{false};
  auto inside = ForceFields::Removal::done;
  Handle added{1, 1};
  field = f.fields.add({"slow",
                        "org.test",
                        {},
                        [&](const c3de_force_call &) -> c3de_status {
                          inside = f.fields.remove(field, "org.test");
                          added = f.fields.add({});
                          running = true;
                          while (!mayEnd) std::this_thread::yield();
                          return C3DE_OK;
                        },
                        {}});
  std::thread stepping([&] { CHECK(f.apply()); });
  while (!running) std::this_thread::yield();
  std::atomic<bool> removed{false};
  std::thread removing([&] {
    CHECK(f.fields.remove(field, "org.test") == ForceFields::Removal::done);
    removed = true;
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  CHECK_FALSE(removed);
  mayEnd = true;
  stepping.join();
  removing.join();
  CHECK(removed);
  CHECK(inside == ForceFields::Removal::fromApply);
  CHECK(added.isNull());
}

TEST_CASE("What cannot be prepared pauses a simulation before the step, and the next play goes on") {
  RecordingSimulator simulator;
  auto created = scene::Simulation::create(simulator.object());
  REQUIRE(created);
  std::atomic<int> asked{0};
  (*created)->setBeforeStep([&]() -> Expected<void> {
    if (++asked == 3) return fail(ErrorCode::plugin, "the third is not to be");
    return {};
  });
  (*created)->setTargetRate(0.0);
  (*created)->transport(C3DE_TRANSPORT_PLAY);
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  while ((*created)->state().mode != C3DE_SIM_PAUSED && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  CHECK((*created)->state().mode == C3DE_SIM_PAUSED);
  CHECK(simulator.steps == 2);
  (*created)->transport(C3DE_TRANSPORT_PLAY);
  while (simulator.steps < 5 && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  CHECK(simulator.steps >= 5);
}

TEST_CASE("What a force field writes to positions, velocities and masses reaches nobody") {
  Fixture f;
  f.fields.add({"vandal",
                "org.vandal",
                {},
                [](const c3de_force_call &call) -> c3de_status {
                  for (const double *array : {call.positions_m, call.velocities_m_s, call.masses_kg})
                    const_cast<double *>(array)[0] = 1e3;
                  return C3DE_OK;
                },
                {}});
  double seen = 0.0;
  f.fields.add({"reader",
                "org.reader",
                {},
                [&seen](const c3de_force_call &call) -> c3de_status {
                  for (const double *array : {call.positions_m, call.velocities_m_s, call.masses_kg})
                    seen = std::max(seen, array[0]);
                  call.forces_N[0] += 2.0;
                  return C3DE_OK;
                },
                {}});
  REQUIRE(f.apply());
  CHECK(seen < 1e3);
  CHECK(f.sum() == 2.0 * 2.0);  // one for each body
  for (int body = 0; body < 2; ++body) {
    c3de_sim_points points{};
    points.size = sizeof points;
    REQUIRE(f.simulator.table()->points(f.simulator.object(), {static_cast<std::uint64_t>(body) + 1}, &points) >= 0);
    CHECK(points.positions_m[0] < 1e3);
    CHECK(points.velocities_m_s[0] < 1e3);
    CHECK(points.masses_kg[0] < 1e3);
  }
}

TEST_CASE("A force field that writes beyond an array is removed, and the message names it") {
  struct Beyond {
    const char *array;
    double *(*place)(const c3de_force_call &call);
  };
  for (const Beyond &beyond :
       {Beyond{"forces_N", [](const c3de_force_call &call) { return call.forces_N + 3 * call.count; }},
        Beyond{"masses_kg", [](const c3de_force_call &call) { return call.forces_N - 1; }},
        Beyond{"velocities_m_s",
               [](const c3de_force_call &call) { return const_cast<double *>(call.velocities_m_s) + 3 * call.count; }},
        Beyond{"positions_m",
               [](const c3de_force_call &call) { return const_cast<double *>(call.positions_m) - 1; }}}) {
    INFO(beyond.array);
    Fixture f;
    f.fields.add({"long",
                  "org.long",
                  {},
                  [&beyond](const c3de_force_call &call) -> c3de_status {
                    *beyond.place(call) = 1.0;
                    return C3DE_OK;
                  },
                  {}});
    const auto applied = f.apply();
    REQUIRE_FALSE(applied);
    CHECK_THAT(applied.error().message,
               Contains("'long' of org.long is removed") && Contains(std::string("beyond the end of ") + beyond.array));
    CHECK(f.sum() == 0.0);
    CHECK(f.apply());
  }
}
