// SPDX-License-Identifier: Apache-2.0
#include "c3de/scene/simulation.h"

#include <chrono>
#include <functional>
#include <memory>
#include <thread>
#include <vector>

#include "c3de/core/log.h"
#include "support/catch.h"
#include "support/recording_simulator.h"

using namespace c3de;
using test::RecordingSimulator;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using scene::Simulation;

namespace {

/// Waits until the condition holds, or long enough to be sure that it will not.
bool eventually(const std::function<bool()> &isSo, std::chrono::milliseconds patience = 5000ms) {
  const auto end = Clock::now() + patience;
  while (Clock::now() < end) {
    if (isSo()) return true;
    std::this_thread::sleep_for(1ms);
  }
  return isSo();
}

std::unique_ptr<Simulation> start(RecordingSimulator &simulator) {
  return Simulation::create(simulator.object()).value();
}

/// The state after all requests so far.
c3de_sim_transport settled(Simulation &simulation) {
  simulation.call([] {});
  return simulation.state();
}

}  // namespace

TEST_CASE("A new simulation stands at its initial state, shows it, and does nothing") {
  RecordingSimulator simulator;
  {
    const auto simulation = start(simulator);
    CHECK(simulator.references() == 2);
    CHECK(simulation->object() == simulator.object());
    REQUIRE(eventually([&] { return simulator.publishes >= 1; }));
    std::this_thread::sleep_for(30ms);
    const c3de_sim_transport state = settled(*simulation);
    CHECK(state.mode == C3DE_SIM_STOPPED);
    CHECK(state.steps == 0);
    CHECK(state.target_rate == 1.0);
    CHECK(state.real_time_factor == 0.0);
    CHECK(simulator.steps == 0);
  }
  CHECK(simulator.references() == 1);
}

TEST_CASE("An object that is no simulator is refused with the name of the interface") {
  RecordingSimulator simulator;
  simulator.answersInterface = false;
  const auto none = Simulation::create(simulator.object());
  REQUIRE_FALSE(none.has_value());
  CHECK(none.error().code == ErrorCode::plugin);
  CHECK_THAT(none.error().message, Contains(C3DE_IFACE_SIMULATOR_ID));
  simulator.answersInterface = true;
  simulator.tableSize = 16;
  const auto tooOld = Simulation::create(simulator.object());
  REQUIRE_FALSE(tooOld.has_value());
  CHECK_THAT(tooOld.error().message, Contains("its size 16 ends before declarations, which revision 1 has"));
  CHECK(simulator.references() == 1);
  CHECK_FALSE(Simulation::create(nullptr).has_value());
}

TEST_CASE("Step makes one step and pauses") {
  RecordingSimulator simulator;
  const auto simulation = start(simulator);
  simulation->transport(C3DE_TRANSPORT_STEP);
  c3de_sim_transport state = settled(*simulation);
  CHECK(state.mode == C3DE_SIM_PAUSED);
  CHECK(state.steps == 1);
  CHECK(eventually([&] { return simulator.publishedStep == 1; }));
  simulation->transport(C3DE_TRANSPORT_STEP);
  simulation->transport(C3DE_TRANSPORT_STEP);
  state = settled(*simulation);
  CHECK(state.steps == 3);
  CHECK_THAT(state.time_s, WithinAbs(3e-3, 1e-12));
}

TEST_CASE("Play goes on until pause, and the last state is shown") {
  RecordingSimulator simulator;
  const auto simulation = start(simulator);
  simulation->transport(C3DE_TRANSPORT_PLAY);
  REQUIRE(eventually([&] { return simulation->state().steps > 20; }));
  CHECK(simulation->state().mode == C3DE_SIM_PLAYING);
  simulation->transport(C3DE_TRANSPORT_PAUSE);
  const c3de_sim_transport state = settled(*simulation);
  CHECK(state.mode == C3DE_SIM_PAUSED);
  CHECK(eventually([&] { return simulator.publishedStep == state.steps; }));
  std::this_thread::sleep_for(30ms);
  CHECK(simulator.steps == state.steps);
  simulation->transport(C3DE_TRANSPORT_PLAY);
  CHECK(eventually([&] { return simulation->state().steps > state.steps; }));
}

TEST_CASE("Stop goes back to the initial state and stays there") {
  RecordingSimulator simulator;
  const auto simulation = start(simulator);
  simulation->transport(C3DE_TRANSPORT_PLAY);
  REQUIRE(eventually([&] { return simulation->state().steps > 5; }));
  simulation->transport(C3DE_TRANSPORT_STOP);
  const c3de_sim_transport state = settled(*simulation);
  CHECK(state.mode == C3DE_SIM_STOPPED);
  CHECK(state.steps == 0);
  CHECK(state.time_s == 0.0);
  CHECK(state.real_time_factor == 0.0);
  CHECK(simulator.resets == 1);
  CHECK(eventually([&] { return simulator.publishedStep == 0; }));
}

TEST_CASE("Reset goes on playing if it was, and stands still if it was paused") {
  RecordingSimulator simulator;
  const auto simulation = start(simulator);
  simulation->transport(C3DE_TRANSPORT_PLAY);
  REQUIRE(eventually([&] { return simulation->state().steps > 5; }));
  simulation->transport(C3DE_TRANSPORT_RESET);
  CHECK(settled(*simulation).mode == C3DE_SIM_PLAYING);
  REQUIRE(eventually([&] { return simulation->state().steps > 0; }));
  simulation->transport(C3DE_TRANSPORT_PAUSE);
  simulation->transport(C3DE_TRANSPORT_RESET);
  const c3de_sim_transport state = settled(*simulation);
  CHECK(state.mode == C3DE_SIM_STOPPED);
  CHECK(state.steps == 0);
  CHECK(simulator.resets == 2);
}

TEST_CASE("A failed step keeps the state, says why, and only stop or reset lead out") {
  setLogThreshold(LogLevel::error);
  RecordingSimulator simulator;
  simulator.failAtStep = 4;
  const auto simulation =
      Simulation::create(simulator.object(), [] { return std::string("phyxel 12 has no volume left"); }).value();
  simulation->transport(C3DE_TRANSPORT_PLAY);
  REQUIRE(eventually([&] { return simulation->state().mode == C3DE_SIM_FAILED; }));
  CHECK(simulation->state().steps == 3);
  CHECK_THAT(simulation->failure(), Contains("step 4") && Contains("phyxel 12 has no volume left"));
  CHECK(eventually([&] { return simulator.publishedStep == 3; }));
  for (const std::uint32_t action : {C3DE_TRANSPORT_PLAY, C3DE_TRANSPORT_STEP, C3DE_TRANSPORT_PAUSE}) {
    simulation->transport(action);
    CHECK(settled(*simulation).mode == C3DE_SIM_FAILED);
  }
  CHECK(simulator.steps == 3);

  simulation->transport(C3DE_TRANSPORT_RESET);
  c3de_sim_transport state = settled(*simulation);
  CHECK(state.mode == C3DE_SIM_STOPPED);
  CHECK(state.steps == 0);
  CHECK(simulation->failure().empty());
  for (int i = 0; i < 4; ++i) simulation->transport(C3DE_TRANSPORT_STEP);
  REQUIRE(settled(*simulation).mode == C3DE_SIM_FAILED);
  simulation->transport(C3DE_TRANSPORT_STOP);
  CHECK(settled(*simulation).mode == C3DE_SIM_STOPPED);
  simulator.failAtStep = 0;
  simulation->transport(C3DE_TRANSPORT_STEP);
  CHECK(settled(*simulation).steps == 1);
}

TEST_CASE("A reset that fails leaves a failed simulation, not a wrong one") {
  RecordingSimulator simulator;
  simulator.fail("reset", C3DE_E_INTERNAL);
  const auto simulation = start(simulator);
  simulation->transport(C3DE_TRANSPORT_STEP);
  (void)settled(*simulation);
  simulation->transport(C3DE_TRANSPORT_STOP);
  const c3de_sim_transport state = settled(*simulation);
  CHECK(state.mode == C3DE_SIM_FAILED);
  CHECK(state.steps == 1);
  CHECK_THAT(simulation->failure(), Contains("initial state") && Contains("-17"));
}

TEST_CASE("Posted commands run on the simulation's thread between steps, in order, also while paused") {
  RecordingSimulator simulator;
  const auto simulation = start(simulator);
  std::vector<int> order;
  std::thread::id first, second;
  simulation->post([&] {
    order.push_back(1);
    first = std::this_thread::get_id();
  });
  simulation->post([&] { order.push_back(2); });
  simulation->call([&] {
    order.push_back(3);
    second = std::this_thread::get_id();
  });
  CHECK(order == std::vector<int>{1, 2, 3});
  CHECK(first == second);
  CHECK(first != std::this_thread::get_id());
  // The effect of a command is shown without a step.
  const std::uint64_t before = simulator.publishes;
  simulation->post([] {});
  CHECK(eventually([&] { return simulator.publishes > before; }));
  CHECK(simulator.steps == 0);
  // A command that waits for itself must not hang, one that throws must not end the thread.
  bool nested = false;
  simulation->call([&] { simulation->call([&] { nested = true; }); });
  CHECK(nested);
  setLogThreshold(LogLevel::error);
  simulation->post([] { throw std::runtime_error("on purpose"); });
  CHECK(settled(*simulation).mode == C3DE_SIM_STOPPED);
}

TEST_CASE("Playing in real time keeps to the wall clock") {
  RecordingSimulator simulator;
  simulator.dt_s = 2e-3;
  const auto simulation = start(simulator);
  const auto begin = Clock::now();
  simulation->transport(C3DE_TRANSPORT_PLAY);
  std::this_thread::sleep_for(600ms);
  simulation->transport(C3DE_TRANSPORT_PAUSE);
  const c3de_sim_transport state = settled(*simulation);
  const double wall_s = std::chrono::duration<double>(Clock::now() - begin).count();
  // Never ahead of the clock; behind it by no more than the load of the machine explains.
  CHECK(state.time_s <= wall_s);
  CHECK(state.time_s > 0.25 * wall_s);
  CHECK(state.real_time_factor < 1.2);
  CHECK(state.real_time_factor > 0.25);
}

TEST_CASE("A target rate slows down and speeds up") {
  RecordingSimulator simulator;
  const auto simulation = start(simulator);
  simulation->setTargetRate(0.1);
  simulation->transport(C3DE_TRANSPORT_PLAY);
  const auto begin = Clock::now();
  std::this_thread::sleep_for(400ms);
  const double slow_s = settled(*simulation).time_s;
  const double wall_s = std::chrono::duration<double>(Clock::now() - begin).count();
  CHECK(slow_s <= 0.1 * wall_s + 2e-3);
  CHECK(slow_s > 0.03 * wall_s);
  CHECK(simulation->state().target_rate == 0.1);

  simulation->setTargetRate(0.0);
  const std::uint64_t before = settled(*simulation).steps;
  std::this_thread::sleep_for(100ms);
  // Without a step to wait for, far more than a step per millisecond.
  CHECK(settled(*simulation).steps > before + 1000);
  CHECK(simulation->state().real_time_factor > 2.0);
  simulation->setTargetRate(-3.0);
  CHECK(settled(*simulation).target_rate == 0.0);
}

TEST_CASE("A simulator that cannot keep up makes every step and says how slow it is") {
  RecordingSimulator simulator;
  simulator.dt_s = 1e-3;
  simulator.stepCost_us = 5000;
  const auto simulation = start(simulator);
  simulation->transport(C3DE_TRANSPORT_PLAY);
  std::this_thread::sleep_for(500ms);
  simulation->transport(C3DE_TRANSPORT_PAUSE);
  const c3de_sim_transport state = settled(*simulation);
  CHECK(state.real_time_factor > 0.0);
  CHECK(state.real_time_factor < 0.25);
  CHECK(state.step_ms >= 5.0);
  CHECK_THAT(state.time_s, WithinAbs(static_cast<double>(simulator.totalSteps) * 1e-3, 1e-9));
  // No burst afterwards: lost time is not made up for.
  simulator.stepCost_us = 0;
  const std::uint64_t before = simulator.steps;
  simulation->transport(C3DE_TRANSPORT_PLAY);
  std::this_thread::sleep_for(100ms);
  simulation->transport(C3DE_TRANSPORT_PAUSE);
  CHECK(settled(*simulation).steps < before + 260);
}

TEST_CASE("The state can be read at once while a step takes long") {
  RecordingSimulator simulator;
  simulator.stepCost_us = 700000;
  const auto simulation = start(simulator);
  simulation->transport(C3DE_TRANSPORT_STEP);
  std::this_thread::sleep_for(50ms);
  const auto begin = Clock::now();
  for (int i = 0; i < 1000; ++i) (void)simulation->state();
  CHECK(Clock::now() - begin < 100ms);
  CHECK(simulator.steps == 0);  // the step is still being computed
}

TEST_CASE("Snapshots are published often enough to be smooth and not more") {
  RecordingSimulator simulator;
  const auto simulation = start(simulator);
  simulation->transport(C3DE_TRANSPORT_PLAY);
  REQUIRE(eventually([&] { return simulation->state().steps > 0; }));
  const std::uint64_t before = simulator.publishes;
  const auto begin = Clock::now();
  std::this_thread::sleep_for(400ms);
  const auto published = static_cast<double>(simulator.publishes - before);
  const double wall_s = std::chrono::duration<double>(Clock::now() - begin).count();
  CHECK(published <= wall_s / 0.008 + 1.0);
  CHECK(published > 5.0);
}

TEST_CASE("A world with nothing to compute does not burn the processor") {
  RecordingSimulator simulator;
  simulator.standsStill = true;
  const auto simulation = start(simulator);
  simulation->setTargetRate(0.0);
  simulation->transport(C3DE_TRANSPORT_PLAY);
  std::this_thread::sleep_for(200ms);
  CHECK(simulator.totalSteps < 60);
  CHECK(simulator.totalSteps > 0);
}

TEST_CASE("A quasi-static solution goes through its load steps as fast as it can and then pauses") {
  RecordingSimulator simulator;
  simulator.finishesAtStep = 300;
  const auto simulation = start(simulator);
  const auto begin = Clock::now();
  simulation->transport(C3DE_TRANSPORT_PLAY);
  REQUIRE(eventually([&] { return settled(*simulation).mode == C3DE_SIM_PAUSED; }));
  // At one step per frame it would take 2.4 s.
  CHECK(Clock::now() - begin < 1500ms);
  CHECK(simulator.steps == 300);
  CHECK(simulator.publishedStep == 300);
  // Play has nothing left to do and terminates; reset starts again.
  simulation->transport(C3DE_TRANSPORT_PLAY);
  REQUIRE(eventually([&] { return settled(*simulation).mode == C3DE_SIM_PAUSED; }));
  CHECK(simulator.totalSteps <= 302);
  simulation->transport(C3DE_TRANSPORT_RESET);
  simulation->transport(C3DE_TRANSPORT_STEP);
  CHECK(settled(*simulation).steps == 1);
}

TEST_CASE("The state that a listener reads is that of the snapshot") {
  RecordingSimulator simulator;
  const auto simulation = start(simulator);
  simulation->transport(C3DE_TRANSPORT_STEP);
  REQUIRE(settled(*simulation).steps == 1);
  std::atomic<int> heard{0}, outdated{0};
  simulation->setPublishedListener([&] {
    ++heard;
    if (simulation->state().steps != simulator.steps) ++outdated;
  });
  simulation->transport(C3DE_TRANSPORT_RESET);
  CHECK(eventually([&] { return heard > 0; }));
  simulation->setPublishedListener({});
  CHECK(simulator.steps == 0);
  CHECK(outdated == 0);
}

TEST_CASE("The listener hears every snapshot until it is taken away") {
  RecordingSimulator simulator;
  const auto simulation = start(simulator);
  std::atomic<int> heard{0};
  simulation->setPublishedListener([&] { ++heard; });
  simulation->transport(C3DE_TRANSPORT_STEP);
  CHECK(eventually([&] { return heard > 0; }));
  simulation->setPublishedListener({});
  const int before = heard;
  simulation->transport(C3DE_TRANSPORT_STEP);
  settled(*simulation);
  settled(*simulation);
  CHECK(heard == before);
}

TEST_CASE("Ending a simulation is quick while it plays, and runs what was posted") {
  RecordingSimulator simulator;
  bool ran = false;
  auto simulation = start(simulator);
  simulation->setTargetRate(1e-9);  // the next step is due in years
  simulation->transport(C3DE_TRANSPORT_PLAY);
  settled(*simulation);
  simulation->post([&] { ran = true; });
  const auto begin = Clock::now();
  simulation.reset();
  CHECK(Clock::now() - begin < 500ms);
  CHECK(ran);
  CHECK(simulator.references() == 1);
}

TEST_CASE("Many threads may command and look at once") {
  RecordingSimulator simulator;
  const auto simulation = start(simulator);
  std::vector<std::thread> threads;
  std::atomic<int> ran{0};
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&, t] {
      for (int i = 0; i < 100; ++i) {
        simulation->transport(1u + static_cast<std::uint32_t>((t + i) % 5));
        simulation->post([&] { ++ran; });
        (void)simulation->state();
        (void)simulation->failure();
        simulation->setTargetRate(i % 3);
      }
    });
  for (std::thread &thread : threads) thread.join();
  simulation->transport(C3DE_TRANSPORT_STOP);
  const c3de_sim_transport state = settled(*simulation);
  CHECK(ran == 400);
  CHECK(state.mode == C3DE_SIM_STOPPED);
  CHECK(state.steps == 0);
}

TEST_CASE("Reset, stop, pause and the end come through within a step that takes long") {
  RecordingSimulator simulator;
  simulator.stepCost_us = 20'000'000;
  const auto begin = Clock::now();
  {
    const auto simulation = start(simulator);
    simulation->transport(C3DE_TRANSPORT_PLAY);
    REQUIRE(eventually([&] { return simulation->state().step_running_s > 0.0; }));

    simulation->transport(C3DE_TRANSPORT_RESET);
    REQUIRE(eventually([&] { return simulator.resets == 1; }));
    CHECK(simulator.endedSteps == 1);
    // It continues to play, and the request is cleared.
    REQUIRE(eventually([&] { return simulation->state().step_running_s > 0.0; }));
    CHECK(simulator.interrupted == false);

    simulation->transport(C3DE_TRANSPORT_PAUSE);
    REQUIRE(eventually([&] { return simulation->state().mode == C3DE_SIM_PAUSED; }));
    CHECK(simulation->failure().empty());
    CHECK(simulation->state().steps == 0);

    // A pending step before a stop is not computed first.
    simulation->post([] { std::this_thread::sleep_for(50ms); });
    simulation->transport(C3DE_TRANSPORT_STEP);
    simulation->transport(C3DE_TRANSPORT_STEP);
    simulation->transport(C3DE_TRANSPORT_STOP);
    CHECK(settled(*simulation).mode == C3DE_SIM_STOPPED);
    CHECK(simulator.totalSteps == 0);

    simulation->transport(C3DE_TRANSPORT_PLAY);
    REQUIRE(eventually([&] { return simulation->state().step_running_s > 0.0; }));
  }
  CHECK(simulator.interrupted == false);
  CHECK(Clock::now() - begin < 10s);  // a single step takes 20

  // Afterwards steps are computed as before.
  simulator.stepCost_us = 0;
  const auto again = start(simulator);
  again->transport(C3DE_TRANSPORT_STEP);
  CHECK(settled(*again).steps == 1);
}

TEST_CASE("A simulator that cannot end its step makes it before anything else happens") {
  RecordingSimulator simulator;
  simulator.hasInterrupt = false;
  simulator.stepCost_us = 200'000;
  const auto simulation = start(simulator);
  simulation->transport(C3DE_TRANSPORT_STEP);
  REQUIRE(eventually([&] { return simulation->state().step_running_s > 0.0; }));
  simulation->transport(C3DE_TRANSPORT_RESET);
  (void)settled(*simulation);
  CHECK(simulator.totalSteps == 1);
  CHECK(simulator.endedSteps == 0);
  CHECK(simulator.resets == 1);
}

TEST_CASE("A step that takes long is told while it lasts, and the rates are those of now") {
  RecordingSimulator simulator;
  simulator.dt_s = 0.01;
  const auto simulation = start(simulator);
  simulation->setTargetRate(0.0);
  simulator.stepCost_us = 2'000;
  simulation->transport(C3DE_TRANSPORT_PLAY);
  REQUIRE(eventually([&] { return simulation->state().real_time_factor > 1.0; }));
  simulator.stepCost_us = 20'000'000;
  REQUIRE(eventually([&] { return simulation->state().step_running_s > 0.3; }));
  const c3de_sim_transport soon = simulation->state();
  CHECK(soon.mode == C3DE_SIM_PLAYING);
  CHECK(simulation->activity() == "a heavy body: less of it would help");
  REQUIRE(eventually([&] { return simulation->state().step_running_s > 1.2; }));
  const c3de_sim_transport late = simulation->state();
  CHECK(late.real_time_factor < soon.real_time_factor);
  CHECK(late.real_time_factor == 0.0);  // no result for more than a second
  CHECK(late.step_ms >= 1200.0);
}

TEST_CASE("A step that is given up pauses, is told once, and is tried again when somebody plays") {
  RecordingSimulator simulator;
  simulator.failAtStep = 4;
  simulator.failStatus = C3DE_E_TIMEOUT;
  const auto simulation = start(simulator);
  simulation->setTargetRate(0.0);
  simulation->transport(C3DE_TRANSPORT_PLAY);
  REQUIRE(eventually([&] { return simulation->state().mode == C3DE_SIM_PAUSED; }));
  CHECK(simulation->state().steps == 3);
  CHECK(simulation->failure().empty());
  CHECK(simulation->abortedSteps().steps == 1);
  simulation->transport(C3DE_TRANSPORT_PLAY);
  REQUIRE(eventually([&] { return simulation->abortedSteps().steps == 2; }));
  simulator.failAtStep = 0;
  simulation->transport(C3DE_TRANSPORT_PLAY);
  REQUIRE(eventually([&] { return simulation->state().steps > 10; }));
  CHECK(simulation->abortedSteps().steps == 2);
}
