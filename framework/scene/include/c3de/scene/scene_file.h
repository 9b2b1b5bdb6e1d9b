// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
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

/// A parameter as it was written, and where, so that whoever checks it can point there. Whole numbers come as
/// C3DE_PARAM_I64, other numbers as F64, [x, y, z] as VEC3, text as TEXT; fitToDeclaration() makes them what is
/// declared.
struct SceneValue {
  ParameterValue value;
  int line = 0;              ///< in SceneFile::source; 0: not from a file
  std::string overridePath;  ///< not empty: it came from `--set overridePath=…`
  bool isOptional = false;   ///< a simulator that does not declare it goes without; nobody has written it
  bool isOfPiece = false;    ///< said of a piece alone: it counts more than what an override says of its body
};

/// Scale, then rotation about x, y and z, then position.
struct ScenePlacement {
  Vec3 position_m{};
  Vec3 rotation_deg{};
  double scale = 1.0;
  std::optional<Mat4> matrix;  ///< column-major, m from the mesh as m, in the place of the others
};

/// A part of space in material coordinates: what of a body lies inside or on the border is meant.
struct SceneRegion {
  enum class Kind { everywhere, box, sphere, halfSpace, voxels };
  Kind kind = Kind::everywhere;
  Vec3 a{};           ///< m: min of a box, centre of a sphere, point of a half-space
  Vec3 b{};           ///< max of a box, m; normal of a half-space, of any length: the side it points away from
  double radius = 0;  ///< m
  /// Where more than half of a voxel is filled, placed as its body is; null until the file that it is in has been read
  std::shared_ptr<const imaging::Fill> voxels;
};

/// A rigid motion that is reached at the end of the ramp and kept: rotation about x, then y, then z, then displacement.
struct SceneMotion {
  Vec3 displacement_m{};
  Vec3 rotation_deg{};
  std::optional<std::array<double, 4>> quaternion;  ///< x, y, z, w: about one axis, in the place of rotation_deg
  std::optional<Vec3> centre_m;                     ///< default: for the simulator to choose (centroid of what moves)
  double ramp_s = 0.0;                              ///< >= 0
};

/// Another material in a region of a body; later ones win.
struct ScenePart {
  std::string name;  ///< SceneTissue::label; empty: of no tissue
  SceneRegion region;
  std::vector<SceneValue> params;  ///< ids "material.…"; what is missing is as in the body
  int line = 0;
};

/// Finer sampling in a region of a body.
struct SceneRefinement {
  SceneRegion region;
  double spacing_m = 0.0;
  int line = 0;
};

/// A label of a label map that has been read.
struct SceneLabel {
  std::size_t layer = 0;    ///< of the map, from 0
  std::uint16_t value = 0;  ///< in that layer
  std::string name;
};

/// Which voxels a tissue has where no label says it.
struct SceneTissueRule {
  std::optional<std::array<double, 2>> threshold;  ///< lowest and highest value of an image
  std::filesystem::path image;                     ///< of the threshold; empty: the volume of the body
  double margin_mm = 0.0;                          ///< within this of tissues before it; 0: anywhere
  std::optional<SceneRegion> region;               ///< of the scan, before placement: nothing outside of it
};

/// Labels of a label map, or what a rule takes of what they leave, that are one tissue of a body.
struct SceneTissue {
  std::string label;                ///< for people: what `wanted` says; what its labels are known as, where it is that
  std::vector<std::string> wanted;  ///< names, '*' for any text, or numbers; empty: of tissues = "known"
  bool isByName = false;            ///< what it is of follows from the names of its labels, which are not read yet
  bool isRigid = false;             ///< it does not move
  bool isEmpty = false;             ///< air: like what has no label
  bool isShown = true;              ///< it has a surface in the 3D view
  std::optional<Vec3> colour;       ///< of that, sRGB, 0 … 1; none: that of its labels
  std::vector<SceneValue> params;   ///< ids "material.…"; none where it is rigid or empty
  std::string preset;               ///< that the material began with; empty: none
  std::string remark;               ///< NamedTissue::remark
  std::vector<SceneLabel> labels;   ///< once the map has been read: those that are of it
  std::optional<SceneTissueRule> rule;
  int line = 0;
};

/// What of a body has no label: where an image has values between two limits.
struct SceneBackground {
  std::filesystem::path image;
  std::string series;           ///< imaging::ReadOptions::series of the file or folder
  std::size_t time = 0;         ///< of several time points, from 0
  double from = 0.0, to = 0.0;  ///< lowest and highest value that belong to it
};

/// Of mesothelium on mesothelium: 0.019 ± 0.002 (pleura and peritoneum of rabbits, D'Angelo et al., Respiratory
/// Physiology & Neurobiology 142, 2004)
inline constexpr double kSlideFriction = 0.02;

/// What is said of one piece of a body that is cut, in the place of what is said of all of it.
struct ScenePiece {
  std::vector<SceneValue> params;    ///< ids "material.…", "sampling.…", "surroundings.…", "rigid", "free"
  std::optional<Vec3> velocity_m_s;  ///< at the start, of its centre of mass
  [[nodiscard]] bool isEmpty() const { return params.empty() && !velocity_m_s; }
};

/// Labels of a body of many tissues that are cut free along their border: one piece, which slides on what is beside it.
struct SceneSlide : ScenePiece {
  std::vector<std::string> names;  ///< of labels, '*' for any text, or numbers
  std::vector<SceneLabel> labels;  ///< once the map has been read: those that are meant
};

/// A body of many tissues in pieces, on the grid of its labels.
struct SceneCut {
  imaging::LabelMap tissues;                    ///< 1 and the number of the tissue; 0: not of the body
  std::vector<std::uint8_t> pieces;             ///< [voxels] 0: the rest, or 1 and the number of what slides
  std::vector<std::vector<SceneLabel>> labels;  ///< [pieces that slide]
};

/// What of an image is a body: a label of a label map, or the values of an image between two limits; then mended.
struct SceneVolume {
  std::filesystem::path file;                      ///< file or DICOM folder; empty: the body has a mesh, or `mask`
  std::size_t time = 0;                            ///< of several time points of the file, from 0
  std::shared_ptr<const imaging::Mask> mask;       ///< in the place of a file: picked in an image that is open
  std::optional<std::array<float, 3>> colour;      ///< linear RGB, of the label that `mask` is; none: of no label
  std::optional<std::uint16_t> label;              ///< number of a label
  std::string labelName;                           ///< or its name; empty: not by name
  std::string series;                              ///< imaging::ReadOptions::series of the file or folder
  std::optional<std::array<double, 2>> threshold;  ///< lowest and highest value that belong to it
  /// Instead of one label: a body of many tissues. A label is of the first of them that names it.
  std::vector<SceneTissue> tissues;
  bool takesKnownTissues = false;  ///< tissues are those whose names are known, once the map has been read
  /// Once the map has been read, where a tissue has a rule: its layers, if labels are asked for, and behind them one of
  /// what the rules take.
  std::shared_ptr<const std::vector<imaging::LabelMap>> ruled;
  bool isSettled = false;                     ///< SceneTissue::labels are known, and parts are made of the tissues
  std::vector<std::string> overridesOfParts;  ///< `--set` of parts that are not made yet, in their order
  std::optional<SceneBackground> background;  ///< its material is that of the body
  std::vector<SceneSlide> slides;             ///< that are still to be cut free
  ScenePiece rest;                            ///< what is left when they are
  double slideFriction = kSlideFriction;      ///< Coulomb, 0 … 10, of their borders
  std::shared_ptr<const SceneCut> cut;        ///< of a piece: of which body
  std::uint8_t piece = 0;                     ///< and which one
  std::optional<SceneRegion> region;          ///< of the scan, before placement: nothing outside belongs to it
  imaging::Mending mend;
  double edgeLength_mm = 0.0;  ///< of the triangles of the skin; 0: automatic

  [[nodiscard]] bool hasTissues() const { return takesKnownTissues || !tissues.empty(); }
  /// Whether a tissue is told by labels, so that the file is to be read as a label map.
  [[nodiscard]] bool asksForLabels() const;
  /// Whether the parts of the tissues follow from names that have not been read yet.
  [[nodiscard]] bool isOpen() const;
};

/// What of an image does not go with the bodies beside it.
struct SceneStill {
  bool isAutomatic = true;             ///< bone and air, where the image or its labels tell them
  std::optional<double> above, below;  ///< values of the image beyond which it stays
  std::vector<std::string> labels;     ///< names of labels, '*' for any text, or numbers
  bool outside = false;                ///< all that belongs to no body
  friend bool operator==(const SceneStill &, const SceneStill &) = default;
};

/// The image that is shown beside the simulation.
struct SceneImage {
  std::filesystem::path file;
  std::size_t time = 0;  ///< of several time points, from 0
  std::vector<std::filesystem::path> labels;
  bool warp = true;      ///< it deforms with the bodies
  std::string series;    ///< imaging::ReadOptions::series of the file or folder
  double rim_mm = 10.0;  ///< within it their displacement falls to nothing around them
  SceneStill still;      ///< and what stays there
  int line = 0;
};

struct SceneBody {
  std::string name;
  std::filesystem::path mesh;  ///< empty where it is made from a volume
  SceneVolume volume;
  std::optional<geometry::LengthUnit> meshUnit = geometry::LengthUnit::millimetre;  ///< none: a plugin's format says it
  ScenePlacement placement;
  Vec3 velocity_m_s{};             ///< at the start
  Vec3 angularVelocity_rad_s{};    ///< at the start, about the centre of mass
  std::vector<SceneValue> params;  ///< ids such as "material.youngs_modulus", "sampling.spacing"; each at most once
  std::vector<ScenePart> parts;    ///< those of tissues that are not rigid first, in their order
  std::vector<SceneRefinement> refinements;
  std::shared_ptr<const imaging::Fill> rigidTissue;  ///< what of it does not move; null: nothing, or not read yet
  int line = 0;
};

/// What of a body lies in the region follows the motion; by default it stands still.
struct SceneFix {
  std::string name;  ///< may be empty
  std::string body;  ///< name of a body of this scene
  SceneRegion region;
  SceneMotion motion;
  int line = 0;
};

/// A force or a pressure on what of a body lies in the region; exactly one of the two is there.
struct SceneLoad {
  std::string name;  ///< may be empty
  std::string body;  ///< name of a body of this scene
  SceneRegion region;
  std::optional<Vec3> force_N;        ///< total over the region
  std::optional<double> pressure_Pa;  ///< pushes into the body
  bool follower = true;               ///< the pressure turns and grows with the surface
  double ramp_s = 0.0;                ///< >= 0
  int line = 0;
};

struct SceneObstacle {
  std::string name;
  std::filesystem::path mesh;
  std::optional<geometry::LengthUnit> meshUnit = geometry::LengthUnit::millimetre;  ///< none: a plugin's format says it
  ScenePlacement placement;
  std::vector<SceneValue> params;     ///< "friction"
  std::optional<SceneMotion> motion;  ///< none: it stands still
  int line = 0;
};

struct SceneProbe {
  std::string name;
  std::string body;  ///< name of a body of this scene
  Vec3 at_m{};       ///< a material point
  int line = 0;
};

/// An elastic layer between the surface of a body and another body, an obstacle, or where it is in the scan. One to the
/// surroundings that holds all of the surface and does not tear is parameters of its body instead.
struct SceneAttachment {
  std::string name;                  ///< differs from those of others
  std::array<std::string, 2> names;  ///< a body; another body, an obstacle, or kSurroundingsName
  std::optional<SceneRegion> region;
  std::optional<double> within_m;                 ///< > 0: where the surfaces are that near
  double stiffness_Pa_m = 0.0, tearsAt_Pa = 0.0;  ///< >= 0
  std::optional<double> saidTangential_Pa_m;      ///< >= 0; none: it follows the stiffness
  int line = 0;
  [[nodiscard]] double tangential_Pa_m() const { return saidTangential_Pa_m.value_or(stiffness_Pa_m); }
};
/// Stands for where a body is in the scan.
inline constexpr const char *kSurroundingsName = "surroundings";

/// Stands for the walls of the world in pairs.
inline constexpr const char *kWallsName = "box";

/// Contact of two bodies, or of a body and an obstacle, a probe tool or the walls.
struct SceneContactPair {
  std::array<std::string, 2> names;  ///< of this scene, or kWallsName; at least one is a body
  std::optional<double> friction;    ///< Coulomb, 0 … 10; none: that of the obstacle, or of all bodies
  bool enabled = true;               ///< false: they pass through each other
  bool fits = false;                 ///< pieces of one body: what overlaps of their skins at the start is no overlap
  int line = 0;
};

struct SceneToolPlace {
  double time_s = 0.0;  ///< >= 0; the load factor of a quasi-static solution
  Vec3 at_m{};          ///< the middle
  std::optional<Vec3> axis;
};

/// A rigid sphere or capsule that is led along a path.
struct SceneProbeTool {
  std::string name;
  double radius_m = 0.0;             ///< > 0
  double length_m = 0.0;             ///< >= 0, between the middles of the ends; 0: a sphere
  double friction = 0.3;             ///< Coulomb, 0 … 10
  std::vector<SceneToolPlace> path;  ///< at least two, times ascend
  int line = 0;
};

/// Where the middle between two jaws is led, and how they have turned since they took hold, at a time.
struct SceneGraspPlace {
  double time_s = 0.0;
  Vec3 at_m{};
  Vec3 turn_deg{};  ///< about x, then y, then z
};

/// Two jaws that take hold of the skin of a body, close on the fold between them, and are led along a path.
struct SceneGrasp {
  std::string name, body;
  Vec3 at_m{};                          ///< material point of the placed body at rest; the nearest skin is grasped
  Vec3 axis{};                          ///< from the first jaw to the second, of any length but 0
  double jaw_m = 0.01;                  ///< > 0, diameter of what a jaw holds
  std::optional<double> saidOpening_m;  ///< >= jaw_m; none: twice jaw_m
  std::optional<double> saidClosed_m;   ///< 0 … opening_m(); none: half of that
  double forceLimit_N = 0.0;            ///< >= 0; 0: none
  std::vector<SceneGraspPlace> path;    ///< may be empty; times ascend
  int line = 0;
  [[nodiscard]] double opening_m() const { return saidOpening_m.value_or(2.0 * jaw_m); }
  [[nodiscard]] double closed_m() const { return saidClosed_m.value_or(0.5 * opening_m()); }
};

/// A scene as it was written. Structure is checked; what stands under world, solver, view, material, sampling and
/// friction is for the simulator's declarations to check.
struct SceneFile {
  std::filesystem::path source;  ///< empty when it was made in memory
  std::string title;
  std::string simulatorClass;  ///< id of the class that simulates; empty: the only one that is there
  int simulatorLine = 0;
  std::optional<SceneImage> image;
  std::vector<SceneValue> world;  ///< ids such as "world.gravity", "world.box.min", "solver.dt"; each at most once
  std::vector<SceneBody> bodies;
  std::vector<SceneFix> fixes;  ///< of all bodies, in the order of the file; so are their numbers in reports
  std::vector<SceneLoad> loads;
  std::vector<SceneObstacle> obstacles;
  std::vector<SceneProbe> probes;
  std::vector<SceneAttachment> attachments;
  std::vector<SceneContactPair> contactPairs;
  std::vector<SceneProbeTool> probeTools;
  std::vector<SceneGrasp> grasps;

  /// "FILE:LINE", or the title when there is no file: what an error message begins with.
  [[nodiscard]] std::string where(int line) const;
  /// The same for a value, "--set PATH" when it came from there.
  [[nodiscard]] std::string where(const SceneValue &value) const;
};

/// Reads and checks a scene. Every error (ErrorCode::input) reads "FILE:LINE: what is wrong; what is accepted"; an
/// unknown key names the nearest known one, a key that is known but not served yet is refused by name.
/// @param materials  presets that `material = "name"` refers to; null: none are known
[[nodiscard]] Expected<SceneFile> loadScene(const std::filesystem::path &path, const MaterialLibrary *materials);
/// The same for text; `source` is used in messages and its folder to find the meshes.
[[nodiscard]] Expected<SceneFile> parseScene(std::string_view text, const std::filesystem::path &source,
                                             const MaterialLibrary *materials);

/// One body made of a mesh file, with the defaults of the simulator and gravity along -y: what "open a mesh" simulates.
[[nodiscard]] SceneFile sceneForMesh(const std::filesystem::path &mesh, geometry::LengthUnit unit);

/// Applies `PATH=VALUE` of the command line, for example "body.liver.material.youngs_modulus=6e3", "solver.dt=auto",
/// "world.gravity=[0,-9.81,0]", "obstacle.floor.friction=0.2", "fix.0.displacement=[0,0,0.01]",
/// "load.press.pressure=200", "attachment.0.stiffness=1e4", "contact.pair.0.friction=0.1" (by name, or by number from
/// 0); of a piece by its name, "body.abdomen.liver.material.youngs_modulus=2e3", "body.abdomen.rest.rigid=true".
/// Errors (ErrorCode::usage) name the nearest path.
[[nodiscard]] Expected<void> applyOverride(SceneFile &scene, std::string_view assignment,
                                           const MaterialLibrary *materials);

/// The values of one table, as their declarations want them: a whole number becomes a number, text a choice. Of two
/// ways to say the same thing (ParameterDecl::alternativeTo) an override counts, and before it what is said of a piece.
/// Errors begin with where(value): unknown (names the nearest), outside what is accepted, two ways to say the same
/// thing, a part of what has to be said together. ErrorCode::usage for an override, ErrorCode::input else.
[[nodiscard]] Expected<std::vector<ParameterValue>> fitToDeclarations(const SceneFile &scene,
                                                                      const std::vector<SceneValue> &values,
                                                                      const std::vector<ParameterDecl> &decls);

/// Null: these values do not have one of this id that is true.
[[nodiscard]] const SceneValue *trueOf(const std::vector<SceneValue> &values, std::string_view id);

/// A tissue gets the material of its labels' names, or is rigid or empty; its name is not known, or its preset is not
/// among the materials: false.
[[nodiscard]] bool nameTissue(SceneTissue &tissue, std::string_view label, const MaterialLibrary &materials);
/// Makes the parts of a body from its tissues, of which none is open. Errors (ErrorCode::input, without a place): all
/// are rigid or empty.
[[nodiscard]] Expected<void> makeTissueParts(SceneBody &body);

/// Names of the pieces of a body that slide: its own, a dot, and what the first of their labels is called.
[[nodiscard]] std::vector<std::string> namesOfPieces(const SceneBody &body);
/// By which the rest of a body with slides is spoken of alone: "abdomen.rest", with a number where a label has that
/// name. Once it is cut the rest has the name of the body.
[[nodiscard]] std::string nameOfRest(const SceneBody &body);
/// A piece that slides, as a body of its own: of the same values, placement and tissues; what is said of it alone takes
/// the place of what is said of the body, its material that of all tissues. Nothing holds it but what is said of it.
[[nodiscard]] SceneBody bodyOfPiece(const SceneBody &body, std::size_t slide);
/// The rest of a body with slides likewise; it is held by what holds the body.
[[nodiscard]] SceneBody bodyOfRest(const SceneBody &body);
/// Names of all bodies, with those of pieces behind that of their body, in the order in which they are built.
[[nodiscard]] std::vector<std::string> namesOfBodies(const SceneFile &scene);
/// What a scene may speak of: these, and the rest of each body with slides.
[[nodiscard]] std::vector<std::string> namesToSpeakOf(const SceneFile &scene);

/// "m", "mm" or "cm"; the error says what is accepted.
[[nodiscard]] Expected<geometry::LengthUnit> parseLengthUnit(std::string_view name);

/// True for the file name extensions of scenes (".toml").
[[nodiscard]] bool isScenePath(const std::filesystem::path &path);

}  // namespace c3de::scene
