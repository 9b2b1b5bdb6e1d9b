// SPDX-License-Identifier: Apache-2.0
#include "commands/run_exports.h"

#include "c3de/core/file_path.h"
#include "c3de/core/log.h"
#include "c3de/core/output_file.h"
#include "c3de/session/export_image.h"
#include "c3de/session/interrupt.h"
#include "c3de/session/progress_line.h"
#include "c3de/session/saved_session.h"
#include "c3de/session/simulation_state.h"
#include "c3de/session/simulator_access.h"

namespace c3de::app {
namespace {

/// @param beginning  the session that is continued, if there is one
Expected<void> writeSession(const RunOptions &options, Session &session, c3de_object *simulator,
                            const SimulatorIdentity &identity, const RunBeginning &beginning) {
  const auto captured = captureState(session, simulator, identity, session.changes()->source());
  if (!captured) return tl::unexpected(captured.error());
  ProgressLine line(options.quiet);
  const ProgressFn report = [&line](double fraction, const std::string &what) {
    line.update(fraction, what);
    return !wasInterrupted();
  };
  const std::filesystem::path folder = absolutePath(options.saveSession).parent_path();
  const Embedding embedding = options.embed ? Embedding::all : Embedding::extracted;
  FileReferences references;
  auto saved = sessionOf(*captured, folder, references, report, embedding);
  if (!saved) return tl::unexpected(saved.error());
  if (beginning.saved && !beginning.replay)
    if (auto kept = keepRest(*beginning.saved, beginning.files, folder, references, embedding, *saved); !kept)
      return kept;
  auto written = session::writeSession(*saved, options.saveSession, report);
  line.finish();
  return written;
}

}  // namespace

Expected<void> writeImageExports(const RunOptions &options, Session &session, const scene::SceneFile &scene,
                                 BodySources &sources, const Prepared &prepared, const c3de_simulator_v1 *table,
                                 c3de_object *simulator, WrittenOutputs &outputs) {
  const auto image = imageOfScene(scene, sources);
  if (!image) return tl::unexpected(image.error());
  const auto how = imageWarpOf(scene, sources, session.materials(), prepared.tissues);
  if (!how) return tl::unexpected(how.error());
  const ImageExport &wanted = options.exportImage;
  const auto u = presentDisplacement(table, simulator, **image, *how);
  for (const auto &file : {wanted.image, wanted.displacement}) {
    if (file.empty()) continue;
    const ImageExport one = file == wanted.image ? ImageExport{file, {}, {}} : ImageExport{{}, file, {}};
    const auto summary = u ? writeImages(one, **image, isImageOfLabels(scene), *u, {}, &session.pool())
                           : Expected<std::string>(tl::unexpected(u.error()));
    if (summary) log(LogLevel::info, *summary);
    const Expected<void> written = summary ? Expected<void>() : Expected<void>(tl::unexpected(summary.error()));
    outputs.note(file, written);
    if (file == wanted.displacement && summary) outputs.note(emptiedFile(file), written);
  }
  if (wanted.labels.empty()) return {};
  const auto layers = labelsToExport(scene, sources);
  if (!layers) return tl::unexpected(layers.error());
  std::vector<const imaging::LabelMap *> maps;
  for (const imaging::LabelMap &layer : **layers) maps.push_back(&layer);
  const auto summary = u ? writeLabels(wanted.labels, maps, (*image)->geometry, *u, {}, &session.pool())
                         : Expected<std::string>(tl::unexpected(u.error()));
  if (summary) log(LogLevel::info, *summary);
  for (const std::filesystem::path &file : labelFiles(wanted.labels, (*layers)->size()))
    outputs.note(file, summary ? Expected<void>() : Expected<void>(tl::unexpected(summary.error())));
  return {};
}

void saveEnd(const RunOptions &options, Session &session, c3de_object *simulator, const SimulatorIdentity &identity,
             const RunBeginning &beginning, WrittenOutputs &outputs) {
  if (!options.saveState.empty()) {
    const auto state = stateBytes(session, simulator, identity);
    outputs.note(options.saveState,
                 state ? writeWholeFile(options.saveState, *state) : Expected<void>(tl::unexpected(state.error())));
  }
  if (!options.saveSession.empty())
    outputs.note(options.saveSession, writeSession(options, session, simulator, identity, beginning));
}

}  // namespace c3de::app
