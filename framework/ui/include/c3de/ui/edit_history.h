// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace c3de::ui {

class OrganGuide;
class ParameterRegistry;

/// Undo and Redo of the window: of parameters, or of the steps that pick an organ, whichever a person has edited last;
/// when that one has nothing to offer, the other. While a step of the organ is computed nothing is. Main thread.
class EditHistory {
 public:
  /// Once per frame; null: there is none. They must outlive the calls below.
  void follow(ParameterRegistry *parameters, OrganGuide *organ);
  /// Of what would be undone or redone; empty: nothing.
  [[nodiscard]] std::string undoLabel() const;
  [[nodiscard]] std::string redoLabel() const;
  void undo();
  void redo();

 private:
  [[nodiscard]] std::string organLabel(bool isUndo) const;
  [[nodiscard]] std::string parameterLabel(bool isUndo) const;
  [[nodiscard]] bool isOrgans(bool isUndo) const;

  ParameterRegistry *parameters_ = nullptr;
  OrganGuide *organ_ = nullptr;
  std::uint64_t parameterEdits_ = 0, organEdits_ = 0;
  bool isOrganLast_ = false;
};

}  // namespace c3de::ui
