// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "c3de/core/expected.h"
#include "c3de/ui/organ_guide.h"
#include "session.h"

namespace c3de::app {

/// Makes bodies of what a person has picked in an image. Main thread. Must outlive the session's jobs.
class WorkstationOrgan {
 public:
  struct Events {
    std::function<void(const std::string &title, const Error &error)> failed;
  };
  WorkstationOrgan(Session &session, Events events) : session_(session), events_(std::move(events)) {}

  /// In a background job, with progress; a later request ends one that runs.
  void makeOrgan(ui::OrganRequest request);

 private:
  Session &session_;
  Events events_;
  Handle job_;
  std::uint64_t serial_ = 0;
};

}  // namespace c3de::app
