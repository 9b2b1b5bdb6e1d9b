// SPDX-License-Identifier: Apache-2.0
// Quantities over simulated time, for the strip of plots.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "c3de/ui/display_units.h"

namespace c3de::ui {

struct PlotPoint {
  double time_s = 0.0, value = 0.0;
};

/// A quantity, with its value at a moment.
struct PlotValue {
  std::string id;     ///< unique
  std::string label;  ///< for the user
  std::string unit;   ///< empty: a ratio
  double value = 0.0;
  bool isShownAtFirst = false;
  std::optional<double> limit{};  ///< of the value, drawn as a line
  std::string limitText{};        ///< what the limit is
};

/// Curves with bounded memory. Main thread.
class PlotList {
 public:
  struct Series {
    PlotValue last;  ///< its description, and its last value, in the unit of the user
    bool isShown = false;
    int source = 0;
    std::vector<PlotPoint> points{};  ///< in the order of time
    std::string declaredUnit{};       ///< in which values are added
    double factor = 1.0;              ///< value here / added value
    double spacing_s = 0.0;           ///< least time between two kept points
    /// Of the last point that is not after this time; none: the curve begins later.
    [[nodiscard]] std::optional<double> valueAt(double time_s) const;
  };
  /// At this number of points, every second one of a curve is dropped, and later points are recorded at this larger
  /// interval.
  static constexpr std::size_t kMaxPoints = 2000;
  /// Further quantities are ignored.
  static constexpr std::size_t kMaxSeries = 400;

  /// Values at a time of the simulation; those that are not finite are omitted. A time before the last one of its
  /// source discards the part of the source's curves after it: the simulation was reset, or a replay has jumped back.
  /// @param source  of values that are read at the same times
  void add(double time_s, const std::vector<PlotValue> &values, int source = 0);
  /// Adds earlier values of a quantity; no effect where there is a curve with this id.
  void addPast(const PlotValue &value, const std::vector<PlotPoint> &points, int source = 0);
  /// Removes the curves of a source with other ids.
  void keepOnly(int source, const std::vector<std::string> &ids);
  /// Removes all curves; what was chosen is kept for quantities that return.
  void clear();
  /// In which values, limits and tables are from now on; what is there is converted.
  void setUnits(const DisplayUnits &units);

  [[nodiscard]] const std::vector<Series> &series() const { return series_; }
  void show(const std::string &id, bool isShown);
  [[nodiscard]] std::size_t shownCount() const;
  /// Shown quantities as a table: the first column is the time, the others are named "label [unit]". A cell is empty
  /// where a curve has no point at that time. Separator, quotes and decimal point as in CSV of RFC 4180.
  [[nodiscard]] std::string csv() const;

 private:
  [[nodiscard]] Series *find(const std::string &id);
  /// None: there are kMaxSeries already.
  [[nodiscard]] Series *findOrAdd(const PlotValue &value, int source);

  DisplayUnits units_;
  std::vector<Series> series_;
  std::map<int, double> lastTime_s_;    ///< by source
  std::map<std::string, bool> chosen_;  ///< by id: whether the user wants to see it
};

/// "0.0123", "1.23e+04": four digits.
[[nodiscard]] std::string plotNumber(double value);

}  // namespace c3de::ui
