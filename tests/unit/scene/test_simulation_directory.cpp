// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "c3de/scene/simulation_directory.h"
#include "support/catch.h"
#include "support/recording_simulator.h"

using namespace c3de;
using scene::Simulation;
using scene::SimulationDirectory;
using test::RecordingSimulator;

namespace {

template <class Condition>
bool eventually(Condition &&condition) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

std::shared_ptr<Simulation> made(RecordingSimulator &simulator) {
  return std::move(*Simulation::create(simulator.object()));
}

}  // namespace

TEST_CASE("Who watches is told of simulations that are there, that come and that go") {
  RecordingSimulator first, second;
  SimulationDirectory directory;
  const Handle a{1, 7}, b{2, 7};
  directory.add(a, "liver", made(first));
  std::vector<std::string> told;
  const Handle watch = directory.watch({"test",
                                        [&](Handle node) { told.push_back("+" + std::to_string(node.index)); },
                                        [&](Handle node) { told.push_back("-" + std::to_string(node.index)); },
                                        {}});
  CHECK(told == std::vector<std::string>{"+1"});
  directory.add(b, "spleen", made(second));
  REQUIRE(directory.all().size() == 2);
  CHECK(directory.all()[1].title == "spleen");
  directory.remove(a);
  CHECK(told == std::vector<std::string>{"+1", "+2", "-1"});
  CHECK(directory.unwatch(watch, "another") == SimulationDirectory::Removal::stale);
  CHECK(directory.unwatch(watch, "test") == SimulationDirectory::Removal::done);
  directory.remove(b);
  CHECK(told.size() == 3);
}

TEST_CASE("Steps are told on the simulation's thread, and after the watch has gone no more") {
  RecordingSimulator simulator;
  SimulationDirectory directory;
  const Handle node{1, 7};
  const auto simulation = made(simulator);
  simulation->setAfterStep([&](const c3de_sim_status &status) { directory.stepped(node, status); });
  directory.add(node, "liver", simulation);
  std::atomic<std::uint64_t> last{0}, calls{0};
  std::atomic<bool> elsewhere{true}, refused{false};
  Handle watch;
  const auto here = std::this_thread::get_id();
  watch = directory.watch({"test", {}, {}, [&](Handle, const c3de_sim_status &status) {
                             if (std::this_thread::get_id() == here) elsewhere = false;
                             refused = directory.unwatch(watch, "test") == SimulationDirectory::Removal::fromStepped;
                             last = status.steps;
                             ++calls;
                           }});
  simulation->setTargetRate(0.0);
  simulation->transport(C3DE_TRANSPORT_PLAY);
  REQUIRE(eventually([&] { return calls > 20; }));
  CHECK(elsewhere);
  CHECK(refused);
  CHECK(last > 0);
  REQUIRE(directory.unwatch(watch, "test") == SimulationDirectory::Removal::done);
  const std::uint64_t then = calls;
  const std::uint64_t steps = simulator.totalSteps;
  REQUIRE(eventually([&] { return simulator.totalSteps > steps + 20; }));
  CHECK(calls == then);
  directory.remove(node);
}

TEST_CASE("A simulation that its caller steps runs what was posted before a step and tells after it") {
  RecordingSimulator simulator;
  auto created = Simulation::createForCaller(simulator.object());
  REQUIRE(created);
  Simulation &simulation = **created;
  CHECK(simulation.isSteppedByCaller());
  std::vector<std::string> order;
  simulation.setBeforeStep([&]() -> Expected<void> {
    order.push_back("before");
    if (order.size() > 4) return fail(ErrorCode::plugin, "no more");
    return {};
  });
  simulation.setAfterStep(
      [&](const c3de_sim_status &status) { order.push_back("after " + std::to_string(status.steps)); });
  simulation.post([&] { order.push_back("posted"); });
  simulation.transport(C3DE_TRANSPORT_PLAY);  // of no effect
  CHECK(order.empty());
  REQUIRE(simulation.beginStep());
  REQUIRE(simulation.table()->step(simulation.object()) == C3DE_OK);
  simulation.endStep();
  CHECK(order == std::vector<std::string>{"posted", "before", "after 1"});
  CHECK(simulation.state().steps == 1);
  bool called = false;
  simulation.call([&] { called = true; });
  CHECK(called);
  REQUIRE(simulation.beginStep());
  const auto refused = simulation.beginStep();
  REQUIRE_FALSE(refused);
  CHECK(refused.error().message == "no more");
  // Pending functions run before it is destroyed.
  simulation.post([&] { order.push_back("last"); });
  created->reset();
  CHECK(order.back() == "last");
  CHECK(simulator.references() == 1);
}
