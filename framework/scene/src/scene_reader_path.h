// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "c3de/core/text.h"
#include "scene_reader.h"

namespace c3de::scene {

template <class Place, class Own>
bool SceneReader::readWaypoints(const TomlValue &value, const char *accepted, std::size_t least,
                                const std::vector<std::string> &keys, std::vector<Place> &out, const Own &own) {
  if (!requireTables("path", accepted, value)) return false;
  if (value.items.size() < least)
    return refuse(value.line, "path has " + std::to_string(value.items.size()) + " place; accepted: " + accepted);
  std::vector<Place> path;
  for (const TomlValue &table : value.items) {
    Place place;
    for (const auto &[key, member] : table.entries) {
      if (key == "time") {
        const char *time = "a number of at least 0, s; of a quasi-static solution the load factor";
        if (!readNumber("time", time, member, place.time_s)) return false;
        if (place.time_s < 0.0)
          return refuse(member.line, "time is " + formatNumber(place.time_s) + "; accepted: " + time);
      } else if (key == "at") {
        if (!readVec3(key, member, place.at_m)) return false;
      } else if (std::find(keys.begin(), keys.end(), key) != keys.end()) {
        if (!own(place, key, member)) return false;
      } else {
        return refuseKey(member.line, key, "a waypoint of a path", keys);
      }
    }
    for (const char *key : {"time", "at"})
      if (table.find(key) == nullptr)
        return refuse(table.line, std::string("a place of the path has no '") + key + "'; accepted: " + accepted);
    if (!path.empty() && !(place.time_s > path.back().time_s))
      return refuse(table.line, "time " + formatNumber(place.time_s) + " follows " + formatNumber(path.back().time_s) +
                                    " in the path; accepted: times that ascend");
    path.push_back(place);
  }
  out = std::move(path);
  return true;
}

}  // namespace c3de::scene
