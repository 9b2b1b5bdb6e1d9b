// SPDX-License-Identifier: Apache-2.0
#include "simulator/saved_state.h"

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "base/accuracy_target.h"
#include "c3de/abi/iface/parameter_ids.h"

namespace pointbased {

using sdk::Error;

namespace {

/// Precedes the interactions. The bytes of StateArchive begin with another number.
constexpr std::uint64_t kInteractions = 0x3153'4e4f'4954'4341;

std::span<const double> numbersOf(const Vec3 &v) { return {v.data(), 3}; }

/// Adds many vectors by their bit patterns.
void addDigest(sdk::SceneRecord &record, const std::string &field, std::span<const Vec3> vectors) {
  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  record.addDigest(field, std::span<const double>(vectors.empty() ? nullptr : vectors[0].data(), 3 * vectors.size()));
}

/// The time limit of a step, and the accuracy target and the requested order of a sampling, are not physics: the
/// sampling itself is recorded.
bool isOfThePhysics(std::string_view id) {
  return !isOfTheView(id) && !isAccuracyTarget(id) && id != C3DE_PARAM_ID_ACCURACY_BODIES &&
         id != "solver.step_budget" && id != "sampling.order";
}

void addValues(sdk::SceneRecord &record, const std::string &owner, const ParameterValues &values) {
  for (const c3de_param_decl &d : values.declarations())
    if (isOfThePhysics(sdk::text(d.id)))
      record.add(owner + std::string(sdk::text(d.id)), sdk::orThrow(values.get(sdk::text(d.id))));
}

void addBodyFields(sdk::SceneRecord &record, const BodyRecord &of, const Body &body) {
  const std::string owner = "body '" + of.name + "': ";
  const RestState &rest = body.rest();
  record.add(owner + "number of phyxels", static_cast<double>(rest.phyxelCount()));
  record.add(owner + "spacing", rest.spacing);
  record.add(owner + "origin", numbersOf(rest.origin));
  addDigest(record, owner + "places of its phyxels", rest.positions);
  record.addDigest(owner + "masses of its phyxels", body.masses());
  record.addDigest(owner + "held phyxels", body.inverseMasses());
  record.add(owner + "points of second order", static_cast<double>(rest.stencils.quadratic.points.size()));
  addValues(record, owner, *of.values);
  for (std::size_t p = 0; p < of.source.parts.size(); ++p) {
    const BodyPart &part = of.source.parts[p];
    const std::string name = part.name.empty() ? "part " + std::to_string(p) : "tissue '" + part.name + "'";
    for (const c3de_param_decl &d : part.values.declarations())
      if (isOfThePhysics(sdk::text(d.id)) && sdk::text(d.id).rfind("material.", 0) == 0)
        record.add(owner + name + ", " + std::string(sdk::text(d.id)), sdk::orThrow(part.values.get(sdk::text(d.id))));
  }
  for (std::size_t f = 0; f < of.source.fixes.size(); ++f) {
    const Fix &fix = of.source.fixes[f];
    const std::string name = owner + "fix " + std::to_string(f) + ", ";
    record.add(name + "displacement", numbersOf(fix.displacement));
    record.add(name + "rotation_deg", numbersOf(fix.rotation_deg));
    record.add(name + "centre", numbersOf(fix.centre.value_or(Vec3::Zero())));
    record.add(name + "rotation vector", numbersOf(fix.rotationVector.value_or(Vec3::Zero())));
    record.add(name + "ramp", fix.ramp);
  }
  for (std::size_t l = 0; l < of.source.loads.size(); ++l) {
    const Load &load = of.source.loads[l];
    const std::string name = owner + "load " + std::to_string(l) + ", ";
    record.add(name + "force", numbersOf(load.force));
    record.add(name + "pressure", load.pressure);
    record.add(name + "follower", load.follower ? "true" : "false");
    record.add(name + "ramp", load.ramp);
  }
  // The phyxels to which their regions resolve.
  for (std::size_t f = 0; f < rest.conditions.held.size(); ++f)
    record.addDigest(owner + "region of fix " + std::to_string(f),
                     std::span<const Index>(rest.conditions.held[f].rows.indices));
  for (std::size_t l = 0; l < rest.conditions.loaded.size(); ++l)
    record.addDigest(owner + "region of load " + std::to_string(l),
                     std::span<const double>(rest.conditions.loaded[l].shares));
}

/// @param motion  at the reset; empty: it is static
void addObstacle(sdk::SceneRecord &record, const ObstacleRecord &obstacle, std::size_t rank,
                 const std::function<RigidMotion(double)> &motion) {
  const std::string owner = "obstacle '" + obstacle.name + "': ";
  record.add(owner + "order", static_cast<double>(rank));
  record.add(owner + "friction", obstacle.friction);
  record.add(owner + "restitution", obstacle.restitution);
  // A motion is a function: two that agree at these times count as equal.
  std::vector<double> motionSamples;
  for (const double t : {0.01, 0.1, 0.37, 1.0, 3.3}) {
    if (!motion) continue;
    const RigidMotion at = motion(t);
    const Vec3 displacement = at.displacementOf(Vec3::Zero());
    motionSamples.insert(motionSamples.end(), at.rotation.data(), at.rotation.data() + 9);
    motionSamples.insert(motionSamples.end(), displacement.data(), displacement.data() + 3);
  }
  if (obstacle.tool)
    for (const ToolPose &place : obstacle.tool->path) {
      motionSamples.push_back(place.time);
      motionSamples.insert(motionSamples.end(), place.at.data(), place.at.data() + 3);
      motionSamples.insert(motionSamples.end(), place.axis.data(), place.axis.data() + 3);
    }
  record.addDigest(owner + "motion", std::span<const double>(motionSamples));
  addDigest(record, owner + "shape and place", obstacle.mesh->positions);
}

void addGrasp(sdk::SceneRecord &record, const std::string &name, const std::string &bodyName, const SceneGrasp &grasp) {
  const std::string owner = "grasp '" + name + "': ";
  record.add(owner + "body", bodyName);
  record.add(owner + "jaw", grasp.settings.jaw);
  record.add(owner + "opening", grasp.settings.opening);
  record.add(owner + "closed", grasp.settings.closed);
  record.add(owner + "force_limit", grasp.settings.forceLimit);
  std::vector<double> numbers;
  for (const SkinPoint &point : grasp.jaws.points) {
    for (const Index corner : point.corners) numbers.push_back(static_cast<double>(corner));
    numbers.insert(numbers.end(), point.weights.data(), point.weights.data() + 3);
  }
  record.addDigest(owner + "places on the skin", std::span<const double>(numbers));
  numbers.clear();
  for (const GraspPose &place : grasp.path) {
    numbers.push_back(place.time);
    numbers.insert(numbers.end(), place.at.data(), place.at.data() + 3);
    for (const double number : place.rotation.coeffs()) numbers.push_back(number);
  }
  record.addDigest(owner + "path", std::span<const double>(numbers));
}

}  // namespace

// The scene to which a state belongs: everything it specifies about the physics.
sdk::SceneRecord SavedState::sceneRecord() const {
  sdk::SceneRecord record;
  addValues(record, "", world_.parameters);
  // "auto" follows the accuracy target.
  record.add("precision",
             worldSettings(world_.parameters).precision == Precision::doublePrecision ? "double" : "single");
  // The bytes after the record identify bodies, obstacles and attachments by their order.
  std::size_t bodies = 0, rank = 0, layers = 0;
  for (const auto &[id, of] : table_.bodies()) {
    record.add("body '" + of.name + "': order", static_cast<double>(bodies++));
    addBodyFields(record, of, *simulator_.body(id));
  }
  for (const auto &[id, obstacle] : table_.obstacles()) {
    if (simulator_.world().isInstrument(id)) continue;
    addObstacle(record, obstacle, rank++, simulator_.world().motionAtReset(id));
  }
  for (const auto &[pair, settings] : simulator_.world().contactPairs()) {
    const std::string owner =
        "contact of '" + table_.nameOf(pair.first) + "' and '" + table_.nameOf(pair.second) + "': ";
    record.add(owner + "friction", settings.friction);
    record.add(owner + "enabled", settings.enabled ? "true" : "false");
  }
  for (const auto &[id, attachment] : table_.attachments()) {
    const std::string owner = "attachment '" + attachment.name + "': ";
    record.add(owner + "order", static_cast<double>(layers++));
    record.add(owner + "first", table_.nameOf(attachment.first));
    record.add(owner + "second",
               attachment.second == kSurroundings ? "surroundings" : table_.nameOf(attachment.second));
    record.add(owner + "within", attachment.within);
    record.add(owner + "stiffness", attachment.stiffness);
    record.add(owner + "tangential", attachment.tangential);
    record.add(owner + "tears_at", attachment.tearsAt);
  }
  for (const AttachmentSummary &now : simulator_.world().attachments()) {
    // The area to which its region resolves.
    record.add("attachment '" + now.name + "': area", now.area);
    record.add("attachment '" + now.name + "': centre", numbersOf(now.centre));
  }
  for (const auto &[id, of] : world_.grasps)
    if (of.scene) addGrasp(record, of.name, table_.nameOf(of.scene->body), *of.scene);
  return record;
}

std::string SavedState::bytes(ChangeAccess) {
  conditions_.update();
  SavedInteractions interactions{obstacles_.savedInstruments(), grasps_.saved(),       holds_.saved(), forces_.saved(),
                                 conditions_.saved(),           forces_.savedMatches()};
  const auto state = simulator_.archive().save();
  if (!state) throw Error(C3DE_E_STATE, state.error());
  std::string bytes = bytesOf(interactions);
  ByteWriter header;
  auto marker = kInteractions, size = static_cast<std::uint64_t>(bytes.size());
  header.number(marker);
  header.number(size);
  return sceneRecord().bytes() + header.bytes() + bytes + *state;
}

SavedInteractions SavedState::takeInteractions(std::string_view &bytes) {
  constexpr std::size_t kHeader = 2 * sizeof(std::uint64_t);
  std::uint64_t marker = 0, size = 0;
  if (bytes.size() < kHeader) return {};
  ByteReader header(bytes.substr(0, kHeader));
  header.number(marker);
  header.number(size);
  if (marker != kInteractions) return {};
  bytes.remove_prefix(kHeader);
  if (size > bytes.size()) throw Error(C3DE_E_FORMAT, "the state ends too early");
  const auto interactions = changeOf<SavedInteractions>(bytes.substr(0, size));
  bytes.remove_prefix(size);
  return interactions;
}

void SavedState::load(const void *bytes, std::uint64_t n) {
  if (bytes == nullptr) throw Error(C3DE_E_ARG, "load_state: bytes is null");
  const StateLock lock(world_);
  std::string_view state(static_cast<const char *>(bytes), static_cast<std::size_t>(n));
  const auto of = sdk::SceneRecord::take(state);
  if (!of) throw Error(C3DE_E_FORMAT, "the state ends too early, or is of another version of the plugin");
  if (const std::string differences = sceneRecord().differencesFrom(*of); !differences.empty())
    throw Error(C3DE_E_ARG, "the state belongs to another scene: " + differences);
  const SavedInteractions interactions = takeInteractions(state);
  for (const SavedHold &hold : interactions.holds) (void)table_.bodyNamed(hold.body);
  for (const SavedMatch &match : interactions.matches) {
    const Body &body = *simulator_.body(table_.bodyNamed(match.body));
    if (match.forces.size() != body.rest().phyxelCount() ||
        !std::all_of(match.forces.begin(), match.forces.end(), [](const Vec3 &f) { return f.allFinite(); }))
      throw Error(C3DE_E_FORMAT, "the forces of the matched body '" + textOf(match.body) + "' do not belong to it");
  }
  const auto grabIds = grasps_.grabIds(interactions.grasps);
  auto loads = forces_.prepare(interactions.loads);
  auto instruments = obstacles_.prepare(interactions.instruments);
  // The forces of supports are part of the state of a body.
  conditions_.update();
  const std::vector<SavedCondition> before = conditions_.saved();
  conditions_.restore(interactions.conditions);
  const auto loaded = simulator_.archive().load(state, std::move(instruments.obstacles));
  if (!loaded) conditions_.restore(before);
  table_.syncInstruments(simulator_);
  if (!loaded) throw Error(C3DE_E_FORMAT, loaded.error());
  table_.clearInstrumentHistory();
  for (std::size_t i = 0; i < loaded->size(); ++i) table_.addInstrument((*loaded)[i], instruments.records[i]);
  holds_.restore(interactions.holds);
  for (const auto &[id, record] : table_.bodies())
    for (ActiveGrab &active : simulator_.body(id)->grabs)
      if (const auto found = grabIds.find(active.id); found != grabIds.end()) active.id = found->second;
  grasps_.restore(interactions.grasps);
  forces_.restore(std::move(loads), interactions.matches);
}

}  // namespace pointbased
