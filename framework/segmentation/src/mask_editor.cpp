// SPDX-License-Identifier: Apache-2.0
#include "c3de/segmentation/mask_editor.h"

#include <utility>

#include "c3de/core/background_jobs.h"

namespace c3de::segmentation {
namespace {

/// Of all states together. A mask of 512 x 512 x 512 voxels takes at most 17 MB, one organ in it usually less than 1 MB.
constexpr std::size_t kHistoryBytes = std::size_t{256} << 20;
/// The overlay is uploaded to the graphics card on the main thread: 32 MB, some hundredths of a second.
constexpr std::size_t kMaxPreviewVoxels = std::size_t{1} << 24;

}  // namespace

MaskEditor::MaskEditor(BackgroundJobs &jobs, std::string jobOwner, std::function<void()> changed)
    : jobs_(jobs), jobOwner_(std::move(jobOwner)), changed_(std::move(changed)), alive_(std::make_shared<bool>(true)) {}

MaskEditor::~MaskEditor() { *alive_ = false; }

void MaskEditor::release() {
  if (!job_.isNull()) jobs_.cancel(std::exchange(job_, {}));
  ++serial_;
}

void MaskEditor::setSources(MaskSources sources) {
  release();
  waiting_.clear();
  states_.clear();
  done_ = 0;
  dropped_ = 0;
  ++history_;
  isCut_ = false;
  shown_ = {};
  problem_.clear();
  ++revision_;
  sources_ = std::move(sources);
  changed_();
}

double MaskEditor::volume_ml() const {
  return shown_.mask ? static_cast<double>(voxels()) * shown_.mask->geometry.voxelVolume() / 1000.0 : 0.0;
}

std::vector<MaskStep> MaskEditor::steps() const {
  std::vector<MaskStep> steps;
  for (std::size_t i = 0; i < done_; ++i) steps.push_back(states_[i].step);
  return steps;
}

std::vector<MaskStep> MaskEditor::plannedSteps() const {
  std::vector<MaskStep> all = steps();
  if (isBusy() && isStepRunning_) all.push_back(running_);
  all.insert(all.end(), waiting_.begin(), waiting_.end());
  return all;
}

void MaskEditor::applyStep(const MaskStep &step) {
  problem_.clear();
  ++edits_;
  if (step.kind == MaskStep::Kind::labels) {
    release();
    waiting_.clear();
    shown_ = {};
    ++revision_;
    record({step, nullptr});
    return changed_();
  }
  if (step.ignoresPreviousMask()) {
    waiting_.clear();
    // A running threshold may finish, so that a result is visible while a slider is dragged; other work would be
    // wasted.
    if (isBusy() && !running_.ignoresPreviousMask()) release();
  }
  waiting_.push_back(step);
  startNext();
  changed_();
}

void MaskEditor::submit(const std::string &title, std::function<Expected<imaging::Mask>(const ProgressFn &)> make,
                        std::shared_ptr<const PackedMask> packed, std::function<void(const Result &)> take) {
  const auto result = std::make_shared<Result>();
  result->packed = std::move(packed);
  const std::uint64_t serial = ++serial_;
  job_ = jobs_.submit(
      jobOwner_, title,
      [make = std::move(make), result, image = sources_.image](const ProgressFn &progress) -> Expected<void> {
        auto made = make(progress);
        if (!made) return tl::unexpected(made.error());
        const auto mask = std::make_shared<const imaging::Mask>(std::move(*made));
        const auto statistics = imaging::statisticsOf(*mask, image ? &image->volume : nullptr, progress);
        if (!statistics) return tl::unexpected(statistics.error());
        result->shown = {mask, std::make_shared<const MaskPreview>(previewOf(*mask, kMaxPreviewVoxels)), *statistics};
        if (!result->packed) result->packed = std::make_shared<const PackedMask>(*mask);
        return {};
      },
      [this, alive = alive_, serial, result, take = std::move(take)](const Expected<void> &done) {
        if (!*alive || serial != serial_) return;
        job_ = {};
        if (!done) {
          waiting_.clear();
          problem_ =
              done.error().code == ErrorCode::cancelled ? "cancelled; the mask is unchanged" : done.error().message;
        } else {
          shown_ = result->shown;
          ++revision_;
          take(*result);
          startNext();
        }
        changed_();
      });
}

void MaskEditor::restore(std::shared_ptr<const imaging::Mask> mask, const MaskStep &step) {
  release();
  waiting_.clear();
  problem_.clear();
  running_ = step;
  isStepRunning_ = true;
  ++history_;
  submit(
      "Segmentation: " + step.text(),
      [mask = std::move(mask)](const ProgressFn &) -> Expected<imaging::Mask> { return *mask; }, nullptr,
      [this, step](const Result &result) {
        states_.clear();
        states_.push_back({step, result.packed});
        done_ = 1;
        dropped_ = 0;
        isCut_ = true;  // what came before is not known any more
      });
  changed_();
}

void MaskEditor::startNext() {
  if (isBusy() || waiting_.empty()) return;
  running_ = waiting_.front();
  isStepRunning_ = true;
  waiting_.pop_front();
  submit(
      "Segmentation: " + running_.text(),
      [step = running_, sources = sources_, before = shown_.mask](const ProgressFn &progress) {
        return carriedOut(step, sources, before.get(), progress);
      },
      nullptr,
      [this, step = running_](const Result &result) {
        record({step, result.packed});
      });
}

void MaskEditor::record(State state) {
  using Kind = MaskStep::Kind;
  states_.resize(done_);
  if (state.step.kind == Kind::threshold && !states_.empty() && states_.back().step.kind == Kind::threshold)
    states_.pop_back();
  states_.push_back(std::move(state));
  std::size_t bytes = 0, kept = 0;
  for (auto it = states_.rbegin(); it != states_.rend() && (bytes <= kHistoryBytes || kept < 2); ++it, ++kept)
    bytes += it->mask ? it->mask->bytes() : 0;
  if (const std::size_t dropped = states_.size() - kept; dropped > 0) {
    states_.erase(states_.begin(), states_.begin() + static_cast<std::ptrdiff_t>(dropped));
    dropped_ += dropped;
    isCut_ = true;
  }
  done_ = states_.size();
}

void MaskEditor::undo(std::size_t steps) {
  if (canUndo() && steps > 0 && done_ - (isCut_ ? 1u : 0u) >= steps) goTo(done_ - steps);
}

void MaskEditor::redo(std::size_t steps) {
  if (canRedo() && steps > 0 && states_.size() - done_ >= steps) goTo(done_ + steps);
}

void MaskEditor::goTo(std::size_t done) {
  problem_.clear();
  const auto packed = done > 0 ? states_[done - 1].mask : nullptr;
  if (packed) {
    running_ = states_[done - 1].step;
    isStepRunning_ = false;
    submit(
        done < done_ ? "Segmentation: undo" : "Segmentation: redo",
        [packed](const ProgressFn &) -> Expected<imaging::Mask> { return packed->mask(); }, packed,
        [this, done](const Result &) { done_ = done; });
  } else {
    done_ = done;
    shown_ = {};
    ++revision_;
  }
  changed_();
}

}  // namespace c3de::segmentation
