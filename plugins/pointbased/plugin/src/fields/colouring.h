// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <string>

#include "base/view_settings.h"
#include "fields/colour_map.h"
#include "pointbased/error_estimate.h"
#include "pointbased/fields.h"
#include "report/verification.h"

namespace pointbased {

/// Meaning of the present colours.
struct ColourScale {
  ColourBy by = ColourBy::displacement;
  double low = 0.0, high = 1.0;  ///< in `unit`
  std::string title, unit, note;
};

/// Values of one body in the unit of the legend: mm, kPa or %.
struct BodyValues {
  std::vector<double> surfels, points;  ///< points: at the points shown by view.points; empty if nothing is shown
  double whole = 0.0;                   ///< of the whole body, %; error and stabilisation only
};

/// Reads values from a body with reused memory.
class ValueReader {
 public:
  /// @param given  values the body cannot provide: ColourBy::verified [surfels] m, contactPressure [phyxels] Pa;
  ///               empty if there are none
  void read(const Body &body, const ViewSettings &view, std::span<const double> given, const ParallelFor &parallelFor,
            BodyValues &out);

 private:
  std::vector<double> perPhyxel_;
  std::vector<Mat3> pointStresses_, phyxelStresses_;
  StressScratch stress_;
  ErrorScratch error_;
};

/// Upper end of an automatic range: a round number that is above 98 % of the values. It grows at once. It shrinks only
/// when the values have become much smaller, so that the legend remains steady.
class AutoRange {
 public:
  /// @param least  smallest meaningful range
  double update(std::vector<double> values, double least);
  void forget() { high_ = 0.0; }

 private:
  double high_ = 0.0;
};

/// 1, 1.5, 2, 2.5, 3, 4, 5, 6, 8 times a power of ten, not below x > 0.
[[nodiscard]] double roundedUp(double x);

/// The colours of all bodies of a simulation. Does nothing while they are coloured by material. Otherwise it uses at
/// most a fifth of the time: values too expensive for every snapshot are updated less often.
class Colouring {
 public:
  struct Colours {
    const RestState *rest = nullptr;  ///< to which the colours belong
    std::vector<Rgba8> surfels, points;
  };
  using Bodies = std::map<std::uint64_t, const Body *>;
  using Clock = std::chrono::steady_clock;

  /// True if the colours are those of the present state. Solver thread.
  bool update(const Bodies &bodies, const ViewSettings &view, const ParallelFor &parallelFor,
              Clock::time_point now = Clock::now());
  /// Data shown by ColourBy::verified; null if none.
  void setVerification(std::shared_ptr<const WorldVerification> verification);
  /// Source of the data shown by ColourBy::contactPressure, [phyxels] Pa of a body.
  void setPressures(std::function<void(std::uint64_t body, std::vector<double> &out)> pressures) {
    pressures_ = std::move(pressures);
  }
  /// Null: coloured by its material.
  [[nodiscard]] const Colours *of(std::uint64_t body) const;
  [[nodiscard]] const std::optional<ColourScale> &scale() const { return scale_; }
  /// Incremented by every update that has computed colours.
  [[nodiscard]] std::uint64_t generation() const { return generation_; }
  /// The next update recomputes everything.
  void forget();

 private:
  struct Entry {
    ValueReader reader;
    BodyValues values;
    Colours colours;
  };
  [[nodiscard]] bool isDue(const Bodies &bodies, const ViewSettings &view, Clock::time_point now) const;
  [[nodiscard]] ColourScale scaleOf(const Bodies &bodies, const ViewSettings &view);

  std::map<std::uint64_t, Entry> entries_;
  std::shared_ptr<const WorldVerification> verification_;
  std::function<void(std::uint64_t, std::vector<double> &)> pressures_;
  ViewSettings view_;
  std::optional<ColourScale> scale_;
  AutoRange range_;
  std::uint64_t generation_ = 0;
  Clock::time_point updated_{};
  Clock::duration cost_{};
};

}  // namespace pointbased
