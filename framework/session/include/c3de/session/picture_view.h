// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

namespace c3de::session {

/// What `--view` chooses.
enum class PictureView { space, axial, sagittal, coronal, four };
[[nodiscard]] const char *nameOf(PictureView view);  ///< as on the command line: "3d", "axial", …, "four-up"
[[nodiscard]] std::optional<PictureView> pictureViewOf(const std::string &name);

/// What `--overlay` lays over the slices in colours.
struct PictureOverlay {
  enum class Kind { none, displacement, volumeChange, field };
  Kind kind = Kind::displacement;
  std::string field;  ///< name of a PointField
  friend bool operator==(const PictureOverlay &, const PictureOverlay &) = default;
};
/// "none", "displacement", "volume_change", else a field of the simulator.
[[nodiscard]] PictureOverlay pictureOverlayOf(const std::string &name);

}  // namespace c3de::session
