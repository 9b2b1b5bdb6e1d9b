// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulator/change_kinds.h"
#include "simulator/saved_interactions.h"
#include "simulator/simulated_world.h"

namespace pointbased {

/// Grabs that pull one part of a body: holds of other plugins, and the grab of the pinch, which has no entry here.
class Holds {
 public:
  explicit Holds(SimulatedWorld &world) : world_(world) {}

  void state(c3de_handle hold, c3de_sim_hold_state *out);

  // The mutex of the world is held.
  /// Starts a hold. Its number is assigned if it is 0. @return its id
  std::uint64_t add(ChangeAccess access, std::uint64_t body, BeginHold &hold);
  void pull(ChangeAccess access, std::uint64_t hold, const Vec3 &target, const std::optional<Mat3> &rotation);
  void remove(ChangeAccess access, std::uint64_t id);
  void removeOf(ChangeAccess access, std::uint64_t body);
  /// 0 if there is none. @param id, number  of the hold
  [[nodiscard]] std::uint64_t numberOf(std::uint64_t id) const;
  [[nodiscard]] std::uint64_t holdNumbered(std::uint64_t number) const;
  [[nodiscard]] bool keepsShape(std::uint64_t hold) const { return holds_.at(hold).keepsShape; }
  /// Starts the grab of the pinch. @param ownLimit  N, set for the tool in addition to the limit of the tissue; 0: none
  void grab(ChangeAccess access, std::uint64_t body, Grab grab, double ownLimit);
  void moveGrab(ChangeAccess access, std::uint64_t body, const Vec3 &target);
  void releaseGrab(ChangeAccess access, std::uint64_t body);
  [[nodiscard]] std::vector<SavedHold> saved() const;
  /// Replaces all holds by those of a state that was loaded. One that is also there now, by its number, keeps its
  /// handle; those of another simulator get new ones.
  void restore(const std::vector<SavedHold> &saved);
  void clear() { holds_.clear(); }

 private:
  struct Hold {
    std::uint64_t body = 0;
    Vec3 fromNamed = Vec3::Zero();  // from the specified point to the middle of the held patch, m, before rotation
    Vec3 target = Vec3::Zero();     // world, m
    Mat3 rotation = Mat3::Identity();
    bool keepsShape = false;
    std::uint64_t number = 0;
  };
  [[nodiscard]] Hold &holdOrThrow(c3de_handle hold);

  SimulatedWorld &world_;
  Simulator &simulator_ = world_.simulator;
  BodyTable &table_ = world_.table;
  std::map<std::uint64_t, Hold> holds_;
  std::uint64_t lastNumber_ = 0;
};

}  // namespace pointbased
