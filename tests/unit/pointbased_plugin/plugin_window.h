// SPDX-License-Identifier: Apache-2.0
// The panel and the tools of the plugin in a session without a window.
#pragma once

#include <fmt/format.h>

#include <array>
#include <chrono>
#include <fstream>
#include <map>
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

namespace plugin_tests {

using namespace c3de;
using namespace c3de::session;
namespace fs = std::filesystem;

/// The registries of a window, a paused simulation of a soft cube above a plate, and its panel and tools.
class Window {
 public:
  /// @param more  of the scene file, after the body and the obstacle
  explicit Window(const std::string &integrator, const std::string &more = {}) {
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
                                       "[[obstacle]]\nname = \"plate\"\nmesh = \"plate.obj\"\n" +
                                       more,
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
  /// The mouse above a point of the xy plane, mm, seen along -z; a pixel is a millimetre.
  bool mouse(std::uint32_t type, double x, double y, std::uint32_t modifiers = 0) {
    c3de_event event{};
    event.size = sizeof event;
    event.type = type;
    event.button = event.buttons = C3DE_BUTTON_LEFT;
    event.modifiers = modifiers;
    event.x_px = 500.0 + x;
    event.y_px = 500.0 - y;
    event.ray_origin_mm[0] = x;
    event.ray_origin_mm[1] = y;
    event.ray_origin_mm[2] = 400.0;
    event.ray_direction[2] = event.view_direction[2] = -1.0;
    event.inside_mm = -1.0;
    return tools_.dispatch(event);
  }
  bool key(std::uint32_t key) {
    c3de_event event{};
    event.size = sizeof event;
    event.type = C3DE_EVENT_KEY;
    event.key = key;
    return tools_.dispatch(event);
  }
  /// The mouse in the axial slice of a height, mm; its pixels are millimetres.
  bool mouseInSlice(std::uint32_t type, double x, double y, double z) {
    c3de_event event{};
    event.size = sizeof event;
    event.type = type;
    event.button = event.buttons = C3DE_BUTTON_LEFT;
    event.x_px = 500.0 + x;
    event.y_px = 500.0 + y;
    event.ray_origin_mm[0] = x;
    event.ray_origin_mm[1] = y;
    event.ray_origin_mm[2] = z;
    event.ray_direction[2] = event.view_direction[2] = 1.0;
    event.where = C3DE_IN_AXIAL;
    event.inside_mm = -1.0;
    return tools_.dispatch(event);
  }
  void cancelTool() { tools_.cancelActive(); }
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
    fs::remove(file);  // with mingw-w64 copying over a file that exists fails, whatever the options
    fs::copy_file(folder_ / "implant.obj", file);
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
  [[nodiscard]] scene::SceneGraph &nodes() { return session_->sceneGraph(); }
  [[nodiscard]] Session &session() { return *session_; }

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

}  // namespace plugin_tests
