// SPDX-License-Identifier: Apache-2.0
// The functions of c3de/embed.h that revision 2 added: supports and loads, the deformed scan, recordings.
#include "guarded_calls.h"

using namespace c3de;         // NOLINT(google-build-using-namespace): C functions below
using namespace c3de::embed;  // NOLINT(google-build-using-namespace)

c3de_status c3de_embed_set_condition(c3de_sim sim, uint64_t body, const c3de_embed_condition *what,
                                     uint64_t *condition) {
  return callWithoutResult(sim, [&](EmbeddedSimulation &of) -> Result<void> {
    if (auto good = notNull(condition, "condition"); !good) return good;
    const auto in = readStruct(what, "what");
    if (!in) return tl::unexpected(in.error());
    const auto set = of.setCondition(body, *in, *condition);
    if (!set) return tl::unexpected(set.error());
    *condition = *set;
    return {};
  });
}
c3de_status c3de_embed_condition_read(c3de_sim sim, uint64_t condition, c3de_embed_condition_state *out) {
  return callWithStruct(sim, out, [&](EmbeddedSimulation &of) { return of.conditionState(condition); });
}
c3de_status c3de_embed_remove_condition(c3de_sim sim, uint64_t condition) {
  return callWithoutResult(sim, [&](EmbeddedSimulation &of) { return of.removeCondition(condition); });
}

c3de_status c3de_embed_warp(c3de_sim sim, uint32_t what, c3de_embed_progress progress, void *progress_self,
                            c3de_image *out) {
  if (out != nullptr) *out = 0;
  return callWithResult(sim, out, "out", [&](EmbeddedSimulation &of) -> Result<c3de_image> {
    auto made = of.warp(what, progressOf(progress, progress_self));
    if (!made) return tl::unexpected(made.error());
    OpenObjects &all = openObjects();
    const std::lock_guard lock(all.mutex);
    all.images.emplace(++all.last, std::move(*made));
    return all.last;
  });
}
c3de_status c3de_embed_image_voxels(c3de_image image, uint64_t layer, c3de_embed_voxels *out) {
  return guarded([&]() -> Result<void> {
    return writeStruct(out, [&]() -> Result<c3de_embed_voxels> {
      const auto found = findImage(image);
      if (!found) return tl::unexpected(found.error());
      return (*found)->voxels(layer);
    });
  });
}
c3de_status c3de_embed_image_label(c3de_image image, uint64_t layer, uint64_t index, c3de_embed_label *out) {
  return guarded([&]() -> Result<void> {
    return writeStruct(out, [&]() -> Result<c3de_embed_label> {
      const auto found = findImage(image);
      if (!found) return tl::unexpected(found.error());
      return (*found)->label(layer, index);
    });
  });
}
c3de_status c3de_embed_image_save(c3de_image image, const char *file) {
  return guarded([&]() -> Result<void> {
    if (auto good = notNull(file, "file"); !good) return good;
    const auto found = findImage(image);
    if (!found) return tl::unexpected(found.error());
    return (*found)->save(pathFromText(file));
  });
}
c3de_status c3de_embed_image_close(c3de_image image) {
  if (image == 0) return C3DE_OK;
  return guarded([&]() -> Result<void> {
    auto found = findImage(image);  // destroyed after the lock
    if (!found) return tl::unexpected(found.error());
    const std::lock_guard lock(openObjects().mutex);
    openObjects().images.erase(image);
    return {};
  });
}

c3de_status c3de_embed_record(c3de_sim sim, const char *file, uint64_t hash_every) {
  return callWithFile(sim, file, [&](EmbeddedSimulation &of, const auto &path) { return of.record(path, hash_every); });
}
c3de_status c3de_embed_end_recording(c3de_sim sim) {
  return callWithoutResult(sim, [](EmbeddedSimulation &of) { return of.endRecording(); });
}
c3de_status c3de_embed_replay(c3de_sim sim, const c3de_embed_run_options *options, c3de_embed_replay_state *out) {
  c3de_embed_replay_state unused{};
  unused.size = sizeof unused;
  return callWithoutResult(sim, [&](EmbeddedSimulation &of) -> Result<void> {
    const auto run = runOf(options);
    if (!run) return tl::unexpected(run.error());
    Result<void> replayed;
    // Also after a failure: how far it has come.
    auto written = writeStruct(out != nullptr ? out : &unused, [&]() -> Result<c3de_embed_replay_state> {
      replayed = of.replay(*run);
      return of.replayState();
    });
    return replayed ? written : replayed;
  });
}
