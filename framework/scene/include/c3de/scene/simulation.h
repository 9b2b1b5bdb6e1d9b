// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "c3de/abi/iface/simulator.h"
#include "c3de/abi/simulation.h"
#include "c3de/core/expected.h"
#include "c3de/core/handle.h"

namespace c3de::scene {

/// Metres of the simulation to millimetres of the world: the transform of the simulation node, and the only place where
/// the two units meet.
inline constexpr double kMillimetresPerMetre = 1000.0;

/// Drives a simulator object on a thread of its own: takes commands between steps, keeps pace with the wall clock, lets
/// the simulator publish a snapshot when somebody looks. The window never waits for it. Or leaves the stepping to who
/// made it, for runs without a window.
class Simulation {
 public:
  /// @param simulator  a count is taken; must answer iface.simulator
  /// @param takeError  the text that the last failing call on the calling thread left, for messages; may be empty
  /// @param owner  the plugin's id, for messages; stays as long as the program
  [[nodiscard]] static Expected<std::unique_ptr<Simulation>> create(c3de_object *simulator,
                                                                    std::function<std::string()> takeError = {},
                                                                    const char *owner = "(unknown)");
  /// The same without a thread and a pace: the caller steps, between beginStep() and endStep(). transport() and
  /// setTargetRate() do nothing; what is posted waits for the next step.
  [[nodiscard]] static Expected<std::unique_ptr<Simulation>> createForCaller(
      c3de_object *simulator, std::function<std::string()> takeError = {}, const char *owner = "(unknown)");
  [[nodiscard]] bool isDrivenByCaller() const;
  /// Of a simulation that its caller steps: what was posted, then what comes before a step; on an error it must not be
  /// made.
  [[nodiscard]] Expected<void> beginStep();
  /// And what comes after one that was made.
  void endStep();

  /// Ends the step that is being computed, runs what was posted, joins the thread, lets go of the simulator. Waits for
  /// the step of a simulator that cannot end one (below revision 4).
  ~Simulation();

  /// C3DE_TRANSPORT_*; takes effect between two steps. Pause, stop and reset end the step that is being computed: the
  /// state before it stays. Ignored: unknown actions, and play, pause and step while it has failed. Reset goes on
  /// playing if it was, and stands at the initial state (C3DE_SIM_STOPPED) otherwise. Any thread.
  void transport(std::uint32_t action);
  /// Simulated seconds per second; 0: as fast as it goes; what is negative or not finite counts as 0. When the
  /// simulator cannot keep up, simulated time falls behind (real_time_factor says by how much); no step is left out or
  /// lengthened.
  void setTargetRate(double rate);
  /// Runs the command on the simulation's thread between two steps, soon, also while paused; then a snapshot is
  /// published. Any thread.
  void post(std::function<void()> command);
  /// Runs the command on the simulation's thread and waits for it: for loading and saving, never from a frame.
  void call(const std::function<void()> &command);
  [[nodiscard]] c3de_sim_transport state() const;  ///< any thread
  /// What takes long in the step that is being computed and what would help, in one line; empty where nobody says. Any
  /// thread, at once.
  [[nodiscard]] std::string activity() const;
  /// Why it failed; empty while it has not.
  [[nodiscard]] std::string failure() const;
  /// Steps that the simulator has given up because they took too long, each of which has paused the simulation.
  struct GivenUp {
    std::uint64_t steps = 0;
    std::string why;  ///< of the last one
  };
  [[nodiscard]] GivenUp givenUp() const;
  /// Called on the simulation's thread before each step from the next one on; an error is logged, the step is not made,
  /// and the simulation pauses. Any thread.
  void setBeforeStep(std::function<Expected<void>()> prepare);
  /// Called on the simulation's thread after each step that was made. Any thread.
  void setAfterStep(std::function<void(const c3de_sim_status &)> follow);
  /// Called on the simulation's thread after each published snapshot, for example to wake the window. When this
  /// returns, the listener before is not running and will not be called again.
  void setPublishedListener(std::function<void()> listener);

  [[nodiscard]] c3de_object *object() const;
  [[nodiscard]] const c3de_simulator_v1 *table() const;

 private:
  struct Impl;
  explicit Simulation(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace c3de::scene
