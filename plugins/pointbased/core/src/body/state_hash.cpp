// SPDX-License-Identifier: Apache-2.0
#include "body/state_hash.h"

namespace pointbased::detail {
namespace {

void hashBytes(std::uint64_t &hash, const void *data, std::size_t size) {
  const auto *bytes = static_cast<const unsigned char *>(data);
  for (std::size_t i = 0; i < size; ++i) hash = (hash ^ bytes[i]) * 1099511628211ull;
}

// Numbers of vectors and matrices, without padding.
template <class Matrices>
void hashAll(std::uint64_t &hash, const Matrices &matrices) {
  for (const auto &m : matrices) hashBytes(hash, m.data(), static_cast<std::size_t>(m.size()) * sizeof(double));
}

}  // namespace

std::uint64_t hashOf(const Body &body, std::uint64_t hash) {
  const State &state = body.state();
  hashAll(hash, state.displacements);
  hashAll(hash, state.velocities);
  hashAll(hash, state.history.plasticInverse);
  for (const PronyPoint &point : state.history.prony) {
    hashBytes(hash, point.previous.data(), 9 * sizeof(double));
    hashAll(hash, point.internal);
  }
  for (const HourglassHistory &modes : state.history.modes) {
    hashBytes(hash, modes.previous.data(), 12 * sizeof(double));
    hashAll(hash, modes.relaxed);
  }
  if (body.rereferenceCount() == 0) return hash;
  hashAll(hash, body.rest().positions);
  hashAll(hash, body.rest().stencils.reference);
  return hash;
}

}  // namespace pointbased::detail
