// SPDX-License-Identifier: Apache-2.0
// Parameters, bodies and obstacles.
#include "simulator/change_kinds.h"

#include <algorithm>

#include "c3de/abi/iface/parameter_ids.h"
#include "simulator/world_simulator.h"

namespace pointbased {
namespace {

using sdk::Error;

/// "world.gravity, world.box.enabled"
std::string idsOf(const ParameterEntries &values) {
  std::string ids;
  for (const ParameterEntry &value : values) ids += (ids.empty() ? "" : ", ") + value.id;
  return ids;
}

/// Whether it is accepted depends on other parameters, or it changes others: its order among them counts.
bool dependsOnOthers(const ParameterEntry &value) {
  return value.id.rfind("world.box.", 0) == 0 || value.id == "solver.integrator" || value.id == "rigid" ||
         value.id == C3DE_PARAM_ID_FREE || isAccuracyTarget(value.id);
}

/// "Gravity" of "world.gravity".
std::string labelOf(std::span<const c3de_param_decl> declarations, const std::string &id) {
  for (const c3de_param_decl &d : declarations)
    if (sdk::text(d.id) == id) return std::string(sdk::text(d.label));
  return id;
}

std::shared_ptr<const ParameterValues> bodyValues(const SimulatorParts &parts, const ParameterEntries &entries) {
  return std::make_shared<const ParameterValues>(valuesOf(parts.world.context.laws.declarations(), entries));
}

void requirePlacement(const Placement &placement) {
  requireFinite("the placement", placement.position, placement.scale);
  requireRotation(placement.rotation);
  require(placement.scale > 0.0, "a scale is not above 0");
}

}  // namespace

MeshData dataOf(const Services &services, c3de_handle mesh) {
  const auto positions = sdk::orThrow(services.meshes.positions(mesh));
  const auto triangles = sdk::orThrow(services.meshes.triangles(mesh));
  MeshData out;
  for (std::size_t i = 0; i < positions.size(); ++i)
    out.positions_mm.emplace_back(positions[i][0], positions[i][1], positions[i][2]);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    out.triangles.push_back({triangles[t][0], triangles[t][1], triangles[t][2]});
  return out;
}

sdk::MeshHandle meshOf(const Services &services, const MeshData &data) {
  for (const Vec3 &x : data.positions_mm) requireFinite("a point of a mesh", x);
  for (const auto &triangle : data.triangles)
    for (const std::uint32_t corner : triangle)
      require(corner < data.positions_mm.size(), "a triangle has a corner that does not exist");
  return sdk::orThrow(services.meshes.create(viewOf(std::span<const Vec3>(data.positions_mm)),
                                             sdk::rows<std::uint32_t, 3>(std::span(data.triangles))));
}

std::string SetWorldParameters::key() const {
  return std::any_of(values.begin(), values.end(), dependsOnOthers) ? std::string() : idsOf(values);
}

bool SetWorldParameters::isOfTheView() const {
  return !values.empty() && std::all_of(values.begin(), values.end(), [](const ParameterEntry &value) {
    return pointbased::isOfTheView(value.id) || value.id == "solver.step_budget";
  });
}

std::string SetWorldParameters::text() const {
  return "set " + (values.size() == 1 ? labelOf(worldDeclarations(), values.front().id) : idsOf(values));
}

void SetWorldParameters::apply(SimulatorParts &parts, ChangeAccess access) const {
  std::vector<c3de_param_value> borrowed;
  for (const ParameterEntry &value : values) borrowed.push_back(value.abi());
  parts.parameters.set(access, borrowed);
}

std::string SetBodyParameter::key() const {
  return dependsOnOthers(value) ? std::string() : body.name + '\n' + std::to_string(body.number) + '\n' + value.id;
}

std::string SetBodyParameter::text() const {
  return "set " + labelOf(bodyDeclarations(), value.id) + " of " + textOf(body);
}

void SetBodyParameter::apply(SimulatorParts &parts, ChangeAccess access) const {
  parts.bodies.setParameter(access, parts.world.table.bodyNamed(body), value.abi());
}

void RebuildBody::prepare(SimulatorParts &parts, const sdk::Progress &progress) {
  if (built) return;
  const auto asked = bodyValues(parts, values);
  BodySource from;
  {
    const std::lock_guard lock(parts.world.mutex);
    from = parts.world.table.body(parts.world.table.bodyNamed(body))->source;
  }
  const bool isRepeated = inputs.has_value();
  if (isRepeated) {
    require(inputs->parts.size() == from.parts.size(), "the body has another number of parts");
    for (std::size_t i = 0; i < from.parts.size(); ++i)
      from.parts[i].values = valuesOf(parts.world.context.laws.declarations(), inputs->parts[i]);
    for (const Load &grab : inputs->grabs) {
      require(validate(grab.region).has_value(), "the region of a pull is not one");
      requireFinite("a pull", grab.force, grab.pressure, grab.ramp);
    }
    from.grabs = inputs->grabs;
  } else {
    Inputs &recorded = inputs.emplace();
    recorded.sampling = parts.accuracy.inputs();
    for (const BodyPart &part : from.parts) recorded.parts.push_back(entriesOf(part.values));
    recorded.grabs = from.grabs;
  }
  const SamplingRequest request =
      isRepeated ? parts.accuracy.repeatedRequest(inputs->sampling) : parts.accuracy.requestFor(inputs->sampling);
  built = std::make_shared<BuiltBody>(parts.bodies.build(body.name, from, *asked, request, progress));
  source = std::make_shared<const BodySource>(std::move(from));
}

void RebuildBody::apply(SimulatorParts &parts, ChangeAccess access) {
  parts.bodies.replace(access, parts.world.table.bodyNamed(body), *built, *bodyValues(parts, values), source->parts);
}

void LoadBody::prepare(SimulatorParts &parts, const sdk::Progress &progress) {
  if (built) return;
  requirePlacement(placement);
  const auto asked = bodyValues(parts, values);
  if (replaced) {
    const std::lock_guard lock(parts.world.mutex);
    (void)parts.world.table.bodyNamed(*replaced);
  }
  source = std::make_shared<BodySource>();
  source->mesh = std::make_shared<const sdk::MeshHandle>(meshOf(parts.world.context.services, mesh));
  source->placement = placement;
  source->tissues = std::make_shared<const std::vector<std::string>>();
  const bool isRepeated = inputs.has_value();
  if (!isRepeated) inputs = parts.accuracy.inputs();
  const SamplingRequest request =
      isRepeated ? parts.accuracy.repeatedRequest(*inputs) : parts.accuracy.requestFor(*inputs);
  built = std::make_shared<BuiltBody>(parts.bodies.build(name, *source, *asked, request, progress));
}

void LoadBody::apply(SimulatorParts &parts, ChangeAccess access) {
  const std::uint64_t before = replaced ? parts.world.table.bodyNamed(*replaced) : 0;
  BodyRecord record;
  record.name = name;
  record.source = *source;
  record.values = bodyValues(parts, values);
  parts.bodies.addLoaded(access, std::move(record), *built);
  if (before != 0) RemoveObject{RemoveObject::What::body, *replaced}.apply(parts, access);
}

void AddObstacle::prepare(SimulatorParts &parts, const sdk::Progress &) {
  if (built) return;
  requirePlacement(placement);
  require(friction >= 0.0 && std::isfinite(friction) && restitution >= 0.0 && restitution <= 1.0,
          "friction or restitution is out of range");
  const sdk::MeshHandle handle = meshOf(parts.world.context.services, mesh);
  built = std::make_shared<RemovedObstacle>(
      parts.obstacles.build(name, handle.handle(), placement, {friction, restitution}));
}

void AddObstacle::apply(SimulatorParts &parts, ChangeAccess access) {
  const std::uint64_t resets = parts.world.resets;
  const std::uint64_t id = parts.obstacles.addBuilt(access, *built);
  added = parts.world.table.obstacle(id)->identity();
  hasReset = parts.world.resets != resets;
}

void RestoreObstacle::apply(SimulatorParts &parts, ChangeAccess access) {
  const RemovedObstacle *removed = parts.obstacles.removed(obstacle);
  if (!removed) throw Error(C3DE_E_NOT_FOUND, "no obstacle '" + textOf(obstacle) + "' was removed");
  if (!pose) pose = Pose{removed->pose, parts.world.simulator.steps() == 0};
  requireRotation(pose->motion.rotation);
  requireFinite("a pose", pose->motion.centre, pose->motion.displacement);
  const std::uint64_t resets = parts.world.resets;
  parts.obstacles.restore(access, *this);
  hasReset = parts.world.resets != resets;
}

void MoveObstacle::apply(SimulatorParts &parts, ChangeAccess access) {
  requireRotation(target.rotation);
  requireFinite("a pose", target.centre, target.displacement);
  const std::uint64_t id = parts.world.table.obstacleNamed(obstacle);
  parts.obstacles.guide(access, id, target);
  isPlaced = !parts.world.simulator.world().isGuided(id);
}

}  // namespace pointbased
