// SPDX-License-Identifier: Apache-2.0
#include "sensitivity/curve_model.h"

#include <algorithm>
#include <cmath>

#include "base/number_text.h"

namespace pointbased::detail {
namespace {

constexpr std::size_t kMostExact = 12;  // different points that are solved themselves
constexpr std::size_t kChebyshev = 10;  // intervals between nodes of more points
// Of static solutions: of the first displacement, within parts of the spacing.
constexpr double kToleranceOfFirst = 1e-4, kTolerance = 1e-6, kLeastTolerance = 1e-8;

// Weights of the polynomial through the nodes at x: barycentric formula (Berrut and Trefethen, SIAM Review 46, 2004).
Eigen::RowVectorXd weightsAt(double x, const std::vector<double> &nodes) {
  const std::size_t n = nodes.size();
  Eigen::RowVectorXd out = Eigen::RowVectorXd::Zero(static_cast<Eigen::Index>(n));
  for (std::size_t k = 0; k < n; ++k)
    if (std::abs(x - nodes[k]) < 1e-12) {
      out[static_cast<Eigen::Index>(k)] = 1.0;
      return out;
    }
  for (std::size_t k = 0; k < n; ++k) {
    const double end = k == 0 || k + 1 == n ? 0.5 : 1.0;
    out[static_cast<Eigen::Index>(k)] = (k % 2 == 0 ? end : -end) / (x - nodes[k]);
  }
  return out / out.sum();
}

struct Prescribed {
  std::vector<std::size_t> fixes, loads;
};

Result<Prescribed> prescribedBy(const BoundaryConditions &conditions) {
  Prescribed out;
  for (std::size_t f = 0; f < conditions.fixes.size(); ++f) {
    const Fix &fix = conditions.fixes[f];
    if (fix.rotationVector || !fix.rotation_deg.isZero(0.0))
      return tl::unexpected("support " + std::to_string(f) + " rotates; accepted: a displacement only");
    if (fix.prescribesMotion()) out.fixes.push_back(f);
  }
  for (std::size_t l = 0; l < conditions.loads.size(); ++l) {
    if (conditions.loads[l].pressure != 0.0)
      return tl::unexpected("load " + std::to_string(l) + " is a pressure; accepted: a force");
    if (!conditions.loads[l].force.isZero(0.0)) out.loads.push_back(l);
  }
  if (out.fixes.size() + out.loads.size() == 1) return out;
  return tl::unexpected(std::to_string(out.fixes.size()) + " supports move and " + std::to_string(out.loads.size()) +
                        " forces act; accepted: either one support that moves, or one force");
}

}  // namespace

Result<void> CurveModel::prescribe(const StiffnessModel &model, RestState &rest, double largest) {
  const auto found = prescribedBy(rest.conditions);
  if (!found) return tl::unexpected(found.error());
  if (!found->fixes.empty()) {
    Fix &fix = rest.conditions.fixes[fix_ = found->fixes.front()];
    direction_ = fix.displacement.normalized();
    fix.displacement = largest * direction_;
    return {};
  }
  Load &load = rest.conditions.loads[found->loads.front()];
  direction_ = load.force.normalized();
  load.force = largest * direction_;
  if (!model.watchedPoint || !model.watchedPoint->allFinite())
    return tl::unexpected(
        std::string("a force is prescribed, so the material point whose displacement was measured is needed"));
  return {};
}

void CurveModel::placeNodes(std::span<const double> prescribed, double largest) {
  std::vector<double> different;
  for (const double one : prescribed) different.push_back(one / largest);
  const std::vector<double> at = different;
  std::sort(different.begin(), different.end());
  different.erase(std::unique(different.begin(), different.end()), different.end());
  if (different.front() > 0.0) different.insert(different.begin(), 0.0);
  const bool isExact = different.size() <= kMostExact + 1;
  nodes_ = std::move(different);
  if (!isExact) {
    nodes_.clear();
    for (std::size_t k = 0; k <= kChebyshev; ++k)
      nodes_.push_back(0.5 - 0.5 * std::cos(3.14159265358979323846 * static_cast<double>(k) / kChebyshev));
  }
  interpolation_.setZero(static_cast<Eigen::Index>(at.size()), static_cast<Eigen::Index>(nodes_.size()));
  for (std::size_t i = 0; i < at.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    if (isExact)
      interpolation_(row, std::lower_bound(nodes_.begin(), nodes_.end(), at[i]) - nodes_.begin()) = 1.0;
    else
      interpolation_.row(row) = weightsAt(at[i], nodes_);
  }
  displacements_.resize(nodes_.size());
}

Result<CurveModel> CurveModel::create(const StiffnessModel &model, std::span<const CurvePoint> curve,
                                      const ParallelFor &parallelFor, const StopRequest *stop) {
  CurveModel out;
  out.parallelFor_ = parallelFor;
  out.stop_ = stop;
  out.gravity_ = model.gravity;
  const auto rest = std::make_shared<RestState>(*model.rest);
  const auto control = curveControl(*rest);
  if (!control) return tl::unexpected(control.error());
  out.control_ = *control;
  std::vector<double> prescribed;
  for (const CurvePoint &point : curve)
    prescribed.push_back(out.control_ == CurveControl::support ? point.displacement : point.force);
  const double largest = *std::max_element(prescribed.begin(), prescribed.end());
  if (auto done = out.prescribe(model, *rest, largest); !done) return tl::unexpected(done.error());
  out.placeNodes(prescribed, largest);
  out.body_ = std::make_unique<Body>("fit", rest, model.constitution, parallelFor);
  if (auto set = out.body_->setFoundation(model.foundation); !set) return tl::unexpected(set.error());
  out.body_->quasiStatic = true;
  for (const Material &material : model.constitution.materials) {
    if (material.law == MaterialLaw::custom)
      return tl::unexpected(
          std::string("a material has a law of a plugin, whose stiffness is its own parameter and not fitted"));
    out.moduli_.push_back(material.youngsModulus);
  }
  if (out.control_ == CurveControl::load) {
    out.watched_ = rest->bind(std::vector{Vec3(*model.watchedPoint - rest->origin)}, {});
    out.objective_.assign(rest->phyxelCount(), Vec3::Zero());
    spreadForces(out.watched_, std::vector{out.direction_}, out.objective_);
  }
  return out;
}

// Gravity acts in full at every load factor.
Environment CurveModel::environment() {
  Environment out;
  out.gravity = gravity_;
  out.parallelFor = &parallelFor_;
  out.clock = &clock_;
  out.stop = stop_;
  // Displacements that are small against the spacing need a smaller tolerance than the default.
  if (control_ == CurveControl::support && nodes_.size() > 1) {
    const double spacing = body_->rest().spacing;
    const double first = nodes_[1] * body_->rest().conditions.fixes[fix_].displacement.norm();
    out.tolerance = std::clamp(kToleranceOfFirst * first, kLeastTolerance * spacing, kTolerance * spacing);
  }
  return out;
}

Result<void> CurveModel::solveNode(std::size_t node, Eigen::Ref<Eigen::VectorXd> out) {
  const double at = nodes_[node];
  const Environment environment = this->environment();
  Body &body = *body_;
  std::vector<Vec3> &start = displacements_[node];
  if (!start.empty())
    body.state().displacements = start;
  else if (node == 0)
    body.reset();  // the others continue from the node before
  body.invalidatePointValues();
  const double from = start.empty() && node > 0 ? nodes_[node - 1] : at;
  if (const std::string why = quasiStaticStep(body, *newton_, environment, from, at).failure; !why.empty())
    return tl::unexpected("no equilibrium with a Young's modulus of " + number(body.material().youngsModulus, 4) +
                          " Pa: " + why);
  start = body.state().displacements;
  ++solutions_;
  std::vector<double> derivatives;
  if (control_ == CurveControl::support) {
    auto found = sensitivities_.solveReaction(body, environment, at, fix_, direction_);
    if (!found) return tl::unexpected(found.error());
    out[0] = found->reaction;
    derivatives = std::move(found->youngsModuli);
  } else {
    std::vector<Vec3> u(1);
    interpolateDisplacements(watched_, body.rest().positions, body.state().displacements, u, parallelFor_);
    auto found = sensitivities_.solve(body, environment, at, objective_);
    if (!found) return tl::unexpected(found.error());
    out[0] = direction_.dot(u[0]);
    derivatives = std::move(found->youngsModuli);
  }
  for (std::size_t m = 0; m < derivatives.size(); ++m)
    out[static_cast<Eigen::Index>(1 + m)] = derivatives[m] * body.constitution().materials[m].youngsModulus;
  return {};
}

Result<CurvePrediction> CurveModel::predict(std::span<const double> logFactors,
                                            const std::function<bool(double)> &wasSolved) {
  Constitution constitution = body_->constitution();
  for (std::size_t m = 0; m < moduli_.size(); ++m)
    constitution.materials[m].youngsModulus = moduli_[m] * std::exp(logFactors[m]);
  body_->setConstitution(std::move(constitution), parallelFor_);
  newton_->forget();
  sensitivities_.forget();
  const auto columns = static_cast<Eigen::Index>(1 + moduli_.size());
  Eigen::MatrixXd atNodes = Eigen::MatrixXd::Zero(columns, static_cast<Eigen::Index>(nodes_.size()));
  for (std::size_t k = hasGravity() ? 0 : 1; k < nodes_.size(); ++k) {
    if (auto done = solveNode(k, atNodes.col(static_cast<Eigen::Index>(k))); !done) {
      displacements_.assign(nodes_.size(), {});
      body_->reset();
      return tl::unexpected(done.error());
    }
    if (!wasSolved(static_cast<double>(k + 1) / static_cast<double>(nodes_.size())))
      return tl::unexpected(std::string("cancelled"));
  }
  if (hasGravity()) atNodes.colwise() -= Eigen::VectorXd(atNodes.col(0));
  const Eigen::MatrixXd atPoints = interpolation_ * atNodes.transpose();
  return CurvePrediction{atPoints.col(0), atPoints.rightCols(columns - 1)};
}

}  // namespace pointbased::detail

namespace pointbased {

Result<CurveControl> curveControl(const RestState &rest) {
  const auto found = detail::prescribedBy(rest.conditions);
  if (!found) return tl::unexpected(found.error());
  return found->fixes.empty() ? CurveControl::load : CurveControl::support;
}

}  // namespace pointbased
