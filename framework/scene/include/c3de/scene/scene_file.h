// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/parameter.h"
#include "c3de/core/vec.h"
#include "c3de/geometry/triangle_mesh.h"
#include "c3de/imaging/masks.h"
#include "c3de/scene/materials.h"

namespace c3de::scene {

/// A parameter as written, with its location for error messages. Integers are stored as C3DE_PARAM_I64, other numbers
/// as F64, [x, y, z] as VEC3, text as TEXT; fitToDeclaration() converts them to the declared type.
struct SceneValue {
  ParameterValue value;
  int line = 0;                  ///< in SceneFile::source; 0: not from a file
  std::string overridePath;      ///< not empty: set by `--set overridePath=…`
  bool isOptional = false;       ///< not written by the user; ignored by a simulator that does not declare it
  bool isPieceOverride = false;  ///< set for a piece alone: takes precedence over an override for its body
};

/// Scale, then rotation about x, y and z, then position.
struct ScenePlacement {
  Vec3 position_m{};
  Vec3 rotation_deg{};
  double scale = 1.0;
  std::optional<Mat4> matrix;  ///< column-major, metres to metres; replaces the other members
};

/// A region of space in material coordinates: selects what is inside a body and inside the region or on its border.
struct SceneRegion {
  enum class Kind { everywhere, box, sphere, halfSpace, voxels };
  Kind kind = Kind::everywhere;
  Vec3 a{};           ///< m: minimum corner of a box, centre of a sphere, point on a half-space's plane
  Vec3 b{};           ///< maximum corner of a box, m; normal of a half-space, of any length, pointing out of it
  double radius = 0;  ///< m
  /// Selects voxels more than half filled, placed as their body is; null until their file has been read
  std::shared_ptr<const imaging::Fill> voxels;
};

/// A rigid motion that is reached at the end of the ramp and held: rotation about x, then y, then z, then displacement.
struct SceneMotion {
  Vec3 displacement_m{};
  Vec3 rotation_deg{};
  std::optional<std::array<double, 4>> quaternion;  ///< x, y, z, w: about one axis, replaces rotation_deg
  std::optional<Vec3> centre_m;                     ///< default: the simulator chooses (centroid of the moved points)
  double ramp_s = 0.0;                              ///< >= 0
};

/// A different material in a region of a body; later parts take precedence.
struct ScenePart {
  std::string name;  ///< SceneTissue::label; empty: not from a tissue
  SceneRegion region;
  std::vector<SceneValue> params;  ///< ids "material.…"; defaults: those of the body
  int line = 0;
};

/// Finer sampling in a region of a body.
struct SceneRefinement {
  SceneRegion region;
  double spacing_m = 0.0;
  int line = 0;
};

/// A label of a label map after reading.
struct SceneLabel {
  std::size_t layer = 0;    ///< layer of the map, from 0
  std::uint16_t value = 0;  ///< in that layer
  std::string name;
};

/// The voxels of a tissue that is not defined by labels.
struct SceneTissueRule {
  std::optional<std::array<double, 2>> threshold;  ///< lowest and highest image value
  std::filesystem::path image;                     ///< for the threshold; empty: the body's volume
  double margin_mm = 0.0;                          ///< maximum distance from earlier tissues; 0: anywhere
  std::optional<SceneRegion> region;               ///< in the scan, before placement: nothing outside it
};

/// One tissue of a body, defined by labels of a label map, or by a rule for the voxels that they leave.
struct SceneTissue {
  std::string label;                ///< display name: from `wanted`, or the known name of its labels
  std::vector<std::string> wanted;  ///< names, '*' for any text, or numbers; empty: from tissues = "known"
  bool isMaterialByName = false;    ///< its material follows from the names of its labels, which are not read yet
  bool isRigid = false;             ///< it is fixed
  bool isEmpty = false;             ///< air: treated as unlabelled
  bool isShown = true;              ///< it has a surface in the 3D view
  std::optional<Vec3> colour;       ///< of that surface, sRGB, 0 … 1; none: that of its labels
  std::vector<SceneValue> params;   ///< ids "material.…"; empty where it is rigid or empty
  std::string preset;               ///< preset that the material started from; empty: none
  std::string remark;               ///< NamedTissue::remark
  std::vector<SceneLabel> labels;   ///< its labels, after the map has been read
  std::optional<SceneTissueRule> rule;
  int line = 0;
};

/// The part of a body without a label: voxels with image values between two limits.
struct SceneBackground {
  std::filesystem::path image;
  std::string series;           ///< imaging::ReadOptions::series of the file or folder
  std::size_t time = 0;         ///< index of the time point, from 0
  double from = 0.0, to = 0.0;  ///< lowest and highest value that belong to it
};

/// Friction of mesothelium on mesothelium: 0.019 ± 0.002 (pleura and peritoneum of rabbits, D'Angelo et al.,
/// Respiratory Physiology & Neurobiology 142, 2004)
inline constexpr double kSlideFriction = 0.02;

/// Settings of one piece of a cut body, which override those of the whole body.
struct ScenePiece {
  std::vector<SceneValue> params;    ///< ids "material.…", "sampling.…", "surroundings.…", "rigid", "free"
  std::optional<Vec3> velocity_m_s;  ///< initial velocity of its centre of mass
  [[nodiscard]] bool isEmpty() const { return params.empty() && !velocity_m_s; }
};

/// Labels of a body of many tissues that are cut free along their border: one piece, which slides on its neighbours.
struct SceneSlidingPart : ScenePiece {
  std::vector<std::string> names;  ///< of labels, '*' for any text, or numbers
  std::vector<SceneLabel> labels;  ///< the matching labels, after the map has been read
};

/// A body of many tissues cut into pieces, on the grid of its labels.
struct SceneBodyPieces {
  imaging::LabelMap tissues;                    ///< 1 plus the tissue index; 0: outside the body
  std::vector<std::uint8_t> pieces;             ///< per voxel; 0: the rest, otherwise 1 plus the sliding piece
  std::vector<std::vector<SceneLabel>> labels;  ///< per sliding piece
};

/// The part of an image that forms a body: a label of a label map, or image values between two limits; then mended.
struct SceneVolume {
  std::filesystem::path file;                      ///< file or DICOM folder; empty: the body has a mesh, or `mask`
  std::size_t time = 0;                            ///< index of the file's time point, from 0
  std::shared_ptr<const imaging::Mask> mask;       ///< instead of a file: picked in an open image
  std::optional<std::array<float, 3>> colour;      ///< linear RGB of the label that `mask` is from; none: no label
  std::optional<std::uint16_t> label;              ///< number of a label
  std::string labelName;                           ///< or its name; empty: not by name
  std::string series;                              ///< imaging::ReadOptions::series of the file or folder
  std::optional<std::array<double, 2>> threshold;  ///< lowest and highest value that belong to it
  /// Instead of one label: a body of many tissues. A label belongs to the first tissue that names it.
  std::vector<SceneTissue> tissues;
  bool usesKnownTissues = false;  ///< the tissues are all known label names, after the map has been read
  /// Set after reading where a tissue has a rule: the layers of the map, if labels are used, and a last layer with the
  /// results of the rules.
  std::shared_ptr<const std::vector<imaging::LabelMap>> ruled;
  bool isSettled = false;                      ///< SceneTissue::labels are resolved, and the tissues' parts exist
  std::vector<std::string> overridesOfParts;   ///< `--set` of parts that do not exist yet, in order
  std::optional<SceneBackground> background;   ///< with the material of the body
  std::vector<SceneSlidingPart> slides;        ///< still to be cut free
  ScenePiece rest;                             ///< settings of the remaining piece
  double slidingFriction = kSlideFriction;     ///< Coulomb, 0 … 10, at their borders
  std::shared_ptr<const SceneBodyPieces> cut;  ///< of a piece: the cut that produced it
  std::uint8_t piece = 0;                      ///< and its index in it
  std::optional<SceneRegion> region;           ///< in the scan, before placement: nothing outside belongs to it
  imaging::MaskCleanUp mend;
  double edgeLength_mm = 0.0;  ///< of the triangles of the skin; 0: automatic

  [[nodiscard]] bool hasTissues() const { return usesKnownTissues || !tissues.empty(); }
  /// Whether a tissue is defined by labels, so that the file has to be read as a label map.
  [[nodiscard]] bool usesLabels() const;
  /// Whether the parts of the tissues depend on names that have not been read yet.
  [[nodiscard]] bool isOpen() const;
};

/// The regions of an image that do not move with the bodies.
struct SceneFixedRegions {
  bool isAutomatic = true;             ///< bone and air, where the image or its labels identify them
  std::optional<double> above, below;  ///< image values beyond which it is fixed
  std::vector<std::string> labels;     ///< names of labels, '*' for any text, or numbers
  bool outside = false;                ///< everything outside the bodies
  friend bool operator==(const SceneFixedRegions &, const SceneFixedRegions &) = default;
};

/// The image that is displayed together with the simulation.
struct SceneImage {
  std::filesystem::path file;
  std::size_t time = 0;  ///< index of the time point, from 0
  std::vector<std::filesystem::path> labels;
  bool warp = true;         ///< it deforms with the bodies
  std::string series;       ///< imaging::ReadOptions::series of the file or folder
  double rim_mm = 10.0;     ///< distance around the bodies within which their displacement falls to zero
  SceneFixedRegions still;  ///< fixed regions
  int line = 0;
};

struct SceneBody {
  std::string name;
  std::filesystem::path mesh;  ///< empty where it is made from a volume
  SceneVolume volume;
  std::optional<geometry::LengthUnit> meshUnit = geometry::LengthUnit::millimetre;  ///< none: set by a plugin's format
  ScenePlacement placement;
  Vec3 velocity_m_s{};             ///< initial
  Vec3 angularVelocity_rad_s{};    ///< initial, about the centre of mass
  std::vector<SceneValue> params;  ///< ids such as "material.youngs_modulus", "sampling.spacing"; each at most once
  std::vector<ScenePart> parts;    ///< those of tissues that are not rigid first, in their order
  std::vector<SceneRefinement> refinements;
  std::shared_ptr<const imaging::Fill> rigidTissue;  ///< its fixed part; null: none, or not read yet
  int line = 0;
};

/// The part of a body in the region follows the motion; by default it is held fixed.
struct SceneFix {
  std::string name;  ///< may be empty
  std::string body;  ///< name of a body of this scene
  SceneRegion region;
  SceneMotion motion;
  int line = 0;
};

/// A force or a pressure on the part of a body in the region; exactly one of the two is set.
struct SceneLoad {
  std::string name;  ///< may be empty
  std::string body;  ///< name of a body of this scene
  SceneRegion region;
  std::optional<Vec3> force_N;        ///< total over the region
  std::optional<double> pressure_Pa;  ///< acts into the body
  bool follower = true;               ///< the pressure follows the surface's orientation and area
  double ramp_s = 0.0;                ///< >= 0
  int line = 0;
};

struct SceneObstacle {
  std::string name;
  std::filesystem::path mesh;
  std::optional<geometry::LengthUnit> meshUnit = geometry::LengthUnit::millimetre;  ///< none: set by a plugin's format
  ScenePlacement placement;
  std::vector<SceneValue> params;     ///< "friction"
  std::optional<SceneMotion> motion;  ///< none: it is fixed
  int line = 0;
};

struct SceneProbe {
  std::string name;
  std::string body;  ///< name of a body of this scene
  Vec3 at_m{};       ///< a material point
  int line = 0;
};

/// A material point whose position is compared with a target, or from which distances and angles are measured.
struct SceneLandmark {
  std::string name;              ///< unique
  std::string body;              ///< name of a body of this scene; empty: the one in which it lies
  Vec3 at_m{};                   ///< in the world at rest
  std::optional<Vec3> target_m;  ///< where it should be at the end
  int line = 0;
};

/// The distance of two landmarks.
struct SceneDistance {
  std::string name;                    ///< unique
  std::array<std::string, 2> between;  ///< different landmarks of this scene
  int line = 0;
};

/// The angle of three landmarks.
struct SceneAngle {
  std::string name;               ///< unique
  std::array<std::string, 3> at;  ///< different landmarks of this scene; the vertex is the second
  int line = 0;
};

/// An elastic layer between the surface of a body and another body, an obstacle, or its position in the scan. A layer
/// to the surroundings that covers the whole surface and does not tear is stored as parameters of its body instead.
struct SceneAttachment {
  std::string name;                  ///< unique
  std::array<std::string, 2> names;  ///< a body; another body, an obstacle, or kSurroundingsName
  std::optional<SceneRegion> region;
  std::optional<double> within_m;                 ///< > 0: where the distance of the surfaces is at most this
  double stiffness_Pa_m = 0.0, tearsAt_Pa = 0.0;  ///< >= 0
  std::optional<double> givenTangential_Pa_m;     ///< >= 0; none: equal to the normal stiffness
  int line = 0;
  [[nodiscard]] double tangential_Pa_m() const { return givenTangential_Pa_m.value_or(stiffness_Pa_m); }
};
/// Denotes the position of a body in the scan.
inline constexpr const char *kSurroundingsName = "surroundings";

/// Denotes the walls of the world in pairs.
inline constexpr const char *kWallsName = "box";

/// Contact of two bodies, or of a body and an obstacle, a probe tool or the walls.
struct SceneContactPair {
  std::array<std::string, 2> names;  ///< in this scene, or kWallsName; at least one is a body
  std::optional<double> friction;    ///< Coulomb, 0 … 10; none: that of the obstacle, or of all bodies
  bool enabled = true;               ///< false: they pass through each other
  bool fits = false;                 ///< pieces of one body: initial overlap of their skins is ignored
  int line = 0;
};

struct SceneToolWaypoint {
  double time_s = 0.0;  ///< >= 0; the load factor of a quasi-static solution
  Vec3 at_m{};          ///< its centre
  std::optional<Vec3> axis;
};

/// A rigid sphere or capsule that moves along a prescribed path.
struct SceneProbeTool {
  std::string name;
  double radius_m = 0.0;                ///< > 0
  double length_m = 0.0;                ///< >= 0, between the centres of the ends; 0: a sphere
  double friction = 0.3;                ///< Coulomb, 0 … 10
  std::vector<SceneToolWaypoint> path;  ///< at least two, times ascend
  int line = 0;
};

/// Prescribed position of the centre between two jaws, and their rotation since grasping, at a given time.
struct SceneGraspWaypoint {
  double time_s = 0.0;
  Vec3 at_m{};
  Vec3 turn_deg{};  ///< about x, then y, then z
};

/// Two jaws that grasp the skin of a body, close on the fold between them, and move along a prescribed path.
struct SceneGrasp {
  std::string name, body;
  Vec3 at_m{};                           ///< material point of the placed body at rest; the nearest skin is grasped
  Vec3 axis{};                           ///< from the first jaw to the second, any length but 0
  double jaw_m = 0.01;                   ///< > 0, diameter of the grasped area
  std::optional<double> givenOpening_m;  ///< >= jaw_m; none: twice jaw_m
  std::optional<double> givenClosed_m;   ///< 0 … opening_m(); none: half of that
  double forceLimit_N = 0.0;             ///< >= 0; 0: no limit
  std::vector<SceneGraspWaypoint> path;  ///< may be empty; times ascend
  int line = 0;
  [[nodiscard]] double opening_m() const { return givenOpening_m.value_or(2.0 * jaw_m); }
  [[nodiscard]] double closed_m() const { return givenClosed_m.value_or(0.5 * opening_m()); }
};

/// What was measured of a body in another state, and how the body is brought to it. One of surface, points and labels.
struct SceneMatch {
  std::string body;                          ///< name of a body of this scene
  std::filesystem::path surface;             ///< a mesh: the whole surface or a part of it
  std::filesystem::path points;              ///< a table, or fiducials of 3D Slicer
  SceneVolume labels;                        ///< file, label and time point: the surface of the label
  std::optional<geometry::LengthUnit> unit;  ///< of surface or points; none: that of the file, otherwise mm
  std::filesystem::path landmarks;           ///< where landmarks of the scene were measured, LPS mm; may be empty
  bool fitsLandmarks = false;                ///< false: they only judge the result
  double landmarkWeight = 10.0;              ///< > 0: measured points that one fitted landmark counts as
  bool isRigidFirst = true;                  ///< false: what was measured is where the body is, apart from deformation
  bool deforms = true;                       ///< false: the rigid motion only
  double noise_mm = 1.0;                     ///< > 0: standard deviation of what was measured
  int line = 0;
};

/// A scene as written. The structure is checked; the values under world, solver, view, material, sampling and friction
/// are checked later against the simulator's declarations.
struct SceneFile {
  std::filesystem::path source;  ///< empty when it was created in memory
  std::string title;
  std::string simulatorClass;  ///< id of the simulator class; empty: the only one available
  int simulatorLine = 0;
  std::optional<SceneImage> image;
  std::optional<SceneMatch> match;
  std::vector<SceneValue> world;  ///< ids such as "world.gravity", "world.box.min", "solver.dt"; each at most once
  std::vector<SceneBody> bodies;
  std::vector<SceneFix> fixes;  ///< of all bodies, in the order of the file, which is also their numbering in reports
  std::vector<SceneLoad> loads;
  std::vector<SceneObstacle> obstacles;
  std::vector<SceneProbe> probes;
  std::vector<SceneLandmark> landmarks;
  std::vector<SceneDistance> distances;
  std::vector<SceneAngle> angles;
  std::vector<SceneAttachment> attachments;
  std::vector<SceneContactPair> contactPairs;
  std::vector<SceneProbeTool> probeTools;
  std::vector<SceneGrasp> grasps;

  /// "FILE:LINE", or the title when there is no file: the prefix of error messages.
  [[nodiscard]] std::string where(int line) const;
  /// Same for a value; "--set PATH" when it was set there.
  [[nodiscard]] std::string where(const SceneValue &value) const;
};

/// Reads and checks a scene. Every error (ErrorCode::input) reads "FILE:LINE: what is wrong; what is accepted". An
/// unknown key names the nearest known one; a key that is known but not supported yet is refused by name.
/// @param materials  presets that `material = "name"` refers to; null: none are known
[[nodiscard]] Expected<SceneFile> loadScene(const std::filesystem::path &path, const MaterialLibrary *materials);
/// Same for text; `source` is used in messages, and meshes are searched in its folder.
/// @param checksFiles  false: the files that it names may be elsewhere, as those of a session
[[nodiscard]] Expected<SceneFile> parseScene(std::string_view text, const std::filesystem::path &source,
                                             const MaterialLibrary *materials, bool checksFiles = true);

/// The scene as TOML text that parseScene() reads as an equal scene. Paths are relative to `folder` where they are
/// below it, otherwise absolute. Numbers are exact, except lengths in mm that no number of mm gives: the last bit of
/// those may differ. A value of `--set` is written as if the file had it, and presets as their values.
///
/// Errors (ErrorCode::output) name what a file cannot contain: a scene without bodies, one whose label maps are
/// resolved (SceneVolume::isSettled) or cut, and values that only `--set` gives: settings of single pieces, of parts
/// before their map is read, and a material outside of tissues.
/// @param nameOfMask  the volume file of a body with SceneVolume::mask, absolute or relative to `folder`; the body is
///                    written as its label 1
[[nodiscard]] Expected<std::string> sceneText(const SceneFile &scene, const std::filesystem::path &folder,
                                              const std::function<std::string(const SceneBody &)> &nameOfMask = {});

/// One body from a mesh file, with the defaults of the simulator and gravity along -y. Used for "open a mesh".
[[nodiscard]] SceneFile sceneForMesh(const std::filesystem::path &mesh, geometry::LengthUnit unit);

/// Applies `PATH=VALUE` of the command line, for example "body.liver.material.youngs_modulus=6e3", "solver.dt=auto",
/// "world.gravity=[0,-9.81,0]", "obstacle.floor.friction=0.2", "fix.0.displacement=[0,0,0.01]",
/// "load.press.pressure=200", "attachment.0.stiffness=1e4", "contact.pair.0.friction=0.1" (by name, or by number from
/// 0); of a piece by its name, "body.abdomen.liver.material.youngs_modulus=2e3", "body.abdomen.rest.rigid=true". Errors
/// (ErrorCode::usage) name the nearest path.
[[nodiscard]] Expected<void> applyOverride(SceneFile &scene, std::string_view assignment,
                                           const MaterialLibrary *materials);

/// Converts the values of one table to their declared types: an integer becomes a number, text a choice. If two
/// alternatives for the same quantity (ParameterDecl::alternativeTo) are set, a value of a piece takes precedence over
/// an override, and an override over the file. Errors begin with where(value): unknown (names the nearest), outside the
/// accepted range, two alternatives for the same quantity, incomplete values that must be set together.
/// ErrorCode::usage for an override, otherwise ErrorCode::input.
[[nodiscard]] Expected<std::vector<ParameterValue>> fitToDeclarations(const SceneFile &scene,
                                                                      const std::vector<SceneValue> &values,
                                                                      const std::vector<ParameterDecl> &decls);

/// Assigns the only body where none is named. Errors (without a location) state what is missing or contradicts, and what
/// is accepted: not exactly one of surface, points and labels, keys without effect, an unknown body.
[[nodiscard]] Expected<void> completeMatch(const SceneFile &scene, SceneMatch &match);

/// Null: no value has this id and is true.
[[nodiscard]] const SceneValue *trueOf(const std::vector<SceneValue> &values, std::string_view id);

/// Sets the material of a tissue from the name of its labels, or marks it rigid or empty. False: the name is unknown,
/// or its preset is not among the materials.
[[nodiscard]] bool setMaterialFromName(SceneTissue &tissue, std::string_view label, const MaterialLibrary &materials);
/// Creates the parts of a body from its tissues, none of which may be open. Errors (ErrorCode::input, without a
/// location): all are rigid or empty.
[[nodiscard]] Expected<void> makeTissueParts(SceneBody &body);

/// Names of the sliding pieces of a body: the name of the body, a dot, and the first of the piece's label names.
[[nodiscard]] std::vector<std::string> namesOfPieces(const SceneBody &body);
/// The name for the rest of a body with slides: "abdomen.rest", with a number where a label has that name. After the
/// cut the rest has the name of the body.
[[nodiscard]] std::string nameOfRest(const SceneBody &body);
/// A sliding piece as a separate body with the same values, placement and tissues. Its own settings override those of
/// the body; its own material overrides that of all tissues. Only its own settings hold it.
[[nodiscard]] SceneBody bodyOfPiece(const SceneBody &body, std::size_t slide);
/// Same for the rest of a body with slides, which is held by whatever holds the body.
[[nodiscard]] SceneBody bodyOfRest(const SceneBody &body);
/// Names of all bodies in build order, each followed by the names of its pieces.
[[nodiscard]] std::vector<std::string> namesOfBodies(const SceneFile &scene);
/// The names that a scene may refer to: these, and the rest of each body with slides.
[[nodiscard]] std::vector<std::string> referableNames(const SceneFile &scene);

/// "m", "mm" or "cm"; the error states what is accepted.
[[nodiscard]] Expected<geometry::LengthUnit> parseLengthUnit(std::string_view name);

/// Whether the file name has a scene extension (".toml").
[[nodiscard]] bool isScenePath(const std::filesystem::path &path);

}  // namespace c3de::scene
