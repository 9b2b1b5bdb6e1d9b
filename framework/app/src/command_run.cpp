// SPDX-License-Identifier: Apache-2.0
#include "command_run.h"

#include <chrono>
#include <cstdio>
#include <utility>

#include "c3de/core/log.h"
#include "c3de/geometry/mesh_io.h"
#include "c3de/render/renderer.h"
#include "exit_code.h"
#include "export_simulation.h"
#include "file_kind.h"
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
    if (const FileKind kind = kindOf(options.scene); kind == FileKind::unknown)
      return tl::unexpected(unknownKind(options.scene));
    else if (kind == FileKind::image)
      return fail(ErrorCode::input, options.scene.string() + ": is an image; accepted: a mesh, or a scene (.toml) whose [[body]] "
                                                             "names it as its volume, with a label or a threshold");
    geometry::LengthUnit unit = geometry::unitInFile(options.scene).value_or(geometry::LengthUnit::millimetre);
    if (!options.meshUnit.empty()) {
      const auto stated = scene::parseLengthUnit(options.meshUnit);
      if (!stated) return fail(ErrorCode::usage, "--unit: " + stated.error().message);
      unit = *stated;
    }
    scene = scene::sceneForMesh(options.scene, unit);
  }
  for (const std::string &assignment : options.overrides) {
    if (!scene) break;
    if (auto applied = scene::applyOverride(*scene, assignment, &materials); !applied)
      return tl::unexpected(applied.error());
  }
  return scene;
}

/// A value of the world as the scene asks for it, or the simulator's default; none where neither says it.
std::optional<ParameterValue> worldValue(const scene::SceneFile &scene, c3de_object *simulator, const std::string &id) {
  for (const scene::SceneValue &value : scene.world)
    if (value.value.id == id) return value.value;
  if (const auto decls = simulatorDeclarations(simulator, C3DE_SIM_SCOPE_WORLD))
    if (const auto decl = findParameter(*decls, id)) return (*decl)->fallbackValue();
  return std::nullopt;
}

RunLimits limitsOf(const scene::SceneFile &scene, c3de_object *simulator, const RunOptions &options,
                   std::chrono::steady_clock::time_point begin) {
  RunLimits limits;
  limits.begin = begin;
  if (const auto integrator = worldValue(scene, simulator, "solver.integrator")) limits.integrator = integrator->text;
  if (const auto steps = worldValue(scene, simulator, "solver.load_steps"); steps && steps->num > 0.0)
    limits.loadSteps = steps->num;
  if (options.timeLimit_s)
    limits.deadline = begin + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                                  std::chrono::duration<double>(*options.timeLimit_s));
  return limits;
}

void printSummary(const RunFacts &facts) {
  if (facts.integrator == kQuasistatic) {
    std::printf("%s: %s, %llu load steps in %.3g s\n", facts.scene.c_str(), facts.outcome.c_str(),
                static_cast<unsigned long long>(facts.steps), facts.wall_s);
    return;
  }
  const Preparation &took = facts.preparation;
  if (took.masks_s > 0.0)
    std::printf("%s: first step after %.3g s (reading %.3g, masks %.3g, surfaces %.3g, fills %.3g, bodies %.3g, step %.3g)\n",
                facts.scene.c_str(), facts.toFirstStep_s, took.reading_s, took.masks_s, took.surfaces_s, took.fills_s,
                took.bodies_s, facts.firstStep_s);
  const double factor = facts.wall_s > 0.0 ? facts.time_s / facts.wall_s : 0.0;
  std::printf("%s: %s, %llu steps of %.4g s, %.6g s simulated in %.3g s (%.3g times real time)\n", facts.scene.c_str(),
              facts.outcome.c_str(), static_cast<unsigned long long>(facts.steps), facts.dt_s, facts.time_s, facts.wall_s,
              factor);
}

/// Where the state at the end of a run that did not reach its end can be found.
std::string whereKept(const RunOptions &options) {
  std::string files;
  for (const auto *file : {&options.report, &options.probes, &options.screenshot, &options.exportList, &options.exportSurface,
                           &options.exportImage.image, &options.exportImage.displacement})
    if (!file->empty()) files += (files.empty() ? "" : ", ") + file->string();
  return files.empty() ? "; --report FILE.json keeps the last good state" : "; the last good state is in " + files;
}

std::vector<std::filesystem::path> outputsOf(const RunOptions &options, const scene::SceneFile &scene) {
  std::vector<std::filesystem::path> all{options.report,     options.probes,            options.screenshot,
                                         options.exportList, options.exportImage.image, options.exportImage.displacement};
  std::vector<std::string> names;
  for (const scene::SceneBody &body : scene.bodies) names.push_back(body.name);
  if (!options.exportSurface.empty())
    for (std::filesystem::path &file : surfaceFiles(options.exportSurface, names)) all.push_back(std::move(file));
  return all;
}

std::vector<std::filesystem::path> inputsOf(const scene::SceneFile &scene) {
  std::vector<std::filesystem::path> all{scene.source};
  for (const scene::SceneBody &body : scene.bodies) all.insert(all.end(), {body.mesh, body.volume.file});
  for (const scene::SceneObstacle &obstacle : scene.obstacles) all.push_back(obstacle.mesh);
  if (scene.image) {
    all.push_back(scene.image->file);
    all.insert(all.end(), scene.image->labels.begin(), scene.image->labels.end());
  }
  return all;
}

Expected<RunFacts> simulate(const RunOptions &options, Session &session, render::Renderer *renderer,
                            std::chrono::steady_clock::time_point begin) {
  auto scene = readScene(options, session.materials());
  if (!scene) return tl::unexpected(scene.error());
  if (!options.exportSurface.empty()) {
    std::vector<std::string> names;
    for (const scene::SceneBody &body : scene->bodies) names.push_back(body.name);
    if (const auto writable = checkSurfaceExport(options.exportSurface, names); !writable) return tl::unexpected(writable.error());
  }
  if (const auto good = checkDistinct(outputsOf(options, *scene), inputsOf(*scene)); !good) return tl::unexpected(good.error());
  const auto image = imageToExport(options.exportImage, *scene);
  if (!image) return tl::unexpected(image.error());
  for (const std::string &notice : image->notices) log(LogLevel::warn, scene->image->file.string() + ": " + notice);
  auto created = session.createSimulator();
  if (!created) return tl::unexpected(created.error());
  const ObjectRef simulator(*created);
  const auto table = simulatorTable(simulator.get());
  if (!table) return tl::unexpected(table.error());

  Preparation preparation;
  {
    ProgressLine progress(options.quiet);
    const auto populated = session.populate(simulator.get(), *scene, [&](double fraction, const std::string &what) {
      progress.update(fraction, what);
      return !wasInterrupted();
    }, &preparation);
    if (!populated) return tl::unexpected(populated.error());
  }

  HeadlessRun run(session, simulator.get(), *table, options, limitsOf(*scene, simulator.get(), options, begin));
  if (const auto ran = run.run(); !ran) return tl::unexpected(ran.error());
  RunFacts facts = run.facts();
  facts.preparation = preparation;
  facts.scene = scene->title;
  facts.source = options.scene.string();

  if (!options.report.empty()) {
    const auto simulatorJson = run.simulatorReport();
    if (!simulatorJson) return tl::unexpected(simulatorJson.error());
    const auto json = reportJson(facts, *simulatorJson);
    if (!json) return tl::unexpected(json.error());
    if (const auto written = writeTextFile(options.report, *json); !written) return tl::unexpected(written.error());
  }
  if (!options.exportSurface.empty()) {
    const auto states = readBodyStates(simulator.get(), BodyParts::skin, [&] { return session.plugins().takeError(); });
    if (!states) return tl::unexpected(states.error());
    if (const auto written = writeSurfaces(options.exportSurface, *states); !written) return tl::unexpected(written.error());
  }
  if (const auto written = exportImages(options.exportImage, image->volume, scene->image ? scene->image->rim_mm : 0.0, *table,
                                          simulator.get(), session.pool());
      !written)
    return tl::unexpected(written.error());
  if (renderer != nullptr) {
    if (const auto adopted = session.adopt(simulator.get(), scene->title); !adopted) return tl::unexpected(adopted.error());
    const auto drawn = writeScreenshot(session, *renderer, options.screenshot, options.width, options.height);
    if (!drawn) return tl::unexpected(drawn.error());
  }
  return facts;
}

}  // namespace

int runScene(const RunOptions &options) {
  const auto begin = std::chrono::steady_clock::now();
  watchForInterrupt();
  for (const auto *file : {&options.report, &options.probes, &options.screenshot}) {
    if (file->empty()) continue;
    if (const auto writable = checkWritable(*file); !writable) return reportError(writable.error());
  }

  if (!options.exportList.empty())
    if (const auto writable = checkSimulationExport(options.exportList); !writable) return reportError(writable.error());
  if (!options.exportSurface.empty())
    if (const auto writable = checkSurfaceExport(options.exportSurface, {}); !writable) return reportError(writable.error());

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
  const auto facts = simulate(options, **session, renderer.get(), begin);
  if (!facts) return reportError(facts.error());

  if (!options.quiet) printSummary(*facts);
  if (facts->outcome == "done") return kDone;
  if (facts->outcome == "diverged")
    return reportError({ErrorCode::diverged, "the simulation diverged: " + facts->failure + whereKept(options)});
  if (facts->outcome == "time_limit") {
    reportError({ErrorCode::cancelled, facts->failure + whereKept(options)});
    return kTimeLimit;
  }
  if (facts->outcome == "interrupted") return reportError({ErrorCode::cancelled, facts->failure});
  return reportError({ErrorCode::internal, facts->failure});
}

}  // namespace c3de::app
