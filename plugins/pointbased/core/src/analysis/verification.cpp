// SPDX-License-Identifier: Apache-2.0
#include "pointbased/verification.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>

#include "analysis/fine_reference_forces.h"
#include "analysis/fine_reference_solution.h"
#include "base/number_text.h"
#include "base/rigid_fit.h"
#include "pointbased/error_estimate.h"

namespace pointbased {

using namespace detail;

namespace {

constexpr double kSkinSampling = 0.5;       // spacings of the body
constexpr double kQuantile = 0.95;          // of the area of the skin
constexpr double kBuildShare = 0.25;        // of the progress
constexpr double kSupportRefinement = 2.0;  // of the fine reference
constexpr double kRounding = 1e-12;         // of the distance from the world's origin

tl::unexpected<std::string> refused(const std::string &text) { return tl::unexpected<std::string>(text); }

bool inverted(const Body &body) {
  return std::any_of(body.gradients().begin(), body.gradients().end(),
                     [](const Mat3 &F) { return !(F.determinant() > 0.0); });
}

Result<void> verifiable(const VerificationTarget &target) {
  const BodyCheckpoint &state = target.state;
  if (state.rigid) return refused("it is rigid: it has no error of its own");
  if (state.stopped) return refused("it has stopped, so its state is no solution; reset leads out");
  if (state.rereferenceCount > 0)
    return refused("it has flowed so far that its reference is a later shape than the one it was filled from");
  return {};
}

// Always a lattice, finer everywhere, and finer still at the ends of supports: stress concentrations at their edges
// converge more slowly than the rest.
BodyRecipe fineReferenceRecipe(const BodyRecipe &recipe, double spacing, double refinement, bool fineSupports) {
  BodyRecipe out = recipe;
  out.evaluation = Evaluation::stressPoints;
  out.sampling.spacing = spacing / refinement;
  for (Refinement &finer : out.sampling.refinements) finer.spacing /= refinement;
  out.sampling.finer.spacing /= refinement;
  if (fineSupports)
    for (const Fix &fix : out.fixes)
      out.sampling.refinements.push_back({fix.region, out.sampling.spacing / kSupportRefinement});
  out.sampling.surfaceSpacing /= refinement;
  out.sampling.jitter = 0.0;
  out.reshape = {};
  return out;
}

/// Material points of the skin or the volume, and their current positions by body and fine reference, world, m.
struct Compared {
  std::vector<double> weights;  // m² or m³
  std::vector<Vec3> reference, coarse, fine;
  double errorOverDifference = 1.0;

  [[nodiscard]] double error(std::size_t i) const { return errorOverDifference * (fine[i] - coarse[i]).norm(); }
  [[nodiscard]] std::vector<double> errors() const {
    std::vector<double> out(reference.size());
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = error(i);
    return out;
  }
};

std::vector<Vec3> placesOf(const RestState &rest, std::span<const Vec3> displacements, std::span<const Vec3> points,
                           std::span<const Vec3> normals, const ParallelFor &parallelFor) {
  std::vector<Vec3> local(points.begin(), points.end()), out(points.size());
  for (Vec3 &x : local) x -= rest.origin;
  interpolateDisplacements(rest.bind(local, normals), rest.positions, displacements, out, parallelFor);
  for (std::size_t i = 0; i < out.size(); ++i) out[i] += points[i];
  return out;
}

double weightedRms(std::span<const double> values, std::span<const double> weights) {
  double sum = 0.0, weight = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    sum += weights[i] * values[i] * values[i];
    weight += weights[i];
  }
  return weight > 0.0 ? std::sqrt(sum / weight) : 0.0;
}

// Value below which a part `share` of the total weight is.
double weightedQuantile(std::span<const double> values, std::span<const double> weights, double share) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  const double all = std::accumulate(weights.begin(), weights.end(), 0.0);
  double sum = 0.0;
  for (const std::size_t i : order)
    if ((sum += weights[i]) >= share * all) return values[i];
  return values.empty() ? 0.0 : values[order.back()];
}

class Verifying {
 public:
  Verifying(const VerificationTarget &target, const BodyShape &shape, const ParallelFor &parallelFor,
            const VerifyProgress &progress, const StopRequest *stop, const VerifySettings &settings)
      : target_(target), shape_(shape), parallelFor_(parallelFor), progress_(progress), stop_(stop),
        settings_(settings), refinement_(settings.refinement),
        body_(target.name, target.state.rest, target.constitution, parallelFor) {
    (void)body_.setFoundation(target.foundation);
    body_.quasiStatic = target.world.integrator == Integrator::quasiStatic;
    (void)body_.restore(target.state, parallelFor);
  }

  [[nodiscard]] Result<Verification> run(const BodyRecipe &recipe) {
    const auto begin = std::chrono::steady_clock::now();
    if (inverted(body_)) return refused("parts of it are inverted, so its state is no solution of the material");
    if (!checkCount(countAt(body_.rest().spacing / refinement_))) refinement_ = kSmallFineReferenceRefinement;
    const double cell = body_.rest().spacing / refinement_;
    if (auto affordable = checkCount(countAt(cell)); !affordable) return refused(affordable.error());
    std::shared_ptr<const RestState> rest;
    auto solved = fineReferenceOf(recipe, affordsFineSupports(cell), rest);
    if (!solved) return refused(solved.error());
    if (!report(0.95, "comparing")) return refused("cancelled");
    Verification out = compare(*rest, *solved);
    out.fineReferenceRest = rest;
    out.fineReferenceDisplacements = std::move(solved->displacements);
    out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return out;
  }

 private:
  [[nodiscard]] bool report(double fraction, const std::string &what) const {
    return !progress_ || progress_(fraction, what);
  }

  [[nodiscard]] std::size_t countAt(double cell) const {
    return static_cast<std::size_t>(shape_.volume / (cell * cell * cell));
  }
  [[nodiscard]] Result<void> checkCount(std::size_t count) const {
    if (count <= settings_.maxPhyxels) return {};
    return refused("its fine reference would have about " + std::to_string(count) + " phyxels at a spacing of " +
                   number(1e3 * body_.rest().spacing / refinement_) + " mm; accepted: at most " +
                   std::to_string(settings_.maxPhyxels));
  }
  // Cells within supports are refined together with the edges of the supports.
  [[nodiscard]] bool affordsFineSupports(double cell) const {
    const double fine = cell / kSupportRefinement;
    double count = static_cast<double>(countAt(cell));
    for (const ConstrainedRegion &part : body_.rest().conditions.held)
      count += part.volume / (fine * fine * fine) + 4.0 * part.area / (fine * fine);
    return !body_.rest().conditions.held.empty() && count <= static_cast<double>(settings_.maxPhyxels);
  }

  // Uses the finer of the two fine references that has a solution.
  [[nodiscard]] Result<FineReferenceState> fineReferenceOf(const BodyRecipe &recipe, bool fineSupports,
                                                           std::shared_ptr<const RestState> &rest) {
    BodyRecipe fine = fineReferenceRecipe(recipe, body_.rest().spacing, refinement_, fineSupports);
    // The accuracy setting may have chosen the order.
    if (!body_.rest().stencils.quadratic.points.empty()) fine.sampling.order = LatticeOrder::quadratic;
    const auto filled = buildRestState(shape_, fine, {}, parallelFor_, [this](double fraction) {
      return report(kBuildShare * fraction, "filling the fine reference");
    });
    if (!filled)
      return refused(filled.error() == "cancelled" ? filled.error() : "its fine reference: " + filled.error());
    rest = *filled;
    hasFineSupports_ = fineSupports;
    auto solved =
        rest->phyxelCount() > settings_.maxPhyxels ? Result<FineReferenceState>(refused("too large")) : solve(rest);
    if (solved || solved.error() == "cancelled") return solved;
    if (fineSupports) return fineReferenceOf(recipe, false, rest);
    if (auto good = checkCount(rest->phyxelCount()); !good) return refused(good.error());
    return solved;
  }

  [[nodiscard]] Result<FineReferenceState> solve(const std::shared_ptr<const RestState> &rest) {
    Constitution constitution = target_.constitution;
    if (body_.rest().evaluation == Evaluation::phyxels) constitution.stabilisation = kLatticeStabilisation;
    auto fineReference = std::make_unique<Body>(target_.name, rest, std::move(constitution), parallelFor_);
    if (const auto held = fineReference->setFoundation(target_.foundation); !held) return refused(held.error());
    std::vector<Vec3> leftOver = knownForces(body_, target_.world.gravity, target_.clock, parallelFor_);
    for (std::size_t i = 0; i < leftOver.size(); ++i) leftOver[i] *= body_.heldMask()[i] ? 0.0 : -1.0;
    const FineReferenceProblem problem{target_, body_, parallelFor_, stop_, !hasFineSupports_, [this](double fraction) {
                                         return report(kBuildShare + (0.95 - kBuildShare) * fraction,
                                                       "solving the fine reference");
                                       }};
    return dependsOnItsWay() ? solveAlongLoadPath(problem, std::move(fineReference))
                             : solveDirectly(problem, leftOver, std::move(fineReference));
  }

  // Friction and plastic flow are path-dependent.
  [[nodiscard]] bool dependsOnItsWay() const {
    return body_.quasiStatic &&
           (target_.constitution.plastic() || target_.world.box.enabled || !target_.obstacles.empty());
  }

  [[nodiscard]] Compared compareAt(std::span<const Vec3> points, std::span<const Vec3> normals,
                                   std::vector<double> weights, const RestState &rest,
                                   const FineReferenceState &solved) const {
    Compared out{std::move(weights),
                 {points.begin(), points.end()},
                 placesOf(body_.rest(), body_.state().displacements, points, normals, parallelFor_),
                 placesOf(rest, solved.displacements, points, normals, parallelFor_),
                 errorOverDifference(refinement_)};
    // Points moved by a support are at their prescribed positions; skin and lattice inside it are only drawn.
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto leads = [&](const Fix &fix) { return contains(fix.region, points[i]); };
      const std::vector<Fix> &fixes = body_.rest().conditions.fixes;
      if (std::none_of(fixes.begin(), fixes.end(), leads)) continue;
      out.fine[i] = out.coarse[i];
      if (!out.weights.empty()) out.weights[i] = 0.0;
    }
    return out;
  }

  [[nodiscard]] Verification compare(const RestState &rest, FineReferenceState &solved) {
    const RestState &own = body_.rest();
    std::vector<Vec3> inside(own.pointCentres);
    for (Vec3 &x : inside) x += own.origin;
    const Compared volume = compareAt(inside, {}, own.stencils.volumes, rest, solved);
    const SurfacePoints sampled = sampleSurface(shape_.surface, kSkinSampling * own.spacing, EverywhereRegion{});
    const Compared skin =
        sampled.count() > 0 ? compareAt(sampled.positions, sampled.normals, sampled.areas, rest, solved) : volume;
    const bool hasNormals = own.surfelNormals.size() == shape_.surface.positions.size();
    const std::vector<double> none;
    const Compared surfels =
        compareAt(shape_.surface.positions,
                  hasNormals ? std::span<const Vec3>(own.surfelNormals) : std::span<const Vec3>(), none, rest, solved);
    Verification out;
    out.spacing = own.spacing;
    out.fineReferenceSpacing = rest.spacing;
    out.phyxels = own.phyxelCount();
    out.fineReferencePhyxels = rest.phyxelCount();
    out.errorRms = weightedRms(volume.errors(), volume.weights);
    const std::vector<double> errors = skin.errors();
    out.error95 = weightedQuantile(errors, skin.weights, kQuantile);
    const auto worst = std::max_element(errors.begin(), errors.end());
    if (worst != errors.end()) {
      out.errorMax = *worst;
      out.worst = skin.coarse[static_cast<std::size_t>(worst - errors.begin())];
    }
    out.largestDisplacement = largestDisplacement(skin);
    out.skinErrors = surfels.errors();
    const ElasticEnergy energy = body_.elasticEnergy(parallelFor_);
    out.elasticEnergy = energy.strain + energy.stabilisation;
    out.fineReferenceElasticEnergy = solved.elasticEnergy;
    out.reactions = body_.reactions(target_.world.gravity);
    out.fineReferenceReactions = std::move(solved.reactions);
    out.limits = limits(solved);
    return out;
  }

  [[nodiscard]] double largestDisplacement(const Compared &at) const {
    const bool isHeld = body_.held() || body_.foundation().settings().holds();
    const RigidFit fit = isHeld ? RigidFit() : rigidFit(at.reference, at.fine, at.weights);
    double largest = 0.0, reach = 0.0;
    for (std::size_t i = 0; i < at.reference.size(); ++i) {
      largest = std::max(largest, (at.fine[i] - fit(at.reference[i])).norm());
      reach = std::max({reach, at.reference[i].norm(), at.fine[i].norm()});
    }
    return largest > std::max(kStrainFloor * (shape_.max - shape_.min).norm(), kRounding * reach) ? largest : 0.0;
  }

  [[nodiscard]] std::vector<std::string> limits(const FineReferenceState &solved) const {
    std::vector<std::string> out;
    if (refinement_ < settings_.refinement)
      out.emplace_back("its fine reference is only " + number(refinement_) + " times finer, to stay below " +
                       std::to_string(settings_.maxPhyxels) + " phyxels: less certain");
    if (!body_.rest().conditions.held.empty() && !hasFineSupports_)
      out.emplace_back(
          "the edges of supports are no finer than the rest of the fine reference: near them the error may be up "
          "to twice as large");
    if (!body_.quasiStatic)
      out.emplace_back(
          "the error is that of the present static equilibrium; errors of time and phase that accumulated during the "
          "motion are not included");
    if (!body_.quasiStatic && target_.constitution.plastic()) out.emplace_back("plastic strain is taken as it is");
    if (target_.constitution.relaxing()) out.emplace_back("relaxing stress is taken as it is");
    if (solved.isHeldByContact)
      out.emplace_back("only contact holds it: where it touches something it is taken to stay where it is");
    else if (!dependsOnItsWay() &&
             std::any_of(body_.contact.active.begin(), body_.contact.active.end(),
                         [](const Contact &c) { return c.normalImpulse > 0.0 || c.normalForce > 0.0; }))
      out.emplace_back("forces of contact are taken as they are");
    return out;
  }

  const VerificationTarget &target_;
  const BodyShape &shape_;
  const ParallelFor &parallelFor_;
  const VerifyProgress &progress_;
  const StopRequest *stop_;
  const VerifySettings &settings_;
  double refinement_;
  Body body_;
  bool hasFineSupports_ = false;
};

}  // namespace

VerificationTarget verificationTarget(const Simulator &simulator, std::size_t id) {
  const Body &body = *simulator.body(id);
  const std::span<const Obstacle> obstacles = simulator.world().obstaclesOf(id);
  WorldSettings world = simulator.world().settings();
  world.box = simulator.world().boxOf(id);
  return {body.name(),
          body.checkpoint(),
          body.constitution(),
          body.foundation().settings(),
          {body.externalForces().begin(), body.externalForces().end()},
          world,
          {obstacles.begin(), obstacles.end()},
          simulator.quasiStatic() ? simulator.loadFactor() : simulator.time()};
}

Result<Verification> verify(const VerificationTarget &target, const BodyShape &shape, const BodyRecipe &recipe,
                            const ParallelFor &parallelFor, const VerifyProgress &progress, const StopRequest *stop,
                            const VerifySettings &settings) {
  if (auto good = verifiable(target); !good) return refused(good.error());
  StoppableLoops loops(parallelFor);
  try {
    const StoppableLoops::Watch watch(loops, stop);
    return Verifying(target, shape, loops.parallelFor(), progress, stop, settings).run(recipe);
  } catch (const Stopped &) {
    return refused("cancelled");
  }
}

}  // namespace pointbased
