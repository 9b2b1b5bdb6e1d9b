// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "pointbased/body.h"
#include "pointbased/contact_settings.h"
#include "pointbased/stage_clock.h"

namespace pointbased {

class World;
namespace detail {
struct SimulationState;
}

struct SimulationEvent {
  double time = 0.0;  ///< s
  /// substep | slowed | smaller_step | stopped | switched | chosen | renewed | restored | note | warning | skin |
  /// overlap | torn | step
  std::string kind;
  std::string text;
};

/// Reports on a simulation: events and warnings, the activity of a running step, contacts, energies and costs.
class Diagnostics {
 public:
  Diagnostics(detail::SimulationState &state, const World &world) : state_(state), world_(world) {}

  [[nodiscard]] const std::vector<SimulationEvent> &events() const;
  /// Adds a warning about a body or obstacle. It is reported as an event at the start of every simulation, and is
  /// removed with the body or obstacle.
  void addWarning(std::size_t id, const std::string &text);
  /// Describes the step that is being computed: the present body, why it may take long, and what would help. Empty
  /// between steps. Any thread.
  [[nodiscard]] std::string activity() const;
  [[nodiscard]] std::vector<StageClock::Summary> stageTimes() const;
  /// Wall-clock time per simulated second of a body, s; 0 before the first step and for quasi-static solutions.
  [[nodiscard]] double costOf(std::size_t body) const;

  /// Touching pairs, by ids: those with contact forces in the last step. Empty before the first step and for a body
  /// whose state has been replaced since. From the impulses of the substeps for explicit steps, from the penalty forces
  /// for implicit ones.
  [[nodiscard]] std::vector<ContactSummary> contacts() const;
  /// Contact pressure of obstacles, walls, other bodies and the body itself on a body, Pa: normal forces over the skin
  /// area that a phyxel carries, mean over the last step. Its integral over these areas is ContactSummary::normalForce.
  /// @param out  [phyxels]; 0 without contact
  void contactPressures(std::size_t body, std::vector<double> &out) const;
  /// Largest penetration of a body's skin into walls, obstacles or its own rigid tissue, m: of the deepest contact
  /// point of every step, and of the displayed skin, now and every 128 explicit steps (not in obstacles).
  [[nodiscard]] double skinDepth(std::size_t body) const;

  struct Energy {
    double kinetic = 0.0, elastic = 0.0, stabilisation = 0.0, gravity = 0.0;  ///< J; gravity relative to the start
    /// J, stored in the surroundings and in attachments; of an attachment between two bodies, half
    double foundation = 0.0;
  };
  [[nodiscard]] Energy energy(std::size_t body) const;
  [[nodiscard]] std::vector<Reaction> reactions(std::size_t body) const;

 private:
  detail::SimulationState &state_;
  const World &world_;
};

}  // namespace pointbased
