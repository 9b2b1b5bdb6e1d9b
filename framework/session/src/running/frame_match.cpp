// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/frame_match.h"

#include <chrono>
#include <utility>

#include "c3de/session/change_log.h"
#include "c3de/session/match_stages.h"
#include "c3de/session/measurements.h"

namespace c3de::session {
namespace {

/// The body at the motion of the frame before.
Expected<RigidMatch> matchAt(const Mat4 &motion, const geometry::TriangleMesh &skin, const MatchTargets &targets,
                             const std::vector<Landmark> &landmarks, const scene::SceneMatch &wanted,
                             ThreadPool *pool) {
  auto out = matchInPlace(skin, targets, landmarks, wanted, pool);
  if (!out) return out;
  auto after = registration::residualsOf(skin, targets.surface.points_mm, motion, out->rigid.after.limit_mm, pool);
  if (!after) return tl::unexpected(after.error());
  out->rigid.measuredFromBody = motion;
  out->rigid.candidates = {{motion, after->rms_mm, after->inlierShare}};
  out->rigid.after = std::move(*after);
  std::vector<double> errors_mm;
  for (MatchedLandmark &one : out->landmarks) {
    one.rigid_mm = transformPoint(motion, one.reference_mm);
    errors_mm.push_back(one.errorRigid_mm());
  }
  if (!errors_mm.empty()) out->after = summaryOf(errors_mm);
  return out;
}

}  // namespace

Expected<FrameMatch> matchPoints(c3de_object *simulator, const std::string &name, const geometry::TriangleMesh &skin,
                                 const MatchTargets &targets, const std::vector<Landmark> &landmarks,
                                 const scene::SceneMatch &wanted, const std::optional<Mat4> &motionBefore,
                                 const char *owner, const std::function<std::string()> &takeError, ThreadPool *pool,
                                 const ProgressFn &progress) {
  // Fewer points do not determine a motion, so the search refuses them.
  if (motionBefore && targets.surface.points_mm.size() < registration::kFewestSurfacePoints)
    return matchPoints(simulator, name, skin, targets, landmarks, wanted, std::nullopt, owner, takeError, pool,
                       progress);
  const auto begin = std::chrono::steady_clock::now();
  auto rigid = motionBefore ? matchAt(*motionBefore, skin, targets, landmarks, wanted, pool)
                            : findMotion(skin, targets, landmarks, wanted, pool, progress);
  if (!rigid) return tl::unexpected(rigid.error());
  FrameMatch out;
  out.rigid = std::move(*rigid);
  if (wanted.deforms && out.rigid.isUsable()) {
    auto elastic = deformBody(simulator, name, out.rigid, targets, landmarks, wanted, owner, takeError, progress,
                              {.continuesLast = motionBefore.has_value()});
    if (!elastic) return tl::unexpected(elastic.error());
    out.elastic = std::move(*elastic);
  }
  // The motion of the frame before is no result without a deformation: it is sought anew.
  if (motionBefore && !out.elastic.body)
    return matchPoints(simulator, name, skin, targets, landmarks, wanted, std::nullopt, owner, takeError, pool,
                       progress);
  out.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return out;
}

Expected<FrameMatch> matchFrame(Session &session, c3de_object *simulator, const scene::SceneFile &scene,
                                const std::string &name, const geometry::TriangleMesh &skin,
                                const FrameRequest &request, const ProgressFn &progress) {
  const auto begin = std::chrono::steady_clock::now();
  scene::SceneMatch wanted = request.wanted;
  // Those of other bodies are left out below.
  const bool areFitted = std::exchange(wanted.fitsLandmarks, false);
  const auto takeError = [&session] { return session.plugins().takeError(); };
  const auto landmarks = unrecorded(
      session.changes(), [&] { return landmarksOfBody(simulator, scene, request.landmarks, wanted, name, takeError); });
  if (!landmarks) return tl::unexpected(landmarks.error());
  wanted.fitsLandmarks = areFitted && !landmarks->empty();
  auto out = matchPoints(simulator, name, skin, request.targets, *landmarks, wanted, request.measuredFromBodyBefore,
                         session.plugins().ownerOf(simulator), takeError, &session.pool(), progress);
  if (!out) return out;
  const auto measured = unrecorded(
      session.changes(), [&] { return measureLandmarks(simulator, *landmarks, out->rigid, takeError, out->elastic); });
  if (!measured) return tl::unexpected(measured.error());
  out->wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return out;
}

}  // namespace c3de::session
