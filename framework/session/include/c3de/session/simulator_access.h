// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "c3de/abi/draft/iface/simulator.h"
#include "c3de/core/expected.h"
#include "c3de/core/parameter.h"
#include "c3de/core/vec.h"

namespace c3de::session {

/// The simulator's table; the error (ErrorCode::plugin) says what the object lacks.
[[nodiscard]] Expected<const c3de_simulator_v0 *> simulatorTable(c3de_object *simulator);

/// What the simulator declares for a scope (C3DE_SIM_SCOPE_*).
[[nodiscard]] Expected<std::vector<ParameterDecl>> simulatorDeclarations(c3de_object *simulator, std::uint32_t scope);

/// Whether it reads fills and answers displacement(): revision 3.
[[nodiscard]] bool servesFills(const c3de_simulator_v0 *table);

/// Whether it can end a step half way: revision 4.
[[nodiscard]] bool endsSteps(const c3de_simulator_v0 *table);

/// Of the skin of a body as it is now, m; empty where nobody says. [sim]
[[nodiscard]] std::vector<Vec3> surfelPositions(c3de_object *simulator, c3de_handle body);

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
  ~ObjectRef() {
    if (object_ != nullptr) object_->vt->release(object_);
  }
  [[nodiscard]] c3de_object *get() const { return object_; }

 private:
  c3de_object *object_ = nullptr;
};

}  // namespace c3de::session
