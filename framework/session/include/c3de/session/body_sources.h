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

#include "c3de/abi/iface/simulator.h"
#include "c3de/core/expected.h"
#include "c3de/core/progress.h"
#include "c3de/geometry/mesh_io.h"
#include "c3de/imaging/masks.h"
#include "c3de/imaging/reading.h"
#include "c3de/scene/scene_file.h"
#include "c3de/session/coverage.h"
#include "c3de/session/preparation.h"
#include "c3de/session/tissue_voxels.h"

namespace c3de::session {

/// The geometry of a body as passed to a simulator: its skin, and the part of an image that it fills.
struct BodyGeometry {
  geometry::LoadedMesh skin;
  imaging::Fill fill;                          ///< empty for a mesh
  double volume_mm3 = 0.0;                     ///< voxel count times voxel volume; 0 for a mesh
  Coverage coverage;                           ///< of the mask; empty for a mesh
  std::optional<std::array<float, 3>> colour;  ///< linear RGB of its label; none if it does not come from a label
  Preparation took;                            ///< time spent on its preparation
  /// For a body of many tissues: the fill of each tissue that has a part, in the order of SceneVolume::tissues. Null: a
  /// tissue that was only found by its name has no voxels left.
  std::vector<std::shared_ptr<const imaging::Fill>> tissues;
  std::shared_ptr<TissueVoxels> places;        ///< of a body of many tissues
  std::vector<double> thickness_mm;            ///< thicknessOf() such a body, in the order of SceneVolume::tissues
  std::shared_ptr<const imaging::Fill> rigid;  ///< of the rigid tissues; null: there are none
};

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
  /// Logs the result of popNotices() as warnings about a file, and stores it for said().
  void reportNotices(const std::filesystem::path &file);
  /// Everything that was reported, each notice once, prefixed with the name of its file.
  [[nodiscard]] const std::vector<std::string> &said() const { return said_; }

 private:
  /// One series of a file at one time point
  using File = std::tuple<std::filesystem::path, std::string, std::size_t>;
  std::map<File, std::shared_ptr<const Layers>> labels_;
  std::map<File, std::shared_ptr<const imaging::Volume>> volumes_;
  std::vector<std::string> notices_, said_;
};

/// The geometry of a mask without its specks. Errors are those of surface and fill.
/// @param edge_mm   edge length of the triangles of the skin; 0: automatic
/// @param points    approximate minimum number of points; voxels are averaged down to a sixteenth of the point spacing
/// @param isOfTissues  addTissues() follows
[[nodiscard]] Expected<BodyGeometry> bodyGeometryOf(const imaging::Mask &mask, double edge_mm, double points,
                                                    bool isOfTissues, const ProgressFn &progress);

/// Adds the fills of its tissues to a geometry.
/// @param points  as in bodyGeometryOf()
/// Errors: a tissue that the scene names has no voxel.
[[nodiscard]] Expected<void> addTissues(const scene::SceneVolume &volume, const imaging::LabelMap &tissues,
                                        double points, BodyGeometry &geometry);

/// Error in a file or value that a scene names, prefixed with its location in the scene. A value that cannot be used is
/// then an input error, not a usage error.
[[nodiscard]] tl::unexpected<Error> failInScene(const Error &error, const scene::SceneFile &scene, int line);

/// The grid of a fill in metres, for a simulator.
[[nodiscard]] c3de_sim_grid toAbi(const imaging::VolumeGeometry &grid);

}  // namespace c3de::session
