// SPDX-License-Identifier: Apache-2.0
// [contact] with [[contact.pair]], and [[probe_tool]]: contact pairs, and tools that touch from outside.
#include <algorithm>
#include <cmath>

#include "c3de/core/text.h"
#include "scene_reader_path.h"

namespace c3de::scene {
namespace {

const std::vector<std::string> kPairKeys{"bodies", "friction", "enabled"};
const std::vector<std::string> kToolKeys{"name", "radius_mm", "length_mm", "friction", "path"};
const std::vector<std::string> kWaypointKeys{"time", "at", "axis"};
const char *const kNames = "two names, [\"liver\", \"kidney\"]; \"box\": the walls of the world";
const char *const kFriction = "a number from 0 to 10";
const char *const kPath = "at least two places, [{ time = 0, at = [x, y, z] }, …] in s and m";
const char *const kRadius = "a number above 0, mm";
const char *const kLength = "a number of at least 0, mm; 0: a sphere";
constexpr double kMaxFriction = 10.0, kMetresPerMillimetre = 1e-3;

}  // namespace

bool SceneReader::readContact(const TomlValue &table) {
  if (table.kind != TomlValue::Kind::table)
    return refuse(table.line, "'contact' is " + table.kindName() + "; accepted: a table, [contact]");
  for (const auto &[key, value] : table.entries) {
    if (key != "pair") {
      if (!store(scene_.world, "contact." + key, value)) return false;
      continue;
    }
    if (!tables(value, "contact.pair")) return false;
    for (const TomlValue &pair : value.items)
      if (!readContactPair(pair)) return false;
  }
  return true;
}

bool SceneReader::readContactPair(const TomlValue &table) {
  SceneContactPair pair;
  pair.line = table.line;
  for (const auto &[key, value] : table.entries)
    if (!contactPairKey(pair, key, value)) return false;
  if (table.find("bodies") == nullptr)
    return refuse(table.line, std::string("the pair has no 'bodies'; accepted: ") + kNames);
  if (!pair.friction && table.find("enabled") == nullptr)
    return refuse(table.line,
                  "the pair says nothing of its contact; accepted: friction = a number from 0 to 10, "
                  "enabled = true, false");
  scene_.contactPairs.push_back(std::move(pair));
  return true;
}

bool SceneReader::contactPairKey(SceneContactPair &pair, const std::string &key, const TomlValue &value) {
  if (key == "bodies") {
    const bool good = value.kind == TomlValue::Kind::array && value.items.size() == 2 &&
                      value.items[0].kind == TomlValue::Kind::text && value.items[1].kind == TomlValue::Kind::text;
    if (!good) return refuse(value.line, "bodies is " + value.kindName() + "; accepted: " + kNames);
    pair.names = {value.items[0].text, value.items[1].text};
    return true;
  }
  if (key == "friction") {
    double friction = 0.0;
    if (!readFriction(key, value, friction)) return false;
    pair.friction = friction;
    return true;
  }
  if (key == "enabled") return readBool(key, value, pair.enabled);
  return refuseKey(value.line, key, "[[contact.pair]]", kPairKeys);
}

bool SceneReader::readFriction(const std::string &key, const TomlValue &value, double &out) {
  if (!readNumber(key, kFriction, value, out)) return false;
  if (!(out >= 0.0 && out <= kMaxFriction))
    return refuse(value.line, key + " is " + formatNumber(out) + "; accepted: " + kFriction);
  return true;
}

bool SceneReader::readProbeTool(const TomlValue &table) {
  SceneProbeTool tool;
  tool.line = table.line;
  for (const auto &[key, value] : table.entries)
    if (!probeToolKey(tool, key, value)) return false;
  if (table.find("radius_mm") == nullptr)
    return refuse(table.line, std::string("the probe tool has no 'radius_mm'; accepted: ") + kRadius);
  if (table.find("path") == nullptr)
    return refuse(table.line, std::string("the probe tool has no 'path'; accepted: ") + kPath);
  if (tool.name.empty()) tool.name = "tool-" + std::to_string(scene_.probeTools.size() + 1);
  for (const SceneProbeTool &other : scene_.probeTools)
    if (other.name == tool.name)
      return refuse(table.line,
                    "a second probe tool is named '" + tool.name + "'; names of probe tools have to differ");
  if (!checkAxes(tool)) return false;
  scene_.probeTools.push_back(std::move(tool));
  return true;
}

bool SceneReader::checkAxes(const SceneProbeTool &tool) {
  const bool hasAxis =
      std::any_of(tool.path.begin(), tool.path.end(), [](const SceneToolWaypoint &p) { return p.axis; });
  return !hasAxis || tool.length_m > 0.0 ||
         refuse(tool.line, "the probe tool has an 'axis' and no 'length_mm': a sphere has none; accepted: length_mm, " +
                               std::string("the length of a capsule"));
}

bool SceneReader::probeToolKey(SceneProbeTool &tool, const std::string &key, const TomlValue &value) {
  if (key == "name") return readName(value, tool.name);
  if (key == "radius_mm" || key == "length_mm") {
    const bool isRadius = key == "radius_mm";
    const char *accepted = isRadius ? kRadius : kLength;
    double size = 0.0;
    if (!readNumber(key, accepted, value, size)) return false;
    if (!(isRadius ? size > 0.0 : size >= 0.0))
      return refuse(value.line, key + " is " + formatNumber(size) + "; accepted: " + accepted);
    (isRadius ? tool.radius_m : tool.length_m) = kMetresPerMillimetre * size;
    return true;
  }
  if (key == "friction") return readFriction(key, value, tool.friction);
  if (key == "path") return readPath(value, tool.path);
  return refuseKey(value.line, key, "[[probe_tool]]", kToolKeys);
}

bool SceneReader::readPath(const TomlValue &value, std::vector<SceneToolWaypoint> &out) {
  return readWaypoints(value, kPath, 2, kWaypointKeys, out,
                       [this](SceneToolWaypoint &place, const std::string &key, const TomlValue &member) {
                         Vec3 axis{};
                         if (!readVec3(key, member, axis)) return false;
                         if (axis == Vec3{})
                           return refuse(member.line,
                                         "axis is [0, 0, 0]; accepted: the direction of a capsule, of any length");
                         place.axis = axis;
                         return true;
                       });
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
      const std::string nearest = nearestName(name, all);
      if (count > 1)
        return refuse(pair.line, "'" + name + "' is the name of " + std::to_string(count) +
                                     " bodies, obstacles or probe tools; accepted: names that only one has");
      return refuse(pair.line, "there is no body, obstacle or probe tool '" + name + "'; " +
                                   (nearest.empty() ? "" : "did you mean '" + nearest + "'? ") +
                                   "accepted: " + joined(all));
    }
    const auto &[a, b] = pair.names;
    if (a == b) return refuse(pair.line, "the pair is of '" + a + "' and itself; accepted: two that differ");
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
