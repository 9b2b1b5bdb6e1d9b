// SPDX-License-Identifier: Apache-2.0
// The keys of all [[tables]] of a scene, in the order of messages.
#include "scene_fields.h"

namespace c3de::scene {
namespace {

const NumberReader kScale{.accepted = "a number above 0", .low = 0.0, .isAbove = true};
const char *const kAttachedNames =
    "two names, [\"liver\", \"surroundings\"]: a body, and another body, an obstacle, or where it is in the scan";
const char *const kPairNames = "two names, [\"liver\", \"kidney\"]; \"box\": the walls of the world";
const char *const kAxis = "the direction [x, y, z] from the first jaw to the second, of any length but 0";

const char *const kTwoLandmarks = "the names of two landmarks, [\"a\", \"b\"]";
const char *const kThreeLandmarks = "the names of three landmarks, [\"a\", \"b\", \"c\"]; the vertex is the second";

struct NamesReader {
  const char *accepted;
  template <std::size_t N>
  bool operator()(SceneReader &reader, const std::string &key, const TomlValue &value,
                  std::array<std::string, N> &out) const {
    const bool good = value.kind == TomlValue::Kind::array && value.items.size() == N &&
                      std::all_of(value.items.begin(), value.items.end(),
                                  [](const TomlValue &name) { return name.kind == TomlValue::Kind::text; });
    if (!good) return reader.refuse(value.line, key + " is " + value.kindName() + "; accepted: " + accepted);
    for (std::size_t i = 0; i < N; ++i) out[i] = value.items[i].text;
    return true;
  }
};

/// A stiffness that is also a parameter of the surroundings, which checkAttachment() stores.
bool readStiffness(SceneReader &reader, const std::string &key, const TomlValue &value, double &out) {
  std::vector<SceneValue> stored;
  return (reader.isOverride() || reader.read("surroundings." + key, value, stored)) &&
         atLeast0(kStiffnessUnit)(reader, key, value, out);
}

/// Stored with the body, which SceneWriter writes as an attachment.
std::optional<TomlValue> leaveOut(SceneWriter &, const std::string &, const SceneAttachment &) { return std::nullopt; }

bool readRetardation(SceneReader &reader, const std::string &key, const TomlValue &value, SceneAttachment &) {
  std::vector<SceneValue> stored;
  return reader.isOverride() ? reader.refuseKey(value.line, key, "[[attachment]]", kAttachmentTable.keys())
                             : reader.read("surroundings." + key, value, stored);
}

bool readMaterialOfBody(SceneReader &reader, const std::string &key, const TomlValue &value, SceneBody &body) {
  return reader.readMaterial(key, value, body.params);
}
bool readPartsOfBody(SceneReader &reader, const std::string &key, const TomlValue &value, SceneBody &body) {
  return reader.read(key, value, body.parts);
}
bool readTissuesOfBody(SceneReader &reader, const std::string &key, const TomlValue &value, SceneBody &body) {
  return reader.readTissues(key, value, body.volume);
}

auto placement(auto member) {
  return [member](auto &table) -> auto & { return table.placement.*member; };
}
auto motion(auto member) {
  return [member](auto &table) -> auto & { return contentOf(table.motion).*member; };
}
auto volume(auto member) { return in(&SceneBody::volume, member); }

}  // namespace

const SceneTable<SceneBody> kBodyTable(
    "body", "body", &SceneFile::bodies, "bodies", "",
    {{"name", &SceneBody::name, &SceneReader::readName},
     {"mesh", &SceneBody::mesh, &SceneReader::readMesh},
     {"mesh_unit", &SceneBody::meshUnit},
     {"position", placement(&ScenePlacement::position_m)},
     {"rotation_deg", placement(&ScenePlacement::rotation_deg)},
     {"scale", placement(&ScenePlacement::scale), kScale},
     {"material", Codec{&readMaterialOfBody, &SceneWriter::materialOf}},
     {"sampling", Codec{&SceneReader::readSampling, &SceneWriter::samplingOf}},
     {"parts", Codec{&readPartsOfBody, &SceneWriter::partsOf}},
     {"velocity", &SceneBody::velocity_m_s},
     {"angular_velocity", &SceneBody::angularVelocity_rad_s},
     {"volume", volume(&SceneVolume::file)},
     {"series", volume(&SceneVolume::series), &SceneReader::readSeries},
     {"time", volume(&SceneVolume::time)},
     {"label", &SceneBody::volume, Codec{&SceneReader::readLabelOf, &SceneWriter::labelOf}},
     {"threshold", volume(&SceneVolume::threshold)},
     {"mend", volume(&SceneVolume::mend)},
     {"edge_length", volume(&SceneVolume::edgeLength_mm), lengthNumber()},
     {C3DE_PARAM_ID_RIGID, &SceneBody::params},
     {C3DE_PARAM_ID_FREE, &SceneBody::params},
     {"matrix", placement(&ScenePlacement::matrix)},
     {"tissues", Codec{&readTissuesOfBody, &SceneWriter::tissuesOf}},
     {"background", Codec{&SceneReader::readBackground, &SceneWriter::backgroundOf}},
     {"region", volume(&SceneVolume::region)},
     {"slides", &SceneBody::volume, Codec{&SceneReader::readSlides, &SceneWriter::slidesOf}},
     {"slide_friction", volume(&SceneVolume::slidingFriction), frictionNumber()}},
    &SceneReader::checkBody);

const SceneTable<SceneFix> kFixTable("fix", "fix", &SceneFile::fixes, "fixes", "",
                                     {{"name", &SceneFix::name, &SceneReader::readName, Override::refused},
                                      {"body", &SceneFix::body},
                                      {"region", &SceneFix::region, required("one of " + acceptedRegions())},
                                      {"displacement", motion(&SceneMotion::displacement_m)},
                                      {"rotation_deg", motion(&SceneMotion::rotation_deg)},
                                      {"quaternion", motion(&SceneMotion::quaternion), Override::accepted},
                                      {"centre", motion(&SceneMotion::centre_m)},
                                      {"ramp", motion(&SceneMotion::ramp_s), atLeast0("s")}},
                                     &SceneReader::checkFix);

const SceneTable<SceneLoad> kLoadTable("load", "load", &SceneFile::loads, "loads", "",
                                       {{"name", &SceneLoad::name, &SceneReader::readName, Override::refused},
                                        {"body", &SceneLoad::body},
                                        {"region", &SceneLoad::region, required("one of " + acceptedRegions())},
                                        {"force", &SceneLoad::force_N},
                                        {"pressure", &SceneLoad::pressure_Pa,
                                         NumberReader{"a number, Pa; above 0 pushes into the body"}},
                                        {"follower", &SceneLoad::follower},
                                        {"ramp", &SceneLoad::ramp_s, atLeast0("s")}},
                                       &SceneReader::checkLoad);

const SceneTable<SceneObstacle> kObstacleTable(
    "obstacle", "obstacle", &SceneFile::obstacles, "", "",
    {{"name", &SceneObstacle::name, Override::accepted},
     {"mesh", &SceneObstacle::mesh, &SceneReader::readMesh,
      required("a mesh file, its path relative to the scene's folder", Override::accepted)},
     {"mesh_unit", &SceneObstacle::meshUnit, Override::accepted},
     {"position", placement(&ScenePlacement::position_m)},
     {"rotation_deg", placement(&ScenePlacement::rotation_deg)},
     {"scale", placement(&ScenePlacement::scale), kScale},
     {C3DE_PARAM_ID_FRICTION, &SceneObstacle::params},
     {C3DE_PARAM_ID_RESTITUTION, &SceneObstacle::params},
     {"displacement", motion(&SceneMotion::displacement_m)},
     {"motion_rotation_deg", motion(&SceneMotion::rotation_deg), Override::accepted},
     {"centre", motion(&SceneMotion::centre_m), Override::accepted},
     {"ramp", motion(&SceneMotion::ramp_s), atLeast0("s")},
     {"matrix", placement(&ScenePlacement::matrix), Override::accepted},
     {"motion_quaternion", motion(&SceneMotion::quaternion), Override::accepted}},
    &SceneReader::checkObstacle);

const SceneTable<SceneProbe> kProbeTable("probe", "probe", &SceneFile::probes, "probes", "probe",
                                         {{"name", &SceneProbe::name, Override::accepted},
                                          {"body", &SceneProbe::body, Override::accepted},
                                          {"at", &SceneProbe::at_m, required("a material point [x, y, z] in m")}});

const SceneTable<SceneLandmark> kLandmarkTable(
    "landmark", "landmark", &SceneFile::landmarks, "landmarks", "",
    {{"name", &SceneLandmark::name, &SceneReader::readName,
      required("text that no other landmark has as its name", Override::refused)},
     {"on", &SceneLandmark::body, Override::accepted},
     {"at", &SceneLandmark::at_m, required("a point [x, y, z] in m, in the world at rest")},
     {"target", &SceneLandmark::target_m}});

const SceneTable<SceneDistance> kDistanceTable(
    "distance", "distance", &SceneFile::distances, "distances", "distance",
    {{"name", &SceneDistance::name, &SceneReader::readName, Override::refused},
     {"between", &SceneDistance::between, NamesReader{kTwoLandmarks}, required(kTwoLandmarks, Override::accepted)}});

const SceneTable<SceneAngle> kAngleTable("angle", "angle", &SceneFile::angles, "angles", "angle",
                                         {{"name", &SceneAngle::name, &SceneReader::readName, Override::refused},
                                          {"at", &SceneAngle::at, NamesReader{kThreeLandmarks},
                                           required(kThreeLandmarks, Override::accepted)}});

const SceneTable<SceneAttachment> kAttachmentTable(
    "attachment", "attachment", &SceneFile::attachments, "", "",
    {{"name", &SceneAttachment::name, &SceneReader::readName, Override::refused},
     {"bodies", &SceneAttachment::names, NamesReader{kAttachedNames}, required(kAttachedNames, Override::refused)},
     {"within_mm", &SceneAttachment::within_m, above0("mm", kMetresPerMillimetre)},
     {"region", &SceneAttachment::region},
     {"stiffness", &SceneAttachment::stiffness_Pa_m, &readStiffness, required(atLeast0(kStiffnessUnit).accepted)},
     {"tangential", &SceneAttachment::givenTangential_Pa_m, &readStiffness},
     {"tears_at", &SceneAttachment::tearsAt_Pa, atLeast0("Pa; 0: never")},
     {"retardation_time", Codec{&readRetardation, &leaveOut}, Override::accepted}});

const SceneTable<SceneContactPair> kContactPairTable("contact.pair", "pair", &SceneFile::contactPairs, "", "",
                                                     {{"bodies", &SceneContactPair::names, NamesReader{kPairNames},
                                                       required(kPairNames, Override::accepted)},
                                                      {"friction", &SceneContactPair::friction, frictionNumber()},
                                                      {"enabled", &SceneContactPair::enabled}},
                                                     &SceneReader::checkPair);

const SceneTable<SceneProbeTool> kProbeToolTable(
    "probe_tool", "probe tool", &SceneFile::probeTools, "probe tools", "tool",
    {{"name", &SceneProbeTool::name, &SceneReader::readName, Override::refused},
     {"radius_mm", &SceneProbeTool::radius_m, above0("mm", kMetresPerMillimetre), required(above0("mm").accepted)},
     {"length_mm", &SceneProbeTool::length_m, atLeast0("mm; 0: a sphere", kMetresPerMillimetre)},
     {"friction", &SceneProbeTool::friction, frictionNumber()},
     {"path", &SceneProbeTool::path, required(kToolPath)}},
    nullptr, &SceneReader::checkAxes);

const SceneTable<SceneGrasp> kGraspTable(
    "grasp", "grasp", &SceneFile::grasps, "grasps", "grasp",
    {{"name", &SceneGrasp::name, &SceneReader::readName, Override::refused},
     {"body", &SceneGrasp::body, &SceneReader::readName, Override::refused},
     {"at", &SceneGrasp::at_m, required("a material point [x, y, z] in m, on the skin")},
     {"axis", &SceneGrasp::axis, DirectionReader{kAxis}, required(kAxis)},
     {"jaw_mm", &SceneGrasp::jaw_m, above0("mm", kMetresPerMillimetre)},
     {"opening_mm", &SceneGrasp::givenOpening_m, above0("mm", kMetresPerMillimetre)},
     {"closed_mm", &SceneGrasp::givenClosed_m, atLeast0("mm", kMetresPerMillimetre)},
     {"force_limit", &SceneGrasp::forceLimit_N, atLeast0("N; 0: no limit")},
     {"path", &SceneGrasp::path}},
    nullptr, &SceneReader::checkJaws);

}  // namespace c3de::scene
