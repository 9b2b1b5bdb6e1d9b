// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>

#include "formats/image_header.h"

namespace c3de::imaging {

struct LabelName {
  std::string name;
  bool coloured = false;
  std::array<float, 3> colour{};  ///< linear RGB
};
/// By the number in the file, which may exceed the range of LabelMap.
using LabelTable = std::map<std::uint64_t, LabelName>;

/// Lines of `number name …` (MRIcron), ITK-SNAP's label description, or Slicer's and FreeSurfer's `number name r g b
/// a`.
[[nodiscard]] LabelTable readLabelTable(const std::filesystem::path &path);
/// The table next to an image, and its file; empty if there is none.
[[nodiscard]] std::pair<LabelTable, std::filesystem::path> sidecarTable(const std::filesystem::path &image);
/// Slicer's segments: Segment0_LabelValue, Segment0_Name, Segment0_Color, Segment0_Layer; one table for each layer.
/// Files of Slicer before 5 have neither value nor layer: segment n is label 1 of layer n.
[[nodiscard]] std::vector<LabelTable> segmentsOf(const std::vector<std::pair<std::string, std::string>> &keys,
                                                 std::size_t layers);

/// The label table in the XML that Caret and Connectome Workbench store in NIfTI: Label elements with Key, Red, Green,
/// Blue.
[[nodiscard]] LabelTable caretLabelsOf(const std::string &xml);

[[nodiscard]] float linearOf(double srgb);  ///< both 0 … 1
[[nodiscard]] double srgbOf(float linear);

}  // namespace c3de::imaging
