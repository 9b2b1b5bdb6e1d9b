// SPDX-License-Identifier: Apache-2.0
#include "logic/scroll_anchor.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace c3de::ui {

double ScrollAnchor::begin(double top, double visible, std::optional<double> mouse) {
  before_ = std::exchange(now_, {});
  start_ = top + room_;
  visible_ = visible;
  shift_ = known_ = 0.0;
  isHeld_ = mouse.has_value();
  isWaiting_ = false;
  for (const auto &[key, y] : before_) {
    if (!mouse || y > *mouse - drawnStart_) continue;
    kept_ = isWaiting_ ? std::max(kept_, y) : y;
    isWaiting_ = true;
  }
  return room_;
}

double ScrollAnchor::row(const std::string &key, double y) {
  y -= start_ + shift_;
  if (!now_.emplace(key, y).second || !isWaiting_) return 0.0;
  const auto before = before_.find(key);
  // If more than a panel height has been skipped before this row, it was moved elsewhere and does not indicate where
  // the others are now.
  if (before == before_.end() || before->second - known_ > visible_) return 0.0;
  known_ = before->second;
  // The first remaining row at or below the one under the mouse.
  if (known_ < kept_) return 0.0;
  isWaiting_ = false;
  return shift_ = std::round(known_ - y);
}

std::optional<double> ScrollAnchor::edge() const { return isWaiting_ ? std::optional(start_ + kept_) : std::nullopt; }

double ScrollAnchor::end(double scroll) {
  isWaiting_ = false;
  drawnStart_ = start_ + shift_;
  const double wanted = scroll - room_ - shift_;
  const double room = isHeld_ ? std::max(-wanted, 0.0) : 0.0;
  isSettling_ = shift_ != 0.0 || room != room_;
  room_ = room;
  return std::max(wanted, 0.0);
}

}  // namespace c3de::ui
