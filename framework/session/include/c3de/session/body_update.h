// SPDX-License-Identifier: Apache-2.0
// Bodies whose mask is corrected while they are simulated.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/imaging/masks.h"
#include "c3de/session/change_log.h"

namespace c3de::session {

class Session;

/// A body that was created from a mask, so that the mask can be edited.
struct MaskedBody {
  std::string name;
  std::shared_ptr<const imaging::Mask> mask;
};
/// Those of a source, in its order; of equal names the last one. Bodies that were removed since are listed as well.
[[nodiscard]] std::vector<MaskedBody> maskedBodies(const SimulationSource &source);

/// The source with another mask of a body; material, sampling, supports and later changes are unchanged.
/// Errors (usage): no body of this name was created from a mask; the mask is empty.
[[nodiscard]] Expected<SimulationSource> withMask(const SimulationSource &source, const std::string &body,
                                                  std::shared_ptr<const imaging::Mask> mask);

/// A body that continued from the body of another simulation (iface/continuation.h).
struct ContinuedBody {
  std::string name;
  bool isSame = false;  ///< its state was copied, otherwise interpolated
  double energyBefore_J = 0.0, energyAfter_J = 0.0;
};
/// Continues from the state of another simulator of the same class, which may be running. Call before the simulator
/// runs. Errors: the class cannot continue; the simulator's text. Any thread.
[[nodiscard]] Expected<std::vector<ContinuedBody>> continueFrom(Session &session, c3de_object *simulator,
                                                                c3de_object *other);

}  // namespace c3de::session
