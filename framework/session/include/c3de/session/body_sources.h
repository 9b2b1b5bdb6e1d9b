// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/progress.h"
#include "c3de/imaging/masks.h"
#include "c3de/imaging/reading.h"
#include "c3de/scene/scene_file.h"
#include "c3de/session/preparation.h"
#include "c3de/session/tissue_voxels.h"

namespace c3de::session {

/// The part of an image that becomes a body.
struct PickedVoxels {
  imaging::Mask mask;
  std::optional<std::array<float, 3>> colour;        ///< linear RGB of its label; none if it does not come from a label
  std::shared_ptr<const imaging::LabelMap> tissues;  ///< pickTissues() of its voxels; null: one tissue
};

/// Images and label maps that the bodies of a scene are built from. Each file is read once. One thread at a time.
class BodySources {
 public:
  /// Picks the voxels that the scene requests. Errors name the file, the label and the available labels.
  /// @param took  the time for reading and masks is added
  [[nodiscard]] Expected<PickedVoxels> pick(const scene::SceneVolume &volume, const ProgressFn &progress,
                                            Preparation &took);
  /// Where the labels of a body of many tissues are located.
  [[nodiscard]] Expected<TissueVoxels> placesOf(const scene::SceneBody &body, const PickedVoxels &picked);
  using Layers = std::vector<imaging::LabelMap>;
  /// An image, or the layers of a label map as a whole, at the time point of the options. Errors are those of the
  /// readers.
  [[nodiscard]] Expected<std::shared_ptr<const Layers>> labels(const std::filesystem::path &file,
                                                               const imaging::ReadOptions &options);
  [[nodiscard]] Expected<std::shared_ptr<const imaging::Volume>> volume(const std::filesystem::path &file,
                                                                        const imaging::ReadOptions &options);
  /// The layers that contain the labels of a body's tissues.
  [[nodiscard]] Expected<std::shared_ptr<const Layers>> layersOf(const scene::SceneVolume &volume,
                                                                 const ProgressFn &progress);
  /// Notices of the readers and others since the last call.
  [[nodiscard]] std::vector<std::string> popNotices();
  void addNotice(std::string sentence) { notices_.push_back(std::move(sentence)); }
  /// Logs the result of popNotices() as warnings about a file, and stores it for reportedNotices().
  void reportNotices(const std::filesystem::path &file);
  /// Everything that was reported, each notice once, prefixed with the name of its file.
  [[nodiscard]] const std::vector<std::string> &reportedNotices() const { return reportedNotices_; }

 private:
  /// One series of a file at one time point
  using File = std::tuple<std::filesystem::path, std::string, std::size_t>;
  std::map<File, std::shared_ptr<const Layers>> labels_;
  std::map<File, std::shared_ptr<const imaging::Volume>> volumes_;
  std::vector<std::string> notices_, reportedNotices_;
};

/// Error in a file or value that a scene names, prefixed with its location in the scene. A value that cannot be used is
/// then an input error, not a usage error.
[[nodiscard]] tl::unexpected<Error> failInScene(const Error &error, const scene::SceneFile &scene, int line);

}  // namespace c3de::session
