// SPDX-License-Identifier: Apache-2.0
#include "simulator_access.h"

#include "c3de/core/text.h"

namespace c3de::app {

Expected<const c3de_simulator_v0 *> simulatorTable(c3de_object *simulator) {
  const void *table = nullptr;
  const c3de_status code = simulator->vt->query(simulator, toAbi(C3DE_IFACE_SIMULATOR_ID), 0, &table);
  if (code < 0 || table == nullptr)
    return fail(ErrorCode::plugin, std::string("the object does not answer ") + C3DE_IFACE_SIMULATOR_ID + " (status " +
                                       std::to_string(code) + ")");
  const auto *typed = static_cast<const c3de_simulator_v0 *>(table);
  if (typed->size < sizeof(c3de_simulator_v0))
    return fail(ErrorCode::plugin, std::string("the table of ") + C3DE_IFACE_SIMULATOR_ID + " has " +
                                       std::to_string(typed->size) + " bytes; needed: " +
                                       std::to_string(sizeof(c3de_simulator_v0)));
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

}  // namespace c3de::app
