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
    /// It lives. @param isNew  in a simulation of its own, which is the present one now; else beside what was there
    std::function<void(const std::string &name, bool isNew)> made;
    std::function<void(const std::string &title, const Error &error)> failed;
  };
  WorkstationOrgan(Session &session, Events events) : session_(session), events_(std::move(events)) {}

  /// In a background job, with progress; a later request ends one that runs. The organ joins the present simulation; where
  /// there is none, one begins without gravity: the scan shows the organ in balance with it.
  void makeOrgan(ui::OrganRequest request);

 private:
  Session &session_;
  Events events_;
  Handle job_;
  std::uint64_t serial_ = 0;
};

/// The request as a scene of one body. @param preset  null: the values of the simulator
[[nodiscard]] scene::SceneFile sceneOf(ui::OrganRequest request, const scene::MaterialPreset *preset);

}  // namespace c3de::app
