// SPDX-License-Identifier: Apache-2.0
#include "commands/fit_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "c3de/core/log.h"
#include "c3de/core/output_file.h"
#include "c3de/core/path_text.h"
#include "c3de/core/text.h"
#include "c3de/session/body_fit.h"
#include "c3de/session/build_scene.h"
#include "c3de/session/headless_run.h"
#include "c3de/session/interrupt.h"
#include "c3de/session/progress_line.h"
#include "c3de/session/run_beginning.h"
#include "c3de/session/saved_session.h"
#include "c3de/session/simulator_access.h"
#include "c3de/session/written_outputs.h"
#include "commands/exit_code.h"
#include "commands/last_crash.h"
#include "commands/scene_at_rest.h"
#include "commands/standard_output.h"

namespace c3de::app {
namespace {

constexpr double kMetresPerMillimetre = 1e-3;

/// What of a scene was measured.
struct MeasuredBody {
  std::string name;
  std::optional<Vec3> watched_m;  ///< none: the displacement of a support is prescribed
};

Expected<std::string> bodyOf(const FitOptions &options, const scene::SceneFile &scene) {
  const auto known = [&](const std::string &name) {
    return std::any_of(scene.bodies.begin(), scene.bodies.end(),
                       [&](const scene::SceneBody &body) { return body.name == name; });
  };
  if (options.body.empty()) {
    if (scene.bodies.size() == 1) return scene.bodies.front().name;
    return fail(
        ErrorCode::usage,
        fmt::format("the scene has {} bodies; accepted: --body with the one that was measured", scene.bodies.size()));
  }
  if (known(options.body)) return options.body;
  std::string names;
  for (const scene::SceneBody &body : scene.bodies) names += (names.empty() ? "" : ", ") + body.name;
  return fail(ErrorCode::usage, fmt::format("--body is '{}'; accepted: {}", options.body, names));
}

Expected<MeasuredBody> measuredOf(const FitOptions &options, const scene::SceneFile &scene) {
  const auto name = bodyOf(options, scene);
  if (!name) return tl::unexpected(name.error());
  MeasuredBody out{*name, {}};
  const bool isLoaded = std::any_of(scene.loads.begin(), scene.loads.end(),
                                    [&](const scene::SceneLoad &load) { return load.body == *name; });
  if (!isLoaded) {
    if (options.probe.empty()) return out;
    return fail(ErrorCode::usage,
                "--probe is for a force that is prescribed, and no [[load]] acts on body '" + *name +
                    "'; accepted: without it, the displacement of the moving [[fix]] is that of the curve");
  }
  std::vector<const scene::SceneProbe *> probes;
  for (const scene::SceneProbe &probe : scene.probes)
    if (probe.body == *name && (options.probe.empty() || probe.name == options.probe)) probes.push_back(&probe);
  if (probes.size() != 1)
    return fail(
        ErrorCode::usage,
        options.probe.empty()
            ? fmt::format("a force is prescribed, and {} probes are on body '{}'; accepted: --probe with the one "
                          "whose displacement was measured",
                          probes.size(), *name)
            : fmt::format("--probe is '{}'; accepted: a [[probe]] of body '{}'", options.probe, *name));
  out.watched_m = probes.front()->at_m;
  return out;
}

std::vector<std::filesystem::path> outputsOf(const FitOptions &options) {
  return {options.run.report, options.residuals};
}

struct Fitted {
  BodyFit fit;
  ForceCurve curve;
  FitFacts facts;
  std::vector<std::string> notices;
};

Expected<void> writeOutputs(const FitOptions &options, const Fitted &fitted, const RunFacts &facts,
                            const HeadlessRun &run, WrittenOutputs &outputs) {
  if (!options.run.report.empty())
    if (auto good = writeReport(options.run.report, facts, run, outputs); !good) return good;
  if (!options.residuals.empty())
    outputs.note(options.residuals, writeWholeFile(options.residuals, fitTable(fitted.fit, fitted.curve)));
  return {};
}

/// Errors of the curve begin with its file.
Error ofCurve(const Error &error, const std::filesystem::path &file) {
  const bool isOfPoint = error.message.starts_with("line ");
  const std::string text =
      isOfPoint ? pathText(file) + ":" + error.message.substr(5) : pathText(file) + ": " + error.message;
  return error.code == ErrorCode::input ? Error{error.code, displayMessage(text)} : error;
}

Expected<Fitted> fit(const FitOptions &options, Session &session, WrittenOutputs &outputs) {
  ProgressLine line(options.run.quiet);
  const ProgressFn progress = [&line](double fraction, const std::string &what) {
    line.update(fraction, what);
    return !wasInterrupted();
  };
  const auto beginning = readBeginning(options.run, session, progress);
  if (!beginning) return tl::unexpected(beginning.error());
  if (beginning->saved || beginning->replay)
    return fail(ErrorCode::usage, pathText(options.run.scene) + ": not a scene; accepted: a scene (.toml)");
  const SharedScene scene = std::get<SharedScene>(beginning->source.front());
  const auto measured = measuredOf(options, *scene);
  if (!measured) return tl::unexpected(measured.error());
  auto curve = readForceCurve(options.curve);
  if (!curve) return tl::unexpected(curve.error());
  const std::vector<std::filesystem::path> inputs{options.run.scene, options.curve};
  if (const auto good = checkOutputs(outputsOf(options), inputs); !good) return tl::unexpected(good.error());
  BodySources sources;
  const auto built = buildAtRest(session, *scene, sources, progress);
  if (!built) return tl::unexpected(built.error());
  c3de_object *const simulator = built->simulator.get();

  Fitted out{{}, std::move(*curve), {measured->name, pathText(options.curve), 0.0, 0.0}, built->prepared.notices};
  BodyFitOptions how;
  how.watched_m = measured->watched_m;
  how.noise = options.noise.value_or(0.0) * (how.watched_m ? kMetresPerMillimetre : 1.0);
  out.facts.noise = how.noise;
  const auto begin = std::chrono::steady_clock::now();
  auto found = fitBody(
      simulator, measured->name, out.curve, how, session.plugins().ownerOf(simulator),
      [&session] { return session.plugins().takeError(); }, progress);
  line.finish();
  if (!found) return tl::unexpected(ofCurve(found.error(), options.curve));
  out.facts.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  out.fit = std::move(*found);

  // A run without a step has the facts of a report.
  RunOptions still = options.run;
  still.steps = 0;
  still.report.clear();
  HeadlessRun run(session, simulator, built->table, still, {}, outputs, beginning->source);
  if (const auto ran = run.run(); !ran) return tl::unexpected(ran.error());
  RunFacts facts = built->facts(run, *scene, options.run.scene);
  facts.fit = fitJson(out.fit, out.curve, out.facts);
  if (out.fit.verdict == FitVerdict::undetermined) facts.outcome = "failed", facts.failure = out.fit.reason;
  if (const auto good = writeOutputs(options, out, facts, run, outputs); !good) return tl::unexpected(good.error());
  return out;
}

}  // namespace

int fitScene(const FitOptions &options) {
  watchForInterrupt();
  if (const auto good = checkOutputs(outputsOf(options), {}); !good) return reportError(good.error());
  const auto journal = beginJournal(options.run.session);
  auto session = Session::create(options.run.session);
  if (!session) return reportError(session.error());
  WrittenOutputs outputs;
  const auto fitted = fit(options, **session, outputs);
  if (!fitted) {
    if (!outputs.areComplete()) reportError(outputs.error());
    return reportError(fitted.error());
  }
  if (!options.run.quiet) {
    for (const std::string &text : fitLines(fitted->fit, fitted->curve, fitted->facts)) printOut(text + "\n");
    for (const std::string &notice : fitted->notices) printOut("  note: " + notice + "\n");
  }
  ExitCode exitCode = kDone;
  if (fitted->fit.verdict == FitVerdict::undetermined)
    exitCode = reportError({ErrorCode::state, pathText(options.curve) + ": " + fitted->fit.reason});
  // A missing output takes precedence over other failures.
  return outputs.areComplete() ? exitCode : reportError(outputs.error());
}

}  // namespace c3de::app
