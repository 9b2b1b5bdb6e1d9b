/* SPDX-License-Identifier: Apache-2.0 */
/* Parameters, panels, tools, history, files, settings and commands. */
#include <math.h>

#include "service_checks.h"

/* ---- params, panels, tools ---- */

static void C3DE_CALL never_changed(void *self, const c3de_param_value *value) { ++*(int *)self; }

static c3de_param_decl number(const char *id) {
  c3de_param_decl d = {.size = sizeof d, .type = C3DE_PARAM_F64, .max = 10.0, .soft_max = 10.0, .fallback = 5.0};
  d.id = text(id);
  d.label = text("Number");
  d.unit = text("Pa");
  return d;
}

void drive_params(void) {
  const c3de_params_v1 *params = service(C3DE_PARAMS_ID);
  static const c3de_str laws[] = {TEXT("stvk"), TEXT("neo_hookean")};
  const c3de_str title = TEXT("Test");
  int told = 0;
  c3de_param_listener listener = {sizeof listener, 0, &told, never_changed};
  c3de_param_decl decls[2] = {number("modulus"), number("law")}, bad = number("modulus");
  decls[1].type = C3DE_PARAM_CHOICE;
  decls[1].choices = laws;
  decls[1].choices_n = 2;
  decls[1].fallback_text = text("stvk");
  c3de_handle set, none;
  GIVES(params, (OK, declare, title, decls, 2, sizeof decls[0], &listener, &set),
        (OK, declare, title, decls, 2, 0, NULL, &none), (OK, remove, none));

  GIVES(params, (E_ARG, declare, title, NULL, 2, 0, NULL, &none), (E_ARG, declare, title, decls, 0, 0, NULL, &none),
        (E_ARG, declare, title, decls, UINT64_MAX, 0, NULL, &none), (E_ARG, declare, title, decls, 2, 8, NULL, &none),
        (E_ARG, declare, title, decls, 2, 0, NULL, NULL));
  CHANGED(params, (E_ARG, declare, title, &bad, 1, 0, NULL, &none), (bad.type, 77, ""), (bad.min, 11.0, ""),
          (bad.fallback, 99.0, "the default does not fit"), (bad.choices_n, 3, ""), (bad.size, 12, ""));
  CHANGED(params, (E_UNSUPPORTED, declare, title, &bad, 1, 0, NULL, &none), (bad.flags, 0x80000000u, ""));
  CHANGED(params, (E_EXISTS, declare, title, decls, 2, 0, NULL, &none), (decls[1], number("modulus"), ""));
  CHANGED(params, (E_ARG, declare, title, decls, 2, 0, &listener, &none), (listener.changed, NULL, ""));

  c3de_param_value value = {.size = sizeof value};
  GIVES(params, (OK, get, set, text("modulus"), &value));
  HOLDS(value.num == 5.0 && value.type == C3DE_PARAM_F64);
  GIVES(params, (OK, get, set, text("law"), &value));
  HOLDS(is_text(value.text, "stvk"));
  SAYS(params, "did you mean 'modulus'", (E_NOT_FOUND, get, set, text("modulos"), &value));
  GIVES(params, (E_ARG, get, set, text("modulus"), NULL), (E_ARG, set, set, NULL),
        (E_STALE, get, kNoSuch, text("modulus"), &value));

  c3de_param_value wanted = {sizeof wanted, C3DE_PARAM_F64, TEXT("modulus"), 7.0, {NULL, 0}, {0, 0, 0}};
  GIVES(params, (OK, set, set, &wanted), (OK, get, set, text("modulus"), &value));
  HOLDS(value.num == 7.0 && told == 0);
  CHANGED(params, (E_ARG, set, set, &wanted), (wanted.num, 11.0, "<= 10"), (wanted.num, NAN, ""));
  CHANGED(params, (E_NOT_FOUND, set, set, &wanted), (wanted.id, text("nobody"), ""));
  GIVES(params, (OK, remove, set), (E_STALE, remove, set));
}

static void C3DE_CALL draw_nothing(void *self, const c3de_ui_v1 *ui) {}

void drive_panels(void) {
  const c3de_panels_v1 *panels = service(C3DE_PANELS_ID);
  c3de_panel panel = {sizeof panel, 1, TEXT("test.driver.panel"), TEXT("Driver"), NULL, draw_nothing};
  c3de_handle h, none;
  GIVES(panels, (OK, add, &panel, &h), (E_EXISTS, add, &panel, &none), (E_ARG, add, NULL, &none),
        (E_ARG, add, &panel, NULL));
  panel.id = text("test.driver.other");
  CHANGED(panels, (E_ARG, add, &panel, &none), (panel.on_ui, NULL, ""), (panel.title, text(""), ""),
          (panel.size, 0, ""));
  GIVES(panels, (OK, notify, C3DE_LOG_INFO, text("Title"), text("Text")),
        (E_ARG, notify, 17, text("Title"), text("Text")), (OK, remove, h), (E_STALE, remove, h));
}

static c3de_status C3DE_CALL activate(void *self) {
  ++*(int *)self;
  return C3DE_OK;
}
static void C3DE_CALL cancel(void *self) { *(int *)self += 10; }
static c3de_status C3DE_CALL refuse_to_activate(void *self) {
  host->set_error(host->ctx, C3DE_E_STATE, text("no body to touch"));
  return C3DE_E_STATE;
}
static c3de_status C3DE_CALL on_event(void *self, const c3de_event *event, uint32_t *consumed) {
  *consumed = 1;
  return C3DE_OK;
}

void drive_tools(void) {
  const c3de_tools_v1 *tools = service(C3DE_TOOLS_ID);
  int calls = 0;
  c3de_tool tool = {sizeof tool,
                    1,
                    TEXT("test.driver.tool"),
                    TEXT("Driver"),
                    TEXT("hint"),
                    'D',
                    0,
                    &calls,
                    activate,
                    cancel,
                    on_event,
                    0,
                    0};
  c3de_handle h, stubborn, none;
  uint32_t active = 9;
  GIVES(tools, (OK, add, &tool, &h), (E_EXISTS, add, &tool, &none), (E_ARG, add, NULL, &none),
        (E_ARG, add, &tool, NULL));
  tool.id = text("test.driver.stubborn");
  CHANGED(tools, (E_ARG, add, &tool, &none), (tool.shortcut, 7, ""));
  tool.shortcut = 0;
  CHANGED(tools, (E_ARG, add, &tool, &none), (tool.cancel, NULL, ""));
  tool.activate = refuse_to_activate;
  CHANGED(tools, (E_UNSUPPORTED, add, &tool, &none), (tool.flags, 2, "accepted: 0, 1 (C3DE_TOOL_IN_SLICES)"));
  tool.flags = C3DE_TOOL_IN_SLICES;
  GIVES(tools, (OK, add, &tool, &stubborn), (OK, activate, h), (OK, is_active, h, &active));
  HOLDS(active == 1 && calls == 1);
  SAYS(tools, "no body to touch", (E_STATE, activate, stubborn));
  GIVES(tools, (OK, is_active, h, &active));
  HOLDS(active == 0 && calls == 11);
  GIVES(tools, (OK, activate, h), (OK, activate, kNone));
  HOLDS(calls == 22);
  GIVES(tools, (E_STALE, activate, kNoSuch), (E_STALE, is_active, kNoSuch, &active), (E_ARG, is_active, h, NULL),
        (OK, remove, h), (E_STALE, remove, h), (OK, remove, stubborn));
  double marked[3] = {0, 0, 0};
  HOLDS(tools->rev >= 2);
  GIVES(tools, (OK, marked_point, marked));
  HOLDS(marked[0] == 1 && marked[1] == -2 && marked[2] == 3.5);
  GIVES(tools, (E_ARG, marked_point, NULL));
}

/* ---- history ---- */

static c3de_status C3DE_CALL take_back(void *self) {
  *(int *)self += 1;
  return C3DE_OK;
}
static c3de_status C3DE_CALL do_again(void *self) {
  *(int *)self += 10;
  return C3DE_OK;
}
static void C3DE_CALL release_edit(void *self) { *(int *)self += 100; }

static int begun;
static void C3DE_CALL begin(void *self, c3de_status status) { begun += status == C3DE_OK ? *(int *)self : 100; }

void drive_history(void) {
  const c3de_history_v1 *history = service(C3DE_HISTORY_ID);
  static int calls, quiet;
  c3de_edit edit = {sizeof edit, 1, TEXT("pull"), &calls, take_back, do_again, release_edit};
  c3de_handle h, none;
  calls = quiet = 0;
  GIVES(history, (OK, add, &edit, &h), (E_ARG, add, NULL, &none), (E_ARG, add, &edit, NULL));
  CHANGED(history, (E_ARG, add, &edit, &none), (edit.label, text(""), "label"), (edit.undo, NULL, ""),
          (edit.redo, NULL, ""), (edit.size, 8, ""));
  HOLDS(none.v == 0 && calls == 0);
  /* This host has no simulation to capture. */
  GIVES(history, (E_UNSUPPORTED, capture, &calls, begin), (E_STATE, add_captured, text("load")));
  GIVES(history, (E_STALE, remove, kNoSuch), (OK, remove, h));
  HOLDS(calls == 100);
  GIVES(history, (E_STALE, remove, h));
  /* Two stay for the test program to undo and redo; the second without release. */
  GIVES(history, (OK, add, &edit, &h));
  edit.label = text("quiet");
  edit.self = &quiet;
  edit.release = NULL;
  GIVES(history, (OK, add, &edit, &h));
}

/* After undo, undo, redo by the test program. */
void drive_history_after(void) {
  const c3de_history_v1 *history = service(C3DE_HISTORY_ID);
  static int last;
  c3de_edit edit = {sizeof edit, 1, TEXT("last"), &last, take_back, do_again, release_edit};
  c3de_handle h;
  GIVES(history, (OK, add, &edit, &h));
}

/* The test program begins what waits in between. */
void drive_history_capture(void) {
  const c3de_history_v1 *history = service(C3DE_HISTORY_ID);
  static int one = 1, ten = 10;
  begun = 0;
  HOLDS(history->rev >= 2);
  GIVES(history, (E_ARG, capture, &one, NULL), (OK, capture, &one, begin), (OK, capture, &ten, begin),
        (E_STATE, add_captured, text("load")));
  HOLDS(begun == 0);
}
void drive_history_captured(void) {
  const c3de_history_v1 *history = service(C3DE_HISTORY_ID);
  HOLDS(begun == 11);
  GIVES(history, (E_ARG, add_captured, text("")), (OK, add_captured, text("load")), (E_STATE, add_captured, text("load")));
}

/* ---- files, settings, commands ---- */

static c3de_status C3DE_CALL read_nothing(void *self, const c3de_mesh_source *source, const c3de_progress *progress,
                                          const c3de_mesh_sink *sink) {
  return C3DE_E_UNSUPPORTED;
}
static c3de_status C3DE_CALL write_nothing(void *self, const c3de_mesh_contents *mesh, const c3de_progress *progress,
                                           c3de_sink bytes) {
  return C3DE_E_UNSUPPORTED;
}

static void drive_writers(const c3de_files_v1 *files) {
  const c3de_str extensions[] = {TEXT("one"), TEXT("obj")};
  c3de_mesh_writer writer = {sizeof writer, 1, TEXT("test.reader"), TEXT("Writer"), extensions, 2, NULL, write_nothing};
  c3de_handle h, none;
  HOLDS(files->rev >= 2);
  GIVES(files, (OK, add_mesh_writer, &writer, &h)); /* a reader may have the same id */
  GIVES(files, (E_EXISTS, add_mesh_writer, &writer, &none));
  HOLDS(none.v == 0);
  GIVES(files, (E_ARG, add_mesh_writer, NULL, &none), (E_ARG, add_mesh_writer, &writer, NULL));
  writer.id = text("test.other");
  CHANGED(files, (E_ARG, add_mesh_writer, &writer, &none), (writer.write, NULL, "write"), (writer.extensions_n, 0, ""),
          (writer.size, 24, ""));
  GIVES(files, (OK, remove, h), (E_STALE, remove, h));
}

void drive_files(void) {
  const c3de_files_v1 *files = service(C3DE_FILES_ID);
  const c3de_str extensions[] = {TEXT("one"), TEXT("TWO")}, dotted[] = {TEXT(".one"), TEXT("two")};
  const c3de_str empty[] = {TEXT(""), TEXT("two")};
  c3de_mesh_reader reader = {sizeof reader, 1,    TEXT("test.reader"), TEXT("Reader"), extensions, 2,
                             TEXT(""),      NULL, read_nothing};
  c3de_handle h, none;
  GIVES(files, (OK, add_mesh_reader, &reader, &h));
  SAYS(files, "test.service_driver", (E_EXISTS, add_mesh_reader, &reader, &none));
  HOLDS(none.v == 0);
  reader.id = text("test.other");
  GIVES(files, (E_ARG, add_mesh_reader, NULL, &none), (E_ARG, add_mesh_reader, &reader, NULL));
  CHANGED(files, (E_ARG, add_mesh_reader, &reader, &none), (reader.extensions_n, 0, "extensions_n"),
          (reader.extensions, dotted, "without the dot"), (reader.extensions, empty, ""), (reader.extensions, NULL, ""),
          (reader.read, NULL, "read"), (reader.label, text(""), ""), (reader.id, text("a b"), ""),
          (reader.size, 16, ""));
  drive_writers(files);
  GIVES(files, (E_STALE, remove, kNoSuch), (OK, remove, h), (E_STALE, remove, h));
}

static c3de_status C3DE_CALL count_key(void *self, c3de_str key) {
  *(uint64_t *)self += key.len;
  return C3DE_OK;
}
static c3de_status C3DE_CALL stop_at_key(void *self, c3de_str key) {
  ++*(uint64_t *)self;
  return C3DE_S_TRUNCATED;
}

void drive_settings(void) {
  const c3de_settings_v1 *settings = service(C3DE_SETTINGS_ID);
  uint64_t bytes = 0, keys = 0, calls = 0;
  const c3de_sink sink = {&bytes, count_bytes};
  const c3de_str broken = {"\xff\xfe", 2};
  SAYS(settings, "colour", (E_NOT_FOUND, get, text("colour"), sink));
  GIVES(settings, (E_NOT_FOUND, remove, text("colour")), (OK, set, text("colour"), text("blue")),
        (OK, set, text("empty"), text("")), (OK, get, text("colour"), sink));
  HOLDS(bytes == 4);
  GIVES(settings, (OK, get, text("empty"), sink));
  HOLDS(bytes == 4);
  GIVES(settings, (E_ARG, get, text("colour"), no_sink), (E_ARG, get, text(""), sink));
  SAYS(settings, "key", (E_ARG, set, text("a b"), text("c")));
  SAYS(settings, "UTF-8", (E_ARG, set, text("bytes"), broken));
  GIVES(settings, (OK, keys, &keys, count_key));
  HOLDS(keys == strlen("colour") + strlen("empty"));
  GIVES(settings, (S_TRUNCATED, keys, &calls, stop_at_key));
  HOLDS(calls == 1);
  GIVES(settings, (E_ARG, keys, &calls, NULL), (OK, remove, text("empty")), (E_NOT_FOUND, get, text("empty"), sink));
}

static const c3de_commands_v1 *kept_commands;
static c3de_status C3DE_CALL count_run(void *self) {
  ++*(int *)self;
  return C3DE_OK;
}
static c3de_status C3DE_CALL fail_to_run(void *self) {
  host->set_error(host->ctx, C3DE_E_STATE, text("there is no organ"));
  return C3DE_E_STATE;
}
static c3de_status C3DE_CALL run_itself(void *self) {
  return kept_commands->run(kept_commands->ctx, text("test.again"));
}

void drive_commands(void) {
  const c3de_commands_v1 *commands = service(C3DE_COMMANDS_ID);
  kept_commands = commands;
  static int runs;
  c3de_command command = {sizeof command, 1,     TEXT("test.count"), TEXT("Count"), TEXT("Counts."), 'Q',
                          C3DE_MOD_CTRL,  &runs, count_run};
  c3de_handle count, other, none;
  runs = 0;
  GIVES(commands, (S_NO_SHORTCUT, add, &command, &count));
  SAYS(commands, "test.service_driver", (E_EXISTS, add, &command, &none));
  GIVES(commands, (OK, run, text("test.count")));
  HOLDS(runs == 1);
  command.id = text("test.fail");
  command.key = 'K';
  command.modifiers = C3DE_MOD_CTRL | C3DE_MOD_SHIFT;
  command.run = fail_to_run;
  GIVES(commands, (OK, add, &command, &other));
  SAYS(commands, "there is no organ", (E_STATE, run, text("test.fail")));
  command.id = text("test.again");
  command.run = run_itself;
  GIVES(commands, (S_NO_SHORTCUT, add, &command, &none));
  SAYS(commands, "running already", (E_STATE, run, text("test.again")));
  GIVES(commands, (OK, remove, none));
  command.id = text("test.next");
  GIVES(commands, (E_ARG, add, NULL, &none), (E_ARG, add, &command, NULL));
  CHANGED(commands, (E_ARG, add, &command, &none), (command.modifiers, 0, "C3DE_MOD_CTRL"),
          (command.modifiers, 64, ""));
  command.modifiers = C3DE_MOD_ALT;
  CHANGED(commands, (E_ARG, add, &command, &none), (command.key, 'k', "'A' to 'Z'"));
  command.key = 0;
  CHANGED(commands, (E_ARG, add, &command, &none), (command.title, text(""), ""), (command.run, NULL, ""),
          (command.size, 16, ""));
  GIVES(commands, (OK, set_enabled, count, 0));
  SAYS(commands, "not enabled", (E_STATE, run, text("test.count")));
  GIVES(commands, (OK, set_enabled, count, 1), (OK, run, text("test.count")));
  HOLDS(runs == 2);
  SAYS(commands, "did you mean test.count?", (E_NOT_FOUND, run, text("test.cuont")));
  GIVES(commands, (E_STALE, set_enabled, kNoSuch, 1), (OK, remove, count), (E_STALE, remove, count));
}
