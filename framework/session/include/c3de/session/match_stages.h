// SPDX-License-Identifier: Apache-2.0
// The stages of a match, for a command and for the window: skins, rigid motion, deformation, landmarks. [sim]: call on
// the thread that steps the simulator, between two steps. `takeError` returns the text of the last failed call.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "c3de/abi/iface/simulator.h"
#include "c3de/core/expected.h"
#include "c3de/core/progress.h"
#include "c3de/core/thread_pool.h"
#include "c3de/geometry/triangle_mesh.h"
#include "c3de/scene/scene_file.h"
#include "c3de/session/measurements.h"
#include "c3de/session/rigid_match.h"

namespace c3de::session {

/// Sets the label of a match by its number or its name. Errors (usage): a number outside of 1 … 65535.
[[nodiscard]] Expected<void> setMatchLabel(const std::string &text, scene::SceneMatch &match);

/// Name of a body in the simulator: the rest of a cut body has the name of the body.
[[nodiscard]] std::string nameInSimulator(const scene::SceneFile &scene, const std::string &name);

/// Names of the bodies, in the order of the simulator. [sim]
[[nodiscard]] std::vector<std::string> simulatedBodies(c3de_object *simulator);

/// The skin of a body at rest and now, LPS mm.
struct BodySkins {
  geometry::TriangleMesh rest, present;
};
/// Errors (plugin): the simulator has no such body, or no skin of it. [sim]
[[nodiscard]] Expected<BodySkins> skinsOf(c3de_object *simulator, const std::string &body,
                                          const std::function<std::string()> &takeError);

/// Those that have a measured position, in their order.
[[nodiscard]] std::vector<Landmark> withTargets(const std::vector<Landmark> &landmarks);

/// Landmarks in a body, or in none, that have a measured position. Probes are added and removed again: pause the log of
/// changes. Errors: those of findBodies(); usage: none is left, and they are to be fitted. [sim]
[[nodiscard]] Expected<std::vector<Landmark>> landmarksOfBody(c3de_object *simulator, const scene::SceneFile &scene,
                                                              const std::vector<Landmark> &landmarks,
                                                              const scene::SceneMatch &match, const std::string &body,
                                                              const std::function<std::string()> &takeError);

/// The rigid motion of a match. Where the body deforms and the noise does not explain the residual, the size of the
/// deformation does: the distance from which a point counts as an outlier grows until the motion is explained. Errors
/// as of matchRigid(). Any thread.
/// @param skin  of the body at rest
[[nodiscard]] Expected<RigidMatch> findMotion(const geometry::TriangleMesh &skin, const MatchTargets &targets,
                                              const std::vector<Landmark> &landmarks, const scene::SceneMatch &match,
                                              ThreadPool *pool, const ProgressFn &progress);

struct DeformationOptions {
  bool continuesLast = false;    ///< from the state of the last match of this body instead of the body at rest
  bool showsIterations = false;  ///< snapshots show each iteration during the match; a step ends that
};

/// Deforms the body at its rigid motion. Where that is not possible the rigid motion remains, with the reason in
/// ElasticMatch::failure. Errors: cancelled. Any thread.
/// @param body       its name in the simulator
/// @param landmarks  with their bodies (findBodies)
/// @param owner      plugin of the simulator
[[nodiscard]] Expected<ElasticMatch> deformBody(c3de_object *simulator, const std::string &body,
                                                const RigidMatch &rigid, const MatchTargets &targets,
                                                const std::vector<Landmark> &landmarks, const scene::SceneMatch &match,
                                                const char *owner, const std::function<std::string()> &takeError,
                                                const ProgressFn &progress, DeformationOptions options = {});

/// Adds the landmarks after the deformation. Probes are added and removed again: pause the log of changes. Errors as of
/// measure(). [sim]
[[nodiscard]] Expected<void> measureLandmarks(c3de_object *simulator, const std::vector<Landmark> &landmarks,
                                              const RigidMatch &rigid, const std::function<std::string()> &takeError,
                                              ElasticMatch &elastic);

/// Why a match that is not usable is not: a sentence with the warnings.
[[nodiscard]] std::string failureOf(const RigidMatch &match);

/// A measured point in the space of the body, that is, after the inverse of the motion.
struct MatchedPoint {
  Vec3 measured_mm{}, surface_mm{};  ///< the point, and the closest one of the skin
  bool isUsed = true;                ///< false: an outlier
  [[nodiscard]] double distance_mm() const { return norm(measured_mm - surface_mm); }
};
/// All measured points, in their order. Errors: of a skin without area. Any thread.
/// @param skin    of the body now
/// @param motion  from the body to what was measured
[[nodiscard]] Expected<std::vector<MatchedPoint>> matchedPoints(const geometry::TriangleMesh &skin,
                                                                const MatchTargets &targets, const RigidMatch &rigid,
                                                                const ElasticMatch &elastic, const Mat4 &motion);

}  // namespace c3de::session
