// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "c3de/imaging/displacement.h"
#include "c3de/imaging/fixed_regions.h"
#include "c3de/imaging/warp_grid.h"
#include "c3de/scene/image_store.h"
#include "c3de/scene/simulation.h"
#include "c3de/session/point_fields.h"
#include "c3de/session/tissue_voxels.h"

namespace c3de::session {

/// The regions of an image that stay fixed while bodies move.
struct FixedRegions {
  std::shared_ptr<const scene::StoredImage> image;  ///< null: the rule fixes nothing
  std::shared_ptr<const scene::StoredLabels> labels;
  imaging::FixedRegionRule rule;
  std::shared_ptr<const std::vector<TissueVoxels>> tissues;  ///< of the bodies of many tissues; null: there are none
  friend bool operator==(const FixedRegions &, const FixedRegions &) = default;
};

/// Displacement of the tissue in a running simulation, for displays of an image next to it. While a client wants it,
/// the simulator is queried after each published snapshot.
class DisplacementSampler {
 public:
  /// Starts with the present simulation: the grid is rebuilt around its bodies and follows them. Any thread.
  void begin();
  /// @param wanted  the displacement is displayed; otherwise the simulator is not queried
  /// @param rim_mm  distance around the bodies within which the displacement falls to zero
  /// @param image   grid of the displayed image, on which the bodies' reference regions are marked
  /// @param fixedRegions  regions of the image that stay fixed
  void want(bool wanted, double rim_mm, const imaging::VolumeGeometry &image = {},
            const FixedRegions &fixedRegions = {});
  [[nodiscard]] bool wanted() const { return wanted_; }
  /// Requests fields of the tissue in addition to its displacement. Any thread.
  void requestFields(const RequestedFields &fields);
  /// The fields that the simulator provides at its points; available after the first displacement. Any thread.
  [[nodiscard]] std::vector<PointField> offered() const;

  /// Call on the simulation's thread, after a snapshot. While one simulation replaces another, both call this and one
  /// waits for the other. During playback it runs at most 20 times a second and uses at most a quarter of the time.
  /// @return the displacement of this snapshot; null where none was requested, or the simulator does not provide it
  std::shared_ptr<const imaging::DisplacementGrid> onPublished(const scene::Simulation &simulation);
  /// The newest displacement, returned once; null if there is no new one. Any thread.
  [[nodiscard]] std::shared_ptr<const imaging::DisplacementGrid> take();
  /// Whether the last snapshot was skipped. A caller that sees the simulation paused checks this and posts for another.
  [[nodiscard]] bool isBehind() const { return behind_; }
  /// Wall time of the last query, ms. Any thread.
  [[nodiscard]] double milliseconds() const { return milliseconds_; }

 private:
  std::atomic<bool> wanted_ = false, behind_ = false;
  std::atomic<double> falloff_mm_ = 10.0, milliseconds_ = 0.0;
  std::atomic<std::uint64_t> serial_ = 1;
  mutable std::mutex mutex_;
  std::shared_ptr<const imaging::DisplacementGrid> newest_;
  imaging::VolumeGeometry image_;
  FixedRegions fixedRegions_;
  RequestedFields fields_;
  std::vector<PointField> offered_;
  // Used by the simulation's thread, and by both threads while one simulation replaces another:
  std::mutex askingMutex_;
  imaging::FollowingGrid grid_;
  std::uint64_t gridSerial_ = 0;
  std::shared_ptr<const imaging::Mask> reference_, bodies_;  // bodies alone; with the regions fixed by the rule
  FixedRegions marked_;                                      // the fixed regions that bodies_ contains
  bool hasStill_ = false;
  std::chrono::steady_clock::time_point last_{};
};

}  // namespace c3de::session
