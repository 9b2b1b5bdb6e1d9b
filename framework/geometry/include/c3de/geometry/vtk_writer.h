// SPDX-License-Identifier: Apache-2.0
// Files for ParaView: point clouds (VTU), surfaces (VTP, also with several bodies), and the list of a sequence (PVD).
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/geometry/point_array.h"
#include "c3de/geometry/triangle_mesh.h"

namespace c3de::geometry {

/// Points in LPS millimetres with their arrays.
struct PointCloud {
  std::vector<Vec3> points;  ///< mm
  std::vector<PointArray> arrays;
};

/// Each point becomes a cell (VTK_VERTEX) of an unstructured grid. @param title  one line, as a comment
[[nodiscard]] Expected<void> writeVtu(const std::filesystem::path &path, const PointCloud &cloud,
                                      const std::string &title = {});
/// A surface; without triangles each vertex becomes a separate point.
[[nodiscard]] Expected<void> writeVtp(const std::filesystem::path &path, const TriangleMesh &mesh,
                                      std::span<const PointArray> arrays, const std::string &title = {});

struct PvdEntry {
  double time_s = 0.0;
  int part = 0;
  std::filesystem::path file;  ///< relative to the list
};
[[nodiscard]] Expected<void> writePvd(const std::filesystem::path &path, std::span<const PvdEntry> entries);

}  // namespace c3de::geometry
