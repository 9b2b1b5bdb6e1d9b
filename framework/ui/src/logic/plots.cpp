// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "c3de/core/text.h"

namespace c3de::ui {
namespace {

std::string quoted(const std::string &text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"') out += '"';
    out += c;
  }
  return out + '"';
}

void addPoint(PlotList::Series &series, const PlotPoint &point) {
  std::vector<PlotPoint> &points = series.points;
  while (!points.empty() && points.back().time_s >= point.time_s) points.pop_back();
  if (points.size() < 2) series.spacing_s = 0.0;
  // The last point is the present one; it stays if it is far enough from the one before.
  if (points.size() >= 2 && points.back().time_s - points[points.size() - 2].time_s < series.spacing_s)
    points.pop_back();
  if (points.size() >= PlotList::kMaxPoints) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < points.size(); i += 2) points[kept++] = points[i];
    points.resize(kept);
    // New points are as far apart as the old ones.
    series.spacing_s = (points.back().time_s - points.front().time_s) / static_cast<double>(kept - 1);
  }
  points.push_back(point);
}

/// The description of a series in the unit in which it is shown.
PlotValue inUnitOf(const DisplayUnit &shown, PlotValue value) {
  value.unit = shown.name;
  value.value *= shown.factor;
  if (value.limit) *value.limit *= shown.factor;
  return value;
}

}  // namespace

void PlotList::setUnits(const DisplayUnits &units) {
  units_ = units;
  for (Series &series : series_) {
    const DisplayUnit shown = displayUnit(units, series.declaredUnit);
    const double change = shown.factor / series.factor;
    series.factor = shown.factor;
    series.last = inUnitOf({shown.name, change}, series.last);
    for (PlotPoint &point : series.points) point.value *= change;
  }
}

std::optional<double> PlotList::Series::valueAt(double time_s) const {
  const auto after = std::upper_bound(points.begin(), points.end(), time_s,
                                      [](double time, const PlotPoint &point) { return time < point.time_s; });
  if (after == points.begin()) return std::nullopt;
  return std::prev(after)->value;
}

PlotList::Series *PlotList::find(const std::string &id) {
  const auto found = std::find_if(series_.begin(), series_.end(), [&](const Series &s) { return s.last.id == id; });
  return found == series_.end() ? nullptr : &*found;
}

PlotList::Series *PlotList::findOrAdd(const PlotValue &value, int source) {
  if (Series *known = find(value.id)) return known;
  // A reset can leave curves without points.
  if (series_.size() >= kMaxSeries) std::erase_if(series_, [](const Series &series) { return series.points.empty(); });
  if (series_.size() >= kMaxSeries) return nullptr;
  const auto chosen = chosen_.find(value.id);
  Series &series =
      series_.emplace_back(Series{value, chosen == chosen_.end() ? value.isShownAtFirst : chosen->second, source});
  const DisplayUnit shown = displayUnit(units_, value.unit);
  series.last = inUnitOf(shown, value);
  series.declaredUnit = value.unit;
  series.factor = shown.factor;
  return &series;
}

void PlotList::add(double time_s, const std::vector<PlotValue> &values, int source) {
  if (!std::isfinite(time_s)) return;
  if (const auto last = lastTime_s_.find(source); last != lastTime_s_.end() && time_s < last->second)
    for (Series &series : series_)
      while (series.source == source && !series.points.empty() && series.points.back().time_s > time_s)
        series.points.pop_back();
  lastTime_s_[source] = time_s;
  for (const PlotValue &value : values) {
    if (!std::isfinite(value.value)) continue;
    Series *series = findOrAdd(value, source);
    if (!series) continue;
    // A quantity may change its unit, for example after another scene was opened.
    const DisplayUnit shown = displayUnit(units_, value.unit);
    series->last = inUnitOf(shown, value);
    series->declaredUnit = value.unit;
    series->factor = shown.factor;
    addPoint(*series, {time_s, series->last.value});
  }
}

void PlotList::addPast(const PlotValue &value, const std::vector<PlotPoint> &points, int source) {
  Series *series = findOrAdd(value, source);
  if (!series || !series->points.empty()) return;
  for (const PlotPoint &point : points) addPoint(*series, {point.time_s, point.value * series->factor});
}

void PlotList::keepOnly(int source, const std::vector<std::string> &ids) {
  std::erase_if(series_, [&](const Series &series) {
    return series.source == source && std::find(ids.begin(), ids.end(), series.last.id) == ids.end();
  });
}

void PlotList::clear() {
  series_.clear();
  lastTime_s_.clear();
}

void PlotList::show(const std::string &id, bool isShown) {
  chosen_[id] = isShown;
  if (Series *series = find(id)) series->isShown = isShown;
}

std::size_t PlotList::shownCount() const {
  return static_cast<std::size_t>(
      std::count_if(series_.begin(), series_.end(), [](const Series &s) { return s.isShown && !s.points.empty(); }));
}

std::string PlotList::csv() const {
  std::string text = "time [s]";
  std::map<double, std::map<std::size_t, double>> rows;
  std::size_t columns = 0;
  for (const Series &series : series_) {
    if (!series.isShown || series.points.empty()) continue;
    text += "," + quoted(series.last.label + " [" + (series.last.unit.empty() ? "1" : series.last.unit) + "]");
    for (const PlotPoint &point : series.points) rows[point.time_s][columns] = point.value;
    ++columns;
  }
  text += "\n";
  for (const auto &[time_s, cells] : rows) {
    text += formatNumber(time_s);
    for (std::size_t c = 0; c < columns; ++c) {
      text += ",";
      if (const auto cell = cells.find(c); cell != cells.end()) text += formatNumber(cell->second);
    }
    text += "\n";
  }
  return text;
}

std::string plotNumber(double value) { return fmt::format("{:.4g}", value); }

}  // namespace c3de::ui
