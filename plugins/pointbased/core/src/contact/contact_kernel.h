// SPDX-License-Identifier: Apache-2.0
// Gauss-Seidel sweeps over contacts, one after the other. The components of a velocity share one register of four.
// Private to the core.
#pragma once

#include <cstddef>

#include "pointbased/types.h"

namespace pointbased::kernels {

/// Layout of SweepJob::records: offsets of the numbers of a contact.
enum ContactRecordOffset : std::size_t {
  kContactNormal = 0,
  kSurfaceVelocity = 4,
  kTangentialImpulse = 8,
  kMass = 12,
  kVelocityMargin = 13,
  kTangentialMass = 14,  ///< only for contacts with rigid bodies
  kContactRecordSize = 16
};

/// Layout of SweepJob::rigidParts: numbers per rigid body in a contact. An impulse P on the contact changes its
/// velocity by linearResponse · P and its spin by angularResponse · P; arms are the positions of its four particles.
enum RigidPart : std::size_t {
  kRigidLinearResponse = 0,
  kRigidAngularResponse = 1,
  kRigidArms = 10,
  kRigidRecordSize = 22
};

/// Input and output of a sweep. Vectors are padded to four numbers, the last one is 0.
struct SweepJob {
  std::size_t count = 0;                                  ///< contacts in this sweep
  const Index *subset = nullptr;                          ///< [count] their numbers, ascending; null: all
  const Index *rows = nullptr;                            ///< [contacts + 1]
  const Index *slots = nullptr;                           ///< [entries]
  const double *weights = nullptr, *responses = nullptr;  ///< [entries] φ, φ/m
  double *velocities = nullptr;                           ///< [slots][4] in, out: m/s
  double *records = nullptr;  ///< [contacts][kContactRecordSize]; out: tangential impulses, and by how much the normal
                              ///< velocity exceeded `minVelocities` before
  const double *inverseMasses = nullptr, *minVelocities = nullptr,
               *friction = nullptr;  ///< [contacts]; friction null: none
  /// [contacts] rate at which `minVelocities` decreases with the impulse, m/s per N s, and its lower limit, m/s; null:
  /// constant
  const double *compliances = nullptr, *minVelocityLimits = nullptr;
  double *impulses = nullptr;  ///< [contacts] in, out: N s
  /// [contacts + 1] rows of parts; [parts] first of four consecutive slots; [parts][kRigidRecordSize]. Null: no rigid
  /// bodies. Entries in slots of rigid bodies have responses of 0.
  const Index *rigidRows = nullptr, *rigidSlots = nullptr;
  const double *rigidParts = nullptr;
};

struct SweepResult {
  double change = 0.0, speed = 0.0;  ///< m/s
};

/// One sweep of projected Gauss-Seidel, forwards or backwards. Impulses keep normal velocities above `minVelocities`
/// and stay within the friction cone.
[[nodiscard]] SweepResult sweepContacts(const SweepJob &job, bool backwards);

}  // namespace pointbased::kernels
