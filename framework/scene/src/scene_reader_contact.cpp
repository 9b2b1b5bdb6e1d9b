// SPDX-License-Identifier: Apache-2.0
// [contact] with [[contact.pair]], and the paths of [[probe_tool]] and [[grasp]].
#include <algorithm>

#include "c3de/core/text.h"
#include "scene_fields.h"

namespace c3de::scene {
namespace {

const char *const kGraspPath = "places [{ time = 0, at = [x, y, z], turn_deg = [x, y, z] }, …] in s, m and degrees";

template <class Waypoint>
Fields<Waypoint> waypointFields(const char *accepted, Field<Waypoint> own) {
  return {"a waypoint of a path",
          "a place of the path",
          {{"time", &Waypoint::time_s, atLeast0("s; of a quasi-static solution the load factor"), required(accepted)},
           {"at", &Waypoint::at_m, required(accepted)},
           std::move(own)}};
}

}  // namespace

const Fields<SceneToolWaypoint> kToolWaypointFields = waypointFields<SceneToolWaypoint>(
    kToolPath, {"axis", &SceneToolWaypoint::axis, DirectionReader{"the direction of a capsule, of any length"}});
const Fields<SceneGraspWaypoint> kGraspWaypointFields =
    waypointFields<SceneGraspWaypoint>(kGraspPath, {"turn_deg", &SceneGraspWaypoint::turn_deg});

bool SceneReader::readContact(const TomlValue &table) {
  if (table.kind != TomlValue::Kind::table)
    return refuse(table.line, "'contact' is " + table.kindName() + "; accepted: a table, [contact]");
  for (const auto &[key, value] : table.entries) {
    if (key != "pair") {
      if (!read("contact." + key, value, scene_.world)) return false;
      continue;
    }
    if (!readTables(kContactPairTable, value)) return false;
  }
  return true;
}

bool SceneReader::checkPair(const TomlValue &keys, SceneContactPair &pair) {
  return pair.friction || keys.find("enabled") != nullptr ||
         refuse(keys.line,
                "the pair has no settings; accepted: friction = a number from 0 to 10, "
                "enabled = true, false");
}

bool SceneReader::checkAxes(const SceneProbeTool &tool) {
  const bool hasAxis =
      std::any_of(tool.path.begin(), tool.path.end(), [](const SceneToolWaypoint &p) { return p.axis; });
  return !hasAxis || tool.length_m > 0.0 ||
         refuse(tool.line, "the probe tool has an 'axis' and no 'length_mm': a sphere has none; accepted: length_mm, " +
                               std::string("the length of a capsule"));
}

bool SceneReader::checkJaws(const SceneGrasp &grasp) {
  const auto mm = [](double metres) { return formatNumber(metres / kMetresPerMillimetre); };
  if (grasp.opening_m() < grasp.jaw_m)
    return refuse(grasp.line, "opening_mm is " + mm(grasp.opening_m()) + " and jaw_mm is " + mm(grasp.jaw_m) +
                                  ": the jaws would overlap; accepted: an opening_mm of at least jaw_mm");
  return grasp.closed_m() <= grasp.opening_m() ||
         refuse(grasp.line,
                "closed_mm is " + mm(grasp.closed_m()) + "; accepted: 0 to opening_mm, " + mm(grasp.opening_m()));
}

bool SceneReader::read(const std::string &, const TomlValue &value, std::vector<SceneToolWaypoint> &out) {
  return readPath(kToolWaypointFields, value, 2, out);
}

bool SceneReader::read(const std::string &, const TomlValue &value, std::vector<SceneGraspWaypoint> &out) {
  return readPath(kGraspWaypointFields, value, 1, out);
}

template <class Waypoint>
bool SceneReader::readPath(const Fields<Waypoint> &fields, const TomlValue &value, std::size_t least,
                           std::vector<Waypoint> &out) {
  const std::string &accepted = fields.fields.front().rules.required;
  if (!requireTables("path", accepted, value)) return false;
  if (value.items.size() < least)
    return refuse(value.line, "path has " + std::to_string(value.items.size()) + " place; accepted: " + accepted);
  std::vector<Waypoint> path;
  for (const TomlValue &table : value.items) {
    Waypoint place;
    if (!readFields(fields, table, place)) return false;
    if (!path.empty() && !(place.time_s > path.back().time_s))
      return refuse(table.line, "time " + formatNumber(place.time_s) + " follows " + formatNumber(path.back().time_s) +
                                    " in the path; accepted: times that ascend");
    path.push_back(place);
  }
  out = std::move(path);
  return true;
}

bool SceneReader::checkPairs() {
  const std::vector<std::string> bodies = referableNames(scene_);
  std::vector<std::string> others{kWallsName};
  for (const SceneObstacle &obstacle : scene_.obstacles) others.push_back(obstacle.name);
  for (const SceneProbeTool &tool : scene_.probeTools) others.push_back(tool.name);
  std::vector<std::string> all = bodies;
  all.insert(all.end(), others.begin(), others.end());
  for (std::size_t i = 0; i < scene_.contactPairs.size(); ++i) {
    const SceneContactPair &pair = scene_.contactPairs[i];
    for (const std::string &name : pair.names) {
      const auto count = std::count(all.begin(), all.end(), name);
      if (count == 1) continue;
      if (count > 1)
        return refuse(pair.line, "'" + name + "' is the name of " + std::to_string(count) +
                                     " bodies, obstacles or probe tools; accepted: names that only one has");
      return refuse(pair.line, "there is no body, obstacle or probe tool '" + name + "'; " + suggestion(name, all));
    }
    const auto &[a, b] = pair.names;
    if (a == b) return refuse(pair.line, "the pair has '" + a + "' twice; accepted: two different names");
    const auto isBody = [&](const std::string &name) {
      return std::find(bodies.begin(), bodies.end(), name) != bodies.end();
    };
    if (!isBody(a) && !isBody(b))
      return refuse(pair.line,
                    "neither '" + a + "' nor '" + b + "' is a body; accepted: a pair with a body, " + joined(bodies));
    for (std::size_t k = 0; k < i; ++k) {
      const auto &[c, d] = scene_.contactPairs[k].names;
      if ((a == c && b == d) || (a == d && b == c))
        return refuse(pair.line, "a second pair is of '" + a + "' and '" + b + "'; accepted: one");
    }
  }
  return true;
}

}  // namespace c3de::scene
