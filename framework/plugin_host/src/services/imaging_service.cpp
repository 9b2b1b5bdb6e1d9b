// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "arguments.h"
#include "c3de/imaging/sampling.h"
#include "c3de/scene/image_store.h"
#include "services/services.h"

namespace c3de::plugin_host {
namespace {

std::shared_ptr<const scene::StoredImage> findImage(PluginContext &plugin, c3de_handle image) {
  auto found = plugin.services().images->image(handleOf(image));
  if (!found) throw Refusal(C3DE_E_STALE, fmt::format("there is no image of handle {}", textOf(image)));
  return found;
}

std::shared_ptr<const scene::StoredLabels> findLabels(PluginContext &plugin, c3de_handle map) {
  auto found = plugin.services().images->labels(handleOf(map));
  if (!found) throw Refusal(C3DE_E_STALE, fmt::format("there is no label map of handle {}", textOf(map)));
  return found;
}

c3de_status writeHandles(const std::vector<Handle> &all, c3de_handle *out, std::uint64_t capacity,
                         std::uint64_t *needed) {
  requireNonNull(needed, "needed");
  if (capacity > 0) requireNonNull(out, "out");
  *needed = all.size();
  const auto n = static_cast<std::size_t>(std::min<std::uint64_t>(all.size(), capacity));
  for (std::size_t i = 0; i < n; ++i) writeHandle(out + i, all[i]);
  return n < all.size() ? C3DE_S_TRUNCATED : C3DE_OK;
}

template <class Info>
void describe(const imaging::VolumeGeometry &geometry, Info &info) {
  for (std::size_t a = 0; a < 3; ++a) info.points[a] = geometry.size[a];
  for (std::size_t n = 0; n < 16; ++n) info.world_from_index[n] = geometry.indexToWorld[n];
}

c3de_status C3DE_CALL images(void *ctx, c3de_handle *out, std::uint64_t capacity, std::uint64_t *needed) noexcept {
  return serve(ctx, "imaging.images", [&](PluginContext &plugin) {
    return writeHandles(plugin.services().images->allImages(), out, capacity, needed);
  });
}

c3de_status C3DE_CALL imageInfo(void *ctx, c3de_handle image, c3de_image_info *out) noexcept {
  return serve(ctx, "imaging.image_info", [&](PluginContext &plugin) {
    const auto stored = findImage(plugin, image);
    c3de_image_info info{};
    info.name = plugin.internedText(stored->name);
    info.unit = plugin.internedText(stored->volume.unit);
    describe(stored->volume.geometry, info);
    info.min = stored->range.min;
    info.max = stored->range.max;
    info.low = stored->range.low;
    info.high = stored->range.high;
    writeStruct(out, info, "out");
  });
}

c3de_status C3DE_CALL sample(void *ctx, c3de_handle image, c3de_view points, double outside, c3de_mview out) noexcept {
  return serve(ctx, "imaging.sample", [&](PluginContext &plugin) {
    const auto stored = findImage(plugin, image);
    const PointRows in(points, "points_mm");
    const std::span<const Vec3> all = in.rows();
    const RowLayout rows = outputLayoutOf(out, "out", points);
    auto *bytes = static_cast<unsigned char *>(out.data);
    // Through a buffer, because rows of the plugin need be neither contiguous nor aligned.
    std::array<double, 512> values;
    for (std::size_t first = 0; first < all.size(); first += values.size()) {
      const std::size_t n = std::min(values.size(), all.size() - first);
      imaging::sampleLinear(stored->volume, all.subspan(first, n), outside, std::span(values).first(n));
      for (std::size_t i = 0; i < n; ++i) std::memcpy(bytes + (first + i) * rows.stride, &values[i], sizeof values[i]);
    }
  });
}

c3de_status C3DE_CALL labelMaps(void *ctx, c3de_handle *out, std::uint64_t capacity, std::uint64_t *needed) noexcept {
  return serve(ctx, "imaging.label_maps", [&](PluginContext &plugin) {
    return writeHandles(plugin.services().images->allLabels(), out, capacity, needed);
  });
}

c3de_status C3DE_CALL labelMapInfo(void *ctx, c3de_handle map, c3de_label_map_info *out) noexcept {
  return serve(ctx, "imaging.label_map_info", [&](PluginContext &plugin) {
    const auto stored = findLabels(plugin, map);
    c3de_label_map_info info{};
    info.name = plugin.internedText(stored->name);
    describe(stored->map.geometry, info);
    info.labels = stored->map.labels.size();
    writeStruct(out, info, "out");
  });
}

c3de_status C3DE_CALL labelsAt(void *ctx, c3de_handle map, c3de_view points, c3de_mview out) noexcept {
  return serve(ctx, "imaging.labels_at", [&](PluginContext &plugin) {
    const auto stored = findLabels(plugin, map);
    const PointRows in(points, "points_mm");
    const RowLayout rows = outputLayoutOf(out, "out", points, C3DE_U32);
    auto *bytes = static_cast<unsigned char *>(out.data);
    for (std::size_t i = 0; i < in.rows().size(); ++i) {
      const std::uint32_t label = stored->at(in.rows()[i]);
      std::memcpy(bytes + i * rows.stride, &label, sizeof label);
    }
  });
}

c3de_status C3DE_CALL enumLabels(void *ctx, c3de_handle map, void *self,
                                 c3de_status(C3DE_CALL *each)(void *self, const c3de_label *label)) noexcept {
  return serve(ctx, "imaging.enum_labels", [&](PluginContext &plugin) -> c3de_status {
    const auto stored = findLabels(plugin, map);
    requireNonNull(each, "each");
    for (const imaging::LabelMap::Label &label : stored->map.labels) {
      const c3de_label out{sizeof(c3de_label),
                           label.value,
                           {label.name.data(), label.name.size()},
                           {label.colour[0], label.colour[1], label.colour[2]},
                           0};
      if (const c3de_status status = each(self, &out); status != C3DE_OK) return status;
    }
    return C3DE_OK;
  });
}

}  // namespace

c3de_imaging_v1 makeImagingTable(PluginContext *plugin) {
  return {sizeof(c3de_imaging_v1), kServiceRevision, plugin,     &images, &imageInfo, &sample, &labelMaps,
          &labelMapInfo,           &labelsAt,        &enumLabels};
}

}  // namespace c3de::plugin_host
