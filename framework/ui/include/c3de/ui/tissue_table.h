// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace c3de::ui {

/// Motion of one label of a body of many tissues.
struct TissueRow {
  std::string label;                           ///< name; "background" for the background
  std::string tissue;                          ///< assigned tissue
  std::optional<std::array<float, 3>> colour;  ///< of its label, sRGB
  bool isRigid = false;
  double reference_ml = 0.0;
  struct Motion {
    double volume_ml = 0.0, mean_mm = 0.0, largest_mm = 0.0, leastRatio = 1.0;  ///< leastRatio: smallest det F
  };
  std::optional<Motion> motion;  ///< none: unknown, or not computed yet

  [[nodiscard]] std::string volumeText() const;
  [[nodiscard]] std::string changeText() const;  ///< of the volume, %
  [[nodiscard]] std::string meanText() const;
  [[nodiscard]] std::string largestText() const;
  [[nodiscard]] std::string ratioText() const;
};

/// The labels of the present simulation. The window draws it, and reports whether it is visible.
struct TissueTable {
  std::vector<TissueRow> rows;  ///< empty: no table is shown
  bool isShown = false;         ///< drawn in the last frame
};

/// Sort order: the largest number first. For a change its magnitude counts; for det F the smallest comes first.
enum class TissueOrder { labels, volume, change, mean, largest, leastRatio };

/// Rows whose label or tissue contains every word of the filter. Rows without data come last.
[[nodiscard]] std::vector<std::size_t> listedRows(const TissueTable &table, const std::string &filter,
                                                  TissueOrder order = TissueOrder::labels);

}  // namespace c3de::ui
