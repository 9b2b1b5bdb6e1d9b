// SPDX-License-Identifier: Apache-2.0
#include "pointbased/material.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "material/laws.h"

namespace pointbased {

using detail::Moduli;

namespace {

// Bounds of the tangent of a function of J with derivatives g1, g2 at F.
struct VolumeBounds {
  double J, areas2, area2, size;  // |cof F|², its largest singular value squared, |F|

  explicit VolumeBounds(const Mat3 &F) {
    const Mat3 c = detail::cofactor(F);
    J = F.col(0).dot(c.col(0));
    areas2 = c.squaredNorm();
    area2 = detail::largestEigenvalueBound(c.transpose() * c);
    size = F.norm();
  }

  // For a⊗n : d²g : a⊗n: J is linear along a⊗n, so only g2 contributes.
  double wave(double g2) const { return std::max(0.0, g2) * area2; }

  // For dF on the diagonal of the principal frame: g2 c cᵀ + g1 D with D_ij = s_k. The eigenvalues of D, the roots of
  // x³ - |F|² x - 2 J, are between ± 2/sqrt(3) |F|, and above -|F| for J > 0. Since D_ij = c_i c_j / J, for J > 0 it is
  // also (g2 + g1/J) c cᵀ - g1/J diag(c_i²), which is exact at rest.
  double along(double g1, double g2) const {
    const double bound = std::max(0.0, g2) * areas2 + std::abs(g1) * size * (J > 0.0 && g1 < 0.0 ? 1.0 : 1.1548);
    if (!(J > 1e-9)) return bound;
    const double r = g1 / J;
    return std::min(bound, std::max(0.0, g2 + r) * areas2 + std::max(0.0, -r) * area2);
  }

  // For dF off the diagonal: ± g1 times a stretch. The largest stretch is computed only if |F| in its place would
  // matter.
  double across(double g1, const Mat3 &F, double enough) const {
    const double bound = std::abs(g1) * size;
    return bound <= enough ? bound : std::abs(g1) * std::sqrt(detail::largestEigenvalueBound(F.transpose() * F));
  }
};

// Upper bounds of the largest wave modulus and of the largest eigenvalue of dP/dF.
struct Stiffness {
  double wave, all;
};

Stiffness stVenantKirchhoffStiffness(const Moduli &m, const Mat3 &F) {
  const Mat3 C = F.transpose() * F;
  const double stretch2 = detail::largestEigenvalueBound(C);
  const double stress = 0.5 * m.lambda * (C.trace() - 3.0) + m.mu * (stretch2 - 1.0);  // largest of S
  return {stress + (m.lambda + 2.0 * m.mu) * stretch2,
          stress + std::max(0.0, m.lambda) * C.trace() + 2.0 * m.mu * stretch2};
}

// In the principal frame, with k = 2 mu - lambda (tr U - 3) and b_ij = k / (s_i + s_j), a skew pair has the eigenvalue
// 2 mu - 2 b_ij, and a⊗n at most lambda + 2 mu or 2 mu - lambda - 2 b_ij.
Stiffness corotatedStiffness(const Moduli &m, const Mat3 &F) {
  const double wave = m.lambda + 2.0 * m.mu;
  const double all = std::max(3.0 * m.lambda, 0.0) + 2.0 * m.mu;
  // tr U <= sqrt(3) |F|: k becomes negative only under tension beyond 2 mu, due to the stress that rotates with the
  // frame.
  const double size = F.norm();
  if (m.lambda >= 0.0 && m.lambda * (std::sqrt(3.0) * size - 3.0) <= 2.0 * m.mu) return {wave, all};
  const detail::Polar p = detail::polar(F);
  const double k = 2.0 * m.mu - m.lambda * (p.trace - 3.0);
  double b = k / (std::sqrt(2.0) * size);
  if (!(k >= 0.0)) {
    const Mat3 U = detail::symmetric(p.R.transpose() * F);
    b = k * std::min(1.0 / kCorotatedFloor, detail::largestEigenvalueBound(detail::turnMatrix(p, U)));
  }
  return {std::max(wave, 2.0 * m.mu - m.lambda - 2.0 * b), std::max(all, 2.0 * m.mu - 2.0 * b)};
}

void addVolume(const Moduli &m, const Mat3 &F, Stiffness &s) {
  if (!(m.volume > 0.0)) return;
  const VolumeBounds bounds(F);
  s.wave += bounds.wave(m.volume);
  const double g1 = m.volume * (bounds.J - 1.0), along = bounds.along(g1, m.volume);
  s.all += std::max(along, bounds.across(g1, F, along));
}

Stiffness stiffness(const Moduli &m, MaterialLaw law, const Mat3 &F) {
  if (law == MaterialLaw::neoHookean) {
    const VolumeBounds bounds(F);
    detail::Volumetric v = detail::volumetric(m, bounds.J);
    if (bounds.J >= kNeoHookeanSwitch) {
      const double along = bounds.along(v.g1, v.g2);
      const double atRest = std::max(3.0 * (m.lambda + m.volume), 0.0) + m.mu;
      return {m.mu + bounds.wave(v.g2), m.mu + std::max(along, bounds.across(v.g1, F, std::max(along, atRest)))};
    }
    // Terms that appear below the switch: |F - R|² contributes at most 2 (tr U is convex), plus products of first
    // derivatives.
    const detail::Collapse k = detail::collapse(m, bounds.J);
    const double off2 = (F - detail::polar(F).R).squaredNorm();
    v.g1 += k.slope * off2;
    v.g2 += k.curvature * off2;
    const double shear = m.mu + 2.0 * k.value;
    return {shear + bounds.wave(v.g2) + 4.0 * std::abs(k.slope) * std::sqrt(bounds.area2 * off2),
            shear + std::max(bounds.along(v.g1, v.g2), bounds.across(v.g1, F, 0.0)) +
                4.0 * std::abs(k.slope) * std::sqrt(bounds.areas2 * off2)};
  }
  Stiffness s{m.lambda + 2.0 * m.mu, std::max(3.0 * m.lambda, 0.0) + 2.0 * m.mu};
  if (law == MaterialLaw::stVenantKirchhoff) s = stVenantKirchhoffStiffness(m, F);
  if (law == MaterialLaw::corotated) s = corotatedStiffness(m, F);
  addVolume(m, F, s);
  return s;
}

double ratioOf(const Stiffness &now, const Stiffness &atRest) {
  const double ratio = std::max(now.wave / atRest.wave, now.all / atRest.all);
  return ratio <= 1.0 ? 1.0 : ratio;  // NaN stays NaN
}

// Collects errors as "name = value is not accepted: what is".
struct ValidationErrors {
  std::string text;

  void need(bool ok, const char *name, double value, const char *accepted) {
    if (ok) return;
    char shown[40];
    std::snprintf(shown, sizeof shown, "%.6g", value);
    text += (text.empty() ? "" : "; ") + std::string(name) + " = " + shown + " is not accepted: " + accepted;
  }
};

}  // namespace

Result<void> validate(const Material &m) {
  ValidationErrors c;
  c.need(std::isfinite(m.youngsModulus) && m.youngsModulus > 0.0, "Young's modulus", m.youngsModulus,
         "finite and > 0 Pa");
  c.need(std::isfinite(m.poissonRatio) && m.poissonRatio > -1.0 && m.poissonRatio < 0.5, "Poisson's ratio",
         m.poissonRatio, "-1 < nu < 0.5");
  c.need(std::isfinite(m.restDensity) && m.restDensity > 0.0, "density", m.restDensity, "finite and > 0 kg/m³");
  c.need(std::isfinite(m.viscosity) && m.viscosity >= 0.0, "viscosity", m.viscosity, "finite and >= 0 Pa s");
  c.need(std::isfinite(m.volumeStiffness) && m.volumeStiffness >= 0.0, "volume stiffness", m.volumeStiffness,
         "finite and >= 0 Pa");
  double shares = 0.0;
  for (const PronyTerm &term : m.prony) {
    const bool share = std::isfinite(term.share) && term.share >= 0.0;
    c.need(share, "Prony share", term.share, "0 <= share < 1");
    if (share) shares += term.share;
    c.need(!(term.share > 0.0) || (std::isfinite(term.time) && term.time > 0.0), "Prony time", term.time,
           "finite and > 0 s where the share is > 0");
  }
  c.need(shares < 1.0, "sum of the Prony shares", shares, "< 1");
  c.need(m.plastic.yield >= 0.0, "plastic yield", m.plastic.yield, ">= 0 (inf: elastic)");
  c.need(m.plastic.creep >= 0.0 && m.plastic.creep <= 1.0, "plastic creep", m.plastic.creep, "0 ... 1");
  c.need(std::isfinite(m.plastic.creepTime) && m.plastic.creepTime > 0.0, "plastic creep time", m.plastic.creepTime,
         "finite and > 0 s");
  c.need(m.plastic.max >= 0.0, "plastic max", m.plastic.max, ">= 0 (0: elastic, inf: no limit)");
  if (m.law == MaterialLaw::custom && (m.relaxes() || m.plastic.enabled()))
    c.text += (c.text.empty() ? "" : "; ") + m.custom->law().name() +
              " does not combine with Prony terms or plasticity: both divide a law into parts that only the built-in "
              "ones have; accepted: viscosity, volume stiffness, or a built-in law";
  if (!c.text.empty()) return tl::unexpected<std::string>(c.text);
  return {};
}

void setLaw(Material &material, std::shared_ptr<const CheckedLaw> law) {
  const double lambda = law->lambda(), mu = law->mu();
  material.law = MaterialLaw::custom;
  material.youngsModulus = mu * (3.0 * lambda + 2.0 * mu) / (lambda + mu);
  material.poissonRatio = lambda / (2.0 * (lambda + mu));
  material.custom = std::move(law);
}

Mat3 greenStrain(const Mat3 &F) { return 0.5 * (F.transpose() * F - Mat3::Identity()); }

double energyDensity(const Material &material, const Mat3 &F) {
  const Moduli m(material);
  return detail::withLaw(material.law, [&](auto law) { return law.energy(m, F); });
}

Mat3 firstPiolaStress(const Material &material, const Mat3 &F) {
  const Moduli m(material);
  return detail::withLaw(material.law, [&](auto law) { return law.stress(m, F); });
}

Mat3 secondPiolaStress(const Material &material, const Mat3 &F) {
  if (material.law == MaterialLaw::linear) return firstPiolaStress(material, F);
  const bool singular = std::abs(F.determinant()) < 1e-12;
  if (singular || (material.law == MaterialLaw::stVenantKirchhoff && !(material.volumeStiffness > 0.0)))
    return detail::hooke(Moduli(material), greenStrain(F));
  return F.inverse() * firstPiolaStress(material, F);
}

Mat3 cauchyStress(const Material &material, const Mat3 &F) {
  const Mat3 P = firstPiolaStress(material, F);
  if (material.law == MaterialLaw::linear) return P;
  const double J = F.determinant();
  return P * F.transpose() / std::copysign(std::max(std::abs(J), 1e-12), J);
}

StressTangent stressTangent(const Material &material, const Mat3 &F) {
  const Moduli m(material);
  return detail::withLaw(material.law, [&](auto law) { return law.tangent(m, F); });
}

Mat3 stressDifferential(const Material &material, const StressTangent &tangent, const Mat3 &dF) {
  const Moduli m(material);
  return detail::withLaw(material.law, [&](auto law) { return law.differential(m, tangent, dF); });
}

Mat3 stressDifferential(const Material &material, const Mat3 &F, const Mat3 &dF) {
  const Moduli m(material);
  return detail::withLaw(material.law, [&](auto law) { return law.differential(m, law.tangent(m, F), dF); });
}

double tangentRatio(const Material &material, const Mat3 &F) {
  const Moduli m(material);
  if (m.custom) {
    TangentBound bound;
    m.custom->bounds({&F, 1}, {&bound, 1});
    return detail::tangentRatio(m, F, bound);
  }
  const double lambda = m.lambda + m.volume;
  return ratioOf(stiffness(m, material.law, F), {lambda + 2.0 * m.mu, std::max(3.0 * lambda, 0.0) + 2.0 * m.mu});
}

double detail::tangentRatio(const Moduli &m, const Mat3 &F, const TangentBound &ofLaw) {
  Stiffness s{ofLaw.wave, ofLaw.all};
  addVolume(m, F, s);
  const TangentBound &rest = m.custom->atRest();
  return ratioOf(s, {rest.wave + m.volume, rest.all + 3.0 * m.volume});
}

}  // namespace pointbased
