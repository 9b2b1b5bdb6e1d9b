// SPDX-License-Identifier: Apache-2.0
// Private to the session.
#pragma once

#include <vector>

#include "c3de/abi/iface/simulator.h"
#include "c3de/core/expected.h"
#include "c3de/core/parameter.h"
#include "c3de/scene/scene_file.h"

namespace c3de::session {

/// The values of a body, matched to the declarations of the simulator.
struct FittedBody {
  std::vector<ParameterValue> values;
  std::vector<std::vector<ParameterValue>> parts;  ///< in the order of SceneBody::parts
};

/// A scene whose keys and values a simulator has all accepted.
struct FittedScene {
  scene::SceneFile scene;
  std::vector<ParameterValue> world;
  std::vector<FittedBody> bodies;                      ///< in the order of the scene
  std::vector<std::vector<ParameterValue>> obstacles;  ///< in the order of the scene
};

/// Checks a scene against the declarations and features of a simulator. Reads no file. Errors begin with the location
/// in the scene: an unknown key (names the nearest), a value outside the accepted range, volumes, contact pairs, probe
/// tools, attachments or grasps that the simulator does not support. Any thread.
[[nodiscard]] Expected<FittedScene> fitScene(c3de_object *simulator, scene::SceneFile scene);

}  // namespace c3de::session
