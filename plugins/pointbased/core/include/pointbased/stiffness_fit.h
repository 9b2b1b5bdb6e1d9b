// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pointbased/body.h"
#include "pointbased/stop_request.h"

namespace pointbased {

/// A point of a measured force-displacement curve.
struct CurvePoint {
  double displacement = 0.0;  ///< m, >= 0
  double force = 0.0;         ///< N
};

/// What the experiment prescribes; the other quantity is measured.
enum class CurveControl {
  support,  ///< the displacement of the only support that moves; its reaction is measured
  load      ///< the only force; the displacement of a material point is measured
};

/// A body as it was measured. Its conditions prescribe either the displacement of one support, or one force.
/// Displacement and force of the curve are the components along the direction of that displacement or force, whose
/// magnitude has no effect.
struct StiffnessModel {
  std::shared_ptr<const RestState> rest;
  Constitution constitution;    ///< the moduli from which the fit starts
  Foundation foundation;        ///< its stiffness is not fitted
  Vec3 gravity = Vec3::Zero();  ///< m/s²; it acts before the measurement, which is relative to the state under gravity
  std::optional<Vec3> watchedPoint;  ///< reference position, world, m; required for CurveControl::load
};

struct StiffnessFitSettings {
  double noise = 0.0;       ///< standard deviation of the measurement noise, N or m; 0: unknown
  int maxIterations = 25;   ///< of Gauss-Newton; > 0
  bool fitsEachOne = true;  ///< the moduli of several materials one by one, where the curve determines them
  const StopRequest *stop = nullptr;
  std::function<bool(double fraction)> progress;  ///< false: cancelled
};

enum class StiffnessVerdict {
  found,
  unexplained,  ///< the residuals are not those of noise: the model does not have the shape of the curve
  undetermined  ///< the confidence interval extends beyond half or twice the modulus
};

struct FittedModulus {
  double value = 0.0, low = 0.0,
         high = 0.0;   ///< Pa; 95 % confidence interval by Student's t, without errors of the model
  bool isOwn = false;  ///< fitted separately; otherwise it has a common factor with others
};

struct StiffnessFit {
  StiffnessVerdict verdict = StiffnessVerdict::found;
  std::string reason;  ///< of a verdict other than found
  CurveControl control = CurveControl::support;
  std::vector<FittedModulus> moduli;  ///< [materials]
  std::vector<double> predicted;      ///< [points] N or m: what is measured, by the fitted model
  double residual = 0.0;              ///< N or m: root mean square, per degree of freedom
  double measured = 0.0;              ///< N or m: root mean square of what was measured
  int iterations = 0;
  bool hasConverged = false;
  std::size_t solutions = 0;  ///< number of static solutions
};

/// What the conditions of a body prescribe. Errors: not exactly one support that moves, or one force; a rotation or a
/// pressure.
[[nodiscard]] Result<CurveControl> curveControl(const RestState &rest);

/// Young's moduli E by which the static solutions of a body reproduce a measured curve:
///
///     minimise  Σ (y_i - f_i(E))²,   f_i the reaction at a displacement, or the displacement at a force
///
/// by Gauss-Newton in log E with the exact derivatives of EquilibriumSensitivitySolver. Curves of more than twelve
/// different points are interpolated between eleven solutions at Chebyshev points. Ratios of moduli, Poisson's ratio
/// and volumeStiffness do not change, except for ratios that the curve determines. Gravity can cause several minima:
/// ten and a hundred times the moduli are then tried as further starts.
/// Errors: conditions that do not define what is prescribed; what the sensitivities refuse; fewer than four points that
/// differ; values that are not finite, negative or decreasing; no equilibrium; forces against the displacement;
/// "cancelled".
/// @threads one at a time for a model; bitwise identical for any number behind parallelFor
/// @source  Seber and Wild, Nonlinear Regression, 2003, ch. 5 (intervals); von Neumann, Annals of Mathematical
///          Statistics 12, 1941 (test of the residuals)
[[nodiscard]] Result<StiffnessFit> fitStiffness(const StiffnessModel &model, std::span<const CurvePoint> curve,
                                                const ParallelFor &parallelFor,
                                                const StiffnessFitSettings &settings = {});

}  // namespace pointbased
