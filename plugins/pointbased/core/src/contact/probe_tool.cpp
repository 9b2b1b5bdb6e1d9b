// SPDX-License-Identifier: Apache-2.0
#include "pointbased/probe_tool.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "base/number_text.h"

namespace pointbased {
namespace {

using detail::number;

constexpr double kHalfTurn = std::numbers::pi - 1e-6;  // rad: from here on no rotation is the shorter one

// All points within `radius` of the segment from middle - half to middle + half.
struct Capsule {
  Vec3 middle, half;
  double radius;

  [[nodiscard]] Vec3 nearestOfLine(const Vec3 &x) const {
    const double size = half.squaredNorm();
    const double s = size > 0.0 ? std::clamp((x - middle).dot(half) / size, -1.0, 1.0) : 0.0;
    return middle + s * half;
  }
  [[nodiscard]] Vec3 normalAt(const Vec3 &x) const {
    const Vec3 direction = x - nearestOfLine(x);
    const double length = direction.norm();
    if (length > 0.0) return direction / length;
    return half.isZero(0.0) ? Vec3(Vec3::UnitZ()) : half.unitOrthogonal();
  }
};

// Interval of t on a line from + t direction.
struct Interval {
  double begin, end;
};

// Interval of t with |a + t b| <= radius.
std::optional<Interval> within(const Vec3 &a, const Vec3 &b, double radius) {
  const double bb = b.squaredNorm(), ab = a.dot(b), aa = a.squaredNorm() - radius * radius;
  if (!(bb > 0.0)) {
    if (aa > 0.0) return std::nullopt;
    return Interval{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  }
  const double root = ab * ab - bb * aa;
  if (root < 0.0) return std::nullopt;
  return Interval{(-ab - std::sqrt(root)) / bb, (-ab + std::sqrt(root)) / bb};
}

// Interval of a line inside the capsule: the hull of its intervals in both balls and in the cylinder, as the union is
// convex.
std::optional<Interval> insideOf(const Capsule &capsule, const Vec3 &from, const Vec3 &direction) {
  std::optional<Interval> out;
  const auto add = [&](const std::optional<Interval> &part) {
    if (!part || part->begin > part->end) return;
    out = out ? Interval{std::min(out->begin, part->begin), std::max(out->end, part->end)} : *part;
  };
  const Vec3 off = from - capsule.middle;
  add(within(off - capsule.half, direction, capsule.radius));
  const double half = capsule.half.norm();
  if (!(half > 0.0)) return out;
  add(within(off + capsule.half, direction, capsule.radius));
  const Vec3 axis = capsule.half / half;
  const double high = off.dot(axis), rise = direction.dot(axis);
  auto cylinder = within(off - high * axis, direction - rise * axis, capsule.radius);
  if (!cylinder) return out;
  if (std::abs(rise) > 0.0) {
    const double a = (-half - high) / rise, b = (half - high) / rise;
    cylinder->begin = std::max(cylinder->begin, std::min(a, b));
    cylinder->end = std::min(cylinder->end, std::max(a, b));
  } else if (std::abs(high) > half) {
    return out;
  }
  add(cylinder);
  return out;
}

// Tool path, with the rotations of the axis from each pose to the next.
class Path {
 public:
  explicit Path(const std::vector<ToolPose> &poses) : poses_(poses) {
    rotations_.push_back(Mat3::Identity());
    for (std::size_t k = 0; k + 1 < poses.size(); ++k) {
      const Vec3 a = poses[k].axis.normalized(), b = poses[k + 1].axis.normalized();
      const Vec3 about = a.cross(b);
      poseRotations_.emplace_back(std::atan2(about.norm(), a.dot(b)),
                                  about.norm() > 0.0 ? Vec3(about.normalized()) : Vec3(Vec3::UnitX()));
      rotations_.push_back(poseRotations_.back().toRotationMatrix() * rotations_.back());
    }
  }

  [[nodiscard]] double largestTurn() const {
    double largest = 0.0;
    for (const Eigen::AngleAxisd &rotation : poseRotations_) largest = std::max(largest, rotation.angle());
    return largest;
  }
  [[nodiscard]] RigidMotion motion(double t) const {
    RigidMotion out;
    out.centre = poses_.front().at;
    const auto next = std::upper_bound(poses_.begin(), poses_.end(), t,
                                       [](double time, const ToolPose &pose) { return time < pose.time; });
    if (next == poses_.begin()) return out;
    const auto k = static_cast<std::size_t>(next - poses_.begin()) - 1;
    if (next == poses_.end()) {
      out.rotation = rotations_.back();
      out.displacement = poses_.back().at - out.centre;
      return out;
    }
    const double s = (t - poses_[k].time) / (poses_[k + 1].time - poses_[k].time);
    const Eigen::AngleAxisd part(s * poseRotations_[k].angle(), poseRotations_[k].axis());
    out.rotation = part.toRotationMatrix() * rotations_[k];
    out.displacement = (1.0 - s) * poses_[k].at + s * poses_[k + 1].at - out.centre;
    return out;
  }

 private:
  std::vector<ToolPose> poses_;
  std::vector<Eigen::AngleAxisd> poseRotations_;  // [poses - 1]
  std::vector<Mat3> rotations_;                   // [poses] since the first
};

// Empty: the tool is valid.
std::string problemOf(const ProbeTool &tool) {
  if (!(tool.radius > 0.0) || !std::isfinite(tool.radius))
    return "its radius is " + number(1e3 * tool.radius) + " mm; accepted: more than 0";
  if (!(tool.length >= 0.0) || !std::isfinite(tool.length))
    return "its length is " + number(1e3 * tool.length) + " mm; accepted: at least 0";
  if (!(tool.friction >= 0.0) || !std::isfinite(tool.friction))
    return "its friction is " + number(tool.friction) + "; accepted: at least 0";
  if (tool.path.size() < 2)
    return "its path has " + std::to_string(tool.path.size()) + " places; accepted: at least two";
  for (std::size_t k = 0; k < tool.path.size(); ++k) {
    const ToolPose &pose = tool.path[k];
    const std::string which = "place " + std::to_string(k) + " of its path ";
    if (!std::isfinite(pose.time) || !pose.at.allFinite()) return which + "is not finite";
    if (!pose.axis.allFinite() || pose.axis.isZero(0.0)) return which + "has no axis; accepted: a direction";
    if (k > 0 && !(pose.time > tool.path[k - 1].time))
      return which + "is at " + number(pose.time) + " s, the one before at " + number(tool.path[k - 1].time) +
             " s; accepted: times that ascend";
  }
  return {};
}

}  // namespace

Result<Obstacle> obstacleOf(const ProbeTool &tool) {
  const std::string which = "probe tool '" + tool.name + "': ";
  if (const std::string problem = problemOf(tool); !problem.empty()) return tl::unexpected(which + problem);
  const Path path(tool.path);
  if (tool.length > 0.0 && path.largestTurn() > kHalfTurn)
    return tl::unexpected(which +
                          "its axis turns by 180 degrees from one place to the next; accepted: a place between, "
                          "which says the way");
  const Capsule capsule{tool.path.front().at, 0.5 * tool.length * tool.path.front().axis.normalized(), tool.radius};
  Obstacle out;
  out.name = tool.name;
  out.friction = tool.friction;
  out.motion = [path](double t) { return path.motion(t); };
  out.closest = [capsule](std::span<const Vec3> points, std::span<const double> maxDistances,
                          std::span<SurfacePoint> answers) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double distance = (points[i] - capsule.nearestOfLine(points[i])).norm() - capsule.radius;
      answers[i] =
          std::abs(distance) <= maxDistances[i] ? SurfacePoint{capsule.normalAt(points[i]), distance} : SurfacePoint();
    }
  };
  out.crossing = [capsule](const Vec3 &from, const Vec3 &to, Vec3 &normal) {
    const auto inside = insideOf(capsule, from, to - from);
    if (!inside) return -1.0;
    const double t = inside->begin >= 0.0 ? inside->begin : inside->end;
    if (!(t >= 0.0 && t <= 1.0)) return -1.0;
    normal = capsule.normalAt(from + t * (to - from));
    return t;
  };
  return out;
}

}  // namespace pointbased
