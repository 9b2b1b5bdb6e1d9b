// SPDX-License-Identifier: Apache-2.0
#include "thin_shapes.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <set>

#include "support/random.h"

namespace validation {
namespace {

using pointbased::Index;
using pointbased::Surface;
using pointbased::Vec3;

constexpr double kTurn = 2.0 * std::numbers::pi;

// Rows of points, joined by squares; the rows are rings where `across`, and the last one joins the first where `along`.
Surface net(const std::vector<std::vector<Vec3>> &rows, bool along, bool across) {
  Surface out;
  const std::size_t n = rows.size(), m = rows.front().size();
  for (const auto &row : rows) out.positions.insert(out.positions.end(), row.begin(), row.end());
  const auto at = [&](std::size_t i, std::size_t j) { return static_cast<Index>((i % n) * m + j % m); };
  for (std::size_t i = 0; i + (along ? 0 : 1) < n; ++i)
    for (std::size_t j = 0; j + (across ? 0 : 1) < m; ++j) {
      out.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      out.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return out;
}

// A point that closes a ring of m vertices from `first` on.
void cap(Surface &surface, const Vec3 &point, Index first, Index m, bool turned) {
  const auto middle = static_cast<Index>(surface.positions.size());
  surface.positions.push_back(point);
  for (Index j = 0; j < m; ++j) {
    const Index a = first + j, b = first + (j + 1) % m;
    surface.triangles.push_back(turned ? std::array<Index, 3>{middle, b, a} : std::array<Index, 3>{middle, a, b});
  }
}

Surface textOnBackground(Surface surface) {
  double volume = 0.0, low = surface.positions.front()[1];
  for (const Vec3 &x : surface.positions) low = std::min(low, x[1]);
  for (Vec3 &x : surface.positions) x[1] -= low;
  for (const auto &[a, b, c] : surface.triangles)
    volume += surface.positions[a].dot(surface.positions[b].cross(surface.positions[c]));
  if (volume < 0.0)
    for (auto &t : surface.triangles) std::swap(t[1], t[2]);
  return surface;
}

std::vector<Vec3> circle(int n, const std::function<Vec3(double, double)> &at) {
  std::vector<Vec3> row;
  for (int j = 0; j < n; ++j) row.push_back(at(std::cos(kTurn * j / n), std::sin(kTurn * j / n)));
  return row;
}

// The border of boxes on a grid, its corners joined.
Surface boxes(const std::set<std::array<int, 3>> &filled, const Vec3 &size) {
  Surface out;
  std::map<std::array<int, 3>, Index> corners;
  const auto corner = [&](const std::array<int, 3> &at) {
    const auto [found, fresh] = corners.emplace(at, static_cast<Index>(out.positions.size()));
    if (fresh) out.positions.push_back(Vec3(at[0], at[1], at[2]).cwiseProduct(size));
    return found->second;
  };
  for (const auto &box : filled)
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const int side : {0, 1}) {
        std::array<int, 3> beside = box;
        beside[axis] += side != 0 ? 1 : -1;
        if (filled.contains(beside)) continue;
        std::array<Index, 4> face{};
        for (int k = 0; k < 4; ++k) {
          std::array<int, 3> at = box;
          at[axis] += side;
          at[(axis + 1) % 3] += k == 1 || k == 2 ? 1 : 0;
          at[(axis + 2) % 3] += k >= 2 ? 1 : 0;
          face[static_cast<std::size_t>(side != 0 ? k : 3 - k)] = corner(at);
        }
        out.triangles.push_back({face[0], face[1], face[2]});
        out.triangles.push_back({face[0], face[2], face[3]});
      }
  return out;
}

}  // namespace

Surface latheSurface(int rings, int around, const std::function<Vec3(int ring, double phi)> &at) {
  Surface out;
  out.positions.push_back(at(0, 0.0));
  for (int r = 1; r < rings; ++r)
    for (int k = 0; k < around; ++k) out.positions.push_back(at(r, kTurn * k / around));
  out.positions.push_back(at(rings, 0.0));
  const auto vertex = [&](int ring, int k) -> Index {
    if (ring == 0) return 0;
    if (ring == rings) return static_cast<Index>(out.positions.size() - 1);
    return static_cast<Index>(1 + (ring - 1) * around + k % around);
  };
  for (int r = 0; r < rings; ++r)
    for (int k = 0; k < around; ++k) {
      const Index a = vertex(r, k), b = vertex(r, k + 1), c = vertex(r + 1, k), d = vertex(r + 1, k + 1);
      if (r > 0) out.triangles.push_back({a, b, c});
      if (r + 1 < rings) out.triangles.push_back({b, d, c});
    }
  return out;
}

Surface tubeSurface(double radius, double wall, double length) {
  constexpr int kAlong = 60, kAround = 48;
  std::vector<std::pair<double, double>> section;  // radius, x
  for (int i = 0; i < kAlong; ++i) section.emplace_back(radius, length * (double(i) / kAlong - 0.5));
  section.emplace_back(radius, 0.5 * length);
  for (int i = 0; i < kAlong; ++i) section.emplace_back(radius - wall, length * (0.5 - double(i) / kAlong));
  section.emplace_back(radius - wall, -0.5 * length);
  std::vector<std::vector<Vec3>> rows;
  for (const auto &[r, x] : section)
    rows.push_back(circle(kAround, [r = r, x = x](double c, double s) { return Vec3(x, r * c, r * s); }));
  return textOnBackground(net(rows, true, true));
}

Surface sheetSurface(double edge, double thickness) {
  constexpr int kAcross = 40;
  std::set<std::array<int, 3>> filled;
  for (int i = 0; i < kAcross; ++i)
    for (int k = 0; k < kAcross; ++k) filled.insert({i, 0, k});
  return textOnBackground(boxes(filled, Vec3(edge / kAcross, thickness, edge / kAcross)));
}

Surface ringSurface(double radius, double section) {
  std::vector<std::vector<Vec3>> rows;
  for (const Vec3 &out : circle(96, [](double c, double s) { return Vec3(c, s, 0.0); }))
    rows.push_back(circle(
        24, [&](double c, double s) { return Vec3((radius + section * c) * out + section * s * Vec3::UnitZ()); }));
  return textOnBackground(net(rows, true, true));
}

Surface helixSurface(double radius, double section, double pitch, int turns) {
  const int points = 75 * turns;
  constexpr int kAround = 16;
  std::vector<std::vector<Vec3>> rows;
  std::vector<Vec3> middle;
  for (int i = 0; i < points; ++i) {
    const double angle = kTurn * turns * i / (points - 1.0), c = std::cos(angle), s = std::sin(angle);
    const Vec3 outward(c, 0.0, s), along = Vec3(-radius * s, pitch / kTurn, radius * c).normalized();
    middle.push_back(radius * outward + Vec3(0.0, pitch * angle / kTurn, 0.0));
    rows.push_back(circle(kAround, [&](double a, double b) {
      return Vec3(middle.back() + section * (a * outward + b * along.cross(outward)));
    }));
  }
  Surface out = net(rows, false, true);
  cap(out, middle.front(), 0, kAround, false);
  cap(out, middle.back(), static_cast<Index>(kAround * (points - 1)), kAround, true);
  return textOnBackground(out);
}

Surface combSurface(int fingers, double width, double length) {
  std::set<std::array<int, 3>> filled;
  for (int i = 0; i < 2 * fingers - 1; ++i)
    for (int j = 0; j < 12; ++j)
      if (j >= 10 || i % 2 == 0) filled.insert({i, j, 0});
  return textOnBackground(boxes(filled, Vec3(width, length / 10, width)));
}

Surface starSurface(double reach, double radius) {
  constexpr int kAround = 64, kDown = 48;
  support::Random random(5);
  std::vector<Vec3> spikes;
  while (spikes.size() < 7) {
    const Vec3 way = random.vector();
    if (way.norm() > 0.3) spikes.push_back(way.normalized());
  }
  const auto place = [&](const Vec3 &way) {
    double most = 0.0;
    for (const Vec3 &spike : spikes) most = std::max(most, std::exp((spike.dot(way) - 1.0) / 0.01));
    return Vec3((radius + (reach - radius) * most) * way);
  };
  std::vector<std::vector<Vec3>> rows;
  for (int j = 1; j <= kDown; ++j) {
    const double down = std::numbers::pi * j / (kDown + 1);
    rows.push_back(circle(kAround, [&](double c, double s) {
      return place(Vec3(std::sin(down) * c, std::cos(down), std::sin(down) * s));
    }));
  }
  Surface out = net(rows, false, true);
  cap(out, place(Vec3::UnitY()), 0, kAround, false);
  cap(out, place(-Vec3::UnitY()), static_cast<Index>(kAround * (kDown - 1)), kAround, true);
  return textOnBackground(out);
}

}  // namespace validation
