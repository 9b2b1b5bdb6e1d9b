// SPDX-License-Identifier: Apache-2.0
#include "simulator/bodies.h"

#include <algorithm>

#include "c3de/sdk/structs.hpp"

namespace pointbased {

using sdk::Error;

void Bodies::add(const c3de_sim_body *body, c3de_handle *out) {
  const c3de_sim_body in = sdk::readStruct(body, "body");
  BodyRecord record;
  record.name = std::string(sdk::text(in.name));
  ParameterValues values(world_.context.laws.declarations());
  sdk::orThrow(values.set(in.params, in.params_n, in.params_stride));
  record.source = readSource(in, values);
  record.values = std::make_shared<const ParameterValues>(std::move(values));
  record.checkRigid();
  SamplingInputs inputs = accuracy_.inputs();
  BuiltBody built = buildBody(world_.context.services, world_.context.laws, record.name, in.mesh, record.source,
                              *record.values, accuracy_.requestFor(inputs), sdk::Progress(in.progress));
  record.source.mesh = std::make_shared<const sdk::MeshHandle>(copyMesh(world_.context.services, in.mesh));
  const StepInterrupt::Waiting waiting(world_.request);
  const StateLock lock(world_);
  std::uint64_t id = 0;
  addBuilt(std::move(record), built, &id);
  if (out) *out = {id};
}

BuiltBody Bodies::build(const std::string &name, const BodySource &source, const ParameterValues &values,
                        const SamplingRequest &request, const sdk::Progress &progress) const {
  return buildBody(world_.context.services, world_.context.laws, name, source.mesh->handle(), source, values, request,
                   progress);
}

void Bodies::addBuilt(BodyRecord record, BuiltBody &built, std::uint64_t *id) {
  record.assignBuilt(built);
  record.checkFree(*record.values, simulator_.quasiStatic());
  record.checkInsideWalls(simulator_.world().settings().box, built.body->rest().spacing);
  world_.reset();
  *id = simulator_.addBody(std::move(built.body));
  table_.addBody(*id, std::move(record));
}

void Bodies::addLoaded(ChangeAccess, BodyRecord record, BuiltBody &built) {
  record.surface = built.surface;
  record.checkFree(*record.values, simulator_.quasiStatic());
  parameters_.growBox(record);
  std::uint64_t id = 0;
  addBuilt(std::move(record), built, &id);
}

void Bodies::setParameter(ChangeAccess, std::uint64_t body, const c3de_param_value &in) {
  BodyRecord &record = table_.bodyOrThrow(body);
  ParameterValues changed = *record.values;
  sdk::orThrow(changed.set(in));
  const std::string_view id = sdk::text(in.id);
  for (const c3de_param_decl &d : changed.declarations())
    if (sdk::text(d.id) == id && (d.flags & C3DE_PARAM_NEEDS_RESET))
      throw Error(C3DE_E_STATE, std::string(id) + " takes effect when the body is built again");
  if (isOfTheSurroundings(id)) {
    if (const auto set = simulator_.world().setFoundation(body, foundationOf(changed)); !set)
      throw Error(C3DE_E_ARG, record.name + ": " + std::string(id) + ": " + set.error());
  } else if (id == "rigid" || id == C3DE_PARAM_ID_FREE) {
    record.checkFree(changed, simulator_.quasiStatic());
    simulator_.world().setRigid(body, isRigid(changed), isFree(changed));
  } else {
    // Parts keep the values they specify themselves.
    for (BodyPart &part : record.source.parts)
      if (std::find(part.own.begin(), part.own.end(), id) == part.own.end()) sdk::orThrow(part.values.set(in));
    forces_.invalidateMasses(body);
    simulator_.world().setConstitution(body, constitutionOf(world_.context.laws, record.name, record.source, changed));
  }
  record.values = std::make_shared<const ParameterValues>(std::move(changed));
}

void Bodies::getParameter(c3de_handle body, c3de_str id, c3de_param_value *out) {
  const std::lock_guard lock(world_.mutex);
  const c3de_param_value found = sdk::orThrow(table_.bodyOrThrow(body.v).values->get(sdk::text(id)));
  sdk::writeStruct(out, found, "out");
}

std::optional<BodySource> Bodies::source(std::uint64_t body) const {
  const std::lock_guard lock(world_.mutex);
  const BodyRecord *found = table_.body(body);
  return found ? std::optional(found->source) : std::nullopt;
}

void Bodies::replace(ChangeAccess, std::uint64_t body, BuiltBody &built, const ParameterValues &values,
                     const std::vector<BodyPart> &parts) {
  BodyRecord record = table_.bodyOrThrow(body);
  record.source.parts = parts;
  const ContactPairs pairs = simulator_.world().contactPairs();
  const std::vector<Attachment> attached = table_.attachmentsOf(body);
  record.assignBuilt(built);
  record.values = std::make_shared<const ParameterValues>(values);
  table_.removeBody(body);
  simulator_.removeBody(body);
  world_.reset();
  const std::size_t id = simulator_.addBody(std::move(built.body));
  table_.addBody(id, std::move(record));
  for (auto &[number, grasp] : world_.grasps)
    if (grasp.scene && grasp.scene->body == body) grasp.scene->body = id;  // on the same skin
  for (const auto &[pair, settings] : pairs)
    if (pair.first == body || pair.second == body)
      simulator_.world().setContactPair(id, pair.first == body ? pair.second : pair.first, settings);
  for (const Attachment &attachment : attached) attachments_.reattach(attachment, body, id);
}

}  // namespace pointbased
