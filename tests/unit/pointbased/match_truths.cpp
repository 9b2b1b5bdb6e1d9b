// SPDX-License-Identifier: Apache-2.0
#include "match_truths.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <random>
#include <sstream>
#include <stdexcept>

#include "pointbased/integrators.h"
#include "support/folders.h"
#include "surfaces.h"

namespace match_truths {
namespace {

constexpr double kPoissonRatio = 0.4;
constexpr double kFinerPart = 0.8;  // spacing of the truth over that of the match: not the same equations

Surface organSurface() {
  const std::string path = std::string(testResourcesFolder()) + "/meshes/organ.obj";
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot read " + path);
  Surface out;
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string kind;
    words >> kind;
    if (kind == "v") {
      Vec3 x;
      words >> x[0] >> x[1] >> x[2];
      out.positions.push_back(1e-3 * x);
    } else if (kind == "f") {
      std::array<Index, 3> t{};
      for (Index &v : t) {
        words >> v;
        --v;
      }
      out.triangles.push_back(t);
    }
  }
  return out;
}

Surface ellipsoid() {
  Surface out = shapes::ballSurface(Vec3::Zero(), 1.0, 24);
  for (Vec3 &x : out.positions) x = x.cwiseProduct(Vec3(0.09, 0.06, 0.045));
  return out;
}

std::shared_ptr<const RestState> restOf(const Organ &organ, double spacing) {
  static std::map<std::pair<std::string, double>, std::shared_ptr<const RestState>> known;
  auto &rest = known[{organ.name, spacing}];
  if (!rest)
    rest = shapes::restState(shapes::inside(organ.surface), {.sampling = {.spacing = spacing}, .fixes = organ.fixes});
  return rest;
}

Material materialOf(const Organ &organ, double stiffness) {
  return {.youngsModulus = stiffness * organ.modulus, .poissonRatio = kPoissonRatio};
}

// Adds a force on the skin around the point of it that is farthest along `side`, over a Gaussian of the width.
void addPush(const Organ &organ, const RestState &rest, const Vec3 &side, const Vec3 &force, double width,
             std::vector<Vec3> &out) {
  const SurfacePoints all = sampleSurface(organ.surface, 0.5 * rest.spacing, EverywhereRegion{});
  SurfacePoints samples;
  for (std::size_t p = 0; p < all.count(); ++p) {
    const bool isHeld = std::any_of(organ.fixes.begin(), organ.fixes.end(),
                                    [&](const Fix &fix) { return contains(fix.region, all.positions[p]); });
    if (isHeld) continue;
    samples.positions.push_back(all.positions[p] - rest.origin);
    samples.normals.push_back(all.normals[p]);
    samples.areas.push_back(all.areas[p]);
  }
  std::size_t top = 0;
  for (std::size_t p = 0; p < samples.count(); ++p)
    if (samples.positions[p].dot(side) > samples.positions[top].dot(side)) top = p;
  std::vector<Vec3> forces(samples.count());
  double total = 0.0;
  for (std::size_t p = 0; p < samples.count(); ++p) {
    const double squared = (samples.positions[p] - samples.positions[top]).squaredNorm();
    const double w = samples.areas[p] * std::exp(-0.5 * squared / (width * width)) *
                     std::max(0.0, samples.normals[p].dot(samples.normals[top]));
    forces[p] = w * force;
    total += w;
  }
  for (Vec3 &f : forces) f /= total;
  spreadForces(rest.bind(samples.positions, samples.normals), forces, out);
}

std::vector<Vec3> loadOf(const Organ &organ, const Body &body, int load) {
  const RestState &rest = body.rest();
  std::vector<Vec3> forces(rest.phyxelCount(), Vec3::Zero());
  const double f = organ.force, width = 0.02;
  const auto push = [&](const Vec3 &side, const Vec3 &force) {
    addPush(organ, rest, side.normalized(), f * force, width, forces);
  };
  const auto weigh = [&](const Vec3 &along) {  // a body force of f in total
    double mass = 0.0;
    for (const double w : body.weights()) mass += w;
    for (std::size_t i = 0; i < forces.size(); ++i) forces[i] += f * body.weights()[i] / mass * along;
  };
  switch (load) {
    case 0:  // bent the other way
      push(Vec3(1.0, 0.0, 0.1), Vec3(0.0, 0.4, 0.7));
      push(Vec3(-0.8, 0.3, 0.1), Vec3(0.0, -0.4, 0.6));
      weigh(Vec3(0.0, 0.0, -1.3));
      break;
    case 1: push(Vec3(1.0, 0.2, -0.3), Vec3(-0.3, 0.2, 0.9)); break;  // from the side
    case 2: push(Vec3(0.2, 0.1, 1.0), Vec3(0.2, 0.1, -1.0)); break;   // where it is seen
    case 3:                                                           // bent
      push(Vec3(1.0, 0.0, 0.1), Vec3(0.0, 0.1, -0.8));
      push(Vec3(-0.8, 0.3, 0.1), Vec3(0.0, 0.2, -0.6));
      push(Vec3(0.0, 0.1, -1.0), Vec3(0.0, 0.0, 1.0));
      break;
    default:  // all of them
      weigh(Vec3(0.2, -0.8, -0.6));
      push(Vec3(0.6, 1.0, 0.0), Vec3(0.0, -0.8, 0.3));
  }
  return forces;
}

// The quarter of the surface that is farthest along a direction, and points of it.
std::vector<std::size_t> seen(const SurfacePoints &samples, const Vec3 &from, std::size_t count, std::mt19937 &random) {
  std::vector<std::size_t> order(samples.count());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return samples.positions[a].dot(from) > samples.positions[b].dot(from);
  });
  double all = 0.0, area = 0.0;
  for (const double a : samples.areas) all += a;
  std::vector<double> sums;
  for (const std::size_t p : order) {
    if (area > 0.25 * all) break;
    sums.push_back(area += samples.areas[p]);
  }
  std::vector<std::size_t> out;
  for (std::size_t k = 0; k < count; ++k) {
    const double at = area * static_cast<double>(random()) / 4294967296.0;
    out.push_back(order[static_cast<std::size_t>(std::lower_bound(sums.begin(), sums.end(), at) - sums.begin())]);
  }
  return out;
}

double normalOf(std::mt19937 &random) {
  const double a = (static_cast<double>(random()) + 0.5) / 4294967296.0;
  const double b = (static_cast<double>(random()) + 0.5) / 4294967296.0;
  return std::sqrt(-2.0 * std::log(a)) * std::cos(2.0 * std::numbers::pi * b);
}

}  // namespace

std::vector<Organ> organs() {
  const Foundation around{2e3, 1e3, 0.0};
  const auto below = [](int axis, double border) {
    Vec3 most = Vec3::Ones();
    most[axis] = border;
    return Fix{.region = BoxRegion{-Vec3::Ones(), most}};
  };
  Fix behind = below(1, 1.0);
  behind.region = BoxRegion{Vec3(-1.0, 0.03, -1.0), Vec3::Ones()};
  return {
      {"beam",
       shapes::boxSurface(Vec3::Zero(), Vec3(0.16, 0.05, 0.04), 10),
       {below(0, 0.004)},
       {},
       0.006,
       Vec3(0.35, 0.3, 1.0).normalized(),
       2e4,
       0.12},
      {"ellipsoid", ellipsoid(), {below(2, -0.03)}, around, 0.0075, Vec3(0.3, 0.2, 1.0).normalized(), 6e3, 4.0},
      {"organ", organSurface(), {behind}, around, 0.0105, Vec3(0.2, -0.9, 0.5).normalized(), 6e3, 3.0},
  };
}

Truth truthOf(const Organ &organ, int load, std::size_t points, double noise) {
  const auto rest = restOf(organ, kFinerPart * organ.spacing);
  const auto body = shapes::makeBody(rest, {materialOf(organ, 1.0)});
  body->quasiStatic = true;
  if (const auto set = body->setFoundation(organ.foundation); !set) throw std::runtime_error(set.error());
  std::vector<Vec3> forces = loadOf(organ, *body, load);
  body->swapExternalForces(forces);
  NewtonSolver solver;
  StageClock clock(stageNames());
  const ParallelFor loops = serialFor();
  Environment environment;
  environment.parallelFor = &loops;
  environment.clock = &clock;
  for (int k = 0; k < 4; ++k)
    if (const auto solved = quasiStaticStep(*body, solver, environment, 0.25 * k, 0.25 * (k + 1));
        !solved.failure.empty())
      throw std::runtime_error(organ.name + ": " + solved.failure);

  Truth out;
  out.motion.rotation = Eigen::AngleAxisd(0.03, Vec3(0.3, -0.6, 0.8).normalized()).toRotationMatrix();
  out.motion.translation = Vec3(0.003, -0.002, 0.002);
  const auto measured = [&](std::span<const Vec3> local, std::span<const Vec3> normals) {
    std::vector<Vec3> u(local.size());
    interpolateDisplacements(rest->bind(local, normals), rest->positions, body->state().displacements, u, loops);
    for (std::size_t i = 0; i < u.size(); ++i) u[i] = out.motion.of(rest->origin + local[i] + u[i]);
    return u;
  };
  std::mt19937 random(static_cast<unsigned>(7 + load));
  SurfacePoints samples = sampleSurface(organ.surface, 0.3 * organ.spacing, EverywhereRegion{});
  std::vector<Vec3> local, normals;
  for (const std::size_t p : seen(samples, organ.seenFrom, points, random)) {
    local.push_back(samples.positions[p] - rest->origin);
    normals.push_back(samples.normals[p]);
  }
  for (const Vec3 &y : measured(local, normals)) {
    Vec3 error;
    for (int a = 0; a < 3; ++a) error[a] = noise * normalOf(random);
    out.points.push_back({y + error, Vec3::Zero()});
  }
  // Each landmark is the point that is farthest from those before.
  std::vector<double> distances(local.size(), 1e9);
  std::vector<Vec3> marks;
  for (int k = 0; k < 4; ++k) {
    const auto next =
        static_cast<std::size_t>(std::max_element(distances.begin(), distances.end()) - distances.begin());
    marks.push_back(local[next]);
    for (std::size_t i = 0; i < local.size(); ++i)
      distances[i] = std::min(k == 0 ? 1e9 : distances[i], (local[i] - local[next]).norm());
  }
  const std::vector<Vec3> moved = measured(marks, {});
  for (std::size_t k = 0; k < marks.size(); ++k) {
    Vec3 error;
    for (int a = 0; a < 3; ++a) error[a] = noise * normalOf(random);
    out.landmarks.push_back({rest->origin + marks[k], moved[k] + error, 0.0});
  }
  out.references = rest->pointCentres;
  out.positions = measured(out.references, {});
  for (Vec3 &X : out.references) X += rest->origin;
  return out;
}

Result<SurfaceMatch> matchOf(const Organ &organ, double stiffness, const ParallelFor &parallelFor) {
  return SurfaceMatch::create(restOf(organ, organ.spacing), {{materialOf(organ, stiffness)}, kLatticeStabilisation},
                              organ.foundation, parallelFor);
}

std::unique_ptr<Body> bodyOf(const Organ &organ, double stiffness) {
  auto body = shapes::makeBody(restOf(organ, organ.spacing), {materialOf(organ, stiffness)});
  if (const auto set = body->setFoundation(organ.foundation); !set) throw std::runtime_error(set.error());
  return body;
}

std::vector<double> errorsOf(const Organ &organ, const Truth &truth, const SurfaceMatchResult &result) {
  const auto rest = restOf(organ, organ.spacing);
  std::vector<Vec3> local = truth.references, u(local.size());
  for (Vec3 &x : local) x -= rest->origin;
  interpolateDisplacements(rest->bind(local, {}), rest->positions, result.displacements, u, serialFor());
  std::vector<double> out;
  for (std::size_t i = 0; i < u.size(); ++i)
    out.push_back((result.motion.of(truth.references[i] + u[i]) - truth.positions[i]).norm());
  return out;
}

std::vector<double> expectedErrorsOf(const Organ &organ, const Truth &truth, const SurfaceMatchResult &result) {
  const auto rest = restOf(organ, organ.spacing);
  std::vector<Vec3> local = truth.references;
  for (Vec3 &x : local) x -= rest->origin;
  const Interpolation at = rest->bind(local, {});
  std::vector<double> out(local.size(), std::numeric_limits<double>::quiet_NaN());
  if (result.expectedErrors.empty()) return out;
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = 0.0;
    for (Index e = at.phyxels.offsets[i]; e < at.phyxels.offsets[i + 1]; ++e)
      out[i] += at.weights[e] * result.expectedErrors[at.phyxels.indices[e]];
  }
  return out;
}

std::vector<double> rigidErrorsOf(const Truth &truth, const SurfaceMatchResult &result) {
  std::vector<double> out;
  for (std::size_t i = 0; i < truth.positions.size(); ++i)
    out.push_back((result.rigid.of(truth.references[i]) - truth.positions[i]).norm());
  return out;
}

double meanOf(const std::vector<double> &values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

}  // namespace match_truths
