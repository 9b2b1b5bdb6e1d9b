// SPDX-License-Identifier: Apache-2.0
#include "pointbased/engine.h"

#include "base/expects.h"
#include "base/symmetric_eigen.h"
#include "forces/point_stiffness.h"

namespace pointbased {

using namespace detail;

namespace {

// Replaces the eigenvalues of a symmetric block by their magnitudes, none below a small fraction of the largest.
Mat3 positiveDefinite(const Mat3 &block) {
  constexpr double kSmallest = 1e-6;
  const SymmetricEigen eigen = symmetricEigen(symmetric(block));
  const Vec3 &values = eigen.values;
  const double largest = values.cwiseAbs().maxCoeff();
  if (!(largest > 0.0)) return Mat3::Identity();
  if (values[0] >= kSmallest * largest) return block;
  return eigen.with(values.cwiseAbs().cwiseMax(kSmallest * largest));
}

}  // namespace

void stiffnessBlocks(const Constitution &constitution, const StencilSet &s, std::span<const Vec3> X,
                     std::span<const Vec3> u, std::span<const Mat3> gradients, const PointHistory &history, double dt,
                     double viscousScale, std::span<Mat3> blocks, const ParallelFor &parallelFor) {
  POINTBASED_EXPECTS(!constitution.materials.empty(), "a material");
  POINTBASED_EXPECTS(X.size() == s.entriesOfPhyxel.rows() && u.size() == X.size(),
                     "one position and one displacement per phyxel");
  POINTBASED_EXPECTS(gradients.size() == s.pointCount(), "one gradient per evaluation point");
  POINTBASED_EXPECTS(blocks.size() == X.size(), "one block per phyxel");
  std::vector<Mat3> ofEntries(s.phyxels.indices.size());
  runLoop(parallelFor, s.pointCount(), kPointGrain, [&](std::size_t begin, std::size_t end) {
    forMaterialRuns(constitution, s, begin, end, [&](const Material &material, std::size_t from, std::size_t to) {
      const PointResponse response(material, s, history, dt, viscousScale > 0.0);
      for (std::size_t q = from; q < to; ++q) {
        const PointStiffness point(constitution, s, q, X, u, gradients, response, viscousScale);
        for (Index e = point.first(); e < point.last(); ++e) {
          const PointStiffness::Entry entry = point.entry(e);
          ofEntries[e] = point.block(e, entry, e, entry);
          ofEntries[e].diagonal().array() += point.curvature(e);
        }
      }
    });
  });
  gather<Mat3>(s, ofEntries, blocks, parallelFor);
  for (Mat3 &block : blocks) block = positiveDefinite(block);
}

void stiffnessTriplets(const Constitution &constitution, const StencilSet &s, std::span<const Vec3> X,
                       std::span<const Vec3> u, std::span<const Mat3> gradients, const PointHistory &history, double dt,
                       double viscousScale, std::vector<Eigen::Triplet<double>> &out) {
  POINTBASED_EXPECTS(!constitution.materials.empty(), "a material");
  POINTBASED_EXPECTS(X.size() == s.entriesOfPhyxel.rows() && u.size() == X.size(),
                     "one position and one displacement per phyxel");
  POINTBASED_EXPECTS(gradients.size() == s.pointCount(), "one gradient per evaluation point");
  out.clear();
  std::size_t count = 0;
  for (std::size_t q = 0; q < s.pointCount(); ++q) {
    const std::size_t entries = s.phyxels.offsets[q + 1] - s.phyxels.offsets[q];
    count += 9 * entries * entries;
  }
  out.reserve(count);
  std::vector<PointStiffness::Entry> entries;
  forMaterialRuns(constitution, s, 0, s.pointCount(), [&](const Material &material, std::size_t from, std::size_t to) {
    const PointResponse response(material, s, history, dt, viscousScale > 0.0);
    for (std::size_t q = from; q < to; ++q) {
      PointStiffness point(constitution, s, q, X, u, gradients, response, viscousScale);
      point.makePositive();
      const Index first = point.first();
      const std::size_t n = point.last() - first;
      entries.resize(n);
      for (std::size_t j = 0; j < n; ++j) entries[j] = point.entry(first + static_cast<Index>(j));
      for (std::size_t j = 0; j < n; ++j)
        for (std::size_t l = 0; l <= j; ++l) {
          const Index ej = first + static_cast<Index>(j), el = first + static_cast<Index>(l);
          const Mat3 K = point.block(ej, entries[j], el, entries[l]);
          const int row = static_cast<int>(3 * s.phyxels.indices[ej]),
                    column = static_cast<int>(3 * s.phyxels.indices[el]);
          for (int c = 0; c < 3; ++c)
            for (int r = 0; r < 3; ++r) {
              out.emplace_back(row + r, column + c, K(r, c));
              if (l != j) out.emplace_back(column + c, row + r, K(r, c));
            }
        }
    }
  });
}

}  // namespace pointbased
