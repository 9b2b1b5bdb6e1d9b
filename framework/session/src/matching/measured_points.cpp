// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/measured_points.h"

#include <algorithm>
#include <array>

#include "c3de/core/path_text.h"
#include "c3de/core/text.h"
#include "c3de/session/landmark_file.h"
#include "files/table_rows.h"
#include "matching/measured_landmark.h"

namespace c3de::session {
namespace {

constexpr double kLargestNumber = 1e6;
constexpr std::size_t kNoColumn = static_cast<std::size_t>(-1);
constexpr const char *kAcceptedColumns =
    "accepted: the columns x,y,z (and nx,ny,nz; landmark), or rows of three or six numbers without names";

/// Where x, y, z and the normal are in a row.
struct PointColumns {
  std::array<std::size_t, 6> at{0, 1, 2, kNoColumn, kNoColumn, kNoColumn};
  std::array<std::string, 6> names{"x", "y", "z", "nx", "ny", "nz"};
  std::size_t landmark = kNoColumn;
  std::size_t cells = 3;
  bool isNamed = false;

  [[nodiscard]] bool hasNormals() const { return at[3] != kNoColumn; }
};

Expected<PointColumns> columnsOfPoints(const std::filesystem::path &file, int line,
                                       const std::vector<std::string> &first) {
  PointColumns out;
  out.cells = first.size();
  if (std::all_of(first.begin(), first.end(),
                  [](const std::string &cell) { return finiteNumber(cell, kLargestNumber).has_value(); })) {
    if (first.size() == 6) out.at = {0, 1, 2, 3, 4, 5};
    if (first.size() == 3 || first.size() == 6) return out;
    return refusedRow(file, line, "the row has " + std::to_string(first.size()) + " numbers; " + kAcceptedColumns);
  }
  out.isNamed = true;
  if (const auto found = std::find(first.begin(), first.end(), "landmark"); found != first.end())
    out.landmark = static_cast<std::size_t>(found - first.begin());
  std::size_t normals = 0;
  for (std::size_t c = 0; c < 6; ++c) {
    out.at[c] = kNoColumn;
    for (const std::string &name : {out.names[c], out.names[c] + "_mm"})
      for (std::size_t i = 0; i < first.size(); ++i)
        if (first[i] == name && (c < 3 || name == out.names[c])) out.at[c] = i, out.names[c] = name;
    if (c >= 3 && out.at[c] != kNoColumn) ++normals;
    if (c < 3 && out.at[c] == kNoColumn)
      return refusedRow(file, line, "the column '" + out.names[c] + "' is missing; " + kAcceptedColumns);
  }
  if (normals != 0 && normals != 3)
    return refusedRow(file, line, "only some of the columns nx, ny, nz exist; " + std::string(kAcceptedColumns));
  return out;
}

Expected<void> addPointRow(const std::filesystem::path &file, int line, const std::vector<std::string> &cells,
                           const PointColumns &columns, double factor, MeasuredPoints &out) {
  if (cells.size() != columns.cells)
    return refusedRow(file, line,
                      "the row has " + std::to_string(cells.size()) +
                          " cells; accepted: " + std::to_string(columns.cells) + ", as in the first row");
  const bool isLandmark = columns.landmark != kNoColumn && !cells[columns.landmark].empty();
  std::array<double, 6> values{};
  for (std::size_t c = 0; c < (columns.hasNormals() && !isLandmark ? 6 : 3); ++c) {
    const std::string &cell = cells[columns.at[c]];
    const auto number = finiteNumber(cell, kLargestNumber);
    if (!number)
      return refusedRow(file, line, columns.names[c] + " is '" + cell + "'; accepted: a number from -1e6 to 1e6");
    values[c] = *number;
  }
  const Vec3 at_mm = factor * Vec3{values[0], values[1], values[2]};
  if (isLandmark) return addMeasuredLandmark(file, line, cells[columns.landmark], at_mm, out);
  if (out.points_mm.size() == kMaxMeasuredPoints)
    return refusedRow(file, line, "more than " + std::to_string(kMaxMeasuredPoints) + " points; accepted: fewer");
  out.points_mm.push_back(at_mm);
  if (!columns.hasNormals()) return {};
  const Vec3 normal{values[3], values[4], values[5]};
  if (!(norm(normal) > 0.0)) return refusedRow(file, line, "the normal is (0, 0, 0); accepted: a direction");
  out.normals.push_back((1.0 / norm(normal)) * normal);
  return {};
}

Expected<MeasuredPoints> readPointTable(const std::filesystem::path &file, double factor) {
  MeasuredPoints out;
  std::optional<PointColumns> columns;
  const auto read = readRows(file, [&](int line, const std::vector<std::string> &cells) -> Expected<void> {
    if (!columns) {
      auto found = columnsOfPoints(file, line, cells);
      if (!found) return tl::unexpected(found.error());
      columns = std::move(*found);
      if (columns->isNamed) return {};
    }
    return addPointRow(file, line, cells, *columns, factor, out);
  });
  if (!read) return tl::unexpected(read.error());
  if (out.points_mm.empty() && out.landmarks.empty())
    return fail(ErrorCode::input, displayMessage(pathText(file) + ": has no point; " + kAcceptedColumns));
  return out;
}

}  // namespace

Expected<void> addMeasuredLandmark(const std::filesystem::path &file, int line, const std::string &name,
                                   const Vec3 &at_mm, MeasuredPoints &out) {
  if (out.landmarks.size() == kMaxLandmarks)
    return refusedRow(file, line, "more than " + std::to_string(kMaxLandmarks) + " landmarks; accepted: fewer");
  for (const FileLandmark &other : out.landmarks)
    if (other.name == name)
      return refusedRow(file, line,
                        "landmark '" + name + "' has another position in " + other.where +
                            "; accepted: one row per landmark and frame");
  out.landmarks.push_back({name, at_mm, pathText(file) + ":" + std::to_string(line)});
  return {};
}

Expected<void> checkNoLandmarks(const MeasuredPoints &measured) {
  if (measured.landmarks.empty()) return {};
  const FileLandmark &one = measured.landmarks.front();
  return fail(ErrorCode::input,
              displayMessage(one.where + ": the row is the position of landmark '" + one.name +
                             "'; accepted: points of the surface. Measured landmarks are read from a file of target "
                             "landmarks; the column 'landmark' is accepted only in sequences (--frames)"));
}

Expected<MeasuredPoints> readMeasuredPoints(const std::filesystem::path &file,
                                            std::optional<geometry::LengthUnit> unit) {
  std::string name = pathText(file.filename());
  std::transform(name.begin(), name.end(), name.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? c + 32 : c; });
  if (name.ends_with(".csv"))
    return readPointTable(file, millimetresPer(unit.value_or(geometry::LengthUnit::millimetre)));
  if (!isLandmarkPath(file))
    return fail(ErrorCode::input,
                displayMessage(pathText(file) + ": is not named like points; accepted: .csv, .fcsv, .mrk.json"));
  if (unit && *unit != geometry::LengthUnit::millimetre)
    return fail(ErrorCode::input, displayMessage(pathText(file) + ": fiducials are in mm; accepted: no unit, or mm"));
  const auto landmarks = readLandmarks(file);
  if (!landmarks) return tl::unexpected(landmarks.error());
  MeasuredPoints out;
  for (const FileLandmark &one : *landmarks) out.points_mm.push_back(one.lps_mm);
  return out;
}

}  // namespace c3de::session
