// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "c3de/abi/iface/attachment.h"
#include "c3de/abi/iface/changes.h"
#include "c3de/abi/iface/contact.h"
#include "c3de/abi/iface/grasp.h"
#include "c3de/abi/iface/simulator.h"
#include "c3de/core/expected.h"
#include "c3de/core/parameter.h"
#include "c3de/core/plugin_table.h"
#include "c3de/core/vec.h"
#include "c3de/scene/simulator_table.h"

namespace c3de::session {

using scene::simulatorTable;

/// The simulator's declarations for a scope (C3DE_SIM_SCOPE_*).
[[nodiscard]] Expected<std::vector<ParameterDecl>> simulatorDeclarations(c3de_object *simulator, std::uint32_t scope);

/// Whether it reads fills and implements displacement().
[[nodiscard]] bool supportsFills(const c3de_simulator_v1 *table);

/// Whether it can interrupt a step.
[[nodiscard]] bool endsSteps(const c3de_simulator_v1 *table);

/// Hash of the present state. Errors (plugin): it has none. [sim]
[[nodiscard]] Expected<std::uint64_t> stateHash(const c3de_simulator_v1 *table, c3de_object *simulator);

/// Steps, time and what else the simulator states about itself. [sim]
[[nodiscard]] Expected<c3de_sim_status> simulatorStatus(const c3de_simulator_v1 *table, c3de_object *simulator);

/// Makes the present state the snapshot that is drawn. A simulation reports an error at its next snapshot. [sim]
void publishSnapshot(c3de_object *simulator);

/// The present skin of a body, m; empty where the simulator does not provide it. [sim]
[[nodiscard]] std::vector<Vec3> surfacePositions(c3de_object *simulator, c3de_handle body);

struct ProbeSample {
  std::string name;
  Vec3 position_m{}, velocity_m_s{};
};
/// The present state of every probe. [sim]
[[nodiscard]] Expected<std::vector<ProbeSample>> readProbes(const c3de_simulator_v1 *table, c3de_object *simulator);

/// The table for pairs and probe tools; null: the simulator supports neither. The error (ErrorCode::plugin) states what
/// is wrong with it. Any thread.
[[nodiscard]] Expected<const c3de_contact_v1 *> contactTable(c3de_object *simulator);

/// Same for attachments.
[[nodiscard]] Expected<const c3de_attachment_v1 *> attachmentTable(c3de_object *simulator);
/// Same for changes.
[[nodiscard]] Expected<const c3de_changes_v1 *> changesTable(c3de_object *simulator);
/// Same for grasps.
[[nodiscard]] Expected<const c3de_grasp_v1 *> graspTable(c3de_object *simulator);

struct ProbeToolSample {
  std::string name;
  Vec3 position_m{}, force_N{};
};
/// The present state of every probe tool; empty where the simulator has none. [sim]
[[nodiscard]] Expected<std::vector<ProbeToolSample>> readProbeTools(c3de_object *simulator);

/// A larger point count is invalid: indices are 32 bits wide.
inline constexpr std::uint64_t kMaxPoints = 0xfffffffeu;

/// A counted reference to an object of a plugin.
class ObjectRef {
 public:
  ObjectRef() = default;
  /// Takes over the caller's reference.
  explicit ObjectRef(c3de_object *object) : object_(object) {}
  ObjectRef(ObjectRef &&other) noexcept : object_(other.object_) { other.object_ = nullptr; }
  ObjectRef &operator=(ObjectRef &&other) noexcept {
    std::swap(object_, other.object_);
    return *this;
  }
  ~ObjectRef() { releaseObject(object_); }
  [[nodiscard]] c3de_object *get() const { return object_; }

 private:
  c3de_object *object_ = nullptr;
};

}  // namespace c3de::session
