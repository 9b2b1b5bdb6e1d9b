// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "c3de/abi/c3de.h"
#include "c3de/core/vec.h"
#include "c3de/geometry/mesh_io.h"
#include "c3de/pointbased/point_sets.h"

namespace c3de::test {

/// The point-based plugin, loaded from disk into a host without a window, and one simulator of it. All calls use the C
/// tables.
class SimulatorSession {
 public:
  explicit SimulatorSession(unsigned threads);
  ~SimulatorSession();

  struct Placement {
    Vec3 position_m{};
    double scale = 1.0;
    Vec3 rotation_deg = Vec3{};
    std::optional<std::array<double, 16>> matrix = std::nullopt;  ///< column-major, instead of the others
  };
  /// Throws with the text of the plugin when something is refused.
  void setWorld(const std::vector<c3de_param_value> &values);
  c3de_handle addBody(geometry::LoadedMesh mesh, const Placement &placement,
                      const std::vector<c3de_param_value> &values);
  c3de_handle addObstacle(geometry::LoadedMesh mesh, const Placement &placement, double friction);
  /// With the forces of addForce(), as hosts apply them.
  void step();
  /// Acts in every step from now on.
  void addForce(std::function<void(const c3de_force_call &)> apply);
  void reset();
  [[nodiscard]] c3de_sim_status status();
  [[nodiscard]] std::uint64_t stateHash();
  [[nodiscard]] std::string report();  ///< JSON
  [[nodiscard]] c3de_sim_body_info info(c3de_handle body);
  /// A field of phyxels with three components, for example C3DE_SIM_FIELD_POSITION.
  [[nodiscard]] std::vector<Vec3> phyxels(c3de_handle body, const char *field);
  [[nodiscard]] std::vector<double> phyxelMasses(c3de_handle body);
  [[nodiscard]] std::vector<Vec3> surfels(c3de_handle body, const char *field);

  /// A new object of a registered class, with a count of one.
  [[nodiscard]] c3de_object *create(const std::string &classId);
  /// iface.phyxel_set of a body, with a count of one.
  [[nodiscard]] c3de_object *phyxelSet(c3de_handle body);
  void remove(c3de_handle bodyOrObstacle);

  [[nodiscard]] static c3de_param_value number(const char *id, double value);
  [[nodiscard]] static c3de_param_value vector(const char *id, const Vec3 &value);

  [[nodiscard]] c3de_object *object();
  [[nodiscard]] const c3de_simulator_v1 *table();
  [[nodiscard]] std::string takeError();

 private:
  [[nodiscard]] std::vector<double> read(c3de_handle body, std::uint32_t on, const char *field,
                                         std::uint32_t components);
  [[nodiscard]] std::vector<Vec3> vectors(c3de_handle body, std::uint32_t on, const char *field);
  void check(c3de_status status, const char *what);
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace c3de::test
