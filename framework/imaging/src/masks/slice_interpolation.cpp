// SPDX-License-Identifier: Apache-2.0
// Shape-based interpolation between slices: Raya and Udupa, IEEE Trans. Med. Imaging 9 (1990).
#include <algorithm>
#include <cmath>
#include <limits>

#include "c3de/imaging/painting.h"
#include "masks/mask_tools.h"

namespace c3de::imaging {
namespace {

/// One slice of a grid, and its in-plane steps in mm.
struct Plane {
  std::size_t columns = 0, rows = 0;
  Vec3 right{}, down{};
};

/// Lower envelope of parabolas (Felzenszwalb and Huttenlocher, Theory of Computing 8, 2012): squared distances along a
/// line with steps of the given length.
void transformLine(std::vector<double> &values, double step, std::vector<double> &scratch,
                   std::vector<std::size_t> &apex, std::vector<double> &border) {
  const std::size_t n = values.size();
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  apex.clear();
  border.clear();
  const auto crossing = [&](std::size_t p, std::size_t q) {
    const double xp = step * static_cast<double>(p), xq = step * static_cast<double>(q);
    return ((values[q] + xq * xq) - (values[p] + xp * xp)) / (2.0 * (xq - xp));
  };
  for (std::size_t q = 0; q < n; ++q) {
    if (values[q] == kInfinite) continue;
    while (!apex.empty() && crossing(apex.back(), q) <= border.back()) {
      apex.pop_back();
      border.pop_back();
    }
    border.push_back(apex.empty() ? -kInfinite : crossing(apex.back(), q));
    apex.push_back(q);
  }
  scratch.assign(n, kInfinite);
  for (std::size_t i = 0, k = 0; i < n && !apex.empty(); ++i) {
    const double x = step * static_cast<double>(i);
    while (k + 1 < apex.size() && border[k + 1] < x) ++k;
    const double away = x - step * static_cast<double>(apex[k]);
    scratch[i] = away * away + values[apex[k]];
  }
  values.swap(scratch);
}

/// Distances in mm to the nearest pixel with the value `target`; infinite if there is none.
std::vector<double> distancesTo(const std::vector<std::uint8_t> &pixels, std::uint8_t target, const Plane &plane) {
  std::vector<double> squares(pixels.size()), line, scratch;
  std::vector<std::size_t> apex;
  std::vector<double> border;
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  std::transform(pixels.begin(), pixels.end(), squares.begin(),
                 [&](std::uint8_t p) { return p == target ? 0.0 : kInfinite; });
  line.resize(plane.columns);
  for (std::size_t r = 0; r < plane.rows; ++r) {
    const auto begin = squares.begin() + static_cast<std::ptrdiff_t>(r * plane.columns);
    std::copy_n(begin, plane.columns, line.begin());
    transformLine(line, norm(plane.right), scratch, apex, border);
    std::copy_n(line.begin(), plane.columns, begin);
  }
  line.resize(plane.rows);
  for (std::size_t c = 0; c < plane.columns; ++c) {
    for (std::size_t r = 0; r < plane.rows; ++r) line[r] = squares[c + plane.columns * r];
    transformLine(line, norm(plane.down), scratch, apex, border);
    for (std::size_t r = 0; r < plane.rows; ++r) squares[c + plane.columns * r] = line[r];
  }
  for (double &s : squares) s = std::sqrt(s);
  return squares;
}

/// A slice with voxels: its outline as signed distances (mm, negative inside), and its centroid in pixels.
struct Outline {
  std::vector<std::uint8_t> pixels;
  std::vector<double> distance_mm;
  double column = 0.0, row = 0.0;

  Outline(std::vector<std::uint8_t> slice, const Plane &plane) : pixels(std::move(slice)) {
    const std::vector<double> outside = distancesTo(pixels, 1, plane), inside = distancesTo(pixels, 0, plane);
    // A slice that is full has no outline within the image; its inside is half an image deep.
    const double deep = 0.5 * (static_cast<double>(plane.columns) * norm(plane.right) +
                               static_cast<double>(plane.rows) * norm(plane.down));
    distance_mm.resize(pixels.size());
    double count = 0.0;
    for (std::size_t p = 0; p < pixels.size(); ++p) {
      distance_mm[p] = pixels[p] != 0 ? -std::min(inside[p], deep) : outside[p];
      if (pixels[p] == 0) continue;
      column += static_cast<double>(p % plane.columns);
      row += static_cast<double>(p / plane.columns);
      count += 1.0;
    }
    column /= count;
    row /= count;
  }

  /// Bilinear between pixel centres, constant beyond the border.
  [[nodiscard]] double at(double c, double r, const Plane &plane) const {
    c = std::clamp(c, 0.0, static_cast<double>(plane.columns - 1));
    r = std::clamp(r, 0.0, static_cast<double>(plane.rows - 1));
    const auto c0 = static_cast<std::size_t>(c), r0 = static_cast<std::size_t>(r);
    const std::size_t c1 = std::min(c0 + 1, plane.columns - 1), r1 = std::min(r0 + 1, plane.rows - 1);
    const double u = c - static_cast<double>(c0), v = r - static_cast<double>(r0);
    const auto d = [&](std::size_t x, std::size_t y) { return distance_mm[x + plane.columns * y]; };
    return (1.0 - v) * ((1.0 - u) * d(c0, r0) + u * d(c1, r0)) + v * ((1.0 - u) * d(c0, r1) + u * d(c1, r1));
  }
};

bool overlap(const Outline &a, const Outline &b) {
  for (std::size_t p = 0; p < a.pixels.size(); ++p)
    if (a.pixels[p] != 0 && b.pixels[p] != 0) return true;
  return false;
}

/// The slices of a mask along one axis.
class Slices {
 public:
  Slices(const VolumeGeometry &grid, std::size_t axis) : n_(grid.size), axis_(axis) {
    const std::size_t a = axis == 0 ? 1 : 0, b = axis == 2 ? 1 : 2;
    const auto step = [&](std::size_t c) {
      return Vec3{grid.indexToWorld[4 * c], grid.indexToWorld[4 * c + 1], grid.indexToWorld[4 * c + 2]};
    };
    plane_ = {n_[a], n_[b], step(a), step(b)};
  }
  [[nodiscard]] const Plane &plane() const { return plane_; }
  [[nodiscard]] std::size_t count() const { return n_[axis_]; }
  [[nodiscard]] std::size_t offset(std::size_t slice, std::size_t column, std::size_t row) const {
    const Index3 i = axis_ == 0   ? Index3{slice, column, row}
                     : axis_ == 1 ? Index3{column, slice, row}
                                  : Index3{column, row, slice};
    return i[0] + n_[0] * (i[1] + n_[1] * i[2]);
  }
  [[nodiscard]] std::vector<std::uint8_t> slice(const Mask &mask, std::size_t index) const {
    std::vector<std::uint8_t> pixels(plane_.columns * plane_.rows);
    for (std::size_t r = 0; r < plane_.rows; ++r)
      for (std::size_t c = 0; c < plane_.columns; ++c)
        pixels[c + plane_.columns * r] = mask.voxels[offset(index, c, r)] != 0 ? 1 : 0;
    return pixels;
  }

 private:
  using Index3 = std::array<std::size_t, 3>;
  Index3 n_;
  std::size_t axis_;
  Plane plane_;
};

void fillGap(Mask &mask, const Slices &slices, std::size_t first, std::size_t last) {
  const Plane &plane = slices.plane();
  const Outline from(slices.slice(mask, first), plane), to(slices.slice(mask, last), plane);
  const bool isMoved = !overlap(from, to);
  const double dc = isMoved ? to.column - from.column : 0.0, dr = isMoved ? to.row - from.row : 0.0;
  for (std::size_t s = first + 1; s < last; ++s) {
    const double t = static_cast<double>(s - first) / static_cast<double>(last - first);
    for (std::size_t r = 0; r < plane.rows; ++r)
      for (std::size_t c = 0; c < plane.columns; ++c) {
        const auto column = static_cast<double>(c), row = static_cast<double>(r);
        const double a = from.at(column - t * dc, row - t * dr, plane),
                     b = to.at(column + (1.0 - t) * dc, row + (1.0 - t) * dr, plane);
        if ((1.0 - t) * a + t * b <= 0.0) mask.voxels[slices.offset(s, c, r)] = 1;
      }
  }
}

/// Which slices along an axis contain voxels.
std::vector<bool> filledSlices(const Mask &mask, std::size_t axis) {
  const auto &n = mask.geometry.size;
  std::vector<bool> isFilled(n[axis], false);
  std::size_t v = 0;
  std::array<std::size_t, 3> i{};
  for (i[2] = 0; i[2] < n[2]; ++i[2])
    for (i[1] = 0; i[1] < n[1]; ++i[1])
      for (i[0] = 0; i[0] < n[0]; ++i[0], ++v)
        if (mask.voxels[v] != 0) isFilled[i[axis]] = true;
  return isFilled;
}

}  // namespace

std::array<std::size_t, 3> emptySlicesBetween(const Mask &mask) {
  std::array<std::size_t, 3> empty{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::vector<bool> isFilled = filledSlices(mask, axis);
    const auto first = std::find(isFilled.begin(), isFilled.end(), true);
    const auto last = std::find(isFilled.rbegin(), isFilled.rend(), true).base();
    if (first < last) empty[axis] = static_cast<std::size_t>(std::count(first, last, false));
  }
  return empty;
}

Expected<Mask> filledBetweenSlices(const Mask &mask, std::size_t axis, const ProgressFn &progress) {
  if (auto checked = checkMask(mask); !checked) return tl::unexpected(checked.error());
  if (axis > 2) return fail(ErrorCode::internal, "a grid has three axes");
  const std::vector<bool> isFilled = filledSlices(mask, axis);
  Mask out = mask;
  const Slices slices(mask.geometry, axis);
  std::size_t before = isFilled.size();
  bool isAny = false;
  for (std::size_t s = 0; s < isFilled.size(); ++s) {
    if (!goesOn(progress, static_cast<double>(s) / static_cast<double>(isFilled.size()), "filling slices"))
      return cancelled();
    if (!isFilled[s]) continue;
    if (before < s && s - before > 1) {
      fillGap(out, slices, before, s);
      isAny = true;
    }
    before = s;
  }
  if (!isAny)
    return fail(ErrorCode::usage,
                "there is no empty slice between two painted ones; paint the outline in some slices and leave the "
                "slices between them empty");
  return out;
}

}  // namespace c3de::imaging
