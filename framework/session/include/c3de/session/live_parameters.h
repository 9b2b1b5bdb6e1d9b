// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "c3de/abi/iface/simulator.h"
#include "c3de/core/expected.h"
#include "c3de/core/parameter.h"
#include "c3de/session/change_log.h"
#include "c3de/session/session.h"

namespace c3de::session {

/// The parameters of a simulator that has been built, by the paths of `--set`: those of the world ("world.gravity") and
/// of its bodies ("body.liver.material.youngs_modulus"; "material." may be left out where the rest is unique). Call on
/// the simulation's thread between two steps, or before it runs.
class LiveParameters {
 public:
  struct Parameter {
    std::string path;
    ParameterDecl decl;  ///< its id is the path without the body
  };

  /// @param source  what the simulator was built from
  /// Errors (plugin): its declarations cannot be read.
  [[nodiscard]] static Expected<LiveParameters> create(Session &session, c3de_object *simulator,
                                                       const SimulationSource &source);

  /// Those of the world, then those of every body, as they are now.
  [[nodiscard]] std::vector<Parameter> all() const;
  /// The present value. Errors: usage, an unknown path, names the nearest; state, the value of a parameter of the world
  /// is not known, because a session has changed it.
  [[nodiscard]] Expected<ParameterValue> get(std::string_view path) const;
  /// @param text  as after `--set PATH=`
  /// Errors: usage, an unknown path or a refused value, with what is accepted; nothing has changed then.
  [[nodiscard]] Expected<void> set(std::string_view path, std::string_view text);

 private:
  struct Target {
    std::string body;  ///< empty: the world
    c3de_handle handle{};
    std::string id;
  };
  LiveParameters(Session &session, c3de_object *simulator, const c3de_simulator_v1 *table)
      : session_(&session), simulator_(simulator), table_(table) {}
  [[nodiscard]] Expected<Target> find(std::string_view path) const;
  [[nodiscard]] const std::vector<std::pair<std::string, c3de_handle>> &bodies() const;
  [[nodiscard]] Error unknown(const std::string &path,
                              const std::vector<std::pair<std::string, c3de_handle>> &bodies) const;
  [[nodiscard]] Error reasonOf(std::string_view path, c3de_status code) const;

  Session *session_;
  c3de_object *simulator_;
  const c3de_simulator_v1 *table_;
  std::vector<ParameterDecl> ofWorld_, ofBody_;
  std::map<std::string, ParameterValue> world_;                      ///< the simulator does not state them
  mutable std::vector<std::pair<std::string, c3de_handle>> bodies_;  ///< as bodies() found them last
  bool isWorldKnown_ = true;
};

/// Applies PATH=VALUE to a scene as scene::applyOverride(); "material." may be left out of the path of a body. Errors do
/// not begin with `--set`.
[[nodiscard]] Expected<void> applyAssignment(scene::SceneFile &scene, const std::string &assignment,
                                             const scene::MaterialLibrary &materials);

}  // namespace c3de::session
