// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "pointbased/attachment.h"
#include "pointbased/body.h"
#include "pointbased/contact_settings.h"
#include "pointbased/world_settings.h"

namespace pointbased {

namespace detail {
struct SimulationState;
}

struct Probe {
  std::size_t id = 0;
  std::string name;
  std::size_t body = 0;
  Vec3 reference = Vec3::Zero();  ///< world, m
  Interpolation binding;          ///< one point
  /// m, displacement of the point from `reference` to its binding position (rereferencing.h)
  Vec3 referenceShift = Vec3::Zero();
};

/// What is simulated: bodies, obstacles, attachments, probes, their settings and the contact of their pairs. Each is
/// named by an id; an id stays valid until its object is removed, and is not reused.
class World {
 public:
  explicit World(detail::SimulationState &state) : state_(state) {}

  [[nodiscard]] const WorldSettings &settings() const;
  /// May be called between any two steps; positions, velocities and plastic state are kept. A change to a quasi-static
  /// solution begins at load factor 0. A change from one continues at the time at which every ramp has reached the load
  /// factor: no earlier than the load factor times the longest ramp.
  void setSettings(const WorldSettings &settings);

  std::size_t addBody(std::unique_ptr<Body> body);
  bool removeBody(std::size_t id);
  [[nodiscard]] Body *body(std::size_t id);
  [[nodiscard]] const Body *body(std::size_t id) const;
  [[nodiscard]] std::vector<std::size_t> bodyIds() const;
  void clear();

  std::size_t addObstacle(Obstacle obstacle);
  /// Adds an obstacle while the simulation runs: an instrument. The simulated history stays valid, also when
  /// removeObstacle() removes the instrument. Simulator::reset() removes it; StateArchive::restore() restores the
  /// instruments of the checkpoint.
  std::size_t addInstrument(Obstacle obstacle);
  bool removeObstacle(std::size_t id);
  [[nodiscard]] std::span<const Obstacle> obstacles() const;
  /// Null if no obstacle has this id.
  [[nodiscard]] const Obstacle *obstacle(std::size_t id) const;
  [[nodiscard]] bool isInstrument(std::size_t id) const;
  /// Moves an obstacle from its present pose to another one at constant rates, after which it stays at rest. It rotates
  /// about target.centre by the smaller angle while that centre moves in a straight line. This replaces the obstacle's
  /// own motion, which reset() restores. Before the first step the obstacle is moved at once, and one that was static
  /// starts from there from then on. No effect if no obstacle has this id.
  /// @param target    finite
  /// @param duration  s, or load factor, >= 0
  void guideObstacle(std::size_t id, const RigidMotion &target, double duration);
  /// True if guideObstacle() has moved it since the last reset().
  [[nodiscard]] bool isGuided(std::size_t id) const;
  /// Obstacle::motion as reset() restores it; empty: it is static, or no obstacle has this id.
  [[nodiscard]] std::function<RigidMotion(double t)> motionAtReset(std::size_t id) const;
  /// Rigid motion of an obstacle at the present time.
  [[nodiscard]] RigidMotion obstacleMotion(std::size_t id) const;
  /// obstacles() as one body sees them: with the friction of its pairs. Those that it passes through have no
  /// Obstacle::closest. Valid until one of these settings changes.
  [[nodiscard]] std::span<const Obstacle> obstaclesOf(std::size_t body) const;
  /// Same for WorldSettings::box.
  [[nodiscard]] WorldBox boxOf(std::size_t body) const;

  /// @return  id of the probe; 0 if there is no such body
  std::size_t addProbe(std::string name, std::size_t body, const Vec3 &reference);
  bool removeProbe(std::size_t id);
  [[nodiscard]] const std::vector<Probe> &probes() const;
  struct ProbeState {
    Vec3 position, velocity;  ///< world, m and m/s
  };
  [[nodiscard]] ProbeState probeState(const Probe &probe) const;

  /// Changes the material of a body during the simulation; forces and the stable step are updated.
  void setConstitution(std::size_t body, Constitution constitution);
  /// Changes how the surroundings hold a body during the simulation. Errors: those of Body::setFoundation(); nothing is
  /// changed then.
  [[nodiscard]] Result<void> setFoundation(std::size_t body, const Foundation &foundation);
  /// Body::setLiveSupports() during the simulation; wakes it. No effect on an unknown id.
  void setLiveSupports(std::size_t body, std::vector<LiveSupport> supports);
  /// Body::setRigid() during the simulation. A static body costs nothing and cannot be grabbed. The stable step of a
  /// rigid body limits no step.
  void setRigid(std::size_t body, bool rigid, bool free = false);

  /// Joins a body to another body, to an obstacle or to its surroundings. Call between two steps; the simulation is
  /// reset. The attachment is removed together with either of the two that it joins.
  /// Errors, with nothing changed: settings that validate() refuses; an unknown id, or the same body twice; a body
  /// without a surface; no part of the surface is in the region, near enough and facing the other body.
  /// @return  id of the attachment
  [[nodiscard]] Result<std::size_t> addAttachment(const Attachment &attachment);
  bool removeAttachment(std::size_t id);
  /// Present state of all attachments, in the order in which they were added.
  [[nodiscard]] std::vector<AttachmentSummary> attachments() const;

  /// Contact between bodies. May be called between any two steps. It is a setting, not state: reset() and restore() do
  /// not change it. Wakes all bodies.
  /// @param contact  friction >= 0
  void setContact(const ContactSettings &contact);
  [[nodiscard]] const ContactSettings &contact() const;
  /// Contact of one pair, in either order; kWorldBox for the walls. The setting is removed together with the body or
  /// obstacle. No effect if one of the ids does not exist, or if neither is a body.
  void setContactPair(std::size_t a, std::size_t b, const ContactPairSettings &settings);
  [[nodiscard]] const ContactPairs &contactPairs() const;
  /// Settings in effect between two: those of the pair, or the general ones. friction >= 0, that of the obstacle or the
  /// walls if the pair has none. Not enabled if contact between bodies is off or an id does not exist.
  [[nodiscard]] ContactPairSettings contactPair(std::size_t a, std::size_t b) const;
  /// Whether two bodies collide with each other, or a body with itself: contact is enabled, and both have a skin.
  [[nodiscard]] bool canTouch(std::size_t a, std::size_t b) const;

  /// World positions and normals of a body's surfels; the second overload in single precision for display.
  void surfels(std::size_t body, std::vector<Vec3> &positions, std::vector<Vec3> &normals);
  void surfels(std::size_t body, std::vector<Vec3f> &positions, std::vector<Vec3f> &normals);

 private:
  detail::SimulationState &state_;
};

}  // namespace pointbased
