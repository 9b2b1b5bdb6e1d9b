// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/edit_history.h"

#include "c3de/ui/organ_guide.h"
#include "c3de/ui/parameter_registry.h"

namespace c3de::ui {

void EditHistory::follow(ParameterRegistry *parameters, OrganGuide *organ) {
  parameters_ = parameters;
  organ_ = organ;
  const std::uint64_t parameterEdits = parameters ? parameters->history().edits() : 0;
  const std::uint64_t organEdits = organ ? organ->mask().edits() : 0;
  if (parameterEdits != parameterEdits_) isOrganLast_ = false;
  if (organEdits != organEdits_) isOrganLast_ = true;
  parameterEdits_ = parameterEdits;
  organEdits_ = organEdits;
}

std::string EditHistory::organLabel(bool isUndo) const {
  if (!organ_) return {};
  // What was picked last has become organs that live, or nothing is picked any more: what they were made of would be laid
  // over them. Its panel does that, and says so.
  const std::vector<MaskStep> steps = isUndo ? organ_->mask().steps() : std::vector<MaskStep>();
  if (!steps.empty() && steps.back().kind == MaskStep::Kind::labels && steps.back().labels.empty()) return {};
  return isUndo ? organ_->mask().undoLabel() : organ_->mask().redoLabel();
}

std::string EditHistory::parameterLabel(bool isUndo) const {
  if (!parameters_) return {};
  return isUndo ? parameters_->history().undoLabel() : parameters_->history().redoLabel();
}

bool EditHistory::isOrgans(bool isUndo) const {
  const bool isLast = organ_ && isOrganLast_;
  if (isLast) return organ_->mask().isBusy() || !organLabel(isUndo).empty() || parameterLabel(isUndo).empty();
  return parameterLabel(isUndo).empty() && !organLabel(isUndo).empty();
}

std::string EditHistory::undoLabel() const { return isOrgans(true) ? organLabel(true) : parameterLabel(true); }
std::string EditHistory::redoLabel() const { return isOrgans(false) ? organLabel(false) : parameterLabel(false); }

void EditHistory::undo() {
  isOrganLast_ = isOrgans(true);
  if (isOrganLast_) {
    if (organ_->mask().isBusy() || !organLabel(true).empty()) organ_->undo();
  } else if (parameters_) {
    parameters_->history().undo(*parameters_);
  }
}

void EditHistory::redo() {
  isOrganLast_ = isOrgans(false);
  if (isOrganLast_)
    organ_->redo();
  else if (parameters_)
    parameters_->history().redo(*parameters_);
}

}  // namespace c3de::ui
