// SPDX-License-Identifier: Apache-2.0
#include "c3de/study/pareto.h"

#include <algorithm>

namespace c3de::study {

std::vector<bool> paretoFront(std::span<const Tradeoff> points, double floor) {
  std::vector<bool> front;
  for (const Tradeoff &point : points)
    front.push_back(std::none_of(points.begin(), points.end(), [&](const Tradeoff &other) {
      return std::max(other.error, floor) <= std::max(point.error, floor) && other.dearest < point.cheapest;
    }));
  return front;
}

}  // namespace c3de::study
