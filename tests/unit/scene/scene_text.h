// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include "c3de/scene/scene_file.h"
#include "support/catch.h"

/// A folder with meshes that scenes of the tests can name; the parser only checks whether they exist.
inline std::filesystem::path sceneFolder() {
  const std::filesystem::path folder = testOutputFolder();
  for (const char *name : {"beam.obj", "block.obj", "model.glb"}) {
    std::ofstream file(folder / name);
    file << "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
  }
  return folder;
}

inline const c3de::scene::MaterialLibrary &presets() {
  static const auto library =
      c3de::scene::MaterialLibrary::load(std::filesystem::path(testResourcesFolder()) / "materials.toml");
  return library.value();
}

inline c3de::Expected<c3de::scene::SceneFile> parse(const std::string &text) {
  return c3de::scene::parseScene(text, sceneFolder() / "test.toml", &presets());
}

/// The message of the error, "" if there is none.
inline std::string errorOf(const std::string &text) {
  const auto scene = parse(text);
  return scene ? std::string() : scene.error().message;
}

inline const c3de::scene::SceneValue *findValue(const std::vector<c3de::scene::SceneValue> &values,
                                                const std::string &id) {
  for (const auto &value : values)
    if (value.value.id == id) return &value;
  return nullptr;
}

inline const std::string kMinimal = R"(format = 1
[[body]]
mesh = "beam.obj"
mesh_unit = "m"
)";
