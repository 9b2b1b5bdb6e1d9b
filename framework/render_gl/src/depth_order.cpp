// SPDX-License-Identifier: Apache-2.0
#include "depth_order.h"

#include <array>

namespace c3de::render {

void sortByKey(std::vector<DepthItem> &items, std::vector<DepthItem> &scratch) {
  constexpr unsigned kBits = 11, kBuckets = 1u << kBits, kPasses = 3;
  std::array<std::array<std::uint32_t, kBuckets>, kPasses> counts{};
  for (const DepthItem &item : items)
    for (unsigned pass = 0; pass < kPasses; ++pass) ++counts[pass][(item.key >> (pass * kBits)) & (kBuckets - 1)];

  scratch.resize(items.size());
  for (unsigned pass = 0; pass < kPasses; ++pass) {
    std::array<std::uint32_t, kBuckets> &start = counts[pass];
    std::uint32_t sum = 0;
    for (std::uint32_t &bucket : start) {
      const std::uint32_t n = bucket;
      bucket = sum;
      sum += n;
    }
    for (const DepthItem &item : items) scratch[start[(item.key >> (pass * kBits)) & (kBuckets - 1)]++] = item;
    items.swap(scratch);
  }
}

}  // namespace c3de::render
