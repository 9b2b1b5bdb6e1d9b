// SPDX-License-Identifier: Apache-2.0
// Connected components over runs along i: a few numbers per run instead of one per voxel.
#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "c3de/imaging/mask_coverage.h"
#include "c3de/imaging/masks.h"
#include "masks/mask_tools.h"

namespace c3de::imaging {
namespace {

struct Run {
  std::uint32_t begin = 0, end = 0;  // along i
  std::uint32_t parent = 0;
};

class Components {
 public:
  /// Components of the voxels with (value != 0) == inside.
  static Expected<Components> of(const Mask &mask, bool inside, const ProgressFn &progress) {
    Components all;
    all.size_ = mask.geometry.size;
    const std::size_t nx = all.size_[0], ny = all.size_[1], nz = all.size_[2];
    all.firstOfRow_.reserve(ny * nz + 1);
    const std::uint8_t *row = mask.voxels.data();
    for (std::size_t k = 0; k < nz; ++k) {
      for (std::size_t j = 0; j < ny; ++j, row += nx) {
        all.firstOfRow_.push_back(all.runs_.size());
        for (std::size_t i = 0; i < nx;) {
          while (i < nx && (row[i] != 0) != inside) ++i;
          if (i == nx) break;
          const std::size_t begin = i;
          while (i < nx && (row[i] != 0) == inside) ++i;
          if (all.runs_.size() >= std::numeric_limits<std::uint32_t>::max())
            return fail(ErrorCode::input, "the mask has more than 4 billion runs of voxels along its rows");
          all.runs_.push_back({static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(i),
                               static_cast<std::uint32_t>(all.runs_.size())});
        }
        const std::size_t here = j + ny * k;
        if (j > 0) all.joinRows(here - 1, here);
        if (k > 0) all.joinRows(here - ny, here);
      }
      if (!goesOn(progress, static_cast<double>(k + 1) / static_cast<double>(nz), "connected parts"))
        return cancelled();
    }
    all.firstOfRow_.push_back(all.runs_.size());
    return all;
  }

  std::uint32_t find(std::uint32_t r) {
    while (runs_[r].parent != r) r = runs_[r].parent = runs_[runs_[r].parent].parent;
    return r;
  }
  [[nodiscard]] std::size_t runCount() const { return runs_.size(); }
  [[nodiscard]] const Run &run(std::size_t r) const { return runs_[r]; }
  /// Voxels by root.
  std::vector<std::size_t> sizes() {
    std::vector<std::size_t> sizes(runs_.size(), 0);
    for (std::uint32_t r = 0; r < runs_.size(); ++r) sizes[find(r)] += runs_[r].end - runs_[r].begin;
    return sizes;
  }
  /// Calls visit(run, offset of its row's first voxel, row touches the border) for every run.
  template <class Visit>
  void forRuns(const Visit &visit) const {
    for (std::size_t row = 0; row + 1 < firstOfRow_.size(); ++row) {
      const std::size_t j = row % size_[1], k = row / size_[1];
      const bool border = j == 0 || j + 1 == size_[1] || k == 0 || k + 1 == size_[2];
      for (std::size_t r = firstOfRow_[row]; r < firstOfRow_[row + 1]; ++r)
        visit(static_cast<std::uint32_t>(r), row * size_[0], border);
    }
  }
  [[nodiscard]] std::uint32_t runAt(const std::array<std::size_t, 3> &index) const {
    const std::size_t row = index[1] + size_[1] * index[2];
    for (std::size_t r = firstOfRow_[row]; r < firstOfRow_[row + 1]; ++r)
      if (runs_[r].begin <= index[0] && index[0] < runs_[r].end) return static_cast<std::uint32_t>(r);
    return std::numeric_limits<std::uint32_t>::max();
  }

 private:
  void joinRows(std::size_t before, std::size_t here) {
    std::size_t a = firstOfRow_[before], b = firstOfRow_[here];
    const std::size_t endA = firstOfRow_[before + 1], endB = runs_.size();
    while (a < endA && b < endB) {
      if (runs_[a].begin < runs_[b].end && runs_[b].begin < runs_[a].end) join(a, b);
      (runs_[a].end < runs_[b].end ? a : b) += 1;
    }
  }
  void join(std::size_t a, std::size_t b) {
    const std::uint32_t ra = find(static_cast<std::uint32_t>(a)), rb = find(static_cast<std::uint32_t>(b));
    runs_[std::max(ra, rb)].parent = std::min(ra, rb);
  }

  std::array<std::size_t, 3> size_{};
  std::vector<Run> runs_;
  std::vector<std::size_t> firstOfRow_;  // number of runs before each row, then the total
};

Mask onlyRoot(const Mask &mask, Components &components, std::uint32_t root) {
  Mask out{mask.geometry, std::vector<std::uint8_t>(mask.voxels.size(), 0)};
  components.forRuns([&](std::uint32_t r, std::size_t row, bool) {
    if (components.find(r) != root) return;
    const Run &run = components.run(r);
    std::fill(out.voxels.begin() + static_cast<std::ptrdiff_t>(row + run.begin),
              out.voxels.begin() + static_cast<std::ptrdiff_t>(row + run.end), std::uint8_t{1});
  });
  return out;
}

}  // namespace

VoxelBox boxAround(const Mask &mask) {
  const auto &n = mask.geometry.size;
  VoxelBox box{n, {0, 0, 0}};
  const std::uint8_t *row = mask.voxels.data();
  for (std::size_t k = 0; k < n[2]; ++k)
    for (std::size_t j = 0; j < n[1]; ++j, row += n[0]) {
      const auto isSet = [](std::uint8_t v) { return v != 0; };
      const std::uint8_t *first = std::find_if(row, row + n[0], isSet);
      if (first == row + n[0]) continue;
      std::size_t last = n[0];
      while (row[last - 1] == 0) --last;
      const std::array<std::size_t, 3> low{static_cast<std::size_t>(first - row), j, k}, high{last, j + 1, k + 1};
      for (std::size_t a = 0; a < 3; ++a) {
        box.min[a] = std::min(box.min[a], low[a]);
        box.max[a] = std::max(box.max[a], high[a]);
      }
    }
  return box;
}

Expected<Mask> connectedComponent(const Mask &mask, const std::array<std::size_t, 3> &index,
                                  const ProgressFn &progress) {
  if (const auto good = checkMask(mask); !good) return tl::unexpected(good.error());
  const auto &n = mask.geometry.size;
  for (std::size_t a = 0; a < 3; ++a)
    if (index[a] >= n[a])
      return fail(ErrorCode::usage, fmt::format("voxel ({}, {}, {}) lies outside of the grid of {} x {} x {}", index[0],
                                                index[1], index[2], n[0], n[1], n[2]));
  if (mask.voxels[index[0] + n[0] * (index[1] + n[1] * index[2])] == 0)
    return fail(ErrorCode::usage,
                fmt::format("voxel ({}, {}, {}) is not in the mask; choose one that is", index[0], index[1], index[2]));
  auto components = Components::of(mask, true, stage(progress, 0.0, 0.9));
  if (!components) return tl::unexpected(components.error());
  return onlyRoot(mask, *components, components->find(components->runAt(index)));
}

Expected<Mask> largestComponent(const Mask &mask, const ProgressFn &progress) {
  if (const auto good = checkMask(mask); !good) return tl::unexpected(good.error());
  auto components = Components::of(mask, true, stage(progress, 0.0, 0.9));
  if (!components) return tl::unexpected(components.error());
  const std::vector<std::size_t> sizes = components->sizes();
  if (sizes.empty()) return mask;
  const auto largest = std::max_element(sizes.begin(), sizes.end());
  return onlyRoot(mask, *components, static_cast<std::uint32_t>(largest - sizes.begin()));
}

Expected<WithoutSpecks> removeSpecks(const Mask &mask, const ProgressFn &progress) {
  constexpr std::size_t kMaxVoxels = 64, kMinShare = 1000;
  if (const auto good = checkMask(mask); !good) return tl::unexpected(good.error());
  auto components = Components::of(mask, true, stage(progress, 0.0, 0.9));
  if (!components) return tl::unexpected(components.error());
  const std::vector<std::size_t> sizes = components->sizes();
  WithoutSpecks out{mask, 0, 0};
  if (sizes.empty()) return out;
  const std::size_t largest = *std::max_element(sizes.begin(), sizes.end());
  const auto isSpeck = [&](std::size_t size) { return size <= kMaxVoxels && size * kMinShare < largest; };
  for (const std::size_t size : sizes)
    if (size > 0 && isSpeck(size)) {
      ++out.specks;
      out.voxels += size;
    }
  if (out.specks == 0) return out;
  components->forRuns([&](std::uint32_t r, std::size_t row, bool) {
    if (!isSpeck(sizes[components->find(r)])) return;
    const Run &run = components->run(r);
    std::fill(out.mask.voxels.begin() + static_cast<std::ptrdiff_t>(row + run.begin),
              out.mask.voxels.begin() + static_cast<std::ptrdiff_t>(row + run.end), std::uint8_t{0});
  });
  return out;
}

Expected<std::vector<std::size_t>> componentSizes(const Mask &mask, const ProgressFn &progress) {
  if (const auto good = checkMask(mask); !good) return tl::unexpected(good.error());
  auto components = Components::of(mask, true, progress);
  if (!components) return tl::unexpected(components.error());
  std::vector<std::size_t> sizes = components->sizes();
  std::erase(sizes, std::size_t{0});
  std::sort(sizes.begin(), sizes.end(), std::greater<>());
  return sizes;
}

Expected<Mask> fillHoles(const Mask &mask, const ProgressFn &progress) {
  if (const auto good = checkMask(mask); !good) return tl::unexpected(good.error());
  auto outside = Components::of(mask, false, stage(progress, 0.0, 0.9));
  if (!outside) return tl::unexpected(outside.error());
  std::vector<std::uint8_t> open(outside->runCount(), 0);
  const std::size_t nx = mask.geometry.size[0];
  outside->forRuns([&](std::uint32_t r, std::size_t, bool border) {
    const Run &run = outside->run(r);
    if (border || run.begin == 0 || run.end == nx) open[outside->find(r)] = 1;
  });
  Mask out = mask;
  outside->forRuns([&](std::uint32_t r, std::size_t row, bool) {
    if (open[outside->find(r)] != 0) return;
    const Run &run = outside->run(r);
    std::fill(out.voxels.begin() + static_cast<std::ptrdiff_t>(row + run.begin),
              out.voxels.begin() + static_cast<std::ptrdiff_t>(row + run.end), std::uint8_t{1});
  });
  return out;
}

}  // namespace c3de::imaging
