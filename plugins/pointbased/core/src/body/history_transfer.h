// SPDX-License-Identifier: Apache-2.0
// Plastic and viscous memory of a body for another discretisation of the same material. Private to the core.
#pragma once

#include "pointbased/body.h"

namespace pointbased::detail {

/// Plastic strain from the nearest point of the same material, or from the nearest one where none is near. No effect if
/// one of the two has no plastic strain.
/// @param to    history of a body that is filled as `rest`
void transferPlasticStrain(const Body &from, State &to, const RestState &rest);

/// Plastic strain and Prony stresses in the same manner. Relaxed hourglass modes are reset, because they belong to
/// cells.
void transferHistory(const Body &from, State &to, const RestState &rest);

}  // namespace pointbased::detail
