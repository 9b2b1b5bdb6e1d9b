// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "c3de/session/rigid_match.h"
#include "c3de/session/session.h"

namespace c3de::session {

/// One measurement of a body.
struct FrameRequest {
  MatchTargets targets;
  std::vector<Landmark> landmarks;  ///< those with a target take part
  scene::SceneMatch wanted;         ///< body, noise, use of landmarks, rigidFirst, deforms; its files are not read
  /// Motion of the frame before, from whose deformation the match starts; none: the first frame
  std::optional<Mat4> measuredFromBodyBefore;
};

struct FrameMatch {
  RigidMatch rigid;
  ElasticMatch elastic;
  double wall_s = 0.0;
  [[nodiscard]] const Mat4 &measuredFromBody() const {
    return elastic.body ? elastic.body->measuredFromBody : rigid.rigid.measuredFromBody;
  }
  /// Whether the next frame can start from it.
  [[nodiscard]] bool canContinue() const {
    constexpr double kLeastPart = 0.5;  // of the points: with fewer the body may be elsewhere
    return rigid.isUsable() && elastic.body && elastic.body->hasConverged && elastic.body->usedPart >= kLeastPart;
  }
};

/// Brings a body of a simulator that its session has adopted to one measurement: the rigid motion, or that of the frame
/// before, then the deformation. Where the body cannot be deformed, the rigid motion remains, with the reason. Errors
/// (input) refer to the measurement; cancelled. Call on the thread that steps the simulator, between two steps.
/// @param name  of the body in the simulator
/// @param skin  of the body at rest, LPS mm
[[nodiscard]] Expected<FrameMatch> matchFrame(Session &session, c3de_object *simulator, const scene::SceneFile &scene,
                                              const std::string &name, const geometry::TriangleMesh &skin,
                                              const FrameRequest &request, const ProgressFn &progress);

/// The part of matchFrame() for any thread, without the landmarks after the deformation.
/// @param landmarks     of this body, with targets
/// @param motionBefore  FrameRequest::measuredFromBodyBefore
/// @param owner         plugin of the simulator
[[nodiscard]] Expected<FrameMatch> matchPoints(c3de_object *simulator, const std::string &name,
                                               const geometry::TriangleMesh &skin, const MatchTargets &targets,
                                               const std::vector<Landmark> &landmarks, const scene::SceneMatch &wanted,
                                               const std::optional<Mat4> &motionBefore, const char *owner,
                                               const std::function<std::string()> &takeError, ThreadPool *pool,
                                               const ProgressFn &progress);

}  // namespace c3de::session
