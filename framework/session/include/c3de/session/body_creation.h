// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/segmentation/segmentation_workflow.h"
#include "c3de/session/session.h"

namespace c3de::session {

/// Makes bodies of what a person has picked in an image. Main thread. Must outlive the session's jobs.
class BodyCreation {
 public:
  /// What has become of a request for several bodies. The failed ones are missing, all others are there.
  struct Result {
    std::vector<segmentation::BodyRequest> created, notTried;  ///< notTried: because it was cancelled before
    std::vector<std::pair<std::string, Error>> failed;         ///< by name
    std::vector<Coverage> coverage;                            ///< of those that were created
    bool isNew = false;  ///< in a simulation of their own, which is the present one now; else beside what was there
  };
  struct Events {
    std::function<void(const Result &)> created;                               ///< at least one body
    std::function<void(const std::string &title, const Error &error)> failed;  ///< no body
  };
  BodyCreation(Session &session, Events events) : session_(session), events_(std::move(events)) {}

  /// In one background job, with progress, one after the other; a later request ends one that runs. The bodies join the
  /// present simulation; where there is none, one begins without gravity: the scan shows organs in balance with it. One
  /// that fails does not keep the others from being created. When it is cancelled, those that have joined the present
  /// simulation stay, and a new one is given up.
  void createBodies(std::vector<segmentation::BodyRequest> requests);

 private:
  [[nodiscard]] Expected<void> createAll(c3de_object *simulator, bool isNew, Result &result,
                                         const ProgressFn &progress);

  Session &session_;
  Events events_;
  Handle job_;
  std::uint64_t serial_ = 0;
};

/// "liver, spleen and stomach"; of more than four the first three: "liver, spleen, stomach and 2 more".
[[nodiscard]] std::string namesOf(const std::vector<segmentation::BodyRequest> &requests);
/// The world that bodies from a scan begin in: without gravity, damped, no body yet.
[[nodiscard]] scene::SceneFile sceneWithoutBodies();
/// The request as a scene of one body. @param preset  null: the values of the simulator
[[nodiscard]] scene::SceneFile sceneOf(const segmentation::BodyRequest &request, imaging::Mask mask,
                                       const scene::MaterialPreset *preset);

}  // namespace c3de::session
