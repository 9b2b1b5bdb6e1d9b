// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include "c3de/abi/iface/simulator.h"
#include "c3de/core/guarded_memory.h"

namespace c3de::scene {

/// The points of a body as lent to a force field: copies, so that the field cannot modify or retain the simulator's
/// arrays. Margins between the arrays detect writes beyond their bounds.
class SharedPoints {
 public:
  /// Copies the simulator's arrays, which stay unchanged until the next call. Arrays are not null, count > 0.
  void lend(const c3de_sim_points &points);
  /// The points with the copied arrays instead of the simulator's.
  [[nodiscard]] const c3de_sim_points &points() const { return lent_; }

  /// The array whose bounds were exceeded by a write; null: none.
  [[nodiscard]] const char *overrun() const;
  /// The read-only array that was modified; null: none. Restores all of them.
  [[nodiscard]] const char *restoreReadOnly();
  /// Copies the forces to the simulator's array.
  void returnForces() const;

 private:
  struct Array {
    const char *name;
    const double *source;  ///< of the simulator
    std::size_t numbers;
    double *begin;
  };
  GuardedMemory memory_;
  c3de_sim_points lent_{}, given_{};
  std::array<Array, 4> arrays_{};  ///< in memory order; the forces are last, before guarded memory
};

}  // namespace c3de::scene
