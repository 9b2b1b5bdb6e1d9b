// SPDX-License-Identifier: Apache-2.0
// Private to the session.
#pragma once

#include <vector>

#include "c3de/abi/iface/simulator.h"
#include "c3de/core/expected.h"
#include "c3de/core/parameter.h"
#include "c3de/scene/scene_file.h"

namespace c3de::session {

/// The values of a body as its simulator declares them.
struct FittedBody {
  std::vector<ParameterValue> values;
  std::vector<std::vector<ParameterValue>> parts;  ///< in the order of SceneBody::parts
};

/// A scene of which a simulator knows every key and takes every value.
struct FittedScene {
  scene::SceneFile scene;
  std::vector<ParameterValue> world;
  std::vector<FittedBody> bodies;                      ///< in the order of the scene
  std::vector<std::vector<ParameterValue>> obstacles;  ///< likewise
};

/// Checks a scene against what a simulator declares and serves. Reads no file. Errors begin with the place in the
/// scene: an unknown key (names the nearest), a value outside of what is accepted, volumes, contact pairs, probe tools,
/// attachments or grasps that the simulator does not serve. Any thread.
[[nodiscard]] Expected<FittedScene> fitScene(c3de_object *simulator, scene::SceneFile scene);

}  // namespace c3de::session
