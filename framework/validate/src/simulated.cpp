// SPDX-License-Identifier: Apache-2.0
#include "simulated.h"

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "c3de/session/body_sources.h"
#include "c3de/session/build_scene.h"

namespace c3de::validate {
namespace {

/// A falling cube of 10 cm; every simulator must support it. Gravity is omitted for a simulator without it.
constexpr const char *kScene = R"(format = 1
title = "Cube"

[[body]]
name = "cube"
mesh = "cube.obj"
)";
constexpr const char *kGravity = "\n[world]\ngravity = [0.0, -9.81, 0.0]\n";
constexpr const char *kCube =
    "# UNITS=mm\nv -50 -50 -50\nv 50 -50 -50\nv 50 50 -50\nv -50 50 -50\nv -50 -50 50\nv 50 -50 50\nv 50 50 50\nv -50 "
    "50 50\n"
    "f 1 4 3\nf 1 3 2\nf 5 6 7\nf 5 7 8\nf 1 2 6\nf 1 6 5\nf 2 3 7\nf 2 7 6\nf 3 4 8\nf 3 8 7\nf 4 1 5\nf 4 5 8\n";

}  // namespace

std::string Simulated::build(const Trial &trial, const std::string &classId) {
  std::error_code ignored;
  std::filesystem::create_directories(trial.folder, ignored);
  std::ofstream(trial.folder / "cube.obj") << kCube;
  session::SessionOptions options;
  options.searchPlugins = false;
  options.threads = 2;
  options.pluginFiles = trial.companions;
  options.pluginFiles.push_back(trial.plugin);
  auto made = session::Session::create(options);
  if (!made) return made.error().message;
  session_ = std::move(*made);
  auto object = session_->createSimulator(classId);
  if (!object) return object.error().message;
  object_ = session::ObjectRef(*object);
  auto found = session::simulatorTable(object_.get());
  if (!found) return found.error().message;
  table = *found;
  if (const auto declared = session::simulatorDeclarations(object_.get(), C3DE_SIM_SCOPE_WORLD))
    hasGravity =
        std::any_of(declared->begin(), declared->end(), [](const auto &one) { return one.id == "world.gravity"; });
  std::ofstream(trial.folder / "cube.toml") << kScene << (hasGravity ? kGravity : "");
  const auto scene = scene::loadScene(trial.folder / "cube.toml", &session_->materials());
  if (!scene) return scene.error().message;
  session::BodySources sources;
  if (const auto built = session::buildScene(*session_, object_.get(), *scene, sources, {}); !built)
    return built.error().message;
  return {};
}

std::vector<std::string> simulatorClasses(const Trial &trial) {
  const LoadedPlugin loaded(trial, TrialHost::Serves::headless);
  std::vector<std::string> own;
  for (const plugin_host::ClassInfo &cls : loaded.host->host->classes())
    if (cls.plugin == loaded.id() &&
        std::find(cls.interfaces.begin(), cls.interfaces.end(), C3DE_IFACE_SIMULATOR_ID) != cls.interfaces.end())
      own.push_back(cls.id);
  return own;
}

}  // namespace c3de::validate
