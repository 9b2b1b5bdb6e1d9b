// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

namespace c3de::session {

/// The choices of `--view`.
enum class PictureView { space, axial, sagittal, coronal, four };
[[nodiscard]] const char *nameOf(PictureView view);  ///< as on the command line: "3d", "axial", …, "four-up"
[[nodiscard]] std::optional<PictureView> pictureViewOf(const std::string &name);

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
