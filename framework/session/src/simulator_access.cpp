// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/simulator_access.h"

#include <cstddef>

#include "c3de/core/text.h"

namespace c3de::session {

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

bool servesFills(const c3de_simulator_v1 *table) { return table->displacement != nullptr; }

bool endsSteps(const c3de_simulator_v1 *table) { return table->interrupt != nullptr; }

std::vector<Vec3> surfacePositions(c3de_object *simulator, c3de_handle body) {
  const auto table = simulatorTable(simulator);
  c3de_sim_body_info info{};
  info.size = sizeof info;
  if (!table || (*table)->body_info(simulator, body, &info) < 0 || info.surface_points > kMostPoints) return {};
  std::vector<Vec3> positions(info.surface_points);
  const c3de_mview view{positions.data(), positions.size(), 3, C3DE_F64, sizeof(Vec3)};
  if ((*table)->read_field(simulator, body, C3DE_SIM_ON_SURFACE, toAbi(C3DE_SIM_FIELD_POSITION), view) < 0) return {};
  return positions;
}

Expected<std::vector<ProbeSample>> readProbes(const c3de_simulator_v1 *table, c3de_object *simulator) {
  std::vector<ProbeSample> samples;
  const c3de_status code =
      table->enum_probes(simulator, &samples, [](void *visitor, const c3de_sim_probe *probe) -> c3de_status {
        // Nothing may be thrown through the boundary.
        try {
          const auto vec = [](const double(&v)[3]) { return Vec3{v[0], v[1], v[2]}; };
          static_cast<std::vector<ProbeSample> *>(visitor)->push_back(
              {shownText(fromAbi(probe->name)), vec(probe->position_m), vec(probe->velocity_m_s)});
          return C3DE_OK;
        } catch (...) {
          return C3DE_E_NOMEM;
        }
      });
  if (code < 0)
    return fail(ErrorCode::plugin, "the simulator does not say its probes (status " + std::to_string(code) + ")");
  return samples;
}

Expected<const c3de_contact_v1 *> contactTable(c3de_object *simulator) {
  const auto found = queryObject(simulator, C3DE_IFACE_CONTACT_ID, 1);
  if (!found) return nullptr;  // it is asked about bodies elsewhere: an object that cannot be asked is noticed there
  const auto *table = static_cast<const c3de_contact_v1 *>(*found);
  if (std::string problem = tableProblem(table); !problem.empty())
    return fail(ErrorCode::plugin, "the simulator's table of " + std::move(problem));
  if (table->size < sizeof(c3de_contact_v1) ||
      (table->add_probe_tool == nullptr) != (table->enum_probe_tools == nullptr))
    return fail(ErrorCode::plugin, std::string("of add_probe_tool() and enum_probe_tools() in the table of ") +
                                       C3DE_IFACE_CONTACT_ID + " one is missing; accepted: both, or null for both");
  return table;
}

namespace {

template <class Table>
Expected<const Table *> tableOf(c3de_object *simulator, const char *id) {
  const auto found = queryObject(simulator, id, 1);
  if (!found) return nullptr;
  const auto *table = static_cast<const Table *>(*found);
  if (std::string problem = tableProblem(table); !problem.empty())
    return fail(ErrorCode::plugin, "the simulator's table of " + std::move(problem));
  return table;
}

}  // namespace

Expected<const c3de_attachment_v1 *> attachmentTable(c3de_object *simulator) {
  return tableOf<c3de_attachment_v1>(simulator, C3DE_IFACE_ATTACHMENT_ID);
}

Expected<const c3de_grasp_v1 *> graspTable(c3de_object *simulator) {
  return tableOf<c3de_grasp_v1>(simulator, C3DE_IFACE_GRASP_ID);
}

Expected<std::vector<ProbeToolSample>> readProbeTools(c3de_object *simulator) {
  std::vector<ProbeToolSample> samples;
  const auto table = contactTable(simulator);
  if (!table) return tl::unexpected(table.error());
  if (*table == nullptr || (*table)->enum_probe_tools == nullptr) return samples;
  const c3de_status code = (*table)->enum_probe_tools(
      simulator, &samples, [](void *visitor, const c3de_sim_probe_tool_state *tool) -> c3de_status {
        // Nothing may be thrown through the boundary.
        try {
          const auto vec = [](const double(&v)[3]) { return Vec3{v[0], v[1], v[2]}; };
          static_cast<std::vector<ProbeToolSample> *>(visitor)->push_back(
              {shownText(fromAbi(tool->name)), vec(tool->position_m), vec(tool->force_N)});
          return C3DE_OK;
        } catch (...) {
          return C3DE_E_NOMEM;
        }
      });
  if (code < 0)
    return fail(ErrorCode::plugin, "the simulator does not say its probe tools (status " + std::to_string(code) + ")");
  return samples;
}

}  // namespace c3de::session
