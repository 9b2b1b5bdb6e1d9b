// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/keyframes.h"

#include <algorithm>
#include <utility>

namespace c3de::session {

void Keyframes::add(std::shared_ptr<Keyframe> keyframe) {
  if (keyframe->state.size() > limitBytes_) return;
  const std::uint64_t made = keyframe->at.made;
  auto at = std::lower_bound(all_.begin(), all_.end(), made,
                             [](const auto &one, std::uint64_t m) { return one->at.made < m; });
  bytes_ += keyframe->state.size();
  if (at != all_.end() && (*at)->at.made == made) {
    bytes_ -= (*at)->state.size();
    *at = std::move(keyframe);
  } else {
    all_.insert(at, std::move(keyframe));
  }
  while (bytes_ > limitBytes_) thinOut();
}

void Keyframes::thinOut() {
  std::size_t removed = all_.size() - 1;
  std::uint64_t smallest = UINT64_MAX;
  // The last one stays: a replay that continues adds after it.
  for (std::size_t i = 0; i + 1 < all_.size(); ++i) {
    const std::uint64_t before = i == 0 ? 0 : all_[i - 1]->at.made, gap = all_[i + 1]->at.made - before;
    if (gap >= smallest) continue;
    smallest = gap;
    removed = i;
  }
  bytes_ -= all_[removed]->state.size();
  all_.erase(all_.begin() + static_cast<std::ptrdiff_t>(removed));
}

std::shared_ptr<const Keyframe> Keyframes::lastUpTo(std::uint64_t made,
                                                    const std::function<bool(const Keyframe &)> &accepts) const {
  for (auto one = all_.rbegin(); one != all_.rend(); ++one)
    if ((*one)->at.made <= made && accepts(**one)) return *one;
  return nullptr;
}

void Keyframes::removeIf(const std::function<bool(const Keyframe &)> &isRemoved) {
  std::erase_if(all_, [&](const auto &one) {
    if (!isRemoved(*one)) return false;
    bytes_ -= one->state.size();
    return true;
  });
}

void Keyframes::verify(std::uint64_t after, std::uint64_t upTo) {
  for (const auto &one : all_)
    if (one->at.made > after && one->at.made <= upTo) one->isVerified = true;
}

}  // namespace c3de::session
