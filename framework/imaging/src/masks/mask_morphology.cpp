// SPDX-License-Identifier: Apache-2.0
// Closing and opening: voxels within a radius of a set, by squared distances between voxel centres.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "c3de/imaging/masks.h"
#include "masks/mask_tools.h"

namespace c3de::imaging {
namespace {

constexpr double kMaxVoxels = 128.0;      // of a radius
constexpr double kOrthogonal = 1e-6;      // cosine between axes
constexpr double kRounding = 1.0 + 1e-6;  // of squared distances in single precision

using Size3 = std::array<std::size_t, 3>;

struct Ball {
  double radius = 0.0;  // mm
  Mat4 axes{};
  Vec3 spacing{};
  bool orthogonal = true;
  Size3 reach{};  // voxels along each axis
};

Expected<Ball> ballOf(const VolumeGeometry &geometry, double radius) {
  if (!(radius > 0.0) || !std::isfinite(radius))
    return fail(ErrorCode::usage, fmt::format("a radius of {} mm is not accepted: finite and > 0", radius));
  Ball ball{radius, geometry.indexToWorld, geometry.spacing(), geometry.shear() < kOrthogonal, {}};
  const Mat4 inverse = affineInverse(geometry.indexToWorld);
  for (std::size_t a = 0; a < 3; ++a) {
    const double voxels = radius * kRounding * norm({inverse[a], inverse[4 + a], inverse[8 + a]});
    if (voxels > kMaxVoxels)
      return fail(ErrorCode::usage,
                  fmt::format("a radius of {:.4g} mm is {:.0f} voxels of {:.3g} mm; at most {:.0f} are accepted",
                              radius, voxels, ball.spacing[a], kMaxVoxels));
    ball.reach[a] = static_cast<std::size_t>(voxels);
  }
  return ball;
}

// Determines whether every voxel is within the radius of one that is set; on its own grid.
class Growth {
 public:
  Growth(const Ball &ball, const Size3 &n) : ball_(ball), n_(n) {}

  bool grow(std::vector<std::uint8_t> &bits, const ProgressFn &progress) {
    return ball_.orthogonal ? byDistance(bits, progress) : byStamps(bits, progress);
  }

 private:
  static constexpr float kFar = 1e30f;

  // out[i] = min over offsets o along an axis of in[row + o][i] + (o s)²; a row is a line of voxels along i.
  void lowest(std::span<const float> in, std::span<const std::uint8_t> any, std::size_t rows, std::size_t reach,
              double s, std::size_t row, float *out) const {
    const std::size_t nx = n_[0];
    const std::size_t first = row > reach ? row - reach : 0, last = std::min(rows, row + reach + 1);
    for (std::size_t other = first; other < last; ++other) {
      if (any[other] == 0) continue;
      const double away = (static_cast<double>(other) - static_cast<double>(row)) * s;
      const auto add = static_cast<float>(away * away);
      const float *from = in.data() + other * nx;
      for (std::size_t i = 0; i < nx; ++i) out[i] = std::min(out[i], from[i] + add);
    }
  }

  bool byDistance(std::vector<std::uint8_t> &bits, const ProgressFn &progress) {
    const std::size_t nx = n_[0], ny = n_[1], nz = n_[2];
    const auto limit = static_cast<float>(ball_.radius * ball_.radius * kRounding);
    std::vector<float> squares(nx * ny * nz), lines;
    std::vector<std::uint8_t> any(ny * nz), anyLine;
    lines.resize(nx * ny);
    anyLine.resize(ny);
    for (std::size_t k = 0; k < nz; ++k) {
      for (std::size_t j = 0; j < ny; ++j)
        anyLine[j] = alongRow(bits.data() + nx * (j + ny * k), limit, lines.data() + nx * j);
      for (std::size_t j = 0; j < ny; ++j) {
        float *out = squares.data() + nx * (j + ny * k);
        std::fill(out, out + nx, kFar);
        lowest(lines, anyLine, ny, ball_.reach[1], ball_.spacing[1], j, out);
        any[j + ny * k] = *std::min_element(out, out + nx) <= limit ? 1 : 0;
      }
      if (!goesOn(progress, 0.5 * static_cast<double>(k + 1) / static_cast<double>(nz), "distances")) return false;
    }
    lines.resize(nx * nz);
    anyLine.resize(nz);
    std::vector<float> best(nx);
    for (std::size_t j = 0; j < ny; ++j) {
      for (std::size_t k = 0; k < nz; ++k) {
        const float *from = squares.data() + nx * (j + ny * k);
        std::copy(from, from + nx, lines.data() + nx * k);
        anyLine[k] = any[j + ny * k];
      }
      for (std::size_t k = 0; k < nz; ++k) {
        std::fill(best.begin(), best.end(), kFar);
        lowest(lines, anyLine, nz, ball_.reach[2], ball_.spacing[2], k, best.data());
        std::uint8_t *out = bits.data() + nx * (j + ny * k);
        for (std::size_t i = 0; i < nx; ++i) out[i] = best[i] <= limit ? 1 : 0;
      }
      if (!goesOn(progress, 0.5 + 0.5 * static_cast<double>(j + 1) / static_cast<double>(ny), "distances"))
        return false;
    }
    return true;
  }

  // Squared distances along one row; whether any is within the radius.
  std::uint8_t alongRow(const std::uint8_t *bits, float limit, float *out) const {
    const std::size_t nx = n_[0];
    const auto s = static_cast<float>(ball_.spacing[0]);
    bool any = false;
    float steps = kFar;
    for (std::size_t i = 0; i < nx; ++i) out[i] = steps = bits[i] != 0 ? 0.0f : steps + 1.0f;
    steps = kFar;
    for (std::size_t i = nx; i-- > 0;) {
      steps = bits[i] != 0 ? 0.0f : steps + 1.0f;
      const float away = std::min(out[i], steps) * s;
      out[i] = away < 1e14f ? away * away : kFar;
      any = any || out[i] <= limit;
    }
    return any ? 1 : 0;
  }

  // On a sheared grid squared distances are not a sum over the axes: every border voxel of the set covers its ball.
  bool byStamps(std::vector<std::uint8_t> &bits, const ProgressFn &progress) {
    struct Line {
      std::ptrdiff_t j, k, from, to;
    };
    std::vector<Line> lines;
    const auto r = [&](std::size_t a) { return static_cast<std::ptrdiff_t>(ball_.reach[a]); };
    for (std::ptrdiff_t k = -r(2); k <= r(2); ++k)
      for (std::ptrdiff_t j = -r(1); j <= r(1); ++j) {
        Line line{j, k, 1, 0};
        for (std::ptrdiff_t i = -r(0); i <= r(0); ++i) {
          Vec3 way{};
          for (std::size_t c = 0; c < 3; ++c)
            way[c] = ball_.axes[c] * static_cast<double>(i) + ball_.axes[4 + c] * static_cast<double>(j) +
                     ball_.axes[8 + c] * static_cast<double>(k);
          if (dot(way, way) > ball_.radius * ball_.radius * kRounding) continue;
          if (line.from > line.to) line.from = i;
          line.to = i;
        }
        if (line.from <= line.to) lines.push_back(line);
      }
    const std::vector<std::uint8_t> before = bits;
    const auto n = [&](std::size_t a) { return static_cast<std::ptrdiff_t>(n_[a]); };
    for (std::ptrdiff_t k = 0; k < n(2); ++k) {
      for (std::ptrdiff_t j = 0; j < n(1); ++j)
        for (std::ptrdiff_t i = 0; i < n(0); ++i) {
          const std::ptrdiff_t at = i + n(0) * (j + n(1) * k);
          const auto set = [&](std::ptrdiff_t v) { return before[static_cast<std::size_t>(v)] != 0; };
          if (!set(at)) continue;
          const bool within = i > 0 && i + 1 < n(0) && j > 0 && j + 1 < n(1) && k > 0 && k + 1 < n(2) && set(at - 1) &&
                              set(at + 1) && set(at - n(0)) && set(at + n(0)) && set(at - n(0) * n(1)) &&
                              set(at + n(0) * n(1));
          if (within) continue;
          for (const Line &line : lines) {
            const std::ptrdiff_t y = j + line.j, z = k + line.k;
            if (y < 0 || y >= n(1) || z < 0 || z >= n(2)) continue;
            const std::ptrdiff_t from = std::max<std::ptrdiff_t>(0, i + line.from),
                                 to = std::min(n(0) - 1, i + line.to);
            for (std::ptrdiff_t x = from; x <= to; ++x) bits[static_cast<std::size_t>(x + n(0) * (y + n(1) * z))] = 1;
          }
        }
      if (!goesOn(progress, static_cast<double>(k + 1) / static_cast<double>(n(2)), "distances")) return false;
    }
    return true;
  }

  const Ball &ball_;
  Size3 n_;
};

void invert(std::vector<std::uint8_t> &bits) {
  for (std::uint8_t &b : bits) b = b != 0 ? 0 : 1;
}

// Rows of a box of voxels that may extend beyond the grid; visit(offset in the box, offset in the grid, length).
struct Window {
  std::array<std::ptrdiff_t, 3> low{};
  Size3 n{};

  template <class Visit>
  void forRows(const Size3 &grid, const Visit &visit) const {
    const auto size = [&](std::size_t a) { return static_cast<std::ptrdiff_t>(grid[a]); };
    const std::ptrdiff_t from = std::max<std::ptrdiff_t>(0, low[0]);
    const std::ptrdiff_t to = std::min(size(0), low[0] + static_cast<std::ptrdiff_t>(n[0]));
    for (std::size_t k = 0; k < n[2]; ++k)
      for (std::size_t j = 0; j < n[1]; ++j) {
        const std::ptrdiff_t y = low[1] + static_cast<std::ptrdiff_t>(j), z = low[2] + static_cast<std::ptrdiff_t>(k);
        if (y < 0 || y >= size(1) || z < 0 || z >= size(2) || to <= from) continue;
        visit(static_cast<std::size_t>(from - low[0]) + n[0] * (j + n[1] * k),
              static_cast<std::size_t>(from + size(0) * (y + size(1) * z)), static_cast<std::size_t>(to - from));
      }
  }
};

enum class Order { growFirst, shrinkFirst, growOnly };

Expected<Mask> growAndShrink(const Mask &mask, double radius, Order order, const ProgressFn &progress) {
  if (const auto good = checkMask(mask); !good) return tl::unexpected(good.error());
  const auto ball = ballOf(mask.geometry, radius);
  if (!ball) return tl::unexpected(ball.error());
  const VoxelBox box = boxAround(mask);
  if (box.empty()) return mask;
  // A closing may temporarily extend beyond the grid; an opening uses the grid alone.
  Window window;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto margin = static_cast<std::ptrdiff_t>(ball->reach[a] + 1);
    std::ptrdiff_t low = static_cast<std::ptrdiff_t>(box.min[a]) - margin;
    std::ptrdiff_t high = static_cast<std::ptrdiff_t>(box.max[a]) + margin;
    if (order == Order::shrinkFirst) {
      low = std::max<std::ptrdiff_t>(0, low);
      high = std::min(static_cast<std::ptrdiff_t>(mask.geometry.size[a]), high);
    }
    window.low[a] = low;
    window.n[a] = static_cast<std::size_t>(high - low);
  }
  std::vector<std::uint8_t> bits(window.n[0] * window.n[1] * window.n[2], 0);
  window.forRows(mask.geometry.size, [&](std::size_t at, std::size_t in, std::size_t length) {
    for (std::size_t i = 0; i < length; ++i) bits[at + i] = mask.voxels[in + i] != 0 ? 1 : 0;
  });
  Growth growth(*ball, window.n);
  const int steps = order == Order::growOnly ? 1 : 2;
  for (int step = 0; step < steps; ++step) {
    const bool grows = (step == 0) == (order != Order::shrinkFirst);
    if (!grows) invert(bits);
    if (!growth.grow(bits, stage(progress, 1.0 * step / steps, 1.0 * (step + 1) / steps))) return cancelled();
    if (!grows) invert(bits);
  }
  Mask out{mask.geometry, order != Order::shrinkFirst ? mask.voxels : std::vector<std::uint8_t>(mask.voxels.size(), 0)};
  window.forRows(mask.geometry.size, [&](std::size_t at, std::size_t in, std::size_t length) {
    for (std::size_t i = 0; i < length; ++i) out.voxels[in + i] = bits[at + i];
  });
  return out;
}

}  // namespace

Expected<Mask> closed(const Mask &mask, double radius_mm, const ProgressFn &progress) {
  return growAndShrink(mask, radius_mm, Order::growFirst, progress);
}

Expected<Mask> grown(const Mask &mask, double radius_mm, const ProgressFn &progress) {
  return growAndShrink(mask, radius_mm, Order::growOnly, progress);
}

Expected<Mask> opened(const Mask &mask, double radius_mm, const ProgressFn &progress) {
  return growAndShrink(mask, radius_mm, Order::shrinkFirst, progress);
}

}  // namespace c3de::imaging
