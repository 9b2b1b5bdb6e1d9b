// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "app.h"
#include "c3de/core/handle.h"
#include "c3de/registry/edit_list.h"
#include "c3de/registry/panel_registry.h"
#include "c3de/session/saved_session.h"
#include "c3de/session/session.h"
#include "workstation/messages.h"
#include "workstation/session_controller.h"
#include "workstation/workstation_images.h"
#include "workstation/workstation_loader.h"

namespace c3de::app {

/// Undo steps of changes that have no inverse, such as another body. Undo builds the simulation again as it was before,
/// with its state; redo as it was when it was undone. Main thread. Must outlive the session's jobs and simulation.
class SimulationHistory : public registry::SimulationSteps {
 public:
  struct Parts {
    Session &session;
    registry::PanelRegistry &panels;
    registry::EditList &edits;
    WorkstationLoader &loader;
    WorkstationImages &images;
    SessionController &sessions;
    std::function<void()> removeSimulation;
    ReportError failed;
  };
  explicit SimulationHistory(Parts parts) : parts_(std::move(parts)) { parts_.edits.setSimulationSteps(this); }
  ~SimulationHistory() override;
  SimulationHistory(const SimulationHistory &) = delete;
  SimulationHistory &operator=(const SimulationHistory &) = delete;

  void captureBefore(const std::function<void(std::uint64_t capture)> &begin) override;
  bool addCaptured(std::uint64_t capture, const std::string &label) override;
  /// What undo and redo do with the mask in the image.
  enum class MaskUndo {
    none,
    ofCreation,  ///< undo picks the structure of the body again
    ofUpdate     ///< undo reverts the changes of the mask that the body followed
  };
  using MaskRange = segmentation::SegmentationWorkflow::MaskRange;
  /// What began with the last captureBefore() has succeeded. No effect if its capture failed.
  /// @param label  "create liver"
  /// @param range  of MaskUndo::ofUpdate
  void add(const std::string &label, MaskUndo mask = MaskUndo::none, const MaskRange &range = {});
  /// The simulation before what began with a captureBefore(). Valid until add(). Errors: it could not be stored;
  /// another change has begun since.
  [[nodiscard]] Expected<const CapturedState *> before(std::uint64_t capture) const;
  /// An undo or redo is in progress.
  [[nodiscard]] bool isBusy() const { return !queue_.empty(); }
  /// Another simulation was opened, or the present one was closed: its steps do not apply any more.
  void clear();

 private:
  /// A simulation at one time; without a source there is none.
  struct Version {
    CapturedState captured;
    std::string title;
  };
  struct Step {
    SimulationHistory *history = nullptr;
    std::uint64_t number = 0;
    std::string label;
    std::shared_ptr<const Version> other;  ///< what undo, or redo, restores
    Handle edit;
    MaskUndo mask = MaskUndo::none;
    MaskRange range;
    bool isMaskUndone = false;
  };
  using SharedVersion = std::shared_ptr<const Version>;

  template <bool isUndo>
  static c3de_status C3DE_CALL call(void *self) noexcept;
  static void C3DE_CALL release(void *self) noexcept;
  void captureVersion(std::function<void(const Expected<SharedVersion> &)> done);
  /// An undo or redo that was requested; the next one waits until it has ended.
  struct Exchange {
    std::uint64_t step = 0, serial = 0;
    bool isUndo = false, isPlaying = false;
    SharedVersion present = nullptr;  ///< before the exchange
  };
  void enqueue(const Step &step, bool isUndo);
  void begin();
  /// The step of an exchange that is still the first one; null: it does not apply any more.
  [[nodiscard]] Step *stepOf(const Exchange &exchange);
  void restore(const Exchange &exchange);
  void onRestored(const Exchange &exchange);
  void onFailed(const Exchange &exchange, const Error &error);
  /// The present state could not be stored: the step, and those that wait, stay as they were.
  void onNotCaptured(const Exchange &exchange, const Error &error);
  void end();
  void keepWithinBudget();

  Parts parts_;
  std::map<std::uint64_t, std::unique_ptr<Step>> steps_;  ///< by number
  std::uint64_t lastNumber_ = 0;
  std::uint64_t captures_ = 0;  ///< number of the last one
  SharedVersion before_;
  std::string notCaptured_;     ///< why there is no before_; empty: it is there, or nothing was captured
  std::deque<Exchange> queue_;  ///< the first one is in progress
  std::uint64_t lastSerial_ = 0;
};

}  // namespace c3de::app
