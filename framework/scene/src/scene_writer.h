// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "c3de/scene/scene_file.h"
#include "c3de/scene/toml_document.h"
#include "scene_reader.h"

namespace c3de::scene {

/// Converts a SceneFile to TOML, the inverse of SceneReader. The keys are those of scene_tables.cpp. After the first
/// error, which is stored, the result is incomplete.
///
/// scene_writer.cpp writes scenes and bodies, scene_writer_values.cpp values, toml_text.cpp the text.
class SceneWriter {
 public:
  /// None: the key is left out.
  using Written = std::optional<TomlValue>;

  SceneWriter(const std::filesystem::path &folder, std::function<std::string(const SceneBody &)> nameOfMask);

  [[nodiscard]] TomlValue writeScene(const SceneFile &scene);
  [[nodiscard]] const std::optional<Error> &error() const { return error_; }

  Written refuse(const std::string &what);
  /// Whether SceneReader accepts a value, called with a reader; stores its error.
  template <class Read>
  bool accepts(const Read &read) {
    SceneFile scratch;
    scratch.title = place_;
    SceneReader reader(scratch, nullptr);
    if (read(reader)) return true;
    if (!error_) error_ = Error{ErrorCode::output, reader.error().message};
    return false;
  }

  /// Writers of a value; `key` is how messages name it.
  Written write(const std::string &key, const std::string &text);
  Written write(const std::string &key, bool flag);
  Written write(const std::string &key, double number);
  Written write(const std::string &key, std::size_t number);
  Written write(const std::string &key, const Vec3 &vector);
  Written write(const std::string &key, const Mat4 &matrix);
  Written write(const std::string &key, const std::array<double, 2> &range);
  Written write(const std::string &key, const std::array<double, 4> &quaternion);
  Written write(const std::string &key, const std::array<std::string, 2> &names);
  Written write(const std::string &key, const std::array<std::string, 3> &names);
  Written write(const std::string &key, const std::vector<std::string> &names);
  Written write(const std::string &key, const std::filesystem::path &path);
  Written write(const std::string &key, const geometry::LengthUnit &unit);
  Written write(const std::string &key, const SceneRegion &region);
  Written write(const std::string &key, const std::vector<ScenePart> &parts);
  Written write(const std::string &key, const std::vector<SceneRefinement> &refinements);
  Written write(const std::string &key, const imaging::MaskCleanUp &mend);
  Written write(const std::string &key, const SceneFixedRegions &still);
  Written write(const std::string &key, const std::vector<SceneToolWaypoint> &path);
  Written write(const std::string &key, const std::vector<SceneGraspWaypoint> &path);
  /// The value with this id, or a table of those whose ids begin with it and a dot.
  Written write(const std::string &id, const std::vector<SceneValue> &values);

  /// Inverses of the readers of the same keys.
  Written materialOf(const std::string &key, const SceneBody &body);
  Written partsOf(const std::string &key, const SceneBody &body);
  Written samplingOf(const std::string &key, const SceneBody &body);
  Written labelOf(const std::string &key, const SceneVolume &volume);
  Written tissuesOf(const std::string &key, const SceneBody &body);
  Written backgroundOf(const std::string &key, const SceneBody &body);
  Written materialOfBackground(const std::string &key, const SceneBody &body);
  Written slidesOf(const std::string &key, const SceneVolume &volume);
  Written labelNamesOf(const std::string &key, const SceneTissue &tissue);
  Written materialOfTissue(const std::string &key, const SceneTissue &tissue);
  Written nameOfRule(const std::string &key, const SceneTissue &tissue);
  Written labelFileOf(const std::string &key, const SceneImage &image);

 private:
  template <class Table>
  TomlValue writeFields(const Fields<Table> &fields, const Table &table);
  template <class Table>
  TomlValue writeTable(const SceneTable<Table> &table, const SceneFile &scene);
  template <class Table>
  Written writePath(const Fields<Table> &fields, const std::vector<Table> &path);
  /// With an entry for optional values.
  Written writeMaterial(const std::string &key, const std::vector<SceneValue> &params);
  void put(TomlValue &table, const std::string &rest, const SceneValue &value);
  void writeWorld(const std::vector<SceneValue> &world, TomlValue &root);
  /// The parameters of bodies and pieces that are attachments of all of their surface.
  void writeLayers(const SceneFile &scene, TomlValue &attachments);
  void writeLayer(const std::string &body, const std::vector<SceneValue> &params, TomlValue &attachments);

  /// The element as a file can say it: without what has no effect.
  SceneBody simplified(const SceneBody &body);
  SceneFix simplified(const SceneFix &fix);
  SceneObstacle simplified(const SceneObstacle &obstacle);
  SceneAttachment simplified(const SceneAttachment &attachment);
  SceneContactPair simplified(const SceneContactPair &pair);
  template <class Table>
  const Table &simplified(const Table &table) {
    return table;
  }
  void checkBody(const SceneBody &body);

  std::filesystem::path folder_;
  std::function<std::string(const SceneBody &)> nameOfMask_;
  std::string place_ = "scene";  ///< prefix of messages: what is written
  std::optional<Error> error_;
};

}  // namespace c3de::scene
