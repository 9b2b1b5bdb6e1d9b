// SPDX-License-Identifier: Apache-2.0
#include "engine_cases.h"

#include "forces/entry_forces.h"
#include "pointbased/lattice.h"

#include <Eigen/LU>
#include <algorithm>

namespace engine_cases {
namespace {

const double kSigns[8][3] = {{-1, -1, -1}, {1, -1, -1}, {-1, 1, -1}, {1, 1, -1},
                             {-1, -1, 1},  {1, -1, 1},  {-1, 1, 1},  {1, 1, 1}};

// Rows of the modes of one cell, projected off the affine fields.
void addModes(EngineCase &c, std::size_t first, double h) {
  StencilSet &s = c.stencils;
  Eigen::Vector4d mean = Eigen::Vector4d::Zero();
  Eigen::Matrix<double, 4, 3> moment = Eigen::Matrix<double, 4, 3>::Zero();
  Eigen::Vector4d signs[8];
  for (std::size_t j = 0; j < 8; ++j) {
    const double *k = kSigns[j];
    signs[j] = Eigen::Vector4d(k[0] * k[1] * 0.5 / (h * h), k[0] * k[2] * 0.5 / (h * h), k[1] * k[2] * 0.5 / (h * h),
                               k[0] * k[1] * k[2] / (h * h * h));
    mean += signs[j] / 8.0;
    moment += signs[j] * c.positions[s.phyxels.indices[first + j]].transpose();
  }
  Vec3 centre = Vec3::Zero();
  for (std::size_t j = 0; j < 8; ++j) centre += c.positions[s.phyxels.indices[first + j]] / 8.0;
  moment -= 8.0 * mean * centre.transpose();
  for (std::size_t j = 0; j < 8; ++j) s.modes.push_back(signs[j] - mean - moment * s.gradients[first + j]);
}

// g + the correction that restores Σ g = 0 and Σ X g^T = I after a disturbance.
void disturbGradients(EngineCase &c, std::size_t first, double amplitude, shapes::Random &random) {
  StencilSet &s = c.stencils;
  Vec3 centre = Vec3::Zero(), sum = Vec3::Zero();
  for (std::size_t j = first; j < first + 8; ++j) {
    s.gradients[j] += amplitude * random.vector();
    centre += c.positions[s.phyxels.indices[j]] / 8.0;
    sum += s.gradients[j] / 8.0;
  }
  Mat3 A = Mat3::Zero(), missing = Mat3::Identity();
  for (std::size_t j = first; j < first + 8; ++j) {
    const Vec3 d = c.positions[s.phyxels.indices[j]] - centre;
    s.gradients[j] -= sum;
    A += d * d.transpose();
    missing -= d * s.gradients[j].transpose();
  }
  for (std::size_t j = first; j < first + 8; ++j)
    s.gradients[j] += missing.transpose() * A.inverse() * (c.positions[s.phyxels.indices[j]] - centre);
}

EngineCase makeLattice(int nx, int ny, int nz, bool cut, double jitter) {
  EngineCase c;
  const double h = 0.01;
  c.spacing = h;
  c.stabilisation = kLatticeStabilisation;
  shapes::Random random(17);
  const Mat3 Q = Eigen::AngleAxisd(0.4, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  StencilSet &s = c.stencils;
  s.axes = Q;
  const auto corner = [&](int i, int j, int k) { return static_cast<Index>((k * (ny + 1) + j) * (nx + 1) + i); };
  for (int k = 0; k <= nz; ++k)
    for (int j = 0; j <= ny; ++j)
      for (int i = 0; i <= nx; ++i) c.positions.push_back(Q * (h * (Vec3(i, j, k) + jitter * random.vector())));
  c.masses.assign(c.phyxels(), 0.0);
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) {
        // The part of the cell that the body fills, in [-1, 1].
        const Eigen::Array3i at(i, j, k), end(nx - 1, ny - 1, nz - 1);
        Vec3 low(-1, -1, -1), high(1, 1, 1);
        for (int a = 0; a < 3; ++a) {
          if (cut && at[a] == 0) low[a] = 0.8 * random();
          if (cut && at[a] == end[a] && at[a] != 0) high[a] = 0.8 * random();
        }
        const Vec3 centre = 0.5 * (low + high), size = 0.5 * (high - low);
        const std::size_t first = s.phyxels.indices.size();
        const double volume = h * h * h * size.prod();
        for (const auto &sign : kSigns) {
          const Index p = corner(i + (sign[0] > 0), j + (sign[1] > 0), k + (sign[2] > 0));
          const Vec3 N(0.5 * (1 + sign[0] * centre[0]), 0.5 * (1 + sign[1] * centre[1]),
                       0.5 * (1 + sign[2] * centre[2]));
          s.phyxels.indices.push_back(p);
          s.gradients.push_back(Q * Vec3(sign[0] * N[1] * N[2], sign[1] * N[0] * N[2], sign[2] * N[0] * N[1]) / h);
          c.masses[p] += 1060.0 * volume * (0.75 * N.prod() + 0.25 / 8.0);
        }
        if (jitter > 0.0) disturbGradients(c, first, 0.1 / h, random);
        addModes(c, first, h);
        s.phyxels.offsets.push_back(static_cast<Index>(s.phyxels.indices.size()));
        s.volumes.push_back(volume);
        s.variances.push_back(h * h / 12.0 * size.cwiseAbs2());
        s.rank.push_back(3);
        s.frameOf.push_back(StencilSet::kNoFrame);
      }
  buildGather(s, c.phyxels());
  return c;
}

}  // namespace

bool EngineCase::full() const {
  return std::all_of(stencils.rank.begin(), stencils.rank.end(), [](std::uint8_t r) { return r == 3; });
}

EngineCase lattice(int nx, int ny, int nz, bool cut) {
  EngineCase c = makeLattice(nx, ny, nz, cut, 0.0);
  c.name = "lattice";
  return c;
}

EngineCase jitteredLattice() {
  EngineCase c = makeLattice(3, 2, 2, false, 0.15);
  c.name = "jittered lattice";
  return c;
}

EngineCase quadraticLattice() {
  LatticeSampling sampling;
  sampling.spacing = 0.01;
  sampling.order = LatticeOrder::quadratic;
  sampling.axes = Eigen::AngleAxisd(0.5, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  const auto body = fillLattice(shapes::box(Vec3(0, 0, 0), Vec3(0.027, 0.022, 0.02), 1), sampling, serialFor());
  EngineCase c;
  c.name = "lattice of second order";
  c.spacing = sampling.spacing;
  c.stabilisation = kLatticeStabilisation;
  c.stencils = body->stencils;
  c.positions = body->positions;
  for (const double v : body->volumes) c.masses.push_back(1060.0 * v);
  return c;
}

EngineCase cloud(std::string name, std::vector<Vec3> positions, double spacing) {
  EngineCase c;
  c.name = std::move(name);
  c.positions = std::move(positions);
  c.spacing = spacing;
  c.stabilisation = 0.2;
  Csr neighbors;
  const double support = 1.8 * spacing;
  for (std::size_t i = 0; i < c.phyxels(); ++i) {
    for (std::size_t j = 0; j < c.phyxels(); ++j)
      if (i != j && (c.positions[i] - c.positions[j]).norm() < support)
        neighbors.indices.push_back(static_cast<Index>(j));
    neighbors.offsets.push_back(static_cast<Index>(neighbors.indices.size()));
  }
  const std::vector<double> radii(c.phyxels(), support), volumes(c.phyxels(), spacing * spacing * spacing);
  c.stencils = buildPhyxelStencils(c.positions, neighbors, radii, volumes, serialFor());
  for (const double v : volumes) c.masses.push_back(1060.0 * v);
  return c;
}

const std::vector<EngineCase> &all() {
  static const std::vector<EngineCase> cases = [] {
    shapes::Random random(11);
    std::vector<Vec3> thick, sheet, line;
    for (int i = 0; i < 36; ++i) thick.push_back(0.01 * (Vec3(i % 3, i / 3 % 3, i / 9) + 0.2 * random.vector()));
    for (int i = 0; i < 16; ++i) sheet.push_back(0.01 * Vec3(i % 4 + 0.2 * random(), i / 4, 0.4 * (i / 4)));
    for (int i = 0; i < 6; ++i) line.push_back(0.01 * Vec3(i + 0.2 * random(), 0.3 * i, 0.0));
    return std::vector<EngineCase>{lattice(3, 2, 2),
                                   jitteredLattice(),
                                   quadraticLattice(),
                                   cloud("cloud", thick, 0.01),
                                   cloud("sheet", sheet, 0.01),
                                   cloud("line", line, 0.01),
                                   cloud("pair", {Vec3(0, 0, 0), Vec3(0.006, 0.008, 0)}, 0.01)};
  }();
  return cases;
}

Constitution constitution(const EngineCase &c, MaterialLaw law) {
  const Material material{.law = law, .youngsModulus = 6000.0, .poissonRatio = 0.4};
  return {{material}, c.stabilisation};
}

const char *nameOf(MaterialLaw law) {
  switch (law) {
    case MaterialLaw::linear: return "linear";
    case MaterialLaw::stVenantKirchhoff: return "St. Venant-Kirchhoff";
    case MaterialLaw::corotated: return "corotated";
    case MaterialLaw::custom: return "custom";
    case MaterialLaw::neoHookean: break;
  }
  return "neo-Hookean";
}

Evaluated evaluate(const EngineCase &c, const Constitution &constitution, std::span<const Vec3> u,
                   const PointHistory &history, double dt, std::span<const Vec3> velocities,
                   const ParallelFor &parallelFor) {
  const std::size_t points = c.stencils.pointCount();
  Evaluated out;
  out.gradients.resize(points);
  out.stresses.resize(points);
  out.ratios.resize(points);
  out.forces.resize(c.phyxels());
  std::vector<Vec3> entries(c.stencils.phyxels.indices.size());
  std::vector<Mat3> rates;
  deformationGradients(c.stencils, u, out.gradients, parallelFor);
  if (!velocities.empty()) {
    rates.resize(points);
    gradientRates(c.stencils, velocities, rates, parallelFor);
  }
  out.ratio = pointStresses(constitution, c.stencils, out.gradients, rates, history, dt, nullptr, out.stresses,
                            out.ratios, parallelFor);
  std::vector<HourglassStrain> relaxed(history.modes.size());
  if (!history.modes.empty())
    relaxModes(constitution, c.stencils, u, out.gradients, history, dt, nullptr, relaxed, parallelFor);
  detail::internalForcesOf(constitution, c.stencils, c.positions, u, out.gradients, out.stresses, relaxed, velocities,
                           entries, out.forces, parallelFor);
  return out;
}

ElasticEnergy energyAt(const EngineCase &c, const Constitution &constitution, std::span<const Vec3> u,
                       const PointHistory &history) {
  std::vector<Mat3> gradients(c.stencils.pointCount());
  deformationGradients(c.stencils, u, gradients, serialFor());
  return elasticEnergy(constitution, c.stencils, c.positions, u, gradients, history);
}

std::vector<Vec3> differential(const EngineCase &c, const Constitution &constitution, std::span<const Vec3> u,
                               std::span<const Vec3> du, const PointHistory &history, double dt, double viscousScale) {
  std::vector<Mat3> gradients(c.stencils.pointCount());
  deformationGradients(c.stencils, u, gradients, serialFor());
  std::vector<Vec3> df(c.phyxels());
  TangentScratch scratch;
  forceDifferential(constitution, c.stencils, c.positions, u, gradients, history, dt, viscousScale, du, scratch, df,
                    serialFor());
  return df;
}

std::vector<Vec3> displaced(const EngineCase &c, const Mat3 &A, const Vec3 &shift) {
  std::vector<Vec3> u;
  for (const Vec3 &X : c.positions) u.push_back(A * X + shift - X);
  return u;
}

std::vector<Vec3> noise(const EngineCase &c, double amplitude, std::uint64_t seed) {
  shapes::Random random(seed);
  std::vector<Vec3> field(c.phyxels());
  for (Vec3 &v : field) v = amplitude * random.vector();
  return field;
}

std::vector<Vec3> generalState(const EngineCase &c) {
  const Mat3 R = Eigen::AngleAxisd(0.8, Vec3(1, 1, 0).normalized()).toRotationMatrix();
  Mat3 A;
  A << 1.15, 0.1, 0.0, -0.05, 0.95, 0.1, 0.02, 0.0, 1.05;
  return plus(displaced(c, R * A, Vec3(0.3, -0.1, 0.2)), 0.1 * c.spacing, noise(c, 1.0, 5));
}

std::vector<Vec3> plus(std::span<const Vec3> a, double factor, std::span<const Vec3> b) {
  std::vector<Vec3> sum(a.begin(), a.end());
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += factor * b[i];
  return sum;
}

double dot(std::span<const Vec3> a, std::span<const Vec3> b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i].dot(b[i]);
  return sum;
}

}  // namespace engine_cases
