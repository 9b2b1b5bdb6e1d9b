// SPDX-License-Identifier: Apache-2.0
#include "pointbased/machine_speed.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "base/work_timer.h"
#include "pointbased/simulator.h"

namespace pointbased {
namespace {

constexpr double kEdge = 0.1;      // m, of the boxes
constexpr double kPush = 0.1;      // m/s
constexpr double kMinTime = 0.03;  // s, over which a time is measured
constexpr int kMinSteps = 3, kWindows = 5;
constexpr double kSameMachine = 1.35;  // ratio of times up to which two measurements are of the same machine
constexpr int kFormat = 2;

// A box that fits its lattice, with a triangle mesh for contact.
BodyShape boxShape(const Vec3 &corner = Vec3::Zero()) {
  BodyShape shape;
  shape.min = corner;
  shape.max = corner + Vec3::Constant(kEdge);
  shape.volume = kEdge * kEdge * kEdge;
  const auto depth = [corner](const Vec3 &x) {
    return (0.5 * kEdge - (x - corner - Vec3::Constant(0.5 * kEdge)).cwiseAbs().array()).minCoeff();
  };
  shape.inside = [depth](std::span<const Vec3> points, std::span<double> inside) {
    for (std::size_t i = 0; i < points.size(); ++i) inside[i] = depth(points[i]) > 0.0 ? 1.0 : 0.0;
  };
  shape.surfaceDistance = [depth](std::span<const Vec3> points, std::span<double> distances) {
    for (std::size_t i = 0; i < points.size(); ++i) distances[i] = std::abs(depth(points[i]));
  };
  for (int k = 0; k < 8; ++k) shape.surface.positions.emplace_back(corner + kEdge * Vec3(k & 1, k >> 1 & 1, k >> 2));
  for (const auto &[a, b, c, d] :
       {std::array<Index, 4>{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}) {
    shape.surface.triangles.push_back({a, b, c});
    shape.surface.triangles.push_back({a, c, d});
  }
  return shape;
}

// Median over windows of the shortest time in each. It is insensitive to other load on the machine and to a single
// wrong clock reading.
double secondsOf(const std::function<void()> &work) {
  work();
  std::array<double, kWindows> shortest{};
  for (double &window : shortest) {
    window = std::numeric_limits<double>::infinity();
    double sum = 0.0;
    for (int k = 0; k < kMinSteps || sum < kMinTime / kWindows; ++k) {
      const detail::WorkTimer timer;
      work();
      const double seconds = timer.seconds();
      sum += seconds;
      window = std::min(window, seconds);
    }
  }
  std::nth_element(shortest.begin(), shortest.begin() + kWindows / 2, shortest.end());
  return shortest[kWindows / 2];
}

struct TimedBody {
  TimedBody(double points, Precision precision, bool walls, const ParallelFor &parallelFor) : simulator(parallelFor) {
    BodyRecipe recipe;
    recipe.sampling.spacing = kEdge / std::round(std::cbrt(points));
    const auto rest = buildRestState(boxShape(), recipe, {}, parallelFor);
    count = static_cast<double>((*rest)->pointCount());
    contacts = static_cast<double>((*rest)->contact.count());
    WorldSettings world;
    world.precision = precision;
    world.box = {walls, Vec3::Constant(-kEdge), Vec3::Constant(2.0 * kEdge)};
    simulator.setWorld(world);
    auto body = std::make_unique<Body>("box", *rest, Constitution{{Material{}}, kLatticeStabilisation}, parallelFor);
    body->setInitialVelocity(Vec3::Zero(), Vec3(1.0, 0.5, 0.2));
    id = simulator.addBody(std::move(body));
  }
  [[nodiscard]] double step() {
    return secondsOf([&] { (void)simulator.step(); });
  }
  Simulator simulator;
  std::size_t id = 0;
  double count = 0.0, contacts = 0.0;
};

// Additional time of a substep per vertex in contact, ns, for two boxes pushed against each other.
double touchTime(const ParallelFor &parallelFor, double apart_ns) {
  TimedBody pushed(MachineSpeed::kPoints[1], Precision::doublePrecision, false, parallelFor);
  Simulator &simulator = pushed.simulator;
  Body &lower = *simulator.body(pushed.id);
  BodyRecipe recipe;
  recipe.sampling.spacing = lower.rest().spacing;
  const auto rest = buildRestState(boxShape(Vec3(0, kEdge, 0)), recipe, {}, parallelFor);
  auto upper = std::make_unique<Body>("upper", *rest, lower.constitution(), parallelFor);
  lower.setInitialVelocity(Vec3(0, kPush, 0), Vec3::Zero());
  upper->setInitialVelocity(Vec3(0, -kPush, 0), Vec3::Zero());
  simulator.addBody(std::move(upper));
  (void)simulator.step();
  double pressing = 0.0;
  const double seconds = secondsOf([&] {
    (void)simulator.step();
    for (const ContactSummary &contact : simulator.diagnostics().contacts())
      pressing = std::max(pressing, static_cast<double>(contact.points));
  });
  return std::max(0.0, 1e9 * seconds - 2.0 * pushed.count * apart_ns) / std::max(1.0, pressing);
}

double surfelTime(const ParallelFor &parallelFor) {
  TimedBody body(MachineSpeed::kPoints[1], Precision::doublePrecision, false, parallelFor);
  const RestState &rest = body.simulator.body(body.id)->rest();
  constexpr std::size_t kSurfels = 8000;
  std::vector<Vec3> points(kSurfels);
  for (std::size_t i = 0; i < kSurfels; ++i) {
    const double t = static_cast<double>(i) / kSurfels;
    points[i] = Vec3(kEdge * t, kEdge * std::fmod(37.0 * t, 1.0), 0.0) - rest.origin;
  }
  const std::vector<Vec3> normals(kSurfels, -Vec3::UnitZ());
  const Surfels surfels(rest.bind(points, normals));
  std::vector<Vec3f> x(kSurfels), n(kSurfels);
  ScreenPhyxels scratch;
  return secondsOf([&] {
           updateSurfels(surfels, normals, rest.origin, rest.positions,
                         body.simulator.body(body.id)->state().displacements, scratch, x, n, parallelFor);
         }) /
         kSurfels;
}

}  // namespace

double MachineSpeed::perPoint(double points, Precision precision) const {
  const std::array<double, 4> &ns = precision == Precision::singlePrecision ? single_ns : double_ns;
  if (points <= kPoints.front()) return ns.front();
  for (std::size_t k = 1; k < kPoints.size(); ++k) {
    if (points > kPoints[k]) continue;
    const double t = std::log(points / kPoints[k - 1]) / std::log(kPoints[k] / kPoints[k - 1]);
    return (1.0 - t) * ns[k - 1] + t * ns[k];
  }
  return ns.back();
}

MachineSpeed nominalSpeed() {
  MachineSpeed speed;
  speed.double_ns = {130.0, 110.0, 110.0, 120.0};
  speed.single_ns = {90.0, 75.0, 75.0, 80.0};
  speed.contact_ns = 40.0;
  speed.touch_ns = 700.0;
  speed.surfel_ns = 20.0;
  return speed;
}

MachineSpeed measureSpeed(const ParallelFor &parallelFor, unsigned threads) {
  MachineSpeed speed;
  speed.threads = threads;
  speed.kernels = kernelTarget();
  for (std::size_t k = 0; k < MachineSpeed::kPoints.size(); ++k)
    for (const Precision precision : {Precision::doublePrecision, Precision::singlePrecision}) {
      TimedBody body(MachineSpeed::kPoints[k], precision, false, parallelFor);
      const double ns = 1e9 * body.step() / body.count;
      (precision == Precision::singlePrecision ? speed.single_ns : speed.double_ns)[k] = ns;
    }
  TimedBody walled(MachineSpeed::kPoints[1], Precision::doublePrecision, true, parallelFor);
  const double with = walled.step();
  speed.contact_ns = std::max(0.0, 1e9 * with - walled.count * speed.double_ns[1]) / std::max(1.0, walled.contacts);
  speed.touch_ns = touchTime(parallelFor, speed.double_ns[1]);
  speed.surfel_ns = 1e9 * surfelTime(parallelFor);
  return speed;
}

bool matchesThisMachine(const MachineSpeed &kept, const ParallelFor &parallelFor, unsigned threads) {
  if (kept.threads != threads || kept.kernels != kernelTarget()) return false;
  TimedBody body(MachineSpeed::kPoints[0], Precision::doublePrecision, false, parallelFor);
  const double ratio = 1e9 * body.step() / body.count / kept.double_ns[0];
  return ratio < kSameMachine && ratio > 1.0 / kSameMachine;
}

std::string textOf(const MachineSpeed &speed) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << kFormat << ' ' << speed.threads << ' ' << speed.kernels;
  for (const double ns : speed.double_ns) text << ' ' << ns;
  for (const double ns : speed.single_ns) text << ' ' << ns;
  text << ' ' << speed.contact_ns << ' ' << speed.touch_ns << ' ' << speed.surfel_ns;
  return text.str();
}

std::optional<MachineSpeed> speedFrom(std::string_view line) {
  std::istringstream text{std::string(line)};
  text.imbue(std::locale::classic());
  MachineSpeed speed;
  int format = 0;
  text >> format >> speed.threads >> speed.kernels;
  for (double &ns : speed.double_ns) text >> ns;
  for (double &ns : speed.single_ns) text >> ns;
  text >> speed.contact_ns >> speed.touch_ns >> speed.surfel_ns;
  if (!text || format != kFormat) return std::nullopt;
  for (const auto &all : {speed.double_ns, speed.single_ns})
    for (const double ns : all)
      if (!(ns > 0.0 && ns < 1e9)) return std::nullopt;
  return speed;
}

}  // namespace pointbased
