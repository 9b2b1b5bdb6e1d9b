// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulator/simulated_world.h"

namespace pointbased {

/// Grabs that pull one part of a body: holds of other plugins, and the grab of the pinch, which has no entry here.
class Holds {
 public:
  explicit Holds(SimulatedWorld &world) : world_(world) {}

  void add(c3de_handle body, const c3de_sim_hold *hold, c3de_handle *out);
  void pull(c3de_handle hold, const double *target_m3, const double *quaternion4);
  void state(c3de_handle hold, c3de_sim_hold_state *out);

  /// Starts the grab of the pinch. @param ownLimit  N, set for the tool in addition to the limit of the tissue; 0: none
  void grab(std::uint64_t body, Grab grab, double ownLimit);
  void moveGrab(std::uint64_t body, const Vec3 &target);
  void releaseGrab(std::uint64_t body);

  // The mutex of the world is held.
  /// False if there is none.
  bool remove(std::uint64_t id);
  void removeOf(std::uint64_t body);
  void clear() { holds_.clear(); }

 private:
  struct Hold {
    std::uint64_t body = 0;
    Vec3 fromNamed = Vec3::Zero();  // from the specified point to the middle of the held patch, m, before rotation
    Vec3 target = Vec3::Zero();     // world, m
    Mat3 rotation = Mat3::Identity();
    bool keepsShape = false;
  };
  [[nodiscard]] Hold &holdOrThrow(c3de_handle hold);

  SimulatedWorld &world_;
  Simulator &simulator_ = world_.simulator;
  BodyTable &table_ = world_.table;
  std::map<std::uint64_t, Hold> holds_;
};

}  // namespace pointbased
