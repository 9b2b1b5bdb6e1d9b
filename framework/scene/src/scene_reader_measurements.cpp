// SPDX-License-Identifier: Apache-2.0
// Names in [[landmark]], [[distance]] and [[angle]].
#include <algorithm>

#include "scene_reader.h"

namespace c3de::scene {

template <std::size_t N>
bool SceneReader::checkLandmarkNames(const std::string &what, int line, const std::array<std::string, N> &names) {
  std::vector<std::string> known;
  for (const SceneLandmark &landmark : scene_.landmarks) known.push_back(landmark.name);
  for (const std::string &name : names) {
    if (std::find(known.begin(), known.end(), name) == known.end())
      return refuse(line, "there is no landmark '" + name + "'; " +
                              (known.empty() ? "the scene has no [[landmark]]" : suggestion(name, known)));
    if (std::count(names.begin(), names.end(), name) > 1)
      return refuse(line, "the " + what + " has '" + name + "' more than once; accepted: different landmarks");
  }
  return true;
}

bool SceneReader::checkMeasurements() {
  for (SceneLandmark &landmark : scene_.landmarks)
    if (!landmark.body.empty() && !checkBodyName("landmark", landmark.line, landmark.body)) return false;
  for (const SceneDistance &distance : scene_.distances)
    if (!checkLandmarkNames("distance", distance.line, distance.between)) return false;
  return std::all_of(scene_.angles.begin(), scene_.angles.end(),
                     [&](const SceneAngle &angle) { return checkLandmarkNames("angle", angle.line, angle.at); });
}

}  // namespace c3de::scene
