// SPDX-License-Identifier: Apache-2.0
#include "commands/match_scene.h"

#include <fmt/format.h>

#include <algorithm>

#include "c3de/core/log.h"
#include "c3de/core/output_file.h"
#include "c3de/core/path_text.h"
#include "c3de/core/text.h"
#include "c3de/session/body_sources.h"
#include "c3de/session/build_scene.h"
#include "c3de/session/change_log.h"
#include "c3de/session/export_image.h"
#include "c3de/session/headless_run.h"
#include "c3de/session/interrupt.h"
#include "c3de/session/match_stages.h"
#include "c3de/session/progress_line.h"
#include "c3de/session/rigid_match.h"
#include "c3de/session/run_beginning.h"
#include "c3de/session/saved_session.h"
#include "c3de/session/simulator_access.h"
#include "c3de/session/written_outputs.h"
#include "commands/exit_code.h"
#include "commands/last_crash.h"
#include "commands/run_exports.h"
#include "commands/scene_at_rest.h"
#include "commands/standard_output.h"

namespace c3de::app {
namespace {

using scene::SceneMatch;

/// The options replace the keys of the scene; a source replaces any other.
Expected<void> addOptions(const MatchOptions &options, SceneMatch &match) {
  if (!options.body.empty()) match.body = options.body;
  const bool isSource = !options.surface.empty() || !options.points.empty() || !options.labels.empty();
  if (isSource) {
    match.surface = options.surface;
    match.points = options.points;
    if (options.labels.empty()) match.labels = {};
    match.labels.file = options.labels;
    match.unit.reset();
  }
  if (!options.label.empty())
    if (auto good = setMatchLabel(options.label, match); !good) return good;
  if (!options.unit.empty()) {
    const auto unit = scene::parseLengthUnit(options.unit);
    if (!unit) return fail(ErrorCode::usage, "--measured-unit: " + unit.error().message);
    match.unit = *unit;
  }
  if (!options.landmarks.empty()) match.landmarks = options.landmarks;
  if (options.noise_mm) match.noise_mm = *options.noise_mm;
  if (!options.use.empty()) match.fitsLandmarks = options.use == "fit";
  if (options.weight) match.landmarkWeight = *options.weight;
  if (options.isRigid) match.deforms = false;
  return {};
}

/// The match of the scene with the options. Errors begin with the location in the scene, where it is wrong alone.
Expected<SceneMatch> matchOf(const MatchOptions &options, const scene::SceneFile &scene) {
  SceneMatch match = scene.match.value_or(SceneMatch{});
  if (auto good = addOptions(options, match); !good) return tl::unexpected(good.error());
  if (const auto good = scene::completeMatch(scene, match); !good) {
    const std::string hint =
        scene.match ? "" : "; " + scene.where(1) + " has no [match], see --surface, --points, --labels";
    return fail(ErrorCode::usage, good.error().message + hint);
  }
  const bool hasTargets = std::any_of(scene.landmarks.begin(), scene.landmarks.end(),
                                      [](const scene::SceneLandmark &one) { return one.target_m.has_value(); });
  if (match.landmarks.empty() && !hasTargets && (match.fitsLandmarks || options.weight))
    return fail(ErrorCode::usage,
                "--use and --weight are for landmarks with a measured position, and there are none; accepted: with "
                "--target-landmarks, or targets in the scene");
  if (options.weight && !match.fitsLandmarks)
    return fail(ErrorCode::usage, "--weight is for landmarks that are fitted; accepted: with --use fit");
  return match;
}

std::vector<std::filesystem::path> outputsOf(const MatchOptions &options) {
  const ImageExport &image = options.run.exportImage;
  return {options.run.report, options.run.exportSurface, options.residuals,     image.image,
          image.labels,       image.displacement,        options.run.saveState, options.run.saveSession};
}

Expected<void> checkOutputFiles(const MatchOptions &options, const scene::SceneFile *scene, const SceneMatch *match) {
  std::vector<std::filesystem::path> inputs;
  if (scene != nullptr) {
    scene::SceneFile named = *scene;
    inputs = {options.run.scene};
    for (const std::filesystem::path *file : filesOf(named)) inputs.push_back(*file);
    inputs.insert(inputs.end(), {match->surface, match->points, match->labels.file, match->landmarks});
  }
  return checkOutputs(outputsOf(options), inputs);
}

/// Deforms the body at its rigid motion, with its landmarks. Errors: cancelled, and those of the landmarks.
Expected<ElasticMatch> deform(const scene::SceneFile &scene, const SceneMatch &wanted, const MatchTargets &targets,
                              const std::vector<Landmark> &landmarks, const RigidMatch &rigid, Session &session,
                              c3de_object *simulator, const ProgressFn &progress) {
  if (!wanted.deforms || !rigid.isUsable()) return ElasticMatch{};
  const auto takeError = [&session] { return session.plugins().takeError(); };
  auto out = deformBody(simulator, nameInSimulator(scene, wanted.body), rigid, targets, landmarks, wanted,
                        session.plugins().ownerOf(simulator), takeError, progress);
  if (!out) return out;
  if (const auto now =
          unrecorded(session.changes(), [&] { return measureLandmarks(simulator, landmarks, rigid, takeError, *out); });
      !now)
    return tl::unexpected(now.error());
  return out;
}

struct Matched {
  RigidMatch match;
  ElasticMatch elastic;
  std::vector<std::string> notices;
  [[nodiscard]] const Mat4 &measuredFromBody() const {
    return elastic.body ? elastic.body->measuredFromBody : match.rigid.measuredFromBody;
  }
};

/// Writes what was requested. The failure of one file does not prevent the others.
Expected<void> writeOutputs(const MatchOptions &options, Session &session, const geometry::TriangleMesh &skin,
                            const MatchTargets &targets, const Matched &matched, const RunFacts &facts,
                            const HeadlessRun &run, WrittenOutputs &outputs) {
  if (!options.run.report.empty())
    if (auto good = writeReport(options.run.report, facts, run, outputs); !good) return good;
  if (!options.residuals.empty())
    outputs.note(options.residuals,
                 writeWholeFile(options.residuals, residualTable(targets, matched.match, matched.elastic)));
  if (!options.run.exportSurface.empty()) {
    geometry::TriangleMesh moved = skin;
    for (Vec3 &v : moved.vertices) v = transformPoint(matched.measuredFromBody(), v);
    outputs.note(options.run.exportSurface, session.meshFormats().write(options.run.exportSurface, moved, {}));
  }
  return {};
}

/// Writes the matched state and the image that it deforms, where requested.
Expected<void> writeState(const RunOptions &options, Session &session, const scene::SceneFile &scene,
                          BodySources &sources, const Prepared &prepared, const c3de_simulator_v1 *table,
                          c3de_object *simulator, const SimulatorIdentity &identity, const RunBeginning &beginning,
                          WrittenOutputs &outputs) {
  saveEnd(options, session, simulator, identity, beginning, outputs);
  if (!options.exportImage.isWanted()) return {};
  return writeImageExports(options, session, scene, sources, prepared, table, simulator, outputs);
}

Expected<Matched> match(const MatchOptions &options, Session &session, WrittenOutputs &outputs) {
  ProgressLine line(options.run.quiet);
  const ProgressFn progress = [&line](double fraction, const std::string &what) {
    line.update(fraction, what);
    return !wasInterrupted();
  };
  const auto beginning = readBeginning(options.run, session, progress);
  if (!beginning) return tl::unexpected(beginning.error());
  if (beginning->saved || beginning->replay)
    return fail(ErrorCode::usage, pathText(options.run.scene) + ": not a scene; accepted: a scene (.toml) or a mesh");
  const SharedScene scene = std::get<SharedScene>(beginning->source.front());
  const auto wanted = matchOf(options, *scene);
  if (!wanted) return tl::unexpected(wanted.error());
  if (const auto good = checkOutputFiles(options, scene.get(), &*wanted); !good) return tl::unexpected(good.error());
  if (!options.run.exportSurface.empty())
    if (const auto good = session.meshFormats().checkWritable(options.run.exportSurface); !good)
      return tl::unexpected(good.error());

  if (const auto good = checkImageExport(options.run.exportImage, *scene); !good) return tl::unexpected(good.error());
  BodySources sources;
  const auto targets = readMatchTargets(*wanted, session.meshFormats(), sources, progress);
  if (!targets) return tl::unexpected(targets.error());
  std::vector<std::filesystem::path> targetFiles;
  if (!wanted->landmarks.empty()) targetFiles.push_back(wanted->landmarks);
  const auto all = landmarksOf(*scene, options.run.landmarks, targetFiles);
  if (!all) return tl::unexpected(all.error());
  const auto built = buildAtRest(session, *scene, sources, progress);
  if (!built) return tl::unexpected(built.error());
  c3de_object *const simulator = built->simulator.get();
  const auto takeError = [&session] { return session.plugins().takeError(); };
  const std::string name = nameInSimulator(*scene, wanted->body);
  const auto skins = skinsOf(simulator, name, takeError);
  if (!skins) return tl::unexpected(skins.error());
  const auto landmarks = landmarksOfBody(simulator, *scene, *all, *wanted, name, takeError);
  if (!landmarks) return tl::unexpected(landmarks.error());
  auto rigid = findMotion(skins->rest, *targets, *landmarks, *wanted, &session.pool(), progress);
  if (!rigid) return tl::unexpected(rigid.error());
  Matched out{std::move(*rigid), {}, targets->notices};
  line.finish();

  // A run without a step has the facts of a report.
  RunOptions still = options.run;
  still.steps = 0;
  still.report.clear();
  still.exportSurface.clear();
  still.exportImage = {};
  still.saveState.clear();
  still.saveSession.clear();
  HeadlessRun run(session, simulator, built->table, still, {}, outputs, beginning->source);
  if (const auto ran = run.run(); !ran) return tl::unexpected(ran.error());
  // The session has adopted the simulator and logs its changes now.
  auto elastic = deform(*scene, *wanted, *targets, *landmarks, out.match, session, simulator, progress);
  if (!elastic) return tl::unexpected(elastic.error());
  out.elastic = std::move(*elastic);
  line.finish();
  RunFacts facts = built->facts(run, *scene, options.run.scene);
  facts.match = matchJson(out.match, out.elastic);
  if (!out.match.isUsable()) facts.outcome = "failed", facts.failure = failureOf(out.match);
  const auto matched = skinsOf(simulator, name, takeError);
  if (!matched) return tl::unexpected(matched.error());
  if (const auto good = writeOutputs(options, session, matched->present, *targets, out, facts, run, outputs); !good)
    return tl::unexpected(good.error());
  if (out.match.isUsable())
    if (const auto good = writeState(options.run, session, *scene, sources, built->prepared, built->table, simulator,
                                     built->identity, *beginning, outputs);
        !good)
      return tl::unexpected(good.error());
  out.notices.insert(out.notices.end(), built->prepared.notices.begin(), built->prepared.notices.end());
  return out;
}

}  // namespace

int matchScene(const MatchOptions &options) {
  watchForInterrupt();
  if (const auto good = checkOutputFiles(options, nullptr, nullptr); !good) return reportError(good.error());
  const auto journal = beginJournal(options.run.session);
  auto session = Session::create(options.run.session);
  if (!session) return reportError(session.error());
  WrittenOutputs outputs;
  const auto matched = match(options, **session, outputs);
  if (!matched) {
    if (!outputs.areComplete()) reportError(outputs.error());
    return reportError(matched.error());
  }
  const RigidMatch &result = matched->match;
  if (!options.run.quiet) {
    for (const std::string &text : matchLines(result, matched->elastic)) printOut(text + "\n");
    for (const std::string &warning : result.rigid.warnings) printOut("  warning: " + warning + "\n");
    for (const std::string &notice : matched->notices) printOut("  note: " + notice + "\n");
  }
  ExitCode exitCode = kDone;
  if (!result.isUsable())
    exitCode = reportError(
        {result.rigid.verdict == registration::RegistrationVerdict::refused ? ErrorCode::input : ErrorCode::state,
         pathText(result.file) + ": " + failureOf(result)});
  // A missing output takes precedence over other failures.
  return outputs.areComplete() ? exitCode : reportError(outputs.error());
}

}  // namespace c3de::app
