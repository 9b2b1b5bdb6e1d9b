// SPDX-License-Identifier: Apache-2.0
#include "c3de/imaging/warp.h"

#include <fmt/format.h>

#include <limits>
#include <new>
#include <optional>
#include <type_traits>

#include "c3de/core/thread_pool.h"
#include "masks/mask_tools.h"
#include "trilinear.h"
#include "warp/displacement_rows.h"

namespace c3de::imaging {
namespace {

using Part = DisplacementRow::Part;

constexpr std::size_t kRowsAtATime = 16;
constexpr double kShares = 50.0;  // number of progress reports

Expected<void> checkGrid(const VolumeGeometry &grid, const char *what) {
  if (grid.voxelCount() == 0)
    return fail(ErrorCode::usage, fmt::format("the {} is {} x {} x {}: each size has to be at least 1", what,
                                              grid.size[0], grid.size[1], grid.size[2]));
  const double volume = grid.voxelVolume();
  if (!std::isfinite(volume) || !(volume > 0.0))
    return fail(ErrorCode::usage, fmt::format("the {} has voxels of {} mm³: finite and > 0 is accepted", what, volume));
  return {};
}

Expected<void> checkDisplacement(const DisplacementGrid &u) {
  if (const auto good = checkGrid(u.geometry, "grid of displacements"); !good) return good;
  const std::size_t wanted = 3 * u.geometry.voxelCount();
  if (u.xyz_mm.size() != wanted)
    return fail(ErrorCode::usage, fmt::format("the grid of displacements has {} values; its {} points need {}",
                                              u.xyz_mm.size(), u.geometry.voxelCount(), wanted));
  if (!u.gap_mm.empty() && u.gap_mm.size() != u.geometry.voxelCount())
    return fail(ErrorCode::usage, fmt::format("the grid of displacements has {} gaps; it has {} points",
                                              u.gap_mm.size(), u.geometry.voxelCount()));
  if (u.bodies && u.bodies->voxels.size() != u.bodies->geometry.voxelCount())
    return fail(ErrorCode::internal, "the voxels of the bodies do not fit their geometry");
  for (std::size_t v = 0; v < wanted; ++v)
    if (!std::isfinite(u.xyz_mm[v])) {
      const auto &n = u.geometry.size;
      const std::size_t point = v / 3;
      return fail(ErrorCode::usage, fmt::format("the displacement of point {} {} {} is {}: finite numbers are accepted",
                                                point % n[0], point / n[0] % n[1], point / n[0] / n[1], u.xyz_mm[v]));
    }
  return {};
}

/// Processes rows of voxels on several threads. @param row  called with the displacements and j, k of each, and the
/// part of it that may be displaced
template <class DoRow>
Expected<void> forRows(const DisplacementGrid &u, const VolumeGeometry &grid, const char *what,
                       const ProgressFn &progress, ThreadPool *threads, const DoRow &row) {
  const Mat4 nodeFromVoxel = multiply(affineInverse(u.geometry.indexToWorld), grid.indexToWorld);
  std::optional<ThreadPool> own;
  if (threads == nullptr) threads = &own.emplace();
  const std::size_t rows = grid.size[1] * grid.size[2];
  const std::size_t share =
      progress ? std::max(kRowsAtATime, static_cast<std::size_t>(static_cast<double>(rows) / kShares)) : rows;
  for (std::size_t first = 0; first < rows; first += share) {
    const std::size_t count = std::min(share, rows - first);
    threads->parallelFor(count, kRowsAtATime, [&](std::size_t from, std::size_t to) {
      DisplacementRow displacement(u, nodeFromVoxel);
      for (std::size_t r = first + from; r < first + to; ++r) {
        const std::size_t j = r % grid.size[1], k = r / grid.size[1];
        const Part part = displacement.moveTo(j, k, grid.size[0]);
        row(displacement, j, k, part);
      }
    });
    if (!goesOn(progress, static_cast<double>(first + count) / static_cast<double>(rows), what)) return cancelled();
  }
  return {};
}

/// The reference position of a displaced voxel, as an index.
class Source {
 public:
  explicit Source(const VolumeGeometry &g) : indexFromWorld_(affineInverse(g.indexToWorld)) {
    for (std::size_t a = 0; a < 3; ++a) last_[a] = static_cast<double>(g.size[a] - 1);
  }
  /// Whether the material of voxel i j k comes from beyond the outermost voxels.
  [[nodiscard]] bool isBeyond(std::size_t i, std::size_t j, std::size_t k, const Vec3 &u) const {
    const Mat4 &m = indexFromWorld_;
    const Vec3 index{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)};
    for (std::size_t a = 0; a < 3; ++a) {
      const double at = index[a] - (m[a] * u[0] + m[4 + a] * u[1] + m[8 + a] * u[2]);
      if (!(at >= -0.5 && at < last_[a] + 0.5)) return true;
    }
    return false;
  }
  /// The reference index of the material of voxel i j k, clamped to the border.
  [[nodiscard]] Vec3 of(std::size_t i, std::size_t j, std::size_t k, const Vec3 &u) const {
    const Mat4 &m = indexFromWorld_;
    const Vec3 index{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)};
    Vec3 at{};
    for (std::size_t a = 0; a < 3; ++a)
      at[a] = std::clamp(index[a] - (m[a] * u[0] + m[4 + a] * u[1] + m[8 + a] * u[2]), 0.0, last_[a]);
    return at;
  }

 private:
  Mat4 indexFromWorld_;
  Vec3 last_{};
};

using Sizes = std::array<std::size_t, 3>;

/// Offset of the voxel nearest to a non-negative index.
std::size_t nearestOffset(const Vec3 &at, const Sizes &n) {
  Sizes nearest{};
  for (std::size_t a = 0; a < 3; ++a) nearest[a] = static_cast<std::size_t>(at[a] + 0.5);
  return nearest[0] + n[0] * (nearest[1] + n[1] * nearest[2]);
}

std::optional<EmptiedRegion> emptiedBy(const DisplacementGrid &u, const VolumeGeometry &g) {
  if (!u.hasEmptiedRegion()) return std::nullopt;
  return EmptiedRegion(u, g.indexToWorld);
}

Vec3 indexOf(std::size_t i, std::size_t j, std::size_t k) {
  return {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)};
}

/// The lowest value that is not NaN; 0 if there is none.
template <class T>
T lowestOf(const std::vector<T> &voxels) {
  std::optional<T> lowest;
  for (const T v : voxels)
    if (v == v && (!lowest || v < *lowest)) lowest = v;
  return lowest.value_or(T{});
}

bool isZero(const Vec3 &u) { return u[0] == 0.0 && u[1] == 0.0 && u[2] == 0.0; }

template <class T>
T stored(double value) {
  if constexpr (std::is_floating_point_v<T>)
    return static_cast<T>(value);
  else
    return static_cast<T>(static_cast<std::int64_t>(value < 0.0 ? value - 0.5 : value + 0.5));
}

template <class T>
T linear(const T *voxels, const Sizes &size, const Sizes &stride, const Vec3 &at) {
  Vec3 t{};
  for (std::size_t a = 0; a < 3; ++a) {
    const std::size_t base = cellOf(at[a], size[a]);
    t[a] = at[a] - static_cast<double>(base);
    voxels += base * (a == 0 ? 1 : a == 1 ? size[0] : size[0] * size[1]);
  }
  constexpr Values kValues = std::is_floating_point_v<T> ? Values::any : Values::finite;
  return stored<T>(trilinear<kValues>(voxels, stride, t));
}

void keepThoseThatOccur(LabelMap &map) {
  std::vector<std::uint8_t> occurs(65536, 0);
  for (const std::uint16_t label : map.voxels) occurs[label] = 1;
  std::erase_if(map.labels, [&](const LabelMap::Label &label) { return occurs[label.value] == 0; });
}

tl::unexpected<Error> noMemory(std::size_t bytes) {
  return fail(ErrorCode::usage,
              fmt::format("not enough memory for the result of {:.1f} GB", 1e-9 * static_cast<double>(bytes)));
}

}  // namespace

Expected<Volume> warped(const Volume &reference, const DisplacementGrid &u, const ProgressFn &progress,
                        ThreadPool *threads, WarpSampling sampling) {
  const VolumeGeometry &g = reference.geometry;
  if (const auto good = checkGrid(g, "image"); !good) return tl::unexpected(good.error());
  if (const auto good = checkDisplacement(u); !good) return tl::unexpected(good.error());
  if (std::visit([](const auto &all) { return all.size(); }, reference.voxels) != g.voxelCount())
    return fail(ErrorCode::internal, "the voxels of the image do not fit its geometry");
  try {
    Volume out = reference;
    const Source source(g);
    const std::optional<EmptiedRegion> vacated = emptiedBy(u, g);
    const Sizes &n = g.size;
    const Sizes stride{n[0] > 1 ? std::size_t{1} : 0, n[1] > 1 ? n[0] : 0, n[2] > 1 ? n[0] * n[1] : 0};
    const auto done = std::visit(
        [&](const auto &all) {
          using T = typename std::decay_t<decltype(all)>::value_type;
          const T *from = all.data();
          T *to = std::get<std::vector<T>>(out.voxels).data();
          const T empty = lowestOf(all);
          const auto row = [&](const DisplacementRow &displacement, std::size_t j, std::size_t k, Part part) {
            T *voxel = to + n[0] * (j + n[1] * k);
            // Vacated voxels may be anywhere.
            if (vacated) part = {0, n[0]};
            for (std::size_t i = part.begin; i < part.end; ++i) {
              Vec3 d = displacement.at(i);
              if (vacated && vacated->settles(displacement, i, indexOf(i, j, k), d))
                voxel[i] = empty;
              else if (isZero(d))
                continue;
              else if (sampling == WarpSampling::linear)
                voxel[i] = linear(from, n, stride, source.of(i, j, k, d));
              else
                voxel[i] = source.isBeyond(i, j, k, d) ? empty : from[nearestOffset(source.of(i, j, k, d), n)];
            }
          };
          return forRows(u, g, "warping", progress, threads, row);
        },
        reference.voxels);
    if (!done) return tl::unexpected(done.error());
    return out;
  } catch (const std::bad_alloc &) {
    return noMemory(reference.bytes());
  }
}

Expected<LabelMap> warped(const LabelMap &reference, const DisplacementGrid &u, const ProgressFn &progress,
                          ThreadPool *threads) {
  const VolumeGeometry &g = reference.geometry;
  if (const auto good = checkGrid(g, "label map"); !good) return tl::unexpected(good.error());
  if (const auto good = checkDisplacement(u); !good) return tl::unexpected(good.error());
  if (reference.voxels.size() != g.voxelCount())
    return fail(ErrorCode::internal, "the voxels of the label map do not fit its geometry");
  try {
    LabelMap out = reference;
    const Source source(g);
    const std::optional<EmptiedRegion> vacated = emptiedBy(u, g);
    const auto done = forRows(u, g, "warping labels", progress, threads,
                              [&](const DisplacementRow &row, std::size_t j, std::size_t k, Part part) {
                                std::uint16_t *voxel = out.voxels.data() + g.size[0] * (j + g.size[1] * k);
                                if (vacated) part = {0, g.size[0]};
                                for (std::size_t i = part.begin; i < part.end; ++i) {
                                  Vec3 d = row.at(i);
                                  if (vacated && vacated->settles(row, i, indexOf(i, j, k), d)) {
                                    voxel[i] = 0;
                                    continue;
                                  }
                                  if (isZero(d)) continue;
                                  voxel[i] = reference.voxels[nearestOffset(source.of(i, j, k, d), g.size)];
                                }
                              });
    if (!done) return tl::unexpected(done.error());
    keepThoseThatOccur(out);
    return out;
  } catch (const std::bad_alloc &) {
    return noMemory(2 * reference.voxels.size());
  }
}

Expected<LabelMap> warped(const LabelMap &reference, const DisplacementGrid &u, const VolumeGeometry &grid,
                          const ProgressFn &progress, ThreadPool *threads) {
  const VolumeGeometry &g = reference.geometry;
  for (const auto &[one, what] : {std::pair(&g, "label map"), {&grid, "grid"}})
    if (const auto good = checkGrid(*one, what); !good) return tl::unexpected(good.error());
  if (const auto good = checkDisplacement(u); !good) return tl::unexpected(good.error());
  if (reference.voxels.size() != g.voxelCount())
    return fail(ErrorCode::internal, "the voxels of the label map do not fit its geometry");
  try {
    LabelMap out{grid, std::vector<std::uint16_t>(grid.voxelCount(), 0), reference.labels};
    const Mat4 indexFromWorld = affineInverse(g.indexToWorld);
    const std::optional<EmptiedRegion> vacated = emptiedBy(u, grid);
    const auto done = forRows(u, grid, "warping labels", progress, threads,
                              [&](const DisplacementRow &row, std::size_t j, std::size_t k, Part) {
                                std::uint16_t *voxel = out.voxels.data() + grid.size[0] * (j + grid.size[1] * k);
                                for (std::size_t i = 0; i < grid.size[0]; ++i) {
                                  Vec3 d = row.at(i);
                                  if (vacated && vacated->settles(row, i, indexOf(i, j, k), d)) continue;
                                  const Vec3 at = transformPoint(indexFromWorld, grid.worldAt(indexOf(i, j, k)) - d);
                                  bool isInside = true;
                                  for (std::size_t a = 0; a < 3; ++a)
                                    isInside =
                                        isInside && at[a] >= -0.5 && at[a] < static_cast<double>(g.size[a]) - 0.5;
                                  if (!isInside) continue;
                                  const Vec3 within{std::max(at[0], 0.0), std::max(at[1], 0.0), std::max(at[2], 0.0)};
                                  voxel[i] = reference.voxels[nearestOffset(within, g.size)];
                                }
                              });
    if (!done) return tl::unexpected(done.error());
    keepThoseThatOccur(out);
    return out;
  } catch (const std::bad_alloc &) {
    return noMemory(2 * grid.voxelCount());
  }
}

Expected<Volume> magnitudeOf(const DisplacementGrid &u, const VolumeGeometry &grid, const ProgressFn &progress,
                             ThreadPool *threads) {
  if (const auto good = checkGrid(grid, "grid"); !good) return tl::unexpected(good.error());
  if (const auto good = checkDisplacement(u); !good) return tl::unexpected(good.error());
  try {
    Volume out;
    out.geometry = grid;
    out.unit = "mm";
    auto &values = out.voxels.emplace<std::vector<float>>(grid.voxelCount(), 0.0f);
    const std::optional<EmptiedRegion> vacated = emptiedBy(u, grid);
    const auto done = forRows(u, grid, "displacement magnitude", progress, threads,
                              [&](const DisplacementRow &row, std::size_t j, std::size_t k, Part part) {
                                float *value = values.data() + grid.size[0] * (j + grid.size[1] * k);
                                for (std::size_t i = part.begin; i < part.end; ++i) {
                                  Vec3 d = row.at(i);
                                  if (vacated) (void)vacated->settles(row, i, indexOf(i, j, k), d);
                                  value[i] = static_cast<float>(norm(d));
                                }
                              });
    if (!done) return tl::unexpected(done.error());
    return out;
  } catch (const std::bad_alloc &) {
    return noMemory(sizeof(float) * grid.voxelCount());
  }
}

Expected<Mask> emptiedRegions(const DisplacementGrid &u, const VolumeGeometry &grid, const ProgressFn &progress,
                              ThreadPool *threads) {
  if (const auto good = checkGrid(grid, "grid"); !good) return tl::unexpected(good.error());
  if (const auto good = checkDisplacement(u); !good) return tl::unexpected(good.error());
  try {
    Mask out{grid, std::vector<std::uint8_t>(grid.voxelCount(), 0)};
    const std::optional<EmptiedRegion> vacated = emptiedBy(u, grid);
    if (!vacated) return out;
    const auto done = forRows(u, grid, "vacated regions", progress, threads,
                              [&](const DisplacementRow &row, std::size_t j, std::size_t k, Part) {
                                std::uint8_t *voxel = out.voxels.data() + grid.size[0] * (j + grid.size[1] * k);
                                for (std::size_t i = 0; i < grid.size[0]; ++i) {
                                  Vec3 d = row.at(i);
                                  voxel[i] = vacated->settles(row, i, indexOf(i, j, k), d) ? 1 : 0;
                                }
                              });
    if (!done) return tl::unexpected(done.error());
    return out;
  } catch (const std::bad_alloc &) {
    return noMemory(grid.voxelCount());
  }
}

Expected<DisplacementGrid> resampled(const DisplacementGrid &u, const VolumeGeometry &grid, const ProgressFn &progress,
                                     ThreadPool *threads) {
  if (const auto good = checkGrid(grid, "grid"); !good) return tl::unexpected(good.error());
  if (const auto good = checkDisplacement(u); !good) return tl::unexpected(good.error());
  try {
    DisplacementGrid out{grid, std::vector<float>(3 * grid.voxelCount(), 0.0f)};
    const std::optional<EmptiedRegion> vacated = emptiedBy(u, grid);
    const auto done = forRows(u, grid, "displacement field", progress, threads,
                              [&](const DisplacementRow &row, std::size_t j, std::size_t k, Part part) {
                                float *value = out.xyz_mm.data() + 3 * grid.size[0] * (j + grid.size[1] * k);
                                for (std::size_t i = part.begin; i < part.end; ++i) {
                                  Vec3 d = row.at(i);
                                  if (vacated) (void)vacated->settles(row, i, indexOf(i, j, k), d);
                                  for (std::size_t a = 0; a < 3; ++a) value[3 * i + a] = static_cast<float>(d[a]);
                                }
                              });
    if (!done) return tl::unexpected(done.error());
    return out;
  } catch (const std::bad_alloc &) {
    return noMemory(3 * sizeof(float) * grid.voxelCount());
  }
}

}  // namespace c3de::imaging
