// SPDX-License-Identifier: Apache-2.0
#include "pointbased/engine.h"

#include <algorithm>
#include <cmath>

namespace pointbased {
namespace {

constexpr std::size_t kGrain = 64;

// Rank-deficient stencils: x moves known directions of the frame only; fill in the others by rotation.
Mat3 completed(const Mat3 &F, int rank, const Mat3 &frame) {
  if (rank == 0) return Mat3::Identity();
  const Vec3 t1 = frame.col(0), t2 = frame.col(1), n = frame.col(2);
  const Vec3 a = F * t1;
  if (rank == 1) {
    const Mat3 R = Eigen::Quaterniond::FromTwoVectors(t1, a).toRotationMatrix();
    return a * t1.transpose() + R * (Mat3::Identity() - t1 * t1.transpose());
  }
  const Vec3 b = F * t2;
  const Vec3 normal = a.cross(b);
  const double length = normal.norm();
  const Vec3 m = length > 1e-12 * (a.squaredNorm() + b.squaredNorm()) ? Vec3(normal / length) : n;
  return a * t1.transpose() + b * t2.transpose() + m * n.transpose();
}

// The stiffness that scales the stabilisation of a point, N/m.
double stabilisationScale(const Material &material, double stabilisation, double volume) {
  return stabilisation * material.youngsModulus * volume;
}

// What the affine fit of a point misses at one of its entries, as the force per weight and its energy.
struct Residual {
  Vec3 direction;  // dU/dx_k = scale * weight * direction
  double squared;
};

Residual residual(int rank, const Mat3 &frame, const Mat3 &F, const Vec3 &rest, const Vec3 &now) {
  if (rank == 1) {
    const Vec3 a = F * frame.col(0);
    const double length = a.norm();
    if (!(length > 0.0)) return {Vec3::Zero(), 0.0};
    const Vec3 axis = a / length;
    const double r = now.dot(axis) - length * rest.dot(frame.col(0));
    return {r * axis, r * r};
  }
  const Vec3 r = now - F * rest;
  return {r, r.squaredNorm()};
}

// dU_q/dF of the stabilisation: zero for a full stencil, whose fit is orthogonal to what it misses; for a flat one the
// completed column and the axis turn with F.
Mat3 residualStress(const StencilSet &s, std::size_t q, double scale, std::span<const Vec3> X, std::span<const Vec3> u,
                    const Mat3 &F) {
  const Mat3 &frame = s.frames[s.frameOf[q]];
  const Index first = s.phyxels.offsets[q], last = s.phyxels.offsets[q + 1];
  const Index anchor = s.phyxels.indices[first];
  const Vec3 t1 = frame.col(0), t2 = frame.col(1), n = frame.col(2);
  const Vec3 a = F * t1, b = F * t2;
  if (s.rank[q] == 1) {
    const double length = a.norm();
    if (!(length > 0.0)) return Mat3::Zero();
    const Vec3 axis = a / length;
    Vec3 da = Vec3::Zero();
    for (Index e = first + 1; e < last; ++e) {
      const Index k = s.phyxels.indices[e];
      const Vec3 rest = X[k] - X[anchor];
      const Vec3 now = rest + (u[k] - u[anchor]);
      const double r = now.dot(axis) - length * rest.dot(t1);
      da += s.weights[e] * r * ((now - axis * axis.dot(now)) / length - axis * rest.dot(t1));
    }
    return scale * da * t1.transpose();
  }
  const Vec3 normal = a.cross(b);
  const double length = normal.norm();
  if (!(length > 1e-12 * (a.squaredNorm() + b.squaredNorm()))) return Mat3::Zero();
  const Vec3 m = normal / length;
  Vec3 y = Vec3::Zero();
  for (Index e = first + 1; e < last; ++e) {
    const Index k = s.phyxels.indices[e];
    const Vec3 rest = X[k] - X[anchor];
    const Vec3 now = rest + (u[k] - u[anchor]);
    y -= s.weights[e] * rest.dot(n) * (now - F * rest);
  }
  y -= m * m.dot(y);
  return scale / length * (b.cross(y) * t1.transpose() + y.cross(a) * t2.transpose());
}

const Mat3 &frameOfPoint(const StencilSet &s, std::size_t q) {
  static const Mat3 identity = Mat3::Identity();
  return s.frameOf[q] == StencilSet::kNoFrame ? identity : s.frames[s.frameOf[q]];
}

Mat3 fittedGradient(const StencilSet &s, std::size_t q, std::span<const Vec3> field) {
  const Index first = s.phyxels.offsets[q], last = s.phyxels.offsets[q + 1];
  const Vec3 anchor = field[s.phyxels.indices[first]];
  Mat3 G = Mat3::Zero();
  for (Index e = first + 1; e < last; ++e) G += (field[s.phyxels.indices[e]] - anchor) * s.gradients[e].transpose();
  return G;
}

}  // namespace

void deformationGradients(const StencilSet &s, std::span<const Vec3> displacements, std::span<Mat3> gradients,
                          const ParallelFor &parallelFor) {
  parallelFor(s.pointCount(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t q = begin; q < end; ++q) {
      Mat3 F = fittedGradient(s, q, displacements) + Mat3::Identity();
      if (s.rank[q] < 3) F = completed(F, s.rank[q], frameOfPoint(s, q));
      gradients[q] = F;
    }
  });
}

void gradientRates(const StencilSet &s, std::span<const Vec3> velocities, std::span<Mat3> rates,
                   const ParallelFor &parallelFor) {
  parallelFor(s.pointCount(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t q = begin; q < end; ++q) rates[q] = fittedGradient(s, q, velocities);
  });
}

double stresses(const Material &material, const StencilSet &s, std::span<const Mat3> gradients, std::span<const Mat3> rates,
                std::span<Mat3> out, std::span<double> tangentRatios, const ParallelFor &parallelFor) {
  parallelFor(s.pointCount(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t q = begin; q < end; ++q) {
      const Mat3 &F = gradients[q];
      Mat3 P = firstPiolaStress(material, F);
      if (!rates.empty()) {
        const Mat3 FtR = F.transpose() * rates[q];
        Mat3 strainRate = 0.5 * (FtR + FtR.transpose());
        if (s.rank[q] < 3) {
          // A turning patch does not strain: only the directions of the stencil count.
          const Mat3 t = frameOfPoint(s, q).leftCols(s.rank[q]) * frameOfPoint(s, q).leftCols(s.rank[q]).transpose();
          strainRate = t * strainRate * t;
        }
        P += F * (2.0 * material.viscosity * strainRate);
      }
      out[q] = s.volumes[q] * P;
      tangentRatios[q] = tangentRatio(material, F);
    }
  });
  double largest = 1.0;
  for (const double ratio : tangentRatios) {
    // A NaN must not be lost in the comparison.
    if (!(ratio <= largest)) largest = ratio;
  }
  return largest;
}

void internalForces(const Material &material, double stabilisation, const StencilSet &s, std::span<const Vec3> X,
                    std::span<const Vec3> u, std::span<const Mat3> gradients, std::span<const Mat3> pointStresses,
                    std::span<Vec3> entryForces, std::span<Vec3> forces, const ParallelFor &parallelFor) {
  // What every point does to the phyxels of its stencil; the anchor takes the opposite of the sum.
  parallelFor(s.pointCount(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t q = begin; q < end; ++q) {
      const Index first = s.phyxels.offsets[q], last = s.phyxels.offsets[q + 1];
      const Index anchor = s.phyxels.indices[first];
      const Mat3 &F = gradients[q];
      const double scale = stabilisationScale(material, stabilisation, s.volumes[q]);
      const bool stabilised = scale > 0.0 && s.rank[q] > 0;
      Mat3 stress = pointStresses[q];
      if (stabilised && s.rank[q] < 3) stress += residualStress(s, q, scale, X, u, F);
      Vec3 sum = Vec3::Zero();
      for (Index e = first + 1; e < last; ++e) {
        const Index k = s.phyxels.indices[e];
        Vec3 f = -(stress * s.gradients[e]);
        if (stabilised) {
          const Vec3 rest = X[k] - X[anchor];
          const Vec3 now = rest + (u[k] - u[anchor]);
          f -= scale * s.weights[e] * residual(s.rank[q], frameOfPoint(s, q), F, rest, now).direction;
        }
        entryForces[e] = f;
        sum += f;
      }
      entryForces[first] = -sum;
    }
  });

  parallelFor(forces.size(), 4 * kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t j = begin; j < end; ++j) {
      Vec3 f = Vec3::Zero();
      for (Index k = s.entriesOfPhyxel.offsets[j]; k < s.entriesOfPhyxel.offsets[j + 1]; ++k)
        f += entryForces[s.entriesOfPhyxel.indices[k]];
      forces[j] = f;
    }
  });
}

ElasticEnergy elasticEnergy(const Material &material, double stabilisation, const StencilSet &s, std::span<const Vec3> X,
                            std::span<const Vec3> u, std::span<const Mat3> gradients) {
  ElasticEnergy energy;
  for (std::size_t q = 0; q < s.pointCount(); ++q) {
    energy.strain += s.volumes[q] * energyDensity(material, gradients[q]);
    if (s.rank[q] == 0) continue;
    const Index first = s.phyxels.offsets[q];
    const Index anchor = s.phyxels.indices[first];
    double sum = 0.0;
    for (Index e = first + 1; e < s.phyxels.offsets[q + 1]; ++e) {
      const Index k = s.phyxels.indices[e];
      const Vec3 rest = X[k] - X[anchor];
      const Vec3 now = rest + (u[k] - u[anchor]);
      sum += s.weights[e] * residual(s.rank[q], frameOfPoint(s, q), gradients[q], rest, now).squared;
    }
    energy.stabilisation += 0.5 * stabilisationScale(material, stabilisation, s.volumes[q]) * sum;
  }
  return energy;
}

double largestFrequency(const Material &material, double stabilisation, const StencilSet &s, std::span<const Vec3> X,
                        std::span<const double> masses, const ParallelFor &parallelFor) {
  const std::size_t n = X.size();
  if (n < 2) return 0.0;
  // At rest the stress is linear in the displacement gradient: P = lambda tr(eps) I + 2 mu eps.
  std::vector<Vec3> mode(n), force(n), entryForces(s.phyxels.indices.size());
  std::vector<Mat3> gradients(s.pointCount()), pointStresses(s.pointCount());
  std::uint64_t state = 0x9e3779b97f4a7c15ull;
  for (Vec3 &v : mode)
    for (int c = 0; c < 3; ++c) {
      state = state * 6364136223846793005ull + 1442695040888963407ull;
      v[c] = static_cast<double>(state >> 40) / static_cast<double>(1u << 24) - 0.5;
    }

  // Rank-deficient stencils: the linearised completion turns the normal with the patch, which r_qk then sees to first
  // order; evaluated through the same nonlinear functions at a displacement small against every stencil.
  double shortest = 1e300;
  for (std::size_t q = 0; q < s.pointCount(); ++q)
    for (Index e = s.phyxels.offsets[q] + 1; e < s.phyxels.offsets[q + 1]; ++e)
      if (const double d = (X[s.phyxels.indices[e]] - X[s.phyxels.indices[s.phyxels.offsets[q]]]).norm(); d > 0.0)
        shortest = std::min(shortest, d);
  if (!(shortest < 1e300)) return 0.0;
  const double amplitude = 1e-6 * shortest;

  double eigenvalue = 0.0;
  std::vector<Vec3> displacement(n);
  constexpr int kIterations = 60;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    double largest = 0.0;
    for (const Vec3 &v : mode) largest = std::max(largest, v.norm());
    if (!(largest > 0.0)) return 0.0;
    for (std::size_t i = 0; i < n; ++i) displacement[i] = mode[i] * (amplitude / largest);
    deformationGradients(s, displacement, gradients, parallelFor);
    parallelFor(s.pointCount(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t q = begin; q < end; ++q) {
        const Mat3 G = gradients[q] - Mat3::Identity();
        const Mat3 eps = 0.5 * (G + G.transpose());
        pointStresses[q] =
            s.volumes[q] * (material.lambda() * eps.trace() * Mat3::Identity() + 2.0 * material.mu() * eps);
      }
    });
    internalForces(material, stabilisation, s, X, displacement, gradients, pointStresses, entryForces, force, parallelFor);
    // Rayleigh quotient in the mass norm, then the next vector M^-1 K u.
    double top = 0.0, bottom = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      top -= displacement[i].dot(force[i]);
      bottom += masses[i] * displacement[i].squaredNorm();
    }
    eigenvalue = std::max(eigenvalue, top / bottom);
    for (std::size_t i = 0; i < n; ++i) mode[i] = -force[i] / masses[i];
  }
  return std::sqrt(std::max(0.0, eigenvalue));
}

}  // namespace pointbased
