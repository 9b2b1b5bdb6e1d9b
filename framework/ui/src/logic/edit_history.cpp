// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/edit_history.h"

#include <algorithm>

#include "c3de/registry/edit_list.h"
#include "c3de/registry/parameter_registry.h"
#include "c3de/segmentation/segmentation_workflow.h"

namespace c3de::ui {

void EditHistory::follow(registry::ParameterRegistry *parameters, segmentation::SegmentationWorkflow *workflow,
                         registry::EditList *steps) {
  parameters_ = parameters;
  workflow_ = workflow;
  steps_ = steps;
  for (const Source source : {Source::parameters, Source::segmentation, Source::steps}) {
    std::uint64_t &seen = edits_[static_cast<std::size_t>(source)];
    const std::uint64_t edits = editsOf(source);
    if (edits != seen) {
      bringForward(source);
      if (source == Source::parameters && steps_) steps_->forgetUndone();
      if (source == Source::steps && parameters_) parameters_->history().forgetUndone();
    }
    seen = edits;
  }
}

std::uint64_t EditHistory::editsOf(Source source) const {
  switch (source) {
    case Source::parameters: return parameters_ ? parameters_->history().edits() : 0;
    case Source::segmentation: return workflow_ ? workflow_->mask().edits() : 0;
    case Source::steps: break;
  }
  return steps_ ? steps_->edits() : 0;
}

void EditHistory::bringForward(Source source) {
  const auto found = std::find(latestFirst_.begin(), latestFirst_.end(), source);
  std::rotate(latestFirst_.begin(), found, found + 1);
}

std::string EditHistory::label(Source source, bool isUndo) const {
  switch (source) {
    case Source::parameters:
      if (!parameters_) return {};
      return isUndo ? parameters_->history().undoLabel() : parameters_->history().redoLabel();
    case Source::segmentation:
      if (!workflow_ || (isUndo && workflow_->hasJustCreated())) return {};
      return isUndo ? workflow_->mask().undoLabel() : workflow_->mask().redoLabel();
    case Source::steps: break;
  }
  if (!steps_) return {};
  return isUndo ? steps_->undoLabel() : steps_->redoLabel();
}

EditHistory::Source EditHistory::source(bool isUndo) const {
  for (const Source source : latestFirst_) {
    // Undoing twice in quick succession applies to its steps both times.
    const bool isBusy =
        source == Source::segmentation && source == latestFirst_.front() && workflow_ && workflow_->mask().isBusy();
    if (isBusy || !label(source, isUndo).empty()) return inOrder(source, isUndo);
  }
  return latestFirst_.front();
}

EditHistory::Source EditHistory::inOrder(Source source, bool isUndo) const {
  if (source == Source::segmentation || !parameters_ || !steps_) return source;
  const Source other = source == Source::parameters ? Source::steps : Source::parameters;
  if (label(other, isUndo).empty()) return source;
  const registry::ParameterHistory &parameters = parameters_->history();
  const auto ofParameters = isUndo ? parameters.undoTime() : parameters.redoTime();
  const auto ofSteps = isUndo ? steps_->undoTime() : steps_->redoTime();
  if (ofParameters == ofSteps) return source;
  return (ofParameters > ofSteps) == isUndo ? Source::parameters : Source::steps;
}

void EditHistory::apply(bool isUndo) {
  const Source source = this->source(isUndo);
  bringForward(source);
  switch (source) {
    case Source::parameters:
      if (parameters_) isUndo ? parameters_->history().undo(*parameters_) : parameters_->history().redo(*parameters_);
      break;
    case Source::segmentation:
      if (!workflow_) break;
      if (!isUndo)
        workflow_->redo();
      else if (workflow_->mask().isBusy() || !label(source, true).empty())
        workflow_->undo();
      break;
    case Source::steps:
      if (steps_) isUndo ? steps_->undo() : steps_->redo();
      break;
  }
}

}  // namespace c3de::ui
