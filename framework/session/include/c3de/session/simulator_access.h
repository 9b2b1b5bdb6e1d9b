// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "c3de/abi/iface/attachment.h"
#include "c3de/abi/iface/contact.h"
#include "c3de/abi/iface/grasp.h"
#include "c3de/abi/iface/simulator.h"
#include "c3de/core/expected.h"
#include "c3de/core/foreign_table.h"
#include "c3de/core/parameter.h"
#include "c3de/core/vec.h"
#include "c3de/scene/simulator_table.h"

namespace c3de::session {

using scene::simulatorTable;

/// What the simulator declares for a scope (C3DE_SIM_SCOPE_*).
[[nodiscard]] Expected<std::vector<ParameterDecl>> simulatorDeclarations(c3de_object *simulator, std::uint32_t scope);

/// Whether it reads fills and answers displacement().
[[nodiscard]] bool servesFills(const c3de_simulator_v1 *table);

/// Whether it can end a step half way.
[[nodiscard]] bool endsSteps(const c3de_simulator_v1 *table);

/// Of the skin of a body as it is now, m; empty where nobody says. [sim]
[[nodiscard]] std::vector<Vec3> surfacePositions(c3de_object *simulator, c3de_handle body);

struct ProbeSample {
  std::string name;
  Vec3 position_m{}, velocity_m_s{};
};
/// Every probe, as it is now. [sim]
[[nodiscard]] Expected<std::vector<ProbeSample>> readProbes(const c3de_simulator_v1 *table, c3de_object *simulator);

/// The table for pairs and probe tools; null: the simulator serves neither. The error (ErrorCode::plugin) says what is
/// wrong with it. Any thread.
[[nodiscard]] Expected<const c3de_contact_v1 *> contactTable(c3de_object *simulator);

/// The same for attachments.
[[nodiscard]] Expected<const c3de_attachment_v1 *> attachmentTable(c3de_object *simulator);
/// And for grasps.
[[nodiscard]] Expected<const c3de_grasp_v1 *> graspTable(c3de_object *simulator);

struct ProbeToolSample {
  std::string name;
  Vec3 position_m{}, force_N{};
};
/// Every probe tool, as it is now; none where the simulator has none. [sim]
[[nodiscard]] Expected<std::vector<ProbeToolSample>> readProbeTools(c3de_object *simulator);

/// A set of more points than this is rubbish: its indices are 32 bits wide.
inline constexpr std::uint64_t kMostPoints = 0xfffffffeu;

/// A counted reference to an object of a plugin.
class ObjectRef {
 public:
  ObjectRef() = default;
  /// Takes over the count of the caller.
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
