// SPDX-License-Identifier: Apache-2.0
#include "pointbased/stiffness_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "base/number_text.h"
#include "sensitivity/curve_model.h"
#include "sensitivity/fit_statistics.h"

namespace pointbased {
namespace {

using detail::CurveModel;
using detail::CurvePrediction;
using detail::number;

constexpr std::size_t kFewestPoints = 4;
constexpr double kLargestStep = 2.3;     // of log E, per iteration
constexpr double kLargestScaling = 7.0;  // of log E, by the first estimate
constexpr double kSmallStep = 1e-6;      // of log E, which ends the iteration
constexpr int kHalvings = 6;             // of a step that does not reduce the residuals
constexpr int kStarts = 3;               // with gravity: the modulus of the scene, ten and a hundred times as much
constexpr int kStiffer = 4;              // factors of ten by which a body without equilibrium at first is stiffened
constexpr double kDetermined = 0.693;    // log 2: half the width of an interval that determines a modulus
constexpr double kSystematic = 5e-3;     // of the measured values: residuals that follow each other but do not matter
constexpr double kUnlikeModel = 0.1;     // of the measured values: residuals that no instrument has
constexpr double kNoEffect = 1e-6;       // of the largest derivative: a material that the curve does not depend on

std::string problemOf(std::span<const CurvePoint> curve, CurveControl control, const StiffnessFitSettings &settings) {
  const bool isSupport = control == CurveControl::support;
  if (!(settings.noise >= 0.0) || !std::isfinite(settings.noise))
    return "noise " + number(settings.noise) + ", must be finite and >= 0";
  if (settings.maxIterations < 1) return "iterations " + std::to_string(settings.maxIterations) + ", must be >= 1";
  std::size_t different = 0;
  double before = 0.0, measured = 0.0;
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const double at = isSupport ? curve[i].displacement : curve[i].force;
    if (!(at >= 0.0))
      return std::string("point ") + std::to_string(i + 1) + ": " + (isSupport ? "displacement " : "force ") +
             number(at, 6) + (isSupport ? " m" : " N") + ", must be >= 0, in the direction that the scene prescribes";
    if (at < before)
      return std::string("point ") + std::to_string(i + 1) + ": the " + (isSupport ? "displacement" : "force") +
             " decreases from " + number(before, 6) + " to " + number(at, 6) +
             "; accepted: the loading part of the curve, in its order";
    if (at > before) ++different;
    before = at;
    measured = std::max(measured, std::abs(isSupport ? curve[i].force : curve[i].displacement));
  }
  if (different < kFewestPoints)
    return std::to_string(different) + (isSupport ? " different displacements" : " different forces") +
           " above 0; accepted: " + std::to_string(kFewestPoints) + " or more";
  if (measured == 0.0) return std::string("every ") + (isSupport ? "force" : "displacement") + " is 0";
  return {};
}

std::string notFiniteIn(std::span<const CurvePoint> curve) {
  for (std::size_t i = 0; i < curve.size(); ++i)
    if (!std::isfinite(curve[i].displacement) || !std::isfinite(curve[i].force))
      return "point " + std::to_string(i + 1) + " is not finite";
  return {};
}

/// Materials with a common factor, by number of the group; kNone: not fitted.
using Groups = std::vector<Eigen::Index>;
constexpr Eigen::Index kNone = -1;

Eigen::Index countOf(const Groups &groups) { return 1 + *std::max_element(groups.begin(), groups.end()); }

class Fit {
 public:
  Fit(CurveModel &model, std::span<const CurvePoint> curve, const StiffnessFitSettings &settings)
      : model_(model), settings_(settings), logFactors_(model.materials(), 0.0) {
    const auto n = static_cast<Eigen::Index>(curve.size());
    measured_.resize(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const CurvePoint &point = curve[static_cast<std::size_t>(i)];
      const bool isSupport = model.control() == CurveControl::support;
      measured_[i] = isSupport ? point.force : point.displacement;
    }
    out_.control = model.control();
  }

  Result<StiffnessFit> run() {
    groups_.assign(model_.materials(), 0);
    if (auto done = scale(); !done) return tl::unexpected(done.error());
    if (auto done = iterate(); !done) return tl::unexpected(done.error());
    if (settings_.fitsEachOne && model_.materials() > 1)
      if (auto done = separate(); !done) return tl::unexpected(done.error());
    return finish();
  }

 private:
  Result<CurvePrediction> predict(const std::vector<double> &logFactors) {
    return model_.predict(logFactors, [this](double part) {
      if (!settings_.progress) return true;
      const double done = static_cast<double>(out_.iterations) + part;
      return settings_.progress(done / (done + 3.0));  // the number of iterations is not known
    });
  }
  [[nodiscard]] double squares(const CurvePrediction &at) const { return (measured_ - at.values).squaredNorm(); }

  // The first estimate: a reaction is about proportional to the modulus, a displacement to its reciprocal. Gravity can
  // deform a body that is too soft so much that there are other minima: the best of several starts is used.
  Result<void> scale() {
    const bool isSupport = model_.control() == CurveControl::support;
    const std::vector<double> begin = logFactors_;
    double least = std::numeric_limits<double>::infinity();
    bool isAgainst = false;
    std::string why;
    const auto keep = [&](Result<CurvePrediction> found, const std::vector<double> &at) {
      if (!found) {
        why = found.error();
      } else if (const double now = squares(*found); now < least) {
        least = now;
        now_ = std::move(*found);
        logFactors_ = at;
      }
    };
    for (int k = 0; k <= kStiffer && why != "cancelled"; ++k) {
      std::vector<double> at = begin;
      for (double &one : at) one += k * std::log(10.0);
      auto first = predict(at);
      double both = 0.0, own = 1.0;
      if (first) both = measured_.dot(first->values), own = first->values.squaredNorm();
      isAgainst = isAgainst || (first && !(both > 0.0));
      if (!first || both > 0.0) keep(std::move(first), at);
      if (both > 0.0) {
        const double shift = std::log(isSupport ? both / own : own / both);
        for (double &one : at) one += std::clamp(shift, -kLargestScaling, kLargestScaling);
        keep(predict(at), at);
      }
      if (!model_.hasGravity() && (isSupport || isAgainst || std::isfinite(least))) break;
      if (k + 1 >= kStarts && std::isfinite(least)) break;
    }
    if (why == "cancelled") return tl::unexpected(std::move(why));
    if (std::isfinite(least)) return {};
    if (!isAgainst) return tl::unexpected(std::move(why));
    return tl::unexpected(
        std::string(isSupport ? "the measured forces act against the displacement that the scene prescribes"
                              : "the measured displacements are opposite to those that the force of the scene causes") +
        "; both must be positive in its direction");
  }

  [[nodiscard]] Eigen::MatrixXd jacobian() const {
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(measured_.size(), countOf(groups_));
    for (std::size_t m = 0; m < groups_.size(); ++m)
      if (groups_[m] != kNone) out.col(groups_[m]) += now_.derivatives.col(static_cast<Eigen::Index>(m));
    return out;
  }

  Result<void> iterate() {
    out_.hasConverged = false;
    for (int k = 0; k < settings_.maxIterations && !out_.hasConverged; ++k) {
      Eigen::VectorXd step = jacobian().colPivHouseholderQr().solve(measured_ - now_.values);
      if (!step.allFinite()) return tl::unexpected(std::string("the derivatives of the curve are not finite"));
      const double size = step.cwiseAbs().maxCoeff();
      if (size > kLargestStep) step *= kLargestStep / size;
      out_.hasConverged = size <= kSmallStep;
      if (out_.hasConverged) break;
      ++out_.iterations;
      bool isBetter = false;
      for (int h = 0; h <= kHalvings && !isBetter; ++h, step *= 0.5) {
        std::vector<double> next = logFactors_;
        for (std::size_t m = 0; m < next.size(); ++m)
          if (groups_[m] != kNone) next[m] += step[groups_[m]];
        auto tried = predict(next);
        if (!tried && tried.error() == "cancelled") return tl::unexpected(tried.error());
        if (!tried || !(squares(*tried) < squares(now_))) continue;
        isBetter = true;
        now_ = std::move(*tried);
        logFactors_ = std::move(next);
      }
      // Without a better point only round-off remains, if the step is small.
      if (!isBetter) {
        out_.hasConverged = size <= 1e3 * kSmallStep;
        break;
      }
    }
    return {};
  }

  [[nodiscard]] std::size_t freedom() const {
    return static_cast<std::size_t>(std::max<Eigen::Index>(0, measured_.size() - countOf(groups_)));
  }
  /// Half the widths of the intervals of log E, by group; infinite: not determined.
  [[nodiscard]] Eigen::VectorXd halfWidths() const {
    const Eigen::MatrixXd J = jacobian();
    const double none = std::numeric_limits<double>::infinity();
    if (freedom() == 0) return Eigen::VectorXd::Constant(J.cols(), none);
    // Scaled, so that the test of the rank does not depend on units.
    const Eigen::VectorXd norms = J.colwise().norm().transpose();
    if (!(norms.minCoeff() > kNoEffect * norms.maxCoeff())) return Eigen::VectorXd::Constant(J.cols(), none);
    const Eigen::MatrixXd scaled = J * norms.cwiseInverse().asDiagonal();
    const Eigen::LDLT<Eigen::MatrixXd> normal(scaled.transpose() * scaled);
    if (!(normal.vectorD().minCoeff() > 1e-10)) return Eigen::VectorXd::Constant(J.cols(), none);
    const Eigen::MatrixXd inverse = normal.solve(Eigen::MatrixXd::Identity(J.cols(), J.cols()));
    const double deviation = std::sqrt(squares(now_) / static_cast<double>(freedom()));
    return detail::studentLimit(freedom()) * deviation *
           (inverse.diagonal().cwiseSqrt().array() / norms.array()).matrix();
  }

  // The moduli individually, if the curve determines them.
  Result<void> separate() {
    const auto before = std::make_tuple(groups_, logFactors_, now_, out_.hasConverged);
    const double largest = now_.derivatives.colwise().norm().maxCoeff();
    Eigen::Index count = 0;
    for (std::size_t m = 0; m < groups_.size(); ++m)
      groups_[m] = now_.derivatives.col(static_cast<Eigen::Index>(m)).norm() > kNoEffect * largest ? count++ : kNone;
    const auto isDetermined = [this] { return halfWidths().maxCoeff() < kDetermined; };
    if (count > 1 && isDetermined()) {
      if (auto done = iterate(); !done) return done;
      if (out_.hasConverged && isDetermined()) return {};
    }
    std::tie(groups_, logFactors_, now_, out_.hasConverged) = before;
    return {};
  }

  void judge(double halfWidth) {
    const double rms = std::sqrt(squares(now_) / static_cast<double>(measured_.size()));
    const Eigen::VectorXd residuals = measured_ - now_.values;
    const std::span<const double> ordered(residuals.data(), static_cast<std::size_t>(residuals.size()));
    const auto percent = [&](double part) { return number(100.0 * part, 2) + " %"; };
    out_.verdict = StiffnessVerdict::unexplained;
    if (!out_.hasConverged)
      out_.reason = "the iteration has not converged";
    else if (settings_.noise > 0.0 && squares(now_) > detail::largestChiSquared(std::max<std::size_t>(1, freedom())) *
                                                          settings_.noise * settings_.noise)
      out_.reason = "the residuals are " + number(out_.residual / settings_.noise, 2) +
                    " times the noise: the model does not have the shape of the curve";
    else if (settings_.noise == 0.0 && rms > kUnlikeModel * out_.measured)
      out_.reason = "the residuals are " + percent(rms / out_.measured) +
                    " of the measured values: the model does not have the shape of the curve";
    else if (settings_.noise == 0.0 && rms > kSystematic * out_.measured && detail::areCorrelated(ordered))
      out_.reason = "the residuals, " + percent(rms / out_.measured) +
                    " of the measured values, are serially correlated: the model does not have the shape of the curve";
    else
      out_.verdict = StiffnessVerdict::found;
    if (out_.verdict != StiffnessVerdict::found || halfWidth < kDetermined) return;
    out_.verdict = StiffnessVerdict::undetermined;
    out_.reason = "the confidence interval extends beyond half or twice the modulus: the noise requires more points";
  }

  StiffnessFit finish() {
    const Eigen::VectorXd widths = halfWidths();
    const bool isCommon = countOf(groups_) == 1;
    for (std::size_t m = 0; m < logFactors_.size(); ++m) {
      FittedModulus one;
      one.value = model_.startModulus(m) * std::exp(logFactors_[m]);
      const double width = groups_[m] == kNone ? std::numeric_limits<double>::infinity() : widths[groups_[m]];
      one.low = one.value * std::exp(-width);
      one.high = one.value * std::exp(width);
      one.isOwn = groups_[m] != kNone && (!isCommon || logFactors_.size() == 1);
      out_.moduli.push_back(one);
    }
    out_.predicted.assign(now_.values.data(), now_.values.data() + now_.values.size());
    const double freedom = static_cast<double>(std::max<std::size_t>(1, this->freedom()));
    out_.residual = std::sqrt(squares(now_) / freedom);
    out_.measured = std::sqrt(measured_.squaredNorm() / static_cast<double>(measured_.size()));
    out_.solutions = model_.solutions();
    judge(widths.maxCoeff());
    return std::move(out_);
  }

  CurveModel &model_;
  const StiffnessFitSettings &settings_;
  std::vector<double> logFactors_;  // [materials] of the moduli at the start
  Groups groups_;
  Eigen::VectorXd measured_;
  CurvePrediction now_;
  StiffnessFit out_;
};

}  // namespace

Result<StiffnessFit> fitStiffness(const StiffnessModel &model, std::span<const CurvePoint> curve,
                                  const ParallelFor &parallelFor, const StiffnessFitSettings &settings) {
  if (std::string why = notFiniteIn(curve); !why.empty()) return tl::unexpected(std::move(why));
  const auto control = curveControl(*model.rest);
  if (!control) return tl::unexpected(control.error());
  if (model.watchedPoint && *control == CurveControl::support)
    return tl::unexpected(std::string(
        "a support is displaced, so its displacement is that of the curve; a measured point is for a force"));
  if (std::string why = problemOf(curve, *control, settings); !why.empty()) return tl::unexpected(std::move(why));
  // Nothing is known of the body where nothing is prescribed.
  std::vector<CurvePoint> used;
  for (const CurvePoint &point : curve)
    if ((*control == CurveControl::support ? point.displacement : point.force) > 0.0) used.push_back(point);
  try {
    auto created = CurveModel::create(model, used, parallelFor, settings.stop);
    if (!created) return tl::unexpected(created.error());
    auto fit = Fit(*created, used, settings).run();
    if (fit) fit->predicted.insert(fit->predicted.begin(), curve.size() - used.size(), 0.0);
    return fit;
  } catch (const Stopped &) {
    return tl::unexpected(std::string("cancelled"));
  }
}

}  // namespace pointbased
