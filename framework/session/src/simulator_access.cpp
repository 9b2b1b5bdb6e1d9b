// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/simulator_access.h"

#include <cstddef>

#include "c3de/abi/draft/iface/point_sets.h"
#include "c3de/core/text.h"

namespace c3de::session {

Expected<const c3de_simulator_v0 *> simulatorTable(c3de_object *simulator) {
  const void *table = nullptr;
  const c3de_status code = simulator->vt->query(simulator, toAbi(C3DE_IFACE_SIMULATOR_ID), 0, &table);
  if (code < 0 || table == nullptr)
    return fail(ErrorCode::plugin, std::string("the object does not answer ") + C3DE_IFACE_SIMULATOR_ID + " (status " +
                                       std::to_string(code) + ")");
  const auto *typed = static_cast<const c3de_simulator_v0 *>(table);
  // What came with revision 3 may be missing.
  constexpr std::uint32_t kNeeded = offsetof(c3de_simulator_v0, displacement);
  if (typed->size < kNeeded)
    return fail(ErrorCode::plugin, std::string("the table of ") + C3DE_IFACE_SIMULATOR_ID + " has " +
                                       std::to_string(typed->size) + " bytes; needed: " + std::to_string(kNeeded));
  return typed;
}

Expected<std::vector<ParameterDecl>> simulatorDeclarations(c3de_object *simulator, std::uint32_t scope) {
  const auto table = simulatorTable(simulator);
  if (!table) return tl::unexpected(table.error());
  const c3de_param_decl *decls = nullptr;
  std::uint64_t n = 0, stride = 0;
  const c3de_status code = (*table)->declarations(simulator, scope, &decls, &n, &stride);
  if (code < 0)
    return fail(ErrorCode::plugin, "the simulator does not say its parameters of scope " + std::to_string(scope) +
                                       " (status " + std::to_string(code) + ")");
  return readDeclarations(decls, n, stride);
}

bool servesFills(const c3de_simulator_v0 *table) {
  return table->rev >= 3 && table->size >= offsetof(c3de_simulator_v0, interrupt) && table->displacement != nullptr;
}

bool endsSteps(const c3de_simulator_v0 *table) {
  return table->rev >= 4 && table->size >= offsetof(c3de_simulator_v0, activity) && table->interrupt != nullptr;
}

std::vector<Vec3> surfelPositions(c3de_object *simulator, c3de_handle body) {
  const auto table = simulatorTable(simulator);
  c3de_object *found = nullptr;
  if (!table || (*table)->surfels(simulator, body, &found) < 0 || found == nullptr) return {};
  const ObjectRef set(found);
  const void *answered = nullptr;
  if (found->vt->query(found, toAbi(C3DE_IFACE_SURFEL_SET_ID), 0, &answered) < 0 || answered == nullptr) return {};
  const auto *surfels = static_cast<const c3de_surfel_set_v0 *>(answered);
  std::vector<Vec3> positions(surfels->count(found));
  const c3de_mview view{positions.data(), positions.size(), 3, C3DE_F64, sizeof(Vec3)};
  if (surfels->read(found, C3DE_FIELD_POSITION, view) < 0) positions.clear();
  return positions;
}

}  // namespace c3de::session
