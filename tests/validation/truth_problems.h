// SPDX-License-Identifier: Apache-2.0
// The problems whose solutions are in truths/truths.json.
#pragma once

#include "solved_body.h"

namespace validation {

using pointbased::MaterialLaw;

inline constexpr double kWidth = 0.04, kLength = 0.2;  // of the beams, m

/// The name in truths.json.
[[nodiscard]] const char *nameOf(MaterialLaw law);

[[nodiscard]] pointbased::BodyShape beam(double length = kLength);
[[nodiscard]] pointbased::BodyShape cube();
[[nodiscard]] Problem cantilever(double spacing, MaterialLaw law, double shear, double length = kLength);
[[nodiscard]] Problem twisted(double spacing, MaterialLaw law);
[[nodiscard]] Problem sagging(double spacing, MaterialLaw law, double gravity);
[[nodiscard]] Problem bondedCube(double spacing, MaterialLaw law, const Vec3 &move, double nu = 0.3);
/// Of about `count` phyxels.
[[nodiscard]] Problem halfBall(std::size_t count, MaterialLaw law);
[[nodiscard]] Problem ringQuarter(std::size_t count, MaterialLaw law, const Vec3 &force);
[[nodiscard]] Problem hangingEllipsoid(std::size_t count, MaterialLaw law, double gravity);
/// Cantilevers under a shear at their tip: a tube, and a bar whose section is a parallelogram.
[[nodiscard]] Problem bentTube(double spacing, MaterialLaw law);
[[nodiscard]] Problem slantedBar(double spacing, MaterialLaw law);
/// A block that a bonded patch is pressed into.
[[nodiscard]] Problem indentation(double spacing, MaterialLaw law, double nu, double depth, bool isByHand = false);
/// A flat beam under pressure on its face: a follower pressure, or an equal dead force.
[[nodiscard]] Problem pressedBeam(double spacing, bool follows);

/// Rotations, evenly distributed; always the same.
[[nodiscard]] std::vector<pointbased::Mat3> randomDirections(std::size_t count);

/// The value of a solution for a reference value, by the last part of its name.
[[nodiscard]] double quantityOf(SolvedBody &body, const std::string &quantity, double length = kLength);

}  // namespace validation
