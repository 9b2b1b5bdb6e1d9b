// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "c3de/abi/iface/parameter_ids.h"
#include "c3de/scene/scene_file.h"
#include "c3de/scene/toml_document.h"

namespace c3de::scene {

/// Converts TOML to a SceneFile, for files and for `--set`. Functions return false after the first error, which is
/// stored.
///
/// scene_reader.cpp reads tables, scene_reader_values.cpp their values, scene_reader_supports.cpp regions and what acts
/// there, scene_reader_tissues.cpp bodies of many tissues, scene_reader_attachments.cpp elastic layers,
/// scene_reader_contact.cpp contact pairs and probe tools, scene_reader_overrides.cpp one value of the command line.
class SceneReader {
 public:
  SceneReader(SceneFile &scene, const MaterialLibrary *materials) : scene_(scene), materials_(materials) {}

  /// A whole scene.
  [[nodiscard]] bool readScene(const TomlValue &root);
  /// One value of `--set path=value`, which is `assignment` as a whole.
  [[nodiscard]] bool readOverride(const std::string &path, const TomlValue &value, std::string_view assignment);
  [[nodiscard]] const Error &error() const { return error_; }

 private:
  bool refuse(int line, const std::string &what);
  bool refuseKey(int line, const std::string &key, const std::string &place, const std::vector<std::string> &known);

  bool tables(const TomlValue &value, const std::string &key);
  bool readWorld(const std::string &prefix, const TomlValue &table);
  bool readSimulator(const TomlValue &table);
  bool readSimulatorClass(const TomlValue &value);
  bool readBody(const TomlValue &table);
  bool readObstacle(const TomlValue &table);
  bool readProbe(const TomlValue &table);
  bool readFix(const TomlValue &table);
  bool readLoad(const TomlValue &table);
  bool readAttachment(const TomlValue &table);
  // scene_reader_contact.cpp
  bool readContact(const TomlValue &table);
  bool readContactPair(const TomlValue &table);
  bool contactPairKey(SceneContactPair &pair, const std::string &key, const TomlValue &value);
  bool readFriction(const std::string &key, const TomlValue &value, double &out);
  bool readProbeTool(const TomlValue &table);
  bool probeToolKey(SceneProbeTool &tool, const std::string &key, const TomlValue &value);
  bool readPath(const TomlValue &value, std::vector<SceneToolWaypoint> &out);
  bool checkAxes(const SceneProbeTool &tool);
  /// A path of at least `least` entries, each with time and at; `own(place, key, value)` reads the other keys.
  template <class Place, class Own>
  bool readWaypoints(const TomlValue &value, const char *accepted, std::size_t least,
                     const std::vector<std::string> &keys, std::vector<Place> &out, const Own &own);
  // scene_reader_grasp.cpp
  bool readGrasp(const TomlValue &table);
  bool graspKey(SceneGrasp &grasp, const std::string &key, const TomlValue &value);
  bool checkGrasp(const SceneGrasp &grasp);
  /// Refuses pairs of unknown names, and of two that cannot touch.
  bool checkPairs();

  bool checkBox();
  bool checkAccuracyTarget();
  /// An accuracy target on the command line replaces any other.
  bool overrideAccuracyTarget(const std::string &path, const TomlValue &value);
  /// Assigns the only body to probes, grasps, fixes and loads without one; refuses unknown body names.
  bool checkBodyNames();
  bool checkBodyName(const std::string &what, int line, std::string &body);
  /// Adds the attachments that hold whole bodies to them.
  bool attachBodies();

  bool bodyKey(SceneBody &body, const std::string &key, const TomlValue &value);
  bool obstacleKey(SceneObstacle &obstacle, const std::string &key, const TomlValue &value);
  bool probeKey(SceneProbe &probe, const std::string &key, const TomlValue &value);
  bool fixKey(SceneFix &fix, const std::string &key, const TomlValue &value);
  bool loadKey(SceneLoad &load, const std::string &key, const TomlValue &value);
  bool meshKey(const std::string &key, const TomlValue &value, std::filesystem::path &out);
  bool unitKey(const std::string &key, const TomlValue &value, std::optional<geometry::LengthUnit> &out);
  bool placementKey(ScenePlacement &placement, const std::string &key, const TomlValue &value);
  bool checkPlacement(const TomlValue &table, const ScenePlacement &placement);
  bool samplingKey(SceneBody &body, const std::string &key, const TomlValue &value);
  bool requireUnit(const TomlValue &table, const std::filesystem::path &mesh,
                   std::optional<geometry::LengthUnit> &unit);

  /// The complete value of `material`.
  bool readMaterial(std::vector<SceneValue> &params, const TomlValue &value);

  bool readRegion(const TomlValue &value, SceneRegion &out);
  bool readParts(const TomlValue &value, std::vector<ScenePart> &out);
  bool readRefinements(const TomlValue &value, std::vector<SceneRefinement> &out);
  /// A motion has at least one key of displacement, rotation, quaternion, centre and ramp.
  /// @param rotationKey  key of the rotation by angles in this context
  bool motionKey(SceneMotion &motion, const std::string &key, const std::string &rotationKey, const TomlValue &value);
  /// A unit quaternion [x, y, z, w].
  bool readQuaternion(const std::string &key, const TomlValue &value, std::optional<std::array<double, 4>> &out);

  // scene_reader_images.cpp
  bool readImage(const TomlValue &table);
  bool readFixedRegions(const TomlValue &value, SceneFixedRegions &out);
  bool volumeKey(SceneVolume &volume, const std::string &key, const TomlValue &value);
  bool checkSource(const TomlValue &table, SceneBody &body);
  // scene_reader_tissues.cpp
  bool readTissues(const TomlValue &value, SceneVolume &out);
  bool readLabelNames(const TomlValue &value, SceneTissue &out);
  bool readTissue(const TomlValue &table, SceneTissue &out);
  bool checkRule(const TomlValue &table, SceneTissue &tissue);
  bool readColour(const std::string &key, const TomlValue &value, Vec3 &out);  ///< sRGB, 0 … 1
  bool readThreshold(const TomlValue &value, std::optional<std::array<double, 2>> &out);
  /// The name of a label, or its number. @param place  prefix of the message
  bool readLabel(const std::string &place, const TomlValue &value, std::string &out);
  bool readBackground(const TomlValue &value, SceneBody &body);
  bool readSlides(const TomlValue &value, SceneVolume &out);
  bool checkTissues(const TomlValue &table, SceneBody &body);
  bool readImageFile(const std::string &key, const TomlValue &value, std::filesystem::path &out);
  bool readTime(const TomlValue &value, std::size_t &out);
  bool readSeries(const TomlValue &value, std::string &out);

  bool readName(const TomlValue &value, std::string &out);
  bool readText(const std::string &key, const TomlValue &value, std::string &out);
  bool readMatrix(const TomlValue &value, std::optional<Mat4> &out);
  bool readVec3(const std::string &key, const TomlValue &value, Vec3 &out);
  bool readNumber(const std::string &key, const std::string &accepted, const TomlValue &value, double &out);
  bool readBool(const std::string &key, const TomlValue &value, bool &out);
  /// Requires a table (or a list of tables) with exactly these keys.
  bool requireKeys(const std::string &place, const std::string &accepted, const TomlValue &value,
                   const std::vector<std::string> &keys);
  bool requireTables(const std::string &place, const std::string &accepted, const TomlValue &value);

  /// Stores the value, or the entries of the table, under ids that begin with id; replaces existing ones. The tables of
  /// a list are numbered from 1: "id1.key", "id2.key".
  bool store(std::vector<SceneValue> &values, const std::string &id, const TomlValue &value);
  void put(std::vector<SceneValue> &values, ParameterValue value, int line, bool isOptional = false);

  bool refusePath(const std::string &path);
  bool overrideBody(const std::string &rest, const TomlValue &value);
  bool overridePiece(const SceneBody &body, ScenePiece &piece, const std::string &key, const TomlValue &value);
  bool overrideSlides(SceneBody &body, const TomlValue &value);
  bool overridePart(SceneBody &body, const std::string &rest, const TomlValue &value);
  bool overrideFix(const std::string &rest, const TomlValue &value);
  bool overrideLoad(const std::string &rest, const TomlValue &value);
  bool overrideObstacle(const std::string &rest, const TomlValue &value);
  bool overrideProbe(const std::string &rest, const TomlValue &value);
  bool overrideContact(const std::string &path, const std::string &rest, const TomlValue &value);
  bool overrideProbeTool(const std::string &rest, const TomlValue &value);
  bool overrideGrasp(const std::string &rest, const TomlValue &value);

  /// An attachment that holds a whole body at its position in the scan, as parameters of the body.
  struct Attachment {
    std::string body;
    std::vector<SceneValue> params;
    int line = 0;
  };
  bool attachmentKey(SceneAttachment &attachment, const std::string &key, const TomlValue &value);
  bool readNotNegative(const std::string &key, const std::string &unit, const TomlValue &value, double &out);
  /// Refuses unknown names and incomplete attachments.
  bool checkAttachments();
  bool overrideAttachment(const std::string &rest, const TomlValue &value);

  SceneFile &scene_;
  std::vector<Attachment> attachments_;
  const MaterialLibrary *materials_;
  std::string override_;    ///< path of the current override; empty: a file
  std::string assignment_;  ///< the complete text of that override
  Error error_;
};

/// Whether the id is one of the accuracy and speed targets.
[[nodiscard]] bool isTargetKey(const std::string &id);

/// "a, b, c"
[[nodiscard]] std::string joined(const std::vector<std::string> &names);

/// The values of a material preset, ids "material.…".
[[nodiscard]] std::vector<SceneValue> valuesOf(const MaterialPreset &preset);

/// Labels with larger numbers are renumbered when their map is read, and are identified by the default names of unnamed
/// labels.
inline constexpr double kLargestLabel = 65535.0;
[[nodiscard]] bool isLabelNumber(double number);
/// "7", "label 70000"
[[nodiscard]] std::string labelText(double number);

}  // namespace c3de::scene
