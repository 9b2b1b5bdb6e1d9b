// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "c3de/sdk/panel.hpp"
#include "tools/load_tool.h"

namespace pointbased {

/// Part of the panel: supports and loads on parts of surfaces that the load tool selects. Each is listed with its
/// value, its reaction or resultant, and can be chosen, changed, hidden and removed. Every change is an undo step.
/// Main thread.
class LoadPanel {
 public:
  explicit LoadPanel(LoadTool &tool) : tool_(tool) {}
  LoadPanel(const LoadPanel &) = delete;
  LoadPanel &operator=(const LoadPanel &) = delete;

  /// Null if none.
  void setSimulator(WorldSimulator *simulator);
  void draw(sdk::Ui &ui, const Snapshot *snapshot);
  /// Supports and loads that are set, without the selection of new ones.
  void drawList(sdk::Ui &ui, const Snapshot &snapshot);

 private:
  void drawTool(sdk::Ui &ui, const Snapshot &snapshot);
  void drawMode(sdk::Ui &ui);
  void drawNew(sdk::Ui &ui, const Snapshot &snapshot);
  void drawValue(sdk::Ui &ui, const ConditionSnapshot &one);
  void drawRow(sdk::Ui &ui, const ConditionSnapshot &one);
  void add(const Snapshot &snapshot, ConditionKind kind);

  LoadTool &tool_;
  sdk::Ref<WorldSimulator> simulator_;
  std::uint32_t kind_ = 0, unit_ = 0, direction_ = 0;
  std::string force_ = "1", vector_ = "0 0 -1", pressure_ = "1", displacement_ = "0 0 5", ramp_ = "0.5";
  bool atRest_ = false;
  std::map<std::uint64_t, std::string> edited_;  // values that are being typed
};

}  // namespace pointbased
