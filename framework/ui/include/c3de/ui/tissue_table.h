// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace c3de::ui {

/// What a label of a body of many tissues has done.
struct TissueRow {
  std::string label;                           ///< name; of the background "background"
  std::string tissue;                          ///< what it is taken for
  std::optional<std::array<float, 3>> colour;  ///< of its label, sRGB
  bool isRigid = false;
  double reference_ml = 0.0;
  struct Motion {
    double volume_ml = 0.0, mean_mm = 0.0, largest_mm = 0.0, leastRatio = 1.0;  ///< leastRatio: smallest det F
  };
  std::optional<Motion> motion;  ///< none: not known, or not yet

  [[nodiscard]] std::string volumeText() const;
  [[nodiscard]] std::string changeText() const;  ///< of the volume, %
  [[nodiscard]] std::string meanText() const;
  [[nodiscard]] std::string largestText() const;
  [[nodiscard]] std::string ratioText() const;
};

/// The labels of the present simulation. The window draws it, and says whether anybody looks.
struct TissueTable {
  std::vector<TissueRow> rows;  ///< none: no table is shown
  bool isShown = false;         ///< in the last frame
};

/// What comes first: the largest number, of a change whatever its sign, of det F the smallest.
enum class TissueOrder { labels, volume, change, mean, largest, leastRatio };

/// Rows whose label or tissue has every word of the filter in it. Those of which nothing is known come last.
[[nodiscard]] std::vector<std::size_t> listedRows(const TissueTable &table, const std::string &filter,
                                                  TissueOrder order = TissueOrder::labels);

}  // namespace c3de::ui
