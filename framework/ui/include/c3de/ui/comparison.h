// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/handle.h"
#include "c3de/geometry/rigid_fit.h"
#include "c3de/render/image_renderer.h"
#include "c3de/scene/image_store.h"
#include "c3de/ui/image_presets.h"

namespace c3de::registry {
class EditList;
}

namespace c3de::ui {

/// Display options of the second scan that the user sets.
struct ComparisonOptions {
  bool isShown = true;
  bool isCheckerboard = false;  ///< otherwise both scans are blended
  double blend = 0.5;           ///< weight of the second scan, 0 … 1
  double square_mm = 20.0;      ///< side of the squares
  WindowLevel windowLevel;      ///< of the second scan
  friend bool operator==(const ComparisonOptions &, const ComparisonOptions &) = default;
};

/// A named point in world space, mm, LPS.
struct NamedPoint {
  std::string name;
  Vec3 at_mm{};
};

/// The pose that brings landmarks of the second scan to those of the same names in the first one.
struct LandmarkAlignment {
  geometry::RigidPose pose;
  std::size_t pairs = 0;
  double mean_mm = 0.0, max_mm = 0.0;  ///< distances of the pairs after the motion
};

/// @param fixed   of the first scan; moving: of the second one, in its own world
/// @param centre_mm  of the rotation of the pose
/// Errors (usage): those of geometry::fitRigid(), with the names that have no partner.
[[nodiscard]] Expected<LandmarkAlignment> alignByLandmarks(std::span<const NamedPoint> fixed,
                                                           std::span<const NamedPoint> moving, const Vec3 &centre_mm);

/// A second scan that is shown over the open image, moved rigidly. Changes of its pose are steps of undo. Main thread.
class Comparison {
 public:
  /// @param edits  must outlive this; null: nothing can be undone
  explicit Comparison(registry::EditList *edits = nullptr) : edits_(edits) {}
  Comparison(const Comparison &) = delete;
  Comparison &operator=(const Comparison &) = delete;
  ~Comparison();

  /// A scan at the position of its file, with automatic window and level; the other options stay. Steps of undo of another scan
  /// end. @param handle  of the renderer, whose owner removes it
  void set(std::shared_ptr<const scene::StoredImage> image, Handle handle);
  /// No scan.
  void clear() { set(nullptr, {}); }
  [[nodiscard]] const scene::StoredImage *image() const { return image_.get(); }
  [[nodiscard]] const std::shared_ptr<const scene::StoredImage> &sharedImage() const { return image_; }
  [[nodiscard]] Handle handle() const { return handle_; }
  /// There is a scan, and it is not hidden.
  [[nodiscard]] bool isShown() const { return image_ && options_.isShown; }

  [[nodiscard]] const ComparisonOptions &options() const { return options_; }
  /// Values outside their ranges are set to the nearest one that is accepted.
  void setOptions(const ComparisonOptions &options);
  static constexpr double kSmallestSquare_mm = 1.0, kLargestSquare_mm = 200.0;

  /// Middle of the second scan in its own world: the centre of rotations.
  [[nodiscard]] const Vec3 &centre_mm() const { return centre_mm_; }
  [[nodiscard]] const geometry::RigidPose &pose() const { return pose_; }
  [[nodiscard]] Mat4 worldFromSecond() const { return geometry::matrixOf(pose_); }
  /// As a step of undo. No effect if it is the same. Errors (usage): a number that is not finite.
  [[nodiscard]] Expected<void> edit(const std::string &label, const geometry::RigidPose &pose);
  /// As a step of undo, with the residual that is shown as long as the scan has this pose.
  [[nodiscard]] Expected<void> align(const LandmarkAlignment &alignment);
  /// Without a step of undo, for example of a session. Errors: as edit().
  [[nodiscard]] Expected<void> assign(const geometry::RigidPose &pose);
  /// A change in progress, such as a drag; it ends with finishPreview() or cancelPreview(). A pose that is not finite
  /// has no effect.
  void preview(const geometry::RigidPose &pose);
  void finishPreview(const std::string &label);
  void cancelPreview();
  /// Of the landmarks that gave the present pose; none: it was changed since.
  [[nodiscard]] std::optional<LandmarkAlignment> alignment() const;

  /// Equal numbers: the same pose; 0: that of the file, or no scan. Undo returns to the earlier number.
  [[nodiscard]] std::uint64_t revision() const { return revision_; }

  /// The nearest voxel's value at a point of the first scan's world; none: outside, or hidden.
  [[nodiscard]] std::optional<double> valueAt(const Vec3 &world_mm) const;
  [[nodiscard]] render::ComparisonDisplay look() const;
  /// Corners of its box at present, in the world of the first scan.
  [[nodiscard]] std::vector<Vec3> corners_mm() const;
  /// "PAT2 50 %", or "PAT2 in squares of 20 mm"; empty: hidden.
  [[nodiscard]] std::string text() const;

 private:
  struct Step;
  void show(const geometry::RigidPose &pose, std::uint64_t revision);

  registry::EditList *edits_;
  std::shared_ptr<const scene::StoredImage> image_;
  Handle handle_;
  ComparisonOptions options_;
  Vec3 centre_mm_{};
  geometry::RigidPose pose_;
  std::optional<geometry::RigidPose> beforePreview_;
  std::optional<LandmarkAlignment> alignment_;
  std::uint64_t revision_ = 0, lastRevision_ = 0;
};

}  // namespace c3de::ui
