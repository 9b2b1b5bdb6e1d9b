// SPDX-License-Identifier: Apache-2.0
// [[grasp]]: two jaws that grasp tissue and move it.
#include "scene_reader_path.h"

namespace c3de::scene {
namespace {

const std::vector<std::string> kKeys{"name",       "body",      "at",          "axis", "jaw_mm",
                                     "opening_mm", "closed_mm", "force_limit", "path"};
const std::vector<std::string> kWaypointKeys{"time", "at", "turn_deg"};
const char *const kAt = "a material point [x, y, z] in m, on the skin";
const char *const kAxis = "the direction [x, y, z] from the first jaw to the second, of any length but 0";
const char *const kPath = "places [{ time = 0, at = [x, y, z], turn_deg = [x, y, z] }, …] in s, m and degrees";
constexpr double kMetresPerMillimetre = 1e-3;

}  // namespace

bool SceneReader::readGrasp(const TomlValue &table) {
  SceneGrasp grasp;
  grasp.line = table.line;
  for (const auto &[key, value] : table.entries)
    if (!graspKey(grasp, key, value)) return false;
  if (table.find("at") == nullptr) return refuse(table.line, std::string("the grasp has no 'at'; accepted: ") + kAt);
  if (table.find("axis") == nullptr)
    return refuse(table.line, std::string("the grasp has no 'axis'; accepted: ") + kAxis);
  if (grasp.name.empty()) grasp.name = "grasp-" + std::to_string(scene_.grasps.size() + 1);
  for (const SceneGrasp &other : scene_.grasps)
    if (other.name == grasp.name)
      return refuse(table.line, "a second grasp is named '" + grasp.name + "'; names of grasps have to differ");
  if (!checkGrasp(grasp)) return false;
  scene_.grasps.push_back(std::move(grasp));
  return true;
}

bool SceneReader::checkGrasp(const SceneGrasp &grasp) {
  const auto mm = [](double metres) { return formatNumber(metres / kMetresPerMillimetre); };
  if (grasp.opening_m() < grasp.jaw_m)
    return refuse(grasp.line, "opening_mm is " + mm(grasp.opening_m()) + " and jaw_mm is " + mm(grasp.jaw_m) +
                                  ": the jaws would overlap; accepted: an opening_mm of at least jaw_mm");
  return grasp.closed_m() <= grasp.opening_m() ||
         refuse(grasp.line,
                "closed_mm is " + mm(grasp.closed_m()) + "; accepted: 0 to opening_mm, " + mm(grasp.opening_m()));
}

bool SceneReader::graspKey(SceneGrasp &grasp, const std::string &key, const TomlValue &value) {
  if (key == "name") return readName(value, grasp.name);
  if (key == "body") return readName(value, grasp.body);
  if (key == "at") return readVec3(key, value, grasp.at_m);
  if (key == "axis") {
    if (!readVec3(key, value, grasp.axis)) return false;
    return grasp.axis != Vec3{} || refuse(value.line, std::string("axis is [0, 0, 0]; accepted: ") + kAxis);
  }
  if (key == "jaw_mm" || key == "opening_mm") {
    const char *accepted = "a number above 0, mm";
    double size = 0.0;
    if (!readNumber(key, accepted, value, size)) return false;
    if (!(size > 0.0)) return refuse(value.line, key + " is " + formatNumber(size) + "; accepted: " + accepted);
    (key == "jaw_mm" ? grasp.jaw_m : grasp.givenOpening_m.emplace()) = kMetresPerMillimetre * size;
    return true;
  }
  if (key == "closed_mm") {
    double gap = 0.0;
    if (!readNotNegative(key, "mm", value, gap)) return false;
    grasp.givenClosed_m = kMetresPerMillimetre * gap;
    return true;
  }
  if (key == "force_limit") return readNotNegative(key, "N; 0: no limit", value, grasp.forceLimit_N);
  if (key == "path")
    return readWaypoints(value, kPath, 1, kWaypointKeys, grasp.path,
                         [this](SceneGraspWaypoint &place, const std::string &turn, const TomlValue &member) {
                           return readVec3(turn, member, place.turn_deg);
                         });
  return refuseKey(value.line, key, "[[grasp]]", kKeys);
}

}  // namespace c3de::scene
