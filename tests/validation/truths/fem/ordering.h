// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model.h"

#include <vector>

namespace truth {

/// A part of the nested dissection: its own nodes are eliminated once its two halves are done.
struct Part {
  int first = -1, second = -1;  ///< halves (indices of parts), or -1 in a leaf
  int element = -1;             ///< of a leaf
  std::vector<int> nodes;       ///< eliminated here: those that both halves share and no parent part has eliminated
};

/// Nested dissection: elements are halved at the median of their centres along the longest side, down to single ones.
/// @return parts, halves before the whole; the last one is the root
std::vector<Part> dissect(const Model &model);

}  // namespace truth
