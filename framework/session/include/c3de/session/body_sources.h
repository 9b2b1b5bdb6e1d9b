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
#include "c3de/session/tissue_places.h"

namespace c3de::session {

/// The shape of a body as a simulator takes it: its skin, and what of an image it fills.
struct BodyGeometry {
  geometry::LoadedMesh skin;
  imaging::Fill fill;                          ///< of a mesh: empty
  double volume_mm3 = 0.0;                     ///< voxel count times voxel volume; of a mesh: 0
  Coverage coverage;                           ///< of the mask; of a mesh: nothing
  std::optional<std::array<float, 3>> colour;  ///< linear RGB of its label; none: it is of no label
  Preparation took;                            ///< what was done for it
  /// Of a body of many tissues: of each that has a part, in the order of SceneVolume::tissues; null: nothing is left of
  /// one that only its name has brought
  std::vector<std::shared_ptr<const imaging::Fill>> tissues;
  std::shared_ptr<TissuePlaces> places;        ///< of such a body
  std::vector<double> thickness_mm;            ///< thicknessOf() such a body, in the order of SceneVolume::tissues
  std::shared_ptr<const imaging::Fill> rigid;  ///< of those that are; null: none is
};

/// What of an image is to become a body.
struct PickedVoxels {
  imaging::Mask mask;
  std::optional<std::array<float, 3>> colour;        ///< linear RGB of its label; none: it is of no label
  std::shared_ptr<const imaging::LabelMap> tissues;  ///< pickTissues(), of what is of the body; null: of one tissue
};

/// Images and label maps that the bodies of a scene come from, each file read once. One thread at a time.
class BodySources {
 public:
  /// What the scene asks for. Errors say which file, which label and which labels there are.
  /// @param took  reading and masks are added
  [[nodiscard]] Expected<PickedVoxels> pick(const scene::SceneVolume &volume, const ProgressFn &progress,
                                            Preparation &took);
  /// Where the labels of a body of many tissues are.
  [[nodiscard]] Expected<TissuePlaces> placesOf(const scene::SceneBody &body, const PickedVoxels &picked);
  using Layers = std::vector<imaging::LabelMap>;
  /// An image, or the layers of a label map as a whole, at the time point of the options. Errors are those of the
  /// readers.
  [[nodiscard]] Expected<std::shared_ptr<const Layers>> labels(const std::filesystem::path &file,
                                                               const imaging::ReadOptions &options);
  [[nodiscard]] Expected<std::shared_ptr<const imaging::Volume>> volume(const std::filesystem::path &file,
                                                                        const imaging::ReadOptions &options);
  /// The layers that the tissues of a body are labels of.
  [[nodiscard]] Expected<std::shared_ptr<const Layers>> layersOf(const scene::SceneVolume &volume,
                                                                 const ProgressFn &progress);
  /// Sentences of the readers, and others, since the last call.
  [[nodiscard]] std::vector<std::string> takeNotices();
  void addNotice(std::string sentence) { notices_.push_back(std::move(sentence)); }
  /// Logs what takeNotices() gives as warnings of a file, and keeps it for said().
  void reportNotices(const std::filesystem::path &file);
  /// All that was reported, each once, with the name of its file in front.
  [[nodiscard]] const std::vector<std::string> &said() const { return said_; }

 private:
  /// One of its series at one of its time points
  using File = std::tuple<std::filesystem::path, std::string, std::size_t>;
  std::map<File, std::shared_ptr<const Layers>> labels_;
  std::map<File, std::shared_ptr<const imaging::Volume>> volumes_;
  std::vector<std::string> notices_, said_;
};

/// Of a mask, without its specks. Errors are those of surface and fill.
/// @param edge_mm   of the triangles of the skin; 0: automatic
/// @param points    about how many there will be, at least: voxels are averaged to a sixteenth of their distance
/// @param isOfTissues  addTissues() follows
[[nodiscard]] Expected<BodyGeometry> bodyGeometryOf(const imaging::Mask &mask, double edge_mm, double points,
                                                    bool isOfTissues, const ProgressFn &progress);

/// Gives a geometry what its tissues fill.
/// @param points  as of bodyGeometryOf()
/// Errors: a tissue that the scene names has no voxel.
[[nodiscard]] Expected<void> addTissues(const scene::SceneVolume &volume, const imaging::LabelMap &tissues,
                                        double points, BodyGeometry &geometry);

/// What goes wrong with a file or a value that a scene names, with the place in the scene; a value that cannot be used
/// is input then, not usage.
[[nodiscard]] tl::unexpected<Error> failInScene(const Error &error, const scene::SceneFile &scene, int line);

/// The fill in metres for a simulator; points into `fill`.
[[nodiscard]] c3de_sim_grid toAbi(const imaging::VolumeGeometry &grid);

}  // namespace c3de::session
