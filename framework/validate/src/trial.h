// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "check.h"
#include "trial_host.h"

namespace c3de::validate {

/// The plugin, created and started in a host of its own, with those that it needs.
struct LoadedTrial {
  LoadedTrial(const Trial &trial, TrialHost::Serves serves, const TrialHost::Change &change = {});

  /// Lines of warnings and errors that were logged; a pass without any.
  [[nodiscard]] Verdict complaints() const;
  [[nodiscard]] const std::string &id() const { return id_; }

  std::unique_ptr<TrialHost> host;
  std::string refusal;  ///< empty: it is there

 private:
  std::string id_;
};

}  // namespace c3de::validate
