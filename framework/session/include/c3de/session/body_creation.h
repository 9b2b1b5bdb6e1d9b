// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/segmentation/segmentation_workflow.h"
#include "c3de/session/session.h"

namespace c3de::session {

/// Creates bodies from structures picked in an image. Main thread. Must outlive the session's jobs.
class BodyCreation {
 public:
  /// Outcome of a request for several bodies. A body that fails is missing; all others are present.
  struct Result {
    std::vector<segmentation::BodyRequest> created, notTried;  ///< notTried: cancelled before they were started
    std::vector<std::pair<std::string, Error>> failed;         ///< by body name
    std::vector<Coverage> coverage;                            ///< of the created bodies
    std::vector<SharedScene> scenes;                           ///< of the created bodies
    bool isNew = false;                                        ///< in a new simulation, which is now the present one
    bool hasReplaced = false;                                  ///< it replaced one that reads no fills
  };
  struct Events {
    std::function<void(const Result &)> created;                               ///< at least one body was created
    std::function<void(const std::string &title, const Error &error)> failed;  ///< no body was created
  };
  BodyCreation(Session &session, Events events) : session_(session), events_(std::move(events)) {}

  /// Creates the bodies one after the other in one background job, with progress. A later request ends a running one.
  /// The bodies join the present simulation. Without one, a simulation starts without gravity, because the scan shows
  /// the organs in equilibrium with it. The failure of one body does not prevent the creation of the others. On
  /// cancellation, bodies that have joined the present simulation stay, and a new simulation is discarded.
  void createBodies(std::vector<segmentation::BodyRequest> requests);

 private:
  /// @param changes  of the simulation that the bodies join; null: a new one
  [[nodiscard]] Expected<void> createAll(c3de_object *simulator, const std::shared_ptr<ChangeLog> &changes,
                                         Result &result, const ProgressFn &progress);

  Session &session_;
  Events events_;
  Handle job_;
  std::uint64_t serial_ = 0;
};

/// "liver, spleen and stomach"; of more than four names the first three: "liver, spleen, stomach and 2 more".
[[nodiscard]] std::string namesOf(const std::vector<segmentation::BodyRequest> &requests);
/// Of the bodies in the present simulation. Main thread.
[[nodiscard]] std::set<std::string> bodyNames(Session &session);
/// The initial world for bodies from a scan: no gravity, damped, no body yet.
[[nodiscard]] scene::SceneFile sceneWithoutBodies();
/// The request as a scene of one body. @param preset  null: the simulator's default values
[[nodiscard]] scene::SceneFile sceneOf(const segmentation::BodyRequest &request, imaging::Mask mask,
                                       const scene::MaterialPreset *preset);

}  // namespace c3de::session
