// SPDX-License-Identifier: Apache-2.0
#include "pointbased/engine.h"

#include "base/expects.h"
#include "forces/point_loops.h"
#include "forces/relaxing_hourglass.h"

namespace pointbased {

using namespace detail;

void relaxModes(const Constitution &constitution, const StencilSet &s, std::span<const Vec3> u,
                std::span<const Mat3> gradients, const PointHistory &before, double dt, PointHistory *after,
                std::span<HourglassStrain> relaxed, const ParallelFor &parallelFor) {
  POINTBASED_EXPECTS(gradients.size() == s.pointCount(), "one gradient per evaluation point");
  POINTBASED_EXPECTS(before.modes.size() == s.pointCount() && relaxed.size() == s.pointCount(),
                     "modes of every evaluation point");
  const bool hourglass = stabilisationOf(constitution, s) == Stabilisation::hourglass;
  runLoop(parallelFor, s.pointCount(), kPointGrain, [&](std::size_t begin, std::size_t end) {
    forMaterialRuns(constitution, s, begin, end, [&](const Material &material, std::size_t from, std::size_t to) {
      const bool relaxes = hourglass && material.relaxes();
      const PronyStep step = relaxes ? pronyStep(material, dt) : PronyStep();
      const RelaxingHourglass modes(material, constitution.stabilisation, step.freshSum);
      const bool linear = material.law == MaterialLaw::linear;
      for (std::size_t q = from; q < to; ++q) {
        HourglassHistory fresh = before.modes[q];
        if (relaxes) {
          const RelaxingHourglassPoint point(s, linear ? Mat3(Mat3::Identity()) : gradients[q], amplitudes(s, q, u));
          advance(modes, step, point.strain, before.modes[q], fresh);
        }
        relaxed[q] =
            relaxes ? HourglassStrain(fresh.relaxed[0] + fresh.relaxed[1]) : HourglassStrain(HourglassStrain::Zero());
        if (after) after->modes[q] = fresh;
      }
    });
  });
}

}  // namespace pointbased
