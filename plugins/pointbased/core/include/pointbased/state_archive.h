// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pointbased/types.h"

namespace pointbased {

namespace detail {
struct SimulationState;
struct SimulatorCheckpoint;
}  // namespace detail

struct Obstacle;

/// The state of a simulation at one time, for StateArchive::restore(). Cheap to copy.
using Checkpoint = std::shared_ptr<const detail::SimulatorCheckpoint>;

/// A body that continued from a body of another simulation.
struct ContinuedBody {
  std::size_t id = 0;
  /// Both have the same phyxels: displacements, velocities and history are equal bit for bit. Otherwise they are
  /// interpolated, and relaxed hourglass modes are reset.
  bool isSame = false;
  double energyBefore = 0.0, energyAfter = 0.0;  ///< J, elastic and kinetic, of the other body and of this one
};

/// Stores and restores the state of a simulation: as checkpoints in memory, or as bytes.
class StateArchive {
 public:
  explicit StateArchive(detail::SimulationState &state) : state_(state) {}

  /// The state between two steps: bodies, clock, probes and events.
  [[nodiscard]] Checkpoint checkpoint() const;
  /// Returns (or advances) to a state of these bodies, without grabs. Materials, world and what holds the bodies are
  /// the present ones. Explicit steps from there repeat the earlier results bit for bit, unless material flows (it
  /// flows once more at the start). Reported as an event.
  /// @return  false: nothing is changed, because bodies or obstacles have been added or removed since, or the
  ///          simulation has been reset
  bool restore(const Checkpoint &checkpoint);
  /// The state as bytes, for load() of a simulator with the same bodies, obstacles, supports, loads and world: also
  /// grabs, the motion of guided obstacles, and stopped bodies. Factorisations and reference energies are reset here as
  /// well, so that this simulation and one that loads the state make the same steps.
  /// Errors, with nothing changed: a body whose reference was renewed after large flow.
  [[nodiscard]] Result<std::string> save();
  /// Restores a state of save(), from which every step gives the same bits as there. States of earlier versions, which
  /// have no grabs, are accepted. On an error nothing is changed: the bytes are not such a state.
  /// @param instruments  of save(), in their order, as World::addInstrument() adds them; they replace the present ones
  /// @return             [instruments] their ids
  [[nodiscard]] Result<std::vector<std::size_t>> load(std::string_view bytes, std::vector<Obstacle> instruments = {});
  /// Continues at the present time of another simulation, with the state of its bodies. A body here may be filled
  /// differently, for example because its shape was corrected: new material around it follows the motion of the nearest
  /// phyxels. Contacts are found again. Grabs, instruments and torn connections are those of this simulation at its
  /// start. Bodies without a counterpart, and static ones, are in their initial state.
  /// Errors, with nothing changed: a body whose reference was renewed after large flow, or that is rigid in only one of
  /// the simulations; one simulation is quasi-static and the other is not; ids without a body.
  /// @param from    between two steps; not this simulation
  /// @param bodies  id in `from`, id here; each at most once
  [[nodiscard]] Result<std::vector<ContinuedBody>> continueFrom(
      const StateArchive &from, std::span<const std::pair<std::size_t, std::size_t>> bodies);
  /// Changes whenever earlier checkpoints become invalid.
  [[nodiscard]] std::uint64_t historyEpoch() const;

 private:
  detail::SimulationState &state_;
};

}  // namespace pointbased
