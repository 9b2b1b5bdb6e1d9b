// SPDX-License-Identifier: Apache-2.0
#include "simulator/body_builder.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>

#include "base/build_request.h"
#include "report/advice.h"

namespace pointbased {
namespace {

// The queries run inside parallel loops of the solver, where errors are not handled. They cannot fail for our own trees
// and views. If they did, "nothing near" would be a wrong result, so the error is thrown here.
void mustSucceed(const sdk::Result<void> &result) {
  if (!result) throw sdk::Error(result.failure());
}

Surface surfaceOf(const PlacedMesh &mesh) {
  Surface surface;
  surface.positions = mesh.positions;
  for (const auto &t : mesh.triangles) surface.triangles.push_back({t[0], t[1], t[2]});
  return surface;
}

BodyShape shapeOf(const Services &services, c3de_handle mesh, const Placement &placement,
                  const std::shared_ptr<PlacedMesh> &surface) {
  BodyShape shape;
  shape.min = surface->min;
  shape.max = surface->max;
  shape.volume = surface->volume;
  const PlacementTransform transform(placement);
  shape.inside = [&services, mesh, transform](std::span<const Vec3> points, std::span<double> inside) {
    std::vector<Vec3> mm;
    mm.reserve(points.size());
    for (const Vec3 &p : points) mm.push_back(transform.millimetres(p));
    mustSucceed(services.meshes.windingNumbers(mesh, viewOf(mm), inside));
  };
  shape.surfaceDistance = [&services, surface](std::span<const Vec3> points, std::span<double> distances) {
    std::vector<c3de_closest> found(points.size());
    const double everywhere = std::numeric_limits<double>::infinity();
    const auto *table = services.collision.table();
    mustSucceed(
        services.host.check(table->closest(table->ctx, surface->tree.handle(), viewOf(points),
                                           sdk::scalars(std::span<const double>(&everywhere, 1)), found.data())));
    for (std::size_t i = 0; i < points.size(); ++i) distances[i] = std::abs(found[i].distance);
  };
  shape.crosses = [&services, surface](std::span<const Vec3> from, std::span<const Vec3> to,
                                       std::span<std::uint8_t> crosses) {
    std::vector<c3de_ray_hit> hits(from.size());
    const auto *table = services.collision.table();
    mustSucceed(services.host.check(
        table->segments(table->ctx, surface->tree.handle(), viewOf(from), viewOf(to), hits.data())));
    for (std::size_t i = 0; i < from.size(); ++i) crosses[i] = hits[i].t >= 0.0 ? 1 : 0;
  };
  shape.surface = surfaceOf(*surface);
  return shape;
}

// The body inside a deformed skin, for references that are updated while the body flows. Runs within a step of the
// solver.
Reshape reshapeOf(const Services &services) {
  return [&services](const Surface &skin) -> Result<BodyShape> {
    std::vector<Vec3> mm;
    mm.reserve(skin.positions.size());
    for (const Vec3 &x : skin.positions) mm.push_back(x / kMetresPerMillimetre);
    auto mesh = services.meshes.create(viewOf(mm), sdk::rows<std::uint32_t, 3>(std::span(skin.triangles)));
    if (!mesh) return tl::unexpected<std::string>(mesh.failure().message);
    try {
      const auto placed = placeMesh(services, mesh->handle(), Placement{});
      BodyShape shape = shapeOf(services, mesh->handle(), Placement{}, placed);
      // The shape queries the mesh.
      const auto kept = std::make_shared<const sdk::MeshHandle>(std::move(*mesh));
      shape.inside = [kept, ask = std::move(shape.inside)](std::span<const Vec3> points, std::span<double> inside) {
        ask(points, inside);
      };
      return shape;
    } catch (const sdk::Error &error) {
      return tl::unexpected<std::string>(error.what());
    }
  };
}

}  // namespace

// "fix 1: …" of the core counts the body's own fixes; error locations have the numbers of the scene.
sdk::Error errorOf(const std::string &text, const std::string &name, const BodySource &source) {
  const std::size_t blank = text.find(' '), colon = text.find(": ");
  if (blank != std::string::npos && colon != std::string::npos && blank < colon) {
    const std::string table = text.substr(0, blank), what = text.substr(colon + 2);
    const auto own = static_cast<std::uint32_t>(std::strtoul(text.c_str() + blank, nullptr, 10));
    if (table == "refinement") return {C3DE_E_ARG, what, {table, own, {}}};
    if (table == "fix" && own < source.fixNumbers.size())
      return {C3DE_E_ARG, what, {table, source.fixNumbers[own], {}}};
    if (table == "load" && own < source.loadNumbers.size())
      return {C3DE_E_ARG, what, {table, source.loadNumbers[own], {}}};
  }
  return {C3DE_E_ARG, name + ": " + text};
}

Constitution constitutionOf(const MaterialLaws &laws, const std::string &name, const BodySource &source,
                            const ParameterValues &values) {
  Constitution out;
  out.materials = {laws.materialOf(name, values)};
  if (const auto valid = validate(out.materials.front()); !valid)
    throw sdk::Error(C3DE_E_ARG, name + ": " + valid.error());
  for (std::size_t i = 0; i < source.parts.size(); ++i) {
    out.materials.push_back(laws.materialOf("part " + std::to_string(i), source.parts[i].values, &source.parts[i].own));
    if (const auto valid = validate(out.materials.back()); !valid)
      throw sdk::Error(C3DE_E_ARG, "part " + std::to_string(i) + ": " + valid.error());
  }
  out.stabilisation = stabilisationOf(values);
  return out;
}

namespace {

sdk::Error cancelled() { return {C3DE_E_CANCELLED, "cancelled"}; }

bool choosesSampling(const ParameterValues &values) {
  return values.isAuto("sampling.spacing") && values.isAuto("sampling.count") && !isRigid(values) &&
         evaluationOf(values) == Evaluation::stressPoints;
}

// The sampling chosen for a body before it is built.
AccuracyPrediction predictionFor(const AccuracyProblem &problem, double area, const SamplingRequest &dial,
                                 bool choosesOrder, const ParallelFor &parallelFor, BuildRequest &request) {
  if (!request.report(0.02, "trying coarse samplings")) throw cancelled();
  AccuracyPrediction promise;
  promise.wish = dial.wish;
  auto survey = surveyAccuracy(problem, parallelFor, &request);
  if (!survey) {
    promise.unpredicted = survey.error();
    promise.choice.count = automaticCount(problem.shape.volume, area);
    return promise;
  }
  promise.survey = std::make_shared<const AccuracySurvey>(std::move(*survey));
  CostSetting setting = dial.setting;
  setting.surfels = problem.shape.surface.positions.size();
  promise.choice = chooseSampling(*promise.survey, problem.constitution, setting, dial.wish);
  // The order for an error target is the same on every machine.
  CostSetting comparing = setting;
  if (dial.wish.kind == AccuracyTarget::Kind::share || dial.wish.kind == AccuracyTarget::Kind::length)
    comparing.speed = nominalSpeed();
  if (!choosesOrder || !mayNeedSecondOrder(*promise.survey, promise.choice, problem.constitution, dial.wish))
    return promise;
  if (!request.report(0.03, "trying functions of second order")) throw cancelled();
  BodyRecipe recipe = problem.recipe;
  recipe.sampling.order = LatticeOrder::quadratic;
  auto second = surveyAccuracy({problem.shape, recipe, problem.constitution, problem.foundation, problem.gravity},
                               parallelFor, &request);
  // No quadratic cell, because the lattice fits the body, or no solution.
  if (!second || second->fine.quadraticPoints == 0) return promise;
  if (!prefersSecondOrder(chooseSampling(*promise.survey, problem.constitution, comparing, dial.wish),
                          chooseSampling(*second, problem.constitution, comparing, dial.wish), dial.wish))
    return promise;
  promise.survey = std::make_shared<const AccuracySurvey>(std::move(*second));
  promise.choice = chooseSampling(*promise.survey, problem.constitution, setting, dial.wish);
  return promise;
}

BodyRecipe recipeOf(const Services &services, const std::string &name, const BodySource &source,
                    const ParameterValues &values) {
  BodyRecipe recipe;
  recipe.evaluation = evaluationOf(values);
  recipe.sampling = samplingOf(values);
  recipe.sampling.refinements = source.refinements;
  for (std::size_t i = 0; i < source.parts.size(); ++i)
    recipe.sampling.materials.emplace_back(source.parts[i].region, static_cast<std::uint16_t>(i + 1));
  recipe.neighbors = neighborChoiceOf(values);
  if (recipe.evaluation == Evaluation::phyxels &&
      (!source.refinements.empty() || recipe.sampling.surfaceSpacing > 0.0 || recipe.sampling.jitter > 0.0 ||
       values.text("sampling.adaptive") == "on" || recipe.sampling.order != LatticeOrder::linear))
    throw sdk::Error(
        C3DE_E_ARG,
        name + ": sampling.refine, surface_spacing, order, adaptive and jitter belong to sampling.evaluation = " +
            "\"stress_points\"; with \"phyxels\" choose spacing or count");
  recipe.fixes = source.fixes;
  recipe.loads = source.loads;
  recipe.reshape = reshapeOf(services);
  return recipe;
}

/// A body being built: data that does not change while its sampling is determined.
struct Making {
  const std::string &name;
  const BodySource &source;
  const ParameterValues &values;
  const BodyShape &shape;
  const PlacedMesh &surface;
  const Constitution &constitution;
  const SamplingRequest &dial;
  const ParallelFor &parallelFor;
  BuildRequest &request;

  [[nodiscard]] AccuracyProblem problem(const BodyRecipe &recipe) const {
    return {shape, recipe, constitution, foundationOf(values), dial.gravity};
  }
};

// Whether any known action on it exists besides gravity.
bool isActedOn(const BodySource &source) {
  return !source.loads.empty() || !source.grabs.empty() ||
         std::any_of(source.fixes.begin(), source.fixes.end(), [](const Fix &fix) { return fix.prescribesMotion(); });
}

// Automatically on for bodies of several tissues.
bool isAdaptive(const Making &of) {
  const std::string &asked = of.values.text("sampling.adaptive");
  if (isRigid(of.values) || evaluationOf(of.values) == Evaluation::phyxels || asked == "off") return false;
  return asked == "on" ||
         (of.values.isAuto("sampling.spacing") && of.source.fill && !of.source.parts.empty() && isActedOn(of.source));
}

// The sampling with local refinement for the same number of phyxels.
AdaptiveSampling adapted(const Making &of, const BodyRecipe &recipe) {
  if (!of.request.report(0.03, "locating the largest errors")) throw cancelled();
  BodyRecipe tried = recipe;
  tried.loads.insert(tried.loads.end(), of.source.grabs.begin(), of.source.grabs.end());
  const auto unchanged = [&](std::string why) {
    AdaptiveSampling out;
    out.sampling = recipe.sampling;
    out.uniform = std::move(why);
    return out;
  };
  if (!isActedOn(of.source) && of.dial.gravity.isZero(0.0))
    return unchanged("nothing moves or loads it, and it has not been pulled yet");
  auto found = adaptSampling(of.problem(tried), of.parallelFor, &of.request);
  if (of.request.isRaised()) throw cancelled();
  return found ? std::move(*found) : unchanged("a trial has no solution: " + found.error());
}

std::unique_ptr<Body> filledBody(const Making &of, const BodyRecipe &recipe) {
  auto rest = buildRestState(of.shape, recipe, of.surface.normals, of.parallelFor, [&](double fraction) {
    return of.request.report(0.05 + 0.8 * fraction, "filling with phyxels");
  });
  if (!rest) {
    if (rest.error() == "cancelled") throw cancelled();
    throw errorOf(rest.error(), of.name, of.source);
  }
  if (const std::string thin = describeCoarseness(**rest, areaOf(of.surface)); !thin.empty() && !isRigid(of.values))
    throw sdk::Error(C3DE_E_ARG, of.name + ": " + thin);
  if (!of.request.report(0.85, "finding the stable step")) throw cancelled();
  return std::make_unique<Body>(of.name, std::move(*rest), of.constitution, of.parallelFor);
}

// A body whose steps are those of uniform cells, as far as a little added mass allows. Null if they would be too small.
std::unique_ptr<Body> adaptiveBody(const Making &of, const BodyRecipe &recipe, AdaptiveSampling &adaptive) {
  BodyRecipe finer = recipe;
  finer.sampling = adaptive.sampling;
  auto body = filledBody(of, finer);
  if (!mayStepExplicitly(of.dial.setting.world.integrator) || adaptive.halved == 0) return body;
  // Halving the cells that determine the step also halves the step.
  constexpr double kShortestStep = 0.4;
  body->scaleMasses(adaptive.evenStep, of.parallelFor);
  if (body->stableStepAtRest() >= kShortestStep * adaptive.evenStep) return body;
  adaptive.uniform = "halves of its stiff cells would ask for explicit steps of " +
                     shortNumber(1e3 * body->stableStepAtRest()) + " instead of " +
                     shortNumber(1e3 * adaptive.evenStep) +
                     " ms; solver.integrator = \"quasistatic\" or \"implicit\" has no such steps";
  adaptive.halved = 0;
  adaptive.sampling = recipe.sampling;
  return nullptr;
}

std::unique_ptr<Body> bodyOf(const Making &of, const BodyRecipe &recipe, std::optional<AdaptiveSampling> &adaptive) {
  std::unique_ptr<Body> body;
  if (isAdaptive(of)) body = adaptiveBody(of, recipe, adaptive.emplace(adapted(of, recipe)));
  if (!body) body = filledBody(of, recipe);
  body->setInitialVelocity(of.source.velocity, of.source.angularVelocity);
  if (const auto held = body->setFoundation(foundationOf(of.values)); !held)
    throw sdk::Error(C3DE_E_ARG, of.name + ": surroundings.stiffness: " + held.error());
  if (isRigid(of.values)) body->setRigid(true, isFree(of.values));
  return body;
}

void measureFrameOf(const Making &of, const Body &body, AccuracyPrediction &promise) {
  if (!of.request.report(0.9, "measuring a frame")) throw cancelled();
  promise.measured(of.dial.frameTime(body, &of.request));
  if (of.request.isRaised()) throw cancelled();
}

// The finest sampling whose measured frame is within a budget. Counts are on a ladder, so that small differences of the
// measured time lead to the same count. The search starts with the predicted count.
std::unique_ptr<Body> bodyWithinBudget(const Making &of, BodyRecipe recipe, const CostSetting &setting,
                                       const std::function<void(BodyRecipe &, double)> &askFor, BuiltBody &out) {
  constexpr int kAttempts = 7;
  constexpr double kRung = 1.08;            // ratio of successive counts
  constexpr double kCostOrder = 4.0 / 3.0;  // exponent of the frame time in the count: phyxels, and steps
  // Fractions of the budget: the upper limit of a frame, the target, and what is sufficient.
  constexpr double kAtMost = 0.95, kAimedAt = 0.88, kUsed = 0.8;
  const AccuracyPrediction predicted = *out.promise;
  const AccuracySurvey &survey = *predicted.survey;
  const double budget = 1e3 * predicted.wish.value;  // ms
  const int last = static_cast<int>(std::log(kMaxChosenPhyxels / kMinChosenPhyxels) / std::log(kRung));
  const double first = std::log(static_cast<double>(predicted.choice.count) / kMinChosenPhyxels) / std::log(kRung);
  int rung = std::clamp(static_cast<int>(std::lround(first)), 0, last);
  int within = -1, beyond = last + 1;
  std::unique_ptr<Body> best;
  for (int attempt = 1;; ++attempt) {
    AccuracyPrediction promise = predicted;
    std::optional<AdaptiveSampling> adaptive;
    askFor(recipe, survey.spacingFor(kMinChosenPhyxels * std::pow(kRung, rung)));
    auto body = bodyOf(of, recipe, adaptive);
    promise.built(body->rest());
    promise.choice.touching_ms = predictTouching(survey, of.constitution, setting, promise.choice.spacing);
    measureFrameOf(of, *body, promise);
    const double frame = promise.choice.frame_ms + promise.choice.touching_ms;
    const bool isWithin = frame <= kAtMost * budget;
    (isWithin ? within : beyond) = rung;
    // If none is within the budget: the coarsest one tried.
    if (isWithin || within < 0) {
      best = std::move(body);
      *out.promise = std::move(promise);
      out.adaptive = std::move(adaptive);
    }
    if ((isWithin && frame >= kUsed * budget) || beyond - within <= 1 || attempt >= kAttempts) return best;
    const double steps = std::log(kAimedAt * budget / frame) / (kCostOrder * std::log(kRung));
    const int next = rung + static_cast<int>(std::clamp(std::round(steps), -1.0 * last, 1.0 * last));
    rung = std::clamp(next, within + 1, beyond - 1);
  }
}

// The body with the sampling chosen by the accuracy setting.
std::unique_ptr<Body> bodyWithChosenSampling(const Making &of, BodyRecipe recipe, BuiltBody &out) {
  const SamplingRequest &dial = of.dial;
  AccuracyPrediction &promise = out.promise.emplace();
  const double area = areaOf(of.surface);
  const bool choosesOrder = of.values.text("sampling.order") == "auto" && recipe.sampling.jitter == 0.0;
  promise = predictionFor(of.problem(recipe), area, dial, choosesOrder, of.parallelFor, of.request);
  recipe.sampling.count = promise.choice.count;
  if (promise.survey) recipe.sampling.order = promise.choice.order;
  // Bodies without further requirements keep the automatic count.
  const auto askFor = [&of, survey = promise.survey](BodyRecipe &asked, double spacing) {
    // Coarser cells, some of which are halved, give the same number of phyxels.
    if (isAdaptive(of))
      asked.sampling.count = static_cast<std::size_t>(std::lround(survey->phyxelsAt(spacing)));
    else
      asked.sampling.spacing = spacing;
  };
  if (promise.survey && recipe.sampling.count != automaticCount(of.shape.volume, area))
    askFor(recipe, promise.choice.spacing);
  CostSetting setting = dial.setting;
  setting.surfels = of.surface.positions.size();
  if (dial.wish.kind == AccuracyTarget::Kind::budget && promise.survey && dial.frameTime)
    return bodyWithinBudget(of, std::move(recipe), setting, askFor, out);
  auto body = bodyOf(of, recipe, out.adaptive);
  promise.built(body->rest());
  if (promise.survey)
    promise.choice.touching_ms = predictTouching(*promise.survey, of.constitution, setting, promise.choice.spacing);
  if (dial.wish.kind != AccuracyTarget::Kind::standard && dial.frameTime) measureFrameOf(of, *body, promise);
  return body;
}

BuiltBody build(const Services &services, const MaterialLaws &laws, const std::string &name, c3de_handle mesh,
                const BodySource &source, const ParameterValues &values, const SamplingRequest &dial,
                BuildRequest &request) {
  refuseConflictingSampling(name, values, dial.wish);
  const Constitution constitution = constitutionOf(laws, name, source, values);
  const auto *meshes = services.meshes.table();
  if (const auto fillable = services.host.check(meshes->check_fillable(meshes->ctx, mesh)); !fillable)
    throw sdk::Error(C3DE_E_FORMAT, fillable.failure().message);
  if (!request.report(0.0, "placing the surface")) throw cancelled();

  BuiltBody out;
  out.surface = placeMesh(services, mesh, source.placement);
  StoppableLoops loops(services.parallelFor());
  const ParallelFor &parallelFor = loops.parallelFor();
  BodyRecipe recipe = recipeOf(services, name, source, values);
  const StoppableLoops::Watch watch(loops, &request);
  const auto shape = source.fill ? shapeOf(source.fill->occupancy, surfaceOf(*out.surface), parallelFor)
                                 : Result<BodyShape>(shapeOf(services, mesh, source.placement, out.surface));
  if (!shape) throw sdk::Error(C3DE_E_ARG, name + ": its fill: " + shape.error());
  const Making making{name, source, values, *shape, *out.surface, constitution, dial, parallelFor, request};
  if (choosesSampling(values)) {
    out.body = bodyWithChosenSampling(making, std::move(recipe), out);
    return out;
  }
  if (recipe.sampling.count == 0) recipe.sampling.count = automaticCount(shape->volume, areaOf(*out.surface));
  // Rigid bodies have it as well, because they may become deformable during the simulation.
  if (values.text("sampling.order") == "auto" && recipe.evaluation == Evaluation::stressPoints &&
      suggestsSecondOrder(*shape, recipe, constitution))
    recipe.sampling.order = LatticeOrder::quadratic;
  out.body = bodyOf(making, std::move(recipe), out.adaptive);
  return out;
}

}  // namespace

BuiltBody buildBody(const Services &services, const MaterialLaws &laws, const std::string &name, c3de_handle mesh,
                    const BodySource &source, const ParameterValues &values, const SamplingRequest &dial,
                    const sdk::Progress &progress) {
  BuildRequest request(progress);
  try {
    BuiltBody out = build(services, laws, name, mesh, source, values, dial, request);
    (void)progress.update(1.0, "done");
    return out;
  } catch (const Stopped &) {
    throw cancelled();
  }
}

bool mayStepExplicitly(Integrator integrator) {
  return integrator == Integrator::explicitVerlet || integrator == Integrator::automatic;
}

BodyFilling fillingOf(const Services &services, const std::string &name, const BodySource &source,
                      const ParameterValues &values, const ParallelFor &parallelFor) {
  BodyFilling out;
  out.surface = placeMesh(services, source.mesh->handle(), source.placement);
  auto shape = source.fill ? shapeOf(source.fill->occupancy, surfaceOf(*out.surface), parallelFor)
                           : Result<BodyShape>(shapeOf(services, source.mesh->handle(), source.placement, out.surface));
  if (!shape) throw sdk::Error(C3DE_E_ARG, name + ": its fill: " + shape.error());
  out.shape = std::move(*shape);
  out.recipe = recipeOf(services, name, source, values);
  return out;
}

sdk::MeshHandle copyMesh(const Services &services, c3de_handle mesh) {
  const auto *table = services.meshes.table();
  c3de_view positions{}, triangles{};
  sdk::orThrow(services.host.check(table->positions(table->ctx, mesh, &positions)));
  sdk::orThrow(services.host.check(table->triangles(table->ctx, mesh, &triangles)));
  return sdk::orThrow(services.meshes.create(positions, triangles));
}

Obstacle buildObstacle(const Services &services, const std::string &name, const std::shared_ptr<PlacedMesh> &mesh,
                       const ObstacleSurface &surface, const std::optional<Fix> &motion) {
  Obstacle obstacle;
  obstacle.name = name;
  obstacle.friction = surface.friction;
  obstacle.restitution = surface.restitution;
  if (motion) {
    ConstrainedRegion whole;
    whole.centroid = 0.5 * (mesh->min + mesh->max);
    obstacle.motion = [fix = *motion, whole](double t) {
      const double s = fix.ramp > 0.0 ? std::clamp(t / fix.ramp, 0.0, 1.0) : 1.0;
      return motionAt(fix, whole, Vec3::Zero(), s);
    };
  }
  obstacle.closest = [&services, mesh](std::span<const Vec3> points, std::span<const double> maxDistances,
                                       std::span<SurfacePoint> out) {
    std::vector<c3de_closest> found(points.size());
    const auto *table = services.collision.table();
    mustSucceed(services.host.check(
        table->closest(table->ctx, mesh->tree.handle(), viewOf(points), sdk::scalars(maxDistances), found.data())));
    const double resolved = 1e-9 * (mesh->max - mesh->min).norm();
    for (std::size_t i = 0; i < points.size(); ++i) {
      // The contact plane is perpendicular to the path to the surface; the normal of an edge or corner deviates from
      // it.
      Vec3 normal(found[i].normal[0], found[i].normal[1], found[i].normal[2]);
      if (std::isfinite(found[i].distance)) {
        const Vec3 offset = points[i] - Vec3(found[i].point[0], found[i].point[1], found[i].point[2]);
        if (const double length = offset.norm(); length > resolved)
          normal = (found[i].distance < 0.0 ? -1.0 : 1.0) / length * offset;
      }
      out[i] = {normal, found[i].distance};
    }
  };
  obstacle.crossing = [&services, mesh](const Vec3 &from, const Vec3 &to, Vec3 &normal) {
    c3de_ray_hit hit{};
    const auto *table = services.collision.table();
    mustSucceed(services.host.check(
        table->segments(table->ctx, mesh->tree.handle(), viewOf({&from, 1}), viewOf({&to, 1}), &hit)));
    if (hit.triangle >= mesh->triangles.size()) return -1.0;
    const auto &corners = mesh->triangles[hit.triangle];
    normal = (mesh->positions[corners[1]] - mesh->positions[corners[0]])
                 .cross(mesh->positions[corners[2]] - mesh->positions[corners[0]])
                 .normalized();
    return hit.t;
  };
  return obstacle;
}

}  // namespace pointbased
