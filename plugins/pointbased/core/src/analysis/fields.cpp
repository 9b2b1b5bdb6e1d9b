// SPDX-License-Identifier: Apache-2.0
#include "pointbased/fields.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "forces/point_loops.h"

namespace pointbased {

using namespace detail;

namespace {

/// Computes v P of every point. Without rates there is no viscous part; without time the relaxation history is
/// unchanged.
void firstPiolaStresses(const Body &body, StressScratch &scratch, const ParallelFor &parallelFor) {
  const std::size_t points = body.rest().pointCount();
  scratch.firstPiola.resize(points);
  scratch.ratios.resize(points);
  if (body.rigid()) {
    std::fill(scratch.firstPiola.begin(), scratch.firstPiola.end(), Mat3(Mat3::Zero()));
    return;
  }
  (void)pointStresses(body.constitution(), body.rest().stencils, body.gradients(), {}, body.state().history, 0.0,
                      nullptr, scratch.firstPiola, scratch.ratios, parallelFor);
}

Mat3 symmetric(const Mat3 &m) { return 0.5 * (m + m.transpose()); }

/// out[q] = stressOf(F, P) for every point, with the special cases common to both stresses.
template <class StressOf>
void stressesInto(const Body &body, std::span<Mat3> out, StressScratch &scratch, const ParallelFor &parallelFor,
                  const StressOf &stressOf) {
  firstPiolaStresses(body, scratch, parallelFor);
  const StencilSet &s = body.rest().stencils;
  const std::span<const Mat3> gradients = body.gradients();
  runLoop(parallelFor, out.size(), kPointGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t q = begin; q < end; ++q) {
      const Mat3 &F = gradients[q];
      const Mat3 P = scratch.firstPiola[q] / s.volumes[q];
      if (materialOfPoint(body.constitution(), s, q).law == MaterialLaw::linear) {
        out[q] = symmetric(P);
      } else if (F.determinant() > 0.0) {
        out[q] = symmetric(stressOf(F, P));
      } else {
        out[q].setZero();
      }
    }
  });
}

}  // namespace

void secondPiolaStresses(const Body &body, std::span<Mat3> out, StressScratch &scratch,
                         const ParallelFor &parallelFor) {
  stressesInto(body, out, scratch, parallelFor, [](const Mat3 &F, const Mat3 &P) -> Mat3 { return F.inverse() * P; });
}

void cauchyStresses(const Body &body, std::span<Mat3> out, StressScratch &scratch, const ParallelFor &parallelFor) {
  stressesInto(body, out, scratch, parallelFor,
               [](const Mat3 &F, const Mat3 &P) -> Mat3 { return P * F.transpose() / F.determinant(); });
}

double vonMises(const Mat3 &stress) {
  const Mat3 deviator = stress - stress.trace() / 3.0 * Mat3::Identity();
  return std::sqrt(1.5) * deviator.norm();
}

Interpolation bindPoints(const RestState &rest) {
  Interpolation points = rest.bind(rest.pointCentres, {});
  if (!rest.stencils.isLattice()) return points;
  // If two parts of the body share a cell, the centre of one may be in the other. It then follows its own affine
  // motion.
  const Csr &own = rest.stencils.phyxels;
  const auto isOwn = [&](std::size_t q) {
    const std::span<const Index> stencil = own.row(q), bound = points.phyxels.row(q);
    return std::all_of(bound.begin(), bound.end(),
                       [&](Index j) { return std::find(stencil.begin(), stencil.end(), j) != stencil.end(); });
  };
  Interpolation out;
  for (std::size_t q = 0; q < points.count(); ++q) {
    const bool kept = isOwn(q);
    const Csr &from = kept ? points.phyxels : own;
    const GradientRows rows(rest.stencils, q);
    const double part = 1.0 / static_cast<double>(own.row(q).size());
    Vec3 middle = Vec3::Zero();
    for (const Index j : own.row(q)) middle += part * rest.positions[j];
    for (Index e = from.offsets[q]; e < from.offsets[q + 1]; ++e) {
      out.phyxels.indices.push_back(from.indices[e]);
      out.gradients.push_back(kept ? points.gradients[e] : rows[e]);
      out.weights.push_back(kept ? points.weights[e] : part + rows[e].dot(rest.pointCentres[q] - middle));
    }
    out.phyxels.offsets.push_back(static_cast<Index>(out.phyxels.indices.size()));
  }
  out.positions = std::move(points.positions);
  return out;
}

void interpolateScalars(const Interpolation &binding, std::span<const double> field, std::span<double> out,
                        const ParallelFor &parallelFor) {
  runLoop(parallelFor, out.size(), 4 * kPointGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      double sum = 0.0, low = std::numeric_limits<double>::infinity(), high = -low;
      for (Index e = binding.phyxels.offsets[p]; e < binding.phyxels.offsets[p + 1]; ++e) {
        const double value = field[binding.phyxels.indices[e]];
        sum += binding.weights[e] * value;
        low = std::min(low, value);
        high = std::max(high, value);
      }
      out[p] = low <= high ? std::clamp(sum, low, high) : 0.0;
    }
  });
}

}  // namespace pointbased
