// SPDX-License-Identifier: Apache-2.0
#include "workstation/comparison_controller.h"

#include <fmt/format.h>

#include <system_error>
#include <utility>

#include "c3de/core/path_text.h"
#include "c3de/imaging/warp_grid.h"
#include "c3de/render/image_renderer.h"
#include "c3de/session/file_kind.h"
#include "c3de/session/landmark_file.h"
#include "workstation/displacement_presenter.h"

namespace c3de::app {
namespace {

std::string extentText(const imaging::WorldBox &box) {
  return fmt::format("x {:.0f} … {:.0f}, y {:.0f} … {:.0f}, z {:.0f} … {:.0f} mm", box.low[0], box.high[0], box.low[1],
                     box.high[1], box.low[2], box.high[2]);
}

bool isSameFile(const std::filesystem::path &a, const std::filesystem::path &b) {
  std::error_code code;
  return std::filesystem::equivalent(a, b, code) && !code;
}

constexpr const char *kRemovals = "c3de.comparison.removal";  // owner of the steps of remove()

}  // namespace

struct ComparisonController::Removal {
  ComparisonController *controller;
  Shown state;
  std::shared_ptr<const scene::StoredImage> image;
};

ComparisonController::ComparisonController(Parts parts)
    : parts_(std::move(parts)), comparison_(&parts_.edits), tools_(parts_.tools, parts_.images.views(), comparison_),
      job_(parts_.session.jobs()) {
  parts_.images.views().setComparison(&comparison_);
}

ComparisonController::~ComparisonController() {
  parts_.edits.removeOwnedBy(kRemovals);
  choice_.reset();
  panel_.reset();
  removeFromRenderer();
  parts_.images.views().setComparison(nullptr);
}

void ComparisonController::connect(ui::WindowActions &actions) {
  actions.openComparison = [this](const std::filesystem::path &file) { open(file); };
  actions.closeComparison = [this] { remove(); };
}

void ComparisonController::open(const std::filesystem::path &path, const std::string &series) {
  pending_.reset();
  read({path, series, 0, imageName(path)});
}

void ComparisonController::restore(const std::filesystem::path &path, const SavedComparison &saved) {
  pending_ = Shown{path, saved};
  read({path, saved.series, static_cast<std::size_t>(saved.time), imageName(path)});
}

void ComparisonController::read(const ImageToRead &wanted) {
  choice_.reset();
  if (!parts_.images.hasImage()) {
    pending_.reset();
    return parts_.failed("Could not open " + wanted.name,
                         {ErrorCode::state, "a second scan is shown over an image; open the image first"});
  }
  const auto read = std::make_shared<ReadImage>();
  const auto isSame = std::make_shared<bool>(false);
  job_.start(
      "Opening " + wanted.name,
      [wanted, read, isSame,
       first = parts_.images.views().sharedImage()](const ProgressFn &progress) -> Expected<void> {
        auto done = readFirst(wanted, true, progress, *read);
        if (done && read->image)
          *isSame = imaging::sameGrid(first->volume.geometry, read->image->volume.geometry) &&
                    first->volume.voxels == read->image->volume.voxels;
        return done;
      },
      [this, wanted, read, isSame](const Expected<void> &result) {
        const std::string title = "Could not open " + wanted.name;
        if (!result) {
          parts_.failed(title, result.error());
        } else if (read->isSegmentation) {
          parts_.failed(title, {ErrorCode::input, "is a label map; accepted: a scan. File > Open label map… shows it"});
        } else if (!read->image) {
          choice_ = std::make_unique<SeriesChoice>(
              parts_.panels, wanted.path, std::move(read->series),
              [this, path = wanted.path](const std::string &id) { id.empty() ? choice_.reset() : open(path, id); });
        } else {
          for (std::string &one : noticesOf(wanted, *isSame)) read->notices.push_back(std::move(one));
          parts_.edits.removeOwnedBy(kRemovals);
          show(wanted, read->image, pending_ ? &pending_->saved : nullptr, std::move(read->notices));
        }
        if (std::exchange(pending_, std::nullopt)) parts_.restored();
      });
}

std::vector<std::string> ComparisonController::noticesOf(const ImageToRead &wanted, bool isSame) const {
  if (pending_) return {};
  if (isSameFile(wanted.path, parts_.images.file()))
    return {"It is the file of the open image. The comparison shows what a simulation changes."};
  if (isSame) return {"Its voxels are those of the open image, at the same positions."};
  return {};
}

bool ComparisonController::show(const ImageToRead &wanted, const std::shared_ptr<const scene::StoredImage> &image,
                                const SavedComparison *saved, std::vector<std::string> notices) {
  render::ImageRenderer *images = parts_.renderer.images();
  const scene::StoredImage *first = parts_.images.views().image();
  if (!images || !first) return false;
  std::string notice;
  const auto handle = images->addImage(voxelsOf(image->volume), &notice);
  if (!handle) {
    parts_.failed("Could not show " + wanted.name, handle.error());
    return false;
  }
  if (!notice.empty()) notices.push_back(notice);
  removeFromRenderer();
  file_ = wanted.path;
  series_ = wanted.series;
  comparison_.set(image, *handle);
  if (saved) {
    // A session has finite numbers only.
    (void)comparison_.assign({saved->translation_mm, saved->rotation_deg, saved->centre_mm});
    ui::ComparisonOptions options = comparison_.options();
    options.isShown = !saved->isHidden;
    options.isCheckerboard = saved->isCheckerboard;
    options.blend = saved->blend;
    options.square_mm = saved->square_mm;
    if (saved->window) options.windowLevel.window = *saved->window;
    if (saved->level) options.windowLevel.level = *saved->level;
    comparison_.setOptions(options);
  } else {
    const imaging::WorldBox box = imaging::boxOf(first->volume.geometry);
    imaging::WorldBox second, shared = box;
    for (const Vec3 &corner : comparison_.corners_mm()) second.add(corner);
    shared.cutTo(second);
    if (shared.isEmpty())
      notices.push_back(
          fmt::format("It does not overlap {}, so that no slice shows it. {}: {}. {}: {}. Align it by "
                      "landmarks, or press Centre in the panel Comparison.",
                      first->name, first->name, extentText(box), wanted.name, extentText(second)));
  }
  tools_.offer(true);
  if (!panel_)
    panel_.emplace(parts_.panels, comparison_, parts_.images.views(),
                   ui::ComparisonPanel::Actions{[this](const std::filesystem::path &file) { align(file); },
                                                [this] { parts_.session.mainQueue().post([this] { remove(); }); }});
  reportNotices(parts_.panels, "Opened " + wanted.name, notices);
  return true;
}

void ComparisonController::align(const std::filesystem::path &landmarks) {
  const std::string title = "The second scan was not aligned";
  const auto moving = readLandmarks(landmarks);
  if (!moving) return parts_.failed(title, moving.error());
  // Those of the first scan are where its picture shows them.
  const bool isAtRest = parts_.images.views().isAtRest();
  std::vector<ui::NamedPoint> from, to;
  for (const FileLandmark &one : *moving) from.push_back({one.name, one.lps_mm});
  for (const ui::MeasuredPoint &one : parts_.measurements.set().points)
    to.push_back({one.name, isAtRest ? one.reference_mm : parts_.measurements.positionOf(one)});
  const auto alignment = ui::alignByLandmarks(to, from, comparison_.centre_mm());
  if (!alignment)
    return parts_.failed(title, {alignment.error().code, pathText(landmarks) + ": " + alignment.error().message});
  if (const auto done = comparison_.align(*alignment); !done) return parts_.failed(title, done.error());
  parts_.panels.notify(C3DE_LOG_INFO, "Aligned by landmarks",
                       fmt::format("{} pairs, residual: mean {:.3f} mm, max {:.3f} mm.", alignment->pairs,
                                   alignment->mean_mm, alignment->max_mm));
}

void ComparisonController::removeFromRenderer() {
  if (render::ImageRenderer *images = parts_.renderer.images(); images && !comparison_.handle().isNull())
    images->remove(comparison_.handle());
}

void ComparisonController::close() {
  parts_.edits.removeOwnedBy(kRemovals);
  hide();
}

void ComparisonController::hide() {
  choice_.reset();
  job_.cancel();
  pending_.reset();
  if (!comparison_.image()) return;
  removeFromRenderer();
  comparison_.clear();
  tools_.offer(false);
  panel_.reset();
  file_.clear();
  series_.clear();
}

void ComparisonController::remove() {
  if (!comparison_.image() || pending_) return close();
  auto removal = std::make_unique<Removal>(Removal{this, *shown(), comparison_.sharedImage()});
  hide();
  registry::Edit edit;
  edit.owner = kRemovals;
  edit.label = "remove comparison";
  edit.undo = [](void *self) noexcept -> c3de_status {
    const auto *one = static_cast<Removal *>(self);
    const Shown &was = one->state;
    const ImageToRead wanted{was.file, was.saved.series, static_cast<std::size_t>(was.saved.time), one->image->name};
    return one->controller->show(wanted, one->image, &was.saved, {}) ? C3DE_OK : C3DE_E_STATE;
  };
  edit.redo = [](void *self) noexcept -> c3de_status {
    static_cast<Removal *>(self)->controller->hide();
    return C3DE_OK;
  };
  edit.release = [](void *self) noexcept { delete static_cast<Removal *>(self); };
  edit.self = removal.release();
  parts_.edits.add(std::move(edit));
}

std::optional<ComparisonController::Shown> ComparisonController::shown() const {
  if (pending_) return pending_;
  if (!comparison_.image()) return std::nullopt;
  Shown out{file_, {}};
  const geometry::RigidPose &pose = comparison_.pose();
  const ui::ComparisonOptions &options = comparison_.options();
  out.saved.series = series_;
  out.saved.time = comparison_.image()->time;
  out.saved.translation_mm = pose.translation_mm;
  out.saved.rotation_deg = pose.rotation_deg;
  out.saved.centre_mm = pose.centre_mm;
  out.saved.isHidden = !options.isShown;
  out.saved.isCheckerboard = options.isCheckerboard;
  out.saved.blend = options.blend;
  out.saved.square_mm = options.square_mm;
  out.saved.window = options.windowLevel.window;
  out.saved.level = options.windowLevel.level;
  return out;
}

}  // namespace c3de::app
