// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/landmark_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <sstream>

#include "c3de/core/csv.h"
#include "c3de/core/input_file.h"
#include "c3de/core/output_file.h"
#include "c3de/core/path_text.h"
#include "c3de/core/text.h"
#include "files/table_rows.h"

namespace c3de::session {
namespace {

using OrderedJson = nlohmann::ordered_json;
using Landmarks = Expected<std::vector<FileLandmark>>;

constexpr const char *kAccepted = "accepted: .csv, .fcsv, .mrk.json";
constexpr double kLargest_mm = 1e6;
const std::array<std::string, 4> kCsvColumns{"name", "x_mm", "y_mm", "z_mm"};
const std::array<std::string, 4> kFcsvColumns{"label", "x", "y", "z"};

enum class Format { csv, fcsv, markups };

std::optional<Format> formatOf(const std::filesystem::path &file) {
  std::string name = pathText(file.filename());
  std::transform(name.begin(), name.end(), name.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? c + 32 : c; });
  if (name.ends_with(".mrk.json")) return Format::markups;
  if (name.ends_with(".fcsv")) return Format::fcsv;
  if (name.ends_with(".csv")) return Format::csv;
  return std::nullopt;
}

Vec3 lpsOf(const Vec3 &v, bool isRas) { return isRas ? Vec3{-v[0], -v[1], v[2]} : v; }

tl::unexpected<Error> refuse(const std::string &where, const std::string &what) {
  return fail(ErrorCode::input, displayMessage(where + ": " + what));
}

std::string lineOf(const std::filesystem::path &file, int line) { return pathText(file) + ":" + std::to_string(line); }

/// Landmarks in the order of the file, with different names.
class Collection {
 public:
  Expected<void> add(const std::string &where, const std::string &name, const Vec3 &lps_mm) {
    if (name.empty()) return refuse(where, "the landmark has no name; accepted: text of at least one character");
    if (std::any_of(name.begin(), name.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20; }))
      return refuse(where, "the name '" + name + "' has a control character; accepted: text on one line");
    if (!names_.insert(name).second)
      return refuse(where, "a second landmark is named '" + name + "'; accepted: names that differ");
    if (all_.size() == kMaxLandmarks)
      return refuse(where, "more than " + std::to_string(kMaxLandmarks) + " landmarks; accepted: fewer");
    all_.push_back({name, lps_mm, where});
    return {};
  }
  std::vector<FileLandmark> all_;

 private:
  std::set<std::string> names_;
};

/// Adds a row. @param columns  indices of name, x, y and z
Expected<void> addRow(Collection &all, const std::string &where, const std::string &row, std::size_t cells,
                      const std::array<std::size_t, 4> &columns, const std::array<std::string, 4> &names, bool isRas) {
  const auto split = splitCsvRow(row);
  const std::size_t needed = *std::max_element(columns.begin(), columns.end()) + 1;
  if (!split || split->size() < needed || split->size() > std::max(needed, cells))
    return refuse(where, !split ? std::string("a quotation mark is not closed; accepted: a row of cells")
                                : "the row has " + std::to_string(split->size()) +
                                      " cells; accepted: " + std::to_string(cells) + ", separated by commas");
  Vec3 at{};
  for (std::size_t a = 0; a < 3; ++a) {
    const std::string cell = trimmed((*split)[columns[a + 1]]);
    const auto number = finiteNumber(cell, kLargest_mm);
    if (!number) return refuse(where, names[a + 1] + " is '" + cell + "'; accepted: a number in mm, from -1e6 to 1e6");
    at[a] = *number;
  }
  return all.add(where, trimmed((*split)[columns[0]]), lpsOf(at, isRas));
}

/// Indices of the columns; the error names the one that is missing.
Expected<std::array<std::size_t, 4>> columnsOf(const std::string &where, const std::string &head,
                                               const std::array<std::string, 4> &names) {
  auto cells = splitCsvRow(head);
  if (cells)
    for (std::string &cell : *cells) cell = trimmed(cell);
  std::array<std::size_t, 4> columns{};
  for (std::size_t c = 0; c < names.size(); ++c) {
    const auto found = cells ? std::find(cells->begin(), cells->end(), names[c]) : std::vector<std::string>::iterator();
    if (!cells || found == cells->end())
      return refuse(where, "the column '" + names[c] + "' is missing in '" + head + "'; accepted: " + names[0] + "," +
                               names[1] + "," + names[2] + "," + names[3]);
    columns[c] = static_cast<std::size_t>(found - cells->begin());
  }
  return columns;
}

std::size_t cellsOf(const std::string &row) {
  const auto cells = splitCsvRow(row);
  return cells ? cells->size() : 0;
}

Landmarks readCsv(std::istream &in, const std::filesystem::path &file) {
  std::string head, row;
  std::getline(in, head);
  if (head.starts_with("\xef\xbb\xbf")) head.erase(0, 3);
  head = trimmed(head);
  const auto columns = columnsOf(lineOf(file, 1), head, kCsvColumns);
  if (!columns) return tl::unexpected(columns.error());
  Collection all;
  for (int line = 2; std::getline(in, row); ++line) {
    if (trimmed(row).empty()) continue;
    if (auto good = addRow(all, lineOf(file, line), row, cellsOf(head), *columns, kCsvColumns, false); !good)
      return tl::unexpected(good.error());
  }
  return std::move(all.all_);
}

/// "CoordinateSystem" of `.fcsv`: whether it is RAS.
Expected<bool> isRasOf(const std::string &where, const std::string &text) {
  if (text == "RAS" || text == "0") return true;
  if (text == "LPS" || text == "1") return false;
  return refuse(where, "CoordinateSystem is '" + text + "'; accepted: RAS or 0, LPS or 1");
}

Landmarks readFcsv(std::istream &in, const std::filesystem::path &file) {
  std::optional<bool> isRas;
  std::array<std::size_t, 4> columns{11, 1, 2, 3};
  std::size_t cells = 14;
  Collection all;
  std::string row;
  for (int line = 1; std::getline(in, row); ++line) {
    const std::string where = lineOf(file, line);
    row = trimmed(row);
    if (row.empty()) continue;
    if (row.front() == '#') {
      const auto equals = row.find('=');
      if (equals == std::string::npos) continue;
      const std::string key = trimmed(row.substr(1, equals - 1)), value = trimmed(row.substr(equals + 1));
      if (key == "CoordinateSystem") {
        const auto stated = isRasOf(where, value);
        if (!stated) return tl::unexpected(stated.error());
        isRas = *stated;
      } else if (key == "columns") {
        const auto stated = columnsOf(where, value, kFcsvColumns);
        if (!stated) return tl::unexpected(stated.error());
        columns = *stated;
        cells = cellsOf(value);
      }
      continue;
    }
    if (!isRas)
      return refuse(where,
                    "no line before it states the coordinate system; accepted: a line '# CoordinateSystem = LPS' (or "
                    "RAS, 0, 1)");
    if (auto good = addRow(all, where, row, cells, columns, kFcsvColumns, *isRas); !good)
      return tl::unexpected(good.error());
  }
  return std::move(all.all_);
}

std::string textOf(const OrderedJson &object, const char *key, const std::string &fallback) {
  const auto found = object.find(key);
  if (found == object.end()) return fallback;
  return found->is_string() ? found->get<std::string>()
                            : found->dump(-1, ' ', false, OrderedJson::error_handler_t::replace);
}

Expected<void> addControlPoint(Collection &all, const std::string &where, const OrderedJson &point, bool isRas) {
  if (!point.is_object()) return refuse(where, "is no object; accepted: { \"label\": …, \"position\": [x, y, z] }");
  if (textOf(point, "positionStatus", "defined") != "defined") return {};  // it has no position yet
  const auto position = point.find("position");
  const bool isGood = position != point.end() && position->is_array() && position->size() == 3 &&
                      std::all_of(position->begin(), position->end(), [](const OrderedJson &x) {
                        return x.is_number() && std::abs(x.get<double>()) <= kLargest_mm;
                      });
  if (!isGood)
    return refuse(where, "position is " + textOf(point, "position", "missing") +
                             "; accepted: three numbers [x, y, z] in mm, from -1e6 to 1e6");
  return all.add(where, trimmed(textOf(point, "label", "")), lpsOf(position->get<Vec3>(), isRas));
}

Expected<void> addMarkup(Collection &all, const std::string &where, const OrderedJson &markup) {
  if (!markup.is_object()) return refuse(where, "is no object; accepted: an object with \"controlPoints\"");
  if (const std::string type = textOf(markup, "type", "Fiducial"); type != "Fiducial")
    return refuse(where, "type is '" + type + "'; accepted: Fiducial");
  const std::string system = textOf(markup, "coordinateSystem", "LPS");
  if (system != "LPS" && system != "RAS")
    return refuse(where, "coordinateSystem is '" + system + "'; accepted: LPS, RAS");
  const std::string unit = textOf(markup, "coordinateUnits", "mm");
  if (unit != "mm" && unit.find("mm,") == std::string::npos && unit.find("\"mm\"") == std::string::npos)
    return refuse(where, "coordinateUnits is '" + unit + "'; accepted: mm");
  const auto points = markup.find("controlPoints");
  if (points == markup.end() || !points->is_array())
    return refuse(where, "controlPoints is " + textOf(markup, "controlPoints", "missing") + "; accepted: a list");
  for (std::size_t i = 0; i < points->size(); ++i)
    if (auto good =
            addControlPoint(all, where + ", control point " + std::to_string(i + 1), (*points)[i], system == "RAS");
        !good)
      return good;
  return {};
}

Landmarks readMarkups(std::istream &in, const std::filesystem::path &file) {
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  OrderedJson root;
  try {
    root = OrderedJson::parse(text);
  } catch (const OrderedJson::parse_error &error) {
    const auto at = static_cast<std::ptrdiff_t>(std::min<std::size_t>(error.byte, text.size()));
    const auto line = 1 + std::count(text.begin(), text.begin() + at, '\n');
    return refuse(lineOf(file, static_cast<int>(line)), "is not JSON; accepted: markups of 3D Slicer");
  } catch (const OrderedJson::exception &) {
    return refuse(lineOf(file, 1), "is not JSON; accepted: markups of 3D Slicer");
  }
  const auto markups = root.is_object() ? root.find("markups") : root.end();
  if (!root.is_object() || markups == root.end() || !markups->is_array())
    return refuse(lineOf(file, 1), "has no list \"markups\"; accepted: markups of 3D Slicer");
  Collection all;
  for (std::size_t i = 0; i < markups->size(); ++i)
    if (auto good = addMarkup(all, pathText(file) + ": markup " + std::to_string(i + 1), (*markups)[i]); !good)
      return tl::unexpected(good.error());
  return std::move(all.all_);
}

std::string coordinateCells(const Vec3 &v) {
  return ',' + formatNumber(v[0]) + ',' + formatNumber(v[1]) + ',' + formatNumber(v[2]);
}

std::string csvText(std::span<const WrittenLandmark> landmarks) {
  std::string text = "name,x_mm,y_mm,z_mm,x_now_mm,y_now_mm,z_now_mm\n";
  for (const WrittenLandmark &one : landmarks)
    text += csvCell(one.name) + coordinateCells(one.reference_mm) + coordinateCells(one.position_mm) + '\n';
  return text;
}

std::string fcsvText(std::span<const WrittenLandmark> landmarks) {
  std::string text =
      "# Markups fiducial file version = 4.11\n# CoordinateSystem = LPS\n"
      "# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID\n";
  for (std::size_t i = 0; i < landmarks.size(); ++i)
    text += std::to_string(i + 1) + coordinateCells(landmarks[i].position_mm) + ",0,0,0,1,1,1,0," +
            csvCell(landmarks[i].name) + ",,\n";
  return text;
}

std::string markupsText(std::span<const WrittenLandmark> landmarks) {
  OrderedJson points = OrderedJson::array();
  for (std::size_t i = 0; i < landmarks.size(); ++i)
    points.push_back(OrderedJson{{"id", std::to_string(i + 1)},
                                 {"label", landmarks[i].name},
                                 {"position", landmarks[i].position_mm},
                                 {"positionStatus", "defined"}});
  const OrderedJson root{
      {"@schema",
       "https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/Resources/Schema/"
       "markups-schema-v1.0.3.json#"},
      {"markups", OrderedJson::array({OrderedJson{{"type", "Fiducial"},
                                                  {"coordinateSystem", "LPS"},
                                                  {"coordinateUnits", "mm"},
                                                  {"controlPoints", std::move(points)}}})}};
  return root.dump(2, ' ', false, OrderedJson::error_handler_t::replace) + "\n";
}

}  // namespace

bool isLandmarkPath(const std::filesystem::path &file) { return formatOf(file).has_value(); }

Expected<void> checkLandmarkPath(const std::filesystem::path &file, const std::string &option) {
  if (isLandmarkPath(file)) return {};
  return fail(ErrorCode::usage,
              option + " " + displayText(pathText(file)) + ": is not named like landmarks; " + kAccepted);
}

Expected<std::vector<FileLandmark>> readLandmarks(const std::filesystem::path &file) {
  const auto format = formatOf(file);
  if (!format) return refuse(pathText(file), std::string("is not named like landmarks; ") + kAccepted);
  auto opened = openInputFile(file);
  if (!opened) return tl::unexpected(opened.error());
  auto read = *format == Format::csv    ? readCsv(*opened, file)
              : *format == Format::fcsv ? readFcsv(*opened, file)
                                        : readMarkups(*opened, file);
  if (read && read->empty()) return refuse(pathText(file), "has no landmark; accepted: one at least");
  return read;
}

Expected<void> writeLandmarks(const std::filesystem::path &file, std::span<const WrittenLandmark> landmarks) {
  const auto format = formatOf(file);
  if (!format)
    return fail(ErrorCode::output, displayText(pathText(file)) + ": is not named like landmarks; " + kAccepted);
  return writeWholeFile(file, *format == Format::csv    ? csvText(landmarks)
                              : *format == Format::fcsv ? fcsvText(landmarks)
                                                        : markupsText(landmarks));
}

}  // namespace c3de::session
