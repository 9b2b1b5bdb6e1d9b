// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/vec.h"
#include "c3de/ui/display_units.h"

namespace c3de::registry {
class EditList;
}

namespace c3de::ui {

/// A material point, mm, LPS.
struct MeasuredPoint {
  std::string name;  ///< unique
  std::string body;  ///< that a scene names; empty: the one in which it lies
  Vec3 reference_mm{};
  std::optional<Vec3> target_mm;
  bool isHidden = false;
  bool isOfScene = false;
  friend bool operator==(const MeasuredPoint &, const MeasuredPoint &) = default;
};

/// A distance of two points, or an angle of three, whose vertex is the second.
struct Measure {
  std::string name;
  std::vector<std::string> points;
  bool isHidden = false;
  bool isOfScene = false;
  [[nodiscard]] bool isAngle() const { return points.size() == 3; }
  friend bool operator==(const Measure &, const Measure &) = default;
};

/// Landmarks and what is measured between them. Names are unique among all of them. Value type.
struct MeasurementSet {
  std::vector<MeasuredPoint> points;
  std::vector<Measure> measures;

  [[nodiscard]] bool isEmpty() const { return points.empty() && measures.empty(); }
  [[nodiscard]] const MeasuredPoint *point(const std::string &name) const;
  [[nodiscard]] const Measure *measure(const std::string &name) const;
  [[nodiscard]] bool has(const std::string &name) const { return point(name) || measure(name); }
  /// "Landmark 1", or the next number that is free.
  [[nodiscard]] std::string freeName(const std::string &kind) const;
  /// A point is removed together with the measures that use it.
  void remove(const std::string &name);
  /// Errors (usage): the name is empty or already used.
  [[nodiscard]] Expected<void> rename(const std::string &name, const std::string &wanted);
  void setHidden(const std::string &name, bool isHidden);
  /// No effect without a landmark of this name.
  void setTarget(const std::string &name, const std::optional<Vec3> &at_mm);
  /// What the scene has replaces what has the same name or came from a scene before; the rest stays.
  void mergeScene(const MeasurementSet &scene);
  friend bool operator==(const MeasurementSet &, const MeasurementSet &) = default;
};

enum class MeasureKind { landmark, distance, angle };
[[nodiscard]] const char *kindName(MeasureKind kind);  ///< "Landmark", …

/// Angle at the second point, 0 … 180 degrees; none: two of the points coincide.
[[nodiscard]] std::optional<double> angle_deg(const Vec3 &a, const Vec3 &vertex, const Vec3 &c);

/// A row of the table. Values: mm or degrees; of a landmark its displacement, which is zero at rest.
struct MeasurementRow {
  std::string name;
  MeasureKind kind = MeasureKind::landmark;
  bool isHidden = false;
  std::optional<double> reference, now;
  std::optional<std::array<double, 2>> error_mm;  ///< of a landmark with a target: at rest, now
  DisplayUnit length{"mm", 1.0};                  ///< in which texts show lengths
  [[nodiscard]] std::string unit() const { return kind == MeasureKind::angle ? "°" : length.name; }
  /// A value of this row as it is shown.
  [[nodiscard]] double shown(double value) const { return kind == MeasureKind::angle ? value : value * length.factor; }
  [[nodiscard]] std::string referenceText() const;
  [[nodiscard]] std::string nowText() const;
  [[nodiscard]] std::string changeText() const;
  /// "42.1 → 36.8 mm"; one number where nothing has changed; of a landmark its displacement, empty at rest.
  [[nodiscard]] std::string label() const;
};

/// Of the errors of all landmarks with a target, mm; sd of the sample (n - 1).
struct TargetErrors {
  std::size_t count = 0;
  std::array<double, 2> mean_mm{}, sd_mm{}, max_mm{};  ///< at rest, now
};

struct CurvePoint2 {
  double time_s = 0.0, value = 0.0;
};

/// Landmarks, distances and angles of the window, with their present positions and their past. Every edit is a step of
/// undo. Main thread.
class MeasurementList {
 public:
  /// @param edits  must outlive this; null: nothing can be undone
  explicit MeasurementList(registry::EditList *edits = nullptr) : edits_(edits) {}
  MeasurementList(const MeasurementList &) = delete;
  MeasurementList &operator=(const MeasurementList &) = delete;

  [[nodiscard]] const MeasurementSet &set() const { return set_; }
  /// Equal numbers: equal content. Undo returns to the earlier number.
  [[nodiscard]] std::uint64_t revision() const { return revision_; }
  /// Replaces the content as a step of undo. No effect if it is the same.
  void edit(const std::string &label, MeasurementSet set);
  /// In which texts and tables have lengths.
  void setUnits(const DisplayUnits &units) { length_ = displayUnit(units, "mm"); }
  [[nodiscard]] const DisplayUnit &length() const { return length_; }
  /// Replaces the content without a step of undo, which also ends those of before.
  void assign(MeasurementSet set);

  /// Present positions by name, at a time of the simulation. A time before the last one discards the past after it.
  void addPositions(const std::map<std::string, Vec3> &positions_mm, double time_s);
  /// Position of a point until the next ones are known.
  void placeNow(const std::string &name, const Vec3 &at_mm) { positions_[name] = at_mm; }
  /// Nothing has moved; there is no past.
  void forgetPositions();
  [[nodiscard]] Vec3 positionOf(const MeasuredPoint &point) const;
  /// Whether any point is elsewhere than at rest, by more than a thousandth of a millimetre.
  [[nodiscard]] bool hasMoved() const;

  [[nodiscard]] std::vector<MeasurementRow> rows() const;
  [[nodiscard]] std::optional<MeasurementRow> row(const std::string &name) const;
  [[nodiscard]] std::optional<TargetErrors> targetErrors() const;
  /// Value of a row over time: mm or degrees; of a landmark its displacement.
  [[nodiscard]] std::vector<CurvePoint2> curve(const std::string &name) const;
  /// Number of kept times. At the limit every second one is dropped, and later ones are kept at this larger interval.
  [[nodiscard]] std::size_t sampleCount() const { return samples_.size(); }
  static constexpr std::size_t kMostSamples = 2000;
  /// Of the last kept time; none: there is no past.
  [[nodiscard]] std::optional<double> lastTime_s() const {
    return samples_.empty() ? std::nullopt : std::optional(samples_.back().time_s);
  }

  /// Grows with every addPositions(). Static solutions have several at one time.
  [[nodiscard]] std::uint64_t positionsRevision() const { return positionsRevision_; }

  /// CSV of the table, and of all curves: a column each, the first is the time.
  [[nodiscard]] std::string tableCsv() const;
  [[nodiscard]] std::string curvesCsv() const;

  std::string selected;  ///< name of the selected row; empty: none

 private:
  struct Sample {
    double time_s;
    std::map<std::string, Vec3> at_mm;
  };
  struct Step;
  [[nodiscard]] std::optional<double> valueOf(const std::string &name, const std::map<std::string, Vec3> *at_mm) const;
  [[nodiscard]] MeasurementRow rowOf(const std::string &name, MeasureKind kind, bool isHidden) const;
  void show(const MeasurementSet &set, std::uint64_t revision);

  registry::EditList *edits_;
  DisplayUnit length_{"mm", 1.0};
  MeasurementSet set_;
  std::uint64_t revision_ = 0, lastRevision_ = 0, positionsRevision_ = 0;
  std::map<std::string, Vec3> positions_;
  std::deque<Sample> samples_;
  double interval_s_ = 0.0;  ///< of kept times, at least
};

}  // namespace c3de::ui
