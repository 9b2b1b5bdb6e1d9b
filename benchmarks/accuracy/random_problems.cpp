// SPDX-License-Identifier: Apache-2.0
#include "accuracy/random_problems.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "mesh_body.h"
#include "pointbased/engine.h"
#include "support/random.h"
#include "thin_shapes.h"

namespace dial {
namespace {

using namespace pointbased;
using support::Random;

constexpr int kAround = 48;  // vertices of a ring
constexpr double kPi = 3.14159265358979323846;

double between(Random &random, double low, double high) { return low + (high - low) * (0.5 * random() + 0.5); }
double logBetween(Random &random, double low, double high) {
  return low * std::pow(high / low, (0.5 * random() + 0.5));
}
int choice(Random &random, int n) { return std::min(n - 1, static_cast<int>(n * (0.5 * random() + 0.5))); }

Mat3 randomRotation(Random &random) {
  // Braces: the order of evaluation of function arguments is unspecified.
  const Eigen::Vector4d q{random(), random(), random(), random()};
  return Eigen::Quaterniond(q.normalized()).toRotationMatrix();
}

double signedPower(double x, double p) { return std::copysign(std::pow(std::abs(x), p), x); }

/// A ball, a cylinder or a box with rounded edges, or a shape between them, with bumps.
Surface lobed(Random &random, const Vec3 &semiAxes, double boxiness, double bumps) {
  struct Bump {
    Vec3 direction;
    double height, width;
  };
  std::vector<Bump> all(5);
  for (Bump &b : all) b = {random.vector().normalized(), bumps * random(), between(random, 0.3, 0.8)};
  constexpr int kRings = 32;
  return validation::latheSurface(kRings, kAround, [=](int ring, double phi) {
    const double theta = kPi * ring / kRings;
    const Vec3 n(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), -std::cos(theta));
    const Vec3 x(signedPower(std::sin(theta), boxiness) * signedPower(std::cos(phi), boxiness),
                 signedPower(std::sin(theta), boxiness) * signedPower(std::sin(phi), boxiness),
                 -signedPower(std::cos(theta), boxiness));
    double r = 1.0;
    for (const Bump &b : all) r += b.height * std::exp(-(n - b.direction).squaredNorm() / (b.width * b.width));
    return Vec3(r * semiAxes.cwiseProduct(x));
  });
}

/// A tube open at both ends: outer radius, wall and length; about z.
Surface tube(double radius, double wall, double length) {
  constexpr int kAlong = 40;
  Surface out;
  for (int skin = 0; skin < 2; ++skin)
    for (int i = 0; i <= kAlong; ++i)
      for (int k = 0; k < kAround; ++k) {
        const double r = skin == 0 ? radius : radius - wall, phi = 2.0 * kPi * k / kAround;
        out.positions.emplace_back(r * std::cos(phi), r * std::sin(phi),
                                   length * (static_cast<double>(i) / kAlong - 0.5));
      }
  const auto vertex = [&](int skin, int i, int k) {
    return static_cast<Index>((skin * (kAlong + 1) + i) * kAround + k % kAround);
  };
  const auto quad = [&](Index a, Index b, Index c, Index d) {
    out.triangles.push_back({a, b, c});
    out.triangles.push_back({a, c, d});
  };
  for (int k = 0; k < kAround; ++k) {
    for (int i = 0; i < kAlong; ++i) {
      quad(vertex(0, i, k), vertex(0, i, k + 1), vertex(0, i + 1, k + 1), vertex(0, i + 1, k));
      quad(vertex(1, i, k), vertex(1, i + 1, k), vertex(1, i + 1, k + 1), vertex(1, i, k + 1));
    }
    quad(vertex(0, 0, k), vertex(1, 0, k), vertex(1, 0, k + 1), vertex(0, 0, k + 1));
    quad(vertex(0, kAlong, k), vertex(0, kAlong, k + 1), vertex(1, kAlong, k + 1), vertex(1, kAlong, k));
  }
  return out;
}

/// Bends a body along x into an arc of `angle`, about z.
void bend(Surface &surface, double angle) {
  if (std::abs(angle) < 1e-6) return;
  double length = 0.0;
  for (const Vec3 &x : surface.positions) length = std::max(length, 2.0 * std::abs(x[0]));
  const double radius = length / angle;
  for (Vec3 &x : surface.positions) {
    const double a = x[0] / radius, r = radius - x[1];
    x = Vec3(r * std::sin(a), radius - r * std::cos(a), x[2]);
  }
}

struct Extent {
  Vec3 low, high;
};
Extent extentOf(const Surface &surface) {
  Extent out{surface.positions.front(), surface.positions.front()};
  for (const Vec3 &x : surface.positions) {
    out.low = out.low.cwiseMin(x);
    out.high = out.high.cwiseMax(x);
  }
  return out;
}

/// The surface beyond a fraction of its extent along a direction, as a half space.
Region endOf(const Surface &surface, const Vec3 &direction, double part) {
  double low = 1e300, high = -1e300;
  for (const Vec3 &x : surface.positions) {
    low = std::min(low, direction.dot(x));
    high = std::max(high, direction.dot(x));
  }
  const double at = low + part * (high - low);
  return HalfSpaceRegion{direction * at, direction};
}

std::string draw(RandomProblem &out, Random &random) {
  const double size = logBetween(random, 0.03, 0.2);
  const double mid = between(random, 0.3, 1.0);
  const double thin = between(random, 0.25, 1.0);
  Surface surface;
  std::string name;
  switch (choice(random, 5)) {
    case 0:
      name = "lobed";
      surface = lobed(random, 0.5 * size * Vec3(1.0, mid, mid * thin), 1.0, 0.25);
      break;
    case 1:
      name = "bent";
      surface = lobed(random, 0.5 * size * Vec3(1.0, 0.3 * mid + 0.1, 0.3 * mid * thin + 0.08), 0.75, 0.08);
      bend(surface, between(random, 0.5, 2.8));
      break;
    case 2:
      name = "box";
      surface = lobed(random, 0.5 * size * Vec3(1.0, mid, mid * thin), 0.15, 0.0);
      break;
    case 3:
      name = "slab";
      surface = lobed(random, 0.5 * size * Vec3{1.0, between(random, 0.5, 1.0), between(random, 0.1, 0.2)}, 0.3, 0.0);
      bend(surface, between(random, 0.0, 1.0));
      break;
    default: {
      name = "tube";
      const double radius = size * between(random, 0.15, 0.25);
      surface = tube(radius, radius * between(random, 0.3, 0.6), size);
      const Mat3 lying = Eigen::AngleAxisd(0.5 * kPi, Vec3::UnitY()).toRotationMatrix();
      for (Vec3 &x : surface.positions) x = lying * x;
      bend(surface, between(random, 0.0, 1.0));
    }
  }
  const Mat3 turn = choice(random, 3) == 0 ? Mat3(Mat3::Identity()) : randomRotation(random);
  for (Vec3 &x : surface.positions) x = turn * x;
  out.shape = validation::meshShape(surface);

  Material material;
  constexpr MaterialLaw kLaws[] = {MaterialLaw::neoHookean, MaterialLaw::neoHookean, MaterialLaw::corotated,
                                   MaterialLaw::stVenantKirchhoff};
  material.law = kLaws[choice(random, 4)];
  material.youngsModulus = logBetween(random, 1e3, 1e5);
  material.poissonRatio = choice(random, 2) == 0 ? between(random, 0.3, 0.45) : between(random, 0.45, 0.495);
  material.restDensity = 1060.0;
  out.constitution = {{material}, kLatticeStabilisation};

  // Along the body, or anywhere.
  const Vec3 along = choice(random, 3) == 0 ? Vec3(randomRotation(random).col(0)) : Vec3(turn.col(0));
  const Vec3 pull = randomRotation(random).col(0);
  Fix fix;
  fix.region = endOf(surface, along, between(random, 0.05, 0.3));
  switch (choice(random, 4)) {
    case 0:
      name += ", hangs";
      out.recipe.fixes = {fix};
      out.gravity = 9.81 * pull;
      break;
    case 1: {
      name += ", pulled";
      out.recipe.fixes = {fix};
      Load load;
      load.region = endOf(surface, -along, between(random, 0.05, 0.2));
      load.force = pull;
      load.ramp = 0.2;
      out.recipe.loads = {load};
      break;
    }
    case 2: {
      name += ", moved";
      Fix other;
      other.region = endOf(surface, -along, between(random, 0.05, 0.2));
      other.displacement = 0.1 * size * pull;
      other.ramp = 0.2;
      out.recipe.fixes = {fix, other};
      break;
    }
    default:
      name += ", bedded";
      out.foundation.stiffness = out.foundation.tangential =
          material.youngsModulus / size * logBetween(random, 0.02, 0.5);
      out.gravity = 9.81 * pull;
  }
  return name;
}

}  // namespace

RandomProblem randomProblem(std::uint64_t seed) {
  // Neighbouring seeds must give unrelated bodies.
  Random random((seed + 1) * 0x9e3779b97f4a7c15ull ^ (seed << 17));
  for (int i = 0; i < 8; ++i) (void)random();
  RandomProblem out;
  const std::string what = draw(out, random);
  const Extent extent = extentOf(out.shape.surface);
  char text[120];
  std::snprintf(text, sizeof text, "%03llu %s, %.0f mm, nu %.3f", static_cast<unsigned long long>(seed), what.c_str(),
                1e3 * (extent.high - extent.low).maxCoeff(), out.constitution.materials.front().poissonRatio);
  out.name = text;
  return out;
}

}  // namespace dial
