// SPDX-License-Identifier: Apache-2.0
// Loads correctly, and then violates the plugin rules on demand. The expected verdict is next to each call in
// test_guarded_calls.cpp.
#include "misbehaves.h"

#include <chrono>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>

#include "minimal.h"

namespace {

using namespace std::chrono_literals;
constexpr auto kHang = 400ms;

const c3de_host *host = nullptr;
bool healed = false;

template <class Table>
const Table *service(const char *id) {
  const void *table = nullptr;
  (void)host->get_service(host->ctx, text(id), 1, &table);
  return static_cast<const Table *>(table);
}
const c3de_registry_v1 *registry() { return service<c3de_registry_v1>(C3DE_REGISTRY_ID); }

void hang() { std::this_thread::sleep_for(kHang); }
[[noreturn]] void throwUp(const char *what) { throw std::runtime_error(what); }

// Functions that do nothing, for tables that lack another one.
void C3DE_CALL onUi(void *, const c3de_ui_v1 *) {}
c3de_status C3DE_CALL activate(void *) { return C3DE_OK; }
void C3DE_CALL cancel(void *) {}
c3de_status C3DE_CALL onEvent(void *, const c3de_event *, std::uint32_t *) { return C3DE_OK; }
c3de_status C3DE_CALL runJob(void *, const c3de_progress *) { return C3DE_OK; }
void C3DE_CALL done(void *, c3de_status, c3de_str) {}

c3de_handle ignored;

// ---- registered on request ----------------------------------------------------------------------------------------

using OnUi = void(C3DE_CALL *)(void *, const c3de_ui_v1 *);
c3de_status addPanel(OnUi f, std::uint32_t size = sizeof(c3de_panel)) {
  const auto *panels = service<c3de_panels_v1>(C3DE_PANELS_ID);
  const c3de_panel panel{size, 1, text("test.misbehaves.panel"), text("Bad\x1b[31m panel"), nullptr, f};
  return panels->add(panels->ctx, &panel, &ignored);
}
c3de_status addTool(decltype(c3de_tool::activate) a, decltype(c3de_tool::cancel) c, decltype(c3de_tool::on_event) e) {
  const auto *tools = service<c3de_tools_v1>(C3DE_TOOLS_ID);
  const c3de_tool tool{
      sizeof(c3de_tool), 1, text("test.misbehaves.tool"), text("Bad tool"), text(""), 0, 0, nullptr, a, c, e, 0, 0};
  return tools->add(tools->ctx, &tool, &ignored);
}
c3de_status submit(decltype(c3de_job::run) run, decltype(c3de_job::done) end) {
  const auto *jobs = service<c3de_jobs_v1>(C3DE_JOBS_ID);
  const c3de_job job{sizeof(c3de_job), 0, text("Bad job"), nullptr, run, end};
  return jobs->submit(jobs->ctx, &job, &ignored);
}
c3de_status addEdit(decltype(c3de_edit::undo) undo, decltype(c3de_edit::redo) redo) {
  const auto *history = service<c3de_history_v1>(C3DE_HISTORY_ID);
  const c3de_edit edit{sizeof(c3de_edit), 1, text("bad step"), nullptr, undo, redo, nullptr};
  return history->add(history->ctx, &edit, &ignored);
}
c3de_status addField(decltype(c3de_force_field::apply) apply) {
  const auto *forces = service<c3de_forces_v1>(C3DE_FORCES_ID);
  const c3de_force_field field{sizeof(c3de_force_field), 0, text("bad field"), nullptr, apply};
  return forces->add(forces->ctx, {0}, &field, &ignored);
}

c3de_handle ownSet;
using Changed = void(C3DE_CALL *)(void *, const c3de_param_value *);
c3de_status declare(Changed changed, const char *title, c3de_handle *out) {
  const auto *params = service<c3de_params_v1>(C3DE_PARAMS_ID);
  c3de_param_decl decl{};
  decl.size = sizeof decl;
  decl.type = C3DE_PARAM_BOOL;
  decl.id = text("on");
  const c3de_param_listener listener{sizeof(c3de_param_listener), 0, nullptr, changed};
  decl.label = text("On\a and \xe2\x80\xaeoff");
  const c3de_status status = params->declare(params->ctx, text(title), &decl, 1, sizeof decl, &listener, out);
  const auto *log = service<c3de_log_v1>(C3DE_LOG_ID);
  log->write(log->ctx, C3DE_LOG_INFO, text(("made params " + std::to_string(out->v)).c_str()));
  return status;
}
c3de_status addFrame(void(C3DE_CALL *fn)(void *)) {
  const auto *time = service<c3de_time_v1>(C3DE_TIME_ID);
  return time->add_frame_callback(time->ctx, nullptr, fn, &ignored);
}

// ---- classes ------------------------------------------------------------------------------------------------------

using Create = c3de_status(C3DE_CALL *)(void *, c3de_object **);
c3de_status addClass(const char *id, Create create) {
  const c3de_class cls{sizeof(c3de_class), 1, text(id), text("Bad"), text(""), nullptr, 0, nullptr, create};
  return registry()->add_class(registry()->ctx, &cls);
}

std::uint32_t C3DE_CALL count(c3de_object *) { return 1; }
c3de_status C3DE_CALL noInterface(c3de_object *, c3de_str, std::uint32_t, const void **) { return C3DE_E_NOT_FOUND; }
c3de_status C3DE_CALL throwingQuery(c3de_object *, c3de_str, std::uint32_t, const void **) {
  throwUp("thrown in query");
}
std::uint32_t C3DE_CALL throwingRelease(c3de_object *) { throwUp("thrown in release"); }

template <class... A>
c3de_status C3DE_CALL nothing(A...) {
  return C3DE_OK;
}
template <class... A>
void serve(c3de_status(C3DE_CALL *&slot)(A...)) {
  slot = &nothing<A...>;
}
/// A simulator that has every function but its step.
const c3de_simulator_v1 *simulatorWithoutStep() {
  static const c3de_simulator_v1 table = [] {
    c3de_simulator_v1 t{};
    t.size = sizeof t;
    t.rev = 1;
    const auto serveAll = [](auto &...slots) { (serve(slots), ...); };
    serveAll(t.attach, t.declarations, t.set_world, t.add_body, t.add_obstacle, t.add_probe, t.set_body_param,
             t.get_body_param, t.remove, t.clear, t.reset, t.publish, t.status, t.state_hash, t.report, t.body_at,
             t.body_info, t.enum_fields, t.read_field, t.triangles, t.enum_probes);
    return t;
  }();
  return &table;
}
c3de_status C3DE_CALL simulatorQuery(c3de_object *, c3de_str, std::uint32_t, const void **table) {
  *table = simulatorWithoutStep();
  return C3DE_OK;
}

const c3de_object_vt kWithoutRelease{sizeof(c3de_object_vt), 1, &count, nullptr, &noInterface};
const c3de_object_vt kTooSmall{16, 1, &count, &count, &noInterface};
const c3de_object_vt kThrowing{sizeof(c3de_object_vt), 1, &count, &throwingRelease, &throwingQuery};
const c3de_object_vt kNoStep{sizeof(c3de_object_vt), 1, &count, &count, &simulatorQuery};

template <const c3de_object_vt *Vt>
c3de_status C3DE_CALL make(void *, c3de_object **out) {
  static c3de_object object{Vt};
  *out = &object;
  return C3DE_OK;
}
c3de_status C3DE_CALL makeWithoutTable(void *, c3de_object **out) {
  static c3de_object object{nullptr};
  *out = &object;
  return C3DE_OK;
}
c3de_status C3DE_CALL throwingCreate(void *, c3de_object **) { throwUp("thrown in create of a class"); }
c3de_status C3DE_CALL itself(void *, c3de_object **out) {
  return registry()->create(registry()->ctx, text("test.bad.Itself/0"), out);
}
c3de_status C3DE_CALL slowCreate(void *, c3de_object **out) {
  hang();
  return make<&kNoStep>(nullptr, out);
}

// ---- recursive callbacks ------------------------------------------------------------------------------------------

c3de_handle itsTool;

void C3DE_CALL takeUpAgain(void *) {
  // Each creates two more: without a depth limit the stack overflows, without a line limit the log does.
  const auto *tools = service<c3de_tools_v1>(C3DE_TOOLS_ID);
  for (int i = 0; i < 2; ++i) (void)tools->activate(tools->ctx, itsTool);
}

// ---- actions on demand --------------------------------------------------------------------------------------------

c3de_status create1000() {
  for (int i = 0; i < 1000; ++i) {
    const std::string id = "test.bad.Number" + std::to_string(i) + "/0";
    if (const c3de_status status = addClass(id.c_str(), &make<&kNoStep>); status < 0) return status;
    c3de_object *object = nullptr;
    if (const c3de_status status = registry()->create(registry()->ctx, text(id.c_str()), &object); status < 0)
      return status;
    object->vt->release(object);
    if (const c3de_status status = registry()->remove_class(registry()->ctx, text(id.c_str())); status < 0)
      return status;
  }
  return C3DE_OK;
}

c3de_status sampleOverItself() {
  // Five points, and the results over the centre of them.
  const auto *mesh = service<c3de_mesh_v1>(C3DE_MESH_ID);
  const double corners[] = {0, 0, 0, 10, 0, 0, 0, 10, 0, 0, 0, 10};
  const std::uint32_t faces[] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
  c3de_handle made;
  if (const c3de_status status =
          mesh->create(mesh->ctx, {corners, 4, 3, C3DE_F64, 0}, {faces, 4, 3, C3DE_U32, 0}, &made);
      status < 0)
    return status;
  // Rows that interleave are fine: x, y, z and the result in one struct.
  double interleaved[5][4] = {};
  if (const c3de_status status = mesh->winding_numbers(mesh->ctx, made, {&interleaved[0][0], 5, 3, C3DE_F64, 32},
                                                       {&interleaved[0][3], 5, 1, C3DE_F64, 32});
      status < 0)
    return C3DE_E_INTERNAL;
  return mesh->winding_numbers(mesh->ctx, made, {&interleaved[0][0], 5, 3, C3DE_F64, 0},
                               {&interleaved[1][0], 5, 1, C3DE_F64, 0});
}

c3de_status hugeView(std::uint64_t rows, std::int64_t stride, const void *data) {
  const auto *mesh = service<c3de_mesh_v1>(C3DE_MESH_ID);
  const std::uint32_t faces[] = {0, 1, 2};
  c3de_handle made;
  return mesh->create(mesh->ctx, {data, rows, 3, C3DE_F64, stride}, {faces, 1, 3, C3DE_U32, 0}, &made);
}

void C3DE_CALL badTexts(void *, const c3de_ui_v1 *ui) {
  ui->heading(ui->ctx, text("red \x1b[31m"));
  ui->value(ui->ctx, text("bytes"), text("\xff\xfe and \xc2\x85"));
  ui->text(ui->ctx, text("two\nlines"));
}

using Do = c3de_status (*)();
const std::map<std::string_view, Do> &misbehaviours() {
  static const std::map<std::string_view, Do> all{
      {"class without create", [] { return addClass("test.bad.NoCreate/0", nullptr); }},
      {"panel without on_ui", [] { return addPanel(nullptr); }},
      {"panel of 48 bytes", [] { return addPanel(&onUi, 48); }},
      {"tool without activate", [] { return addTool(nullptr, &cancel, &onEvent); }},
      {"tool without cancel", [] { return addTool(&activate, nullptr, &onEvent); }},
      {"tool without on_event", [] { return addTool(&activate, &cancel, nullptr); }},
      {"listener without changed", [] { return declare(nullptr, "Bad", &ignored); }},
      {"job without run", [] { return submit(nullptr, &done); }},
      {"job without done", [] { return submit(&runJob, nullptr); }},
      {"step without undo", [] { return addEdit(nullptr, &activate); }},
      {"step without redo", [] { return addEdit(&activate, nullptr); }},
      {"field without apply", [] { return addField(nullptr); }},

      {"classes",
       [] {
         (void)addClass("test.bad.NoRelease/0", &make<&kWithoutRelease>);
         (void)addClass("test.bad.TooSmall/0", &make<&kTooSmall>);
         (void)addClass("test.bad.NoTable/0", &makeWithoutTable);
         (void)addClass("test.bad.NoObject/0", [](void *, c3de_object **) -> c3de_status { return C3DE_OK; });
         (void)addClass("test.bad.Throws/0", &make<&kThrowing>);
         (void)addClass("test.bad.NoStep/0", &make<&kNoStep>);
         (void)addClass("test.bad.ThrowingCreate/0", &throwingCreate);
         (void)addClass("test.bad.Slow/0", &slowCreate);
         return addClass("test.bad.Itself/0", &itself);
       }},
      {"class that throws, from a plugin",
       [] {
         c3de_object *made = nullptr;
         return registry()->create(registry()->ctx, text("test.bad.ThrowingCreate/0"), &made);
       }},
      {"1000 classes", &create1000},
      {"tool that takes itself up again",
       [] {
         const c3de_status status = addTool(&activate, &takeUpAgain, &onEvent);
         itsTool = ignored;
         return status;
       }},

      {"results over what is read", &sampleOverItself},
      {"2^40 rows", [] { return hugeView(std::uint64_t{1} << 40, 0, &ignored); }},
      {"negative stride", [] { return hugeView(3, -24, &ignored); }},
      {"stride below the row", [] { return hugeView(3, 16, &ignored); }},
      {"null with rows", [] { return hugeView(3, 0, nullptr); }},

      {"slow panel", [] { return addPanel([](void *, const c3de_ui_v1 *) { hang(); }); }},
      {"slow tool",
       [] {
         return addTool(&activate, &cancel, [](void *, const c3de_event *, std::uint32_t *) -> c3de_status {
           hang();
           return C3DE_OK;
         });
       }},
      {"slow frame", [] { return addFrame([](void *) { hang(); }); }},
      {"slow field",
       [] {
         return addField([](void *, const c3de_force_call *) -> c3de_status {
           hang();
           return C3DE_OK;
         });
       }},
      {"silent job",
       [] {
         return submit(
             [](void *, const c3de_progress *) -> c3de_status {
               hang();
               return C3DE_OK;
             },
             &done);
       }},
      {"busy job",
       [] {
         return submit(
             [](void *, const c3de_progress *progress) -> c3de_status {
               for (int i = 0; i < 20; ++i) {
                 std::this_thread::sleep_for(kHang / 20);
                 if (progress->update(progress->self, 0.05 * i, text("busy")) < 0) return C3DE_E_CANCELLED;
               }
               return C3DE_OK;
             },
             &done);
       }},
      {"job until it is cancelled",
       [] {
         return submit(
             [](void *, const c3de_progress *progress) -> c3de_status {
               // Silent for a long time; then it finally receives the request to stop.
               for (;;) {
                 hang();
                 if (progress->update(progress->self, -1.0, text("")) < 0) return C3DE_E_CANCELLED;
               }
             },
             &done);
       }},

      {"panel that throws",
       [] {
         return addPanel([](void *, const c3de_ui_v1 *ui) {
           if (!healed) throwUp("thrown in a panel");
           ui->text(ui->ctx, text("healed"));
         });
       }},
      {"panel that throws now and then",
       [] {
         return addPanel([](void *, const c3de_ui_v1 *) {
           static int calls = 0;
           if (++calls % 3 != 0) throwUp("thrown now and then");
         });
       }},
      {"tool that fails",
       [] {
         return addTool(&activate, &cancel, [](void *, const c3de_event *, std::uint32_t *) -> c3de_status {
           host->set_error(host->ctx, C3DE_E_STATE, text("the hand is \x1b[1mtired"));
           return C3DE_E_STATE;
         });
       }},
      {"listener that throws",
       [] {
         return declare([](void *, const c3de_param_value *) { throwUp("thrown in a listener"); }, "Deaf", &ownSet);
       }},
      {"watch that throws",
       [] {
         const auto *simulation = service<c3de_simulation_v1>(C3DE_SIMULATION_ID);
         c3de_simulation_watch watch{};
         watch.size = sizeof watch;
         watch.stepped = [](void *, c3de_handle, std::uint64_t, double) { throwUp("thrown after a step"); };
         c3de_handle handle{};
         return simulation->watch(simulation->ctx, &watch, &handle);
       }},
      {"frame that throws", [] { return addFrame([](void *) { throwUp("thrown in a frame"); }); }},
      {"heal",
       [] {
         healed = true;
         return C3DE_OK;
       }},

      {"panel with bad texts", [] { return addPanel(&badTexts); }},
      {"lines with bad texts",
       [] {
         const auto *log = service<c3de_log_v1>(C3DE_LOG_ID);
         log->write(log->ctx, C3DE_LOG_INFO, text("bell \a, escape \x1b[2J, back\b, byte \xff, turned \xe2\x80\xae!"));
         host->set_error(host->ctx, C3DE_E_IO, text("bad \x1b]0;title\a byte \xc3"));
         return C3DE_E_IO;
       }},
      {"100000 lines",
       [] {
         const auto *log = service<c3de_log_v1>(C3DE_LOG_ID);
         for (int i = 0; i < 100000; ++i) log->write(log->ctx, C3DE_LOG_DEBUG, text("again and again"));
         return C3DE_OK;
       }},
      {"curves of no numbers",
       [] {
         return addPanel([](void *, const c3de_ui_v1 *ui) {
           const double bad[] = {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()};
           if (ui->rev >= 4) ui->curve(ui->ctx, text("bad"), text("bad"), text("N"), bad, 2);
           if (ui->rev >= 4) ui->curve(ui->ctx, text("null"), text("null"), text("N"), nullptr, 7);
         });
       }},
      {"list without an end",
       [] {
         return addPanel([](void *, const c3de_ui_v1 *ui) {
           if (ui->rev >= 3) ui->list_begin(ui->ctx, text("list"), 3);
           ui->same_line(ui->ctx);
         });
       }},
  };
  return all;
}

c3de_status C3DE_CALL run(c3de_object *, c3de_str what) {
  const auto found = misbehaviours().find(std::string_view(what.ptr, what.len));
  return found != misbehaviours().end() ? found->second() : C3DE_E_NOT_FOUND;
}

const test_misbehaves_v0 kTable{sizeof(test_misbehaves_v0), 1, &run};
c3de_status C3DE_CALL query(c3de_object *, c3de_str, std::uint32_t, const void **table) {
  *table = &kTable;
  return C3DE_OK;
}
const c3de_object_vt kVt{sizeof(c3de_object_vt), 1, &count, &count, &query};

c3de_status C3DE_CALL create(const c3de_host *h, void **) {
  host = h;
  healed = false;
  return addClass(TEST_MISBEHAVES_CLASS, &make<&kVt>);
}

const c3de_plugin plugin = {NAMED("test.misbehaves"), NO_NEEDS, &create, &do_nothing, &do_nothing, &destroy_nothing};

}  // namespace

ANSWER_WITH(&plugin)
