// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/build_scene.h"

#include "c3de/abi/imaging.h"
#include "c3de/imaging/statistics.h"
#include "c3de/session/export_image.h"
#include "c3de/session/file_kind.h"

namespace c3de::session {

Expected<void> readSceneImage(const scene::SceneFile &scene, BodySources &sources, const ProgressFn &progress) {
  if (!scene.image) return {};
  imaging::ReadOptions options;
  options.progress = progress;
  const scene::SceneImage &image = *scene.image;
  imaging::ReadOptions chosen = options;
  chosen.series = image.series;
  chosen.time = image.time;
  if (const auto read = sources.volume(image.file, chosen); !read) return failInScene(read.error(), scene, image.line);
  sources.reportNotices(image.file);
  for (const std::filesystem::path &labels : image.labels) {
    if (const auto read = sources.labels(labels, options); !read) return failInScene(read.error(), scene, image.line);
    sources.reportNotices(labels);
  }
  // Checks that the labels of fixed regions exist; presets add none that are missing.
  if (!image.still.labels.empty())
    if (auto warp = imageWarpOf(scene, sources, {}); !warp) return tl::unexpected(warp.error());
  return {};
}

Expected<void> buildScene(Session &session, c3de_object *simulator, const scene::SceneFile &scene, BodySources &sources,
                          const ProgressFn &progress, Prepared *prepared) {
  if (auto read = readSceneImage(scene, sources, progress); !read) return read;
  return session.populate(simulator, scene, progress, prepared, &sources);
}

void lendImage(Session &session, const scene::SceneFile &scene, BodySources &sources) {
  if (!scene.image || !session.plugins().isUsed(C3DE_IMAGING_ID)) return;
  const scene::SceneImage &image = *scene.image;
  imaging::ReadOptions chosen;
  chosen.series = image.series;
  chosen.time = image.time;
  if (const auto volume = sources.volume(image.file, chosen)) {
    auto stored = std::make_shared<scene::StoredImage>();
    stored->name = imageName(image.file);
    stored->volume = **volume;
    stored->range = imaging::robustRange(stored->volume);
    stored->time = image.time;
    session.images().add(std::shared_ptr<const scene::StoredImage>(std::move(stored)));
  }
  for (const std::filesystem::path &file : image.labels) {
    const auto layers = sources.labels(file, {});
    if (!layers) continue;
    for (const imaging::LabelMap &map : **layers) {
      auto stored = std::make_shared<scene::StoredLabels>();
      stored->name = imageName(file);
      stored->map = map;
      session.images().add(std::shared_ptr<const scene::StoredLabels>(std::move(stored)));
    }
  }
}

}  // namespace c3de::session
