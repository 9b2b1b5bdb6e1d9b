// SPDX-License-Identifier: Apache-2.0
#include "workstation/workstation_images.h"

#include <algorithm>
#include <utility>

#include "c3de/abi/log.h"
#include "c3de/core/output_file.h"
#include "c3de/core/path_text.h"
#include "c3de/imaging/writing.h"
#include "c3de/render/image_renderer.h"
#include "c3de/session/file_kind.h"
#include "workstation/image_reading.h"

namespace c3de::app {

WorkstationImages::WorkstationImages(Session &session, render::Renderer &renderer, registry::PanelRegistry &panels,
                                     registry::ToolRegistry &tools, Events events)
    : session_(session), renderer_(renderer), panels_(panels), events_(std::move(events)),
      displacement_(renderer.images(), views_),
      workflow_(session.jobs(), kJobOwner, session.materials(),
                {[this] { showPreview(); }, events_.createBodies, events_.updateBody}),
      brush_(tools, views_, workflow_),
      scanBody_(session.jobs(), kJobOwner, session.materials(), events_.createScanBody),
      labels_({session, renderer, panels, views_, workflow_},
              {[this] { updateScanBodySources(); }, [this] { applyRestored(); }, events_.failed}),
      maskSurface_(session, renderer), job_(session.jobs()), timeJob_(session.jobs()) {
  if (render::ImageRenderer *images = renderer_.images()) images->setOverlayColours(ui::overlayColours());
  views_.setTimeChooser([this](std::size_t time) { readTime(time); });
}

WorkstationImages::~WorkstationImages() {
  choice_.reset();
  render::ImageRenderer *images = renderer_.images();
  if (!images) return;
  const ui::ImageHandles &handles = views_.handles();
  for (const Handle handle : {handles.image, handles.labels, handles.preview, handles.missing}) images->remove(handle);
}

void WorkstationImages::open(const std::filesystem::path &path, std::vector<std::filesystem::path> labels,
                             const std::string &series, std::size_t time, Segmentation segmentation,
                             bool isOfSimulation) {
  choice_.reset();
  const auto read = std::make_shared<ReadImage>();
  const ImageToRead wanted{path, series, time, imageName(path), !windowLevelRules_.empty()};
  const bool laysOver = segmentation == Segmentation::labels && views_.image() != nullptr;
  job_.start(
      "Opening " + wanted.name,
      [wanted, read, laysOver](const ProgressFn &progress) -> Expected<void> {
        return readFirst(wanted, laysOver, progress, *read);
      },
      [this, wanted, labels = std::move(labels), read, isOfSimulation](const Expected<void> &result) {
        if (!result) return events_.failed("Could not open " + wanted.name, result.error());
        if (!read->image && !read->isSegmentation) return askForSeries(wanted.path, labels, read->series);
        std::vector<std::filesystem::path> maps = labels;
        if (read->isSegmentation) maps.insert(maps.begin(), wanted.path);
        if (read->image) {
          const std::filesystem::path former = std::exchange(path_, wanted.path);
          const std::string formerSeries = std::exchange(series_, wanted.series);
          const bool isSecond = hasImage() && !isOfSimulation && !read->isSegmentation &&
                                (former != wanted.path || formerSeries != wanted.series);
          show(read->image, isOfSimulation);
          applyWindowLevelRule(read->description + " " + pathText(wanted.path.filename()));
          if (isSecond && views_.image() == read->image.get()) offerToCompare(former, formerSeries);
          if (read->isSegmentation)
            read->notices.emplace_back(
                "Its segments lie over its numbers as labels. To see them over a scan, open the scan, then this file "
                "again.");
          reportNotices(panels_, "Opened " + wanted.name, read->notices);
        } else {
          reportNotices(panels_, "Opened " + wanted.name,
                        {"A segmentation: its segments lie over the image that is open, as labels. "
                         "Close the image first to see it alone."});
        }
        for (const std::filesystem::path &file : maps) labels_.open(file);
        if (!labels_.isLoading()) applyRestored();
        if (!read->series.empty()) askForSeries(wanted.path, labels, read->series);
      });
}

void WorkstationImages::readTime(std::size_t time) {
  const ImageToRead wanted{path_, series_, time, imageName(path_)};
  const auto read = std::make_shared<ReadImage>();
  timeJob_.start(
      "Reading time point " + std::to_string(time) + " of " + wanted.name,
      [wanted, read](const ProgressFn &progress) { return readStored(wanted, progress, *read); },
      [this, read, wanted](const Expected<void> &result) {
        if (!result)
          return events_.failed("Could not read time point " + std::to_string(wanted.time) + " of " + wanted.name,
                                result.error());
        showTime(read->image);
      });
}

void WorkstationImages::showTime(std::shared_ptr<scene::StoredImage> image) {
  render::ImageRenderer *images = renderer_.images();
  const scene::StoredImage *shown = views_.image();
  if (!images || !shown) return;
  if (!imaging::sameGrid(shown->volume.geometry, image->volume.geometry))
    return events_.failed("Could not show another time point of " + image->name,
                          {ErrorCode::input, "its position differs from that of the open one"});
  auto handle = images->addImage(voxelsOf(image->volume));
  if (!handle) return events_.failed("Could not show " + image->name, handle.error());
  images->remove(views_.handles().image);
  session_.images().removeImage(storedImage_);
  storedImage_ = session_.images().add(std::shared_ptr<const scene::StoredImage>(image));
  views_.replaceImage(image, *handle);
  workflow_.replaceImage(image);
  updateScanBodySources();
}

void WorkstationImages::show(std::shared_ptr<scene::StoredImage> image, bool isOfSimulation) {
  render::ImageRenderer *images = renderer_.images();
  if (!images) return;
  std::string notice;
  auto handle = images->addImage(voxelsOf(image->volume), &notice);
  if (!handle) return events_.failed("Could not show " + image->name, handle.error());
  const bool isAnother = !isOfSimulation && session_.simulation() != nullptr;
  close();
  storedImage_ = session_.images().add(std::shared_ptr<const scene::StoredImage>(image));
  views_.setImage(image);
  views_.setHandles({*handle, {}, {}, {}, {}, {}});
  markMissing();
  node_ = session_.sceneGraph().add({}, image->name);
  scene::Node *node = session_.sceneGraph().find(node_);
  node->hasBounds = true;
  const imaging::VolumeGeometry &grid = image->volume.geometry;
  for (unsigned corner = 0; corner < 8; ++corner) {
    Vec3 index{};
    for (std::size_t a = 0; a < 3; ++a)
      index[a] = (corner >> a & 1u) != 0 ? static_cast<double>(grid.size[a]) - 0.5 : -0.5;
    const Vec3 at = grid.worldAt(index);
    for (std::size_t a = 0; a < 3; ++a) {
      node->boundsMin[a] = corner == 0 ? at[a] : std::min(node->boundsMin[a], at[a]);
      node->boundsMax[a] = corner == 0 ? at[a] : std::max(node->boundsMax[a], at[a]);
    }
  }
  session_.sceneGraph().touch();
  workflow_.setSources({image, nullptr});
  updateScanBodySources();
  segmentationPanel_.emplace(
      panels_, ui::SegmentationPanel::Parts{views_, workflow_, scanBody_, brush_, events_.askForLabelFile});
  brush_.offer(true);
  panel_.emplace(panels_, views_, labels_.choices());
  if (!notice.empty()) reportNotices(panels_, "Opened " + image->name, {notice});
  if (isAnother) offerToCloseSimulation(image->name);
  events_.shown();
}

void WorkstationImages::applyWindowLevelRule(const std::string &name) {
  const auto found = ui::windowLevelFor(windowLevelRules_, name);
  if (!found || !views_.image()) return;
  ui::ImageOptions options = views_.options();
  options.windowLevel = *found;
  views_.setOptions(options);
}

void WorkstationImages::offerToCloseSimulation(const std::string &image) {
  // Posted, since messages are being drawn; skipped if another simulation has been opened since.
  const auto close = [this, node = session_.simulationNode()] {
    session_.mainQueue().post([this, node] {
      if (session_.simulationNode() == node) events_.closeSimulation();
    });
  };
  panels_.notify(C3DE_LOG_INFO, "The simulation is still open",
                 "Its bodies were made before " + image +
                     " was opened, and deform it where they overlap it. File > Close simulation removes them.",
                 {{"Close the simulation", close}}, registry::About::simulation);
}

void WorkstationImages::offerToCompare(const std::filesystem::path &former, const std::string &series) {
  // Posted, since messages are being drawn; skipped if yet another image has been opened.
  const auto compare = [this, former, series, shown = path_] {
    session_.mainQueue().post([this, former, series, shown] {
      if (hasImage() && path_ == shown) events_.compareWith(former, series);
    });
  };
  panels_.notify(C3DE_LOG_INFO, "Another image is open",
                 imageName(former) + " was open before. It can be shown over the new one as a second scan.",
                 {{"Compare with it", compare}});
}

void WorkstationImages::onBodiesReady(const std::vector<segmentation::BodyRequest> &requests) {
  labels_.hideLabelsOf(requests);
  workflow_.onBodiesCreated(requests);
}

void WorkstationImages::updateScanBodySources() {
  segmentation::ScanBody::Sources sources;
  sources.image = views_.sharedImage();
  sources.imageFile = path_;
  sources.series = series_;
  labels_.addTo(sources);
  scanBody_.setSources(std::move(sources));
}

void WorkstationImages::applyRestored() {
  if (!toRestore_) return;
  isRestoring_ = true;
  workflow_.restore(*std::exchange(toRestore_, std::nullopt));
  reportRestored();
}

/// At once where nothing is computed, for example for labels of a map that could not be read.
void WorkstationImages::reportRestored() {
  if (!isRestoring_ || workflow_.mask().isBusy()) return;
  isRestoring_ = false;
  events_.selectionRestored();
}

/// Preview of the selection, over the slices.
void WorkstationImages::showPreview() {
  reportRestored();
  render::ImageRenderer *images = renderer_.images();
  views_.setPickedLabels(workflow_.isSeveral() ? workflow_.pickedLabels() : std::vector<std::uint16_t>());
  if (!images || preview_ == workflow_.mask().preview()) return;
  preview_ = workflow_.mask().preview();
  ui::ImageHandles handles = views_.handles();
  images->remove(std::exchange(handles.preview, {}));
  if (preview_ && !preview_->voxels.empty()) {
    auto handle = images->addLabels(placeOf(preview_->geometry), preview_->voxels);
    if (!handle) return views_.setHandles(handles), events_.failed("Could not show what is picked", handle.error());
    handles.preview = *handle;
    const std::pair<std::uint16_t, render::Colour> colour{std::uint16_t{1}, workflow_.colour()};
    images->setLabelColours(handles.preview, {&colour, 1});
  }
  views_.setHandles(handles);
}

void WorkstationImages::showDisplacement(std::shared_ptr<const imaging::DisplacementGrid> displacement) {
  if (const auto shown = displacement_.show(std::move(displacement)); !shown)
    events_.failed("Could not show the displacement", shown.error());
}

void WorkstationImages::showMissing(const std::vector<Coverage> &bodies, bool isNew) {
  if (isNew) coverage_.clear();
  coverage_.insert(coverage_.end(), bodies.begin(), bodies.end());
  std::vector<std::string> sentences;
  for (const Coverage &body : bodies)
    if (std::string text = sentenceOf(body); !text.empty()) sentences.push_back(std::move(text));
  if (!sentences.empty()) sentences.emplace_back("It is hatched in the slices.");
  reportNotices(panels_, "Incomplete body", sentences, registry::About::simulation);
  markMissing();
}

void WorkstationImages::markMissing() {
  render::ImageRenderer *images = renderer_.images();
  if (!images) return;
  if (const auto marked = app::showMissing(*images, views_, coverage_); !marked)
    events_.failed("What is in no body cannot be marked", marked.error());
}

void WorkstationImages::close() {
  timeJob_.cancel();
  toRestore_.reset();
  isRestoring_ = false;
  brush_.offer(false);
  maskSurface_.hide();
  segmentationPanel_.reset();
  workflow_.setSources({});
  labels_.close();
  displacement_.forget();
  if (render::ImageRenderer *images = renderer_.images())
    for (const Handle handle : {views_.handles().image, views_.handles().missing}) images->remove(handle);
  views_.setImage(nullptr);
  scanBody_.setSources({});
  session_.images().removeImage(std::exchange(storedImage_, {}));
  session_.sceneGraph().remove(std::exchange(node_, {}));
  panel_.reset();
  if (events_.closed) events_.closed();
}

void WorkstationImages::saveLabels(const std::filesystem::path &path) {
  std::string notice;
  if (workflow_.isMaskSavedAlone()) notice = " The open label map has another grid; its labels are not in the file.";
  session_.jobs().submit(
      kJobOwner, "Saving " + imageName(path),
      [make = workflow_.labelMapToSave(), path](const ProgressFn &) -> Expected<void> {
        const auto map = make();
        if (!map) return tl::unexpected(map.error());
        return imaging::writeLabelMap(path, *map);
      },
      [this, path, notice, revision = workflow_.mask().revision()](const Expected<void> &written) {
        if (!written) return events_.failed("The label map could not be saved", written.error());
        savedRevision_ = revision;
        const auto open = [this, path] {
          session_.mainQueue().post([this, path] {
            if (hasImage()) openLabels(path);
          });
        };
        panels_.notify(C3DE_LOG_INFO, "Label map saved", pathText(path) + notice, {{"Show it over the image", open}});
      });
}

void WorkstationImages::saveStatistics(const std::filesystem::path &path) {
  session_.jobs().submit(
      kJobOwner, "Measuring regions",
      [make = workflow_.statisticsToSave(), path](const ProgressFn &progress) -> Expected<void> {
        const auto text = make(progress);
        if (!text) return tl::unexpected(text.error());
        return writeWholeFile(path, *text);
      },
      [this, path](const Expected<void> &written) {
        if (!written) return events_.failed("The region statistics could not be saved", written.error());
        panels_.notify(C3DE_LOG_INFO, "Region statistics saved", pathText(path));
      });
}

void WorkstationImages::followNode() {
  if (views_.image() && views_.options().showsPreviewSurface)
    maskSurface_.show(workflow_.mask().preview(), workflow_.colour());
  else
    maskSurface_.hide();
  maskSurface_.followTree();
  if (views_.image()) views_.setVisibleInSpace(session_.sceneGraph().isVisible(node_));
  // "Fit view" includes what is drawn in space; an image shown only in the slices is excluded.
  if (scene::Node *node = session_.sceneGraph().find(node_))
    node->hasBounds = views_.options().showsSlicesInSpace || views_.options().showsVolume;
}

void WorkstationImages::askForSeries(const std::filesystem::path &path, std::vector<std::filesystem::path> labels,
                                     std::vector<imaging::SeriesInfo> series) {
  choice_.reset();
  choice_ = std::make_unique<SeriesChoice>(panels_, path, std::move(series),
                                           [this, path, labels = std::move(labels)](const std::string &id) {
                                             if (id.empty())
                                               choice_.reset();
                                             else
                                               open(path, labels, id);
                                           });
}

}  // namespace c3de::app
