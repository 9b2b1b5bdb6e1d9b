// SPDX-License-Identifier: Apache-2.0
#include "pointbased/equilibrium_sensitivity.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/expects.h"
#include "base/number_text.h"
#include "forces/vector_forces.h"
#include "sensitivity/equilibrium_tangent.h"

namespace pointbased {
namespace {

using detail::dot;

constexpr double kModulusStep = 1e-4;  // relative, of central differences of forces that are nearly linear in E

// Parts of the materials around a phyxel, by volume.
void addShares(const RestState &rest, Index phyxel, double weight, std::span<double> shares) {
  const StencilSet &s = rest.stencils;
  if (!rest.materialShares.empty()) {
    for (std::size_t m = 0; m < shares.size(); ++m)
      shares[m] += weight * rest.materialShares[phyxel * shares.size() + m];
    return;
  }
  double volume = 0.0;
  if (!s.materials.empty())
    for (const Index entry : s.entriesOfPhyxel.row(phyxel)) volume += s.volumes[s.pointOfEntry(entry)];
  if (!(volume > 0.0)) {
    shares[0] += weight;
    return;
  }
  for (const Index entry : s.entriesOfPhyxel.row(phyxel)) {
    const Index q = s.pointOfEntry(entry);
    shares[s.materials[q]] += weight * s.volumes[q] / volume;
  }
}

Vec3 meanOf(const Csr &rows, std::span<const double> weights, std::size_t row, std::span<const Vec3> field) {
  Vec3 mean = Vec3::Zero();
  for (Index e = rows.offsets[row]; e < rows.offsets[row + 1]; ++e) mean += weights[e] * field[rows.indices[e]];
  return mean;
}

// Sensitivities to prescribed motions; `rest` is dJ/du - K λ.
class SupportSensitivities {
 public:
  SupportSensitivities(Body &body, double loadFactor, std::span<const Vec3> adjoint, std::span<const Vec3> rest)
      : body_(body), adjoint_(adjoint), rest_(rest) {
    const BoundaryConditions &conditions = body.rest().conditions;
    const Vec3 &origin = body.rest().origin;
    for (std::size_t f = 0; f < conditions.fixes.size(); ++f) {
      const Fix &fix = conditions.fixes[f];
      const RigidMotion motion = motionAt(fix, conditions.held[f], origin, body.factor(fix.ramp, loadFactor));
      out_.push_back({Vec3::Zero(), Vec3::Zero(), origin + motion.centre + motion.displacement});
    }
    for (const LiveSupport &live : body.liveSupports())
      out_.push_back(
          {Vec3::Zero(), Vec3::Zero(),
           origin + live.part.centroid + live.displacementAt(live.progressAt(loadFactor, body.quasiStatic))});
    targets_ = body.patchTargets(loadFactor);
  }

  std::vector<EquilibriumSensitivity::Support> compute() {
    const BoundaryConditions &conditions = body_.rest().conditions;
    const std::span<const std::uint8_t> mask = body_.heldMask();
    std::vector<std::uint8_t> isDone(mask.size(), 0);  // the first fix that holds a phyxel moves it
    std::size_t patch = 0;
    for (std::size_t f = 0; f < conditions.held.size(); ++f) {
      for (const Index i : conditions.held[f].phyxels) {
        if (isDone[i] != 0) continue;
        isDone[i] = 1;
        add(f, body_.rest().positions[i] + body_.state().displacements[i], rest_[i]);
      }
      addPatches(f, conditions.held[f].rows.rows(), patch);
    }
    for (std::size_t k = 0; k < body_.liveSupports().size(); ++k)
      addPatches(conditions.held.size() + k, body_.liveSupports()[k].part.rows.rows(), patch);
    return std::move(out_);
  }

 private:
  void add(std::size_t support, const Vec3 &x, const Vec3 &derivative) {
    EquilibriumSensitivity::Support &one = out_[support];
    one.displacement += derivative;
    one.rotation += (body_.rest().origin + x - one.centre).cross(derivative);
  }
  void addPatches(std::size_t support, std::size_t count, std::size_t &patch) {
    const PatchSolver &patches = body_.patches();
    for (std::size_t k = 0; k < count; ++k, ++patch) {
      const Vec3 X = meanOf(patches.phyxels(), patches.weights(), patch, body_.rest().positions);
      add(support, X + targets_[patch],
          patches.stiffness()[patch] * meanOf(patches.phyxels(), patches.weights(), patch, adjoint_));
    }
  }

  Body &body_;
  std::span<const Vec3> adjoint_, rest_, targets_;
  std::vector<EquilibriumSensitivity::Support> out_;
};

// Internal forces at the displacements of a body with other moduli. Only the kernels know the layers of cells that
// contain two materials; they exist where Body::vectorisedTangent() says so.
void internalForcesWith(const Constitution &constitution, const Body &body, std::span<const Mat3> gradients,
                        std::span<Vec3> forces, const ParallelFor &parallelFor) {
  const RestState &rest = body.rest();
  PointHistory none;
  if (body.vectorisedTangent()) {
    const auto kernels = detail::vectorForces(rest.stencils, rest.positions, body.masses(), constitution,
                                              Precision::doublePrecision, parallelFor);
    (void)kernels->evaluate(body.state().displacements, {}, {none, 0.0}, forces, parallelFor);
    return;
  }
  std::vector<Mat3> stresses(rest.pointCount());
  std::vector<double> ratios(rest.pointCount());
  std::vector<Vec3> entries(rest.stencils.phyxels.indices.size());
  (void)pointStresses(constitution, rest.stencils, gradients, {}, none, 0.0, nullptr, stresses, ratios, parallelFor);
  internalForces(constitution, rest.stencils, rest.positions, body.state().displacements, gradients, stresses, entries,
                 forces, parallelFor);
}

// -λ · d(internal forces)/dE of one material at constant u.
double elasticTerm(const Body &body, std::size_t material, std::span<const Mat3> gradients,
                   std::span<const Vec3> adjoint, const ParallelFor &parallelFor) {
  std::vector<Vec3> forces(adjoint.size());
  const double modulus = body.constitution().materials[material].youngsModulus, step = kModulusStep * modulus;
  double difference = 0.0;
  for (const double sign : {1.0, -1.0}) {
    Constitution changed = body.constitution();
    changed.materials[material].youngsModulus = modulus + sign * step;
    internalForcesWith(changed, body, gradients, forces, parallelFor);
    difference += sign * dot(adjoint, forces);
  }
  return difference / (2.0 * step);
}

// The part of dJ/dE that results from the stiffness of held patches, a mean of the moduli around them.
// `moved`: [patches] displacement of their targets with the adjoint field, or empty.
void addPatchTerms(const Body &body, std::span<const Vec3> adjoint, std::span<const Vec3> moved,
                   std::span<double> out) {
  const std::vector<Material> &materials = body.constitution().materials;
  const PatchSolver &patches = body.patches();
  const Csr &rows = patches.phyxels();
  std::vector<double> shares(materials.size());
  for (std::size_t p = 0; p < patches.rows(); ++p) {
    std::fill(shares.begin(), shares.end(), 0.0);
    for (Index e = rows.offsets[p]; e < rows.offsets[p + 1]; ++e)
      addShares(body.rest(), rows.indices[e], std::abs(patches.weights()[e]), shares);
    double modulus = 0.0;
    for (std::size_t m = 0; m < shares.size(); ++m) modulus += shares[m] * materials[m].youngsModulus;
    const Vec3 target = moved.empty() ? Vec3(Vec3::Zero()) : moved[p];
    const double work = patches.forces()[p].dot(meanOf(rows, patches.weights(), p, adjoint) - target);
    for (std::size_t m = 0; m < shares.size(); ++m) out[m] += work * shares[m] / modulus;
  }
}

std::vector<double> modulusSensitivities(const Body &body, std::span<const Vec3> adjoint, std::span<const Vec3> moved,
                                         const ParallelFor &parallelFor) {
  const std::vector<Material> &materials = body.constitution().materials;
  std::vector<Mat3> gradients(body.rest().pointCount());
  deformationGradients(body.rest().stencils, body.state().displacements, gradients, parallelFor);
  std::vector<double> out(materials.size(), 0.0);
  for (std::size_t m = 0; m < out.size(); ++m)
    if (materials[m].law != MaterialLaw::custom) out[m] = elasticTerm(body, m, gradients, adjoint, parallelFor);
  addPatchTerms(body, adjoint, moved, out);
  for (std::size_t m = 0; m < out.size(); ++m)
    if (materials[m].law == MaterialLaw::custom) out[m] = std::numeric_limits<double>::quiet_NaN();
  return out;
}

// What moves with a fix: phyxels that it holds first, and its patches.
struct MovedPart {
  std::vector<Index> phyxels;
  std::size_t firstPatch = 0, patches = 0;
};

MovedPart movedBy(const Body &body, std::size_t fix) {
  const BoundaryConditions &conditions = body.rest().conditions;
  std::vector<std::uint8_t> isDone(body.rest().phyxelCount(), 0);
  MovedPart out;
  for (std::size_t f = 0; f <= fix; ++f) {
    for (const Index i : conditions.held[f].phyxels) {
      if (f == fix && isDone[i] == 0) out.phyxels.push_back(i);
      isDone[i] = 1;
    }
    if (f < fix) out.firstPatch += conditions.held[f].rows.rows();
  }
  out.patches = conditions.held[fix].rows.rows();
  return out;
}

// -λ · dr/dk of one of the two stiffnesses of the foundation.
double foundationTerm(const Body &body, const Foundation &unit, std::span<const Vec3> adjoint,
                      const ParallelFor &parallelFor) {
  ElasticFoundation foundation = body.foundation();
  if (!foundation.acts()) return 0.0;
  foundation.set(unit);
  std::vector<Vec3> forces(adjoint.size(), Vec3::Zero());
  foundation.addForces(body.state().displacements, {}, forces, parallelFor);
  return dot(adjoint, forces);
}

}  // namespace

EquilibriumSensitivitySolver::EquilibriumSensitivitySolver()
    : tangent_(std::make_unique<detail::EquilibriumTangent>()) {}
EquilibriumSensitivitySolver::~EquilibriumSensitivitySolver() = default;
EquilibriumSensitivitySolver::EquilibriumSensitivitySolver(EquilibriumSensitivitySolver &&) noexcept = default;
EquilibriumSensitivitySolver &EquilibriumSensitivitySolver::operator=(EquilibriumSensitivitySolver &&) noexcept =
    default;
void EquilibriumSensitivitySolver::forget() { tangent_->forget(); }

Result<void> EquilibriumSensitivitySolver::linearise(Body &body, const Environment &environment, double loadFactor,
                                                     const SensitivitySettings &settings) {
  if (auto done = tangent_->linearise(body, environment, loadFactor); !done) return done;
  if (tangent_->residual() <= settings.largestResidual) return {};
  return tl::unexpected("body '" + body.name() + "' is not in equilibrium at load factor " +
                        detail::number(loadFactor) + ": its residual is " + detail::number(tangent_->residual(), 3) +
                        " of the internal forces, at most " + detail::number(settings.largestResidual, 3) +
                        " is accepted; solve it with a smaller tolerance");
}

Result<EquilibriumSensitivity> EquilibriumSensitivitySolver::solve(Body &body, const Environment &environment,
                                                                   double loadFactor, std::span<const Vec3> objective,
                                                                   const SensitivitySettings &settings) {
  const std::size_t n = body.rest().phyxelCount();
  POINTBASED_EXPECTS(objective.size() == n, "a derivative of the objective per phyxel");
  for (std::size_t i = 0; i < n; ++i)
    if (!objective[i].allFinite())
      return tl::unexpected("the derivative of the objective is not finite at phyxel " + std::to_string(i));
  if (auto done = linearise(body, environment, loadFactor, settings); !done) return tl::unexpected(done.error());
  EquilibriumSensitivity out;
  out.residual = tangent_->residual();
  out.forces.resize(n);
  if (auto done = tangent_->solve(objective, out.forces, settings.tolerance, settings.maxIterations); !done)
    return tl::unexpected(done.error());
  out.iterations = tangent_->iterations();
  std::vector<Vec3> rest(n);
  tangent_->product(out.forces, rest);
  for (std::size_t i = 0; i < n; ++i) rest[i] = objective[i] - rest[i];
  out.supports = SupportSensitivities(body, loadFactor, out.forces, rest).compute();
  const ParallelFor &parallelFor = *environment.parallelFor;
  out.foundationStiffness = foundationTerm(body, {1.0, 0.0, 0.0}, out.forces, parallelFor);
  out.foundationTangential = foundationTerm(body, {0.0, 1.0, 0.0}, out.forces, parallelFor);
  if (settings.includeYoungsModuli) out.youngsModuli = modulusSensitivities(body, out.forces, {}, parallelFor);
  return out;
}

Result<ReactionSensitivity> EquilibriumSensitivitySolver::solveReaction(Body &body, const Environment &environment,
                                                                        double loadFactor, std::size_t fix,
                                                                        const Vec3 &direction,
                                                                        const SensitivitySettings &settings) {
  POINTBASED_EXPECTS(fix < body.rest().conditions.fixes.size(), "a support of the body");
  POINTBASED_EXPECTS(std::abs(direction.norm() - 1.0) < 1e-6, "a unit direction");
  const std::size_t n = body.rest().phyxelCount();
  if (auto done = linearise(body, environment, loadFactor, settings); !done) return tl::unexpected(done.error());
  const MovedPart part = movedBy(body, fix);
  const PatchSolver &patches = body.patches();
  const Csr &rows = patches.phyxels();
  std::vector<Vec3> rate(n, Vec3::Zero()), pull(n, Vec3::Zero()), product(n), right(n), free(n);
  std::vector<Vec3> moved(patches.rows(), Vec3::Zero());
  for (const Index i : part.phyxels) rate[i] = direction;
  for (std::size_t p = part.firstPatch; p < part.firstPatch + part.patches; ++p) {
    moved[p] = direction;
    for (Index e = rows.offsets[p]; e < rows.offsets[p + 1]; ++e)
      pull[rows.indices[e]] += patches.stiffness()[p] * patches.weights()[e] * direction;
  }
  tangent_->product(rate, product);
  for (std::size_t i = 0; i < n; ++i) right[i] = pull[i] - product[i];
  if (auto done = tangent_->solve(right, free, settings.tolerance, settings.maxIterations); !done)
    return tl::unexpected(done.error());
  for (std::size_t i = 0; i < n; ++i) rate[i] += free[i];
  tangent_->product(rate, product);
  ReactionSensitivity out;
  out.reaction = direction.dot(body.reactions(Vec3::Zero())[fix].force);
  for (const Index i : part.phyxels) out.stiffness += direction.dot(product[i] - pull[i]);
  for (std::size_t p = part.firstPatch; p < part.firstPatch + part.patches; ++p)
    out.stiffness += patches.stiffness()[p] * direction.dot(direction - meanOf(rows, patches.weights(), p, rate));
  if (!settings.includeYoungsModuli) return out;
  out.youngsModuli = modulusSensitivities(body, rate, moved, *environment.parallelFor);
  for (double &one : out.youngsModuli) one = -one;
  return out;
}

}  // namespace pointbased
