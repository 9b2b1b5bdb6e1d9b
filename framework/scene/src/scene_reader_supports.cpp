// SPDX-License-Identifier: Apache-2.0
#include "scene_reader.h"

#include <algorithm>

#include "c3de/core/text.h"

namespace c3de::scene {
namespace {

const std::vector<std::string> kFixKeys{"name",         "body",       "region", "displacement",
                                        "rotation_deg", "quaternion", "centre", "ramp"};
const std::vector<std::string> kLoadKeys{"name", "body", "region", "force", "pressure", "follower", "ramp"};
const std::vector<std::string> kRegionKeys{"box", "sphere", "half_space", "everywhere"};

const char *const kBox = "box = { min = [x, y, z], max = [x, y, z] }";
const char *const kSphere = "sphere = { centre = [x, y, z], radius = r }";
const char *const kHalfSpace = "half_space = { point = [x, y, z], normal = [x, y, z] }";
const char *const kPart = "[ { region = { … }, material = { … } } ]";
const char *const kRefinement = "[ { region = { … }, spacing = 0.005 } ]";

std::string acceptedRegions() {
  return std::string("{ ") + kBox + " }, { " + kSphere + " }, { " + kHalfSpace + " }, { everywhere = true }";
}

std::string shown(const Vec3 &v) {
  return "[" + formatNumber(v[0]) + ", " + formatNumber(v[1]) + ", " + formatNumber(v[2]) + "]";
}

/// Whether another element has the name.
template <class T>
bool isUsed(const std::vector<T> &elements, const std::string &name) {
  return !name.empty() &&
         std::any_of(elements.begin(), elements.end(), [&](const T &other) { return other.name == name; });
}

}  // namespace

bool SceneReader::readRegion(const TomlValue &value, SceneRegion &out) {
  if (value.kind != TomlValue::Kind::table || value.entries.size() != 1)
    return refuse(value.line, "region is " +
                                  (value.kind == TomlValue::Kind::table
                                       ? "a table with " + std::to_string(value.entries.size()) + " keys"
                                       : value.kindName()) +
                                  "; accepted: one of " + acceptedRegions());
  const auto &[key, shape] = value.entries.front();
  SceneRegion region;
  if (key == "everywhere") {
    bool everywhere = false;
    if (!readBool("region.everywhere", shape, everywhere)) return false;
    if (!everywhere) return refuse(shape.line, "region.everywhere is false; accepted: one of " + acceptedRegions());
  } else if (key == "box") {
    region.kind = SceneRegion::Kind::box;
    if (!requireKeys("region.box", kBox, shape, {"min", "max"}) ||
        !readVec3("region.box.min", *shape.find("min"), region.a) ||
        !readVec3("region.box.max", *shape.find("max"), region.b))
      return false;
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (region.a[axis] > region.b[axis])
        return refuse(shape.line, "region.box: min " + shown(region.a) + " is above max " + shown(region.b) +
                                      "; accepted: min up to max in x, y and z");
  } else if (key == "sphere") {
    region.kind = SceneRegion::Kind::sphere;
    if (!requireKeys("region.sphere", kSphere, shape, {"centre", "radius"}) ||
        !readVec3("region.sphere.centre", *shape.find("centre"), region.a) ||
        !readNumber("region.sphere.radius", "a number above 0, m", *shape.find("radius"), region.radius))
      return false;
    if (!(region.radius > 0.0))
      return refuse(shape.line,
                    "region.sphere.radius is " + formatNumber(region.radius) + "; accepted: a number above 0, m");
  } else if (key == "half_space") {
    region.kind = SceneRegion::Kind::halfSpace;
    if (!requireKeys("region.half_space", kHalfSpace, shape, {"point", "normal"}) ||
        !readVec3("region.half_space.point", *shape.find("point"), region.a) ||
        !readVec3("region.half_space.normal", *shape.find("normal"), region.b))
      return false;
    if (region.b == Vec3{})
      return refuse(shape.line, "region.half_space.normal is [0, 0, 0]; accepted: a direction [x, y, z]");
  } else {
    return refuseKey(shape.line, key, "region", kRegionKeys);
  }
  out = region;
  return true;
}

bool SceneReader::motionKey(SceneMotion &motion, const std::string &key, const std::string &rotationKey,
                            const TomlValue &value) {
  if (key == "displacement") return readVec3(key, value, motion.displacement_m);
  if (key == rotationKey) return readVec3(key, value, motion.rotation_deg);
  if (key == "quaternion" || key == "motion_quaternion") return readQuaternion(key, value, motion.quaternion);
  if (key == "centre") {
    Vec3 centre{};
    if (!readVec3(key, value, centre)) return false;
    motion.centre_m = centre;
    return true;
  }
  const std::string accepted = "a number of at least 0, s";
  if (!readNumber(key, accepted, value, motion.ramp_s)) return false;
  return motion.ramp_s >= 0.0 || refuse(value.line, key + " is " + formatNumber(value.num) + "; accepted: " + accepted);
}

bool SceneReader::readQuaternion(const std::string &key, const TomlValue &value,
                                 std::optional<std::array<double, 4>> &out) {
  // The rounding error of a unit quaternion printed with six digits; the value is then normalised.
  constexpr double kTolerance = 1e-5;
  const std::string accepted = "; accepted: a quaternion [x, y, z, w] of length 1";
  if (!value.isNumbers(4)) return refuse(value.line, key + " is " + value.kindName() + accepted);
  double square = 0.0;
  for (const TomlValue &item : value.items) square += item.num * item.num;
  const double length = std::sqrt(square);
  if (!(std::abs(length - 1.0) <= kTolerance))
    return refuse(value.line, key + " has the length " + formatNumber(length) + accepted);
  out.emplace();
  for (std::size_t i = 0; i < 4; ++i) (*out)[i] = value.items[i].num / length;
  return true;
}

bool SceneReader::readFix(const TomlValue &table) {
  SceneFix fix;
  fix.line = table.line;
  for (const auto &[key, value] : table.entries)
    if (!fixKey(fix, key, value)) return false;
  if (fix.motion.quaternion && table.find("rotation_deg") != nullptr)
    return refuse(table.line, "the fix has 'rotation_deg' and 'quaternion'; accepted: one of them");
  if (table.find("region") == nullptr)
    return refuse(table.line, "the fix has no 'region'; accepted: one of " + acceptedRegions());
  if (isUsed(scene_.fixes, fix.name))
    return refuse(table.line, "a second fix is named '" + fix.name + "'; names of fixes have to differ");
  scene_.fixes.push_back(std::move(fix));
  return true;
}

bool SceneReader::fixKey(SceneFix &fix, const std::string &key, const TomlValue &value) {
  if (key == "name") return readName(value, fix.name);
  if (key == "body") return readText(key, value, fix.body);
  if (key == "region") return readRegion(value, fix.region);
  if (key == "displacement" || key == "rotation_deg" || key == "quaternion" || key == "centre" || key == "ramp")
    return motionKey(fix.motion, key, "rotation_deg", value);
  return refuseKey(value.line, key, "[[fix]]", kFixKeys);
}

bool SceneReader::readLoad(const TomlValue &table) {
  SceneLoad load;
  load.line = table.line;
  for (const auto &[key, value] : table.entries)
    if (!loadKey(load, key, value)) return false;
  if (table.find("region") == nullptr)
    return refuse(table.line, "the load has no 'region'; accepted: one of " + acceptedRegions());
  if (load.force_N.has_value() == load.pressure_Pa.has_value())
    return refuse(table.line, std::string("the load has ") +
                                  (load.force_N ? "'force' and 'pressure'" : "no 'force' and no 'pressure'") +
                                  "; accepted: one of force = [x, y, z] in N, pressure = p in Pa");
  if (const TomlValue *follower = table.find("follower"); follower != nullptr && !load.pressure_Pa)
    return refuse(follower->line,
                  "follower is for a pressure; a force keeps its direction; accepted: no 'follower' here");
  if (isUsed(scene_.loads, load.name))
    return refuse(table.line, "a second load is named '" + load.name + "'; names of loads have to differ");
  scene_.loads.push_back(std::move(load));
  return true;
}

bool SceneReader::loadKey(SceneLoad &load, const std::string &key, const TomlValue &value) {
  if (key == "name") return readName(value, load.name);
  if (key == "body") return readText(key, value, load.body);
  if (key == "region") return readRegion(value, load.region);
  if (key == "force") {
    Vec3 force{};
    if (!readVec3(key, value, force)) return false;
    load.force_N = force;
    return true;
  }
  if (key == "pressure") {
    double pressure = 0.0;
    if (!readNumber(key, "a number, Pa; above 0 pushes into the body", value, pressure)) return false;
    load.pressure_Pa = pressure;
    return true;
  }
  if (key == "follower") return readBool(key, value, load.follower);
  if (key == "ramp") {
    SceneMotion motion;
    if (!motionKey(motion, key, "", value)) return false;
    load.ramp_s = motion.ramp_s;
    return true;
  }
  return refuseKey(value.line, key, "[[load]]", kLoadKeys);
}

bool SceneReader::readParts(const TomlValue &value, std::vector<ScenePart> &out) {
  if (!requireTables("parts", kPart, value)) return false;
  std::vector<ScenePart> parts;
  for (const TomlValue &table : value.items) {
    ScenePart part;
    part.line = table.line;
    if (!requireKeys("a part of a body", kPart, table, {"region", "material"}) ||
        !readRegion(*table.find("region"), part.region) || !readMaterial(part.params, *table.find("material")))
      return false;
    parts.push_back(std::move(part));
  }
  out = std::move(parts);
  return true;
}

bool SceneReader::readRefinements(const TomlValue &value, std::vector<SceneRefinement> &out) {
  if (!requireTables("sampling.refine", kRefinement, value)) return false;
  std::vector<SceneRefinement> refinements;
  for (const TomlValue &table : value.items) {
    SceneRefinement refinement;
    refinement.line = table.line;
    const std::string accepted = "a number above 0, m";
    if (!requireKeys("an entry of sampling.refine", kRefinement, table, {"region", "spacing"}) ||
        !readRegion(*table.find("region"), refinement.region) ||
        !readNumber("sampling.refine: spacing", accepted, *table.find("spacing"), refinement.spacing_m))
      return false;
    if (!(refinement.spacing_m > 0.0))
      return refuse(table.line,
                    "sampling.refine: spacing is " + formatNumber(refinement.spacing_m) + "; accepted: " + accepted);
    refinements.push_back(refinement);
  }
  out = std::move(refinements);
  return true;
}

}  // namespace c3de::scene
