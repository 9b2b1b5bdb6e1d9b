// SPDX-License-Identifier: Apache-2.0
// The functions of c3de/embed.h: arguments, handles, errors. No exception leaves them.
#include "c3de/embed.h"

#include <fmt/format.h>

#ifndef _WIN32
#include <pthread.h>
#endif

#include <atomic>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <utility>

#include "c3de/core/assert.h"
#include "c3de/core/embedding.h"
#include "c3de/core/log.h"
#include "c3de/core/per_thread.h"
#include "c3de/core/text.h"
#include "c3de/session/recording_file.h"
#include "guarded_calls.h"

namespace c3de::embed {

std::string &lastError() { return perThread<std::string, struct LastErrorTag>(); }

namespace {

// Never destroyed: calls may come while the process ends.
std::atomic<OpenObjects *> openNow{nullptr};

#ifndef _WIN32
/// Numbers continue, so that those of the parent are refused.
void renewInForkedProcess() {
  auto *fresh = new OpenObjects;
  fresh->last = openNow.load()->last;
  openNow = fresh;
}
#endif

}  // namespace

OpenObjects &openObjects() {
  static const bool isMade = [] {
    setEmbedded();
    // Of a broken precondition the caller receives a status.
    setAssertHandler([](const char *condition, const char *text, const char *file, int line) {
      throw std::logic_error(fmt::format("{} ({}) at {}:{}", text, condition, file, line));
    });
    openNow = new OpenObjects;
#ifndef _WIN32
    (void)pthread_atfork(nullptr, nullptr, &renewInForkedProcess);
#endif
    return true;
  }();
  (void)isMade;
  return *openNow;
}

namespace {

std::string notOpen(const char *what, std::uint64_t number) {
  return fmt::format("{} {} is not open: it has been closed, or was opened before this process was forked", what,
                     number);
}

}  // namespace

Result<std::shared_ptr<EmbeddedSimulation>> findSimulation(c3de_sim sim) {
  const std::lock_guard lock(openObjects().mutex);
  const auto found = openObjects().simulations.find(sim);
  if (found != openObjects().simulations.end()) return found->second;
  if (sim == 0) return refuse(C3DE_E_ARG, "the simulation is 0; accepted: one that c3de_embed_open() has opened");
  return refuse(C3DE_E_STALE, notOpen("simulation", sim));
}

Result<std::shared_ptr<const WarpedImage>> findImage(c3de_image image) {
  const std::lock_guard lock(openObjects().mutex);
  const auto found = openObjects().images.find(image);
  if (found != openObjects().images.end()) return found->second;
  if (image == 0) return refuse(C3DE_E_ARG, "the image is 0; accepted: one that c3de_embed_warp() has made");
  return refuse(C3DE_E_STALE, notOpen("image", image));
}

ProgressFn progressOf(c3de_embed_progress call, void *self) {
  if (call == nullptr) return [](double, const std::string &) { return true; };
  return [call, self](double fraction, const std::string &what) { return call(self, fraction, what.c_str()) == 0; };
}

Result<EmbeddedSimulation::Run> runOf(const c3de_embed_run_options *options) {
  c3de_embed_run_options in{};
  if (options != nullptr) {
    const auto read = readStruct(options, "options");
    if (!read) return tl::unexpected(read.error());
    in = *read;
  }
  if (!std::isfinite(in.until_s) || in.until_s < 0.0)
    return refuse(C3DE_E_ARG, fmt::format("until_s is {} s; accepted: finite, >= 0", in.until_s));
  if (!std::isfinite(in.stepped_every_s) || in.stepped_every_s < 0.0)
    return refuse(C3DE_E_ARG, fmt::format("stepped_every_s is {} s; accepted: finite, >= 0", in.stepped_every_s));
  EmbeddedSimulation::Run run;
  run.maxSteps = in.max_steps;
  run.until_s = in.until_s;
  run.every_s = in.stepped_every_s;
  run.failsWithStoppedBodies = true;
  if (in.stepped != nullptr)
    run.stepped = [call = in.stepped, self = in.stepped_self](const c3de_embed_status &status, double fraction) {
      return call(self, &status, fraction) == 0;
    };
  return run;
}

namespace {

Result<void> addTexts(const char *const *texts, std::uint64_t n, const char *name,
                      const std::function<void(const char *)> &add) {
  if (n == 0) return {};
  if (auto good = notNull(static_cast<const void *>(texts), name); !good) return good;
  for (std::uint64_t i = 0; i < n; ++i) {
    if (texts[i] == nullptr) return refuse(C3DE_E_ARG, fmt::format("{}[{}] is null", name, i));
    add(texts[i]);
  }
  return {};
}

Result<EmbeddedSimulation::Request> requestOf(const c3de_embed_options *options) {
  const auto in = readStruct(options, "options");
  if (!in) return tl::unexpected(in.error());
  if (in->file == nullptr && in->text == nullptr)
    return refuse(C3DE_E_ARG, "file and text are null; accepted: one of them at least");
  if (in->threads > 1024) return refuse(C3DE_E_ARG, fmt::format("threads is {}; accepted: 0 to 1024", in->threads));
  EmbeddedSimulation::Request request;
  session::RunOptions &run = request.options;
  run.scene = pathFromText(in->file != nullptr ? in->file : "scene.toml");
  if (in->text != nullptr) {
    run.sceneText = in->text;
    if (run.sceneText.empty()) return refuse(C3DE_E_ARG, "text is empty; accepted: a scene as TOML");
    if (!scene::isScenePath(run.scene))
      return refuse(C3DE_E_ARG, fmt::format("file is '{}'; accepted beside text: a name that ends with .toml",
                                            pathText(run.scene)));
  }
  run.session.searchPlugins = (in->flags & C3DE_EMBED_NO_PLUGIN_SEARCH) == 0;
  run.session.threads = in->threads;
  run.quiet = true;
  run.isReplay = in->text == nullptr && session::isRecordingPath(run.scene);
  run.checkHashes = run.isReplay;
  const auto addTo = [](std::vector<std::filesystem::path> &list) {
    return [&list](const char *text) { list.push_back(pathFromText(text)); };
  };
  auto good = addTexts(in->assign, in->assign_n, "assign", [&](const char *text) { run.overrides.emplace_back(text); });
  if (good) good = addTexts(in->plugin_files, in->plugin_files_n, "plugin_files", addTo(run.session.pluginFiles));
  if (good)
    good = addTexts(in->plugin_folders, in->plugin_folders_n, "plugin_folders", addTo(run.session.pluginFolders));
  if (!good) return tl::unexpected(good.error());
  request.progress = progressOf(in->progress, in->progress_self);
  return request;
}

}  // namespace
}  // namespace c3de::embed

using namespace c3de;         // NOLINT(google-build-using-namespace): C functions below
using namespace c3de::embed;  // NOLINT(google-build-using-namespace)
using Simulation = EmbeddedSimulation;

uint32_t c3de_embed_revision(void) { return C3DE_EMBED_REV; }
const char *c3de_embed_version(void) { return C3DE_VERSION; }
const char *c3de_embed_last_error(void) { return lastError().c_str(); }

void c3de_embed_set_log(void(C3DE_CALL *log)(void *self, int32_t level, const char *line), void *self) {
  (void)guarded([&]() -> Result<void> {
    (void)openObjects();
    if (log == nullptr)
      setLogListener({});
    else
      setLogListener([log, self](LogLevel level, const std::string &line) {
        log(self, static_cast<int32_t>(level), line.c_str());
      });
    return {};
  });
}

c3de_status c3de_embed_open(const c3de_embed_options *options, c3de_sim *out) {
  if (out != nullptr) *out = 0;
  return guarded([&]() -> Result<void> {
    if (auto good = notNull(out, "out"); !good) return good;
    OpenObjects &all = openObjects();
    auto request = requestOf(options);
    if (!request) return tl::unexpected(request.error());
    auto made = Simulation::open(std::move(*request));
    if (!made) return tl::unexpected(made.error());
    const std::lock_guard lock(all.mutex);
    all.simulations.emplace(++all.last, std::move(*made));
    *out = all.last;
    return {};
  });
}

c3de_status c3de_embed_close(c3de_sim sim) {
  if (sim == 0) return C3DE_OK;
  return guarded([&]() -> Result<void> {
    const auto found = findSimulation(sim);
    if (!found) return tl::unexpected(found.error());
    const std::shared_ptr<Simulation> closing = *found;
    if (auto closed = closing->close(); !closed) return closed;
    const std::lock_guard lock(openObjects().mutex);
    openObjects().simulations.erase(sim);
    return {};
  });
}

c3de_status c3de_embed_parameter_count(c3de_sim sim, uint64_t *out) {
  return callWithResult(sim, out, "out", [](Simulation &of) { return of.parameterCount(); });
}
c3de_status c3de_embed_parameter_at(c3de_sim sim, uint64_t index, c3de_embed_parameter *out) {
  return callWithStruct(sim, out, [&](Simulation &of) { return of.parameterAt(index); });
}
c3de_status c3de_embed_get(c3de_sim sim, const char *path, c3de_embed_value *out) {
  return callWithStruct(sim, out, [&](Simulation &of) -> Result<c3de_embed_value> {
    if (auto good = notNull(path, "path"); !good) return tl::unexpected(good.error());
    return of.get(path);
  });
}
c3de_status c3de_embed_set(c3de_sim sim, const char *path, const char *text) {
  return callWithoutResult(sim, [&](Simulation &of) -> Result<void> {
    if (auto good = notNull(path, "path"); !good) return good;
    if (auto good = notNull(text, "text"); !good) return good;
    return of.set(path, text);
  });
}

c3de_status c3de_embed_get_status(c3de_sim sim, c3de_embed_status *out) {
  return callWithStruct(sim, out, [](Simulation &of) { return of.status(); });
}

c3de_status c3de_embed_step(c3de_sim sim, uint64_t n, uint64_t *done) {
  std::uint64_t made = 0;
  const c3de_status code = callWithoutResult(sim, [&](Simulation &of) -> Result<void> {
    if (n == 0) return {};
    Simulation::Run run;
    run.maxSteps = n;
    return of.run(run, made);
  });
  if (done != nullptr) *done = made;
  return code;
}

c3de_status c3de_embed_run(c3de_sim sim, const c3de_embed_run_options *options) {
  return callWithoutResult(sim, [&](Simulation &of) -> Result<void> {
    const auto run = runOf(options);
    if (!run) return tl::unexpected(run.error());
    std::uint64_t made = 0;
    return of.run(*run, made);
  });
}

c3de_status c3de_embed_cancel(c3de_sim sim) {
  return callWithoutResult(sim, [](Simulation &of) -> Result<void> {
    of.cancel();
    return {};
  });
}
c3de_status c3de_embed_reset(c3de_sim sim) {
  return callWithoutResult(sim, [](Simulation &of) { return of.reset(); });
}
c3de_status c3de_embed_state_hash(c3de_sim sim, uint64_t *out) {
  return callWithResult(sim, out, "out", [](Simulation &of) { return of.stateHash(); });
}

c3de_status c3de_embed_body_at(c3de_sim sim, uint64_t index, c3de_embed_body *out) {
  return callWithStruct(sim, out, [&](Simulation &of) { return of.bodyAt(index); });
}
c3de_status c3de_embed_find_body(c3de_sim sim, const char *name, uint64_t *index) {
  return callWithResult(sim, index, "index", [&](Simulation &of) -> Result<std::uint64_t> {
    if (auto good = notNull(name, "name"); !good) return tl::unexpected(good.error());
    return of.findBody(name);
  });
}
c3de_status c3de_embed_field_at(c3de_sim sim, uint64_t body, uint32_t on, uint64_t index, c3de_embed_field *out) {
  return callWithStruct(sim, out, [&](Simulation &of) { return of.fieldAt(body, on, index); });
}
c3de_status c3de_embed_view_field(c3de_sim sim, uint64_t body, uint32_t on, const char *name, c3de_embed_array *out) {
  return callWithStruct(sim, out, [&](Simulation &of) -> Result<c3de_embed_array> {
    if (auto good = notNull(name, "name"); !good) return tl::unexpected(good.error());
    return of.viewField(body, on, name);
  });
}
c3de_status c3de_embed_read_field(c3de_sim sim, uint64_t body, uint32_t on, const char *name, double *data,
                                  uint64_t bytes) {
  return callWithoutResult(sim, [&](Simulation &of) -> Result<void> {
    if (auto good = notNull(name, "name"); !good) return good;
    if (bytes != 0)
      if (auto good = notNull(data, "data"); !good) return good;
    return of.readField(body, on, name, data, bytes);
  });
}
c3de_status c3de_embed_view_triangles(c3de_sim sim, uint64_t body, c3de_embed_array *out) {
  return callWithStruct(sim, out, [&](Simulation &of) { return of.viewTriangles(body); });
}

c3de_status c3de_embed_events(c3de_sim sim, const char **json) {
  return callWithResult(sim, json, "json", [](Simulation &of) { return of.events(); });
}
c3de_status c3de_embed_report(c3de_sim sim, const char **json) {
  return callWithResult(sim, json, "json", [](Simulation &of) { return of.report(); });
}

c3de_status c3de_embed_save_state(c3de_sim sim, const char *file) {
  return callWithFile(sim, file, [](Simulation &of, const auto &path) { return of.saveState(path); });
}
c3de_status c3de_embed_load_state(c3de_sim sim, const char *file) {
  return callWithFile(sim, file, [](Simulation &of, const auto &path) { return of.loadState(path); });
}
c3de_status c3de_embed_save_session(c3de_sim sim, const char *file) {
  return callWithFile(sim, file, [](Simulation &of, const auto &path) { return of.saveSession(path); });
}

c3de_status c3de_embed_hold_body(c3de_sim sim, uint64_t body, const c3de_embed_hold *hold, uint64_t *out) {
  return callWithResult(sim, out, "out", [&](Simulation &of) -> Result<std::uint64_t> {
    const auto in = readStruct(hold, "hold");
    if (!in) return tl::unexpected(in.error());
    return of.hold(body, *in);
  });
}
c3de_status c3de_embed_pull(c3de_sim sim, uint64_t hold, const double *target_m) {
  return callWithoutResult(sim, [&](Simulation &of) -> Result<void> {
    if (auto good = notNull(target_m, "target_m"); !good) return good;
    for (int axis = 0; axis < 3; ++axis)
      if (!std::isfinite(target_m[axis]))
        return refuse(C3DE_E_ARG, fmt::format("target_m[{}] is {}; accepted: finite", axis, target_m[axis]));
    return of.pull(hold, target_m);
  });
}
c3de_status c3de_embed_hold_read(c3de_sim sim, uint64_t hold, c3de_embed_hold_state *out) {
  return callWithStruct(sim, out, [&](Simulation &of) { return of.holdState(hold); });
}
c3de_status c3de_embed_release(c3de_sim sim, uint64_t hold) {
  return callWithoutResult(sim, [&](Simulation &of) { return of.release(hold); });
}
