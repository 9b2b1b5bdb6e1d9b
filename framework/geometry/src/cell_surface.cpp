// SPDX-License-Identifier: Apache-2.0
#include "cell_surface.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "mesh_edges.h"
#include "wording.h"

namespace c3de::geometry {
namespace {

constexpr int kTriangle = 5, kStrip = 6, kPolygon = 7, kPixel = 8, kQuad = 9, kTetrahedron = 10, kVoxel = 11,
              kHexahedron = 12, kWedge = 13, kPyramid = 14;

/// Number of corners of a cell with straight edges. @return 0: any number, from three on
std::size_t cornersOf(int type) {
  switch (type) {
    case kTriangle: return 3;
    case kPixel:
    case kQuad:
    case kTetrahedron: return 4;
    case kPyramid: return 5;
    case kWedge: return 6;
    case kVoxel:
    case kHexahedron: return 8;
    default: return 0;
  }
}

/// The cell with the same corners and straight edges (vtkCellType.h); 0: unknown.
int straightened(long long type) {
  switch (type) {
    case 22:
    case 34:
    case 69: return kTriangle;
    case 23:
    case 28:
    case 30:
    case 70: return kQuad;
    case 24:
    case 71: return kTetrahedron;
    case 25:
    case 29:
    case 33:
    case 72: return kHexahedron;
    case 26:
    case 31:
    case 32:
    case 73: return kWedge;
    case 27:
    case 37:
    case 74: return kPyramid;
    default: return type >= kTriangle && type <= kPyramid ? static_cast<int>(type) : 0;
  }
}

bool isPointOrLine(long long type) { return (type >= 0 && type <= 4) || type == 21 || type == 35 || type == 68; }

using Corners = std::array<unsigned char, 4>;  // of a face; a triangle repeats its first corner

std::span<const Corners> facesOf(int type) {
  static constexpr std::array<Corners, 4> kOfTetrahedron{{{0, 1, 3, 0}, {1, 2, 3, 1}, {2, 0, 3, 2}, {0, 2, 1, 0}}};
  static constexpr std::array<Corners, 6> kOfHexahedron{
      {{0, 4, 7, 3}, {1, 2, 6, 5}, {0, 1, 5, 4}, {3, 7, 6, 2}, {0, 3, 2, 1}, {4, 5, 6, 7}}};
  static constexpr std::array<Corners, 6> kOfVoxel{
      {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
  static constexpr std::array<Corners, 5> kOfWedge{
      {{0, 1, 2, 0}, {3, 5, 4, 3}, {0, 3, 4, 1}, {1, 4, 5, 2}, {2, 5, 3, 0}}};
  static constexpr std::array<Corners, 5> kOfPyramid{
      {{0, 3, 2, 1}, {0, 1, 4, 0}, {1, 2, 4, 1}, {2, 3, 4, 2}, {3, 0, 4, 3}}};
  switch (type) {
    case kTetrahedron: return kOfTetrahedron;
    case kHexahedron: return kOfHexahedron;
    case kVoxel: return kOfVoxel;
    case kWedge: return kOfWedge;
    case kPyramid: return kOfPyramid;
    default: return {};
  }
}

/// A face of a cell, with its sorted corners, to find the same face of another cell.
struct Face {
  std::array<unsigned, 4> key;
  std::array<unsigned, 4> corners;
  std::size_t count;
};

}  // namespace

Expected<void> CellSurface::add(long long type, std::span<const unsigned> corners) {
  if (isPointOrLine(type)) {
    ++pointsAndLines_;
    return {};
  }
  const int straight = straightened(type);
  if (straight == 0)
    return fail(ErrorCode::input, fmt::format("cells of type {} are not read; accepted are tetrahedra, hexahedra, "
                                              "wedges, pyramids, voxels and polygons (types 5 to 14), and those with "
                                              "points on their edges",
                                              type));
  const std::size_t needed = cornersOf(straight);
  if (corners.size() < std::max<std::size_t>(needed, 3))
    return fail(ErrorCode::input, fmt::format("a cell of type {} has {} corners; it needs {}", type, corners.size(),
                                              std::max<std::size_t>(needed, 3)));
  if (needed != 0) corners = corners.first(needed);
  curved_ += straight != type ? 1 : 0;
  const std::size_t begin = corners_.size();
  corners_.insert(corners_.end(), corners.begin(), corners.end());
  (straight < kTetrahedron ? faces_ : volumes_).push_back({straight, begin, corners_.size()});
  return {};
}

Expected<void> CellSurface::finish(RawMesh &raw) const {
  const auto put = [&raw](std::span<const unsigned> corners) -> Expected<void> {
    if (corners.size() <= kMaxFaceCorners && addFace(raw, corners)) return {};
    return fail(ErrorCode::input,
                fmt::format("a cell has {} corners; up to {} are accepted, up to 4096 if it is concave", corners.size(),
                            kMaxFaceCorners));
  };
  // Cells of different regions may have separate points at one position.
  const std::vector<unsigned> first = volumes_.empty() ? std::vector<unsigned>() : firstAtSamePosition(raw.vertices);
  std::vector<Face> all;
  for (const Cell &cell : volumes_) {
    const std::span<const unsigned> corners(corners_.data() + cell.begin, cell.end - cell.begin);
    Vec3 centre{};
    for (const unsigned v : corners) centre = centre + (1.0 / static_cast<double>(corners.size())) * raw.vertices[v];
    for (const Corners &local : facesOf(cell.type)) {
      Face face{};
      face.count = local[3] == local[0] ? 3 : 4;
      for (std::size_t c = 0; c < face.count; ++c) face.corners[c] = corners[local[c]];
      // Cells may have the opposite orientation; a face points away from the centre of its cell.
      const Vec3 &a = raw.vertices[face.corners[0]], &b = raw.vertices[face.corners[1]],
                 &c = raw.vertices[face.corners[2]], &d = raw.vertices[face.corners[face.count - 1]];
      if (dot(cross(c - a, d - b), a - centre) < 0.0)
        std::reverse(face.corners.begin(), face.corners.begin() + static_cast<std::ptrdiff_t>(face.count));
      std::array<unsigned, 4> &key = face.key;
      for (std::size_t i = 0; i < face.count; ++i) key[i] = first[face.corners[i]];
      std::sort(key.begin(), key.begin() + static_cast<std::ptrdiff_t>(face.count));
      const auto end = std::unique(key.begin(), key.begin() + static_cast<std::ptrdiff_t>(face.count));
      if (end - key.begin() < 3) continue;  // a cell with coincident corners
      std::fill(end, key.end(), 0xffffffffu);
      all.push_back(face);
    }
  }
  std::stable_sort(all.begin(), all.end(), [](const Face &a, const Face &b) { return a.key < b.key; });
  std::size_t crowded = 0;
  for (std::size_t begin = 0, end = 0; begin < all.size(); begin = end) {
    while (end < all.size() && all[end].key == all[begin].key) ++end;
    crowded += end - begin > 2 ? 1 : 0;
    if (end - begin != 1) continue;
    if (auto added = put({all[begin].corners.data(), all[begin].count}); !added) return added;
  }
  if (!volumes_.empty()) {
    raw.notes.push_back(fmt::format("the outer surface of {} was taken{}", counted(volumes_.size(), "cell", "cells"),
                                    curved_ != 0 ? ", with straight edges" : ""));
    if (crowded != 0)
      raw.notes.push_back(
          fmt::format("{} of more than two cells {} ignored", counted(crowded, "face", "faces"), wasOrWere(crowded)));
    if (!faces_.empty())
      raw.notes.push_back(fmt::format("{} besides the volume cells {} ignored",
                                      counted(faces_.size(), "polygon", "polygons"), wasOrWere(faces_.size())));
  }
  for (const Cell &cell : faces_) {
    if (!volumes_.empty()) break;
    std::vector<unsigned> corners(corners_.begin() + static_cast<std::ptrdiff_t>(cell.begin),
                                  corners_.begin() + static_cast<std::ptrdiff_t>(cell.end));
    if (cell.type == kStrip) {
      for (std::size_t i = 0; i + 2 < corners.size(); ++i)
        raw.triangles.push_back(i % 2 == 0 ? Triangle{corners[i], corners[i + 1], corners[i + 2]}
                                           : Triangle{corners[i + 1], corners[i], corners[i + 2]});
      continue;
    }
    if (cell.type == kPixel) std::swap(corners[2], corners[3]);
    if (auto added = put(corners); !added) return added;
  }
  if (pointsAndLines_ != 0)
    raw.notes.push_back(fmt::format("{} lines and single points of the file were left out", pointsAndLines_));
  return {};
}

}  // namespace c3de::geometry
