// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "c3de/imaging/displacement.h"
#include "c3de/imaging/still.h"
#include "c3de/imaging/warp_grid.h"
#include "c3de/scene/image_store.h"
#include "c3de/scene/simulation.h"
#include "c3de/session/point_fields.h"
#include "c3de/session/tissue_places.h"

namespace c3de::session {

/// What of an image stays while bodies move.
struct StillPlaces {
  std::shared_ptr<const scene::StoredImage> image;  ///< null: nothing stays by the rule
  std::shared_ptr<const scene::StoredLabels> labels;
  imaging::StillRule rule;
  std::shared_ptr<const std::vector<TissuePlaces>> tissues;  ///< of bodies; null: there are none of many
  friend bool operator==(const StillPlaces &, const StillPlaces &) = default;
};

/// How far the tissue of a running simulation has moved, for who shows an image beside it: asked of the simulator after
/// each published snapshot while somebody wants it.
class DisplacementSampler {
 public:
  /// Any thread. Of the simulation that goes on from here: the grid is laid anew around its bodies, which it follows.
  void begin();
  /// @param wanted  somebody looks; else the simulator is not asked
  /// @param rim_mm  within it the displacement falls to nothing around the bodies
  /// @param image   the grid of what is shown, on which the bodies' places in the reference are told
  /// @param still   what of it stays
  void want(bool wanted, double rim_mm, const imaging::VolumeGeometry &image = {}, const StillPlaces &still = {});
  [[nodiscard]] bool wanted() const { return wanted_; }
  /// And fields of the tissue beside how far it has moved. Any thread.
  void wantFields(const FieldsWanted &fields);
  /// Those that the simulator has at its points; known after the first displacement. Any thread.
  [[nodiscard]] std::vector<PointField> offered() const;

  /// On the simulation's thread, after a snapshot. While one simulation takes the place of another both have one, and
  /// one waits for the other. While it plays at most 20 times a second, and no more than a quarter of the time goes
  /// there.
  /// @return that of this snapshot; null where none was asked for, or the simulator does not say
  std::shared_ptr<const imaging::DisplacementGrid> onPublished(const scene::Simulation &simulation);
  /// The newest displacement, once; null when there is none that has not been taken. Any thread.
  [[nodiscard]] std::shared_ptr<const imaging::DisplacementGrid> take();
  /// Whether the last snapshot went without one; asked by who sees that the simulation stands, and posts for another.
  [[nodiscard]] bool isBehind() const { return behind_; }
  /// Wall time of the last one, ms. Any thread.
  [[nodiscard]] double milliseconds() const { return milliseconds_; }

 private:
  std::atomic<bool> wanted_ = false, behind_ = false;
  std::atomic<double> rim_mm_ = 10.0, milliseconds_ = 0.0;
  std::atomic<std::uint64_t> serial_ = 1;
  mutable std::mutex mutex_;
  std::shared_ptr<const imaging::DisplacementGrid> newest_;
  imaging::VolumeGeometry image_;
  StillPlaces still_;
  FieldsWanted fields_;
  std::vector<PointField> offered_;
  // Of the simulation's thread, and of both while one takes the place of another:
  std::mutex askingMutex_;
  imaging::FollowingGrid grid_;
  std::uint64_t gridSerial_ = 0;
  std::shared_ptr<const imaging::Mask> reference_, bodies_;  // bodies alone; with what stays by the rule
  StillPlaces marked_;                                       // that bodies_ has
  bool hasStill_ = false;
  std::chrono::steady_clock::time_point last_{};
};

struct PresentBodies {
  imaging::WorldBox box;    ///< around their skins
  double spacing_mm = 0.0;  ///< the finest
};
/// [sim]
[[nodiscard]] PresentBodies presentBodies(const c3de_simulator_v1 *table, c3de_object *simulator);
/// Where the bodies are in the reference, on the grid of an image: kBodyVoxel and, of rigid tissue, kRigidVoxel; null
/// where the simulator lends no skins, or too little memory is left.
/// @param tissues  of those that have maps, whose voxels count in the place of their skins; null: there are none [sim]
[[nodiscard]] std::shared_ptr<imaging::Mask> referenceBodies(c3de_object *simulator,
                                                             const imaging::VolumeGeometry &image,
                                                             const std::vector<TissuePlaces> *tissues = nullptr);
/// Displacements and gaps. False where the simulator cannot say, or fails. [sim]
[[nodiscard]] bool readDisplacement(const c3de_simulator_v1 *table, c3de_object *simulator, double rim_mm,
                                    imaging::DisplacementGrid &grid);

}  // namespace c3de::session
