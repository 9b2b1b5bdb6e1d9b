// SPDX-License-Identifier: Apache-2.0
// The tissues of the material library as values of a body's parameters.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "c3de/registry/parameter_registry.h"
#include "c3de/scene/materials.h"

namespace c3de::ui {

/// A list of tissues with the one that a body has.
struct TissueChoice {
  std::vector<std::string> names;  ///< first "custom", then those of the library
  std::uint32_t index = 0;         ///< 0: no tissue of the library has the values of the body
  std::string tooltip;             ///< what it sets, and for the chosen tissue its range and its evidence

  [[nodiscard]] std::string texts() const;  ///< for the search
};

/// @param set  of a body
[[nodiscard]] TissueChoice tissueChoiceOf(const registry::ParameterSet &set, const scene::MaterialLibrary &library);

/// The values that the tissue gives to the parameters of a set: density, Young's modulus with its range, Poisson's
/// ratio, those of them that the set has.
[[nodiscard]] std::vector<ParameterValue> tissueValues(const registry::ParameterSet &set,
                                                       const scene::MaterialPreset &preset);

}  // namespace c3de::ui
