// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <variant>
#include <vector>

#include "c3de/embed.h"
#include "c3de/imaging/volume.h"
#include "result.h"

namespace c3de::embed {

/// A deformed image, or the layers of a deformed label map. Immutable; any thread.
class WarpedImage {
 public:
  using Layers = std::vector<imaging::LabelMap>;
  explicit WarpedImage(imaging::Volume image) : content_(std::move(image)) {}
  /// @pre  not empty
  explicit WarpedImage(Layers layers) : content_(std::move(layers)) {}

  /// C3DE_E_NOT_FOUND after the last layer, or label.
  [[nodiscard]] Result<c3de_embed_voxels> voxels(std::uint64_t layer) const;
  [[nodiscard]] Result<c3de_embed_label> label(std::uint64_t layer, std::uint64_t index) const;
  /// As c3de run --export-image, or --export-labels.
  [[nodiscard]] Result<void> save(const std::filesystem::path &file) const;

 private:
  [[nodiscard]] std::uint64_t layerCount() const;
  [[nodiscard]] Result<void> checkLayer(std::uint64_t layer) const;

  std::variant<imaging::Volume, Layers> content_;
};

}  // namespace c3de::embed
