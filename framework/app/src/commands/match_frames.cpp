// SPDX-License-Identifier: Apache-2.0
#include "commands/match_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "c3de/abi/log.h"
#include "c3de/core/csv.h"
#include "c3de/core/log.h"
#include "c3de/core/output_file.h"
#include "c3de/core/path_text.h"
#include "c3de/geometry/rigid_fit.h"
#include "c3de/session/body_states.h"
#include "c3de/session/build_scene.h"
#include "c3de/session/export_simulation.h"
#include "c3de/session/frame_match.h"
#include "c3de/session/headless_run.h"
#include "c3de/session/interrupt.h"
#include "c3de/session/match_stages.h"
#include "c3de/session/progress_line.h"
#include "c3de/session/run_beginning.h"
#include "c3de/session/simulator_access.h"
#include "c3de/session/written_outputs.h"
#include "commands/exit_code.h"
#include "commands/last_crash.h"
#include "commands/measured_source.h"
#include "commands/run_exports.h"
#include "commands/scene_at_rest.h"
#include "commands/standard_output.h"

namespace c3de::app {
namespace {

using Json = nlohmann::ordered_json;
using scene::SceneMatch;

struct DoneFrame {
  std::string name;
  std::optional<double> time_s;
  FrameMatch match;
};

struct Sequence {
  std::vector<DoneFrame> frames;
  std::optional<std::size_t> planned;  ///< none: until the stream ends
  std::size_t unmatched = 0;           ///< frames of a stream that could not be matched
  std::string failure;                 ///< why it ends early; empty: it is complete
  ErrorCode code = ErrorCode::state;
};

/// Folder, table or address, for messages.
std::filesystem::path sourceOf(const MatchOptions &options) {
  return options.stream.empty() ? options.frames : pathFromText(options.stream);
}

std::vector<std::filesystem::path> outputsOf(const MatchOptions &options) {
  return {options.run.report, options.frameTable, options.run.exportList, options.run.saveState,
          options.run.saveSession};
}

/// The match of the scene with the options; its source is the sequence.
Expected<SceneMatch> wantedOf(const MatchOptions &options, const scene::SceneFile &scene) {
  SceneMatch out = scene.match.value_or(SceneMatch{});
  if (!options.body.empty()) out.body = options.body;
  if (options.noise_mm) out.noise_mm = *options.noise_mm;
  if (options.isRigid) out.deforms = false;
  out.points = sourceOf(options);
  out.surface.clear();
  out.labels = {};
  out.landmarks.clear();
  if (!options.use.empty()) out.fitsLandmarks = options.use == "fit";
  if (options.weight) out.landmarkWeight = *options.weight;
  out.unit.reset();
  if (!options.unit.empty()) {
    const auto unit = scene::parseLengthUnit(options.unit);
    if (!unit) return fail(ErrorCode::usage, "--measured-unit: " + unit.error().message);
    out.unit = *unit;
  }
  if (const auto good = scene::completeMatch(scene, out); !good) return fail(ErrorCode::usage, good.error().message);
  return out;
}

Json rowOf(const DoneFrame &frame) {
  const FrameMatch &match = frame.match;
  Json row{{"frame", frame.name}, {"time_s", frame.time_s ? Json(*frame.time_s) : Json()}, {"wall_s", match.wall_s}};
  const Json details = Json::parse(matchJson(match.rigid, match.elastic), nullptr, false);
  for (const char *key : {"verdict", "points", "converged", "surface_rms_mm", "landmark_error_mm", "landmarks",
                          "iterations", "forces", "elastic", "motion", "warnings"})
    if (const auto found = details.find(key);
        found != details.end() && (key != std::string_view("landmarks") || !found->empty()))
      row[key] = *found;
  return row;
}

std::string tableOf(const Sequence &sequence) {
  std::string text =
      "frame,time_s,wall_s,points,verdict,converged,iterations,rms_rigid_mm,rms_after_mm,used_part,expected_error_mm,"
      "landmarks,landmark_mean_rigid_mm,landmark_mean_after_mm,x_mm,y_mm,z_mm,rx_deg,ry_deg,rz_deg\n";
  for (const DoneFrame &frame : sequence.frames) {
    const FrameMatch &match = frame.match;
    const auto &body = match.elastic.body;
    const geometry::RigidPose pose = geometry::poseOf(match.measuredFromBody(), {});
    const auto number = [&](bool isKnown, double value) {
      return isKnown ? fmt::format("{:.6g}", value) : std::string();
    };
    const auto mean = [&](const std::optional<ErrorSummary> &errors) {
      return number(errors.has_value(), errors ? errors->mean_mm : 0.0);
    };
    text += fmt::format(
        "{},{},{:.4g},{},{},{},{},{:.6g},{},{},{},{},{},{},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g}\n",
        csvCell(frame.name), number(frame.time_s.has_value(), frame.time_s.value_or(0.0)), match.wall_s,
        match.rigid.points, verdictOf(match.rigid), body && body->hasConverged ? 1 : 0, body ? body->iterations : 0,
        match.rigid.rigid.after.rms_mm, number(body.has_value(), body ? body->after_mm : 0.0),
        number(body.has_value(), body ? body->usedPart : 0.0),
        number(body && body->error, body && body->error ? body->error->rms_mm : 0.0), match.rigid.landmarks.size(),
        mean(match.rigid.after), mean(match.elastic.after), pose.translation_mm[0], pose.translation_mm[1],
        pose.translation_mm[2], pose.rotation_deg[0], pose.rotation_deg[1], pose.rotation_deg[2]);
  }
  return text;
}

/// Why a match is no result; empty: it is one.
std::string failureOfFrame(const FrameMatch &match) {
  if (match.rigid.isUsable()) return {};
  return match.rigid.rigid.verdict == registration::RegistrationVerdict::refused ? "no rigid motion is credible"
                                                                                 : "the rigid motion is ambiguous";
}

/// Matches the frames in their order. A frame of files that cannot be matched ends the sequence; of a stream it is
/// left out, with a warning. Errors: cancelled.
Expected<Sequence> matchAll(Session &session, c3de_object *simulator, const scene::SceneFile &scene,
                            const std::string &name, const geometry::TriangleMesh &skin, const SceneMatch &wanted,
                            MeasuredSource &source, SimulationExport *timeline, const ProgressFn &progress) {
  Sequence out;
  out.planned = source.count();
  FrameRequest request;
  request.wanted = wanted;
  request.targets.file = wanted.points;
  for (;;) {
    const std::size_t number = out.frames.size() + out.unmatched + 1;
    auto frame = source.next(progress);
    const auto end = [&](ErrorCode code, const std::string &where, const std::string &why) {
      out.code = code;
      out.failure = fmt::format("{}: {}", where, why);
      return out;
    };
    if (!frame) return end(frame.error().code, fmt::format("frame {}", number), frame.error().message);
    if (!*frame) return out;
    session::MeasuredFrame &measured = (*frame)->measured;
    request.targets.surface.points_mm = std::move(measured.measured.points_mm);
    request.targets.surface.normals = std::move(measured.measured.normals);
    request.landmarks = std::move((*frame)->landmarks);
    const ProgressFn part = [&](double fraction, const std::string &what) {
      const double done = static_cast<double>(number - 1) + std::max(fraction, 0.0);
      return progress(out.planned ? done / static_cast<double>(*out.planned) : -1.0,
                      fmt::format("frame {}: {}", measured.name, what));
    };
    auto match = matchFrame(session, simulator, scene, name, skin, request, part);
    if (!match && match.error().code == ErrorCode::cancelled) {
      if (source.isLive()) return out;
      return tl::unexpected(match.error());
    }
    const std::string where = out.planned ? fmt::format("frame {} ({} of {})", measured.name, number, *out.planned)
                                          : "frame " + measured.name;
    if (const std::string why = match ? failureOfFrame(*match) : match.error().message;
        !why.empty() && source.isLive() && (match || match.error().code == ErrorCode::input)) {
      log(LogLevel::warn, fmt::format("{}: {}; it is left out", where, why));
      ++out.unmatched;
      request.measuredFromBodyBefore.reset();
      continue;
    }
    if (!match) return end(match.error().code, where, match.error().message);
    out.frames.push_back({measured.name, measured.time_s, std::move(*match)});
    const FrameMatch &last = out.frames.back().match;
    if (const std::string why = failureOfFrame(last); !why.empty()) {
      const bool isRefused = last.rigid.rigid.verdict == registration::RegistrationVerdict::refused;
      return end(isRefused ? ErrorCode::input : ErrorCode::state, where, why);
    }
    if (const auto sent = source.send(last); !sent) return end(sent.error().code, where, sent.error().message);
    // Without a deformation the body still has the shape of a frame before.
    if (timeline != nullptr && last.elastic.body) {
      const auto states =
          readBodyStates(simulator, BodyParts::skinAndInside, [&session] { return session.plugins().takeError(); });
      if (!states) return tl::unexpected(states.error());
      const double at = measured.time_s.value_or(static_cast<double>(number - 1));
      if (const auto added = timeline->addFrame(at, *states); !added) return tl::unexpected(added.error());
    }
    // A frame that has not converged is no start for the next one.
    request.measuredFromBodyBefore.reset();
    if (last.canContinue()) request.measuredFromBodyBefore = last.measuredFromBody();
  }
}

Expected<void> writeResults(const MatchOptions &options, const HeadlessRun &run, RunFacts facts,
                            const Sequence &sequence, const MeasuredSource &source, WrittenOutputs &outputs) {
  if (!options.frameTable.empty())
    outputs.note(options.frameTable, writeWholeFile(options.frameTable, tableOf(sequence)));
  if (options.run.report.empty()) return {};
  if (!sequence.frames.empty()) {
    const FrameMatch &last = sequence.frames.back().match;
    Json json = Json::parse(matchJson(last.rigid, last.elastic), nullptr, false);
    json["frames"] = Json::array();
    for (const DoneFrame &frame : sequence.frames) json["frames"].push_back(rowOf(frame));
    if (const std::string stream = source.streamJson(); !stream.empty()) {
      json["stream"] = Json::parse(stream);
      json["stream"]["unmatched"] = sequence.unmatched;
    }
    facts.match = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  }
  if (!sequence.failure.empty()) facts.outcome = "failed", facts.failure = sequence.failure;
  return writeReport(options.run.report, facts, run, outputs);
}

Expected<Sequence> run(const MatchOptions &options, Session &session, WrittenOutputs &outputs) {
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
  const auto wanted = wantedOf(options, *scene);
  if (!wanted) return tl::unexpected(wanted.error());
  std::vector<std::filesystem::path> inputs{options.run.scene};
  if (!options.frames.empty()) inputs.push_back(options.frames);
  inputs.insert(inputs.end(), options.run.landmarks.begin(), options.run.landmarks.end());
  if (const auto good = checkOutputs(outputsOf(options), inputs); !good) return tl::unexpected(good.error());
  if (!options.run.exportList.empty())
    if (const auto good = checkSimulationExport(options.run.exportList); !good) return tl::unexpected(good.error());
  if (options.weight && !wanted->fitsLandmarks)
    return fail(ErrorCode::usage, "--weight is for landmarks that are fitted; accepted: with --use fit");
  Expected<std::unique_ptr<MeasuredSource>> source;
  if (options.stream.empty()) source = measuredFiles(options, *scene, *wanted);
  if (!source) return tl::unexpected(source.error());
  BodySources sources;
  const auto built = buildAtRest(session, *scene, sources, progress);
  if (!built) return tl::unexpected(built.error());
  c3de_object *const simulator = built->simulator.get();
  const std::string name = nameInSimulator(*scene, wanted->body);
  const auto skins = skinsOf(simulator, name, [&session] { return session.plugins().takeError(); });
  if (!skins) return tl::unexpected(skins.error());
  // A run without a step has the facts of a report; the session has adopted the simulator then.
  RunOptions still;
  still.session = options.run.session;
  still.scene = options.run.scene;
  still.steps = 0;
  still.quiet = options.run.quiet;
  HeadlessRun atRest(session, simulator, built->table, still, {}, outputs, beginning->source);
  if (const auto ran = atRest.run(); !ran) return tl::unexpected(ran.error());
  if (!options.stream.empty()) source = measuredStream(options, {session, *scene, *built, sources, name});
  if (!source) return tl::unexpected(source.error());
  std::optional<SimulationExport> timeline;
  if (!options.run.exportList.empty()) timeline.emplace(options.run.exportList);
  auto sequence = matchAll(session, simulator, *scene, name, skins->rest, *wanted, **source,
                           timeline ? &*timeline : nullptr, progress);
  line.finish();
  if (timeline) outputs.note(options.run.exportList, timeline->finish());
  if (!sequence) return tl::unexpected(sequence.error());
  RunFacts facts = built->facts(atRest, *scene, options.run.scene);
  if (const auto good = writeResults(options, atRest, std::move(facts), *sequence, **source, outputs); !good)
    return tl::unexpected(good.error());
  if (sequence->failure.empty()) saveEnd(options.run, session, simulator, built->identity, *beginning, outputs);
  return sequence;
}

}  // namespace

int matchFrames(const MatchOptions &options) {
  watchForInterrupt();
  if (const auto good = checkOutputs(outputsOf(options), {}); !good) return reportError(good.error());
  const auto journal = beginJournal(options.run.session);
  auto session = Session::create(options.run.session);
  if (!session) return reportError(session.error());
  WrittenOutputs outputs;
  const auto sequence = run(options, **session, outputs);
  if (!sequence) {
    if (!outputs.areComplete()) reportError(outputs.error());
    return reportError(sequence.error());
  }
  if (!options.run.quiet) {
    double total = 0.0, longest = 0.0;
    for (const DoneFrame &frame : sequence->frames) {
      total += frame.match.wall_s;
      if (&frame != &sequence->frames.front()) longest = std::max(longest, frame.match.wall_s);
      const auto &body = frame.match.elastic.body;
      printOut(fmt::format("frame {}: rms {:.3g} mm{}\n", frame.name,
                           body ? body->after_mm : frame.match.rigid.rigid.after.rms_mm,
                           body ? fmt::format(" after {} iterations", body->iterations) : " after the rigid motion"));
      const auto &errors = body ? frame.match.elastic.after : frame.match.rigid.after;
      if (errors)
        printOut(fmt::format("  landmarks ({}): {}\n", frame.match.rigid.landmarks.size(), errorText(*errors)));
      for (const std::string &warning : frame.match.rigid.rigid.warnings) printOut("  warning: " + warning + "\n");
      for (const std::string &warning : warningsOf(frame.match.elastic)) printOut("  warning: " + warning + "\n");
    }
    printOut(fmt::format(
        "{}{} frames in {:.3g} s, longest after the first {:.3g} s; not for clinical use\n", sequence->frames.size(),
        sequence->planned ? fmt::format(" of {}", *sequence->planned) : std::string(), total, longest));
  }
  ExitCode exitCode = kDone;
  if (sequence->frames.empty() && sequence->failure.empty())
    exitCode = reportError({ErrorCode::input, options.stream + ": no frame was matched"});
  if (!sequence->failure.empty())
    exitCode = reportError({sequence->code, pathText(sourceOf(options)) + ": " + sequence->failure});
  // A missing output takes precedence over other failures.
  return outputs.areComplete() ? exitCode : reportError(outputs.error());
}

}  // namespace c3de::app
