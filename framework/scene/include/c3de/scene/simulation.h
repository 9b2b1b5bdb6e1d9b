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

/// Metres of the simulation to millimetres of the world: the transform of the simulation node. The only conversion
/// between the two units.
inline constexpr double kMillimetresPerMetre = 1000.0;

/// Drives a simulator object on its own thread: runs commands between steps, keeps pace with the wall clock, lets the
/// simulator publish a snapshot when needed for display. The window never waits for it. Alternatively the caller steps
/// it, for runs without a window.
class Simulation {
 public:
  /// @param simulator  a reference is taken; must implement iface.simulator
  /// @param takeError  returns the text of the last failed call on the calling thread, for messages; may be empty
  /// @param owner  the plugin's id, for messages; must outlive the program's run
  [[nodiscard]] static Expected<std::unique_ptr<Simulation>> create(c3de_object *simulator,
                                                                    std::function<std::string()> takeError = {},
                                                                    const char *owner = "(unknown)");
  /// Same without a thread and without pacing: the caller steps, between beginStep() and endStep(). transport() and
  /// setTargetRate() have no effect; posted commands wait for the next step.
  [[nodiscard]] static Expected<std::unique_ptr<Simulation>> createForCaller(
      c3de_object *simulator, std::function<std::string()> takeError = {}, const char *owner = "(unknown)");
  [[nodiscard]] bool isSteppedByCaller() const;
  /// For a simulation stepped by its caller: runs posted commands, then the before-step function. After an error the
  /// step must be skipped.
  [[nodiscard]] Expected<void> beginStep();
  /// Call after a step that was made.
  void endStep();

  /// Ends the step in progress, runs posted commands, joins the thread, releases the simulator. If the simulator cannot
  /// interrupt a step (below revision 4), waits for the step to complete.
  ~Simulation();

  /// C3DE_TRANSPORT_*; takes effect between two steps. Pause, stop and reset end the step in progress; the state before
  /// it is retained. Ignored: unknown actions, and play, pause and step after a failure. Reset continues to play if it
  /// was playing, otherwise it stops at the initial state (C3DE_SIM_STOPPED). Any thread.
  void transport(std::uint32_t action);
  /// Simulated seconds per second; 0: as fast as possible; negative and non-finite values count as 0. When the
  /// simulator cannot keep up, simulated time falls behind (see real_time_factor); no step is skipped or lengthened.
  void setTargetRate(double rate);
  /// Runs the command on the simulation's thread between two steps, soon, also while paused; then publishes a snapshot.
  /// Any thread.
  void post(std::function<void()> command);
  /// Runs the command on the simulation's thread and waits for it. For loading and saving; never call it from a frame.
  void call(const std::function<void()> &command);
  [[nodiscard]] c3de_sim_transport state() const;  ///< any thread
  /// What takes long in the step in progress and what would help, in one line; empty where the simulator does not
  /// report it. Any thread; returns immediately.
  [[nodiscard]] std::string activity() const;
  /// The reason for the failure; empty without one.
  [[nodiscard]] std::string failure() const;
  /// Steps that the simulator has aborted because they took too long. Each of them has paused the simulation.
  struct AbortedSteps {
    std::uint64_t steps = 0;
    std::string why;  ///< of the last one
  };
  [[nodiscard]] AbortedSteps abortedSteps() const;
  /// Called on the simulation's thread before each step, starting with the next. An error is logged, the step is
  /// skipped, and the simulation pauses. Any thread.
  void setBeforeStep(std::function<Expected<void>()> prepare);
  /// Called on the simulation's thread after each completed step. Any thread.
  void setAfterStep(std::function<void(const c3de_sim_status &)> follow);
  /// Called on the simulation's thread after each completed reset, with the status before it. Any thread.
  void setAfterReset(std::function<void(const c3de_sim_status &)> follow);
  /// Called on the simulation's thread after each published snapshot, for example to wake the window. When this
  /// returns, the previous listener is not running and will not be called again.
  void setPublishedListener(std::function<void()> listener);

  [[nodiscard]] c3de_object *object() const;
  [[nodiscard]] const c3de_simulator_v1 *table() const;

 private:
  struct Impl;
  explicit Simulation(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace c3de::scene
