// SPDX-License-Identifier: Apache-2.0
// Undo and redo of what the panel and the tools of the plugin do, in a session without a window.
#include <fmt/format.h>

#include <array>
#include <chrono>
#include <fstream>
#include <map>
#include <random>
#include <thread>

#include "box_mesh.h"
#include "c3de/core/platform.h"
#include "c3de/geometry/mesh_writer.h"
#include "c3de/registry/command_registry.h"
#include "c3de/registry/edit_list.h"
#include "c3de/registry/panel_registry.h"
#include "c3de/registry/parameter_registry.h"
#include "c3de/registry/settings_store.h"
#include "c3de/registry/text_panel.h"
#include "c3de/registry/tool_registry.h"
#include "c3de/render/renderer.h"
#include "c3de/session/saved_session.h"
#include "c3de/session/session.h"
#include "c3de/ui/edit_history.h"
#include "support/catch.h"
#include "support/environment.h"
#include "support/folders.h"

using namespace c3de;
using namespace c3de::session;
namespace fs = std::filesystem;

namespace {

/// The registries of a window, a paused simulation of a soft cube above a plate, and its panel and tools.
class Window {
 public:
  explicit Window(const std::string &integrator) {
    REQUIRE(geometry::writeMesh(folder_ / "cube.obj", session::test::boxMesh({-50, -50, -50}, {50, 50, 50})));
    REQUIRE(geometry::writeMesh(folder_ / "plate.obj", session::test::boxMesh({-150, -150, -80}, {150, 150, -60})));
    REQUIRE(geometry::writeMesh(folder_ / "implant.obj", session::test::boxMesh({-10, -10, -10}, {10, 10, 10})));
    registry::keepSettingsInMemory();
    SessionOptions options;
    options.searchPlugins = false;
    options.pluginFiles = {fs::path(testPluginFolder()) / ("pointbased" + std::string(pluginExtension()))};
    options.threads = 1;
    options.renderer = renderer_.get();
    options.panels = &panels_;
    options.parameters = &parameters;
    options.tools = &tools_;
    options.edits = &edits;
    options.commands = &commands_;
    auto created = Session::create(options);
    if (!created) FAIL(created.error().message);
    session_ = std::move(*created);
    tools_.setMarkedPoint([this] { return marked_; });
    auto scene = scene::parseScene("format = 1\n[world]\ngravity = [0, 0, 0]\n[solver]\nintegrator = \"" + integrator +
                                       "\"\n[[body]]\nname = \"cube\"\nmesh = \"cube.obj\"\n"
                                       "material = { youngs_modulus = 2e4 }\nsampling = { count = 60 }\n"
                                       "[[obstacle]]\nname = \"plate\"\nmesh = \"plate.obj\"\n",
                                   folder_ / "scene.toml", nullptr);
    if (!scene) FAIL(scene.error().message);
    auto simulator = session_->createSimulator();
    if (!simulator) FAIL(simulator.error().message);
    const auto populated = session_->populate(*simulator, *scene, {});
    if (!populated) FAIL(populated.error().message);
    const auto adopted = session_->adopt(*simulator, "undo", {std::make_shared<const scene::SceneFile>(*scene)});
    (*simulator)->vt->release(*simulator);
    if (!adopted) FAIL(adopted.error().message);
    flush();
    step();
  }
  ~Window() { session_.reset(); }
  Window(const Window &) = delete;
  Window &operator=(const Window &) = delete;

  void frame() {
    session_->mainQueue().runFrame();
    for (const Handle handle : panels_.handles())
      if (registry::Panel *panel = panels_.find(handle)) panel_.draw(*panel);
    history.follow(&parameters, nullptr, &edits);
  }
  /// Until the simulation has executed what was posted, and the panel shows its snapshot.
  void flush() {
    for (int i = 0; i < 2; ++i) session_->simulation()->call([] {});
    frame();
  }
  template <class Condition>
  void wait(const char *what, const Condition &condition) {
    const auto begin = std::chrono::steady_clock::now();
    while (!condition()) {
      INFO(what);
      REQUIRE(std::chrono::steady_clock::now() - begin < std::chrono::seconds(60));
      std::this_thread::sleep_for(std::chrono::microseconds(200));
      frame();
    }
  }
  void step() {
    const std::uint64_t before = session_->simulation()->state().steps;
    session_->simulation()->transport(C3DE_TRANSPORT_STEP);
    wait("a step", [&] { return session_->simulation()->state().steps != before; });
    flush();
  }
  [[nodiscard]] std::uint64_t steps() const { return session_->simulation()->state().steps; }
  void finishJobs() {
    wait("a job", [this] { return session_->jobs().running().empty(); });
    flush();
  }

  void activate(const std::string &id) {
    for (const auto &[handle, tool] : tools_.tools())
      if (tool->id == id && tools_.active() != handle) REQUIRE(tools_.activate(handle));
  }
  /// The mouse above a point of the xy plane, mm, seen along -z.
  bool mouse(std::uint32_t type, double x, double y) {
    c3de_event event{};
    event.size = sizeof event;
    event.type = type;
    event.button = event.buttons = C3DE_BUTTON_LEFT;
    event.ray_origin_mm[0] = x;
    event.ray_origin_mm[1] = y;
    event.ray_origin_mm[2] = 400.0;
    event.ray_direction[2] = event.view_direction[2] = -1.0;
    event.inside_mm = -1.0;
    return tools_.dispatch(event);
  }
  /// False: the tool found nothing there.
  bool drag(const std::string &tool, double x, double y, double dx, double dy, int stepsWhileHeld) {
    activate(tool);
    flush();
    if (!mouse(C3DE_EVENT_PRESS, x, y)) return false;
    flush();
    mouse(C3DE_EVENT_MOVE, x + dx, y + dy);
    flush();
    for (int i = 0; i < stepsWhileHeld; ++i) step();
    mouse(C3DE_EVENT_RELEASE, x + dx, y + dy);
    flush();
    return true;
  }
  bool edit(const std::string &id, const ParameterValue &value) {
    for (const Handle set : parameters.ownedBy("c3de.pointbased"))
      for (const ParameterDecl &decl : parameters.find(set)->decls)
        if (decl.id == id) {
          ParameterValue of = value;
          of.id = id;
          of.type = decl.type;
          const auto edited = parameters.edit(set, of);
          INFO((edited ? "" : edited.error().message));
          REQUIRE(edited.has_value());
          parameters.history().endGesture();
          flush();
          return true;
        }
    return false;
  }
  void addImplant(const Vec3 &at_mm) {
    marked_ = at_mm;
    activate("pointbased.move");
    // The panel reads a file when its name changes.
    const fs::path file = folder_ / fmt::format("implant{}.obj", ++implants_);
    fs::copy_file(folder_ / "implant.obj", file, fs::copy_options::overwrite_existing);
    panel_.setText("obstacle_browse", file.string());
    frame();
    finishJobs();
    panel_.press("obstacle_add");
    frame();
    finishJobs();
  }
  bool removeImplant(const Vec3 &at_mm) {
    activate("pointbased.move");
    flush();
    if (!mouse(C3DE_EVENT_PRESS, at_mm[0], at_mm[1])) return false;
    mouse(C3DE_EVENT_RELEASE, at_mm[0], at_mm[1]);
    flush();
    panel_.press("obstacle_remove");
    frame();
    flush();
    return true;
  }

  [[nodiscard]] registry::TextPanel &panel() { return panel_; }

  /// What a user means by the state: hash and time of the simulation, what the panel shows.
  struct State {
    std::uint64_t hash = 0, steps = 0;
    std::map<std::string, std::string> shown;
    friend bool operator==(const State &, const State &) = default;
  };
  State state() {
    flush();
    State out;
    session_->simulation()->call([&] {
      scene::Simulation &simulation = *session_->simulation();
      simulation.table()->state_hash(simulation.object(), &out.hash);
    });
    out.steps = steps();
    parameters.forEach([&](const registry::ParameterSet &set) {
      for (const ParameterValue &value : set.values) out.shown[set.title + "/" + value.id] = value.display();
    });
    return out;
  }
  /// As a replay does: not by the panel.
  void setWorldOutside(const std::string &id, const Vec3 &vec) {
    session_->simulation()->call([&] {
      c3de_param_value value{};
      value.size = sizeof value;
      value.type = C3DE_PARAM_VEC3;
      value.id = {id.data(), id.size()};
      for (std::size_t i = 0; i < 3; ++i) value.vec[i] = vec[i];
      scene::Simulation &simulation = *session_->simulation();
      REQUIRE(simulation.table()->set_world(simulation.object(), &value, 1, sizeof value) >= 0);
    });
    flush();
  }
  [[nodiscard]] Vec3 shown(const std::string &id) {
    for (const Handle set : parameters.ownedBy("c3de.pointbased"))
      for (const ParameterValue &value : parameters.find(set)->values)
        if (value.id == id) return value.vec;
    FAIL("no such parameter");
    return {};
  }
  [[nodiscard]] std::size_t undoCount() { return edits.undoCount() + parameters.history().undoCount(); }
  void undo() {
    history.undo();
    flush();
  }
  void redo() {
    history.redo();
    flush();
  }
  /// What a session saves now, opened again: its hash, and that after five further steps.
  [[nodiscard]] std::array<std::uint64_t, 2> hashWhenReopened() {
    Expected<CapturedState> captured = fail(ErrorCode::internal, "not captured");
    session_->simulation()->call([&] {
      const auto identity = session_->chooseSimulator({});
      if (identity)
        captured = captureState(*session_, session_->simulation()->object(), *identity, *session_->changes());
    });
    if (!captured) FAIL(captured.error().message);
    auto simulator = session_->createSimulator();
    REQUIRE(simulator);
    const auto populated =
        session_->populate(*simulator, *std::get<SharedScene>(captured->source.front()), {}, nullptr);
    if (!populated) FAIL(populated.error().message);
    const auto built = buildRemaining(*session_, *simulator, captured->source, {}, nullptr);
    if (!built) FAIL(built.error().message);
    SessionFile saved;
    saved.state = captured->state;
    saved.stateHash = captured->hash;
    saved.steps = captured->steps;
    const auto restored = restoreSession(*session_, *simulator, captured->identity, saved, "undo.c3de");
    if (!restored) FAIL(restored.error().message);
    std::array<std::uint64_t, 2> hashes{};
    const c3de_simulator_v1 *table = session_->simulation()->table();
    table->state_hash(*simulator, hashes.data());
    for (int i = 0; i < 5; ++i) REQUIRE(table->step(*simulator) >= 0);
    table->state_hash(*simulator, &hashes[1]);
    (*simulator)->vt->release(*simulator);
    return hashes;
  }

  registry::ParameterRegistry parameters;
  registry::EditList edits;
  ui::EditHistory history;

 private:
  fs::path folder_ = testOutputFolder();
  ScopedEnvironment home_{"C3DE_HOME", (folder_ / "home").string()};
  std::unique_ptr<render::Renderer> renderer_ = render::createNullRenderer();
  registry::PanelRegistry panels_;
  registry::ToolRegistry tools_;
  registry::CommandRegistry commands_;
  registry::TextPanel panel_{&parameters};
  Vec3 marked_{};
  int implants_ = 0;
  std::unique_ptr<Session> session_;
};

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
