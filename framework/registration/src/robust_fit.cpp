// SPDX-License-Identifier: Apache-2.0
#include "robust_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "motions.h"

namespace c3de::registration {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Cosine of the largest angle between the normals of a point and of its foot.
constexpr double kCompatible = 0.35;

/// The foot of a moved point; not found where normals are incompatible.
Foot footOf(const TargetSurface &target, const MovingPoints &moving, std::size_t i, const Mat4 &m, const Vec3 &at,
            double limit_mm, Feet feet) {
  Foot foot = feet == Feet::exact ? target.closest(at, limit_mm) : target.near(at);
  if (!foot.isFound || foot.distance > limit_mm) return {};
  if (!moving.normals.empty()) {
    const double along = dot(turned(m, moving.normals[i]), foot.normal);
    if ((moving.areNormalsOriented ? along : std::abs(along)) < kCompatible) return {};
  }
  return foot;
}

double tukey(double distance, double limit) {
  const double x = distance / limit;
  return x < 1.0 ? (1.0 - x * x) * (1.0 - x * x) : 0.0;
}

/// One equation: the foot moves along `direction` with a rotation about `centre` and a translation.
Vector6 rowOf(const Vec3 &at, const Vec3 &centre, const Vec3 &direction, double arm) {
  const Vec3 c = cross(at - centre, direction);
  Vector6 row;
  row << c[0] / arm, c[1] / arm, c[2] / arm, direction[0], direction[1], direction[2];
  return row;
}

struct Equations {
  Matrix6 matrix = Matrix6::Zero();
  Vector6 right = Vector6::Zero();

  void add(const Vector6 &row, double residual, double weight) {
    matrix += weight * row * row.transpose();
    right -= weight * residual * row;
  }
};

void addPairs(const MovingPoints &moving, const Mat4 &m, const Vec3 &centre, double arm, Equations &out) {
  static const std::array<Vec3, 3> kAxes{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  for (const LandmarkPair &pair : moving.pairs) {
    const Vec3 at = transformPoint(m, pair.measured_mm), d = at - pair.body_mm;
    for (std::size_t a = 0; a < 3; ++a) out.add(rowOf(at, centre, kAxes[a], arm), d[a], moving.pairWeight);
  }
}

/// Re-orthogonalised product, so that many small steps remain a rotation.
Mat4 stepped(const Mat4 &m, const Vec3 &rotation, const Vec3 &centre, const Vec3 &translation) {
  Mat4 out = multiply(withPoint(rotationOf(rotation), centre, centre + translation), m);
  Vec3 x{out[0], out[1], out[2]}, y{out[4], out[5], out[6]};
  x = (1.0 / norm(x)) * x;
  y = y - dot(x, y) * x;
  y = (1.0 / norm(y)) * y;
  const Vec3 z = cross(x, y);
  for (std::size_t a = 0; a < 3; ++a) out[a] = x[a], out[4 + a] = y[a], out[8 + a] = z[a];
  return out;
}

}  // namespace

MovingPoints MovingPoints::subset(std::span<const std::size_t> indices) const {
  MovingPoints out;
  out.areNormalsOriented = areNormalsOriented;
  out.pairs = pairs;
  out.pairWeight = pairWeight * static_cast<double>(indices.size()) / static_cast<double>(points.size());
  for (const std::size_t i : indices) {
    out.points.push_back(points[i]);
    if (!normals.empty()) out.normals.push_back(normals[i]);
  }
  return out;
}

std::vector<double> distancesOf(const TargetSurface &target, const MovingPoints &moving, const Mat4 &m, double limit_mm,
                                Feet feet) {
  std::vector<double> out(moving.points.size(), limit_mm);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const Foot foot = footOf(target, moving, i, m, transformPoint(m, moving.points[i]), limit_mm, feet);
    if (foot.isFound) out[i] = foot.distance;
  }
  return out;
}

double truncatedCost(const TargetSurface &target, const MovingPoints &moving, const Mat4 &m, double limit_mm,
                     Feet feet) {
  double sum = 0.0, count = static_cast<double>(moving.points.size());
  for (const double d : distancesOf(target, moving, m, limit_mm, feet)) sum += d * d;
  for (const LandmarkPair &pair : moving.pairs) {
    const double d = std::min(limit_mm, norm(transformPoint(m, pair.measured_mm) - pair.body_mm));
    sum += moving.pairWeight * d * d;
    count += moving.pairWeight;
  }
  return sum / count;
}

double robustDeviation(std::vector<double> distances, double noise_mm) {
  if (distances.empty()) return noise_mm;
  std::sort(distances.begin(), distances.end());
  std::vector<double> squares{0.0};
  for (const double d : distances) squares.push_back(squares.back() + d * d);
  // Upwards from the noise: the first deviation that agrees with itself is that of the surface, and a larger one would
  // include outliers. Uniform distances never agree, so that it grows until all are within.
  double sigma = noise_mm;
  for (int i = 0; i < 30; ++i) {
    const auto count = std::upper_bound(distances.begin(), distances.end(), 3.0 * sigma) - distances.begin();
    const double next =
        count > 0 ? std::sqrt(squares[static_cast<std::size_t>(count)] / static_cast<double>(count)) : 2.0 * sigma;
    if (next <= 1.001 * sigma) return sigma;
    sigma = next;
  }
  return sigma;
}

Mat4 refine(const TargetSurface &target, const MovingPoints &moving, Mat4 m, double limit_mm, double noise_mm,
            int iterations, Feet feet) {
  const double arm = 0.5 * target.diagonal_mm();
  std::vector<Foot> found(moving.points.size());
  std::vector<Vec3> at(moving.points.size());
  std::vector<double> distances(moving.points.size());
  double limit = limit_mm;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    Vec3 centre{};
    double total = 0.0;
    for (std::size_t i = 0; i < at.size(); ++i) {
      at[i] = transformPoint(m, moving.points[i]);
      found[i] = footOf(target, moving, i, m, at[i], limit_mm, feet);
      distances[i] = found[i].isFound ? found[i].distance : limit_mm;
    }
    limit = std::min(limit, std::max(3.0 * robustDeviation(distances, noise_mm), 0.75 * limit));
    for (std::size_t i = 0; i < at.size(); ++i) {
      const double w = found[i].isFound ? tukey(found[i].distance, limit) : 0.0;
      centre = centre + w * at[i];
      total += w;
    }
    if (!(total > 0.0)) return m;
    centre = (1.0 / total) * centre;
    Equations equations;
    for (std::size_t i = 0; i < at.size(); ++i)
      if (const double w = found[i].isFound ? tukey(found[i].distance, limit) : 0.0; w > 0.0)
        equations.add(rowOf(at[i], centre, found[i].normal, arm), dot(at[i] - found[i].point, found[i].normal), w);
    addPairs(moving, m, centre, arm, equations);
    // Directions that the points do not determine stay as they are.
    Matrix6 damped = equations.matrix;
    damped.diagonal().array() += 1e-4 * equations.matrix.trace() / 6.0;
    const Vector6 step = damped.ldlt().solve(equations.right);
    if (!step.allFinite()) return m;
    const Vec3 rotation{step[0] / arm, step[1] / arm, step[2] / arm}, translation{step[3], step[4], step[5]};
    m = stepped(m, rotation, centre, translation);
    const bool isSettled = limit <= std::max(3.0 * robustDeviation(distances, noise_mm), 3.0 * noise_mm) * 1.001;
    if (isSettled && step.norm() < 1e-3 * noise_mm) break;
  }
  return m;
}

std::array<std::array<double, 6>, 6> information(const TargetSurface &target, const MovingPoints &moving, const Mat4 &m,
                                                 double limit_mm, const Vec3 &centre, double arm) {
  Equations equations;
  for (std::size_t i = 0; i < moving.points.size(); ++i) {
    const Vec3 at = transformPoint(m, moving.points[i]);
    const Foot foot = footOf(target, moving, i, m, at, limit_mm, Feet::exact);
    if (foot.isFound) equations.add(rowOf(at, centre, foot.normal, arm), 0.0, 1.0);
  }
  addPairs(moving, m, centre, arm, equations);
  std::array<std::array<double, 6>, 6> out{};
  for (int r = 0; r < 6; ++r)
    for (int c = 0; c < 6; ++c) out[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)] = equations.matrix(r, c);
  return out;
}

}  // namespace c3de::registration
