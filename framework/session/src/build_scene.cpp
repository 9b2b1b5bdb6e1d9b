// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/build_scene.h"

#include "c3de/core/log.h"
#include "c3de/session/export_image.h"

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
  for (const std::string &notice : sources.takeNotices()) log(LogLevel::warn, image.file.string() + ": " + notice);
  for (const std::filesystem::path &labels : image.labels) {
    if (const auto read = sources.labels(labels, options); !read) return failInScene(read.error(), scene, image.line);
    for (const std::string &notice : sources.takeNotices()) log(LogLevel::warn, labels.string() + ": " + notice);
  }
  // That the labels which are to stay are there; presets add none that are not.
  if (!image.still.labels.empty())
    if (auto warp = imageWarpOf(scene, sources, {}); !warp) return tl::unexpected(warp.error());
  return {};
}

Expected<void> buildScene(Session &session, c3de_object *simulator, const scene::SceneFile &scene, BodySources &sources,
                          const ProgressFn &progress, Prepared *prepared) {
  if (auto read = readSceneImage(scene, sources, progress); !read) return read;
  return session.populate(simulator, scene, progress, prepared, &sources);
}

}  // namespace c3de::session
