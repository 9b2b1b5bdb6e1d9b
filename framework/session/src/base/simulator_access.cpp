// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/simulator_access.h"

#include <cstddef>

#include "c3de/core/first_size.h"
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
  if (const std::string problem = arrayProblem(decls, n, stride); !problem.empty())
    return fail(ErrorCode::plugin, "the simulator's parameters of scope " + std::to_string(scope) + ": " + problem);
  return readDeclarations(decls, n, stride);
}

bool supportsFills(const c3de_simulator_v1 *table) { return table->displacement != nullptr; }

bool endsSteps(const c3de_simulator_v1 *table) { return table->interrupt != nullptr; }

Expected<std::uint64_t> stateHash(const c3de_simulator_v1 *table, c3de_object *simulator) {
  std::uint64_t hash = 0;
  if (table->state_hash(simulator, &hash) < 0) return fail(ErrorCode::plugin, "the simulator gives no state hash");
  return hash;
}

Expected<c3de_sim_status> simulatorStatus(const c3de_simulator_v1 *table, c3de_object *simulator) {
  c3de_sim_status status{};
  status.size = sizeof status;
  if (const c3de_status code = table->status(simulator, &status); code < 0)
    return fail(ErrorCode::plugin, "the simulator does not say its status (" + std::to_string(code) + ")");
  return status;
}

void publishSnapshot(c3de_object *simulator) {
  if (const auto table = simulatorTable(simulator)) (void)(*table)->publish(simulator);
}

std::vector<Vec3> surfacePositions(c3de_object *simulator, c3de_handle body) {
  const auto table = simulatorTable(simulator);
  c3de_sim_body_info info{};
  info.size = sizeof info;
  if (!table || (*table)->body_info(simulator, body, &info) < 0 || info.surface_points > kMaxPoints) return {};
  std::vector<Vec3> positions(info.surface_points);
  const c3de_mview view{positions.data(), positions.size(), 3, C3DE_F64, sizeof(Vec3)};
  if ((*table)->read_field(simulator, body, C3DE_SIM_ON_SURFACE, toAbi(C3DE_SIM_FIELD_POSITION), view) < 0) return {};
  return positions;
}

namespace {

/// The items that a simulator has passed to a visitor, and why one was refused; empty: none was.
template <class T>
struct Seen {
  std::vector<T> all;
  std::string problem;

  /// @param what  "probes"
  [[nodiscard]] Expected<std::vector<T>> answer(c3de_status code, const char *what) {
    if (!problem.empty())
      return fail(ErrorCode::plugin,
                  std::string("of the ") + what + " of the simulator one cannot be read: " + problem);
    if (code < 0)
      return fail(ErrorCode::plugin,
                  std::string("the simulator does not say its ") + what + " (status " + std::to_string(code) + ")");
    return std::move(all);
  }
};

/// For each(): adds read(*in). No exception may cross the boundary.
template <class T, class Struct, class Read>
c3de_status see(void *visitor, const Struct *in, const Read &read) noexcept {
  try {
    auto &seen = *static_cast<Seen<T> *>(visitor);
    seen.problem = sizeProblem(in);
    if (!seen.problem.empty()) return C3DE_E_ARG;
    seen.all.push_back(read(*in));
    return C3DE_OK;
  } catch (...) {
    return C3DE_E_NOMEM;
  }
}

Vec3 vec(const double (&v)[3]) { return {v[0], v[1], v[2]}; }

}  // namespace

Expected<std::vector<ProbeSample>> readProbes(const c3de_simulator_v1 *table, c3de_object *simulator) {
  Seen<ProbeSample> seen;
  const c3de_status code =
      table->enum_probes(simulator, &seen, [](void *visitor, const c3de_sim_probe *probe) -> c3de_status {
        return see<ProbeSample>(visitor, probe, [](const c3de_sim_probe &in) -> ProbeSample {
          return {displayText(fromAbi(in.name)), vec(in.position_m), vec(in.velocity_m_s)};
        });
      });
  return seen.answer(code, "probes");
}

Expected<const c3de_contact_v1 *> contactTable(c3de_object *simulator) {
  const auto found = queryObject(simulator, C3DE_IFACE_CONTACT_ID, 1);
  if (!found) return nullptr;  // queried about bodies elsewhere: an object that cannot be queried is detected there
  const auto *table = static_cast<const c3de_contact_v1 *>(*found);
  if (std::string problem = tableProblem(table); !problem.empty())
    return fail(ErrorCode::plugin, "the simulator's table of " + std::move(problem));
  if (const std::string problem = sizeProblem(table); !problem.empty())
    return fail(ErrorCode::plugin, std::string("the simulator's table of ") + C3DE_IFACE_CONTACT_ID + ": " + problem);
  if ((table->add_probe_tool == nullptr) != (table->enum_probe_tools == nullptr))
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

Expected<const c3de_changes_v1 *> changesTable(c3de_object *simulator) {
  return tableOf<c3de_changes_v1>(simulator, C3DE_IFACE_CHANGES_ID);
}

Expected<const c3de_grasp_v1 *> graspTable(c3de_object *simulator) {
  return tableOf<c3de_grasp_v1>(simulator, C3DE_IFACE_GRASP_ID);
}

Expected<std::vector<ProbeToolSample>> readProbeTools(c3de_object *simulator) {
  Seen<ProbeToolSample> seen;
  const auto table = contactTable(simulator);
  if (!table) return tl::unexpected(table.error());
  if (*table == nullptr || (*table)->enum_probe_tools == nullptr) return seen.all;
  const c3de_status code = (*table)->enum_probe_tools(
      simulator, &seen, [](void *visitor, const c3de_sim_probe_tool_state *tool) -> c3de_status {
        return see<ProbeToolSample>(visitor, tool, [](const c3de_sim_probe_tool_state &in) -> ProbeToolSample {
          return {displayText(fromAbi(in.name)), vec(in.position_m), vec(in.force_N)};
        });
      });
  return seen.answer(code, "probe tools");
}

}  // namespace c3de::session
