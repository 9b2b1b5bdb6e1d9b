// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <atomic>
#include <cmath>

#include "pointbased/engine.h"

#include "base/expects.h"
#include "forces/custom_batches.h"
#include "forces/entry_forces.h"
#include "forces/point_response.h"
#include "forces/quadratic_energy.h"

namespace pointbased {

using namespace detail;

namespace {

// Stiffness of a point relative to rest: the larger of that of its law and that of its modes, which grows with the
// stretch.
double ratioAt(const Material &material, const Mat3 &F, bool hourglass) {
  const double ratio = tangentRatio(material, F);
  return hourglass ? std::max(ratio, largestEigenvalueBound(F.transpose() * F)) : ratio;
}

double ratioAt(const Material &material, const Mat3 &F, const Mat3 &plasticInverse, bool hourglass) {
  const double ratio = elastoplasticTangentRatio(material, F, plasticInverse);
  return hourglass ? std::max(ratio, largestEigenvalueBound(F.transpose() * F)) : ratio;
}

void customStresses(const PointResponse &response, std::span<const Mat3> gradients, std::span<const Mat3> rates,
                    bool hourglass, std::span<Mat3> out, std::span<double> ratios, std::size_t from, std::size_t to) {
  const Moduli moduli(response.material);
  std::array<TangentBound, kLawBatch> bounds;
  forBatches(from, to, [&](std::size_t first, std::size_t count) {
    moduli.custom->stresses(gradients.subspan(first, count), out.subspan(first, count));
    moduli.custom->bounds(gradients.subspan(first, count), std::span(bounds).first(count));
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t q = first + i;
      const Mat3 &F = gradients[q];
      Mat3 P = out[q];
      VolumeTerm::addStress(moduli, F, P);
      if (response.viscous) P += response.viscousStress(q, F, rates[q]);
      out[q] = response.stencils.volumes[q] * P;
      ratios[q] = detail::tangentRatio(moduli, F, bounds[i]);
      if (hourglass) ratios[q] = std::max(ratios[q], largestEigenvalueBound(F.transpose() * F));
    }
  });
}

}  // namespace

double pointStresses(const Constitution &constitution, const StencilSet &s, std::span<const Mat3> gradients,
                     std::span<const Mat3> rates, const PointHistory &before, double dt, PointHistory *after,
                     std::span<Mat3> out, std::span<double> ratios, const ParallelFor &parallelFor) {
  POINTBASED_EXPECTS(!constitution.materials.empty(), "a material");
  POINTBASED_EXPECTS(gradients.size() == s.pointCount(), "one gradient per evaluation point");
  POINTBASED_EXPECTS(rates.empty() || rates.size() == s.pointCount(), "one rate per evaluation point, or none");
  POINTBASED_EXPECTS(out.size() == s.pointCount() && ratios.size() == s.pointCount(),
                     "one result per evaluation point");
  const bool hourglass = stabilisationOf(constitution, s) == Stabilisation::hourglass;
  runLoop(parallelFor, s.pointCount(), kPointGrain, [&](std::size_t begin, std::size_t end) {
    forMaterialRuns(constitution, s, begin, end, [&](const Material &material, std::size_t from, std::size_t to) {
      const PointResponse response(material, s, before, dt, !rates.empty());
      if (material.law == MaterialLaw::custom) {
        customStresses(response, gradients, rates, hourglass, out, ratios, from, to);
      } else if (response.elastic()) {
        withLaw(material.law, [&](auto law) {
          const Moduli moduli(material);
          for (std::size_t q = from; q < to; ++q) {
            const Mat3 F = lawGradient(law, s, q, gradients[q]);
            out[q] = s.volumes[q] * law.stress(moduli, F);
            ratios[q] = ratioAt(material, F, hourglass);
          }
        });
      } else {
        for (std::size_t q = from; q < to; ++q) {
          PronyPoint fresh;
          PronyPoint *memory = response.relaxing && after ? &after->prony[q] : &fresh;
          const Mat3 P = response.stress(q, gradients[q], rates.empty() ? Mat3(Mat3::Zero()) : rates[q], *memory);
          out[q] = s.volumes[q] * P;
          ratios[q] = response.plastic ? ratioAt(material, gradients[q], before.plasticInverse[q], hourglass)
                                       : ratioAt(material, gradients[q], hourglass);
        }
      }
      if (!response.relaxing && after && after != &before && !before.prony.empty())
        std::copy(before.prony.begin() + static_cast<std::ptrdiff_t>(from),
                  before.prony.begin() + static_cast<std::ptrdiff_t>(to),
                  after->prony.begin() + static_cast<std::ptrdiff_t>(from));
    });
  });
  double largest = 1.0;
  for (const double ratio : ratios) {
    // NaN must not be lost in the comparison.
    if (!(ratio <= largest)) largest = ratio;
    if (std::isnan(largest)) break;
  }
  return largest;
}

std::size_t plasticFlow(const Constitution &constitution, const StencilSet &s, std::span<const Mat3> gradients,
                        double dt, PointHistory &history, const ParallelFor &parallelFor) {
  POINTBASED_EXPECTS(gradients.size() == s.pointCount(), "one gradient per evaluation point");
  POINTBASED_EXPECTS(history.plasticInverse.empty() || history.plasticInverse.size() == s.pointCount(),
                     "a history of every evaluation point, or none");
  if (history.plasticInverse.empty()) return 0;
  std::atomic<std::size_t> flowed{0};
  runLoop(parallelFor, s.pointCount(), kPointGrain, [&](std::size_t begin, std::size_t end) {
    std::size_t here = 0;
    forMaterialRuns(constitution, s, begin, end, [&](const Material &material, std::size_t from, std::size_t to) {
      if (!material.plastic.enabled()) return;
      for (std::size_t q = from; q < to; ++q)
        here += plasticFlow(material.plastic, gradients[q], dt, history.plasticInverse[q], nullptr,
                            history.plasticBefore.empty() ? nullptr : &history.plasticBefore[q])
                    ? 1
                    : 0;
    });
    flowed += here;
  });
  return flowed;
}

ElasticEnergy elasticEnergy(const Constitution &constitution, const StencilSet &s, std::span<const Vec3> X,
                            std::span<const Vec3> u, std::span<const Mat3> gradients, const PointHistory &history,
                            std::span<Eigen::Vector2d> perPoint) {
  POINTBASED_EXPECTS(!constitution.materials.empty(), "a material");
  POINTBASED_EXPECTS(X.size() == s.entriesOfPhyxel.rows() && u.size() == X.size(),
                     "one position and one displacement per phyxel");
  POINTBASED_EXPECTS(gradients.size() == s.pointCount(), "one gradient per evaluation point");
  POINTBASED_EXPECTS(perPoint.empty() || perPoint.size() == s.pointCount(), "room for every evaluation point, or none");
  return elasticEnergyOf(constitution, s, X, u, gradients, history, perPoint, 0, s.pointCount());
}

ElasticEnergy detail::elasticEnergyOf(const Constitution &constitution, const StencilSet &s, std::span<const Vec3> X,
                                      std::span<const Vec3> u, std::span<const Mat3> gradients,
                                      const PointHistory &history, std::span<Eigen::Vector2d> perPoint,
                                      std::size_t begin, std::size_t end) {
  ElasticEnergy energy;
  const Stabilisation control = stabilisationOf(constitution, s);
  CustomEnergies custom;
  for (std::size_t q = begin; q < end; ++q) {
    const Material &material = materialOfPoint(constitution, s, q);
    const bool linear = material.law == MaterialLaw::linear;
    const bool plastic = !history.plasticInverse.empty() && material.plastic.enabled();
    const Mat3 F = linear ? lawGradient(Law<MaterialLaw::linear>(), s, q, gradients[q]) : gradients[q];
    const auto sameUntil = [&] {
      std::size_t last = q + 1;
      while (last < end && last < q + kLawBatch && &materialOfPoint(constitution, s, last) == &material) ++last;
      return last;
    };
    const double density = plastic ? elastoplasticEnergyDensity(material, F, history.plasticInverse[q])
                           : material.law == MaterialLaw::custom ? custom.at(material, gradients, q, sameUntil)
                                                                 : energyDensity(material, F);
    const double strain = s.volumes[q] * density;
    double stabilisation = 0.0;
    if (control == Stabilisation::hourglass && material.relaxes()) {
      const RelaxingHourglassPoint point(RelaxingHourglass(material, constitution.stabilisation, 0.0), s, q,
                                         linear ? Mat3(Mat3::Identity()) : gradients[q], amplitudes(s, q, u),
                                         HourglassStrain(HourglassStrain::Zero()));
      stabilisation = 0.5 * point.strain.cwiseProduct(point.D).sum();
    } else if (const QuadraticPoints::Point *quadratic = s.quadratic.find(q);
               control == Stabilisation::hourglass && quadratic != nullptr) {
      const HourglassEnergy modal(material, constitution.stabilisation);
      const Amplitudes modes = amplitudes(s, q, u);
      const QuadraticPoint point(QuadraticEnergy(modal), s, q, *quadratic,
                                 linear ? Mat3(Mat3::Identity()) : gradients[q],
                                 secondGradient(bendsOf(s, q, *quadratic, u), modes));
      stabilisation =
          point.energy + 0.5 * modal.twist(s.volumes[q], s.variances[q]) * modes.topRightCorner<3, 1>().squaredNorm();
    } else if (control == Stabilisation::hourglass) {
      stabilisation = HourglassPoint(HourglassEnergy(material, constitution.stabilisation), s, q,
                                     linear ? Mat3(Mat3::Identity()) : gradients[q], amplitudes(s, q, u))
                          .energy;
    } else if (control == Stabilisation::isotropic && s.rank[q] > 0) {
      const StabilisationPoint residual(s, q, gradients[q]);
      const Index first = s.phyxels.offsets[q], anchor = s.phyxels.indices[first];
      double sum = 0.0;
      for (Index e = first + 1; e < s.phyxels.offsets[q + 1]; ++e)
        sum += s.weights[e] * residual.direction(Offset(s, q, X, u, s.phyxels.indices[e], anchor)).squaredNorm();
      stabilisation = 0.5 * residualScale(material, constitution.stabilisation, s.volumes[q]) * sum;
    }
    energy.strain += strain;
    energy.stabilisation += stabilisation;
    if (!perPoint.empty()) perPoint[q] = {strain, stabilisation};
  }
  return energy;
}

}  // namespace pointbased
