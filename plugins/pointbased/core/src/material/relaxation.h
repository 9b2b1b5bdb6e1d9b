// SPDX-License-Identifier: Apache-2.0
// Parts of pronyStress() that depend on the law. Private to the core.
#pragma once

#include "pointbased/material.h"

namespace pointbased::detail {

/// D(F), the stress of the shear modulus in the law's own measure of strain e, Pa; symmetric.
[[nodiscard]] Mat3 pronyDrive(const Material &material, const Mat3 &F);
/// d/dF (Q : e(F)) at fixed, symmetric Q: the relaxed part of P, Pa.
[[nodiscard]] Mat3 pronyPushed(const Material &material, const Mat3 &F, const Mat3 &Q);

}  // namespace pointbased::detail
