// SPDX-License-Identifier: Apache-2.0
#include "scene_reader.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "c3de/core/text.h"

namespace c3de::scene {
namespace {

const std::vector<std::string> kRegionKeys{"box", "sphere", "half_space", "everywhere"};

const char *const kBox = "box = { min = [x, y, z], max = [x, y, z] }";
const char *const kSphere = "sphere = { centre = [x, y, z], radius = r }";
const char *const kHalfSpace = "half_space = { point = [x, y, z], normal = [x, y, z] }";
const char *const kPart = "[ { region = { … }, material = { … } } ]";
const char *const kRefinement = "[ { region = { … }, spacing = 0.005 } ]";

std::string shown(const Vec3 &v) {
  return "[" + formatNumber(v[0]) + ", " + formatNumber(v[1]) + ", " + formatNumber(v[2]) + "]";
}

}  // namespace

std::string acceptedRegions() {
  return std::string("{ ") + kBox + " }, { " + kSphere + " }, { " + kHalfSpace + " }, { everywhere = true }";
}

bool SceneReader::read(const std::string &, const TomlValue &value, SceneRegion &out) {
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
    if (!read("region.everywhere", shape, everywhere)) return false;
    if (!everywhere) return refuse(shape.line, "region.everywhere is false; accepted: one of " + acceptedRegions());
  } else if (key == "box") {
    region.kind = SceneRegion::Kind::box;
    if (!requireKeys("region.box", kBox, shape, {"min", "max"}) ||
        !read("region.box.min", *shape.find("min"), region.a) || !read("region.box.max", *shape.find("max"), region.b))
      return false;
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (region.a[axis] > region.b[axis])
        return refuse(shape.line, "region.box: min " + shown(region.a) + " is above max " + shown(region.b) +
                                      "; accepted: min up to max in x, y and z");
  } else if (key == "sphere") {
    region.kind = SceneRegion::Kind::sphere;
    if (!requireKeys("region.sphere", kSphere, shape, {"centre", "radius"}) ||
        !read("region.sphere.centre", *shape.find("centre"), region.a) ||
        !readNumber("region.sphere.radius", "a number above 0, m", *shape.find("radius"), region.radius))
      return false;
    if (!(region.radius > 0.0))
      return refuse(shape.line,
                    "region.sphere.radius is " + formatNumber(region.radius) + "; accepted: a number above 0, m");
  } else if (key == "half_space") {
    region.kind = SceneRegion::Kind::halfSpace;
    if (!requireKeys("region.half_space", kHalfSpace, shape, {"point", "normal"}) ||
        !read("region.half_space.point", *shape.find("point"), region.a) ||
        !read("region.half_space.normal", *shape.find("normal"), region.b))
      return false;
    if (region.b == Vec3{})
      return refuse(shape.line, "region.half_space.normal is [0, 0, 0]; accepted: a direction [x, y, z]");
  } else {
    return refuseKey(shape.line, key, "region", kRegionKeys);
  }
  out = region;
  return true;
}

bool SceneReader::read(const std::string &key, const TomlValue &value, std::array<double, 4> &out) {
  // The rounding error of a unit quaternion printed with six digits; the value is then normalised.
  constexpr double kTolerance = 1e-5;
  const std::string accepted = "; accepted: a quaternion [x, y, z, w] of length 1";
  if (!value.isNumbers(4)) return refuse(value.line, key + " is " + value.kindName() + accepted);
  double square = 0.0;
  for (const TomlValue &item : value.items) square += item.num * item.num;
  const double length = std::sqrt(square);
  if (!(std::abs(length - 1.0) <= kTolerance))
    return refuse(value.line, key + " has the length " + formatNumber(length) + accepted);
  // A normalised quaternion stays as it is, so that a scene can be written and read again.
  constexpr double kRounding = 4.0 * std::numeric_limits<double>::epsilon();
  const double divisor = std::abs(length - 1.0) <= kRounding ? 1.0 : length;
  for (std::size_t i = 0; i < 4; ++i) out[i] = value.items[i].num / divisor;
  return true;
}

bool SceneReader::checkFix(const TomlValue &keys, SceneFix &fix) {
  return !fix.motion.quaternion || keys.find("rotation_deg") == nullptr ||
         refuse(keys.line, "the fix has 'rotation_deg' and 'quaternion'; accepted: one of them");
}

bool SceneReader::checkLoad(const TomlValue &keys, SceneLoad &load) {
  if (load.force_N.has_value() == load.pressure_Pa.has_value())
    return refuse(keys.line, std::string("the load has ") +
                                 (load.force_N ? "'force' and 'pressure'" : "no 'force' and no 'pressure'") +
                                 "; accepted: one of force = [x, y, z] in N, pressure = p in Pa");
  const TomlValue *follower = keys.find("follower");
  return follower == nullptr || load.pressure_Pa ||
         refuse(follower->line,
                "follower is for a pressure; a force keeps its direction; accepted: no 'follower' here");
}

bool SceneReader::read(const std::string &, const TomlValue &value, std::vector<ScenePart> &out) {
  if (!requireTables("parts", kPart, value)) return false;
  std::vector<ScenePart> parts;
  for (const TomlValue &table : value.items) {
    ScenePart part;
    part.line = table.line;
    if (!requireKeys("a part of a body", kPart, table, {"region", "material"}) ||
        !read("region", *table.find("region"), part.region) ||
        !readMaterial("material", *table.find("material"), part.params))
      return false;
    parts.push_back(std::move(part));
  }
  out = std::move(parts);
  return true;
}

bool SceneReader::read(const std::string &, const TomlValue &value, std::vector<SceneRefinement> &out) {
  if (!requireTables("sampling.refine", kRefinement, value)) return false;
  std::vector<SceneRefinement> refinements;
  for (const TomlValue &table : value.items) {
    SceneRefinement refinement;
    refinement.line = table.line;
    const std::string accepted = "a number above 0, m";
    if (!requireKeys("an entry of sampling.refine", kRefinement, table, {"region", "spacing"}) ||
        !read("region", *table.find("region"), refinement.region) ||
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
