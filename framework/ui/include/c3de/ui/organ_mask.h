// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "c3de/core/handle.h"
#include "c3de/ui/mask_steps.h"

namespace c3de {
class BackgroundJobs;
}

namespace c3de::ui {

/// The mask a person is picking: steps are carried out in background jobs, one after the other, and can be undone. A
/// threshold that waits gives way to a later one, so that a slider shows what it says by the latest settings. Main
/// thread.
///
/// The jobs may end first: the destructor does not touch them. To let go of a job that runs, setSources({}).
class OrganMask {
 public:
  /// @param changed  another mask, another problem, or a job has begun or ended
  OrganMask(BackgroundJobs &jobs, std::string jobOwner, std::function<void()> changed);
  ~OrganMask();
  OrganMask(const OrganMask &) = delete;
  OrganMask &operator=(const OrganMask &) = delete;

  /// Nothing is picked then, and there is nothing to undo.
  void setSources(MaskSources sources);
  [[nodiscard]] const MaskSources &sources() const { return sources_; }

  void carryOut(const MaskStep &step);
  /// Goes back by a step; thresholds that follow each other are one. Not while a job runs.
  void undo();
  [[nodiscard]] bool canUndo() const { return states_.size() > (isCut_ ? 1u : 0u) && !isBusy(); }
  [[nodiscard]] bool isBusy() const { return !job_.isNull(); }

  /// Null: nothing is picked.
  [[nodiscard]] const std::shared_ptr<const imaging::Mask> &mask() const { return shown_.mask; }
  [[nodiscard]] const std::shared_ptr<const MaskPreview> &preview() const { return shown_.preview; }
  [[nodiscard]] std::size_t voxels() const { return shown_.voxels; }
  [[nodiscard]] double volume_ml() const;
  /// What led to the mask, in order.
  [[nodiscard]] std::vector<MaskStep> steps() const;
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
    std::shared_ptr<const PackedMask> mask;
  };
  struct Result {
    Shown shown;
    std::shared_ptr<const PackedMask> packed;
  };
  void startNext();
  void submit(const std::string &title, std::function<Expected<imaging::Mask>(const ProgressFn &)> make,
              std::shared_ptr<const PackedMask> packed, std::function<void(const Result &)> take);
  void letGo();

  BackgroundJobs &jobs_;
  std::string jobOwner_;
  std::function<void()> changed_;
  MaskSources sources_;
  Shown shown_;
  std::vector<State> states_;
  bool isCut_ = false;  ///< the oldest states have been forgotten
  std::deque<MaskStep> waiting_;
  MaskStep running_;
  Handle job_;
  std::uint64_t serial_ = 0;  ///< of the job whose result counts
  std::string problem_;
  std::shared_ptr<bool> alive_;
};

}  // namespace c3de::ui
