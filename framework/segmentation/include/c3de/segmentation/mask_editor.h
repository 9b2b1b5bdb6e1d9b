// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "c3de/core/handle.h"
#include "c3de/imaging/region_statistics.h"
#include "c3de/segmentation/mask_steps.h"

namespace c3de {
class BackgroundJobs;
}

namespace c3de::segmentation {

/// The mask that the user is editing. Steps run in background jobs, one after the other, and can be undone and redone.
/// A newer threshold replaces a waiting one, so that a slider shows the result of its latest setting. Main thread.
///
/// The jobs may end first: the destructor does not touch them. To release a running job, call setSources({}).
class MaskEditor {
 public:
  /// @param changed  called when the mask or the problem changes, or a job starts or ends
  MaskEditor(BackgroundJobs &jobs, std::string jobOwner, std::function<void()> changed);
  ~MaskEditor();
  MaskEditor(const MaskEditor &) = delete;
  MaskEditor &operator=(const MaskEditor &) = delete;

  /// Clears the mask and the undo history.
  void setSources(MaskSources sources);
  /// Another time point of the same image: the mask is retained, later steps use the new image.
  void replaceImage(std::shared_ptr<const scene::StoredImage> image) { sources_.image = std::move(image); }
  [[nodiscard]] const MaskSources &sources() const { return sources_; }

  void applyStep(const MaskStep &step);
  /// Replaces the mask and the undo history by a mask of an earlier run. @param step  Kind::restored
  void restore(std::shared_ptr<const imaging::Mask> mask, const MaskStep &step);
  /// Reverts steps; consecutive thresholds count as one. Not while a job runs, nor beyond the steps that are kept.
  void undo(std::size_t steps = 1);
  /// Possible until another step is carried out.
  void redo(std::size_t steps = 1);
  /// Number of steps that led to the mask, since the history began.
  [[nodiscard]] std::size_t position() const { return dropped_ + done_; }
  /// Number of the undo history: it changes when one begins, and positions of others do not apply.
  [[nodiscard]] std::uint64_t history() const { return history_; }
  [[nodiscard]] bool canUndo() const { return done_ > (isCut_ ? 1u : 0u) && !isBusy(); }
  [[nodiscard]] bool canRedo() const { return done_ < states_.size() && !isBusy(); }
  /// Name of the step to be undone or redone, for the user; empty: none.
  [[nodiscard]] std::string undoLabel() const { return canUndo() ? states_[done_ - 1].step.text() : std::string(); }
  [[nodiscard]] std::string redoLabel() const { return canRedo() ? states_[done_].step.text() : std::string(); }
  [[nodiscard]] bool isBusy() const { return !job_.isNull(); }
  /// Incremented by every requested step.
  [[nodiscard]] std::uint64_t edits() const { return edits_; }
  /// Incremented whenever the mask has changed, or the labels that are picked instead of one.
  [[nodiscard]] std::uint64_t revision() const { return revision_; }

  /// Null: no mask.
  [[nodiscard]] const std::shared_ptr<const imaging::Mask> &mask() const { return shown_.mask; }
  [[nodiscard]] const std::shared_ptr<const MaskPreview> &preview() const { return shown_.preview; }
  [[nodiscard]] std::size_t voxels() const { return shown_.statistics.voxels; }
  /// Of the image values inside the mask.
  [[nodiscard]] const imaging::RegionStatistics &statistics() const { return shown_.statistics; }
  [[nodiscard]] double volume_ml() const;
  /// The steps that led to the mask, in order.
  [[nodiscard]] std::vector<MaskStep> steps() const;
  /// Same, including running and waiting steps, as if they had succeeded.
  [[nodiscard]] std::vector<MaskStep> plannedSteps() const;
  /// The error of the last step, for the user; empty: none.
  [[nodiscard]] const std::string &problem() const { return problem_; }

 private:
  struct Shown {
    std::shared_ptr<const imaging::Mask> mask;
    std::shared_ptr<const MaskPreview> preview;
    imaging::RegionStatistics statistics;
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
  std::size_t done_ = 0;     ///< the states before it led to the mask, the others can be redone
  std::size_t dropped_ = 0;  ///< oldest states that have been discarded
  bool isCut_ = false;       ///< the oldest states have been discarded
  std::deque<MaskStep> waiting_;
  MaskStep running_;
  bool isStepRunning_ = false;  ///< otherwise the job is an undo or redo
  std::uint64_t edits_ = 0, revision_ = 0, history_ = 0;
  Handle job_;
  std::uint64_t serial_ = 0;  ///< of the job whose result counts
  std::string problem_;
  std::shared_ptr<bool> alive_;
};

}  // namespace c3de::segmentation
