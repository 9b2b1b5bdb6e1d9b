// SPDX-License-Identifier: Apache-2.0
#include "c3de/scene/scene_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>

#include "c3de/core/text.h"
#include "c3de/scene/toml_document.h"
#include "scene_reader.h"

namespace c3de::scene {
namespace {

/// Parses the text after `=` on the command line: TOML if valid, otherwise a plain number or text without quotes.
TomlValue parseOverrideValue(std::string_view text) {
  const auto toml = parseToml("value = " + std::string(text), "--set");
  if (toml && toml->entries.size() == 1 && toml->entries.front().key == "value") {
    TomlValue value = toml->entries.front().value;
    if (value.kind != TomlValue::Kind::date) return value;
  }
  TomlValue value;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value.num);
  if (code == std::errc() && end == text.data() + text.size()) {
    value.kind = TomlValue::Kind::number;
  } else {
    value.kind = TomlValue::Kind::text;
    value.text = text;
  }
  return value;
}

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
}

}  // namespace

std::string SceneFile::where(int line) const {
  if (source.empty()) return title.empty() ? "scene" : title;
  return line > 0 ? source.string() + ":" + std::to_string(line) : source.string();
}

std::string SceneFile::where(const SceneValue &value) const {
  return value.overridePath.empty() ? where(value.line) : "--set " + value.overridePath;
}

Expected<SceneFile> loadScene(const std::filesystem::path &path, const MaterialLibrary *materials) {
  const auto text = readTextFile(path);
  if (!text) return tl::unexpected(text.error());
  return parseScene(*text, path, materials);
}

Expected<SceneFile> parseScene(std::string_view text, const std::filesystem::path &source,
                               const MaterialLibrary *materials, bool checksFiles) {
  const auto root = parseToml(text, source.string());
  if (!root) return tl::unexpected(root.error());
  SceneFile scene;
  scene.source = source;
  SceneReader reader(scene, materials, checksFiles);
  if (!reader.readScene(*root)) return tl::unexpected(reader.error());
  return scene;
}

SceneFile sceneForMesh(const std::filesystem::path &mesh, geometry::LengthUnit unit) {
  SceneFile scene;
  scene.title = mesh.stem().string();
  SceneBody body;
  body.name = scene.title;
  body.mesh = mesh;
  body.meshUnit = unit;
  scene.bodies.push_back(std::move(body));
  SceneValue gravity;
  gravity.value.id = C3DE_PARAM_ID_GRAVITY;
  gravity.value.type = C3DE_PARAM_VEC3;
  gravity.value.vec = {0.0, -9.81, 0.0};
  scene.world.push_back(std::move(gravity));
  return scene;
}

Expected<void> applyOverride(SceneFile &scene, std::string_view assignment, const MaterialLibrary *materials) {
  const std::size_t equals = assignment.find('=');
  const std::string path(trimmed(assignment.substr(0, equals)));
  if (equals == std::string_view::npos || path.empty())
    return fail(ErrorCode::usage, displayMessage("--set " + std::string(assignment) +
                                                 ": accepted: PATH=VALUE, for example solver.dt=1e-3"));
  // Read into a copy, so that a refused value leaves the scene unchanged.
  SceneFile changed = scene;
  SceneReader reader(changed, materials);
  if (!reader.readOverride(path, parseOverrideValue(trimmed(assignment.substr(equals + 1))), assignment))
    return tl::unexpected(reader.error());
  scene = std::move(changed);
  return {};
}

namespace {

ErrorCode codeOf(const SceneValue &value) { return value.overridePath.empty() ? ErrorCode::input : ErrorCode::usage; }

Expected<ParameterValue> fitted(const SceneFile &scene, const SceneValue &value,
                                const std::vector<ParameterDecl> &decls) {
  const std::string where = scene.where(value) + ": ";
  const auto decl = findParameter(decls, value.value.id);
  if (!decl) return fail(codeOf(value), where + decl.error().message);
  ParameterValue fitted = value.value;
  const bool isAuto = ((*decl)->flags & C3DE_PARAM_AUTO) != 0 && fitted.text == "auto";
  if (fitted.type == C3DE_PARAM_I64 && (*decl)->type == C3DE_PARAM_F64) fitted.type = C3DE_PARAM_F64;
  if (fitted.type == C3DE_PARAM_F64 && (*decl)->type == C3DE_PARAM_I64 && fitted.num == std::floor(fitted.num))
    fitted.type = C3DE_PARAM_I64;
  if (fitted.type == C3DE_PARAM_TEXT && (*decl)->type == C3DE_PARAM_CHOICE && !isAuto) fitted.type = C3DE_PARAM_CHOICE;
  const auto good = checkParameter(**decl, fitted);
  if (!good) return fail(codeOf(value), where + good.error().message);
  return fitted;
}

const SceneValue *valueOf(const std::vector<SceneValue> &values, const std::string &id) {
  const auto found = std::find_if(values.begin(), values.end(), [&](const SceneValue &v) { return v.value.id == id; });
  return found == values.end() ? nullptr : &*found;
}

/// Of two alternative values for the same quantity, the one with the higher rank counts.
int rankOf(const SceneValue &value) { return value.isPieceOverride ? 2 : value.overridePath.empty() ? 0 : 1; }

/// "material.prony1." for "material.prony1.share".
std::string tableOf(const std::string &id) { return id.substr(0, id.rfind('.') + 1); }

}  // namespace

Expected<std::vector<ParameterValue>> fitToDeclarations(const SceneFile &scene, const std::vector<SceneValue> &values,
                                                        const std::vector<ParameterDecl> &decls) {
  std::set<std::string> superseded;
  for (const ParameterDecl &decl : decls) {
    const SceneValue *said = valueOf(values, decl.id);
    if (said == nullptr || decl.alternativeTo.empty()) continue;
    const SceneValue *other = valueOf(values, decl.alternativeTo);
    if (other == nullptr) continue;
    if (rankOf(*said) == rankOf(*other))
      return fail(codeOf(*said), scene.where(*said) + ": '" + decl.id + "' and '" + decl.alternativeTo +
                                     "' specify the same quantity; accepted: one of them");
    superseded.insert(rankOf(*said) < rankOf(*other) ? decl.id : decl.alternativeTo);
  }
  for (const SceneValue &value : values) {
    const auto decl = findParameter(decls, value.value.id);
    if (!decl || ((*decl)->flags & C3DE_PARAM_TOGETHER) == 0) continue;
    for (const ParameterDecl &other : decls)
      if ((other.flags & C3DE_PARAM_TOGETHER) != 0 && tableOf(other.id) == tableOf((*decl)->id) &&
          valueOf(values, other.id) == nullptr)
        return fail(codeOf(value), scene.where(value) + ": '" + value.value.id + "' without '" + other.id +
                                       "'; accepted: both or neither");
  }
  std::vector<ParameterValue> all;
  for (const SceneValue &value : values) {
    if (superseded.contains(value.value.id) || (value.isOptional && !findParameter(decls, value.value.id))) continue;
    auto one = fitted(scene, value, decls);
    if (!one) return tl::unexpected(one.error());
    all.push_back(std::move(*one));
  }
  return all;
}

const SceneValue *trueOf(const std::vector<SceneValue> &values, std::string_view id) {
  const auto found = std::find_if(values.begin(), values.end(), [&](const SceneValue &value) {
    return value.value.id == id && value.value.num != 0.0;
  });
  return found == values.end() ? nullptr : &*found;
}

Expected<geometry::LengthUnit> parseLengthUnit(std::string_view name) {
  if (name == "m") return geometry::LengthUnit::metre;
  if (name == "mm") return geometry::LengthUnit::millimetre;
  if (name == "cm") return geometry::LengthUnit::centimetre;
  return fail(ErrorCode::usage, "unknown unit \"" + std::string(name) + "\"; accepted: \"m\", \"mm\", \"cm\"");
}

bool isScenePath(const std::filesystem::path &path) { return path.extension() == ".toml"; }

}  // namespace c3de::scene
