// SPDX-License-Identifier: Apache-2.0
#include "logic/row_anchor.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace c3de::ui {

double RowAnchor::begin(double top, double visible, std::optional<double> mouse) {
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

double RowAnchor::row(const std::string &key, double y) {
  y -= start_ + shift_;
  if (!now_.emplace(key, y).second || !isWaiting_) return 0.0;
  const auto before = before_.find(key);
  // A row that comes after more than a panel has been passed over was put elsewhere, and does not tell where the others
  // have gone.
  if (before == before_.end() || before->second - known_ > visible_) return 0.0;
  known_ = before->second;
  // The first one that is left of what was under the mouse and below it.
  if (known_ < kept_) return 0.0;
  isWaiting_ = false;
  return shift_ = std::round(known_ - y);
}

std::optional<double> RowAnchor::edge() const { return isWaiting_ ? std::optional(start_ + kept_) : std::nullopt; }

double RowAnchor::end(double scroll) {
  isWaiting_ = false;
  drawnStart_ = start_ + shift_;
  const double wanted = scroll - room_ - shift_;
  const double room = isHeld_ ? std::max(-wanted, 0.0) : 0.0;
  isSettling_ = shift_ != 0.0 || room != room_;
  room_ = room;
  return std::max(wanted, 0.0);
}

}  // namespace c3de::ui
