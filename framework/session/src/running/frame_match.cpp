// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/frame_match.h"

#include <chrono>

#include "c3de/session/change_log.h"
#include "c3de/session/measurements.h"

namespace c3de::session {
namespace {

using registration::RegistrationVerdict;

double secondsSince(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

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

/// Where the noise does not explain the residual, the size of the deformation does: the distance from which a point
/// counts as an outlier grows until the motion is explained.
Expected<RigidMatch> rigidMotion(const geometry::TriangleMesh &skin, const FrameRequest &request, ThreadPool *pool,
                                 const ProgressFn &progress) {
  const scene::SceneMatch &wanted = request.wanted;
  if (request.measuredFromBodyBefore) return matchAt(*request.measuredFromBodyBefore, skin, request, pool);
  if (!wanted.isRigidFirst) return matchInPlace(skin, request.targets, request.landmarks, wanted, pool);
  auto rigid = matchRigid(skin, request.targets, request.landmarks, wanted, pool, progress);
  scene::SceneMatch wider = wanted;
  for (const double factor : {2.0, 5.0, 10.0}) {
    if (!wanted.deforms || !rigid || rigid->rigid.verdict != RegistrationVerdict::unexplained) break;
    wider.noise_mm = factor * wanted.noise_mm;
    auto next = matchRigid(skin, request.targets, request.landmarks, wider, pool, progress);
    if (!next && next.error().code == ErrorCode::cancelled) return next;
    if (!next || !next->isUsable()) break;
    rigid = std::move(next);
  }
  return rigid;
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
  const auto begin = std::chrono::steady_clock::now();
  const auto takeError = [&session] { return session.plugins().takeError(); };
  registration::MeasuredSurface measured = request.targets.surface;
  std::vector<Landmark> targeted;
  for (const Landmark &one : request.landmarks)
    if (one.target_mm) targeted.push_back(one);
  if (!targeted.empty())
    if (const auto found = unrecorded(session, [&] { return findBodies(simulator, scene, targeted, takeError); });
        !found)
      return tl::unexpected(found.error());
  if (request.wanted.fitsLandmarks)
    for (const Landmark &one : targeted) measured.pairs.push_back({one.reference_mm, *one.target_mm});
  BodyMatchOptions how;
  how.measuredFromBody = rigid.rigid.measuredFromBody;
  how.isMotionKnown = !request.wanted.isRigidFirst;
  how.noise_mm = request.wanted.noise_mm;
  how.continuesLast = request.measuredFromBodyBefore.has_value();
  auto body = matchBody(simulator, name, measured, how, session.plugins().ownerOf(simulator), takeError, progress);
  ElasticMatch out;
  if (!body && body.error().code == ErrorCode::cancelled) return tl::unexpected(body.error());
  out.wall_s = secondsSince(begin);
  if (!body) {
    out.failure = body.error().message;
    return out;
  }
  out.body = std::move(*body);
  if (targeted.empty()) return out;
  const auto now = unrecorded(session, [&] { return measure(simulator, scene, targeted, takeError); });
  if (!now) return tl::unexpected(now.error());
  std::vector<Vec3> at_mm;
  for (const MeasuredLandmark &one : now->landmarks) at_mm.push_back(one.position_mm);
  addLandmarks(rigid, std::move(at_mm), out);
  return out;
}

}  // namespace

Expected<FrameMatch> matchFrame(Session &session, c3de_object *simulator, const scene::SceneFile &scene,
                                const std::string &name, const geometry::TriangleMesh &skin,
                                const FrameRequest &request, const ProgressFn &progress) {
  const auto begin = std::chrono::steady_clock::now();
  auto rigid = rigidMotion(skin, request, &session.pool(), progress);
  if (!rigid) return tl::unexpected(rigid.error());
  FrameMatch out;
  out.rigid = std::move(*rigid);
  auto elastic = deform(session, simulator, scene, name, request, out.rigid, progress);
  if (!elastic) return tl::unexpected(elastic.error());
  out.elastic = std::move(*elastic);
  out.wall_s = secondsSince(begin);
  return out;
}

}  // namespace c3de::session
