// SPDX-License-Identifier: Apache-2.0
// This engine as a program would use it: with its own choice of step, law and stabilisation.
#pragma once

#include "moving_body.h"
#include "pointbased/simulator.h"
#include "scenes.h"

namespace peers {

/// The lattice of a scene, built once for all measurements. Errors: those of buildRestState().
[[nodiscard]] pointbased::Result<std::shared_ptr<const pointbased::RestState>> buildEngineRest(const Scene &scene,
                                                                                               std::size_t nodes);

/// @param dt  s; 0: the engine's choice
[[nodiscard]] std::unique_ptr<MovingBody> makeEngineBody(const Scene &scene,
                                                         const std::shared_ptr<const pointbased::RestState> &rest,
                                                         const Solid &solid, pointbased::Integrator integrator,
                                                         double dt);

/// The measured displacement at rest, by the quasi-static solution, m. Throws with the reason where there is none.
[[nodiscard]] Vec3 engineAtRest(const Scene &scene, const std::shared_ptr<const pointbased::RestState> &rest,
                                const Solid &solid);

}  // namespace peers
