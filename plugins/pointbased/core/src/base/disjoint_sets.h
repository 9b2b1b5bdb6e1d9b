// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numeric>

#include "pointbased/types.h"

namespace pointbased {

/// Union-find; the smallest member represents its set.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t n) : parents_(n) { std::iota(parents_.begin(), parents_.end(), Index{0}); }
  [[nodiscard]] Index find(Index i) {
    while (parents_[i] != i) i = parents_[i] = parents_[parents_[i]];
    return i;
  }
  /// @return whether the two sets were distinct
  bool join(Index a, Index b) {
    a = find(a);
    b = find(b);
    if (a == b) return false;
    if (b < a) std::swap(a, b);
    parents_[b] = a;
    return true;
  }

 private:
  std::vector<Index> parents_;
};

}  // namespace pointbased
