// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "check.h"
#include "trial_host.h"

namespace c3de::validate {

/// The plugin, created and started in a separate host, with the plugins it requires.
struct LoadedPlugin {
  LoadedPlugin(const Trial &trial, TrialHost::Serves serves, const TrialHost::Change &change = {});

  /// Logged warnings and errors; a pass if there are none.
  [[nodiscard]] Verdict complaints() const;
  [[nodiscard]] const std::string &id() const { return id_; }

  std::unique_ptr<TrialHost> host;
  std::string refusal;  ///< empty: it is loaded

 private:
  std::string id_;
};

}  // namespace c3de::validate
