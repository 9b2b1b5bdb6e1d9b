// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "c3de/sdk/commands.hpp"
#include "c3de/sdk/panel.hpp"

namespace pointbased {

namespace sdk = c3de::sdk;

/// The two modes of the panel: what a user needs first, and everything. The chosen one is a setting of the user, and no
/// part of a scene or a session. Main thread.
class PanelMode {
 public:
  /// Simple, unless the user has chosen otherwise before.
  explicit PanelMode(sdk::Host host);

  [[nodiscard]] bool isSimple() const { return isSimple_; }
  /// Two buttons, of which the chosen one is disabled.
  void draw(sdk::Ui &ui);

  static constexpr std::string_view kSetting = "panel.mode", kSimple = "simple", kAll = "all";

 private:
  void choose(bool isSimple);

  sdk::Settings settings_;
  bool isSimple_ = true;
};

}  // namespace pointbased
