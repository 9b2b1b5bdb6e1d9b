// SPDX-License-Identifier: Apache-2.0
// Two material laws for the point-based plugin: an exponential one for soft tissue that stiffens as it is stretched, and
// the compressible neo-Hookean one, which the plugin has itself: what it costs to have a law from outside.
#include <algorithm>
#include <array>
#include <cmath>

#include "c3de/pointbased/material_law.hpp"
#include "c3de/sdk/sdk.hpp"

namespace {

namespace sdk = c3de::sdk;

using sdk::Deformation, sdk::dot, sdk::matrix9;
using Matrix = sdk::Matrix9;

/// W = mu/(2b) (exp(b (I - 3)) - 1) + K/4 (J² - 1 - 2 ln J), I = J^(-2/3) tr(F^T F).
/// @source  Demiray, A note on the elasticity of soft biological tissues, J. Biomech. 5 (1972), for incompressible
///          tissue; the volumetric part as is usual where I is free of the volume
class Exponential {
 public:
  static constexpr std::array kParams{
      sdk::numberParam({.id = "exponential.shear_modulus",
                        .label = "Shear modulus",
                        .unit = "Pa",
                        .doc = "At rest. Liver about 2 kPa"},
                       {.min = 0.0, .max = 1e12, .softMin = 100.0, .softMax = 1e5}, 2000.0,
                       C3DE_PARAM_MIN_OPEN | C3DE_PARAM_LOG_SCALE),
      sdk::numberParam({.id = "exponential.stiffening",
                        .label = "Stiffening b",
                        .unit = "",
                        .doc = "Exponent: the stress grows by exp(b (I - 3)); small: as rubber"},
                       {.min = 1e-6, .max = 20.0, .softMin = 0.01, .softMax = 10.0}, 2.0),
      sdk::numberParam({.id = "exponential.bulk_modulus",
                        .label = "Bulk modulus",
                        .unit = "Pa",
                        .doc = "Resistance to a change of volume; the stable step shrinks with its root"},
                       {.min = 0.0, .max = 1e12, .softMin = 1e3, .softMax = 1e6}, 20000.0,
                       C3DE_PARAM_MIN_OPEN | C3DE_PARAM_LOG_SCALE)};

  explicit Exponential(const double *params) : mu_(params[0]), b_(params[1]), K_(params[2]) {}

  double energy(const double *f) const {
    const Deformation v(f);
    const double I = std::pow(v.J, -2.0 / 3.0) * dot(v.F, v.F);
    return mu_ / (2.0 * b_) * std::expm1(b_ * (I - 3.0)) + 0.25 * K_ * (v.J * v.J - 1.0 - 2.0 * std::log(v.J));
  }
  void stress(const double *f, double *P) const {
    const Deformation v(f);
    const Shape shape(v);
    const double slope = 0.5 * mu_ * std::exp(b_ * (shape.I - 3.0)), pressure = 0.5 * K_ * (v.J - 1.0 / v.J);
    for (std::size_t i = 0; i < 9; ++i) P[i] = slope * shape.slope[i] + pressure * v.cof[i];
  }
  void differential(const double *f, const double *df, double *dP) const {
    const Deformation v(f);
    const Shape shape(v);
    const Matrix D = matrix9(df), dcof = v.cofactorChange(D);
    const double slope = 0.5 * mu_ * std::exp(b_ * (shape.I - 3.0)), dI = dot(shape.slope, D);
    const double dJ = dot(v.cof, D), FD = dot(v.F, D);
    const double pressure = 0.5 * K_ * (v.J - 1.0 / v.J), dPressure = 0.5 * K_ * (1.0 + 1.0 / (v.J * v.J)) * dJ;
    for (std::size_t i = 0; i < 9; ++i) {
      // F^-T = cof F / J, and its change.
      const double h = v.cof[i] / v.J, dh = (dcof[i] - h * dJ) / v.J;
      const double bent = -2.0 / 3.0 * dJ / v.J * shape.slope[i] +
                          shape.scale * (2.0 * D[i] - 4.0 / 3.0 * FD * h - 2.0 / 3.0 * shape.squares * dh);
      dP[i] = slope * (bent + b_ * dI * shape.slope[i]) + pressure * dcof[i] + dPressure * v.cof[i];
    }
  }

 private:
  /// I and dI/dF.
  struct Shape {
    double scale, squares, I;
    Matrix slope;
    explicit Shape(const Deformation &v)
        : scale(std::pow(v.J, -2.0 / 3.0)), squares(dot(v.F, v.F)), I(scale * squares) {
      for (std::size_t i = 0; i < 9; ++i) slope[i] = scale * (2.0 * v.F[i] - 2.0 / 3.0 * squares * v.cof[i] / v.J);
    }
  };
  double mu_, b_, K_;
};

/// W = mu/2 (tr(F^T F) - 3) - mu ln J + lambda/2 (ln J)²; not for nu < 0, and not continued where a point is inverted.
/// @source  Bonet and Wood, Nonlinear Continuum Mechanics for Finite Element Analysis, 2nd ed., ch. 6.4
class NeoHookean {
 public:
  // The same parameters as those of the point-based plugin.
  static constexpr std::array kParams{
      sdk::numberParam({.id = "youngs_modulus", .unit = "Pa"}, {.min = 0.0, .max = 1e12}, 6000.0),
      sdk::numberParam({.id = "poisson_ratio"}, {.min = 0.0, .max = 0.5}, 0.45)};

  explicit NeoHookean(const double *params)
      : lambda_(params[0] * params[1] / ((1.0 + params[1]) * (1.0 - 2.0 * params[1]))),
        mu_(params[0] / (2.0 * (1.0 + params[1]))) {}

  double energy(const double *f) const {
    const Deformation v(f);
    const double l = std::log(v.J);
    return 0.5 * mu_ * (dot(v.F, v.F) - 3.0) - mu_ * l + 0.5 * lambda_ * l * l;
  }
  void stress(const double *f, double *P) const {
    const Deformation v(f);
    const double pressure = mu_ + first(v.J);
    for (std::size_t i = 0; i < 9; ++i) P[i] = mu_ * (v.F[i] - v.cof[i]) + pressure * v.cof[i];
  }
  void differential(const double *f, const double *df, double *dP) const {
    const Deformation v(f);
    const Matrix D = matrix9(df), dcof = v.cofactorChange(D);
    const double g1 = first(v.J), g2 = second(v.J) * dot(v.cof, D);
    for (std::size_t i = 0; i < 9; ++i) dP[i] = mu_ * D[i] + g2 * v.cof[i] + g1 * dcof[i];
  }
  // Along a⊗n J is linear, so that only its second derivative counts; off the principal axes the first one does, times
  // a stretch.
  void bounds(const double *f, double *waveAndAll) const {
    const Deformation v(f);
    const double g1 = first(v.J), g2 = second(v.J), area2 = largestSquare(v.cof), r = g1 / v.J;
    const double along = std::max(0.0, g2 + r) * dot(v.cof, v.cof) + std::max(0.0, -r) * area2;
    waveAndAll[0] = mu_ + std::max(0.0, g2) * area2;
    waveAndAll[1] = mu_ + std::max(along, std::abs(g1) * std::sqrt(largestSquare(v.F)));
  }

 private:
  [[nodiscard]] double first(double J) const { return (lambda_ * std::log(J) - mu_) / J; }
  [[nodiscard]] double second(double J) const { return (lambda_ + mu_ - lambda_ * std::log(J)) / (J * J); }

  /// Square of the largest singular value, by the three roots of a cubic.
  static double largestSquare(const Matrix &m) {
    double a[3][3];
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        a[i][j] = m[3 * i] * m[3 * j] + m[3 * i + 1] * m[3 * j + 1] + m[3 * i + 2] * m[3 * j + 2];
    const double q = (a[0][0] + a[1][1] + a[2][2]) / 3.0;
    for (std::size_t i = 0; i < 3; ++i) a[i][i] -= q;
    const double off = a[0][1] * a[0][1] + a[0][2] * a[0][2] + a[1][2] * a[1][2];
    const double p = std::sqrt((a[0][0] * a[0][0] + a[1][1] * a[1][1] + a[2][2] * a[2][2] + 2.0 * off) / 6.0);
    if (!(p > 1e-9 * q)) return q + 2.0 * p;
    const double det = a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[1][2]) -
                       a[0][1] * (a[0][1] * a[2][2] - a[1][2] * a[0][2]) +
                       a[0][2] * (a[0][1] * a[1][2] - a[1][1] * a[0][2]);
    return q + 2.0 * p * std::cos(std::acos(std::clamp(det / (2.0 * p * p * p), -1.0, 1.0)) / 3.0);
  }

  double lambda_, mu_;
};

class MaterialLaws {
 public:
  static constexpr sdk::PluginInfo info{.id = "org.c3de.material_law",
                                        .version = "1.0.0",
                                        .displayName = "Material laws",
                                        .vendor = "C3DE",
                                        .license = "Apache-2.0"};
  static constexpr std::array needs{sdk::required<c3de_registry_v1>()};

  explicit MaterialLaws(sdk::Host host) {
    const sdk::Registry registry(host);
    sdk::orThrow(registry.add<sdk::MaterialLaw<Exponential>>("org.c3de.exponential/0", "Exponential",
                                                             "Soft tissue that stiffens as it is stretched", *this));
    sdk::orThrow(registry.add<sdk::MaterialLaw<NeoHookean>>("org.c3de.neo_hookean/0", "Neo-Hookean",
                                                            "As the point-based plugin's own, for comparison", *this));
  }
};

}  // namespace

C3DE_DEFINE_PLUGIN(MaterialLaws)
