// SPDX-License-Identifier: Apache-2.0
#include "pointbased/error_estimate.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "forces/point_loops.h"
#include "forces/quadratic_energy.h"
#include "pointbased/singular_regions.h"

namespace pointbased {

using namespace detail;

namespace {

using Strain = ErrorScratch::Strain;
using Slopes = ErrorScratch::Slopes;
using Moments = ErrorScratch::Moments;

Strain packed(const Mat3 &E) {
  Strain out;
  out << E(0, 0), E(1, 1), E(2, 2), 0.5 * (E(1, 2) + E(2, 1)), 0.5 * (E(0, 2) + E(2, 0)), 0.5 * (E(0, 1) + E(1, 0));
  return out;
}

/// ½ e : C : e with the moduli at rest, J/m³; for a slope, J/m⁵.
double energyOf(const Material &material, const Strain &e) {
  const double trace = e[0] + e[1] + e[2];
  return material.mu() * (e.head<3>().squaredNorm() + 2.0 * e.tail<3>().squaredNorm()) +
         0.5 * (material.lambda() + material.volumeStiffness) * trace * trace;
}

void add(Moments &m, double volume, const Vec3 &x, const Strain &e) {
  m.volume += volume;
  m.first += volume * x;
  m.second += (volume * x) * x.transpose();
  const Strain ve = volume * e;
  m.strain += ve;
  m.strainFirst += ve * x.transpose();
}

/// Adds moments about another position; d points from here to there.
void add(Moments &m, const Moments &other, const Vec3 &d) {
  m.volume += other.volume;
  m.first += other.first + other.volume * d;
  const Mat3 mixed = d * other.first.transpose();
  m.second += other.second + mixed + mixed.transpose() + (other.volume * d) * d.transpose();
  m.strain += other.strain;
  m.strainFirst += other.strainFirst + other.strain * d.transpose();
}

/// Strain slopes within a cell from its hourglass modes: linear in plane stress, as in HourglassEnergy.
Slopes hourglassSlopes(const Material &material, const StencilSet &s, std::size_t q, const Mat3 &F,
                       std::span<const Vec3> displacements) {
  const Amplitudes all = amplitudes(s, q, displacements);
  const Mat3 turn = material.law == MaterialLaw::linear ? s.axes : Mat3(F * s.axes);
  const Mat3 B = turn.transpose() * all.topLeftCorner<3, 3>();
  if (const QuadraticPoints::Point *quadratic = s.quadratic.find(q)) {
    const Mat3 bends = turn.transpose() * bendsOf(s, q, *quadratic, displacements);
    Slopes out;
    for (int a = 0; a < 3; ++a) {
      Mat3 slope;
      for (int j = 0; j < 3; ++j) slope.col(j) = a == j ? bends.col(a) : B.col(a + j - 1);
      out.col(a) = packed(slope);
    }
    return out;
  }
  const double lambda = material.lambda() + material.volumeStiffness;
  const double across = -lambda / (lambda + 2.0 * material.mu());
  Slopes out;
  out.col(0) << across * (B(1, 0) + B(2, 1)), B(1, 0), B(2, 1), 0.5 * (B(2, 0) + B(1, 1)), 0.0, 0.0;
  out.col(1) << B(0, 0), across * (B(0, 0) + B(2, 2)), B(2, 2), 0.0, 0.5 * (B(2, 0) + B(0, 2)), 0.0;
  out.col(2) << B(0, 1), B(1, 2), across * (B(0, 1) + B(1, 2)), 0.0, 0.0, 0.5 * (B(1, 1) + B(0, 2));
  return out;
}

/// Variance of the points around, relative to that of the widest direction or to the squared size of the point.
/// Directions with less determine no slope. Two layers have a variance of 0.22 d², the interior of a lattice 0.5 d².
/// Larger: more directions are ignored.
constexpr double kUnseen = 0.05;

struct Fit {
  Strain value;  ///< at the point
  Slopes slopes;
};

/// Affine fit to the strains around a point, about which the moments are taken. In undetermined directions the slope is
/// `own`.
/// @param size  size of the region that the point represents, m
Fit fit(const Moments &m, const Slopes &own, double size) {
  const Vec3 mean = m.first / m.volume;
  const Strain meanStrain = m.strain / m.volume;
  const Mat3 variance = m.second / m.volume - mean * mean.transpose();
  const Slopes covariance = m.strainFirst / m.volume - meanStrain * mean.transpose();
  Eigen::SelfAdjointEigenSolver<Mat3> solver;
  solver.computeDirect(variance);
  Mat3 inverse = Mat3::Zero(), unseen = Mat3::Zero();
  const double least = kUnseen * std::max(solver.eigenvalues()[2], size * size);
  for (int a = 0; a < 3; ++a) {
    const Vec3 direction = solver.eigenvectors().col(a);
    const double value = solver.eigenvalues()[a];
    if (value > least) {
      inverse += (direction / value) * direction.transpose();
    } else {
      unseen += direction * direction.transpose();
    }
  }
  Fit out;
  out.slopes = covariance * inverse + own * unseen;
  out.value = meanStrain - out.slopes * mean;
  return out;
}

/// Marks a phyxel whose surrounding points have several materials: moments are summed again for each material.
constexpr double kMixed = -1.0;

class Recovery {
 public:
  Recovery(const Body &body, ErrorScratch &scratch)
      : body_(body), gradients_(body.gradients()), s_(body.rest().stencils), scratch_(scratch),
        lattice_(s_.isLattice()) {}

  void strains(std::size_t begin, std::size_t end) {
    const auto &plastic = body_.state().history.plasticInverse;
    const Mat3 &Q = s_.axes;
    for (std::size_t q = begin; q < end; ++q) {
      const Material &material = materialOfPoint(body_.constitution(), s_, q);
      Mat3 F = gradients_[q];
      if (!plastic.empty() && material.plastic.enabled()) F = F * plastic[q];
      const Mat3 E = material.law == MaterialLaw::linear ? Mat3(F - Mat3::Identity()) : greenStrain(F);
      scratch_.strains[q] = packed(Q.transpose() * E * Q);
      scratch_.centres[q] = Q.transpose() * body_.rest().pointCentres[q];
    }
  }

  void moments(std::size_t begin, std::size_t end) {
    for (std::size_t j = begin; j < end; ++j) {
      Moments &m = scratch_.moments[j];
      m = Moments();
      const Index first = s_.entriesOfPhyxel.offsets[j], last = s_.entriesOfPhyxel.offsets[j + 1];
      if (first == last) continue;
      const std::uint16_t material = materialIndex(s_.pointOfEntry(s_.entriesOfPhyxel.indices[first]));
      bool mixed = false;
      for (Index k = first + 1; k < last && !mixed; ++k) {
        const Index entry = s_.entriesOfPhyxel.indices[k], q = s_.pointOfEntry(entry);
        mixed = s_.isCorner(entry, q) && materialIndex(q) != material;
      }
      if (mixed) {
        m.volume = kMixed;
      } else {
        addAround(m, j, material, position(j));
      }
    }
  }

  void errors(std::size_t begin, std::size_t end) {
    for (std::size_t q = begin; q < end; ++q) scratch_.errors[q] = errorOf(q);
  }

 private:
  [[nodiscard]] std::uint16_t materialIndex(std::size_t q) const { return s_.materials.empty() ? 0 : s_.materials[q]; }
  [[nodiscard]] Vec3 position(std::size_t j) const { return s_.axes.transpose() * body_.rest().positions[j]; }

  void addPoint(Moments &m, std::size_t q, std::uint16_t material, const Vec3 &about) const {
    if (s_.rank[q] == 3 && materialIndex(q) == material)
      add(m, s_.volumes[q], scratch_.centres[q] - about, scratch_.strains[q]);
  }
  void addAround(Moments &m, std::size_t j, std::uint16_t material, const Vec3 &about) const {
    for (Index k = s_.entriesOfPhyxel.offsets[j]; k < s_.entriesOfPhyxel.offsets[j + 1]; ++k) {
      const Index entry = s_.entriesOfPhyxel.indices[k], q = s_.pointOfEntry(entry);
      if (s_.isCorner(entry, q)) addPoint(m, q, material, about);
    }
  }

  [[nodiscard]] double errorOf(std::size_t q) const {
    if (s_.rank[q] < 3) return 0.0;
    const Material &material = materialOfPoint(body_.constitution(), s_, q);
    const std::uint16_t index = materialIndex(q);
    const Vec3 &centre = scratch_.centres[q];
    Moments around;
    for (Index e = s_.phyxels.offsets[q]; e < s_.phyxels.offsets[q + 1] && s_.isCorner(e, q); ++e) {
      const Index j = s_.phyxels.indices[e];
      if (!lattice_) {
        addPoint(around, j, index, centre);
      } else if (scratch_.moments[j].volume == kMixed) {
        addAround(around, j, index, centre);
      } else {
        add(around, scratch_.moments[j], position(j) - centre);
      }
    }
    Slopes own = Slopes::Zero();
    if (stabilisationOf(body_.constitution(), s_) == Stabilisation::hourglass)
      own = hourglassSlopes(material, s_, q, gradients_[q], body_.state().displacements);
    const double size = std::cbrt(s_.volumes[q]);
    const Fit better = fit(around, own, size);
    const Vec3 variances = lattice_ ? s_.variances[q] : Vec3(Vec3::Constant(size * size / 12.0));
    double density = energyOf(material, better.value - scratch_.strains[q]);
    for (int axis = 0; axis < 3; ++axis)
      density += variances[axis] * energyOf(material, better.slopes.col(axis) - own.col(axis));
    return s_.volumes[q] * density;
  }

  const Body &body_;
  std::span<const Mat3> gradients_;
  const StencilSet &s_;
  ErrorScratch &scratch_;
  bool lattice_;
};

/// Calls body(q, share) for the points in which phyxel j has a share. Cells are shared evenly by their phyxels; in a
/// cloud each phyxel has its own point.
template <class Body>
void forShares(const StencilSet &s, std::size_t j, Body &&body) {
  if (!s.isLattice()) return body(j, 1.0);
  for (Index k = s.entriesOfPhyxel.offsets[j]; k < s.entriesOfPhyxel.offsets[j + 1]; ++k) {
    const Index entry = s.entriesOfPhyxel.indices[k], q = s.pointOfEntry(entry);
    if (!s.isCorner(entry, q)) continue;
    const Index sharing =
        s.quadratic.find(q) != nullptr ? QuadraticPoints::kCorners : s.phyxels.offsets[q + 1] - s.phyxels.offsets[q];
    body(q, 1.0 / sharing);
  }
}

/// Energy of strains at the level of round-off, J.
double floorOf(const Body &body, std::size_t q) {
  const StencilSet &s = body.rest().stencils;
  const double modulus = materialOfPoint(body.constitution(), s, q).youngsModulus;
  return 0.5 * s.volumes[q] * modulus * kStrainFloor * kStrainFloor;
}

}  // namespace

ErrorEstimate estimateError(const Body &body, std::vector<double> *perPhyxel, ErrorScratch &scratch,
                            const ParallelFor &parallelFor) {
  const RestState &rest = body.rest();
  const StencilSet &s = rest.stencils;
  const std::size_t points = rest.pointCount(), phyxels = rest.phyxelCount();
  const bool lattice = s.isLattice();
  if (perPhyxel) perPhyxel->assign(phyxels, 0.0);
  ErrorEstimate out;
  scratch.strains.resize(points);
  scratch.centres.resize(points);
  scratch.errors.resize(points);
  scratch.energies.resize(points);
  scratch.moments.resize(lattice ? phyxels : 0);

  Recovery recovery(body, scratch);
  runLoop(parallelFor, points, kPointGrain, [&](std::size_t b, std::size_t e) { recovery.strains(b, e); });
  runLoop(parallelFor, scratch.moments.size(), kPointGrain,
          [&](std::size_t b, std::size_t e) { recovery.moments(b, e); });
  runLoop(parallelFor, points, kPointGrain, [&](std::size_t b, std::size_t e) { recovery.errors(b, e); });

  const ElasticEnergy elastic = body.elasticEnergy(scratch.energies);
  const double factor = lattice ? kLatticeErrorFactor : kCloudErrorFactor;
  double error = 0.0, floor = 0.0, volume = 0.0;
  for (std::size_t q = 0; q < points; ++q) {
    scratch.errors[q] *= factor * factor;
    error += scratch.errors[q];
    floor += floorOf(body, q);
    volume += s.volumes[q];
  }
  // Round-off may make the energy of an almost unstrained body negative.
  const double energy = std::max(elastic.strain, 0.0) + elastic.stabilisation;
  const double whole = energy + error + floor;
  if (!std::isfinite(whole)) return {1.0, 1.0};
  if (!(whole > 0.0)) return out;
  out.relative = std::sqrt(error / whole);
  out.stabilisationShare = elastic.stabilisation / (energy + floor);
  if (!perPhyxel) return out;

  for (std::size_t j = 0; j < phyxels; ++j) {
    double errorHere = 0.0, volumeHere = 0.0;
    forShares(s, j, [&](std::size_t q, double share) {
      errorHere += share * scratch.errors[q];
      volumeHere += share * s.volumes[q];
    });
    if (volumeHere > 0.0) (*perPhyxel)[j] = std::sqrt(errorHere / volumeHere * volume / whole);
  }
  return out;
}

void stabilisationShares(const Body &body, const ErrorScratch &scratch, std::vector<double> &perPhyxel) {
  const StencilSet &s = body.rest().stencils;
  perPhyxel.assign(body.rest().phyxelCount(), 0.0);
  for (std::size_t j = 0; j < perPhyxel.size(); ++j) {
    double stabilisation = 0.0, whole = 0.0;
    forShares(s, j, [&](std::size_t q, double share) {
      stabilisation += share * scratch.energies[q][1];
      whole += share * (std::max(scratch.energies[q][0], 0.0) + scratch.energies[q][1] + floorOf(body, q));
    });
    if (!std::isfinite(whole)) {
      perPhyxel[j] = 1.0;
    } else if (whole > 0.0) {
      perPhyxel[j] = stabilisation / whole;
    }
  }
}

double relativeErrorOutside(const Body &body, const ErrorScratch &scratch, const SingularRegions &places) {
  double error = 0.0, whole = 0.0;
  for (std::size_t q = 0; q < scratch.errors.size(); ++q) {
    if (places.points[q] != 0) continue;
    error += scratch.errors[q];
    whole += scratch.errors[q] + std::max(scratch.energies[q][0], 0.0) + scratch.energies[q][1] + floorOf(body, q);
  }
  if (!std::isfinite(whole)) return 1.0;
  return whole > 0.0 ? std::sqrt(error / whole) : 0.0;
}

ErrorEstimate estimateError(const Body &body, std::vector<double> *perPhyxel) {
  ErrorScratch scratch;
  return estimateError(body, perPhyxel, scratch, serialFor());
}

}  // namespace pointbased
