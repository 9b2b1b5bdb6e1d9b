// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/frame_match.h"

#include <chrono>

#include "c3de/session/change_log.h"
#include "c3de/session/match_stages.h"
#include "c3de/session/measurements.h"

namespace c3de::session {
namespace {

/// The body at the motion of the frame before.
Expected<RigidMatch> matchAt(const Mat4 &motion, const geometry::TriangleMesh &skin, const FrameRequest &request,
                             ThreadPool *pool) {
  auto out = matchInPlace(skin, request.targets, request.landmarks, request.wanted, pool);
  if (!out) return out;
  auto after =
      registration::residualsOf(skin, request.targets.surface.points_mm, motion, out->rigid.after.limit_mm, pool);
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

/// Calls a function that adds probes and removes them again, so that these are no changes of the session.
template <class Read>
auto unrecorded(Session &session, const Read &read) {
  const std::shared_ptr<ChangeLog> changes = session.changes();
  std::optional<ChangeLog::Unrecorded> pause;
  if (changes) pause.emplace(*changes);
  return read();
}

Expected<ElasticMatch> deform(Session &session, c3de_object *simulator, const scene::SceneFile &scene,
                              const std::string &name, const FrameRequest &request, const RigidMatch &rigid,
                              const ProgressFn &progress) {
  if (!request.wanted.deforms || !rigid.isUsable()) return ElasticMatch{};
  const auto takeError = [&session] { return session.plugins().takeError(); };
  std::vector<Landmark> landmarks = withTargets(request.landmarks);
  if (!landmarks.empty())
    if (const auto found = unrecorded(session, [&] { return findBodies(simulator, scene, landmarks, takeError); });
        !found)
      return tl::unexpected(found.error());
  auto out =
      deformBody(simulator, name, rigid, request.targets, landmarks, request.wanted,
                 session.plugins().ownerOf(simulator), takeError, progress, request.measuredFromBodyBefore.has_value());
  if (!out) return out;
  const auto measured =
      unrecorded(session, [&] { return measureLandmarks(simulator, scene, landmarks, rigid, takeError, *out); });
  if (!measured) return tl::unexpected(measured.error());
  return out;
}

}  // namespace

Expected<FrameMatch> matchFrame(Session &session, c3de_object *simulator, const scene::SceneFile &scene,
                                const std::string &name, const geometry::TriangleMesh &skin,
                                const FrameRequest &request, const ProgressFn &progress) {
  const auto begin = std::chrono::steady_clock::now();
  ThreadPool *const pool = &session.pool();
  auto rigid = request.measuredFromBodyBefore
                   ? matchAt(*request.measuredFromBodyBefore, skin, request, pool)
                   : findMotion(skin, request.targets, request.landmarks, request.wanted, pool, progress);
  if (!rigid) return tl::unexpected(rigid.error());
  FrameMatch out;
  out.rigid = std::move(*rigid);
  auto elastic = deform(session, simulator, scene, name, request, out.rigid, progress);
  if (!elastic) return tl::unexpected(elastic.error());
  out.elastic = std::move(*elastic);
  out.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return out;
}

}  // namespace c3de::session
