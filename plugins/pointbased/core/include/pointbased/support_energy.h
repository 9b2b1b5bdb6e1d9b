// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pointbased/body.h"

namespace pointbased {

/// J, stored in the springs by which fixes hold a body: Σ |λ|²/(2 k) of their present forces λ. Together with strain
/// and stabilisation energy it is half of the work of the loads of a linear static solution (Clapeyron).
[[nodiscard]] double supportEnergy(const Body &body);

}  // namespace pointbased
