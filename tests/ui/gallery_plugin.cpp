// SPDX-License-Identifier: Apache-2.0
// A plugin for tests of the window: every widget once, every kind of parameter, a tool that counts its events, a slow
// job and a visible box. What it has observed is in value rows of its panel.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <string>
#include <string_view>
#include <thread>

#include "c3de/abi/entry.h"
#include "c3de/abi/jobs.h"
#include "c3de/abi/log.h"
#include "c3de/abi/panels.h"
#include "c3de/abi/params.h"
#include "c3de/abi/render.h"
#include "c3de/abi/scene.h"
#include "c3de/abi/tools.h"

namespace {

c3de_str str(std::string_view s) { return {s.data(), s.size()}; }

struct Gallery {
  const c3de_panels_v1 *panels = nullptr;
  const c3de_params_v1 *params = nullptr;
  const c3de_tools_v1 *tools = nullptr;
  const c3de_jobs_v1 *jobs = nullptr;
  const c3de_scene_v1 *scene = nullptr;
  const c3de_render_v1 *render = nullptr;
  c3de_handle set{}, node{}, box{}, points{}, job{};

  std::uint32_t presses = 0, checked = 0, choice = 1;
  std::uint32_t restless = 0;  ///< from the next press on, rows above it appear and disappear with every frame
  int phase = -1;              ///< of that; -1: not yet
  std::uint32_t random = 1;    ///< the state is written every few frames: not synchronous with that
  double slider = 1.5;
  char text[32] = "liver", file[512] = "";
  std::string changed = "none", fileSeen = "none", jobEnd = "none";
  int toolPresses = 0, toolMoves = 0, toolReleases = 0, toolCancels = 0;
  bool isHolding = false;
  double rayX = 0.0;
  std::atomic<bool> isJobRunning{false};

  void value(const c3de_ui_v1 *ui, const char *name, const std::string &shown) const {
    ui->value(ui->ctx, str(name), str(shown));
  }
  void draw(const c3de_ui_v1 *ui);
};

void Gallery::draw(const c3de_ui_v1 *ui) {
  void *c = ui->ctx;
  random = 1664525U * random + 1013904223U;
  if (restless != 0 && phase >= 0) phase = static_cast<int>((random >> 16U) % 3U);
  if (phase != 1) {
    ui->heading(c, str("Widgets"));
    ui->text(c, str("Every widget once; this text is long enough to be wrapped at the edge of the panel."));
  }
  for (int i = 0; phase == 2 && i < 4; ++i) {
    ui->button(c, str("comes." + std::to_string(i)), str("It comes and goes"), 1);
    value(ui, "Comes and goes", std::to_string(i));
  }
  if (ui->button(c, str("press"), str("Press"), 1) & C3DE_UI_COMMITTED) {
    ++presses;
    if (restless != 0) phase = std::max(phase, 0);
  }
  ui->tooltip(c, str("Counts"));
  ui->same_line(c);
  ui->button(c, str("off"), str("Not now"), 0);
  ui->same_line(c);
  if (ui->button(c, str("notify"), str("Notify"), 1) & C3DE_UI_COMMITTED)
    panels->notify(panels->ctx, C3DE_LOG_WARN, str("From the gallery"), str("Something to know."));
  value(ui, "Presses", std::to_string(presses));
  ui->checkbox(c, str("check"), str("Show phyxels"), &checked);
  ui->slider(c, str("slider"), str("Pull"), str("N"), &slider, 0.0, 5.0);
  value(ui, "Slider", std::to_string(slider));
  const c3de_str names[] = {str("explicit"), str("implicit"), str("quasistatic"), {nullptr, 0}};
  ui->choice(c, str("choice"), str("Integrator"), &choice, names, 4);
  ui->input_text(c, str("text"), str("Name"), text, sizeof text);
  if (ui->file_button(c, str("file"), str("Choose organ…"), str("obj;stl"), file, sizeof file) & C3DE_UI_CHANGED)
    fileSeen = file;
  value(ui, "File", fileSeen);
  if (ui->button(c, str("job"), str("Long job"), isJobRunning ? 0 : 1) & C3DE_UI_COMMITTED) {
    c3de_job work{};
    work.size = sizeof work;
    work.title = str("A long job");
    work.self = this;
    work.run = [](void *, const c3de_progress *progress) -> c3de_status {
      for (int i = 0; i < 2000; ++i) {
        if (progress->update(progress->self, i / 2000.0, str("working")) == C3DE_E_CANCELLED) return C3DE_E_CANCELLED;
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
      }
      return C3DE_OK;
    };
    work.done = [](void *self, c3de_status status, c3de_str) {
      static_cast<Gallery *>(self)->jobEnd = std::to_string(status);
      static_cast<Gallery *>(self)->isJobRunning = false;
    };
    isJobRunning = true;
    jobs->submit(jobs->ctx, &work, &job);
  }
  value(ui, "Job", jobEnd);
  ui->progress(c, 0.42, str("42 of 100"));
  ui->separator(c);
  // Missing text, and the same id twice: the window must handle both.
  ui->text(c, {nullptr, 0});
  ui->button(c, {nullptr, 0}, str("Nameless"), 1);
  ui->button(c, {nullptr, 0}, str("Nameless too"), 1);
  ui->checkbox(c, str("restless"), str("Restless"), &restless);
  ui->heading(c, str("Parameters"));
  ui->params(c, set, {nullptr, 0});
  value(ui, "Changed", changed);
  ui->heading(c, str("Tool"));
  value(ui, "Tool presses", std::to_string(toolPresses));
  value(ui, "Tool moves", std::to_string(toolMoves));
  value(ui, "Tool releases", std::to_string(toolReleases));
  value(ui, "Tool cancels", std::to_string(toolCancels));
  value(ui, "Ray x", std::to_string(rayX));
  ui->same_line(c);  // with nothing after it
}

c3de_param_decl decl(std::uint32_t type, const char *id, const char *label, const char *unit, const char *group,
                     double min, double max, double fallback, std::uint32_t flags) {
  c3de_param_decl d{};
  d.size = sizeof d;
  d.type = type;
  d.id = str(id);
  d.label = str(label);
  d.unit = str(unit);
  d.doc = str("What it means; too small is soft, too large is stiff.");
  d.group = str(group);
  d.min = d.soft_min = min;
  d.max = d.soft_max = max;
  d.fallback = fallback;
  d.flags = flags;
  return d;
}

c3de_status declareParameters(Gallery &g) {
  static const c3de_str laws[] = {str("linear"), str("stvk"), str("neo_hookean")};
  c3de_param_decl list[] = {
      decl(C3DE_PARAM_F64, "youngs", "Young's modulus", "Pa", "Material", 1e2, 1e7, 5e3,
           C3DE_PARAM_LOG_SCALE | C3DE_PARAM_NEEDS_RESET),
      decl(C3DE_PARAM_F64, "poisson", "Poisson's ratio", "", "Material", 0.0, 0.5, 0.3,
           C3DE_PARAM_MIN_OPEN | C3DE_PARAM_MAX_OPEN),
      decl(C3DE_PARAM_CHOICE, "law", "Law", "", "Material", 0, 0, 0, 0),
      decl(C3DE_PARAM_F64, "dt", "Time step", "s", "Solver", 1e-6, 1e-1, 1e-3, C3DE_PARAM_LOG_SCALE | C3DE_PARAM_AUTO),
      decl(C3DE_PARAM_I64, "count", "Phyxels", "", "Solver", 10, 5000, 500, C3DE_PARAM_NEEDS_RESET),
      decl(C3DE_PARAM_BOOL, "surface", "Draw surface", "", "Solver", 0, 1, 1, 0),
      decl(C3DE_PARAM_VEC3, "gravity", "Gravity", "m/s²", "Solver", -100, 100, 0, 0),
      decl(C3DE_PARAM_TEXT, "note", "Note", "", "Solver", 0, 0, 0, 0),
      decl(C3DE_PARAM_F64, "damping", "Damping", "1/s", "Solver", 0, 100, 0, C3DE_PARAM_ADVANCED),
  };
  list[2].choices = laws;
  list[2].choices_n = 3;
  list[2].fallback_text = str("stvk");
  list[3].fallback_text = str("auto");
  list[6].fallback_vec[1] = -9.81;
  c3de_param_listener listener{};
  listener.size = sizeof listener;
  listener.self = &g;
  listener.changed = [](void *self, const c3de_param_value *v) {
    char number[64];
    std::snprintf(number, sizeof number, "%.10g", v->num);
    const std::string id(v->id.ptr, v->id.len);
    const std::string text = v->text.len ? std::string(v->text.ptr, v->text.len) : std::string(number);
    static_cast<Gallery *>(self)->changed = id + " = " + text;
  };
  return g.params->declare(g.params->ctx, str("Gallery"), list, std::size(list), sizeof list[0], &listener, &g.set);
}

c3de_status addTool(Gallery &g) {
  c3de_tool tool{};
  tool.size = sizeof tool;
  tool.id = str("test.marker");
  tool.label = str("Marker");
  tool.hint = str("Drag to count");
  tool.shortcut = 'T';
  tool.self = &g;
  tool.activate = [](void *) -> c3de_status { return C3DE_OK; };
  tool.cancel = [](void *self) {
    Gallery &gallery = *static_cast<Gallery *>(self);
    if (gallery.isHolding) ++gallery.toolCancels;
    gallery.isHolding = false;
  };
  tool.on_event = [](void *self, const c3de_event *event, std::uint32_t *consumed) -> c3de_status {
    Gallery &gallery = *static_cast<Gallery *>(self);
    gallery.rayX = event->ray_direction[0];
    if (event->type == C3DE_EVENT_PRESS && event->button == C3DE_BUTTON_LEFT) {
      ++gallery.toolPresses;
      gallery.isHolding = true;
      *consumed = 1;
    } else if (event->type == C3DE_EVENT_MOVE && gallery.isHolding) {
      ++gallery.toolMoves;
      *consumed = 1;
    } else if (event->type == C3DE_EVENT_RELEASE) {
      ++gallery.toolReleases;
      gallery.isHolding = false;
      *consumed = 1;
    }
    return C3DE_OK;
  };
  c3de_handle handle{};
  return g.tools->add(g.tools->ctx, &tool, &handle);
}

void addBox(Gallery &g) {
  static const float corners[8][3] = {{-60, -40, -30}, {60, -40, -30}, {60, 40, -30}, {-60, 40, -30},
                                      {-60, -40, 30},  {60, -40, 30},  {60, 40, 30},  {-60, 40, 30}};
  static const std::uint32_t faces[12][3] = {{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7}, {0, 1, 5}, {0, 5, 4},
                                             {1, 2, 6}, {1, 6, 5}, {2, 3, 7}, {2, 7, 6}, {3, 0, 4}, {3, 4, 7}};
  g.scene->add_node(g.scene->ctx, {0}, str("gallery"), &g.node);
  c3de_handle child{};
  g.scene->add_node(g.scene->ctx, g.node, str("box"), &child);
  const double min[] = {-60, -40, -30}, max[] = {60, 40, 30};
  g.scene->set_bounds(g.scene->ctx, child, min, max);
  const c3de_material skin{sizeof(c3de_material), 0, {0.72f, 0.36f, 0.32f, 1.0f}, 0};
  g.render->create_mesh(g.render->ctx, child, {corners, 8, 3, C3DE_F32, 0}, {faces, 12, 3, C3DE_U32, 0}, &skin, &g.box);
}

c3de_status C3DE_CALL create(const c3de_host *host, void **self) {
  auto *g = new Gallery;
  const auto get = [&](const char *id, auto &table) {
    const void *found = nullptr;
    const c3de_status status = host->get_service(host->ctx, str(id), 1, &found);
    table = static_cast<std::remove_reference_t<decltype(table)>>(found);
    return status;
  };
  c3de_status status = get(C3DE_PANELS_ID, g->panels);
  if (status >= 0) status = get(C3DE_PARAMS_ID, g->params);
  if (status >= 0) status = get(C3DE_TOOLS_ID, g->tools);
  if (status >= 0) status = get(C3DE_JOBS_ID, g->jobs);
  if (status >= 0) status = get(C3DE_SCENE_ID, g->scene);
  if (status >= 0) status = get(C3DE_RENDER_ID, g->render);
  if (status >= 0) status = declareParameters(*g);
  if (status >= 0) status = addTool(*g);
  c3de_panel panel{};
  panel.size = sizeof panel;
  panel.id = str("test.gallery");
  panel.title = str("Gallery");
  panel.self = g;
  panel.on_ui = [](void *gallery, const c3de_ui_v1 *ui) { static_cast<Gallery *>(gallery)->draw(ui); };
  c3de_handle handle{};
  if (status >= 0) status = g->panels->add(g->panels->ctx, &panel, &handle);
  if (status < 0) {
    delete g;
    return status;
  }
  addBox(*g);
  *self = g;
  return C3DE_OK;
}

constexpr char kId[] = "test.gallery", kVersion[] = "1.0.0", kName[] = "Gallery", kVendor[] = "C3DE",
               kLicense[] = "Apache-2.0";
const c3de_service_req kNeeds[] = {
    {sizeof(c3de_service_req), C3DE_REQUIRED, {C3DE_PANELS_ID, sizeof C3DE_PANELS_ID - 1}, 1, 0},
    {sizeof(c3de_service_req), C3DE_REQUIRED, {C3DE_PARAMS_ID, sizeof C3DE_PARAMS_ID - 1}, 1, 0},
    {sizeof(c3de_service_req), C3DE_REQUIRED, {C3DE_TOOLS_ID, sizeof C3DE_TOOLS_ID - 1}, 1, 0},
    {sizeof(c3de_service_req), C3DE_REQUIRED, {C3DE_JOBS_ID, sizeof C3DE_JOBS_ID - 1}, 1, 0},
    {sizeof(c3de_service_req), C3DE_REQUIRED, {C3DE_SCENE_ID, sizeof C3DE_SCENE_ID - 1}, 1, 0},
    {sizeof(c3de_service_req), C3DE_REQUIRED, {C3DE_RENDER_ID, sizeof C3DE_RENDER_ID - 1}, 1, 0},
};
const c3de_plugin kPlugin = {sizeof(c3de_plugin),
                             1,
                             {kId, sizeof kId - 1},
                             {kVersion, sizeof kVersion - 1},
                             {kName, sizeof kName - 1},
                             {kVendor, sizeof kVendor - 1},
                             {kLicense, sizeof kLicense - 1},
                             kNeeds,
                             std::size(kNeeds),
                             sizeof kNeeds[0],
                             create,
                             [](void *) -> c3de_status { return C3DE_OK; },
                             [](void *) -> c3de_status { return C3DE_OK; },
                             [](void *self) { delete static_cast<Gallery *>(self); }};

}  // namespace

C3DE_EXPORT c3de_status C3DE_CALL c3de_plugin_query(const c3de_offer *, c3de_answer *answer) {
  answer->abi_major = C3DE_ABI_MAJOR;
  answer->abi_minor = C3DE_ABI_MINOR;
  answer->plugin = &kPlugin;
  return C3DE_OK;
}
