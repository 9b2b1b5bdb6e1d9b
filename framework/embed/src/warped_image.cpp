// SPDX-License-Identifier: Apache-2.0
#include "warped_image.h"

#include <fmt/format.h>

#include <algorithm>

#include "c3de/imaging/writing.h"
#include "c3de/session/export_image.h"

namespace c3de::embed {
namespace {

/// Row-major, to RAS.
void writeAffine(const Mat4 &indexToWorld, double (&affine)[16]) {
  for (std::size_t row = 0; row < 4; ++row)
    for (std::size_t column = 0; column < 4; ++column) {
      const double lps = indexToWorld[row + 4 * column];
      affine[4 * row + column] = row < 2 && lps != 0.0 ? -lps : lps;
    }
}

template <class T>
c3de_embed_voxels voxelsOf(const imaging::VolumeGeometry &geometry, const std::vector<T> &voxels, std::uint32_t type) {
  c3de_embed_voxels out{};
  out.size = sizeof out;
  out.type = type;
  out.data = voxels.data();
  std::int64_t stride = sizeof(T);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    out.shape[axis] = geometry.size[axis];
    out.strides[axis] = stride;
    stride *= static_cast<std::int64_t>(geometry.size[axis]);
  }
  writeAffine(geometry.indexToWorld, out.affine);
  out.slope = 1.0;
  out.unit = "";
  out.layers = 1;
  return out;
}

static_assert(std::variant_size_v<imaging::Voxels> == C3DE_EMBED_VOXEL_F64);

}  // namespace

std::uint64_t WarpedImage::layerCount() const {
  const auto *layers = std::get_if<Layers>(&content_);
  return layers != nullptr ? layers->size() : 1;
}

Result<void> WarpedImage::checkLayer(std::uint64_t layer) const {
  if (layer < layerCount()) return {};
  return refuse(C3DE_E_NOT_FOUND, fmt::format("layer {}: accepted: below {}", layer, layerCount()));
}

Result<c3de_embed_voxels> WarpedImage::voxels(std::uint64_t layer) const {
  if (auto good = checkLayer(layer); !good) return tl::unexpected(good.error());
  if (const auto *image = std::get_if<imaging::Volume>(&content_)) {
    const auto type = static_cast<std::uint32_t>(image->voxels.index()) + C3DE_EMBED_VOXEL_I8;
    c3de_embed_voxels out =
        std::visit([&](const auto &voxels) { return voxelsOf(image->geometry, voxels, type); }, image->voxels);
    out.slope = image->slope;
    out.intercept = image->intercept;
    out.unit = image->unit.c_str();
    return out;
  }
  const Layers &layers = std::get<Layers>(content_);
  const imaging::LabelMap &map = layers[layer];
  c3de_embed_voxels out = voxelsOf(map.geometry, map.voxels, C3DE_EMBED_VOXEL_U16);
  out.layers = layers.size();
  out.labels = map.labels.size();
  return out;
}

Result<c3de_embed_label> WarpedImage::label(std::uint64_t layer, std::uint64_t index) const {
  if (auto good = checkLayer(layer); !good) return tl::unexpected(good.error());
  const auto *layers = std::get_if<Layers>(&content_);
  const std::size_t count = layers != nullptr ? (*layers)[layer].labels.size() : 0;
  if (index >= count)
    return refuse(C3DE_E_NOT_FOUND, count == 0 ? std::string("the image has no labels")
                                               : fmt::format("label {}: accepted: below {}", index, count));
  const imaging::LabelMap::Label &label = (*layers)[layer].labels[index];
  c3de_embed_label out{};
  out.size = sizeof out;
  out.value = label.value;
  out.name = label.name.c_str();
  std::copy(label.colour.begin(), label.colour.end(), out.colour);
  return out;
}

Result<void> WarpedImage::save(const std::filesystem::path &file) const {
  const auto checked = session::checkImageFile(file);
  if (!checked) return refuse(checked.error());
  if (const auto *image = std::get_if<imaging::Volume>(&content_)) {
    if (const auto written = imaging::writeVolume(file, *image); !written) return refuse(written.error());
    return {};
  }
  const Layers &layers = std::get<Layers>(content_);
  const std::vector<std::filesystem::path> files = session::labelFiles(file, layers.size());
  for (std::size_t layer = 0; layer < layers.size(); ++layer)
    if (const auto written = imaging::writeLabelMap(files[layer], layers[layer]); !written)
      return refuse(written.error());
  return {};
}

}  // namespace c3de::embed
