// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include "c3de/abi/iface/simulator.h"
#include "c3de/core/guarded_memory.h"

namespace c3de::scene {

/// The points of a body as they are lent to a force field: copies, so that whatever it writes to them, or keeps of them,
/// is not the simulator's. Between the arrays are margins that show who has written beyond one.
class LentPoints {
 public:
  /// Copies what the simulator gives, which stays as it is until the next call. Arrays are not null, count > 0.
  void lend(const c3de_sim_points &points);
  /// With the arrays of this in the place of the simulator's.
  [[nodiscard]] const c3de_sim_points &points() const { return lent_; }

  /// The array beyond whose end, or before whose beginning, was written; null: none.
  [[nodiscard]] const char *overrun() const;
  /// The array that was written to though it is lent for reading; null: none. All are then as they were lent.
  [[nodiscard]] const char *restoreReadOnly();
  /// Hands the forces to the simulator.
  void giveForces() const;

 private:
  struct Array {
    const char *name;
    const double *source;  ///< of the simulator
    std::size_t numbers;
    double *begin;
  };
  GuardedMemory memory_;
  c3de_sim_points lent_{}, given_{};
  std::array<Array, 4> arrays_{};  ///< in the order of their places; the forces are last, before memory that is guarded
};

}  // namespace c3de::scene
