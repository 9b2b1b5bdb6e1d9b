// SPDX-License-Identifier: Apache-2.0
// The state of a simulation as bytes.
#include <cstring>

#include "world_simulator.h"

namespace pointbased {

using sdk::Error;

// What a state belongs to: everything that a scene says of the physics.
std::uint64_t WorldSimulator::fingerprint() const {
  std::uint64_t hash = 0xcbf29ce484222325ull;
  const auto addBytes = [&](const void *bytes, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) hash = (hash ^ static_cast<const unsigned char *>(bytes)[i]) * 0x100000001b3ull;
  };
  const auto addNumber = [&](double value) { addBytes(&value, sizeof value); };
  const auto addVector = [&](const Vec3 &v) { addBytes(v.data(), 3 * sizeof(double)); };
  const auto addText = [&](std::string_view text) {
    addNumber(static_cast<double>(text.size()));
    addBytes(text.data(), text.size());
  };
  const auto addValues = [&](const ParameterValues &values) {
    for (const c3de_param_decl &d : values.declarations()) {
      if (isOfTheView(sdk::text(d.id))) continue;
      const c3de_param_value value = sdk::orThrow(values.get(sdk::text(d.id)));
      addText(sdk::text(value.text));
      addNumber(value.num);
      addVector(Vec3(value.vec));
    }
  };
  addValues(world_);
  for (const auto &[id, record] : table_.bodies()) {
    const Body &body = *simulator_.body(id);
    addText(record.name);
    addValues(*record.values);
    for (const BodyPart &part : record.source.parts) addValues(part.values);
    addVector(body.rest().origin);
    for (const Vec3 &x : body.rest().positions) addVector(x);
    for (const double m : body.masses()) addNumber(m);
    for (const double m : body.inverseMasses()) addNumber(m);
    for (const Fix &fix : record.source.fixes) {
      addVector(fix.displacement);
      addVector(fix.rotation_deg);
      addVector(fix.centre.value_or(Vec3::Zero()));
      addVector(fix.rotationVector.value_or(Vec3::Zero()));
      addNumber(fix.ramp);
    }
    for (const Load &load : record.source.loads) {
      addVector(load.force);
      addNumber(load.pressure);
      addNumber(load.follower ? 1.0 : 0.0);
      addNumber(load.ramp);
    }
    // What their regions have come to mean.
    const BoundaryConditions &conditions = body.rest().conditions;
    for (const ConstrainedRegion &held : conditions.held)
      for (const Index i : held.rows.indices) addNumber(static_cast<double>(i));
    for (const LoadedPart &loaded : conditions.loaded)
      for (const double share : loaded.shares) addNumber(share);
  }
  for (const auto &[id, obstacle] : table_.obstacles()) {
    if (simulator_.isInstrument(id)) continue;
    addText(obstacle.name);
    addNumber(obstacle.friction);
    addNumber(obstacle.restitution);
    // A motion is a function: two that meet at these times are taken for one.
    const std::function<RigidMotion(double)> motion = simulator_.motionAtReset(id);
    for (const double t : {0.01, 0.1, 0.37, 1.0, 3.3}) {
      if (!motion) continue;
      const RigidMotion at = motion(t);
      addBytes(at.rotation.data(), 9 * sizeof(double));
      addVector(at.displacementOf(Vec3::Zero()));
    }
    if (obstacle.tool)
      for (const ToolPlace &place : obstacle.tool->path) {
        addNumber(place.time);
        addVector(place.at);
        addVector(place.axis);
      }
    for (const Vec3 &x : obstacle.mesh->positions) addVector(x);
  }
  for (const auto &[pair, settings] : simulator_.contactPairs()) {
    addText(table_.nameOf(pair.first));
    addText(table_.nameOf(pair.second));
    addNumber(settings.friction);
    addNumber(settings.enabled ? 1.0 : 0.0);
  }
  for (const auto &[id, attachment] : table_.attachments()) {
    addText(table_.nameOf(attachment.first));
    addText(attachment.second == kSurroundings ? "" : table_.nameOf(attachment.second));
    for (const double number : {attachment.within, attachment.stiffness, attachment.tangential, attachment.tearsAt})
      addNumber(number);
  }
  for (const auto &[id, record] : grasps_) {
    if (!record.scene) continue;
    const SceneGrasp &grasp = *record.scene;
    addText(record.name);
    addText(table_.nameOf(grasp.body));
    for (const SkinPoint &point : grasp.places.points) {
      for (const Index corner : point.corners) addNumber(static_cast<double>(corner));
      addVector(point.weights);
    }
    for (const double number :
         {grasp.settings.jaw, grasp.settings.opening, grasp.settings.closed, grasp.settings.forceLimit})
      addNumber(number);
    for (const GraspPlace &place : grasp.path) {
      addNumber(place.time);
      addVector(place.at);
      for (const double number : place.rotation.coeffs()) addNumber(number);
    }
  }
  for (const AttachmentSummary &now : simulator_.attachments()) {
    addNumber(now.area);  // what its region has come to mean
    addVector(now.centre);
  }
  return hash;
}

c3de_status WorldSimulator::saveState(c3de_sink sink) {
  const std::lock_guard lock(mutex_);
  if (!liveLoads_.empty()) throw Error(C3DE_E_STATE, "loads that came while it ran act on it; remove them first");
  const auto state = simulator_.savedState();
  if (!state) throw Error(C3DE_E_STATE, state.error());
  const std::uint64_t of = fingerprint();
  std::string bytes(reinterpret_cast<const char *>(&of), sizeof of);
  return sdk::put(sink, bytes + *state);
}

void WorldSimulator::loadState(const void *bytes, std::uint64_t n) {
  if (bytes == nullptr) throw Error(C3DE_E_ARG, "load_state: bytes is null");
  const std::lock_guard lock(mutex_);
  std::string_view state(static_cast<const char *>(bytes), static_cast<std::size_t>(n));
  std::uint64_t of = 0;
  if (state.size() < sizeof of) throw Error(C3DE_E_FORMAT, "the state ends too early");
  std::memcpy(&of, state.data(), sizeof of);
  if (of != fingerprint())
    throw Error(C3DE_E_ARG,
                "the state belongs to another scene: bodies, materials, supports, loads, obstacles or world differ");
  state.remove_prefix(sizeof of);
  const auto gone = simulator_.goToSavedState(state);
  table_.followInstruments(simulator_);
  if (!gone) throw Error(C3DE_E_FORMAT, gone.error());
  liveLoads_.clear();
  holds_.clear();
}

}  // namespace pointbased
