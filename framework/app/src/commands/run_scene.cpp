// SPDX-License-Identifier: Apache-2.0
#include "commands/run_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <span>
#include <utility>

#include "c3de/core/input_file.h"
#include "c3de/core/log.h"
#include "c3de/core/output_file.h"
#include "c3de/core/path_text.h"
#include "c3de/core/text.h"
#include "c3de/geometry/mesh_io.h"
#include "c3de/imaging/statistics.h"
#include "c3de/session/body_sources.h"
#include "c3de/session/body_states.h"
#include "c3de/session/build_scene.h"
#include "c3de/session/export_simulation.h"
#include "c3de/session/file_kind.h"
#include "c3de/session/headless_run.h"
#include "c3de/session/interrupt.h"
#include "c3de/session/point_fields.h"
#include "c3de/session/progress_line.h"
#include "c3de/session/recorder.h"
#include "c3de/session/replay.h"
#include "c3de/session/run_beginning.h"
#include "c3de/session/sample_points.h"
#include "c3de/session/saved_session.h"
#include "c3de/session/simulation_state.h"
#include "c3de/session/simulator_access.h"
#include "c3de/session/verification.h"
#include "c3de/session/written_outputs.h"
#include "commands/exit_code.h"
#include "commands/last_crash.h"
#include "commands/run_details.h"
#include "commands/run_exports.h"
#include "commands/run_landmarks.h"
#include "commands/standard_output.h"
#include "run_picture.h"

namespace c3de::app {
namespace {

RunLimits limitsOf(const RunOptions &options, std::chrono::steady_clock::time_point begin) {
  RunLimits limits;
  limits.begin = begin;
  if (options.timeLimit_s)
    limits.deadline = begin + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                                  std::chrono::duration<double>(*options.timeLimit_s));
  return limits;
}

void printSummary(const RunFacts &facts) {
  if (facts.isLoadStepped)
    return printOut(
        fmt::format("{}: {}, {} load steps in {:.3g} s\n", facts.scene, facts.outcome, facts.steps, facts.wall_s));
  const Preparation &took = facts.prepared.took;
  if (took.masks_s > 0.0)
    printOut(fmt::format(
        "{}: first step after {:.3g} s (reading {:.3g}, masks {:.3g}, surfaces {:.3g}, fills {:.3g}, bodies {:.3g}, "
        "step {:.3g})\n",
        facts.scene, facts.toFirstStep_s, took.reading_s, took.masks_s, took.surfaces_s, took.fills_s, took.bodies_s,
        facts.firstStep_s));
  for (const Coverage &body : facts.prepared.coverage)
    if (const std::string text = sentenceOf(body); !text.empty()) printOut(fmt::format("{}: {}\n", facts.scene, text));
  const double factor = facts.wall_s > 0.0 ? facts.time_s / facts.wall_s : 0.0;
  printOut(fmt::format("{}: {}, {} steps of {:.4g} s, {:.6g} s simulated in {:.3g} s ({:.3g} times real time)\n",
                       facts.scene, facts.outcome, facts.steps, facts.dt_s, facts.time_s, facts.wall_s, factor));
}

std::vector<std::filesystem::path> outputsOf(const RunOptions &options, const scene::SceneFile &scene) {
  std::vector<std::filesystem::path> all{options.report,
                                         options.probes,
                                         options.screenshot,
                                         options.exportList,
                                         options.saveState,
                                         options.saveSession,
                                         options.record,
                                         options.sampled,
                                         options.exportLandmarks,
                                         options.energies,
                                         options.tissues,
                                         options.exportImage.image,
                                         options.exportImage.displacement,
                                         options.exportImage.labels,
                                         emptiedFile(options.exportImage.displacement)};
  if (!options.exportSurface.empty())
    for (std::filesystem::path &file : surfaceFiles(options.exportSurface, scene::namesOfBodies(scene)))
      all.push_back(std::move(file));
  return all;
}

std::vector<std::filesystem::path> inputsOf(const RunOptions &options, const scene::SceneFile &scene) {
  std::vector<std::filesystem::path> all{options.scene, options.fromState, options.samplePoints};
  for (const auto *files : {&options.session.pluginFiles, &options.landmarks, &options.targetLandmarks})
    all.insert(all.end(), files->begin(), files->end());
  scene::SceneFile named = scene;
  for (const std::filesystem::path *file : filesOf(named)) all.push_back(*file);
  return all;
}

/// Frames are many files, which replace files of the same names in the folder.
Expected<void> checkFramesFolder(const RunOptions &options, std::span<const std::filesystem::path> others) {
  if (options.exportList.empty()) return {};
  const std::filesystem::path folder = framesFolder(options.exportList);
  std::error_code code;
  for (const std::filesystem::path &other : others)
    if (!other.empty() &&
        std::filesystem::equivalent(other.has_parent_path() ? other.parent_path() : ".", folder, code))
      return fail(ErrorCode::usage,
                  other.string() + ": lies in the folder that --export fills with frames; accepted: another folder");
  return {};
}

/// Checks that no output overwrites an input or another output. Without a scene only the outputs are checked.
Expected<void> checkFiles(const RunOptions &options, const scene::SceneFile *scene) {
  const std::vector<std::filesystem::path> outputs = outputsOf(options, scene != nullptr ? *scene : scene::SceneFile{});
  std::vector<std::filesystem::path> inputs;
  if (scene != nullptr) inputs = inputsOf(options, *scene);
  if (auto good = checkOutputs(outputs, inputs); !good) return good;
  for (const auto &others : {inputs, outputs})
    if (auto good = checkFramesFolder(options, others); !good) return good;
  return {};
}

Expected<void> writeReport(const RunOptions &options, const RunFacts &facts, const HeadlessRun &run) {
  const auto simulatorJson = run.simulatorReport();
  if (!simulatorJson) return tl::unexpected(simulatorJson.error());
  const auto json = reportJson(facts, *simulatorJson);
  if (!json) return tl::unexpected(json.error());
  return writeWholeFile(options.report, *json);
}

void writeSurfaceExport(const RunOptions &options, Session &session, c3de_object *simulator, WrittenOutputs &outputs) {
  const auto states = readBodyStates(simulator, BodyParts::skin, [&] { return session.plugins().takeError(); });
  if (!states) return outputs.addFailure(options.exportSurface, states.error());
  writeSurfaces(session.meshFormats(), options.exportSurface, *states,
                [&](const auto &file, const auto &result) { outputs.note(file, result); });
}

/// Checked before the run, so that a view that cannot be drawn wastes no run.
Expected<PictureView> viewAsked(const RunOptions &options, const scene::SceneFile &scene) {
  const PictureView view = options.view.value_or(scene.image ? PictureView::four : PictureView::space);
  if (options.overlay && (view == PictureView::space || !scene.image))
    return fail(ErrorCode::usage, "--overlay is for slices of the scene's image, and none is drawn");
  if (view == PictureView::space || scene.image) return view;
  return fail(ErrorCode::usage, std::string("--view ") + nameOf(view) + " shows slices of an image, and " +
                                    scene.where(1) + " has no [image]; accepted: --view 3d");
}

/// The scene's image has already been read and exists.
Expected<PictureSources> pictureSources(const RunOptions &options, PictureView view, const scene::SceneFile &scene,
                                        BodySources &sources, const scene::MaterialLibrary &materials,
                                        const Prepared &prepared) {
  PictureSources out;
  out.view = view;
  out.camera = options.camera;
  if (view == PictureView::space) return out;
  imaging::ReadOptions atTime;
  atTime.time = scene.image->time;
  const auto image = sources.volume(scene.image->file, atTime);
  if (!image) return tl::unexpected(image.error());
  out.image = std::make_shared<scene::StoredImage>();
  out.image->name = imageName(scene.image->file);
  out.image->volume = **image;
  out.image->range = imaging::robustRange(out.image->volume);
  auto how = imageWarpOf(scene, sources, materials, prepared.tissues);
  if (!how) return tl::unexpected(how.error());
  out.how = std::move(*how);
  out.warp = scene.image->warp;
  if (scene.image->labels.empty()) return out;
  const auto labels = sources.labels(scene.image->labels.back(), {});
  if (!labels) return tl::unexpected(labels.error());
  if ((*labels)->empty()) return out;
  out.labels = std::make_shared<scene::StoredLabels>();
  out.labels->name = imageName(scene.image->labels.back());
  out.labels->map = (*labels)->back();
  return out;
}

Expected<void> drawPicture(Session &session, c3de_object *simulator, const scene::SceneFile &scene,
                           const RunOptions &options, RunPicture &picture, PictureView view, BodySources &sources,
                           const Prepared &prepared) {
  auto shown = pictureSources(options, view, scene, sources, session.materials(), prepared);
  if (!shown) return tl::unexpected(shown.error());
  if (options.overlay) shown->overlay = *options.overlay;
  if (auto adopted = session.adopt(simulator, scene.title); !adopted) return adopted;
  return picture.write(session, options.screenshot, options.width, options.height, *shown, prepared);
}

/// Checks that are possible before anything is built. Returns the view of the screenshot.
Expected<PictureView> checkBeforeBuilding(const RunOptions &options, const scene::SceneFile &scene,
                                          const geometry::MeshFormats &formats) {
  if (!options.exportSurface.empty())
    if (const auto writable = checkSurfaceExport(formats, options.exportSurface, scene::namesOfBodies(scene));
        !writable)
      return tl::unexpected(writable.error());
  if (!options.tissues.empty() && std::none_of(scene.bodies.begin(), scene.bodies.end(),
                                               [](const scene::SceneBody &body) { return body.volume.hasTissues(); }))
    return fail(ErrorCode::usage, "--tissues needs a body with tissues, and " + scene.where(1) + " has none");
  if (const auto good = checkFiles(options, &scene); !good) return tl::unexpected(good.error());
  if (const auto good = checkImageExport(options.exportImage, scene); !good) return tl::unexpected(good.error());
  return viewAsked(options, scene);
}

/// Returns the message if the time limit was reached first; empty if the bodies have been built.
Expected<std::string> buildBodies(const RunOptions &options, const RunLimits &limits, Session &session,
                                  c3de_object *simulator, const SimulationSource &source, BodySources &sources,
                                  Prepared &prepared) {
  const scene::SceneFile &scene = *std::get<SharedScene>(source.front());
  ProgressLine progress(options.quiet);
  std::string present;
  bool isOver = false;
  const ProgressFn report = [&](double fraction, const std::string &what) {
    present = what;
    progress.update(fraction, what);
    isOver = isOver || (limits.deadline && std::chrono::steady_clock::now() >= *limits.deadline);
    return !isOver && !wasInterrupted();
  };
  auto built = buildScene(session, simulator, scene, sources, report, &prepared);
  if (built) built = buildRemaining(session, simulator, source, report, &prepared);
  if (built) {
    lendImage(session, scene, sources);
    return std::string();
  }
  if (built.error().code != ErrorCode::cancelled) return tl::unexpected(built.error());
  const std::string where = present + "; no step was made, and there is no state to keep";
  if (isOver) return "the time limit of " + formatNumber(*options.timeLimit_s) + " s was reached at " + where;
  return fail(ErrorCode::cancelled, "interrupted at " + where);
}

/// Positions of the points. Also called before the first step, so that a point that cannot be followed is reported
/// before hours of work.
Expected<std::vector<Vec3>> followPoints(const RunOptions &options, const std::vector<SamplePoint> &points,
                                         Session &session, c3de_object *simulator) {
  if (points.empty()) return std::vector<Vec3>{};
  return positionsOf(simulator, points, pathText(options.samplePoints),
                     [&session] { return session.plugins().takeError(); });
}

void writeSampledPoints(const RunOptions &options, const std::vector<SamplePoint> &points, Session &session,
                        c3de_object *simulator, const HeadlessRun &run, WrittenOutputs &outputs) {
  if (points.empty()) return;
  if (const auto lost = lostPoints(run); !lost)
    return outputs.addFailure(options.sampled, lost.error());
  else if (!lost->empty())
    return outputs.addFailure(options.sampled,
                              {ErrorCode::input, "--sample-points cannot be followed to the end: " + *lost});
  const auto positions = followPoints(options, points, session, simulator);
  outputs.note(options.sampled, positions ? writeSampled(options.sampled, points, *positions)
                                          : Expected<void>(tl::unexpected(positions.error())));
}

std::vector<SkinVolume> skinVolumes(Session &session, c3de_object *simulator) {
  const auto states = readBodyStates(simulator, BodyParts::skin, [&session] { return session.plugins().takeError(); });
  std::vector<SkinVolume> volumes;
  if (!states) return volumes;  // a simulator may have no skins
  constexpr double kCubicMetres = 1e-9;
  for (const BodyState &body : *states) {
    geometry::TriangleMesh reference = body.skin;
    for (const geometry::PointArray &array : body.skinArrays)
      if (array.components == 3)
        for (std::size_t i = 0; i < reference.vertices.size(); ++i)
          for (std::size_t a = 0; a < 3; ++a) reference.vertices[i][a] -= array.values[3 * i + a];
    volumes.push_back({kCubicMetres * signedVolume(reference), kCubicMetres * signedVolume(body.skin)});
  }
  return volumes;
}

/// Motion of the labels, for report and table.
void followTissues(const RunOptions &options, c3de_object *simulator, const c3de_simulator_v1 *table, RunFacts &facts,
                   WrittenOutputs &outputs) {
  if (options.report.empty() && options.tissues.empty()) return;
  auto motions = tissueMotions(table, simulator, facts.prepared.tissues);
  if (motions)
    facts.tissues = std::move(*motions);
  else
    log(LogLevel::warn, "tissues: " + motions.error().message);
  if (!options.tissues.empty())
    outputs.note(options.tissues, motions ? writeTissueTable(options.tissues, facts.tissues)
                                          : Expected<void>(tl::unexpected(motions.error())));
}

/// Error of the end state. A run that did not reach its end is not verified.
Expected<void> verifyEnd(const RunOptions &options, const RunLimits &limits, Session &session, c3de_object *simulator,
                         const c3de_simulator_v1 *table, RunFacts &facts) {
  if (!options.verify || facts.outcome != "done") return {};
  ProgressLine progress(options.quiet);
  auto said = verification(session, simulator, table, [&](double fraction, const std::string &what) {
    progress.update(fraction, what);
    const bool isOver = limits.deadline && std::chrono::steady_clock::now() >= *limits.deadline;
    return !isOver && !wasInterrupted();
  });
  progress.finish();
  if (said) {
    facts.verification = std::move(*said);
    return {};
  }
  if (said.error().code != ErrorCode::cancelled) return tl::unexpected(said.error());
  facts.outcome = wasInterrupted() ? "interrupted" : "time_limit";
  facts.failure = said.error().message;
  return {};
}

/// Checked before the first step, so that a wrong name wastes no run.
Expected<void> checkOverlay(const RunOptions &options, const c3de_simulator_v1 *table, c3de_object *simulator) {
  if (!options.overlay || options.overlay->kind != PictureOverlay::Kind::field) return {};
  std::string known = "none, displacement, volume_change";
  for (const PointField &field : pointFields(table, simulator)) {
    if (field.name == options.overlay->field) return {};
    known += ", " + field.name;
  }
  return fail(ErrorCode::usage, "--overlay " + options.overlay->field + ": accepted: " + known);
}

/// Makes the run record or repeat, where requested.
Expected<void> prepareRecording(const RunOptions &options, Session &session, c3de_object *simulator,
                                const SimulatorIdentity &identity, const SimulationSource &source, Replay *replay,
                                HeadlessRun &run) {
  if (replay != nullptr) run.repeat(*replay);
  if (options.record.empty()) return {};
  ProgressLine line(options.quiet);
  const ProgressFn report = [&line](double fraction, const std::string &what) {
    line.update(fraction, what);
    return !wasInterrupted();
  };
  const auto start = recordingStart(session, simulator, identity, source, options.record, options.recordHashEvery,
                                    report, options.embed ? Embedding::all : Embedding::extracted);
  if (!start) return tl::unexpected(start.error());
  RecorderOptions recorderOptions;
  recorderOptions.progress = report;
  auto recorder = Recorder::create(options.record, *start, simulator, recorderOptions);
  line.finish();
  if (!recorder) return tl::unexpected(recorder.error());
  run.record(std::move(*recorder));
  return {};
}

/// How far a replay has come, for people.
std::string replayNotice(const RunOptions &options, const Replay &replay, const RunFacts &facts) {
  std::string text = fmt::format("repeats {} up to step {}", pathText(options.scene), facts.steps);
  if (options.checkHashes)
    text += fmt::format("; {} state hash{} equal", replay.equalHashes(), replay.equalHashes() == 1 ? " is" : "es are");
  return text;
}

/// The state with which the run begins, if a file states one. @param saved  the session that is continued; null: none
Expected<void> restoreState(const RunOptions &options, Session &session, c3de_object *simulator,
                            const SimulatorIdentity &identity, const SessionFile *saved) {
  if (!options.fromState.empty()) {
    const auto state = readStateFile(options.fromState);
    if (!state) return tl::unexpected(state.error());
    if (auto gone = goToState(session, simulator, identity, *state, pathText(options.fromState)); !gone) return gone;
  }
  return saved != nullptr ? restoreSession(session, simulator, identity, *saved, options.scene) : Expected<void>();
}

struct Simulated {
  RunFacts facts;
  std::string overBefore;  ///< the time limit, if reached before the first step; empty: there are facts
};

Expected<Simulated> simulate(const RunOptions &options, Session &session, RunPicture *picture,
                             std::chrono::steady_clock::time_point begin, WrittenOutputs &outputs) {
  // As soon as plugins have registered their formats.
  if (!options.exportSurface.empty())
    if (const auto writable = checkSurfaceExport(session.meshFormats(), options.exportSurface, {}); !writable)
      return tl::unexpected(writable.error());
  ProgressLine reading(options.quiet);
  const auto beginning = readBeginning(options, session, [&reading](double fraction, const std::string &what) {
    reading.update(fraction, what);
    return !wasInterrupted();
  });
  reading.finish();
  if (!beginning) return tl::unexpected(beginning.error());
  const auto &[saved, files, replay, source] = *beginning;
  const SharedScene scene = std::get<SharedScene>(source.front());
  log(LogLevel::debug, describe(*scene, options));
  const auto view = checkBeforeBuilding(options, *scene, session.meshFormats());
  if (!view) return tl::unexpected(view.error());
  const auto chosen = session.chooseSimulator(scene->simulatorClass);
  if (!chosen) return failInScene(chosen.error(), *scene, scene->simulatorLine);
  log(LogLevel::debug, fmt::format("simulated by {}, {} threads", chosen->classId, session.pool().threadCount()));
  if (replay)
    if (const auto same = replay->checkSimulator(*chosen); !same) return tl::unexpected(same.error());
  auto created = session.createSimulator(chosen->classId);
  if (!created) return tl::unexpected(created.error());
  const ObjectRef simulator(*created);
  const auto table = simulatorTable(simulator.get());
  if (!table) return tl::unexpected(table.error());
  if (options.verify)
    if (const auto able = checkVerifies(*table, *chosen); !able) return tl::unexpected(able.error());

  const auto points = options.samplePoints.empty() ? Expected<std::vector<SamplePoint>>(std::vector<SamplePoint>())
                                                   : readSamplePoints(options.samplePoints);
  if (!points) return tl::unexpected(points.error());
  auto landmarks = readRunLandmarks(options, *scene);
  if (!landmarks) return tl::unexpected(landmarks.error());
  const RunLimits limits = limitsOf(options, begin);
  Prepared prepared;
  BodySources sources;
  auto overBefore = buildBodies(options, limits, session, simulator.get(), source, sources, prepared);
  if (!overBefore) return tl::unexpected(overBefore.error());
  if (!overBefore->empty()) return Simulated{{}, std::move(*overBefore)};
  log(LogLevel::debug, describe(prepared.took));

  if (const auto good = checkOverlay(options, *table, simulator.get()); !good) return tl::unexpected(good.error());
  if (const auto restored = restoreState(options, session, simulator.get(), *chosen, saved ? &*saved : nullptr);
      !restored)
    return tl::unexpected(restored.error());
  if (const auto followed = followPoints(options, *points, session, simulator.get()); !followed)
    return tl::unexpected(followed.error());
  if (const auto found =
          findBodies(simulator.get(), *scene, *landmarks, [&session] { return session.plugins().takeError(); });
      !found)
    return tl::unexpected(found.error());
  HeadlessRun run(session, simulator.get(), *table, options, limits, outputs, source);
  if (const auto good = prepareRecording(options, session, simulator.get(), *chosen, source, replay.get(), run); !good)
    return tl::unexpected(good.error());
  if (const auto ran = run.run(); !ran) return tl::unexpected(ran.error());
  RunFacts facts = run.facts();
  facts.prepared = std::move(prepared);
  facts.scene = scene->title;
  facts.source = options.scene.string();
  facts.simulator = *chosen;

  if (const auto good = verifyEnd(options, limits, session, simulator.get(), *table, facts); !good)
    return tl::unexpected(good.error());
  if (!options.quiet)
    if (const auto simulatorJson = run.simulatorReport()) {
      facts.accuracy = accuracyLines(*simulatorJson, facts.verification);
      if (const auto notices = noticesOf(*simulatorJson)) facts.notices = *notices;
    }
  if (replay) facts.notices.push_back(replayNotice(options, *replay, facts));
  writeSampledPoints(options, *points, session, simulator.get(), run, outputs);
  facts.measurements = measureEnd(options, *landmarks, *scene, session, simulator.get(), run, outputs);
  if (!options.report.empty()) facts.skinVolumes = skinVolumes(session, simulator.get());
  followTissues(options, simulator.get(), *table, facts, outputs);
  if (!options.report.empty()) outputs.note(options.report, writeReport(options, facts, run));
  saveEnd(options, session, simulator.get(), *chosen, *beginning, outputs);
  if (!options.exportSurface.empty()) writeSurfaceExport(options, session, simulator.get(), outputs);
  if (options.exportImage.isWanted())
    if (const auto good =
            writeImageExports(options, session, *scene, sources, facts.prepared, *table, simulator.get(), outputs);
        !good)
      return tl::unexpected(good.error());
  if (picture != nullptr)
    outputs.note(options.screenshot,
                 drawPicture(session, simulator.get(), *scene, options, *picture, *view, sources, facts.prepared));
  return Simulated{facts, {}};
}

}  // namespace

int runScene(const RunOptions &options) {
  const auto begin = std::chrono::steady_clock::now();
  watchForInterrupt();
  if (!options.exportList.empty())
    if (const auto writable = checkSimulationExport(options.exportList); !writable)
      return reportError(writable.error());
  if (const auto good = checkFiles(options, nullptr); !good) return reportError(good.error());
  if (const auto good = checkPictureFormat(options.screenshot); !good) return reportError(good.error());

  std::unique_ptr<RunPicture> picture;
  SessionOptions sessionOptions = options.session;
  if (!options.screenshot.empty()) {
    auto made = RunPicture::create();
    if (!made) return reportError(made.error());
    picture = std::move(*made);
    sessionOptions.renderer = &picture->renderer();
  }
  const auto journal = beginJournal(sessionOptions);
  auto session = Session::create(sessionOptions);
  if (!session) return reportError(session.error());
  WrittenOutputs outputs;
  const auto simulated = simulate(options, **session, picture.get(), begin, outputs);
  if (!simulated) {
    if (!outputs.areComplete()) reportError(outputs.error());
    return reportError(simulated.error());
  }
  if (!simulated->overBefore.empty()) {
    reportError({ErrorCode::cancelled, simulated->overBefore});
    return kTimeLimit;
  }
  const RunFacts *facts = &simulated->facts;

  if (!options.quiet) {
    printSummary(*facts);
    for (const std::string &line : measurementLines(facts->measurements)) printOut("  " + line + "\n");
    for (const std::string &line : facts->accuracy) printOut("  " + line + "\n");
    for (const std::string &notice : facts->prepared.notices) printOut("  note: " + notice + "\n");
    for (const std::string &notice : facts->notices) printOut("  note: " + notice + "\n");
  }
  const std::string kept = outputs.written().empty() ? "; --report FILE.json keeps the last good state"
                                                     : "; the last good state is in " + outputs.written();
  ExitCode exitCode = kDone;
  if (facts->outcome == "diverged") {
    exitCode = reportError({ErrorCode::diverged, "the simulation diverged: " + facts->failure + kept});
  } else if (facts->outcome == "differs") {
    exitCode = reportError({ErrorCode::diverged, facts->failure});
  } else if (facts->outcome == "time_limit") {
    reportError({ErrorCode::cancelled, facts->failure + kept});
    exitCode = kTimeLimit;
  } else if (facts->outcome == "interrupted") {
    exitCode = reportError({ErrorCode::cancelled, facts->failure});
  } else if (facts->outcome != "done") {
    exitCode = reportError({ErrorCode::internal, facts->failure});
  }
  // A missing output takes precedence over other failures.
  return outputs.areComplete() ? exitCode : reportError(outputs.error());
}

}  // namespace c3de::app
