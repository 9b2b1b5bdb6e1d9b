// SPDX-License-Identifier: Apache-2.0
#include "workstation/workstation_labels.h"

#include <algorithm>
#include <string>
#include <utility>

#include "c3de/imaging/reading.h"
#include "c3de/imaging/warp_grid.h"
#include "c3de/render/image_renderer.h"
#include "c3de/session/file_kind.h"
#include "workstation/displacement_presenter.h"

namespace c3de::app {

void WorkstationLabels::open(const std::filesystem::path &path) {
  if (!parts_.views.image())
    return events_.failed("Could not open " + imageName(path),
                          {ErrorCode::state, "a label map needs an image; open the image first"});
  waiting_.push_back(path);
  if (!job_.isRunning()) readNext();
}

std::vector<std::filesystem::path> WorkstationLabels::files() const {
  std::vector<std::filesystem::path> files;
  for (const OpenLabels &open : maps_)
    if (std::find(files.begin(), files.end(), open.path) == files.end()) files.push_back(open.path);
  return files;
}

void WorkstationLabels::readNext() {
  if (waiting_.empty()) return events_.loaded();
  const std::filesystem::path path = waiting_.front();
  waiting_.pop_front();
  const std::string name = imageName(path);
  const auto read = std::make_shared<ReadLabels>();
  job_.start(
      "Opening labels " + name,
      [path, read, name](const ProgressFn &progress) -> Expected<void> {
        imaging::ReadOptions options;
        options.progress = progress;
        auto loaded = imaging::readLabelMap(path, options);
        if (!loaded) return tl::unexpected(loaded.error());
        loaded->layers.insert(loaded->layers.begin(), std::move(loaded->labels));
        for (imaging::LabelMap &layer : loaded->layers) {
          auto one = std::make_shared<scene::StoredLabels>();
          one->name = loaded->layers.size() == 1 ? name
                                                 : name + ", layer " + std::to_string(read->layers.size() + 1) +
                                                       " of " + std::to_string(loaded->layers.size());
          one->map = std::move(layer);
          read->layers.push_back(std::move(one));
        }
        read->notices = std::move(loaded->notices);
        return {};
      },
      [this, path, read, name](const Expected<void> &result) {
        if (result)
          add(path, *read);
        else
          events_.failed("Could not open " + name, result.error());
        readNext();
      });
}

void WorkstationLabels::add(const std::filesystem::path &path, ReadLabels &read) {
  std::erase_if(maps_, [&](const OpenLabels &open) { return open.path == path; });
  for (const auto &layer : read.layers) maps_.push_back({path, layer, {}});
  show(OpenLabels(maps_[maps_.size() - read.layers.size()]));
  if (const scene::StoredImage *image = parts_.views.image()) {
    imaging::WorldBox shared = imaging::boxOf(image->volume.geometry);
    shared.cutTo(imaging::boxOf(read.layers.front()->map.geometry));
    if (shared.isEmpty())
      read.notices.push_back("It does not overlap the image " + image->name +
                             ": no slice shows it. Is it of another scan?");
  }
  reportNotices(parts_.panels, "Opened " + imageName(path), read.notices);
}

void WorkstationLabels::show(const OpenLabels &open) {
  render::ImageRenderer *images = parts_.renderer.images();
  ui::ImageViews &views = parts_.views;
  if (!images || !views.image()) return;
  auto handle = images->addLabels(placeOf(open.labels->map.geometry), open.labels->map.voxels);
  if (!handle) return events_.failed("Could not show " + open.labels->name, handle.error());
  remove();
  stored_ = parts_.session.images().add(open.labels);
  parts_.workflow.setSources({parts_.workflow.mask().sources().image, open.labels});
  views.setLabels(open.labels);
  events_.shown();
  for (const std::uint16_t label : open.hidden) views.setLabelOpacity(label, 0.0f);
  ui::ImageHandles handles = views.handles();
  handles.labels = *handle;
  views.setHandles(handles);
}

void WorkstationLabels::remove() {
  ui::ImageHandles handles = parts_.views.handles();
  if (render::ImageRenderer *images = parts_.renderer.images()) images->remove(handles.labels);
  handles.labels = {};
  parts_.views.setHandles(handles);
  parts_.views.setLabels(nullptr);
  parts_.session.images().removeLabels(std::exchange(stored_, {}));
}

void WorkstationLabels::close() {
  job_.cancel();
  waiting_.clear();
  maps_.clear();
  remove();
}

std::size_t WorkstationLabels::shown() const {
  const auto found = std::find_if(maps_.begin(), maps_.end(),
                                  [&](const OpenLabels &open) { return open.labels.get() == parts_.views.labels(); });
  return static_cast<std::size_t>(found - maps_.begin());
}

ui::ImagePanel::LabelMaps WorkstationLabels::choices() {
  return {[this] {
            std::vector<std::string> names;
            for (const OpenLabels &open : maps_) names.push_back(open.labels->name);
            return names;
          },
          [this] { return shown(); }, [this](std::size_t index) { show(OpenLabels(maps_[index])); }};
}

void WorkstationLabels::addTo(segmentation::ScanBody::Sources &sources) const {
  const std::size_t present = shown();
  if (present >= maps_.size()) return;
  sources.labelFile = maps_[present].path;
  for (const OpenLabels &open : maps_)
    if (open.path == sources.labelFile) sources.layers.push_back(open.labels);
}

void WorkstationLabels::hideLabelsOf(const std::vector<segmentation::BodyRequest> &requests) {
  for (const segmentation::BodyRequest &request : requests)
    for (OpenLabels &open : maps_) {
      if (!request.labels || open.labels != request.labels) continue;
      open.hidden.push_back(request.label);
      if (open.labels.get() == parts_.views.labels()) parts_.views.setLabelOpacity(request.label, 0.0f);
    }
}

void WorkstationLabels::showHiddenLabels() {
  for (OpenLabels &open : maps_)
    for (const std::uint16_t label : std::exchange(open.hidden, {}))
      if (open.labels.get() == parts_.views.labels()) parts_.views.setLabelOpacity(label, 1.0f);
}

}  // namespace c3de::app
