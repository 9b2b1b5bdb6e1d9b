// SPDX-License-Identifier: Apache-2.0
#include "matching/match_terms.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace pointbased::detail {
namespace {

constexpr double kAlong = 5e-4;  // stiffness along the surface: the distance knows nothing of it, and slides
constexpr double kHuber = 1.5, kTukey = 4.685;  // standard deviations
constexpr double kMedianOfNormal = 0.6745;      // of |x|, x normal with variance 1

double weightOf(RobustLoss loss, double t) {
  if (loss == RobustLoss::huber) return t <= kHuber ? 1.0 : kHuber / t;
  const double part = std::max(0.0, 1.0 - t * t / (kTukey * kTukey));
  return part * part;
}

}  // namespace

MatchTerms::MatchTerms(const RestState &rest, const Interpolation &binding, std::span<const MatchPoint> points,
                       std::span<const MatchLandmark> landmarks, const SurfaceMatchSettings &settings,
                       const ParallelFor &parallelFor)
    : rest_(rest), binding_(binding), points_(points), landmarks_(landmarks), settings_(settings),
      parallelFor_(parallelFor), skin_(rest.skin) {
  std::vector<Vec3> references;
  for (const MatchLandmark &landmark : landmarks) references.push_back(landmark.reference - rest.origin);
  if (!references.empty()) bound_ = rest.bind(references, {});
  landmarkPositions_.resize(references.size());
  skinPositions_.resize(binding.count());
  closest_.resize(points.size());
  residuals_.assign(count(), Vec3::Zero());
  weights_.assign(count(), 1.0);
  double volume = 0.0;
  for (std::size_t i = 0; i < rest.phyxelCount(); ++i) {
    centre_ += rest.volumes[i] * rest.positions[i];
    volume += rest.volumes[i];
  }
  centre_ /= volume;
}

double MatchTerms::noiseOf(std::size_t i) const {
  const double own = i < points_.size() ? 0.0 : landmarks_[i - points_.size()].noise;
  return own > 0.0 ? own : settings_.noise;
}

void MatchTerms::evaluate(std::span<const Vec3> displacements, const MatchMotion &motion) {
  interpolateDisplacements(binding_, rest_.positions, displacements, skinPositions_, parallelFor_);
  for (std::size_t v = 0; v < skinPositions_.size(); ++v) skinPositions_[v] += binding_.positions[v];
  skin_.move(skinPositions_);
  const double cosine = std::cos(settings_.largestAngle_deg * std::numbers::pi / 180.0);
  constexpr std::size_t kGrain = 8;
  parallelFor_(points_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3 y = motion.inverse(points_[i].position) - rest_.origin;
      closest_[i] = skin_.closest(y, motion.rotation.transpose() * points_[i].normal, cosine, closest_[i].triangle);
      residuals_[i] = y - closest_[i].position;
    }
  });
  if (landmarks_.empty()) return;
  interpolateDisplacements(bound_, rest_.positions, displacements, landmarkPositions_, parallelFor_);
  for (std::size_t l = 0; l < landmarks_.size(); ++l) {
    landmarkPositions_[l] += bound_.positions[l];
    residuals_[points_.size() + l] = motion.inverse(landmarks_[l].position) - rest_.origin - landmarkPositions_[l];
  }
}

double MatchTerms::distanceOf(std::size_t i) const {
  if (i < points_.size() && closest_[i].triangle == ClosestSkinPoint::kNone)
    return std::numeric_limits<double>::infinity();
  return residuals_[i].norm();
}

bool MatchTerms::sees() const {
  for (std::size_t i = 0; i < count(); ++i)
    if (std::isfinite(distanceOf(i))) return true;
  return false;
}

double MatchTerms::spread() const {
  std::vector<double> sizes;
  for (std::size_t i = 0; i < count(); ++i) {
    const double distance = distanceOf(i);
    // The length of three components is longer than one of them.
    if (std::isfinite(distance)) sizes.push_back(distance / noiseOf(i) / (i < points_.size() ? 1.0 : 2.28));
  }
  if (sizes.empty()) return 1.0;
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  return std::max(1.0, *middle / kMedianOfNormal);
}

void MatchTerms::weigh(RobustLoss loss, double scale) {
  for (std::size_t i = 0; i < count(); ++i) {
    // Landmarks alone say how the surface has moved along itself; they are chosen by a person, and always count.
    const double distance = distanceOf(i);
    weights_[i] = i >= points_.size()       ? 1.0
                  : std::isfinite(distance) ? weightOf(loss, distance / (scale * noiseOf(i)))
                                            : 0.0;
  }
}

double MatchTerms::distance() const {
  double sum = 0.0, all = 0.0;
  const std::size_t last = points_.empty() ? count() : points_.size();
  for (std::size_t i = 0; i < last; ++i) {
    if (!(weights_[i] > 0.0)) continue;
    sum += weights_[i] * residuals_[i].squaredNorm();
    all += weights_[i];
  }
  return all > 0.0 ? std::sqrt(sum / all) : std::numeric_limits<double>::infinity();
}

double MatchTerms::misfit() const {
  // A few landmarks may be farther off by chance.
  constexpr double kByChance = 1.2;
  double ofLandmarks = 0.0;
  for (std::size_t i = points_.size(); i < count(); ++i)
    ofLandmarks += residuals_[i].squaredNorm() / (3.0 * noiseOf(i) * noiseOf(i));
  if (!landmarks_.empty()) ofLandmarks = std::sqrt(ofLandmarks / static_cast<double>(landmarks_.size())) / kByChance;
  return std::max(points_.empty() ? 0.0 : distance() / settings_.noise, ofLandmarks);
}

Eigen::Matrix<double, 3, 6> MatchTerms::motionColumns(const Vec3 &x) const {
  const Vec3 arm = x - centre_;
  Eigen::Matrix<double, 3, 6> out;
  out << 0.0, arm[2], -arm[1], 1.0, 0.0, 0.0,  //
      -arm[2], 0.0, arm[0], 0.0, 1.0, 0.0,     //
      arm[1], -arm[0], 0.0, 0.0, 0.0, 1.0;
  return out;
}

MatchMotion MatchTerms::moved(const MatchMotion &motion, const Eigen::Matrix<double, 6, 1> &step) const {
  const Vec3 turn = step.head<3>(), centre = rest_.origin + centre_;
  const double angle = turn.norm();
  const Mat3 small =
      angle > 0.0 ? Mat3(Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix()) : Mat3(Mat3::Identity());
  MatchMotion out;
  out.rotation = motion.rotation * small;
  const Vec3 moved = centre + step.tail<3>();
  out.translation = motion.translation + motion.rotation * moved - out.rotation * centre;
  return out;
}

void MatchTerms::springs(double stiffness, MatchSprings &out) const {
  out.clear();
  const double unit = settings_.noise;
  for (std::size_t i = 0; i < count(); ++i) {
    if (!(weights_[i] > 0.0)) continue;
    const double k = stiffness * weights_[i] * unit * unit / (noiseOf(i) * noiseOf(i));
    if (i >= points_.size()) {
      const std::size_t l = i - points_.size();
      for (Index e = bound_.phyxels.offsets[l]; e < bound_.phyxels.offsets[l + 1]; ++e)
        out.add(bound_.phyxels.indices[e], bound_.weights[e]);
      out.finish(k * Mat3::Identity(), residuals_[i], motionColumns(landmarkPositions_[l]));
      continue;
    }
    const ClosestSkinPoint &at = closest_[i];
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const Index v = rest_.skin[at.triangle][corner];
      for (Index e = binding_.phyxels.offsets[v]; e < binding_.phyxels.offsets[v + 1]; ++e)
        out.add(binding_.phyxels.indices[e], at.weights[static_cast<Eigen::Index>(corner)] * binding_.weights[e]);
    }
    const Mat3 across = at.normal * at.normal.transpose();
    out.finish(k * (across + kAlong * (Mat3::Identity() - across)), residuals_[i], motionColumns(at.position));
  }
}

void MatchTerms::linearise(double scale, LinearMeasurements &out) const {
  out.d = out.weights = Eigen::VectorXd::Zero(rows());
  out.C = Eigen::MatrixXd::Zero(rows(), settings_.isMotionKnown ? 0 : 6);
  const bool hasMotion = !settings_.isMotionKnown;
  for (std::size_t i = 0; i < count(); ++i) {
    const double sigma = scale * noiseOf(i), weight = weights_[i] / (sigma * sigma);
    if (!(weight > 0.0)) continue;
    const auto row = static_cast<Eigen::Index>(i);
    if (i < points_.size()) {
      const Vec3 &normal = closest_[i].normal;
      out.d[row] = normal.dot(residuals_[i]);
      out.weights[row] = weight;
      if (hasMotion) out.C.row(row) = normal.transpose() * motionColumns(closest_[i].position);
      continue;
    }
    const std::size_t l = i - points_.size();
    const Eigen::Index first = row + 2 * static_cast<Eigen::Index>(l);
    out.d.segment<3>(first) = residuals_[i];
    out.weights.segment<3>(first).setConstant(weight);
    if (hasMotion) out.C.middleRows<3>(first) = motionColumns(landmarkPositions_[l]);
  }
}

Eigen::MatrixXd MatchTerms::observe(const ResponseMatrix &displacements, std::size_t responses, const Mat3 &rotation,
                                    const ParallelFor &parallelFor) const {
  constexpr std::size_t kGrain = 8;
  const auto n = static_cast<Eigen::Index>(responses);
  const Eigen::Index third = displacements.cols() / 3;
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(rows(), n);
  const auto add = [&](const Interpolation &binding, std::size_t at, double weight, Eigen::RowVectorXf &moved) {
    for (Index e = binding.phyxels.offsets[at]; e < binding.phyxels.offsets[at + 1]; ++e)
      moved += static_cast<float>(weight * binding.weights[e]) * displacements.row(binding.phyxels.indices[e]);
  };
  parallelFor(count(), kGrain, [&](std::size_t begin, std::size_t end) {
    Eigen::RowVectorXf moved(displacements.cols());
    for (std::size_t i = begin; i < end; ++i) {
      if (!(weights_[i] > 0.0)) continue;
      moved.setZero();
      if (i < points_.size()) {
        const ClosestSkinPoint &at = closest_[i];
        for (std::size_t corner = 0; corner < 3; ++corner)
          add(binding_, rest_.skin[at.triangle][corner], at.weights[static_cast<Eigen::Index>(corner)], moved);
        const Vec3 normal = rotation.transpose() * at.normal;
        for (Eigen::Index c = 0; c < 3; ++c)
          out.row(static_cast<Eigen::Index>(i)) += normal[c] * moved.segment(c * third, n).cast<double>();
        continue;
      }
      const std::size_t l = i - points_.size();
      add(bound_, l, 1.0, moved);
      for (Eigen::Index c = 0; c < 3; ++c)
        out.middleRows<3>(static_cast<Eigen::Index>(points_.size() + 3 * l)) +=
            rotation.col(c) * moved.segment(c * third, n).cast<double>();
    }
  });
  return out;
}

}  // namespace pointbased::detail
