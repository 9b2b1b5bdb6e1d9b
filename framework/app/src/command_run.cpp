// SPDX-License-Identifier: Apache-2.0
#include "command_run.h"

#include <cstdio>
#include <utility>

#include "c3de/render/renderer.h"
#include "exit_code.h"
#include "headless_run.h"
#include "interrupt.h"
#include "output_file.h"
#include "progress_line.h"
#include "screenshot.h"
#include "simulator_access.h"

namespace c3de::app {
namespace {

Expected<scene::SceneFile> readScene(const RunOptions &options, const scene::MaterialLibrary &materials) {
  Expected<scene::SceneFile> scene;
  if (scene::isScenePath(options.scene)) {
    scene = scene::loadScene(options.scene, &materials);
  } else {
    std::error_code code;
    if (!std::filesystem::is_regular_file(options.scene, code))
      return fail(ErrorCode::input, options.scene.string() + ": no such file; accepted: a scene (.toml) or a mesh");
    const auto unit = scene::parseLengthUnit(options.meshUnit);
    if (!unit) return fail(ErrorCode::usage, "--unit: " + unit.error().message);
    scene = scene::sceneForMesh(options.scene, *unit);
  }
  for (const std::string &assignment : options.overrides) {
    if (!scene) break;
    if (auto applied = scene::applyOverride(*scene, assignment, &materials); !applied)
      return tl::unexpected(applied.error());
  }
  return scene;
}

/// The integrator that the scene asks for, or the simulator's default.
std::string integratorOf(const scene::SceneFile &scene, c3de_object *simulator) {
  for (const scene::SceneValue &value : scene.world)
    if (value.value.id == "solver.integrator") return value.value.text;
  if (const auto decls = simulatorDeclarations(simulator, C3DE_SIM_SCOPE_WORLD))
    if (const auto decl = findParameter(*decls, "solver.integrator")) return (*decl)->fallbackText;
  return {};
}

void printSummary(const RunFacts &facts) {
  const double factor = facts.wall_s > 0.0 ? facts.time_s / facts.wall_s : 0.0;
  std::printf("%s: %s, %llu steps of %.4g s, %.6g s simulated in %.3g s (%.3g times real time)\n", facts.scene.c_str(),
              facts.outcome.c_str(), static_cast<unsigned long long>(facts.steps), facts.dt_s, facts.time_s, facts.wall_s,
              factor);
}

Expected<RunFacts> simulate(const RunOptions &options, Session &session, render::Renderer *renderer) {
  auto scene = readScene(options, session.materials());
  if (!scene) return tl::unexpected(scene.error());
  auto created = session.createSimulator();
  if (!created) return tl::unexpected(created.error());
  const ObjectRef simulator(*created);
  const auto table = simulatorTable(simulator.get());
  if (!table) return tl::unexpected(table.error());

  {
    ProgressLine progress(options.quiet);
    const auto populated = session.populate(simulator.get(), *scene, [&](double fraction, const std::string &what) {
      progress.update(fraction, what);
      return !wasInterrupted();
    });
    if (!populated) return tl::unexpected(populated.error());
  }

  HeadlessRun run(session, simulator.get(), *table, options);
  if (const auto ran = run.run(); !ran) return tl::unexpected(ran.error());
  RunFacts facts = run.facts();
  facts.scene = scene->title;
  facts.source = options.scene.string();
  facts.integrator = integratorOf(*scene, simulator.get());

  if (!options.report.empty()) {
    const auto simulatorJson = run.simulatorReport();
    if (!simulatorJson) return tl::unexpected(simulatorJson.error());
    const auto json = reportJson(facts, *simulatorJson);
    if (!json) return tl::unexpected(json.error());
    if (const auto written = writeTextFile(options.report, *json); !written) return tl::unexpected(written.error());
  }
  if (renderer != nullptr) {
    if (const auto adopted = session.adopt(simulator.get(), scene->title); !adopted) return tl::unexpected(adopted.error());
    const auto drawn = writeScreenshot(session, *renderer, options.screenshot, options.width, options.height);
    if (!drawn) return tl::unexpected(drawn.error());
  }
  return facts;
}

}  // namespace

int runScene(const RunOptions &options) {
  watchForInterrupt();
  for (const auto *file : {&options.report, &options.probes, &options.screenshot}) {
    if (file->empty()) continue;
    if (const auto writable = checkWritable(*file); !writable) return reportError(writable.error());
  }

  // The context outlives the renderer, the renderer the session.
  std::unique_ptr<render::OffscreenContext> context;
  std::unique_ptr<render::Renderer> renderer;
  SessionOptions sessionOptions = options.session;
  if (!options.screenshot.empty()) {
    auto made = render::OffscreenContext::create();
    if (!made) return reportError(made.error());
    context = std::move(*made);
    auto gl = render::createGlRenderer();
    if (!gl) return reportError(gl.error());
    renderer = std::move(*gl);
    sessionOptions.renderer = renderer.get();
  }
  auto session = Session::create(sessionOptions);
  if (!session) return reportError(session.error());
  const auto facts = simulate(options, **session, renderer.get());
  if (!facts) return reportError(facts.error());

  if (!options.quiet) printSummary(*facts);
  if (facts->outcome == "done") return kDone;
  if (facts->outcome == "diverged")
    return reportError({ErrorCode::diverged, "the simulation diverged: " + facts->failure +
                                                 (options.report.empty() ? "; --report FILE.json keeps the last good state"
                                                                         : "; the last good state is in " +
                                                                               options.report.string())});
  if (facts->outcome == "interrupted") return reportError({ErrorCode::cancelled, facts->failure});
  return reportError({ErrorCode::internal, facts->failure});
}

}  // namespace c3de::app
