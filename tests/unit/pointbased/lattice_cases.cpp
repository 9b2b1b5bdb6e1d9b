// SPDX-License-Identifier: Apache-2.0
#include "lattice_cases.h"

#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>
#include <atomic>
#include <numeric>
#include <thread>

#include "surfaces.h"

namespace lattice_cases {

LatticeBody filled(const BodyShape &shape, const LatticeSampling &sampling, const ParallelFor &parallelFor) {
  auto body = fillLattice(shape, sampling, parallelFor);
  if (!body) throw std::runtime_error(body.error());
  return std::move(*body);
}

LatticeSampling withSpacing(double spacing) { return LatticeSampling{.spacing = spacing}; }

BodyShape box(const Vec3 &min, const Vec3 &max) { return shapes::box(min, max, 1); }

BodyShape ball(const Vec3 &centre, double radius) {
  BodyShape shape = shapes::ball(centre, radius);
  shape.surface = shapes::ballSurface(centre, radius, 48);
  return shape;
}

BodyShape together(const BodyShape &a, const BodyShape &b) {
  BodyShape shape;
  shape.min = a.min.cwiseMin(b.min);
  shape.max = a.max.cwiseMax(b.max);
  shape.volume = a.volume + b.volume;
  shape.inside = [=](std::span<const Vec3> points, std::span<double> inside) {
    std::vector<double> other(points.size());
    a.inside(points, inside);
    b.inside(points, other);
    for (std::size_t i = 0; i < points.size(); ++i) inside[i] = std::max(inside[i], other[i]);
  };
  shape.surfaceDistance = [=](std::span<const Vec3> points, std::span<double> distances) {
    std::vector<double> other(points.size());
    a.surfaceDistance(points, distances);
    b.surfaceDistance(points, other);
    for (std::size_t i = 0; i < points.size(); ++i) distances[i] = std::min(distances[i], other[i]);
  };
  shape.crosses = [=](std::span<const Vec3> from, std::span<const Vec3> to, std::span<std::uint8_t> crosses) {
    std::vector<double> first(from.size()), second(from.size());
    a.inside(from, first);
    a.inside(to, second);
    for (std::size_t i = 0; i < from.size(); ++i) crosses[i] = (first[i] > 0.5) != (second[i] > 0.5) ? 1 : 0;
  };
  shape.surface = shapes::joined(a.surface, b.surface);
  return shape;
}

BodyShape shifted(const BodyShape &shape, double spacing, const Vec3 &shift) {
  BodyShape result = shape;
  for (int a = 0; a < 3; ++a) {
    // The lattice is centred on the bounds: one cell more shifts it by half a cell, wider bounds by the rest.
    const double off = (shift[a] - 0.5) * spacing;
    (off < 0.0 ? result.min : result.max)[a] += 2.0 * off;
  }
  return result;
}

Mat3 rotation(int axis, double degrees) {
  return Eigen::AngleAxisd(degrees * EIGEN_PI / 180.0, Vec3::Unit(axis)).toRotationMatrix();
}

double sum(std::span<const double> values) { return std::accumulate(values.begin(), values.end(), 0.0); }

ParallelFor threadedFor(std::size_t threads) {
  return [threads](std::size_t n, std::size_t grain, const std::function<void(std::size_t, std::size_t)> &body) {
    std::atomic<std::size_t> next{0};
    std::vector<std::thread> pool;
    for (std::size_t t = 0; t < threads; ++t)
      pool.emplace_back([&] {
        for (std::size_t begin = next.fetch_add(grain); begin < n; begin = next.fetch_add(grain))
          body(begin, std::min(n, begin + grain));
      });
    for (std::thread &t : pool) t.join();
  };
}

Consistency consistencyOf(const LatticeBody &body) {
  Consistency worst;
  const StencilSet &s = body.stencils;
  const double h = body.spacing;
  for (std::size_t q = 0; q < s.pointCount(); ++q) {
    Vec3 sum = Vec3::Zero();
    Mat3 moment = Mat3::Zero();
    Eigen::Vector4d modes = Eigen::Vector4d::Zero();
    Eigen::Matrix<double, 4, 3> modeMoments = Eigen::Matrix<double, 4, 3>::Zero();
    for (Index e = s.phyxels.offsets[q]; e < s.phyxels.offsets[q + 1]; ++e) {
      const Vec3 X = body.positions[s.phyxels.indices[e]] - body.pointCentres[q];
      sum += s.gradients[e];
      moment += X * s.gradients[e].transpose();
      modes += s.modes[e];
      modeMoments += s.modes[e] * X.transpose();
    }
    const Eigen::Vector4d unit(h * h, h * h, h * h, h * h * h);
    worst.gradientSum = std::max(worst.gradientSum, h * sum.norm());
    worst.gradientMoment = std::max(worst.gradientMoment, (moment - Mat3::Identity()).norm());
    worst.modeSum = std::max(worst.modeSum, modes.cwiseProduct(unit).norm());
    worst.modeMoment = std::max(worst.modeMoment, (unit.asDiagonal() * modeMoments).norm() / h);
  }
  return worst;
}

double patchError(const LatticeBody &body, const BodyShape &shape) {
  std::vector<Vec3> difference(body.positions.size(), Vec3::Zero());
  const StencilSet &s = body.stencils;
  for (std::size_t q = 0; q < s.pointCount(); ++q)
    for (Index e = s.phyxels.offsets[q]; e < s.phyxels.offsets[q + 1]; ++e)
      difference[s.phyxels.indices[e]] += s.volumes[q] * s.gradients[e];
  SurfacePoints points = sampleSurface(shape.surface, body.spacing / 12.0, EverywhereRegion{});
  for (Vec3 &p : points.positions) p -= body.origin;
  const Interpolation bound = body.cells->bind(points.positions, points.normals, serialFor());
  for (std::size_t p = 0; p < points.count(); ++p)
    for (Index e = bound.phyxels.offsets[p]; e < bound.phyxels.offsets[p + 1]; ++e)
      difference[bound.phyxels.indices[e]] -= bound.weights[e] * points.areas[p] * points.normals[p];
  double worst = 0.0;
  for (const Vec3 &d : difference) worst = std::max(worst, d.norm() / (body.spacing * body.spacing));
  return worst;
}

double bindingError(const LatticeBody &body, std::span<const Vec3> points, std::span<const Vec3> normals) {
  const Interpolation bound = body.cells->bind(points, normals, serialFor());
  double worst = 0.0;
  for (std::size_t p = 0; p < points.size(); ++p) {
    double sum = -1.0;
    Vec3 place = Vec3::Zero(), gradient = Vec3::Zero();
    Mat3 moment = -Mat3::Identity();
    for (Index e = bound.phyxels.offsets[p]; e < bound.phyxels.offsets[p + 1]; ++e) {
      const Vec3 X = body.positions[bound.phyxels.indices[e]] - points[p];
      sum += bound.weights[e];
      place += bound.weights[e] * X;
      gradient += bound.gradients[e];
      moment += X * bound.gradients[e].transpose();
    }
    worst =
        std::max({worst, std::abs(sum), place.norm() / body.spacing, gradient.norm() * body.spacing, moment.norm()});
  }
  return worst;
}

LinearSolution solveLinear(const LatticeBody &body, const BodyShape &shape, const Region &loaded, const Vec3 &force,
                           double twist, double poissonRatio) {
  constexpr double kYoungsModulus = 1e4, kModal = 0.92;
  const double lambda = kYoungsModulus * poissonRatio / ((1.0 + poissonRatio) * (1.0 - 2.0 * poissonRatio));
  const double mu = 0.5 * kYoungsModulus / (1.0 + poissonRatio);
  const double plane = 2.0 * lambda * mu / (lambda + 2.0 * mu);
  const StencilSet &s = body.stencils;
  const std::size_t n = body.positions.size();
  std::vector<Eigen::Triplet<double>> entries;

  for (std::size_t q = 0; q < s.pointCount(); ++q) {
    const Index first = s.phyxels.offsets[q];
    const auto count = static_cast<Eigen::Index>(s.phyxels.offsets[q + 1] - first);
    Eigen::MatrixXd K = Eigen::MatrixXd::Zero(3 * count, 3 * count);
    // In lattice axes, rotated at the end.
    Eigen::MatrixXd g(3, count), modes(4, count);
    for (Eigen::Index k = 0; k < count; ++k) {
      g.col(k) = s.axes.transpose() * s.gradients[first + static_cast<Index>(k)];
      modes.col(k) = s.modes[first + static_cast<Index>(k)];
    }
    for (Eigen::Index j = 0; j < count; ++j)
      for (Eigen::Index k = 0; k < count; ++k)
        K.block<3, 3>(3 * j, 3 * k) += lambda * g.col(j) * g.col(k).transpose() + mu * g.col(k) * g.col(j).transpose() +
                                       mu * g.col(j).dot(g.col(k)) * Mat3::Identity();
    const auto mode = [&](int i, int j) { return modes.row(i + j - 1); };
    for (int axis = 0; axis < 3; ++axis) {
      const int p = axis == 0 ? 1 : 0, r = axis == 2 ? 1 : 2;
      Eigen::VectorXd pp = Eigen::VectorXd::Zero(3 * count), rr = pp, pr = pp;
      for (Eigen::Index k = 0; k < count; ++k) {
        pp[3 * k + p] = mode(p, axis)[k];
        rr[3 * k + r] = mode(r, axis)[k];
        pr[3 * k + r] = 0.5 * mode(p, axis)[k];
        pr[3 * k + p] = 0.5 * mode(r, axis)[k];
      }
      const Eigen::VectorXd trace = pp + rr;
      K += kModal * s.variances[q][axis] *
           (2.0 * mu * (pp * pp.transpose() + rr * rr.transpose() + 2.0 * pr * pr.transpose()) +
            plane * trace * trace.transpose());
    }
    const double h2 = body.spacing * body.spacing / 12.0;
    for (Eigen::Index j = 0; j < count; ++j)
      for (Eigen::Index k = 0; k < count; ++k)
        K.block<3, 3>(3 * j, 3 * k) += twist * kYoungsModulus * h2 * h2 * modes(3, j) * modes(3, k) * Mat3::Identity();
    for (Eigen::Index j = 0; j < count; ++j)
      for (Eigen::Index k = 0; k < count; ++k) {
        const Mat3 block = s.volumes[q] * s.axes * K.block<3, 3>(3 * j, 3 * k) * s.axes.transpose();
        const auto row = static_cast<int>(3 * s.phyxels.indices[first + static_cast<Index>(j)]);
        const auto column = static_cast<int>(3 * s.phyxels.indices[first + static_cast<Index>(k)]);
        for (int a = 0; a < 3; ++a)
          for (int b = 0; b < 3; ++b) entries.emplace_back(row + a, column + b, block(a, b));
      }
  }
  std::vector<std::uint8_t> fixed(n, 0);
  for (const ConstrainedRegion &held : body.held) {
    for (const Index i : held.phyxels) fixed[i] = 1;
    for (std::size_t p = 0; p < held.areas.size(); ++p) {
      const double stiffness = held.stiffness[p] * kYoungsModulus * held.areas[p] / body.spacing;
      for (Index e = held.rows.offsets[p]; e < held.rows.offsets[p + 1]; ++e)
        for (Index f = held.rows.offsets[p]; f < held.rows.offsets[p + 1]; ++f)
          for (int a = 0; a < 3; ++a)
            entries.emplace_back(static_cast<int>(3 * held.rows.indices[e]) + a,
                                 static_cast<int>(3 * held.rows.indices[f]) + a,
                                 stiffness * held.weights[e] * held.weights[f]);
    }
  }
  SurfacePoints points = sampleSurface(shape.surface, body.spacing / 6.0, loaded);
  for (Vec3 &p : points.positions) p -= body.origin;
  const Interpolation bound = body.cells->bind(points.positions, points.normals, serialFor());
  std::vector<double> mean(n, 0.0);
  double area = 0.0;
  for (const double a : points.areas) area += a;
  for (std::size_t p = 0; p < points.count(); ++p)
    for (Index e = bound.phyxels.offsets[p]; e < bound.phyxels.offsets[p + 1]; ++e)
      mean[bound.phyxels.indices[e]] += bound.weights[e] * points.areas[p] / area;

  std::vector<int> number(n, -1);
  int free = 0;
  for (std::size_t i = 0; i < n; ++i)
    if (fixed[i] == 0) number[i] = free++;
  std::vector<Eigen::Triplet<double>> kept;
  for (const auto &t : entries) {
    const int row = number[static_cast<std::size_t>(t.row()) / 3],
              column = number[static_cast<std::size_t>(t.col()) / 3];
    if (row >= 0 && column >= 0) kept.emplace_back(3 * row + t.row() % 3, 3 * column + t.col() % 3, t.value());
  }
  Eigen::SparseMatrix<double> K(3 * free, 3 * free);
  K.setFromTriplets(kept.begin(), kept.end());
  Eigen::VectorXd f = Eigen::VectorXd::Zero(3 * free);
  for (std::size_t i = 0; i < n; ++i)
    if (number[i] >= 0) f.segment<3>(3 * number[i]) = mean[i] * force;
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(K);
  const Eigen::VectorXd u = solver.solve(f);
  LinearSolution solution;
  solution.displacements.assign(n, Vec3::Zero());
  for (std::size_t i = 0; i < n; ++i)
    if (number[i] >= 0) solution.displacements[i] = u.segment<3>(3 * number[i]);
  for (std::size_t i = 0; i < n; ++i) solution.tip += mean[i] * solution.displacements[i].dot(force.normalized());
  return solution;
}

}  // namespace lattice_cases
