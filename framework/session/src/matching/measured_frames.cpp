// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/measured_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <system_error>

#include "c3de/core/path_text.h"
#include "c3de/core/text.h"
#include "c3de/session/landmark_file.h"
#include "files/table_rows.h"
#include "matching/measured_landmark.h"

namespace c3de::session {
namespace {

namespace fs = std::filesystem;

constexpr double kLargestNumber = 1e6;
constexpr std::size_t kNoColumn = static_cast<std::size_t>(-1);
constexpr const char *kAccepted = "accepted: the columns frame or time_s, and x, y, z; optional: landmark";

/// Whether a name comes before another one, with numbers in them by value.
bool isBefore(const std::string &a, const std::string &b) {
  const auto isDigit = [](char c) { return c >= '0' && c <= '9'; };
  std::size_t i = 0, k = 0;
  while (i < a.size() && k < b.size()) {
    if (isDigit(a[i]) && isDigit(b[k])) {
      const auto number = [&](const std::string &text, std::size_t &at) {
        while (at + 1 < text.size() && text[at] == '0' && isDigit(text[at + 1])) ++at;
        const std::size_t from = at;
        while (at < text.size() && isDigit(text[at])) ++at;
        return text.substr(from, at - from);
      };
      const std::string one = number(a, i), other = number(b, k);
      if (one.size() != other.size()) return one.size() < other.size();
      if (one != other) return one < other;
    } else {
      if (a[i] != b[k]) return a[i] < b[k];
      ++i, ++k;
    }
  }
  if (a.size() - i != b.size() - k) return a.size() - i < b.size() - k;
  return a < b;  // f1 and f01
}

struct FrameColumns {
  std::size_t frame = kNoColumn, time = kNoColumn, landmark = kNoColumn, cells = 0;
  std::array<std::size_t, 3> at{kNoColumn, kNoColumn, kNoColumn};
};

Expected<FrameColumns> columnsOf(const fs::path &file, int line, const std::vector<std::string> &first) {
  FrameColumns out;
  out.cells = first.size();
  const std::array<const char *, 3> names{"x", "y", "z"};
  for (std::size_t i = 0; i < first.size(); ++i) {
    if (first[i] == "frame") out.frame = i;
    if (first[i] == "time_s") out.time = i;
    if (first[i] == "landmark") out.landmark = i;
    for (std::size_t a = 0; a < 3; ++a)
      if (first[i] == names[a] || first[i] == std::string(names[a]) + "_mm") out.at[a] = i;
  }
  for (std::size_t a = 0; a < 3; ++a)
    if (out.at[a] == kNoColumn)
      return refusedRow(file, line, fmt::format("the column '{}' is missing; {}", names[a], kAccepted));
  if (out.frame == kNoColumn && out.time == kNoColumn)
    return refusedRow(file, line, fmt::format("neither 'frame' nor 'time_s' is a column; {}", kAccepted));
  return out;
}

Expected<void> addRow(const fs::path &file, int line, const std::vector<std::string> &cells,
                      const FrameColumns &columns, double factor, std::vector<MeasuredFrame> &out) {
  if (cells.size() != columns.cells)
    return refusedRow(
        file, line,
        fmt::format("the row has {} cells; accepted: {}, as in the first row", cells.size(), columns.cells));
  const std::string &name = cells[columns.frame != kNoColumn ? columns.frame : columns.time];
  if (name.empty()) return refusedRow(file, line, "the frame has no name; accepted: a number or text");
  std::optional<double> time_s;
  if (columns.time != kNoColumn) {
    time_s = finiteNumber(cells[columns.time], kLargestNumber);
    if (!time_s)
      return refusedRow(file, line,
                        fmt::format("time_s is '{}'; accepted: a number from -1e6 to 1e6", cells[columns.time]));
  }
  if (out.empty() || out.back().name != name) {
    if (out.size() == kMaxFrames) return refusedRow(file, line, fmt::format("more than {} frames", kMaxFrames));
    if (time_s && !out.empty() && !(*time_s > *out.back().time_s))
      return refusedRow(
          file, line,
          fmt::format("time_s is {}, and {} before; accepted: times that increase", *time_s, *out.back().time_s));
    if (std::any_of(out.begin(), out.end(), [&](const MeasuredFrame &one) { return one.name == name; }))
      return refusedRow(file, line,
                        fmt::format("frame '{}' has rows above; accepted: all rows of a frame together", name));
    out.push_back({name, time_s, {}});
  }
  Vec3 point{};
  for (std::size_t a = 0; a < 3; ++a) {
    const std::string &cell = cells[columns.at[a]];
    const auto number = finiteNumber(cell, kLargestNumber);
    if (!number)
      return refusedRow(file, line, fmt::format("{} is '{}'; accepted: a number from -1e6 to 1e6", "xyz"[a], cell));
    point[a] = factor * *number;
  }
  if (columns.landmark != kNoColumn && !cells[columns.landmark].empty())
    return addMeasuredLandmark(file, line, cells[columns.landmark], point, out.back().measured);
  if (out.back().measured.points_mm.size() == kMaxMeasuredPoints)
    return refusedRow(file, line, fmt::format("more than {} points in a frame", kMaxMeasuredPoints));
  out.back().measured.points_mm.push_back(point);
  return {};
}

Expected<std::vector<MeasuredFrame>> framesOfTable(const fs::path &file, double factor) {
  std::vector<MeasuredFrame> out;
  std::optional<FrameColumns> columns;
  const auto read = readRows(file, [&](int line, const std::vector<std::string> &cells) -> Expected<void> {
    if (columns) return addRow(file, line, cells, *columns, factor, out);
    const auto found = columnsOf(file, line, cells);
    if (!found) return tl::unexpected(found.error());
    columns = *found;
    return {};
  });
  if (!read) return tl::unexpected(read.error());
  if (out.empty())
    return fail(ErrorCode::input, displayMessage(fmt::format("{}: has no frame; {}", pathText(file), kAccepted)));
  return out;
}

bool isPointFile(const fs::path &file) { return pathText(file.extension()) == ".csv" || isLandmarkPath(file); }

Expected<std::vector<MeasuredFrame>> framesOfFolder(const fs::path &folder, std::optional<geometry::LengthUnit> unit) {
  std::vector<fs::path> files;
  std::error_code failed;
  for (fs::directory_iterator one(folder, failed), end; !failed && one != end; one.increment(failed))
    if (isPointFile(one->path())) files.push_back(one->path());
  if (failed) return fail(ErrorCode::input, displayMessage(fmt::format("{}: {}", pathText(folder), failed.message())));
  if (files.empty())
    return fail(
        ErrorCode::input,
        displayMessage(fmt::format("{}: has no file of points; accepted: .csv, .fcsv, .mrk.json", pathText(folder))));
  if (files.size() > kMaxFrames)
    return fail(ErrorCode::input, displayMessage(fmt::format("{}: more than {} frames", pathText(folder), kMaxFrames)));
  std::sort(files.begin(), files.end(), [](const fs::path &a, const fs::path &b) {
    return isBefore(pathText(a.filename()), pathText(b.filename()));
  });
  std::vector<MeasuredFrame> out;
  for (const fs::path &file : files) {
    auto measured = readMeasuredPoints(file, unit);
    if (!measured) return tl::unexpected(measured.error());
    out.push_back({pathText(file.filename()), std::nullopt, std::move(*measured)});
  }
  return out;
}

}  // namespace

Expected<std::vector<MeasuredFrame>> readMeasuredFrames(const fs::path &path,
                                                        std::optional<geometry::LengthUnit> unit) {
  std::error_code failed;
  if (fs::is_directory(path, failed)) return framesOfFolder(path, unit);
  return framesOfTable(path, millimetresPer(unit.value_or(geometry::LengthUnit::millimetre)));
}

}  // namespace c3de::session
