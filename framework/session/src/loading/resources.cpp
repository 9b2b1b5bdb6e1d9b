// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/resources.h"
#include "c3de/core/file_path.h"

#include <array>

#include "c3de/core/embedding.h"
#include "c3de/scene/scene_file.h"

namespace c3de::session {
namespace {

/// The scan that scenes/brain_living.toml reads.
constexpr const char *kHeadScan = "/usr/share/mricron/templates/ch2.nii.gz";

}  // namespace

Expected<std::filesystem::path> findResource(const std::filesystem::path &name) {
  const std::filesystem::path programFolder = modulePath().parent_path();
  const std::array folders{programFolder / ".." / "share" / "c3de", programFolder / C3DE_SOURCE_RESOURCES};
  std::string searched;
  for (const std::filesystem::path &folder : folders) {
    const std::filesystem::path candidate = normalPath(folder / name);
    std::error_code code;
    if (std::filesystem::exists(candidate, code)) return candidate;
    searched += (searched.empty() ? "" : ", ") + candidate.string();
  }
  return fail(ErrorCode::input, "the resource '" + name.generic_string() + "' is missing; looked for: " + searched);
}

Expected<scene::MaterialLibrary> loadMaterialPresets() {
  const auto file = findResource("materials.toml");
  if (!file) return tl::unexpected(file.error());
  return scene::MaterialLibrary::load(*file);
}

Expected<DefaultScene> findDefaultScene() {
  std::string why;
  if (const auto head = findResource("scenes/brain_living.toml"); !head)
    why = head.error().message;
  else if (const auto materials = loadMaterialPresets(); !materials)
    why = materials.error().message;
  else if (const auto scene = scene::loadScene(*head, &*materials); !scene)
    why = scene.error().message;
  else
    return DefaultScene{*head, ""};
  auto organ = findResource("scenes/first_light.toml");
  if (!organ) return tl::unexpected(organ.error());
  std::error_code code;
  const bool isInstalled = std::filesystem::exists(kHeadScan, code);
  return DefaultScene{std::move(*organ),
                      "The scene of a head cannot be opened (" + why + ")" +
                          (isInstalled ? "" : "; the Debian package mricron-data contains its scan")};
}

}  // namespace c3de::session
