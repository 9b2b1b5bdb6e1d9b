// SPDX-License-Identifier: Apache-2.0
#include "c3de/imaging/surface.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "c3de/imaging/mask_coverage.h"
#include "c3de/imaging/masks.h"
#include "masks/mask_tools.h"
#include "surface/remesh.h"
#include "surface/self_crossings.h"
#include "surface/surface_net.h"
#include "surface/volume_ledger.h"

namespace c3de::imaging {
namespace {

constexpr double kMaxTriangles = 5e6;
// Automatic edges, see SurfaceSettings: triangles of a detailed skin, and of one that has to be finer because it is
// thin.
constexpr double kDetail = 4e4, kThinDetail = 2.4e5;
constexpr double kLongestOfVoxel = 1.5, kEdgesAcross = 3.0;
// For masks with a mean thickness below kSlender voxels: parts that an opening with radius kThin removes need such
// edges.
constexpr double kSlender = 8.0, kThin = 1.5, kManyThin = 0.01, kShortestOfVoxel = 0.7;
constexpr double kAreaOfSteps = 1.5;  // voxel steps increase an area up to this factor
constexpr float kHalf = 0.5f;
constexpr double kVoxelsPerEdge = 2.5;                         // of the grid to which the mask is resampled
constexpr double kRelaxations = 2.0, kMaxRelaxations = 200.0;  // per squared length in voxels
constexpr double kDefaultLength = 2.0;                         // longest voxel edges
constexpr std::size_t kFairings = 10;
constexpr double kFirstLevel = 1.0;  // of the longest voxel edge
constexpr double kMaxOfPart = 0.5;   // of the cube root of a part's volume: its maximum edge length
constexpr int kUntanglings = 12;
constexpr double kEven = 0.3, kInwards = 0.05;  // of the distance to the mean of the neighbours, of an edge
constexpr double kNoise = 0.05;                 // maximum share of intersecting triangles that are corrected
constexpr int kHolds = 4;                       // final iterations of volume and border constraints
constexpr int kCoarsely = 2, kFinely = 20;      // steps that restore volumes
constexpr double kReach = 2.0;                  // distance within which volume is restored, in smoothing lengths

// Surface area of the mask, without the steps of its voxels, mm².
double borderArea(const Mask &mask, const VoxelBox &box) {
  const auto &n = mask.geometry.size;
  const std::array<std::size_t, 3> step{1, n[0], n[0] * n[1]};
  std::array<std::size_t, 3> faces{};
  for (std::size_t k = box.min[2]; k < box.max[2]; ++k)
    for (std::size_t j = box.min[1]; j < box.max[1]; ++j)
      for (std::size_t i = box.min[0]; i < box.max[0]; ++i) {
        const std::array<std::size_t, 3> at{i, j, k};
        const std::size_t v = i + step[1] * j + step[2] * k;
        if (mask.voxels[v] == 0) continue;
        for (std::size_t a = 0; a < 3; ++a) {
          faces[a] += static_cast<std::size_t>(at[a] == 0 || mask.voxels[v - step[a]] == 0);
          faces[a] += static_cast<std::size_t>(at[a] + 1 == n[a] || mask.voxels[v + step[a]] == 0);
        }
      }
  const Vec3 spacing = mask.geometry.spacing();
  double area = 0.0;
  for (std::size_t a = 0; a < 3; ++a)
    area += static_cast<double>(faces[a]) * spacing[(a + 1) % 3] * spacing[(a + 2) % 3];
  return area / kAreaOfSteps;
}

// Removes parts that are connected only in single blocks next to a large remainder.
void dropSpecks(Fill &grid) {
  Mask half{grid.geometry, std::vector<std::uint8_t>(grid.values.size())};
  for (std::size_t v = 0; v < grid.values.size(); ++v) half.voxels[v] = grid.values[v] >= kHalf ? 1 : 0;
  const auto kept = removeSpecks(half);
  if (!kept || kept->specks == 0) return;
  for (std::size_t v = 0; v < grid.values.size(); ++v)
    if (half.voxels[v] != kept->mask.voxels[v]) grid.values[v] = 0.0f;
}

// Records at the surrounding vertices the difference between the actual fill of a border block and the full or empty
// block that is meshed. Returns the volume of all blocks inside the surface, and of adjacent ones, whose fill is added.
double recordBlocks(const Fill &grid, SurfaceNet &net) {
  const auto &n = grid.geometry.size;
  const std::array<std::size_t, 3> step{1, n[0], n[0] * n[1]};
  const auto nodeOf = [&](std::size_t i, std::size_t j, std::size_t k) { return i + step[1] * j + step[2] * k; };
  std::vector<unsigned> vertexAt(grid.values.size(), EditMesh::kNone);  // by the lowest of the eight blocks around it
  for (unsigned v = 0; v < net.homes.size(); ++v)
    vertexAt[nodeOf(static_cast<std::size_t>(net.homes[v][0]), static_cast<std::size_t>(net.homes[v][1]),
                    static_cast<std::size_t>(net.homes[v][2]))] = v;
  const double block = grid.geometry.voxelVolume();
  double seen = 0.0;
  for (std::size_t k = 1; k + 1 < n[2]; ++k)
    for (std::size_t j = 1; j + 1 < n[1]; ++j)
      for (std::size_t i = 1; i + 1 < n[0]; ++i) {
        const std::size_t at = nodeOf(i, j, k);
        const float own = grid.values[at];
        const bool isInside = own >= kHalf;
        if (isInside) seen += static_cast<double>(own);
        if (own == 0.0f || own == 1.0f) continue;
        std::array<unsigned, 8> around{};
        std::size_t count = 0;
        for (std::size_t c = 0; c < 8; ++c)
          if (const unsigned v = vertexAt[at - (c & 1) - step[1] * (c >> 1 & 1) - step[2] * (c >> 2)];
              v != EditMesh::kNone)
            around[count++] = v;
        if (count > 0 && !isInside) seen += static_cast<double>(own);
        const double more = block * (static_cast<double>(own) - (isInside ? 1.0 : 0.0));
        for (std::size_t c = 0; c < count; ++c) net.mesh.owed[around[c]] += more / static_cast<double>(count);
      }
  return seen * block;
}

double trianglesOf(double area, double edge) { return area / (0.25 * std::sqrt(3.0) * edge * edge); }

// Whether a part of the mask is nowhere three voxels thick: branches of vessels, walls.
bool hasThinParts(const Mask &mask, double thickness, double voxel, double volume) {
  if (!(thickness < kSlender * voxel)) return false;
  const auto thick = opened(mask, kThin * voxel);
  return thick && 1.0 - volumeOf(*thick) / volume > kManyThin;
}

// As long as the detail of the image and the triangle count allow, but short enough for thin parts.
double automaticEdge(double area, double thickness, double voxel, bool isThin) {
  const double thin = isThin ? kShortestOfVoxel * voxel : std::max(voxel, thickness / kEdgesAcross);
  const double wanted = std::max(std::min(kLongestOfVoxel * voxel, thin), std::sqrt(trianglesOf(area, 1.0) / kDetail));
  return std::max(std::min(wanted, thin), std::sqrt(trianglesOf(area, 1.0) / kThinDetail));
}

// Numbers the connected parts in the tags.
std::size_t tagParts(EditMesh &mesh) {
  constexpr unsigned kOpen = EditMesh::kNone;
  std::fill(mesh.tags.begin(), mesh.tags.end(), kOpen);
  std::size_t parts = 0;
  std::vector<unsigned> stack;
  for (unsigned seed = 0; seed < mesh.points.size(); ++seed) {
    if (!mesh.isUsed(seed) || mesh.tags[seed] != kOpen) continue;
    stack.assign(1, seed);
    mesh.tags[seed] = static_cast<unsigned>(parts);
    while (!stack.empty()) {
      const unsigned v = stack.back();
      stack.pop_back();
      mesh.around(v, [&](unsigned h) {
        if (mesh.tags[mesh.to(h)] != kOpen) return;
        mesh.tags[mesh.to(h)] = static_cast<unsigned>(parts);
        stack.push_back(mesh.to(h));
      });
    }
    ++parts;
  }
  return parts;
}

struct PartMeasures {
  std::vector<double> volumes, areas;
};

PartMeasures measure(const EditMesh &mesh, std::span<const Vec3> points, std::size_t parts, const Vec3 &about) {
  PartMeasures m{std::vector<double>(parts, 0.0), std::vector<double>(parts, 0.0)};
  for (unsigned h = 0; h < mesh.halfEdges(); h += 3) {
    if (!mesh.alive(h)) continue;
    const Vec3 a = points[mesh.from(h)] - about, b = points[mesh.to(h)] - about, c = points[mesh.from(h + 2)] - about;
    const unsigned part = mesh.tags[mesh.from(h)];
    m.volumes[part] += dot(a, cross(b, c)) / 6.0;
    m.areas[part] += 0.5 * norm(cross(b - a, c - a));
  }
  return m;
}

// Moves every part along its normals until it has its target volume.
void restoreVolumes(EditMesh &mesh, std::span<const double> wanted, std::span<const double> edges, int times) {
  const Vec3 about = mesh.points.front();
  for (int time = 0; time < times; ++time) {
    const PartMeasures now = measure(mesh, mesh.points, wanted.size(), about);
    std::vector<double> way(wanted.size(), 0.0);
    double worst = 0.0;
    for (std::size_t p = 0; p < wanted.size(); ++p) {
      const double missing = wanted[p] - now.volumes[p];
      worst = std::max(worst, std::abs(missing) / std::abs(wanted[p]));
      if (now.areas[p] > 0.0) way[p] = std::clamp(missing / now.areas[p], -0.25 * edges[p], 0.25 * edges[p]);
    }
    if (worst < 1e-6) return;
    std::vector<Vec3> moved = mesh.points;
    for (unsigned v = 0; v < moved.size(); ++v) {
      if (!mesh.isUsed(v)) continue;
      Vec3 normal{};
      mesh.around(v, [&](unsigned h) { normal = normal + mesh.areaNormal(h); });
      const double length = norm(normal);
      if (length > 0.0) moved[v] = moved[v] + (way[mesh.tags[v]] / length) * normal;
    }
    mesh.points.swap(moved);
    recordMoves(mesh, moved);
  }
}

// Smooths around intersecting triangles, and moves them inwards, because regions too close to themselves are mostly
// gaps. Returns the moved vertices.
std::vector<std::uint8_t> untangle(EditMesh &mesh, std::span<const unsigned> crossed, std::span<const double> edges) {
  std::vector<std::uint8_t> moves(mesh.points.size(), 0);
  for (const unsigned h : crossed)
    for (unsigned c = 0; c < 3; ++c) {
      moves[mesh.from(h + c)] = 1;
      mesh.around(mesh.from(h + c), [&](unsigned g) { moves[mesh.to(g)] = 1; });
    }
  std::vector<Vec3> moved = mesh.points;
  for (unsigned v = 0; v < moved.size(); ++v) {
    if (moves[v] == 0 || !mesh.isUsed(v)) continue;
    Vec3 normal{}, mean{};
    double count = 0.0;
    mesh.around(v, [&](unsigned h) {
      normal = normal + mesh.areaNormal(h);
      mean = mean + mesh.points[mesh.to(h)];
      count += 1.0;
    });
    const double length = norm(normal);
    moved[v] = moved[v] + kEven * ((1.0 / count) * mean - moved[v]);
    if (length > 0.0) moved[v] = moved[v] - (kInwards * edges[mesh.tags[v]] / length) * normal;
  }
  mesh.points.swap(moved);
  recordMoves(mesh, moved);
  return moves;
}

using Continue = std::function<bool(double)>;  // argument: completed fraction; false: stop

Expected<void> checkSettings(const SurfaceSettings &settings) {
  for (const auto &[name, value] :
       {std::pair{"edge length", settings.edgeLength}, std::pair{"smoothing length", settings.smoothingLength}})
    if (!(value >= 0.0) || !std::isfinite(value))
      return fail(ErrorCode::usage,
                  fmt::format("{} = {} mm is not accepted: finite and > 0, or 0 to have it chosen", name, value));
  return {};
}

struct BlockGrid {
  Fill fill;
  bool isCoarse;  // blocks of more than one voxel
};

// The mask resampled for this edge length; in single voxels where no block would remain.
BlockGrid blockGridOf(const Mask &mask, const VoxelBox &box, double edge) {
  constexpr std::array<std::size_t, 3> kVoxel{1, 1, 1};
  const std::array<std::size_t, 3> block = blocksUpTo(mask.geometry, edge / kVoxelsPerEdge);
  BlockGrid grid{fillInBlocks(mask, box, block), block != kVoxel};
  if (std::none_of(grid.fill.values.begin(), grid.fill.values.end(), [](float f) { return f >= kHalf; }))
    grid = {fillInBlocks(mask, box, kVoxel), false};
  if (grid.isCoarse) dropSpecks(grid.fill);
  return grid;
}

// Present areas of the parts, and their target volumes, which sum up to `seen`.
PartMeasures targetsOf(const EditMesh &surface, std::span<const Vec3> points, std::size_t parts, double seen) {
  PartMeasures wanted = measure(surface, points, parts, points.front());
  for (unsigned v = 0; v < points.size(); ++v) wanted.volumes[surface.tags[v]] += surface.owed[v];
  double counted = 0.0;
  for (const double v : wanted.volumes) counted += v;
  for (double &v : wanted.volumes) v *= seen / counted;
  return wanted;
}

Expected<void> checkTriangles(double area, double edge) {
  const double triangles = trianglesOf(area / kAreaOfSteps, edge);
  if (triangles <= kMaxTriangles) return {};
  return fail(ErrorCode::usage,
              fmt::format("an edge length of {:.3g} mm gives about {:.2g} triangles; at most {:.2g} are "
                          "accepted: choose longer edges",
                          edge, triangles, kMaxTriangles));
}

// Remeshes a smoothed surface to even triangles, keeping it at the border of the blocks and preserving the volumes of
// its parts.
class SkinShaper {
 public:
  // @param edge, length  of the edges, of smoothing, mm
  // @param longest       edge of a block, mm
  SkinShaper(EditMesh &surface, const Fill &grid, std::span<const double> volumes, double edge, double length,
             double longest)
      : surface_(surface), grid_(grid), indexOf_(affineInverse(grid.geometry.indexToWorld)), volumes_(volumes),
        edge_(edge), reach_(kReach * length), edges_(noLongerThan(edge)),
        cells_(grid, *std::min_element(edges_.begin(), edges_.end()) / longest) {}

  // Fairing acts over some edges only. Edges much shorter than voxels are therefore reached by halving, with fairing at
  // each level; otherwise the voxel steps would remain as bumps.
  bool remeshByHalves(double firstEdge, const Continue &shouldContinue) {
    compensateOver(std::cbrt(grid_.geometry.voxelVolume()));
    for (double level = firstEdge; level > 1.5 * edge_; level *= 0.5) {
      std::vector<double> coarser(edges_);
      for (std::size_t p = 0; p < coarser.size(); ++p)
        coarser[p] = std::max(edges_[p], std::min(level, 0.5 * kMaxOfPart * std::cbrt(std::abs(volumes_[p]))));
      if (!remeshTo(coarser, level, shouldContinue)) return false;
    }
    return remeshTo(edges_, edge_, shouldContinue);
  }

  void restoreBorderAndVolumes() {
    for (int t = 0; t < kHolds; ++t) {
      compensateOver(edge_);
      constrainToBorder();
    }
    compensateOver(edge_);
    restoreVolumes(surface_, volumes_, edges_, kFinely);
  }

  // Reduces intersections of triangles as far as possible in some iterations.
  void untangleAll() {
    std::vector<unsigned> crossed = crossedTriangles(surface_);
    std::vector<Vec3> best = surface_.points;
    std::size_t fewest = crossed.size();
    const double noise = kNoise / 3.0 * surface_.halfEdges();
    for (int t = 0; t < kUntanglings && !crossed.empty() && static_cast<double>(crossed.size()) < noise; ++t) {
      const std::vector<std::uint8_t> moved = untangle(surface_, crossed, edges_);
      constrainToBorder();
      restoreVolumes(surface_, volumes_, edges_, kFinely);
      crossed = crossedTriangles(surface_, moved);
      // Checks everywhere again, because volumes have been restored everywhere.
      if (crossed.empty()) crossed = crossedTriangles(surface_);
      if (crossed.size() >= fewest) continue;
      fewest = crossed.size();
      best = surface_.points;
    }
    surface_.points.swap(best);
  }

 private:
  // By part: small ones need shorter edges to keep their shape.
  [[nodiscard]] std::vector<double> noLongerThan(double edge) const {
    std::vector<double> edges;
    for (const double volume : volumes_) edges.push_back(std::min(edge, kMaxOfPart * std::cbrt(std::abs(volume))));
    return edges;
  }

  bool remeshTo(std::span<const double> edges, double present, const Continue &shouldContinue) {
    const auto round = [&](double fraction) {
      compensateOver(present);
      constrainToBorder();
      return shouldContinue(fraction);
    };
    if (!remesh(surface_, edges, round)) return false;
    fair(surface_, kFairings);
    return true;
  }

  // @param present  present edge length
  void compensateOver(double present) { compensateVolume(surface_, edges_, reach_ / present, kCoarsely); }

  void constrainToBorder() {
    const std::vector<Vec3> before = surface_.points;
    for (unsigned v = 0; v < surface_.points.size(); ++v) {
      if (!surface_.isUsed(v)) continue;
      const Vec3 held = cells_.nearest(transformPoint(indexOf_, surface_.points[v]));
      surface_.points[v] = transformPoint(grid_.geometry.indexToWorld, held);
    }
    recordMoves(surface_, before);
  }

  EditMesh &surface_;
  const Fill &grid_;
  Mat4 indexOf_;
  std::span<const double> volumes_;  // by part, like edges_
  double edge_, reach_;
  std::vector<double> edges_;
  BorderCells cells_;
};

}  // namespace

Expected<geometry::TriangleMesh> surfaceOf(const Mask &mask, const SurfaceSettings &settings,
                                           const ProgressFn &progress) {
  if (const auto good = checkMask(mask); !good) return tl::unexpected(good.error());
  if (const auto good = checkSettings(settings); !good) return tl::unexpected(good.error());
  const VoxelBox box = boxAround(mask);
  if (box.empty()) return fail(ErrorCode::usage, "the mask is empty: there is no surface around nothing");
  const double volume = volumeOf(mask);
  const double voxel = std::cbrt(mask.geometry.voxelVolume()), visible = borderArea(mask, box);
  const double thickness = 4.0 * volume / visible;  // the diameter of a tube, approximately that of branching ones
  // Tubes of two voxels collapse with edges of one voxel.
  const bool isThin = hasThinParts(mask, thickness, voxel, volume);
  const double edge =
      settings.edgeLength > 0.0 ? settings.edgeLength : automaticEdge(visible, thickness, voxel, isThin);
  const auto shouldContinue = [&](double fraction) { return goesOn(progress, fraction, "surface"); };

  const BlockGrid blocks = blockGridOf(mask, box, edge);
  const Fill &grid = blocks.fill;
  const auto toWorld = [&](const Vec3 &index) { return transformPoint(grid.geometry.indexToWorld, index); };
  if (!shouldContinue(0.1)) return cancelled();
  SurfaceNet net = surfaceNetOf(grid, mask.geometry.handedness() < 0.0);
  EditMesh &surface = net.mesh;
  const std::size_t parts = tagParts(surface);
  // Volume lost by the blocks is not restored: the remainder would grow by it.
  const double seen = blocks.isCoarse ? recordBlocks(grid, net) : volume;
  std::vector<Vec3> homes(net.homes.size());
  std::transform(net.homes.begin(), net.homes.end(), homes.begin(), toWorld);
  const PartMeasures wanted = targetsOf(surface, homes, parts, seen);
  const double area = std::accumulate(wanted.areas.begin(), wanted.areas.end(), 0.0);
  if (const auto good = checkTriangles(area, edge); !good) return tl::unexpected(good.error());
  if (!shouldContinue(0.3)) return cancelled();

  const Vec3 spacing = grid.geometry.spacing();
  const double shortest = *std::min_element(spacing.begin(), spacing.end());
  const double longest = *std::max_element(spacing.begin(), spacing.end());
  const double length = settings.smoothingLength > 0.0 ? settings.smoothingLength : kDefaultLength * longest;
  const double relaxations = std::ceil(kRelaxations * length * length / (shortest * shortest));
  relax(net, static_cast<std::size_t>(std::min(kMaxRelaxations, relaxations)));
  for (Vec3 &point : surface.points) point = toWorld(point);
  recordMoves(surface, homes);
  if (!shouldContinue(0.5)) return cancelled();

  SkinShaper shaper(surface, grid, wanted.volumes, edge, length, longest);
  const double firstEdge = isThin ? kShortestOfVoxel * voxel : kFirstLevel * longest;
  if (!shaper.remeshByHalves(firstEdge, [&](double fraction) { return shouldContinue(0.5 + 0.4 * fraction); }))
    return cancelled();
  shaper.restoreBorderAndVolumes();
  shaper.untangleAll();
  if (!shouldContinue(1.0)) return cancelled();
  return surface.mesh();
}

Expected<geometry::TriangleMesh> previewSurfaceOf(const Mask &mask, std::size_t maxBlocks, const ProgressFn &progress) {
  constexpr std::size_t kRelaxed = 8;  // removes the steps of blocks
  constexpr double kLonger = 1.2;
  if (const auto good = checkMask(mask); !good) return tl::unexpected(good.error());
  const VoxelBox box = boxAround(mask);
  if (box.empty()) return fail(ErrorCode::usage, "the mask is empty: there is no surface around nothing");
  const Vec3 spacing = mask.geometry.spacing();
  double edge = *std::max_element(spacing.begin(), spacing.end());
  const auto blockCount = [&] {
    const std::array<std::size_t, 3> block = blocksUpTo(mask.geometry, edge);
    std::size_t count = 1;
    for (std::size_t a = 0; a < 3; ++a) count *= (box.edge(a) + block[a] - 1) / block[a];
    return count;
  };
  while (blockCount() > std::max<std::size_t>(maxBlocks, 1)) edge *= kLonger;
  Fill grid = fillInBlocks(mask, box, blocksUpTo(mask.geometry, edge));
  dropSpecks(grid);
  if (std::none_of(grid.values.begin(), grid.values.end(), [](float f) { return f >= kHalf; }))
    return fail(ErrorCode::input, fmt::format("the mask fills no block of {:.3g} mm to a half", edge));
  if (!goesOn(progress, 0.5, "surface")) return cancelled();
  SurfaceNet net = surfaceNetOf(grid, mask.geometry.handedness() < 0.0);
  relax(net, kRelaxed);
  for (Vec3 &point : net.mesh.points) point = transformPoint(grid.geometry.indexToWorld, point);
  if (!goesOn(progress, 1.0, "surface")) return cancelled();
  return net.mesh.mesh();
}

}  // namespace c3de::imaging
