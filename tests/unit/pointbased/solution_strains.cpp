// SPDX-License-Identifier: Apache-2.0
#include "solution_strains.h"

#include <algorithm>

namespace solution_strains {

double energyOf(const Material &material, const Mat3 &E) {
  return material.mu() * E.squaredNorm() + 0.5 * material.lambda() * E.trace() * E.trace();
}

Samples samplesOf(const RestState &lattice) {
  Samples out;
  for (std::size_t q = 0; q < lattice.pointCount(); ++q)
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 sign(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
      const Vec3 away = lattice.stencils.variances[q].cwiseSqrt().cwiseProduct(sign);
      out.points.push_back(lattice.origin + lattice.pointCentres[q] + lattice.stencils.axes * away);
      out.volumes.push_back(lattice.stencils.volumes[q] / 8.0);
    }
  return out;
}

std::vector<Mat3> strainsAt(const Body &body, std::vector<Vec3> points, std::vector<std::size_t> *cells) {
  const RestState &rest = body.rest();
  const StencilSet &s = rest.stencils;
  const Material &material = body.material();
  for (Vec3 &x : points) x -= rest.origin;
  const Interpolation bound = rest.bind(points, {});
  std::vector<Mat3> out;
  out.reserve(points.size());
  if (cells) cells->clear();
  for (std::size_t p = 0; p < points.size(); ++p) {
    const Index *first = &bound.phyxels.indices[bound.phyxels.offsets[p]];
    const Index *last = first + (bound.phyxels.offsets[p + 1] - bound.phyxels.offsets[p]);
    std::size_t q = 0;
    if (!s.isLattice()) {
      q = *std::min_element(first, last, [&](Index a, Index b) {
        return (rest.positions[a] - points[p]).squaredNorm() < (rest.positions[b] - points[p]).squaredNorm();
      });
      out.push_back(greenStrain(body.gradients()[q]));
      if (cells) cells->push_back(q);
      continue;
    }
    // The cell that contains all phyxels that move the point; of several the one with the nearest centre.
    std::size_t most = 0;
    double nearest = 0.0;
    for (Index k = s.entriesOfPhyxel.offsets[*first]; k < s.entriesOfPhyxel.offsets[*first + 1]; ++k) {
      const Index candidate = s.pointOfEntry(s.entriesOfPhyxel.indices[k]);
      const Index *from = &s.phyxels.indices[s.phyxels.offsets[candidate]];
      const Index *to = from + (s.phyxels.offsets[candidate + 1] - s.phyxels.offsets[candidate]);
      const auto common =
          static_cast<std::size_t>(std::count_if(first, last, [&](Index j) { return std::find(from, to, j) != to; }));
      const double distance = (rest.pointCentres[candidate] - points[p]).norm();
      if (common > most || (common == most && distance < nearest)) {
        most = common;
        nearest = distance;
        q = candidate;
      }
    }
    const Mat3 &F = body.gradients()[q];
    Eigen::Matrix<double, 3, 4> a = Eigen::Matrix<double, 3, 4>::Zero();
    const ModeRows modes(s, q);
    for (Index e = s.phyxels.offsets[q]; e < s.phyxels.offsets[q + 1]; ++e)
      a += body.state().displacements[s.phyxels.indices[e]] * modes[e].transpose();
    const Mat3 B = (F * s.axes).transpose() * a.leftCols<3>();
    const Vec3 xi = s.axes.transpose() * (points[p] - rest.pointCentres[q]);
    const double across = -material.lambda() / (material.lambda() + 2.0 * material.mu());
    Mat3 E = Mat3::Zero();
    for (int z = 0; z < 3; ++z) {
      const int x = (z + 1) % 3, y = (z + 2) % 3;
      const auto mode = [](int i, int j) { return i + j - 1; };  // xy, xz, yz
      const double xx = B(x, mode(x, z)), yy = B(y, mode(y, z)), xy = 0.5 * (B(x, mode(y, z)) + B(y, mode(x, z)));
      E(x, x) += xx * xi[z];
      E(y, y) += yy * xi[z];
      E(z, z) += across * (xx + yy) * xi[z];
      E(x, y) += xy * xi[z];
      E(y, x) += xy * xi[z];
    }
    if (cells) cells->push_back(q);
    out.push_back(greenStrain(F) + s.axes * E * s.axes.transpose());
  }
  return out;
}

}  // namespace solution_strains
