// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "c3de/sdk/object.hpp"
#include "c3de/sdk/simulator.hpp"

namespace c3de::test {

/// A simulator without bodies whose steps advance time by a millisecond; made with the SDK.
class CountingSimulator : public sdk::Object<CountingSimulator> {
 public:
  static std::array<sdk::Interface, 1> interfaces();

  void attach(c3de_handle) {}
  void declarations(std::uint32_t, const c3de_param_decl **decls, std::uint64_t *n, std::uint64_t *stride) {
    *decls = nullptr;
    *n = 0;
    *stride = sizeof(c3de_param_decl);
  }
  void setWorld(const c3de_param_value *, std::uint64_t, std::uint64_t) {}
  void addBody(const c3de_sim_body *, c3de_handle *) { throw sdk::Error(C3DE_E_UNSUPPORTED, "no bodies here"); }
  void addObstacle(const c3de_sim_obstacle *, c3de_handle *) {}
  void addProbe(c3de_str, c3de_handle, const double *, c3de_handle *) {}
  void setBodyParam(c3de_handle, const c3de_param_value *) {}
  void getBodyParam(c3de_handle, c3de_str, c3de_param_value *) {}
  void remove(c3de_handle) {}
  void clear() {}
  void step() { ++steps_; }
  void reset() { steps_ = 0; }
  void publish() {}
  void status(c3de_sim_status *out) const {
    const std::uint32_t size = out->size;
    *out = {size, 0, steps_, 1e-3 * static_cast<double>(steps_), 1e-3, 0, 0, 0, 0, 0, 0};
  }
  void stateHash(std::uint64_t *out) const { *out = steps_; }
  c3de_status report(c3de_sink json) const { return sdk::put(json, "{}"); }
  void bodyAt(std::uint64_t, c3de_handle *) {}
  void bodyInfo(c3de_handle, c3de_sim_body_info *) {}
  c3de_status enumFields(c3de_handle, void *, c3de_status(C3DE_CALL *)(void *, const c3de_sim_field *)) {
    return C3DE_OK;
  }
  c3de_status readField(c3de_handle, std::uint32_t, c3de_str, c3de_mview) { return C3DE_E_NOT_FOUND; }
  c3de_status triangles(c3de_handle, c3de_view *) { return C3DE_E_NOT_FOUND; }
  c3de_status enumProbes(void *, c3de_status(C3DE_CALL *)(void *, const c3de_sim_probe *)) { return C3DE_OK; }

 private:
  std::uint64_t steps_ = 0;
};

inline std::array<sdk::Interface, 1> CountingSimulator::interfaces() {
  return {sdk::interfaceOf(sdk::kSimulatorTable<CountingSimulator>)};
}

}  // namespace c3de::test
