// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

namespace c3de::session {

/// What `--view` chooses.
enum class PictureView { space, axial, sagittal, coronal, four };
[[nodiscard]] const char *nameOf(PictureView view);  ///< as on the command line: "3d", "axial", …, "four-up"
[[nodiscard]] std::optional<PictureView> pictureViewOf(const std::string &name);

}  // namespace c3de::session
