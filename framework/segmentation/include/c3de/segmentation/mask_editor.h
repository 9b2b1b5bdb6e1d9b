// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "c3de/core/handle.h"
#include "c3de/segmentation/mask_steps.h"

namespace c3de {
class BackgroundJobs;
}

namespace c3de::segmentation {

/// The mask a person is picking: steps are carried out in background jobs, one after the other, and can be undone and
/// redone. A threshold that waits gives way to a later one, so that a slider shows what it says by the latest settings.
/// Main thread.
///
/// The jobs may end first: the destructor does not touch them. To let go of a job that runs, setSources({}).
class MaskEditor {
 public:
  /// @param changed  another mask, another problem, or a job has begun or ended
  MaskEditor(BackgroundJobs &jobs, std::string jobOwner, std::function<void()> changed);
  ~MaskEditor();
  MaskEditor(const MaskEditor &) = delete;
  MaskEditor &operator=(const MaskEditor &) = delete;

  /// Nothing is picked then, and there is nothing to undo.
  void setSources(MaskSources sources);
  /// Another time point of the same image: what is picked stays, later steps look at this one.
  void replaceImage(std::shared_ptr<const scene::StoredImage> image) { sources_.image = std::move(image); }
  [[nodiscard]] const MaskSources &sources() const { return sources_; }

  void carryOut(const MaskStep &step);
  /// Goes back by a step; thresholds that follow each other are one. Not while a job runs.
  void undo();
  /// Until another step is carried out.
  void redo();
  [[nodiscard]] bool canUndo() const { return done_ > (isCut_ ? 1u : 0u) && !isBusy(); }
  [[nodiscard]] bool canRedo() const { return done_ < states_.size() && !isBusy(); }
  /// What would be undone or redone, for a person; empty: nothing.
  [[nodiscard]] std::string undoLabel() const { return canUndo() ? states_[done_ - 1].step.text() : std::string(); }
  [[nodiscard]] std::string redoLabel() const { return canRedo() ? states_[done_].step.text() : std::string(); }
  [[nodiscard]] bool isBusy() const { return !job_.isNull(); }
  /// Grows with every step that is asked for.
  [[nodiscard]] std::uint64_t edits() const { return edits_; }

  /// Null: nothing is picked.
  [[nodiscard]] const std::shared_ptr<const imaging::Mask> &mask() const { return shown_.mask; }
  [[nodiscard]] const std::shared_ptr<const MaskPreview> &preview() const { return shown_.preview; }
  [[nodiscard]] std::size_t voxels() const { return shown_.voxels; }
  [[nodiscard]] double volume_ml() const;
  /// What led to the mask, in order.
  [[nodiscard]] std::vector<MaskStep> steps() const;
  /// The same with what runs and waits, as if it had succeeded.
  [[nodiscard]] std::vector<MaskStep> plannedSteps() const;
  /// What went wrong with the last step, for a person; empty: nothing.
  [[nodiscard]] const std::string &problem() const { return problem_; }

 private:
  struct Shown {
    std::shared_ptr<const imaging::Mask> mask;
    std::shared_ptr<const MaskPreview> preview;
    std::size_t voxels = 0;
  };
  struct State {
    MaskStep step;
    std::shared_ptr<const PackedMask> mask;  ///< null: the step makes none
  };
  struct Result {
    Shown shown;
    std::shared_ptr<const PackedMask> packed;
  };
  void startNext();
  void submit(const std::string &title, std::function<Expected<imaging::Mask>(const ProgressFn &)> make,
              std::shared_ptr<const PackedMask> packed, std::function<void(const Result &)> take);
  void release();
  void record(State state);
  void goTo(std::size_t done);

  BackgroundJobs &jobs_;
  std::string jobOwner_;
  std::function<void()> changed_;
  MaskSources sources_;
  Shown shown_;
  std::vector<State> states_;
  std::size_t done_ = 0;  ///< states before it are what led to the mask, the others can be redone
  bool isCut_ = false;    ///< the oldest states have been forgotten
  std::deque<MaskStep> waiting_;
  MaskStep running_;
  bool isStepRunning_ = false;  ///< else the job goes back or forth
  std::uint64_t edits_ = 0;
  Handle job_;
  std::uint64_t serial_ = 0;  ///< of the job whose result counts
  std::string problem_;
  std::shared_ptr<bool> alive_;
};

}  // namespace c3de::segmentation
