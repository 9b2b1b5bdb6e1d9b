// SPDX-License-Identifier: Apache-2.0
// Undo and redo of what the panel and the tools of the plugin do, in a session without a window.
#include <array>
#include <map>
#include <random>

#include "plugin_window.h"

using namespace plugin_tests;

namespace {

/// Makes random changes, so that one more step of undo exists after each.
class Changer {
 public:
  Changer(Window &window, bool withImplants) : window_(window), withImplants_(withImplants) {}
  /// @return the kind; empty: nothing was changed
  std::string change() {
    const std::size_t before = window_.undoCount();
    std::string kind = tryChange();
    if (window_.undoCount() == before) return {};
    CHECK(window_.undoCount() == before + 1);
    return kind;
  }

 private:
  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(random_()) / static_cast<double>(std::mt19937::max());
  }
  std::string tryChange() {
    const double kind = uniform(0.0, 1.0);
    ParameterValue value;
    if (kind < 0.25) {
      value.num = std::round(uniform(1e4, 4e4));
      window_.edit("material.youngs_modulus", value);
      return "parameter of the body";
    }
    if (kind < 0.45) {
      value.vec = {uniform(-0.5, 0.5), uniform(-0.5, 0.5), uniform(-0.5, 0.5)};
      window_.edit("world.gravity", value);
      return "parameter of the world";
    }
    if (kind < 0.75) {
      window_.drag("pointbased.pinch", uniform(-20, 20), uniform(-20, 20), uniform(-5, 5), uniform(-5, 5), 1);
      return "pull";
    }
    if (kind < 0.9 || !withImplants_) {
      window_.drag("pointbased.move", uniform(110, 130), uniform(-130, 130), uniform(-4, 4), uniform(-4, 4), 0);
      return "move";
    }
    if (implants_.size() < 3) {
      const Vec3 at{300.0 + 60.0 * static_cast<double>(placed_++ % 8), uniform(-200, 200), 0.0};
      window_.addImplant(at);
      implants_.push_back(at);
      return "add";
    }
    const Vec3 at = implants_.front();
    implants_.erase(implants_.begin());
    window_.removeImplant(at);
    return "remove";
  }

  Window &window_;
  bool withImplants_;
  std::mt19937 random_{20261128};
  std::vector<Vec3> implants_;
  int placed_ = 0;
};

/// Resident memory of this process, bytes; 0: not known here.
std::size_t residentBytes() {
  std::ifstream in("/proc/self/statm");
  std::size_t all = 0, resident = 0;
  return in >> all >> resident ? resident * 4096 : 0;
}

}  // namespace

TEST_CASE("1000 random changes are undone and redone, with equal states at both ends", "[undo]") {
  Window window("explicit");
  Changer changer(window, false);
  const Window::State before = window.state();
  const auto hashesBefore = window.hashWhenReopened();
  CHECK(hashesBefore[0] == before.hash);
  const std::size_t memoryBefore = residentBytes();
  std::map<std::string, int> made;
  std::map<std::size_t, std::uint64_t> hashes;  // on the path, by the number of changes
  constexpr std::size_t kChanges = 1000;
  for (int tries = 0; window.undoCount() < kChanges; ++tries) {
    REQUIRE(tries < 2000);
    if (const std::string kind = changer.change(); !kind.empty()) ++made[kind];
    if (window.undoCount() % 100 == 0) hashes[window.undoCount()] = window.state().hash;
  }
  for (const auto &[kind, count] : made) UNSCOPED_INFO(kind << ": " << count);
  CHECK(made["parameter of the body"] > 150);
  CHECK(made["parameter of the world"] > 100);
  CHECK(made["pull"] > 200);
  CHECK(made["move"] > 80);
  const Window::State after = window.state();
  CHECK(after.hash != before.hash);
  const auto hashesAfter = window.hashWhenReopened();
  CHECK(hashesAfter[0] == after.hash);

  std::size_t undone = 0, differing = 0;
  for (; !window.history.undoLabel().empty(); ++undone) {
    REQUIRE(undone < kChanges);
    if (const auto known = hashes.find(kChanges - undone);
        known != hashes.end() && window.state().hash != known->second)
      ++differing;
    window.undo();
  }
  CHECK(undone == kChanges);
  CHECK(differing == 0);
  const Window::State atBegin = window.state();
  CHECK(atBegin.hash == before.hash);
  CHECK(atBegin.steps == before.steps);
  CHECK(atBegin.shown == before.shown);
  CHECK(window.hashWhenReopened() == hashesBefore);

  std::size_t redone = 0;
  for (; !window.history.redoLabel().empty(); ++redone) {
    REQUIRE(redone < kChanges);
    window.redo();
  }
  CHECK(redone == kChanges);
  const Window::State atEnd = window.state();
  CHECK(atEnd.hash == after.hash);
  CHECK(atEnd.steps == after.steps);
  CHECK(atEnd.shown == after.shown);
  CHECK(window.hashWhenReopened() == hashesAfter);

  CHECK(window.edits.bytes() <= registry::EditList::kBudget);
  CHECK(window.parameters.history().bytes() <= registry::ParameterHistory::kBudget);
  constexpr std::size_t kStates = std::size_t{256} << 20;  // of the plugin's tools
  const std::size_t memory = residentBytes();
  WARN("memory of 1000 changes: " << (memory > memoryBefore ? (memory - memoryBefore) >> 20 : 0) << " MiB");
  if (memory > memoryBefore)
    CHECK(memory - memoryBefore < kStates + registry::EditList::kBudget + registry::ParameterHistory::kBudget);
}

TEST_CASE("Implants that are added and removed are undone and redone among parameters", "[undo]") {
  Window window("explicit");
  const Window::State before = window.state();
  ParameterValue value;
  std::vector<Window::State> states{before};
  for (int i = 0; i < 6; ++i) {
    const Vec3 at{300.0 + 60.0 * i, 20.0 * i, 0.0};
    window.addImplant(at);
    states.push_back(window.state());
    value.num = 3e4 + 100.0 * i;
    window.edit("material.youngs_modulus", value);
    states.push_back(window.state());
    if (i % 2 == 1) {
      REQUIRE(window.removeImplant(at));
      states.push_back(window.state());
    }
    REQUIRE(window.undoCount() == states.size() - 1);
  }
  for (std::size_t i = states.size() - 1; i-- > 0;) {
    INFO("undone: " << window.history.undoLabel());
    window.undo();
    const Window::State now = window.state();
    CHECK(now.hash == states[i].hash);
    CHECK(now.shown == states[i].shown);
  }
  CHECK(window.history.undoLabel().empty());
  for (std::size_t i = 1; i < states.size(); ++i) {
    INFO("redone: " << window.history.redoLabel());
    window.redo();
    CHECK(window.state().hash == states[i].hash);
  }
  CHECK(window.history.redoLabel().empty());
}

TEST_CASE("The panel shows values of the world that are set outside of it, and Undo in quick succession", "[undo]") {
  Window window("explicit");
  ParameterValue value;
  value.vec = {0.0, 0.0, -1.0};
  window.setWorldOutside("world.gravity", value.vec);
  CHECK(window.shown("world.gravity") == value.vec);
  // Edits that the simulation has not executed yet are not taken back by the values before them.
  value.vec = {0.0, 0.0, -2.0};
  window.edit("world.gravity", value);
  value.vec = {0.0, 0.0, -3.0};
  window.edit("world.gravity", value);
  for (int i = 0; i < 20; ++i) {
    window.history.undo();
    window.frame();
    window.history.redo();
    window.frame();
  }
  window.flush();
  CHECK(window.shown("world.gravity") == value.vec);
  CHECK(window.undoCount() == 2);
}

TEST_CASE(
    "the simple mode of the panel has what comes first, accuracy is in both modes, and no state depends on them") {
  Window window("explicit");
  const auto has = [&](const char *id) { return window.panel().find(id) != nullptr; };
  const auto statesAccuracy = [&] {
    return window.panel().value("Displacement") && window.panel().value("Stress and strain") &&
           window.panel().value("Singular regions");
  };
  const Window::State before = window.state();
  for (const char *id : {"play", "material.youngs_modulus", "world.gravity", "accuracy.error_mm", "hold", "verify"}) {
    INFO(id);
    CHECK(has(id));
  }
  CHECK(statesAccuracy());
  CHECK_FALSE(has("solver.dt"));
  CHECK_FALSE(has("material.density"));
  CHECK_FALSE(window.panel().value("State hash"));

  window.panel().press("view.mode.all");
  window.frame();
  window.frame();
  for (const char *id : {"play", "material.youngs_modulus", "world.gravity", "accuracy.error_mm", "verify", "solver.dt",
                         "material.density", "pinch"}) {
    INFO(id);
    CHECK(has(id));
  }
  CHECK(statesAccuracy());
  CHECK_FALSE(has("hold"));
  CHECK(window.panel().value("State hash"));
  CHECK(window.state() == before);

  window.panel().press("view.mode.simple");
  window.frame();
  window.frame();
  CHECK(has("hold"));
  CHECK_FALSE(has("solver.dt"));
}
