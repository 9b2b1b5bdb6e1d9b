// SPDX-License-Identifier: Apache-2.0
// Sweeps over contacts, one after the other: the components of a velocity fill a register of four. Private to the core.
#pragma once

#include <cstddef>

#include "pointbased/types.h"

namespace pointbased::kernels {

/// Numbers per contact in SweepJob::sides.
enum ContactSide : std::size_t {
  kNormalOfContact = 0,
  kSurfaceVelocity = 4,
  kTangentialImpulse = 8,
  kMass = 12,
  kRoomOfContact = 13,
  kTangentialMass = 14,  ///< of contacts that move rigid bodies
  kContactNumbers = 16
};

/// Numbers per rigid body that a contact moves, in SweepJob::rigidParts: how its velocity and spin follow an impulse P
/// on the contact, share P and turn P, and where its four particles are.
enum RigidPart : std::size_t { kRigidShare = 0, kRigidTurn = 1, kRigidArms = 10, kRigidNumbers = 22 };

/// What a sweep reads and writes; vectors are padded to four numbers, the last 0.
struct SweepJob {
  std::size_t count = 0;                              ///< contacts of this sweep
  const Index *which = nullptr;                       ///< [count] their numbers, ascending; null: all
  const Index *rows = nullptr;                        ///< [contacts + 1]
  const Index *slots = nullptr;                       ///< [entries]
  const double *shares = nullptr, *pushes = nullptr;  ///< [entries] φ, φ/m
  double *velocities = nullptr;                       ///< [slots][4] in, out: m/s
  double *sides = nullptr;  ///< [contacts][kContactNumbers]; tangential impulses out, and by how much the normal
                            ///< velocity was above `least` before
  const double *inverseMasses = nullptr, *least = nullptr, *friction = nullptr;  ///< [contacts]; friction null: without
  /// [contacts] m/s per N s, by which `least` falls as the impulse grows, and m/s, where it ends; null: it stays
  const double *compliances = nullptr, *floors = nullptr;
  double *impulses = nullptr;  ///< [contacts] in, out: N s
  /// [contacts + 1] rows of parts; [parts] the first of four slots, the others follow; [parts][kRigidNumbers]. Null:
  /// nothing is rigid. Entries in the slots of rigid bodies have no push.
  const Index *rigidRows = nullptr, *rigidSlots = nullptr;
  const double *rigidParts = nullptr;
};

struct SweepResult {
  double change = 0.0, speed = 0.0;  ///< m/s
};

/// One sweep of projected Gauss-Seidel, forwards or backwards: impulses that keep normal velocities above `least`,
/// within the cone of friction.
[[nodiscard]] SweepResult sweepContacts(const SweepJob &job, bool backwards);

}  // namespace pointbased::kernels
