// SPDX-License-Identifier: Apache-2.0
#include "commands/run_details.h"

#include <fmt/format.h>

#include "c3de/core/path_text.h"
#include "c3de/render/picture_file.h"
#include "c3de/scene/scene_file.h"

namespace c3de::app {

std::string describe(const scene::SceneFile &scene, const RunOptions &options) {
  std::string text = fmt::format("{}: '{}'", pathText(options.scene), scene.title);
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    text += (i == 0 ? (scene.bodies.size() == 1 ? ", body " : ", bodies ") : ", ") + scene.bodies[i].name;
  for (const std::string &assignment : options.overrides) text += "; --set " + assignment;
  return text;
}

std::string describe(const Preparation &took) {
  return fmt::format(
      "bodies are built: reading {:.3g} s, masks {:.3g} s, surfaces {:.3g} s, fills {:.3g} s, points {:.3g} s",
      took.reading_s, took.masks_s, took.surfaces_s, took.fills_s, took.bodies_s);
}

Expected<void> checkPictureFormat(const std::filesystem::path &file) {
  if (file.empty() || render::isPictureFile(file)) return {};
  return fail(ErrorCode::usage, "--screenshot " + pathText(file) + ": '" + pathText(file.extension()) +
                                    "' cannot be written; accepted: " + render::kPictureExtensions);
}

}  // namespace c3de::app
