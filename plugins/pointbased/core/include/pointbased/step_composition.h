// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "pointbased/integrators.h"

namespace pointbased {

/// Stages of a step of a body. All integrators use these flags, and compose() reports the same: a stage that is not set
/// is not run.
struct StepStages {
  bool fused = false;    ///< forces in one pass, by vector kernels: no separate stages for gradients, flow and stresses
  bool flow = false;     ///< plastic
  bool viscous = false;  ///< stresses of the velocities
  bool relaxing = false;  ///< Prony terms
  bool loads = false;
  bool surroundings = false;  ///< elastic foundation
  bool outside = false;       ///< forces from outside of the model
  bool grabs = false;
  bool supports = false;  ///< for held phyxels and patches
  bool patches = false;   ///< subset of supports: those with patches
  bool contact = false;
  bool damping = false;  ///< mass-proportional
};
[[nodiscard]] StepStages stagesOf(const Body &body, const Environment &environment);

/// Description of one stage.
struct ComposedStage {
  std::string name;
  bool runs = false;
  std::string why;    ///< why it runs or not
  std::string clock;  ///< the stage of Diagnostics::stageTimes() that includes its time; empty: it takes none
};

/// Stages of a step of a body, in order.
struct StepComposition {
  std::string body;
  std::vector<ComposedStage> stages;

  /// Null if there is no stage with that name.
  [[nodiscard]] const ComposedStage *stage(const std::string &name) const {
    for (const ComposedStage &one : stages)
      if (one.name == name) return &one;
    return nullptr;
  }
};

/// Further facts about a body's surroundings and state for its composition.
struct CompositionNotes {
  std::string idle;  ///< why no stage runs (rigid, stopped, asleep); empty: stages run
  Integrator integrator = Integrator::explicitVerlet;
  bool maySleep = false;
  std::vector<std::string> probes;        ///< names
  std::vector<std::string> touches = {};  ///< names of the bodies with which it can be in contact
  bool touchesItself = false;             ///< folds of its skin are close to each other
};
[[nodiscard]] StepComposition compose(const Body &body, const Environment &environment, const CompositionNotes &notes);

}  // namespace pointbased
