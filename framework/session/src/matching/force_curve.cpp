// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/force_curve.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "c3de/core/path_text.h"
#include "c3de/core/text.h"
#include "files/table_rows.h"

namespace c3de::session {
namespace {

constexpr double kLargestNumber = 1e9;
constexpr std::size_t kFewestPoints = 4;
constexpr double kSmallestPart = 2e-4,
                 kLargestPart = 3.0;  // of the extent of the body: displacements that are possible
constexpr const char *kAccepted =
    "accepted: the columns displacement_mm and force_N, or rows of two numbers without names";

struct CurveColumns {
  std::array<std::size_t, 2> at{0, 1};
  std::array<std::string, 2> names{"displacement_mm", "force_N"};
  std::size_t cells = 2;
  bool isNamed = false;
};

Expected<CurveColumns> columnsOf(const std::filesystem::path &file, int line, const std::vector<std::string> &first) {
  CurveColumns out;
  out.cells = first.size();
  const bool isData = std::any_of(first.begin(), first.end(), [](const std::string &cell) {
    return finiteNumber(cell, kLargestNumber).has_value();
  });
  if (isData) {
    if (first.size() == 2) return out;
    return refusedRow(file, line, fmt::format("the row has {} cells; {}", first.size(), kAccepted));
  }
  out.isNamed = true;
  const auto find = [&](std::size_t column, const char *name) {
    const auto found = std::find(first.begin(), first.end(), name);
    if (found == first.end()) return false;
    out.at[column] = static_cast<std::size_t>(found - first.begin());
    out.names[column] = name;
    return true;
  };
  if (!find(0, "displacement_mm") && !find(0, "displacement_m"))
    return refusedRow(file, line, fmt::format("the column 'displacement_mm' is missing; {}", kAccepted));
  if (!find(1, "force_N")) return refusedRow(file, line, fmt::format("the column 'force_N' is missing; {}", kAccepted));
  return out;
}

Expected<void> addPoint(const std::filesystem::path &file, int line, const std::vector<std::string> &cells,
                        const CurveColumns &columns, ForceCurve &out) {
  if (cells.size() != columns.cells)
    return refusedRow(file, line, fmt::format("the row has {} cells; accepted: {}", cells.size(), columns.cells));
  std::array<double, 2> values{};
  for (std::size_t c = 0; c < 2; ++c) {
    const std::string &cell = cells[columns.at[c]];
    const auto number = finiteNumber(cell, kLargestNumber);
    if (!number)
      return refusedRow(file, line, fmt::format("{} is '{}'; accepted: a finite number", columns.names[c], cell));
    values[c] = *number;
  }
  if (out.lines.size() == kMaxCurvePoints)
    return refusedRow(file, line, fmt::format("more than {} points; accepted: fewer", kMaxCurvePoints));
  out.displacement_m.push_back((out.isInMillimetres ? 1e-3 : 1.0) * values[0]);
  out.force_N.push_back(values[1]);
  out.lines.push_back(line);
  return {};
}

std::string pointOf(const ForceCurve &curve, std::size_t i) {
  return curve.lines.empty() ? fmt::format("point {}", i + 1) : fmt::format("line {}", curve.lines[i]);
}

}  // namespace

Expected<ForceCurve> readForceCurve(const std::filesystem::path &file) {
  ForceCurve out;
  std::optional<CurveColumns> columns;
  const auto read = readRows(file, [&](int line, const std::vector<std::string> &cells) -> Expected<void> {
    if (!columns) {
      auto found = columnsOf(file, line, cells);
      if (!found) return tl::unexpected(found.error());
      columns = std::move(*found);
      out.isInMillimetres = columns->names[0] == "displacement_mm";
      if (columns->isNamed) return {};
    }
    return addPoint(file, line, cells, *columns, out);
  });
  if (!read) return tl::unexpected(read.error());
  if (!columns || out.lines.empty())
    return fail(ErrorCode::input, displayMessage(fmt::format("{}: contains no points; {}", pathText(file), kAccepted)));
  return out;
}

Expected<void> checkForceCurve(const ForceCurve &curve, bool isLoaded, double extent_m) {
  const std::vector<double> &prescribed = isLoaded ? curve.force_N : curve.displacement_m;
  const char *quantity = isLoaded ? "force" : "displacement";
  const double factor = isLoaded ? 1.0 : 1e3;
  const char *unit = isLoaded ? "N" : "mm";
  std::size_t different = 0;
  double before = 0.0, largest_m = 0.0;
  for (std::size_t i = 0; i < prescribed.size(); ++i) {
    if (!std::isfinite(curve.displacement_m[i]) || !std::isfinite(curve.force_N[i]))
      return fail(ErrorCode::input, fmt::format("{}: displacement {} m, force {} N; accepted: finite numbers",
                                                pointOf(curve, i), curve.displacement_m[i], curve.force_N[i]));
    if (prescribed[i] < 0.0)
      return fail(ErrorCode::input,
                  fmt::format("{}: the {} is {:.6g} {}; accepted: 0 or more, in the direction that the "
                              "scene prescribes",
                              pointOf(curve, i), quantity, factor * prescribed[i], unit));
    if (prescribed[i] < before)
      return fail(ErrorCode::input,
                  fmt::format("{}: the {} decreases from {:.6g} to {:.6g} {}; accepted: the loading part of the curve, "
                              "in its order",
                              pointOf(curve, i), quantity, factor * before, factor * prescribed[i], unit));
    if (prescribed[i] > before) ++different;
    before = prescribed[i];
    largest_m = std::max(largest_m, std::abs(curve.displacement_m[i]));
  }
  if (largest_m == 0.0 && !prescribed.empty())
    return fail(ErrorCode::input, "every displacement is 0; accepted: a curve along which the body deforms");
  if (different < kFewestPoints)
    return fail(ErrorCode::input,
                fmt::format("{} different {}s above 0; accepted: {} or more", different, quantity, kFewestPoints));
  if (curve.isInMillimetres && extent_m > 0.0 && largest_m < kSmallestPart * extent_m)
    return fail(
        ErrorCode::input,
        fmt::format("the largest displacement is {:.3g} mm, {:.2g} of the extent of the body ({:.4g} mm); if the "
                    "values are in metres, name the column displacement_m, which accepts smaller ones",
                    1e3 * largest_m, largest_m / extent_m, 1e3 * extent_m));
  if (extent_m > 0.0 && largest_m > kLargestPart * extent_m)
    return fail(ErrorCode::input,
                fmt::format("the largest displacement is {:.4g} mm, {:.2g} times the extent of the body "
                            "({:.4g} mm); accepted: up to {:g} times",
                            1e3 * largest_m, largest_m / extent_m, 1e3 * extent_m, kLargestPart));
  return {};
}

}  // namespace c3de::session
