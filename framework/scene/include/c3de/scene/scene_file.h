// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/parameter.h"
#include "c3de/core/vec.h"
#include "c3de/geometry/triangle_mesh.h"
#include "c3de/scene/materials.h"

namespace c3de::scene {

/// A parameter as it was written, and where, so that whoever checks it can point there. Whole numbers come as
/// C3DE_PARAM_I64, other numbers as F64, [x, y, z] as VEC3, text as TEXT; fitToDeclaration() makes them what is declared.
struct SceneValue {
  ParameterValue value;
  int line = 0;              ///< in SceneFile::source; 0: not from a file
  std::string overridePath;  ///< not empty: it came from `--set overridePath=…`
};

/// Scale, then rotation about x, y and z, then position.
struct ScenePlacement {
  Vec3 position_m{};
  Vec3 rotation_deg{};
  double scale = 1.0;
};

struct SceneBody {
  std::string name;
  std::filesystem::path mesh;
  geometry::LengthUnit meshUnit = geometry::LengthUnit::millimetre;
  ScenePlacement placement;
  std::vector<SceneValue> params;  ///< ids such as "material.youngs_modulus", "sampling.spacing"; each at most once
  int line = 0;
};

struct SceneObstacle {
  std::string name;
  std::filesystem::path mesh;
  geometry::LengthUnit meshUnit = geometry::LengthUnit::millimetre;
  ScenePlacement placement;
  std::vector<SceneValue> params;  ///< "friction"
  int line = 0;
};

struct SceneProbe {
  std::string name;
  std::string body;  ///< name of a body of this scene
  Vec3 at_m{};       ///< a material point
  int line = 0;
};

/// A scene as it was written. Structure is checked; what stands under world, solver, material, sampling and friction is
/// for the simulator's declarations to check.
struct SceneFile {
  std::filesystem::path source;  ///< empty when it was made in memory
  std::string title;
  std::vector<SceneValue> world;  ///< ids such as "world.gravity", "world.box.min", "solver.dt"; each at most once
  std::vector<SceneBody> bodies;
  std::vector<SceneObstacle> obstacles;
  std::vector<SceneProbe> probes;

  /// "FILE:LINE", or the title when there is no file: what an error message begins with.
  [[nodiscard]] std::string where(int line) const;
  /// The same for a value, "--set PATH" when it came from there.
  [[nodiscard]] std::string where(const SceneValue &value) const;
};

/// Reads and checks a scene. Every error (ErrorCode::input) reads "FILE:LINE: what is wrong; what is accepted"; an unknown
/// key names the nearest known one, a key that is known but not served yet is refused by name.
/// @param materials  presets that `material = "name"` refers to; null: none are known
[[nodiscard]] Expected<SceneFile> loadScene(const std::filesystem::path &path, const MaterialLibrary *materials);
/// The same for text; `source` is used in messages and its folder to find the meshes.
[[nodiscard]] Expected<SceneFile> parseScene(std::string_view text, const std::filesystem::path &source,
                                             const MaterialLibrary *materials);

/// One body made of a mesh file, with the defaults of the simulator and gravity along -y: what "open a mesh" simulates.
[[nodiscard]] SceneFile sceneForMesh(const std::filesystem::path &mesh, geometry::LengthUnit unit);

/// Applies `PATH=VALUE` of the command line, for example "body.liver.material.youngs_modulus=6e3", "solver.dt=auto",
/// "world.gravity=[0,-9.81,0]", "obstacle.floor.friction=0.2" (by name, or by number from 0). Errors (ErrorCode::usage)
/// name the nearest path.
[[nodiscard]] Expected<void> applyOverride(SceneFile &scene, std::string_view assignment, const MaterialLibrary *materials);

/// Finds the declaration of a value and turns the value into the declared type: a whole number into a number, text into a
/// choice. Errors begin with where(value): unknown (names the nearest), known to the format but not declared by this
/// simulator, or outside what is accepted. ErrorCode::usage for an override, ErrorCode::input else.
[[nodiscard]] Expected<ParameterValue> fitToDeclaration(const SceneFile &scene, const SceneValue &value,
                                                        const std::vector<ParameterDecl> &decls);

/// "m", "mm" or "cm"; the error says what is accepted.
[[nodiscard]] Expected<geometry::LengthUnit> parseLengthUnit(std::string_view name);

/// True for the file name extensions of scenes (".toml").
[[nodiscard]] bool isScenePath(const std::filesystem::path &path);

}  // namespace c3de::scene
