// SPDX-License-Identifier: Apache-2.0
// Random use of what a plugin registers, as users would operate it.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>

#include "c3de/abi/iface/simulator.h"
#include "c3de/abi/tools.h"
#include "c3de/core/text.h"
#include "c3de/registry/text_panel.h"
#include "c3de/scene/simulation.h"
#include "check.h"
#include "trial.h"

namespace c3de::validate {
namespace {

constexpr int kEvents = 300, kSurfaces = 30;

Verdict ofEvents(const LoadedPlugin &loaded, int events) {
  const Verdict said = loaded.complaints();
  return said.result == Result::pass ? pass(fmt::format("{} events", events)) : said;
}

double numberWithin(const ParameterDecl &decl, Random &random) {
  const double low = std::isfinite(decl.min) ? decl.min : -1e6, high = std::isfinite(decl.max) ? decl.max : 1e6;
  switch (random.below(4)) {
    case 0: return decl.min;
    case 1: return decl.max;
    default: return low + random.unit() * (high - low);
  }
}

ParameterValue randomValue(const ParameterDecl &decl, Random &random) {
  ParameterValue value = decl.fallbackValue();
  value.num = numberWithin(decl, random);
  if (decl.type == C3DE_PARAM_I64) value.num = std::round(value.num);
  if (decl.type == C3DE_PARAM_BOOL) value.num = static_cast<double>(random.below(2));
  for (double &component : value.vec) component = numberWithin(decl, random);
  if (!decl.choices.empty()) {
    value.text = random.of(decl.choices);
  } else if (decl.type == C3DE_PARAM_TEXT) {
    const std::array<std::string, 5> texts{"", "a", std::string(10000, 'x'), "\xc3\xa4 \xe2\x82\xac", "%s%n"};
    value.text = random.of(texts);
  }
  return value;
}

Verdict parameters(const Trial &trial) {
  const LoadedPlugin loaded(trial, TrialHost::Serves::all);
  if (!loaded.refusal.empty()) return fail(loaded.refusal);
  registry::ParameterRegistry &registry = loaded.host->parameters;
  const std::vector<Handle> sets = registry.ownedBy(loaded.id());
  if (sets.empty()) return skip("it declares no parameters");
  Random random(trial.seed);
  std::string unlabelled;
  int taken = 0;
  for (const Handle set : sets) {
    const std::vector<ParameterDecl> decls = registry.find(set)->decls;
    for (const ParameterDecl &decl : decls) {
      if (decl.label.empty()) unlabelled += (unlabelled.empty() ? "" : ", ") + decl.id;
      if (const auto sound = checkParameter(decl, decl.fallbackValue()); !sound)
        return fail("its own default is refused: " + sound.error().message);
    }
    for (int i = 0; i < kEvents && !decls.empty(); ++i) {
      const ParameterDecl &decl = random.of(decls);
      taken += registry.edit(set, randomValue(decl, random)) ? 1 : 0;  // values that are not accepted never reach the
                                                                       // plugin
      if (i % 10 == 0) loaded.host->mainQueue.runFrame();
      if (registry.find(set) == nullptr) return warn("took its parameters back when one was changed");
    }
    while (!registry.history().undoLabel().empty()) registry.history().undo(registry);
  }
  loaded.host->mainQueue.runFrame();
  if (!unlabelled.empty()) return warn("parameters without a label: " + unlabelled);
  return ofEvents(loaded, taken);
}

void workWidget(registry::TextPanel &panel, const registry::TextPanel::Widget &widget, Random &random) {
  constexpr std::array kNumbers{0.0, -1.0, 1.0, 1e-300, -1e300, 1e300, 0.5, 1e9};
  const std::array<std::string, 5> texts{"", "auto", "\xe2\x82\xac", std::string(5000, 'y'), "../../x"};
  switch (random.below(4)) {
    case 0: return panel.press(widget.id);
    case 1: return panel.check(widget.id, random.below(2) == 1);
    case 2: return panel.setNumber(widget.id, random.of(kNumbers));
    default: return panel.setText(widget.id, random.of(texts));
  }
}

Verdict panels(const Trial &trial) {
  const LoadedPlugin loaded(trial, TrialHost::Serves::all);
  if (!loaded.refusal.empty()) return fail(loaded.refusal);
  if (loaded.host->panels.handles().empty()) return skip("it has no panels");
  Random random(trial.seed);
  registry::TextPanel text(&loaded.host->parameters);
  int events = 0;
  for (const Handle handle : loaded.host->panels.handles()) {
    for (int i = 0; i < kEvents; ++i, ++events) {
      const registry::Panel *panel = loaded.host->panels.find(handle);
      if (panel == nullptr) break;  // the plugin may remove its panel
      (void)text.draw(*panel);
      const auto &widgets = text.widgets();
      int open = 0;
      for (const auto &widget : widgets) open += widget.kind == "list" ? 1 : widget.kind == "list end" ? -1 : 0;
      if (open != 0) return warn("the panel " + panel->id + (open > 0 ? " does not end a list" : " ends a list twice"));
      if (!widgets.empty()) {
        const registry::TextPanel::Widget widget = random.of(widgets);
        workWidget(text, widget, random);
      }
      loaded.host->mainQueue.runFrame();
    }
  }
  return ofEvents(loaded, events);
}

c3de_event randomEvent(Random &random, std::uint32_t &buttons, double time_s) {
  c3de_event event{};
  event.size = sizeof event;
  event.type = 1 + static_cast<std::uint32_t>(random.below(5));
  event.button = 1u << random.below(3);
  if (event.type == C3DE_EVENT_PRESS) buttons |= event.button;
  if (event.type == C3DE_EVENT_RELEASE) buttons &= ~event.button;
  event.buttons = buttons;
  event.modifiers = static_cast<std::uint32_t>(random.below(8));
  event.key = event.type == C3DE_EVENT_KEY ? static_cast<std::uint32_t>(random.below(128)) : 0;
  event.x_px = random.unit() * 2000.0 - 500.0;
  event.y_px = random.unit() * 2000.0 - 500.0;
  event.wheel = event.type == C3DE_EVENT_WHEEL ? random.unit() * 20.0 - 10.0 : 0.0;
  event.ray_direction[random.below(3)] = random.below(2) == 0 ? 1.0 : -1.0;
  event.view_direction[2] = -1.0;
  for (double &origin : event.ray_origin_mm) origin = random.unit() * 2000.0 - 1000.0;
  event.time_s = time_s;
  event.where = static_cast<std::uint32_t>(random.below(4));  // events of slices reach only tools that request them
  return event;
}

Verdict tools(const Trial &trial) {
  const LoadedPlugin loaded(trial, TrialHost::Serves::all);
  if (!loaded.refusal.empty()) return fail(loaded.refusal);
  registry::ToolRegistry &registry = loaded.host->tools;
  if (registry.tools().empty()) return skip("it has no tools");
  Random random(trial.seed);
  std::uint32_t buttons = 0;
  for (int i = 0; i < kEvents; ++i) {
    const auto entries = registry.tools();
    if (entries.empty()) break;
    switch (random.below(12)) {
      case 0: (void)registry.activate(random.of(entries).handle); break;
      case 1: (void)registry.activate({}); break;
      case 2: registry.cancelActive(); break;
      default: (void)registry.dispatch(randomEvent(random, buttons, 0.016 * i));
    }
    loaded.host->mainQueue.runFrame();
  }
  // The window closes during an action.
  if (const auto entries = registry.tools(); !entries.empty()) (void)registry.activate(entries.front().handle);
  c3de_event press = randomEvent(random, buttons, 10.0);
  press.type = C3DE_EVENT_PRESS;
  (void)registry.dispatch(press);
  loaded.host->host.reset();
  return ofEvents(loaded, kEvents);
}

Verdict commands(const Trial &trial) {
  const LoadedPlugin loaded(trial, TrialHost::Serves::all);
  if (!loaded.refusal.empty()) return fail(loaded.refusal);
  const auto entries = loaded.host->commands.commands();
  if (entries.empty()) return skip("it has no commands");
  int runs = 0;
  for (int i = 0; i < 3; ++i)
    for (const auto &entry : entries) {
      const registry::PluginCommand *command = loaded.host->commands.find(entry.handle);
      if (command == nullptr) continue;
      (void)loaded.host->commands.run(entry.handle);  // the command may refuse
      ++runs;
      for (int frame = 0; frame < 5; ++frame) loaded.host->mainQueue.runFrame();
    }
  return ofEvents(loaded, runs);
}

Verdict readers(const Trial &trial) {
  const LoadedPlugin loaded(trial, TrialHost::Serves::all);
  if (!loaded.refusal.empty()) return fail(loaded.refusal);
  const auto infos = loaded.host->meshFormats.readers();
  if (infos.empty()) return skip("it reads no files");
  Random random(trial.seed);
  std::error_code ignored;
  std::filesystem::create_directories(trial.folder, ignored);
  int refused = 0;
  for (const auto &info : infos)
    for (int i = 0; i < kEvents; ++i) {
      const auto file = trial.folder / ("random" + (info.extensions.empty() ? "" : info.extensions.front()));
      std::string bytes(i == 0 ? 0 : random.below(2000), '\0');
      // Text more often than bytes, because readers of text reject bytes at once.
      const bool isText = i % 3 != 0;
      for (char &byte : bytes)
        byte = isText ? "0123456789 -.eE\nvf"[random.below(18)] : static_cast<char>(random.below(256));
      std::ofstream(file, std::ios::binary) << bytes;
      const auto read = loaded.host->meshFormats.load(file, geometry::LengthUnit::millimetre, {}, info.id);
      if (read) continue;
      ++refused;
      if (read.error().message.find('\n') != std::string::npos) return warn(info.id + " answers in several lines");
    }
  const Verdict said = loaded.complaints();
  return said.result == Result::fail
             ? said
             : pass(fmt::format("{} of {} files of rubbish refused", refused, kEvents * infos.size()));
}

Verdict writers(const Trial &trial) {
  const LoadedPlugin loaded(trial, TrialHost::Serves::all);
  if (!loaded.refusal.empty()) return fail(loaded.refusal);
  const auto infos = loaded.host->meshFormats.writers();
  if (infos.empty()) return skip("it writes no files");
  Random random(trial.seed);
  std::error_code ignored;
  std::filesystem::create_directories(trial.folder, ignored);
  int written = 0, asked = 0;
  std::string refusal;
  for (const auto &info : infos)
    for (int i = 0; i < kSurfaces; ++i) {
      geometry::TriangleMesh mesh;
      const std::size_t vertices = 3 + (i == 0 ? 0 : random.below(i == 1 ? 100'000 : 500));
      // Includes numbers that are difficult to represent as text.
      const double size = std::array{1.0, 1e-9, 1e9, 1e300}[random.below(4)];
      const auto number = [&] { return size * (static_cast<double>(random.below(2001)) / 1000.0 - 1.0); };
      for (std::size_t v = 0; v < vertices; ++v) mesh.vertices.push_back({number(), -0.0, number()});
      for (std::size_t t = 0; t < vertices; ++t)
        mesh.triangles.push_back({static_cast<unsigned>(t), static_cast<unsigned>((t + 1) % vertices),
                                  static_cast<unsigned>(random.below(vertices))});
      const auto file = trial.folder / ("surface" + info.extensions.front());
      const auto result = loaded.host->meshFormats.write(file, mesh, {{}, i % 2 == 0 ? "liver" : ""});
      ++asked;
      if (result) ++written;
      if (result) continue;
      refusal = result.error().message;
      if (refusal.find('\n') != std::string::npos) return warn(info.id + " answers in several lines");
    }
  const Verdict said = loaded.complaints();
  if (said.result == Result::fail) return said;
  if (written == 0) return fail(fmt::format("not one of {} surfaces is written: {}", asked, refusal));
  return pass(fmt::format("{} of {} surfaces written", written, asked));
}

/// A simulation of one body that consists only of points: some in one position, some held, or none at all. Requests for
/// any other interface are refused as unsupported.
class Points {
 public:
  Points() {
    // Static tables of this process: each object is found through self.
    static const c3de_object_vt vt{sizeof(c3de_object_vt), 1, [](c3de_object *) -> std::uint32_t { return 2; },
                                   [](c3de_object *) -> std::uint32_t { return 1; }, &query};
    self_.object.vt = &vt;
  }
  Points(const Points &) = delete;
  Points &operator=(const Points &) = delete;

  void move(Random &random) {
    const std::size_t n = random.below(200);
    const auto number = [&] { return static_cast<double>(random.below(2001)) / 1e4 - 0.1; };
    masses_.assign(n, 0.0);
    forces_.assign(3 * n, 0.0);
    for (auto *numbers : {&positions_, &velocities_}) {
      numbers->resize(3 * n);
      for (double &x : *numbers) x = random.below(10) == 0 ? 0.0 : number();
    }
    for (std::size_t i = 0; i < n; ++i) {
      if (random.below(4) != 0) masses_[i] = 1e-3;  // otherwise it is held
      if (random.below(8) == 0)                     // at the first one, or at the origin
        for (std::size_t c = 0; c < 3; ++c) positions_[3 * i + c] = i % 2 == 0 ? positions_[c] : 0.0;
    }
    ++steps_;
  }
  [[nodiscard]] c3de_object *object() { return &self_.object; }
  [[nodiscard]] static const c3de_simulator_v1 *table() {
    static const c3de_simulator_v1 made = makeTable();
    return &made;
  }
  [[nodiscard]] bool isAsked() const { return isAsked_; }
  [[nodiscard]] c3de_sim_status status() const {
    c3de_sim_status status{};
    status.size = sizeof status;
    status.steps = steps_;
    status.time_s = 1e-3 * static_cast<double>(steps_);
    status.dt_s = 1e-3;
    status.bodies = hasBody_ ? 1 : 0;
    return status;
  }

 private:
  struct Self {
    c3de_object object;
    Points *points;
  };
  static Points &of(c3de_object *self) { return *reinterpret_cast<Self *>(self)->points; }

  static c3de_status C3DE_CALL query(c3de_object *, c3de_str id, std::uint32_t minRev, const void **found) {
    if (fromAbi(id) != C3DE_IFACE_SIMULATOR_ID) return C3DE_E_NOT_FOUND;
    if (minRev > 1) return C3DE_E_VERSION;
    *found = table();
    return C3DE_OK;
  }
  template <class... Arguments>
  static c3de_status C3DE_CALL unserved(c3de_object *, Arguments...) noexcept {
    return C3DE_E_UNSUPPORTED;
  }
  template <class... Arguments>
  static void serveNot(c3de_status(C3DE_CALL *&slot)(c3de_object *, Arguments...)) {
    slot = &unserved<Arguments...>;
  }

  static c3de_simulator_v1 makeTable() {
    c3de_simulator_v1 table{};
    table.size = sizeof table;
    table.rev = 1;
    serveNot(table.attach);
    serveNot(table.declarations);
    serveNot(table.set_world);
    serveNot(table.add_body);
    serveNot(table.add_obstacle);
    serveNot(table.add_probe);
    serveNot(table.set_body_param);
    serveNot(table.get_body_param);
    serveNot(table.body_info);
    serveNot(table.read_field);
    serveNot(table.triangles);
    serveNot(table.report);
    table.enum_fields = [](c3de_object *, c3de_handle, void *, auto *) -> c3de_status { return C3DE_OK; };
    table.enum_probes = [](c3de_object *, void *, auto *) -> c3de_status { return C3DE_OK; };
    table.publish = [](c3de_object *) -> c3de_status { return C3DE_OK; };
    table.state_hash = [](c3de_object *self, std::uint64_t *out) -> c3de_status {
      *out = of(self).steps_;
      return C3DE_OK;
    };
    table.clear = [](c3de_object *self) -> c3de_status {
      of(self).hasBody_ = false;
      return C3DE_OK;
    };
    table.remove = [](c3de_object *self, c3de_handle what) -> c3de_status {
      if (what.v != 1) return C3DE_E_STALE;
      of(self).hasBody_ = false;
      return C3DE_OK;
    };
    table.step = [](c3de_object *self) -> c3de_status {
      ++of(self).steps_;
      return C3DE_OK;
    };
    table.reset = [](c3de_object *self) -> c3de_status {
      of(self).steps_ = 0;
      return C3DE_OK;
    };
    table.status = [](c3de_object *self, c3de_sim_status *out) -> c3de_status {
      const std::uint32_t size = out->size;
      const c3de_sim_status status = of(self).status();
      std::memcpy(out, &status, std::min<std::size_t>(size, sizeof status));
      out->size = size;
      return C3DE_OK;
    };
    table.body_at = [](c3de_object *self, std::uint64_t index, c3de_handle *out) -> c3de_status {
      if (index > 0 || !of(self).hasBody_) return C3DE_E_NOT_FOUND;
      out->v = 1;
      return C3DE_OK;
    };
    table.points = [](c3de_object *self, c3de_handle, c3de_sim_points *out) -> c3de_status {
      Points &own = of(self);
      own.isAsked_ = true;
      out->name = {"body", 4};
      out->count = own.masses_.size();
      out->positions_m = own.positions_.data();
      out->velocities_m_s = own.velocities_.data();
      out->masses_kg = own.masses_.data();
      out->forces_N = own.forces_.data();
      return C3DE_OK;
    };
    return table;
  }

  Self self_{{nullptr}, this};
  std::vector<double> positions_, velocities_, masses_, forces_;
  std::uint64_t steps_ = 0;
  bool isAsked_ = false, hasBody_ = true;
};

Verdict steps(const Trial &trial) {
  Points points;  // outlives a plugin that may keep it
  const LoadedPlugin loaded(trial, TrialHost::Serves::all);
  if (!loaded.refusal.empty()) return fail(loaded.refusal);
  Random random(trial.seed);
  // In the scene, where a plugin finds it and may modify it.
  const Handle node = loaded.host->sceneGraph.add({}, "Points");
  auto simulation = scene::Simulation::createForCaller(points.object());
  if (!simulation) return fail(simulation.error().message);
  loaded.host->simulations.add(node, "Points", std::move(*simulation));
  const auto take = [&]() -> Verdict {
    for (int i = 0; i < kEvents; ++i) {
      if (const auto applied = loaded.host->forces.apply(node, points.object(), Points::table()); !applied)
        return fail(applied.error().message);
      points.move(random);
      loaded.host->simulations.stepped(node, points.status());
    }
    return loaded.complaints();
  };
  const Verdict said = take();
  loaded.host->simulations.remove(node);
  loaded.host->sceneGraph.remove(node);
  if (said.result != Result::pass) return said;
  return pass(fmt::format("{} steps{}", kEvents, points.isAsked() ? "" : "; it adds no force"));
}

constexpr std::array kChecks{
    Check{"parameters", "Declarations are sound; random and extreme values, and their undoing, are taken", &parameters},
    Check{"panels", "300 random clicks, numbers and texts in each panel", &panels},
    Check{"tools", "300 random events, changes and cancels of tools, and the end in the middle of one", &tools},
    Check{"commands", "Each command three times, with nothing open", &commands},
    Check{"readers", "300 files of rubbish for each reader of meshes", &readers},
    Check{"writers", "30 surfaces for each writer of meshes, one of 100 000 triangles", &writers},
    Check{"steps",
          "300 steps of a simulation for its force fields and watches: what it only reads, and the bodies, stay",
          &steps}};

}  // namespace

std::span<const Check> callbackChecks() { return kChecks; }

}  // namespace c3de::validate
