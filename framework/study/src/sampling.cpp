// SPDX-License-Identifier: Apache-2.0
#include "c3de/study/sampling.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "c3de/geometry/winding_number.h"

namespace c3de::study {
namespace {

constexpr double kMetres = 1e-3;  // per mm
constexpr std::size_t kLeast = 8;

/// 0 … 1. The distributions of the standard library differ between implementations, its generator does not.
double uniform(std::mt19937_64 &random) { return static_cast<double>(random() >> 11) * 0x1p-53; }

std::size_t shareOf(double part, double whole, std::size_t count) {
  return std::max(kLeast, static_cast<std::size_t>(std::llround(part / whole * static_cast<double>(count))));
}

Vec3 corner(const geometry::TriangleMesh &mesh, std::size_t triangle, std::size_t c) {
  return mesh.vertices[mesh.triangles[triangle][c]];
}

/// Points drawn in the box until enough are inside. Empty if almost none of the box is inside.
std::vector<Vec3> drawInside(const geometry::TriangleMesh &mesh, std::size_t count, std::mt19937_64 &random) {
  const geometry::WindingNumber winding(mesh);
  const geometry::Box box = geometry::boundingBox(mesh);
  std::vector<Vec3> points;
  const std::size_t most = 100000 + 1000 * count;
  for (std::size_t tried = 0; points.size() < count && tried < most; ++tried) {
    Vec3 point{};
    for (std::size_t a = 0; a < 3; ++a) point[a] = box.min[a] + uniform(random) * (box.max[a] - box.min[a]);
    if (winding.at(point) > 0.5) points.push_back(point);
  }
  if (points.size() < count) points.clear();
  return points;
}

std::vector<Vec3> drawOnSkin(const geometry::TriangleMesh &mesh, std::size_t count, std::mt19937_64 &random) {
  std::vector<double> areas;  // up to and including each triangle
  double sum = 0.0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vec3 a = corner(mesh, t, 0);
    sum += 0.5 * norm(cross(corner(mesh, t, 1) - a, corner(mesh, t, 2) - a));
    areas.push_back(sum);
  }
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count; ++i) {
    const auto found = std::upper_bound(areas.begin(), areas.end(), uniform(random) * sum);
    const auto t = static_cast<std::size_t>(std::min(found, areas.end() - 1) - areas.begin());
    const double root = std::sqrt(uniform(random)), v = uniform(random);
    points.push_back((1.0 - root) * corner(mesh, t, 0) + (root * (1.0 - v)) * corner(mesh, t, 1) +
                     (root * v) * corner(mesh, t, 2));
  }
  return points;
}

}  // namespace

Expected<Samples> drawSamples(const std::vector<Skin> &skins, std::size_t count, std::uint64_t seed) {
  double volume = 0.0, area = 0.0;
  for (const Skin &skin : skins) {
    const double own = geometry::signedVolume(skin.mesh);
    if (!(own > 0.0) || skin.mesh.triangles.empty())
      return fail(ErrorCode::input,
                  "body '" + skin.body + "' has no skin that encloses something; fields cannot be compared");
    volume += own;
    area += geometry::surfaceArea(skin.mesh);
  }
  std::mt19937_64 random(seed);
  Samples out;
  std::vector<double> skinWeights;
  std::vector<session::SamplePoint> onSkin;
  for (const Skin &skin : skins) {
    const double ownVolume = geometry::signedVolume(skin.mesh), ownArea = geometry::surfaceArea(skin.mesh);
    const std::vector<Vec3> inside = drawInside(skin.mesh, shareOf(ownVolume, volume, count), random);
    if (inside.empty())
      return fail(ErrorCode::input,
                  "body '" + skin.body + "' fills too little of its box for points to be drawn inside");
    for (const Vec3 &point : inside) {
      out.points.push_back({skin.body, kMetres * point, 0});
      out.weights.push_back(1e-9 * ownVolume / static_cast<double>(inside.size()));
    }
    const std::vector<Vec3> outer = drawOnSkin(skin.mesh, shareOf(ownArea, area, count), random);
    for (const Vec3 &point : outer) {
      onSkin.push_back({skin.body, kMetres * point, 0});
      skinWeights.push_back(1e-6 * ownArea / static_cast<double>(outer.size()));
    }
  }
  out.inside = out.skinBegin = out.points.size();
  out.points.insert(out.points.end(), onSkin.begin(), onSkin.end());
  out.weights.insert(out.weights.end(), skinWeights.begin(), skinWeights.end());
  return out;
}

}  // namespace c3de::study
