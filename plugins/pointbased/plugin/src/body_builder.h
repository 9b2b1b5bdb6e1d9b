// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "accuracy_dial.h"
#include "body_source.h"
#include "material_laws.h"

namespace pointbased {

/// A body made from a mesh of the host.
struct BuiltBody {
  std::unique_ptr<Body> body;
  std::shared_ptr<PlacedMesh> surface;
  std::optional<AccuracyPromise> promise;    ///< where the dial has chosen its sampling
  std::optional<AdaptiveSampling> adaptive;  ///< where finer cells were asked for
};

/// Fills the mesh, binds its vertices as surfels. Errors as sdk::Error: a mesh that bounds no volume, a sampling that
/// does not fit, cancelled. Any thread.
/// @param dial  chooses the sampling where the values do not say it
[[nodiscard]] BuiltBody buildBody(const Services &services, const MaterialLaws &laws, const std::string &name,
                                  c3de_handle mesh, const BodySource &source, const ParameterValues &values,
                                  const DialRequest &dial, const sdk::Progress &progress);

/// Whether the smallest cells of a body may decide the length of steps, so that its masses are scaled
/// (Body::scaleMasses).
[[nodiscard]] bool mayStepExplicitly(Integrator integrator);

/// What a body is filled from, to be filled once more in another way.
struct BodyFilling {
  BodyShape shape;
  BodyRecipe recipe;  ///< its sampling as the body's values say it
  std::shared_ptr<PlacedMesh> surface;
};
/// Errors as sdk::Error. Any thread.
[[nodiscard]] BodyFilling fillingOf(const Services &services, const std::string &name, const BodySource &source,
                                    const ParameterValues &values, const ParallelFor &parallelFor);

/// The materials of a body and its parts. Errors as sdk::Error.
[[nodiscard]] Constitution constitutionOf(const MaterialLaws &laws, const std::string &name, const BodySource &source,
                                          const ParameterValues &values);

/// A mesh of our own with the same triangles: the caller of add_body may let go of theirs. Errors as sdk::Error.
[[nodiscard]] sdk::MeshHandle copyMesh(const Services &services, c3de_handle mesh);

struct ObstacleSurface {
  double friction = 0.0, restitution = 0.0;
};

/// The obstacle's questions answered by the host's collision service. Errors as sdk::Error.
[[nodiscard]] Obstacle buildObstacle(const Services &services, const std::string &name,
                                     const std::shared_ptr<PlacedMesh> &mesh, const ObstacleSurface &surface,
                                     const std::optional<Fix> &motion);

}  // namespace pointbased
