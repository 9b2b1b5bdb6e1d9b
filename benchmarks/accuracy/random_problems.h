// SPDX-License-Identifier: Apache-2.0
// Bodies, materials and loads drawn by seed: the accuracy setting is fitted to them and tested on them.
#pragma once

#include <string>

#include "pointbased/accuracy.h"

namespace dial {

struct RandomProblem {
  std::string name;  ///< family, size, load
  pointbased::BodyShape shape;
  std::vector<pointbased::Vec3> normals;  ///< of the vertices of the surface
  pointbased::BodyRecipe recipe;
  pointbased::Constitution constitution;
  pointbased::Foundation foundation;
  pointbased::Vec3 gravity = pointbased::Vec3::Zero();

  [[nodiscard]] pointbased::AccuracyProblem problem() const {
    return {shape, recipe, constitution, foundation, gravity};
  }
};

/// Lobed, bent, boxy and tubular bodies of 3 … 20 cm in any direction; soft and stiff, nearly incompressible ones too;
/// fixed at one end, at both ends or all around; under their weight, a force or a prescribed motion. The same for equal
/// seeds, on every machine.
[[nodiscard]] RandomProblem randomProblem(std::uint64_t seed);

}  // namespace dial
