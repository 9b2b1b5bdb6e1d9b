// SPDX-License-Identifier: Apache-2.0
#include "contact_cases.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "shapes.h"
#include "surfaces.h"

namespace shapes {

using namespace pointbased;

namespace {

constexpr double kNothing = std::numeric_limits<double>::infinity();

SurfacePoint within(double range, const Vec3 &normal, double distance) {
  return {normal, std::abs(distance) <= range ? distance : kNothing};
}

}  // namespace

Obstacle halfSpace(const Vec3 &point, const Vec3 &normal, double friction, Asked *asked) {
  Obstacle o;
  o.name = "half-space";
  o.friction = friction;
  o.closest = [=](std::span<const Vec3> points, std::span<const double> ranges, std::span<SurfacePoint> out) {
    if (asked) asked->closest += points.size();
    for (std::size_t i = 0; i < points.size(); ++i) out[i] = within(ranges[i], normal, (points[i] - point).dot(normal));
  };
  o.crossing = [=](const Vec3 &from, const Vec3 &to, Vec3 &hit) {
    if (asked) ++asked->crossing;
    hit = normal;
    const double a = (from - point).dot(normal), b = (to - point).dot(normal);
    return a * b <= 0.0 && a != b ? a / (a - b) : -1.0;
  };
  return o;
}

Obstacle sheet(double height, double half, double friction) {
  Obstacle o;
  o.name = "sheet";
  o.friction = friction;
  o.closest = [=](std::span<const Vec3> points, std::span<const double> ranges, std::span<SurfacePoint> out) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3 &x = points[i];
      const Vec3 nearest(std::clamp(x[0], -half, half), height, std::clamp(x[2], -half, half));
      const double distance = (x - nearest).norm();
      out[i] = within(ranges[i], distance > 0.0 ? Vec3((x - nearest) / distance) : Vec3(Vec3::UnitY()), distance);
    }
  };
  o.crossing = [=](const Vec3 &from, const Vec3 &to, Vec3 &hit) {
    hit = Vec3::UnitY();
    const double a = from[1] - height, b = to[1] - height;
    if (a * b > 0.0 || a == b) return -1.0;
    const Vec3 at = from + a / (a - b) * (to - from);
    return std::abs(at[0]) <= half && std::abs(at[2]) <= half ? a / (a - b) : -1.0;
  };
  return o;
}

Obstacle solidBox(const Vec3 &min, const Vec3 &max, double friction, Asked *asked) {
  Obstacle o;
  o.name = "box";
  o.friction = friction;
  o.closest = [=](std::span<const Vec3> points, std::span<const double> ranges, std::span<SurfacePoint> out) {
    if (asked) asked->closest += points.size();
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3 &x = points[i];
      const Vec3 beyond = (x - max).cwiseMax(min - x);
      const Vec3 offset = x - x.cwiseMax(min).cwiseMin(max);
      if (offset.norm() > 0.0) {
        out[i] = within(ranges[i], offset.normalized(), offset.norm());
        continue;
      }
      Eigen::Index axis = 0;
      const double distance = beyond.maxCoeff(&axis);
      out[i] = within(ranges[i],
                      x[axis] - max[axis] > min[axis] - x[axis] ? Vec3(Vec3::Unit(axis)) : Vec3(-Vec3::Unit(axis)),
                      distance);
    }
  };
  o.crossing = [=](const Vec3 &from, const Vec3 &to, Vec3 &hit) {
    if (asked) ++asked->crossing;
    // The first face that the path crosses, from either side.
    double best = -1.0;
    for (int axis = 0; axis < 3; ++axis)
      for (int side = 0; side < 2; ++side) {
        const double height = side == 0 ? min[axis] : max[axis], a = from[axis] - height, b = to[axis] - height;
        if (a * b > 0.0 || a == b) continue;
        const double t = a / (a - b);
        const Vec3 at = from + t * (to - from);
        bool inFace = true;
        for (int other = 0; other < 3; ++other)
          if (other != axis && (at[other] < min[other] || at[other] > max[other])) inFace = false;
        if (!inFace || (best >= 0.0 && t >= best)) continue;
        best = t;
        hit = side == 0 ? Vec3(-Vec3::Unit(axis)) : Vec3(Vec3::Unit(axis));
      }
    return best;
  };
  return o;
}

std::unique_ptr<Body> latticeBox(const Vec3 &min, const Vec3 &max, double spacing, const Material &material, int n) {
  return makeBody(restState(box(min, max, n), {.sampling = {.spacing = spacing}}), {material});
}

Material rubber(double youngsModulus, double viscosity) {
  return Material{.youngsModulus = youngsModulus, .poissonRatio = 0.3, .viscosity = viscosity};
}

WorldSettings worldOf(Integrator integrator, const Vec3 &gravity) {
  return {.gravity = gravity,
          .integrator = integrator,
          .dt = integrator == Integrator::explicitVerlet ? 0.0 : kImplicitStep};
}

Extent extent(Body &body, const Vec3 &axis) {
  Extent out{kNothing, -kNothing};
  for (const Vec3 &x : body.contactPositions(serialFor())) {
    out.low = std::min(out.low, x.dot(axis));
    out.high = std::max(out.high, x.dot(axis));
  }
  return out;
}

Vec3 meanVelocity(const Body &body) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < body.masses().size(); ++i) sum += body.masses()[i] * body.state().velocities[i];
  return sum / body.totalMass();
}

Vec3 meanDisplacement(const Body &body) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < body.masses().size(); ++i) sum += body.masses()[i] * body.state().displacements[i];
  return sum / body.totalMass();
}

Momenta momenta(const Body &body) {
  Momenta out;
  for (std::size_t i = 0; i < body.rest().phyxelCount(); ++i) {
    const Vec3 p = body.masses()[i] * body.state().velocities[i];
    out.linear += p;
    out.angular += (body.rest().positions[i] + body.state().displacements[i]).cross(p);
    out.size += p.norm();
  }
  return out;
}

long countEvents(const Simulator &simulator, const std::string &kind, const std::string &text) {
  return std::count_if(
      simulator.diagnostics().events().begin(), simulator.diagnostics().events().end(),
      [&](const SimulationEvent &event) { return event.kind == kind && event.text.find(text) != std::string::npos; });
}

double totalEnergy(const Simulator &simulator, std::size_t id) {
  const Diagnostics::Energy e = simulator.diagnostics().energy(id);
  return e.kinetic + e.elastic + e.stabilisation + e.gravity;
}

}  // namespace shapes
