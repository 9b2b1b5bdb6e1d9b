// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "pointbased/integrators.h"

namespace pointbased {

/// Which stages a step of a body has. Every integrator decides by these, and compose() tells of the same ones: what is
/// not here does not run.
struct StepStages {
  bool fused = false;     ///< forces in one go, by vector kernels: no gradients, flow and stresses of their own
  bool flow = false;      ///< plastic
  bool viscous = false;   ///< stresses of the velocities
  bool relaxing = false;  ///< Prony terms
  bool loads = false;
  bool surroundings = false;  ///< elastic foundation
  bool outside = false;       ///< forces from outside of the model
  bool hands = false;
  bool supports = false;  ///< of held phyxels and patches
  bool patches = false;   ///< of these, those with patches
  bool contact = false;
  bool damping = false;  ///< of the mass
};
[[nodiscard]] StepStages stagesOf(const Body &body, const Environment &environment);

/// One stage, for people.
struct ComposedStage {
  std::string name;
  bool runs = false;
  std::string why;    ///< it runs, or does not
  std::string clock;  ///< the stage of Simulator::stageTimes() that its time is part of; empty: it takes none
};

/// What a step of a body consists of, in order.
struct StepComposition {
  std::string body;
  std::vector<ComposedStage> stages;

  /// Null: there is none of that name.
  [[nodiscard]] const ComposedStage *stage(const std::string &name) const {
    for (const ComposedStage &one : stages)
      if (one.name == name) return &one;
    return nullptr;
  }
};

/// What of a body's surroundings and state a composition tells of besides.
struct CompositionNotes {
  std::string idle;  ///< why no stage runs (rigid, stopped, asleep); empty: stages run
  Integrator integrator = Integrator::explicitVerlet;
  bool maySleep = false;
  std::vector<std::string> probes;        ///< names
  std::vector<std::string> touches = {};  ///< names of the bodies that it touches where they meet
  bool touchesItself = false;             ///< folds of its skin are near each other
};
[[nodiscard]] StepComposition compose(const Body &body, const Environment &environment, const CompositionNotes &notes);

}  // namespace pointbased
