// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/tissue_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "logic/label_list.h"

namespace c3de::ui {
namespace {

const std::string kUnknown = "–";

/// Without the sign of a zero.
std::string rounded(double value, int digits) {
  const double least = 0.5 * std::pow(10.0, -digits);
  return fmt::format("{:.{}f}", std::abs(value) < least ? 0.0 : value, digits);
}

double rankOf(const TissueRow &row, TissueOrder order) {
  if (order == TissueOrder::volume) return row.motion ? row.motion->volume_ml : row.reference_ml;
  if (!row.motion) return -std::numeric_limits<double>::infinity();
  switch (order) {
    case TissueOrder::change: return std::abs(row.motion->volume_ml / std::max(row.reference_ml, 1e-9) - 1.0);
    case TissueOrder::mean: return row.motion->mean_mm;
    case TissueOrder::largest: return row.motion->largest_mm;
    case TissueOrder::leastRatio: return -row.motion->leastRatio;
    case TissueOrder::labels:
    case TissueOrder::volume: break;
  }
  return 0.0;
}

}  // namespace

std::string TissueRow::volumeText() const {
  const double ml = motion ? motion->volume_ml : reference_ml;
  return rounded(ml, ml < 100.0 ? 2 : ml < 1e4 ? 1 : 0);
}

std::string TissueRow::changeText() const {
  if (!motion || !(reference_ml > 0.0)) return kUnknown;
  return rounded(100.0 * (motion->volume_ml / reference_ml - 1.0), 1);
}

std::string TissueRow::meanText() const { return motion ? rounded(motion->mean_mm, 1) : kUnknown; }
std::string TissueRow::largestText() const { return motion ? rounded(motion->largest_mm, 1) : kUnknown; }
std::string TissueRow::ratioText() const { return motion ? rounded(motion->leastRatio, 2) : kUnknown; }

std::vector<std::size_t> listedRows(const TissueTable &table, const std::string &filter, TissueOrder order) {
  std::vector<std::size_t> listed;
  for (std::size_t i = 0; i < table.rows.size(); ++i)
    if (isListed(table.rows[i].label + " " + table.rows[i].tissue, filter)) listed.push_back(i);
  if (order != TissueOrder::labels)
    std::stable_sort(listed.begin(), listed.end(), [&](std::size_t a, std::size_t b) {
      return rankOf(table.rows[a], order) > rankOf(table.rows[b], order);
    });
  return listed;
}

}  // namespace c3de::ui
