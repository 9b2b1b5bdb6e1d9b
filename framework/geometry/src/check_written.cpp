// SPDX-License-Identifier: Apache-2.0
#include "check_written.h"

#include <fmt/format.h>

#include <cmath>
#include <set>

#include "file_text.h"

namespace c3de::geometry {

Expected<void> checkRows(const std::filesystem::path &path, const std::vector<Vec3> &points,
                         std::span<const PointArray> arrays) {
  const auto refuse = [&](const std::string &what) {
    return fail(ErrorCode::state, displayPath(path) + ": not written: " + what);
  };
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k)
      if (!std::isfinite(points[i][k]))
        return refuse(fmt::format("{} coordinate {} of point {} is not finite", "xyz"[k], points[i][k], i));
  std::set<std::string> names;
  for (const PointArray &array : arrays) {
    if (array.name.empty() || !names.insert(array.name).second)
      return refuse("the name '" + array.name + "' of an array is empty or duplicated");
    if (array.components == 0 || array.values.size() != points.size() * array.components)
      return refuse(fmt::format("array '{}' has {} numbers for {} points with {} components", array.name,
                                array.values.size(), points.size(), array.components));
  }
  return {};
}

Expected<void> checkTriangles(const std::filesystem::path &path, const TriangleMesh &mesh) {
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const unsigned v : mesh.triangles[t])
      if (v >= mesh.vertices.size())
        return fail(ErrorCode::state, fmt::format("{}: not written: triangle {} names vertex {} of {}",
                                                  displayPath(path), t, v, mesh.vertices.size()));
  return {};
}

}  // namespace c3de::geometry
