// SPDX-License-Identifier: Apache-2.0
// Images and label maps.
#pragma once

#include <array>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "c3de/sdk/guard.hpp"
#include "c3de/sdk/services/service.hpp"
#include "c3de/sdk/view.hpp"

namespace c3de::sdk {

/// Images and label maps of the workstation, to be read. Any thread.
class Imaging : public Service<c3de_imaging_v1> {
 public:
  using Service::Service;

  struct Label {
    std::uint32_t value = 0;
    std::string name;
    std::array<float, 3> colour{};  ///< linear RGB
  };

  Result<std::vector<c3de_handle>> images() const { return handles<&c3de_imaging_v1::images>(); }
  Result<c3de_image_info> imageInfo(c3de_handle image) const {
    c3de_image_info out{};
    out.size = sizeof out;
    if (auto done = call<&c3de_imaging_v1::image_info>(image, &out); !done) return done.failure();
    return out;
  }
  /// Values at points of the world, mm; `outside` where there are no voxels.
  Result<void> sample(c3de_handle image, std::span<const Vec3> points_mm, std::span<double> out,
                      double outside = std::numeric_limits<double>::quiet_NaN()) const {
    return call<&c3de_imaging_v1::sample>(image, rows<double, 3>(points_mm), outside, mutableRows<double, 1>(out));
  }

  Result<std::vector<c3de_handle>> labelMaps() const { return handles<&c3de_imaging_v1::label_maps>(); }
  Result<c3de_label_map_info> labelMapInfo(c3de_handle map) const {
    c3de_label_map_info out{};
    out.size = sizeof out;
    if (auto done = call<&c3de_imaging_v1::label_map_info>(map, &out); !done) return done.failure();
    return out;
  }
  Result<void> labelsAt(c3de_handle map, std::span<const Vec3> points_mm, std::span<std::uint32_t> out) const {
    return call<&c3de_imaging_v1::labels_at>(map, rows<double, 3>(points_mm), mutableRows<std::uint32_t, 1>(out));
  }
  Result<std::vector<Label>> labels(c3de_handle map) const {
    std::vector<Label> out;
    const auto each = [](void *self, const c3de_label *label) noexcept -> c3de_status {
      return guard([&] {
        static_cast<std::vector<Label> *>(self)->push_back(
            {label->value, std::string(text(label->name)), {label->colour[0], label->colour[1], label->colour[2]}});
      });
    };
    if (auto done = call<&c3de_imaging_v1::enum_labels>(map, static_cast<void *>(&out), +each); !done)
      return done.failure();
    return out;
  }

 private:
  template <auto Slot>
  Result<std::vector<c3de_handle>> handles() const {
    // Again while others add some between the question and the answer.
    std::vector<c3de_handle> out;
    std::uint64_t needed = 0;
    do {
      out.resize(static_cast<std::size_t>(needed));
      if (auto done = call<Slot>(out.data(), static_cast<std::uint64_t>(out.size()), &needed); !done)
        return done.failure();
    } while (needed > out.size());
    out.resize(static_cast<std::size_t>(needed));
    return out;
  }
};

}  // namespace c3de::sdk
