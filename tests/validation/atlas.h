// SPDX-License-Identifier: Apache-2.0
// The outcome of every run of the sweep, as a table and as an image.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "c3de/render/renderer.h"

namespace extremes {

enum class Ending {
  finite,       ///< all steps made, every number finite
  finiteSoFar,  ///< finite, but the processor time for a run was used up before its last step
  stopped,      ///< the guard stopped the body in its last valid state and reported the reason
  refused,      ///< the settings were refused with a message
  failed        ///< all other outcomes: values that are not numbers, a stop without a report, a step that did not
                ///< return in time
};

struct AtlasRun {
  double youngsModulus = 0.0, poissonRatio = 0.0, spacing = 0.0;  // Pa, 1, m
  std::string scheme;                                             ///< integrator
  double dt = 0.0;                                                ///< s; 0: the integrator has no step
  Ending ending = Ending::failed;
  int steps = 0;                            ///< completed steps
  double seconds = 0.0, slowestStep = 0.0;  ///< processor time
  std::string reason;                       ///< of a stop or refusal
};

/// One line per run, with a header.
[[nodiscard]] std::string atlasTable(const std::vector<AtlasRun> &runs);

[[nodiscard]] std::array<std::uint8_t, 3> colourOf(Ending ending);

/// One panel per integrator and step (across) and spacing (down); in each, Young's modulus across and Poisson's ratio
/// up. Every cell is a run; the legend counts them.
[[nodiscard]] c3de::render::Image drawAtlas(const std::vector<AtlasRun> &runs);

}  // namespace extremes
