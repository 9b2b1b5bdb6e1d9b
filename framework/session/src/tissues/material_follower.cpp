// SPDX-License-Identifier: Apache-2.0
#include "tissues/material_follower.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "c3de/imaging/masks.h"

namespace c3de::session {
namespace {

constexpr std::uint8_t kInside = 2, kBeside = 1;               // relation of grid points to a body
constexpr double kClose = 1e-4, kNear = 0.02, kEnough = 0.05;  // of a step

using Mat3 = std::array<Vec3, 3>;  // columns

double determinant(const Mat3 &m) { return dot(m[0], cross(m[1], m[2])); }

/// m y = b; the determinant is not 0.
Vec3 solved(const Mat3 &m, const Vec3 &b) {
  const double d = 1.0 / determinant(m);
  return {d * dot(b, cross(m[1], m[2])), d * dot(m[0], cross(b, m[2])), d * dot(m[0], cross(m[1], b))};
}

}  // namespace

MaterialFollower::MaterialFollower(const imaging::DisplacementGrid &u, const imaging::WorldBox &reference,
                                   std::vector<std::uint8_t> own)
    : u_(u), own_(std::move(own)), toIndex_(imaging::affineInverse(u.geometry.indexToWorld)), low_(reference.low) {
  const Vec3 steps = u.geometry.spacing();
  step_ = std::min({steps[0], steps[1], steps[2]});
  for (std::size_t a = 0; a < 3; ++a)
    size_[a] = static_cast<std::size_t>((reference.high[a] - low_[a]) / (2.0 * step_)) + 1;
  seeds_.assign(size_[0] * size_[1] * size_[2], Seed{});
  std::size_t p = 0;
  const auto &n = u.geometry.size;
  for (std::size_t k = 0; k < n[2]; ++k)
    for (std::size_t j = 0; j < n[1]; ++j)
      for (std::size_t i = 0; i < n[0]; ++i, ++p) {
        // A gap: the displacement points to a location that this material has left.
        if (u.gap_mm[p] > u.leastGap() || (!own_.empty() && own_[p] == 0)) continue;
        const Vec3 d{u.xyz_mm[3 * p], u.xyz_mm[3 * p + 1], u.xyz_mm[3 * p + 2]};
        const Vec3 x = u.geometry.worldAt({static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
        const bool isInside = own_.empty() || own_[p] == kInside;
        if (const auto cell = cellOf(x - d, {}); cell && (isInside || !seeds_[*cell].isInside))
          seeds_[*cell] = {x, isInside};
      }
}

std::optional<MaterialFollower::Found> MaterialFollower::find(const Vec3 &X) const {
  std::optional<Found> best;
  double least = std::numeric_limits<double>::infinity();
  // Where pieces of a body have separated, space next to one piece overlaps the former position of another. The
  // solution nearest the body is the right one.
  for (const Vec3 &seed : seedsOf(X)) {
    const auto found = findFrom(seed, X);
    if (!found) continue;
    const double outside = outsideAt(X + found->displacement);
    if (outside < least) {
      least = outside;
      best = found;
    }
    if (least <= step_) break;
  }
  return best;
}

std::optional<Vec3> MaterialFollower::findNear(const Vec3 &X, const Vec3 &known) const {
  // The fixed-point iteration converges: u changes by less than the distance of two positions unless tissue overlaps
  // itself.
  Vec3 u = known;
  for (int i = 0; i < 8; ++i) {
    const Vec3 next = u_.continuousAt(X + u);
    const double change = norm(next - u);
    u = next;
    if (change < kNear * step_ && isOwnAt(X + u)) return u;
  }
  const auto found = find(X);
  if (!found) return std::nullopt;
  return found->displacement;
}

std::optional<MaterialFollower::Found> MaterialFollower::findFrom(Vec3 x, const Vec3 &X) const {
  const auto miss = [&] { return X - (x - u_.continuousAt(x)); };
  Vec3 missing = miss();
  // Newton's method: exact for affine motion, even for large rotations of the body.
  for (int i = 0; i < 16 && norm(missing) > kClose * step_; ++i) {
    const Mat3 slope = inverseGradient(x);
    if (determinant(slope) == 0.0) return std::nullopt;
    Vec3 way = solved(slope, missing);
    if (const double length = norm(way); length > 2.0 * step_) way = (2.0 * step_ / length) * way;
    x = x + way;
    missing = miss();
  }
  const double J = 1.0 / determinant(inverseGradient(x));
  if (!(norm(missing) <= kEnough * step_) || !std::isfinite(J) || !isOwnAt(x)) return std::nullopt;
  return Found{x - X, J};
}

double MaterialFollower::outsideAt(const Vec3 &x) const {
  if (own_.empty()) return 0.0;
  const Vec3 index = transformPoint(toIndex_, x);
  const auto &n = u_.geometry.size;
  double least = std::numeric_limits<double>::infinity();
  for (int k = -1; k <= 1; ++k)
    for (int j = -1; j <= 1; ++j)
      for (int i = -1; i <= 1; ++i) {
        const Vec3 at{std::floor(index[0] + 0.5) + i, std::floor(index[1] + 0.5) + j, std::floor(index[2] + 0.5) + k};
        bool isThere = true;
        for (std::size_t a = 0; a < 3; ++a) isThere = isThere && at[a] >= 0.0 && at[a] < static_cast<double>(n[a]);
        if (!isThere) continue;
        const std::size_t p = static_cast<std::size_t>(at[0]) +
                              n[0] * (static_cast<std::size_t>(at[1]) + n[1] * static_cast<std::size_t>(at[2]));
        if (own_[p] == kInside) least = std::min(least, norm(u_.geometry.worldAt(at) - x));
      }
  return least;
}

bool MaterialFollower::isOwnAt(const Vec3 &x) const {
  if (own_.empty()) return true;
  const Vec3 index = transformPoint(toIndex_, x);
  const auto &n = u_.geometry.size;
  std::array<std::size_t, 3> at{};
  for (std::size_t a = 0; a < 3; ++a) {
    const double nearest = std::floor(index[a] + 0.5);
    if (!(nearest >= 0.0 && nearest < static_cast<double>(n[a]))) return false;
    at[a] = static_cast<std::size_t>(nearest);
  }
  return own_[at[0] + n[0] * (at[1] + n[1] * at[2])] != 0;
}

MaterialFollower::Mat3 MaterialFollower::inverseGradient(const Vec3 &x) const {
  Mat3 out{};
  const double h = 0.5 * step_;
  for (std::size_t a = 0; a < 3; ++a) {
    Vec3 way{};
    way[a] = h;
    out[a] = (-0.5 / h) * (u_.continuousAt(x + way) - u_.continuousAt(x - way));
    out[a][a] += 1.0;
  }
  return out;
}

std::optional<std::size_t> MaterialFollower::cellOf(const Vec3 &X, const std::array<int, 3> &beside) const {
  std::array<std::size_t, 3> at{};
  for (std::size_t a = 0; a < 3; ++a) {
    const double cell = std::floor((X[a] - low_[a]) / (2.0 * step_)) + beside[a];
    if (!(cell >= 0.0 && cell < static_cast<double>(size_[a]))) return std::nullopt;
    at[a] = static_cast<std::size_t>(cell);
  }
  return at[0] + size_[0] * (at[1] + size_[1] * at[2]);
}

std::vector<Vec3> MaterialFollower::seedsOf(const Vec3 &X) const {
  std::array<std::pair<int, Vec3>, 27> found;
  std::size_t count = 0;
  for (int k = -1; k <= 1; ++k)
    for (int j = -1; j <= 1; ++j)
      for (int i = -1; i <= 1; ++i) {
        const auto cell = cellOf(X, {i, j, k});
        if (!cell || std::isnan(seeds_[*cell].x[0])) continue;
        found[count++] = {std::abs(i) + std::abs(j) + std::abs(k) + (seeds_[*cell].isInside ? 0 : 4), seeds_[*cell].x};
      }
  if (count == 0) return {X};
  std::stable_sort(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(count),
                   [](const auto &a, const auto &b) { return a.first < b.first; });
  std::vector<Vec3> seeds(count);
  std::transform(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(count), seeds.begin(),
                 [](const auto &one) { return one.second; });
  return seeds;
}

std::vector<std::uint8_t> ownPoints(const std::vector<BodyState> &bodies, const std::string &name,
                                    const imaging::VolumeGeometry &grid) {
  std::vector<std::uint8_t> own;
  for (const BodyState &body : bodies)
    if (body.name == name && !body.skin.triangles.empty()) own = imaging::maskOf(body.skin, grid).voxels;
  if (own.empty()) return {};
  // A single body may be thinner than the grid: points next to it are valid at any distance.
  for (std::uint8_t &one : own) one = one != 0 ? kInside : bodies.size() == 1 ? kBeside : 0;
  // Next to it: along each axis in turn.
  constexpr std::ptrdiff_t kFar = 2;
  std::size_t stride = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::vector<std::uint8_t> before = own;
    const auto n = static_cast<std::ptrdiff_t>(grid.size[a]);
    for (std::size_t v = 0; v < own.size(); ++v) {
      if (before[v] != 0) continue;
      const auto at = static_cast<std::ptrdiff_t>(v / stride % grid.size[a]);
      for (std::ptrdiff_t d = std::max(-kFar, -at); d <= std::min(kFar, n - 1 - at) && own[v] == 0; ++d)
        if (before[static_cast<std::size_t>(static_cast<std::ptrdiff_t>(v) + d * static_cast<std::ptrdiff_t>(stride))])
          own[v] = kBeside;
    }
    stride *= grid.size[a];
  }
  for (const BodyState &body : bodies) {
    if (body.name == name) continue;
    const std::vector<std::uint8_t> other = imaging::maskOf(body.skin, grid).voxels;
    for (std::size_t v = 0; v < own.size(); ++v)
      if (other[v] != 0) own[v] = 0;
  }
  return own;
}

}  // namespace c3de::session
