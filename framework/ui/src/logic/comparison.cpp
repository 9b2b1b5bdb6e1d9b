// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "c3de/core/text.h"
#include "c3de/registry/edit_list.h"

namespace c3de::ui {
namespace {

constexpr const char *kOwner = "c3de.comparison";

std::string listOf(const std::vector<std::string> &names) {
  constexpr std::size_t kMost = 5;
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kMost); ++i)
    text += (i == 0 ? "'" : ", '") + displayText(names[i]) + "'";
  return names.size() > kMost ? text + fmt::format(" and {} others", names.size() - kMost) : text;
}

Vec3 middleOf(const imaging::VolumeGeometry &grid) {
  Vec3 index{};
  for (std::size_t a = 0; a < 3; ++a) index[a] = 0.5 * (static_cast<double>(grid.size[a]) - 1.0);
  return grid.worldAt(index);
}

Expected<void> checkPose(const geometry::RigidPose &pose) {
  if (geometry::isFinite(pose)) return {};
  const Vec3 &t = pose.translation_mm, &r = pose.rotation_deg;
  return fail(
      ErrorCode::usage,
      fmt::format("the second scan cannot be moved by {}, {}, {} mm and rotated by {}, {}, {} degrees; accepted: "
                  "finite numbers",
                  t[0], t[1], t[2], r[0], r[1], r[2]));
}

}  // namespace

Expected<LandmarkAlignment> alignByLandmarks(std::span<const NamedPoint> fixed, std::span<const NamedPoint> moving,
                                             const Vec3 &centre_mm) {
  std::vector<Vec3> from, to;
  std::vector<std::string> alone;
  for (const NamedPoint &one : moving) {
    const auto same =
        std::find_if(fixed.begin(), fixed.end(), [&](const auto &point) { return point.name == one.name; });
    if (same == fixed.end()) {
      alone.push_back(one.name);
      continue;
    }
    from.push_back(one.at_mm);
    to.push_back(same->at_mm);
  }
  const auto fit = geometry::fitRigid(from, to);
  if (!fit) {
    std::string why = fit.error().message;
    if (!alone.empty()) why += fmt::format(". The first scan has no landmark {}", listOf(alone));
    if (fixed.empty()) why += ". It has no landmarks at all: add some, or load a file of them";
    return fail(fit.error().code, why);
  }
  return LandmarkAlignment{geometry::poseOf(fit->fixedFromMoving, centre_mm), from.size(), fit->mean_mm, fit->max_mm};
}

struct Comparison::Step {
  Comparison *comparison;
  geometry::RigidPose before, after;
  std::uint64_t revisionBefore, revisionAfter;
};

Comparison::~Comparison() {
  if (edits_) edits_->removeOwnedBy(kOwner);
}

void Comparison::set(std::shared_ptr<const scene::StoredImage> image, Handle handle) {
  if (edits_) edits_->removeOwnedBy(kOwner);
  image_ = std::move(image);
  handle_ = handle;
  centre_mm_ = image_ ? middleOf(image_->volume.geometry) : Vec3{};
  pose_ = {{}, {}, centre_mm_};
  beforePreview_.reset();
  alignment_.reset();
  revision_ = 0;
  if (!image_) return;
  options_.windowLevel = automaticWindowLevel(image_->range);
  options_.isShown = true;
}

void Comparison::setOptions(const ComparisonOptions &options) {
  options_ = options;
  const auto within = [](double value, double low, double high, double otherwise) {
    return std::isfinite(value) ? std::clamp(value, low, high) : otherwise;
  };
  options_.blend = within(options.blend, 0.0, 1.0, 0.5);
  options_.square_mm = within(options.square_mm, kSmallestSquare_mm, kLargestSquare_mm, 20.0);
}

void Comparison::show(const geometry::RigidPose &pose, std::uint64_t revision) {
  pose_ = pose;
  revision_ = revision;
  beforePreview_.reset();
}

Expected<void> Comparison::edit(const std::string &label, const geometry::RigidPose &pose) {
  if (auto good = checkPose(pose); !good) return good;
  cancelPreview();
  if (!image_ || pose == pose_) return {};
  auto step = std::make_unique<Step>(Step{this, pose_, pose, revision_, ++lastRevision_});
  show(pose, step->revisionAfter);
  if (!edits_) return {};
  registry::Edit edit;
  edit.owner = kOwner;
  edit.label = label;
  edit.undo = [](void *self) noexcept -> c3de_status {
    const auto *one = static_cast<Step *>(self);
    one->comparison->show(one->before, one->revisionBefore);
    return C3DE_OK;
  };
  edit.redo = [](void *self) noexcept -> c3de_status {
    const auto *one = static_cast<Step *>(self);
    one->comparison->show(one->after, one->revisionAfter);
    return C3DE_OK;
  };
  edit.release = [](void *self) noexcept { delete static_cast<Step *>(self); };
  edit.self = step.release();
  edits_->add(std::move(edit));
  return {};
}

Expected<void> Comparison::align(const LandmarkAlignment &alignment) {
  if (auto edited = edit("align by landmarks", alignment.pose); !edited) return edited;
  alignment_ = alignment;
  return {};
}

Expected<void> Comparison::assign(const geometry::RigidPose &pose) {
  if (auto good = checkPose(pose); !good) return good;
  if (edits_) edits_->removeOwnedBy(kOwner);
  // A pose may have been saved about another centre.
  if (image_) show(geometry::poseOf(geometry::matrixOf(pose), centre_mm_), ++lastRevision_);
  return {};
}

void Comparison::preview(const geometry::RigidPose &pose) {
  if (!image_ || !geometry::isFinite(pose)) return;
  if (!beforePreview_) beforePreview_ = pose_;
  pose_ = pose;
}

void Comparison::finishPreview(const std::string &label) {
  if (!beforePreview_) return;
  const geometry::RigidPose wanted = pose_;
  // Only finite poses are shown.
  (void)edit(label, wanted);
}

void Comparison::cancelPreview() {
  if (beforePreview_) pose_ = *std::exchange(beforePreview_, std::nullopt);
}

std::optional<LandmarkAlignment> Comparison::alignment() const {
  return alignment_ && alignment_->pose == pose_ ? alignment_ : std::nullopt;
}

std::optional<double> Comparison::valueAt(const Vec3 &world_mm) const {
  if (!isShown()) return std::nullopt;
  const imaging::VolumeGeometry &grid = image_->volume.geometry;
  const Vec3 own = transformPoint(geometry::rigidInverse(worldFromSecond()), world_mm);
  const auto index = imaging::voxelAt(grid, transformPoint(imaging::affineInverse(grid.indexToWorld), own));
  if (!index) return std::nullopt;
  return image_->volume.value((*index)[0], (*index)[1], (*index)[2]);
}

render::ComparisonDisplay Comparison::look() const {
  if (!isShown() || (!options_.isCheckerboard && options_.blend <= 0.0)) return {};
  return {handle_,
          worldFromSecond(),
          options_.windowLevel.window,
          options_.windowLevel.level,
          static_cast<float>(options_.blend),
          options_.isCheckerboard,
          options_.square_mm};
}

std::vector<Vec3> Comparison::corners_mm() const {
  std::vector<Vec3> corners;
  if (!image_) return corners;
  const imaging::VolumeGeometry &grid = image_->volume.geometry;
  const Mat4 place = worldFromSecond();
  for (unsigned corner = 0; corner < 8; ++corner) {
    Vec3 index{};
    for (std::size_t a = 0; a < 3; ++a)
      index[a] = (corner >> a & 1u) != 0 ? static_cast<double>(grid.size[a]) - 0.5 : -0.5;
    corners.push_back(transformPoint(place, grid.worldAt(index)));
  }
  return corners;
}

std::string Comparison::text() const {
  if (!isShown()) return {};
  return options_.isCheckerboard ? fmt::format("{} in squares of {:.3g} mm", image_->name, options_.square_mm)
                                 : fmt::format("{} {:.0f} %", image_->name, 100.0 * options_.blend);
}

}  // namespace c3de::ui
