// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "c3de/abi/iface/parameter_ids.h"
#include "c3de/scene/scene_file.h"
#include "c3de/scene/toml_document.h"

namespace c3de::scene {

template <class Table>
struct Fields;
template <class Table>
struct SceneTable;

/// Converts TOML to a SceneFile, for files and for `--set`. Functions return false after the first error, which is
/// stored.
///
/// scene_tables.cpp lists the keys of all tables, scene_fields.h reads them. scene_reader.cpp reads scenes and checks
/// names, scene_reader_values.cpp reads values, scene_reader_supports.cpp regions and what acts there,
/// scene_reader_images.cpp images, scene_reader_tissues.cpp bodies of many tissues, scene_reader_attachments.cpp
/// elastic layers, scene_reader_contact.cpp contact pairs, scene_reader_measurements.cpp landmarks,
/// scene_reader_match.cpp what was measured,
/// scene_reader_overrides.cpp one value of the command line.
class SceneReader {
 public:
  SceneReader(SceneFile &scene, const MaterialLibrary *materials, bool checksFiles = true)
      : scene_(scene), materials_(materials), checksFiles_(checksFiles) {}

  /// A whole scene.
  [[nodiscard]] bool readScene(const TomlValue &root);
  /// One value of `--set path=value`, which is `assignment` as a whole.
  [[nodiscard]] bool readOverride(const std::string &path, const TomlValue &value, std::string_view assignment);
  [[nodiscard]] const Error &error() const { return error_; }
  [[nodiscard]] bool isOverride() const { return !override_.empty(); }

  bool refuse(int line, const std::string &what);
  bool refuseKey(int line, const std::string &key, const std::string &place, const std::vector<std::string> &known);

  /// Readers of a value; `key` is how messages name it.
  bool read(const std::string &key, const TomlValue &value, std::string &out);
  bool read(const std::string &key, const TomlValue &value, bool &out);
  bool read(const std::string &key, const TomlValue &value, Vec3 &out);
  bool read(const std::string &key, const TomlValue &value, Mat4 &out);
  bool read(const std::string &key, const TomlValue &value, std::array<double, 2> &out);  ///< a range of image values
  bool read(const std::string &key, const TomlValue &value, std::array<double, 4> &out);  ///< a unit quaternion
  bool read(const std::string &key, const TomlValue &value, std::size_t &out);            ///< a time point
  bool read(const std::string &key, const TomlValue &value, std::filesystem::path &out);  ///< an image
  bool read(const std::string &key, const TomlValue &value, geometry::LengthUnit &out);
  bool read(const std::string &key, const TomlValue &value, SceneRegion &out);
  bool read(const std::string &key, const TomlValue &value, std::vector<ScenePart> &out);
  bool read(const std::string &key, const TomlValue &value, std::vector<SceneRefinement> &out);
  bool read(const std::string &key, const TomlValue &value, imaging::MaskCleanUp &out);
  bool read(const std::string &key, const TomlValue &value, SceneFixedRegions &out);
  bool read(const std::string &key, const TomlValue &value, std::vector<SceneToolWaypoint> &out);
  bool read(const std::string &key, const TomlValue &value, std::vector<SceneGraspWaypoint> &out);
  /// Stores the value, or the entries of the table, under ids that begin with id; replaces existing ones. The tables of
  /// a list are numbered from 1: "id1.key", "id2.key".
  bool read(const std::string &id, const TomlValue &value, std::vector<SceneValue> &out);
  bool readNumber(const std::string &key, const std::string &accepted, const TomlValue &value, double &out);
  bool readName(const std::string &key, const TomlValue &value, std::string &out);
  bool readMesh(const std::string &key, const TomlValue &value, std::filesystem::path &out);
  /// A file that exists. @param accepted  "a mesh file"
  bool readFile(const std::string &key, const char *accepted, const TomlValue &value, std::filesystem::path &out);
  bool readSeries(const std::string &key, const TomlValue &value, std::string &out);
  bool readColour(const std::string &key, const TomlValue &value, Vec3 &out);  ///< sRGB, 0 … 1
  bool readMaterial(const std::string &key, const TomlValue &value, std::vector<SceneValue> &params);
  bool readSampling(const std::string &key, const TomlValue &value, SceneBody &body);
  bool readSamplingKey(SceneBody &body, const std::string &key, const TomlValue &value);
  bool readLabelOf(const std::string &key, const TomlValue &value, SceneVolume &out);
  bool readTissues(const std::string &key, const TomlValue &value, SceneVolume &out);
  bool readBackground(const std::string &key, const TomlValue &value, SceneBody &body);
  bool readSlides(const std::string &key, const TomlValue &value, SceneVolume &out);
  bool readLabelNames(const std::string &key, const TomlValue &value, SceneTissue &out);
  /// The name of a label, or its number. @param place  prefix of the message
  bool readLabel(const std::string &place, const TomlValue &value, std::string &out);

  /// Checks of the keys of a table together.
  bool checkBody(const TomlValue &keys, SceneBody &body);
  bool checkFix(const TomlValue &keys, SceneFix &fix);
  bool checkLoad(const TomlValue &keys, SceneLoad &load);
  bool checkObstacle(const TomlValue &keys, SceneObstacle &obstacle);
  bool checkPair(const TomlValue &keys, SceneContactPair &pair);
  bool checkAxes(const SceneProbeTool &tool);
  bool checkJaws(const SceneGrasp &grasp);

 private:
  template <class Table>
  bool readField(const Fields<Table> &fields, const std::string &key, const TomlValue &value, Table &out);
  template <class Table>
  bool readFields(const Fields<Table> &fields, const TomlValue &keys, Table &out);
  template <class Table>
  bool readTable(const SceneTable<Table> &table, const TomlValue &keys);
  bool readTable(const SceneTable<SceneAttachment> &table, const TomlValue &keys);
  template <class Table>
  bool readTables(const SceneTable<Table> &table, const TomlValue &value);
  template <class Waypoint>
  bool readPath(const Fields<Waypoint> &fields, const TomlValue &value, std::size_t least, std::vector<Waypoint> &out);

  bool readWorld(const std::string &prefix, const TomlValue &table);
  bool readSimulator(const TomlValue &table);
  bool readSimulatorClass(const TomlValue &value);
  bool readContact(const TomlValue &table);
  bool readImage(const TomlValue &table);
  bool readMatch(const TomlValue &table);
  /// Once all bodies are known.
  bool checkMatch();
  bool readTissue(const TomlValue &table, SceneTissue &out);

  bool readOptional(const TomlValue &value, std::vector<SceneValue> &params);

  bool checkBox();
  bool checkAccuracyTarget();
  /// Assigns the only body to probes, grasps, fixes and loads without one; refuses unknown body names.
  bool checkBodyNames();
  bool checkBodyName(const std::string &what, int line, std::string &body);
  /// Refuses unknown names of bodies and landmarks.
  bool checkMeasurements();
  template <std::size_t N>
  bool checkLandmarkNames(const std::string &what, int line, const std::array<std::string, N> &names);
  bool checkPlacement(const TomlValue &table, const ScenePlacement &placement);
  bool checkSource(const TomlValue &table, SceneBody &body);
  bool checkTissues(const TomlValue &table, SceneBody &body);
  bool checkRule(const TomlValue &table, SceneTissue &tissue);
  bool requireUnit(const TomlValue &table, const std::filesystem::path &mesh,
                   std::optional<geometry::LengthUnit> &unit);
  /// Requires a table (or a list of tables) with exactly these keys.
  bool requireKeys(const std::string &place, const std::string &accepted, const TomlValue &value,
                   const std::vector<std::string> &keys);
  bool requireTables(const std::string &place, const std::string &accepted, const TomlValue &value);
  void put(std::vector<SceneValue> &values, ParameterValue value, int line, bool isOptional = false);
  /// Refuses pairs of unknown names, and of two that cannot touch.
  bool checkPairs();
  /// Refuses unknown names and incomplete attachments.
  bool checkAttachments();
  /// Adds the attachments that hold whole bodies to them.
  bool attachBodies();

  bool refusePath(const std::string &path);
  /// An accuracy target on the command line replaces any other.
  bool overrideAccuracyTarget(const std::string &path, const TomlValue &value);
  bool overrideBody(const std::string &rest, const TomlValue &value);
  bool overridePiece(const SceneBody &body, ScenePiece &piece, const std::string &key, const TomlValue &value);
  bool overrideSlides(SceneBody &body, const TomlValue &value);
  bool overridePart(SceneBody &body, const std::string &rest, const TomlValue &value);
  bool overrideMatch(const std::string &key, const TomlValue &value);
  bool overrideContact(const std::string &path, const std::string &rest, const TomlValue &value);
  template <class Table>
  bool overrideElement(const SceneTable<Table> &table, const std::string &rest, const TomlValue &value);
  bool replaceLoad(SceneLoad &load, const std::string &key);

  /// An attachment that holds a whole body at its position in the scan, as parameters of the body.
  struct Attachment {
    std::string body;
    std::vector<SceneValue> params;
    int line = 0;
  };

  SceneFile &scene_;
  std::vector<Attachment> attachments_;
  const MaterialLibrary *materials_;
  bool checksFiles_;
  std::string override_;    ///< path of the current override; empty: a file
  std::string assignment_;  ///< the complete text of that override
  Error error_;
};

/// Whether the id is one of the accuracy and speed targets.
[[nodiscard]] bool isTargetKey(const std::string &id);

/// "a, b, c"
[[nodiscard]] std::string joined(const std::vector<std::string> &names);
/// "did you mean 'b'? accepted: a, b, c"
[[nodiscard]] std::string suggestion(const std::string &name, const std::vector<std::string> &known);
/// The shapes of regions, for messages.
[[nodiscard]] std::string acceptedRegions();

/// The values of a material preset, ids "material.…".
[[nodiscard]] std::vector<SceneValue> valuesOf(const MaterialPreset &preset);

/// A table in a material: its values are SceneValue::isOptional.
inline constexpr const char *kOptionalKey = "optional";

/// Labels with larger numbers are renumbered when their map is read, and are identified by the default names of unnamed
/// labels.
inline constexpr double kLargestLabel = 65535.0;
[[nodiscard]] bool isLabelNumber(double number);
/// "7", "label 70000"
[[nodiscard]] std::string labelText(double number);

}  // namespace c3de::scene
