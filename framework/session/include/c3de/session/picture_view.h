// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

namespace c3de::session {

/// The choices of `--view`.
enum class PictureView { space, axial, sagittal, coronal, four };
[[nodiscard]] const char *nameOf(PictureView view);  ///< as on the command line: "3d", "axial", …, "four-up"
[[nodiscard]] std::optional<PictureView> pictureViewOf(const std::string &name);

/// Where the 3D view is seen from. What is not given is that of the window at its beginning.
struct PictureCamera {
  std::optional<double> azimuth_deg;    ///< about the up axis; 0: from +z (y up) or -y (z up); 90: from +x
  std::optional<double> elevation_deg;  ///< above the plane to which the up axis is perpendicular, -90 ... 90
  std::optional<bool> isZUp;            ///< the up axis is z, otherwise y; default: z beside slices
};

/// The colour overlay on slices that `--overlay` selects.
struct PictureOverlay {
  enum class Kind { none, displacement, volumeChange, field };
  Kind kind = Kind::displacement;
  std::string field;  ///< name of a PointField
  friend bool operator==(const PictureOverlay &, const PictureOverlay &) = default;
};
/// "none", "displacement", "volume_change", otherwise a field of the simulator.
[[nodiscard]] PictureOverlay pictureOverlayOf(const std::string &name);

}  // namespace c3de::session
