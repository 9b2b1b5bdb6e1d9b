// SPDX-License-Identifier: Apache-2.0
// The upper abdomen of nobody: the shapes of tools/make_scan.cpp.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "c3de/core/vec.h"

namespace c3de::tools {

struct Tissue {
  double hounsfield = -1000.0;
  std::uint16_t label = 0;  ///< 0: without a label
};

struct NamedLabel {
  std::string name;    ///< as TotalSegmentator spells it
  Vec3 colour_sRgb{};  ///< 0 … 1
};

/// What is at a point, LPS mm from the middle of the piece.
[[nodiscard]] Tissue tissueAt(const Vec3 &p);
/// Label n is entry n - 1.
[[nodiscard]] const std::vector<NamedLabel> &abdomenLabels();

}  // namespace c3de::tools
