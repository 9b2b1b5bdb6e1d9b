// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "base/accuracy_target.h"
#include "simulator/body_source.h"
#include "simulator/material_laws.h"

namespace pointbased {

/// A body built from a mesh of the host.
struct BuiltBody {
  std::unique_ptr<Body> body;
  std::shared_ptr<PlacedMesh> surface;
  std::optional<AccuracyPrediction> promise;  ///< if its sampling was chosen by the accuracy setting
  std::optional<AdaptiveSampling> adaptive;   ///< if finer cells were requested
};

/// Fills the mesh and binds its vertices as surfels. Throws sdk::Error for a mesh that bounds no volume, for a sampling
/// that does not fit, and when cancelled. Any thread.
/// @param dial  chooses the sampling where the values do not specify it
[[nodiscard]] BuiltBody buildBody(const Services &services, const MaterialLaws &laws, const std::string &name,
                                  c3de_handle mesh, const BodySource &source, const ParameterValues &values,
                                  const SamplingRequest &dial, const sdk::Progress &progress);

/// Whether the smallest cells of a body may determine the step size, so that its masses are scaled (Body::scaleMasses).
[[nodiscard]] bool mayStepExplicitly(Integrator integrator);

/// What a body is filled from, so that it can be filled again with another sampling.
struct BodyFilling {
  BodyShape shape;
  BodyRecipe recipe;  ///< its sampling as specified by the body's values
  std::shared_ptr<PlacedMesh> surface;
};
/// Throws sdk::Error. Any thread.
[[nodiscard]] BodyFilling fillingOf(const Services &services, const std::string &name, const BodySource &source,
                                    const ParameterValues &values, const ParallelFor &parallelFor);

/// The materials of a body and its parts. Throws sdk::Error.
[[nodiscard]] Constitution constitutionOf(const MaterialLaws &laws, const std::string &name, const BodySource &source,
                                          const ParameterValues &values);

/// An own mesh with the same triangles, so that the caller of add_body may release theirs. Throws sdk::Error.
[[nodiscard]] sdk::MeshHandle copyMesh(const Services &services, c3de_handle mesh);

struct ObstacleSurface {
  double friction = 0.0, restitution = 0.0;
};

/// An obstacle whose queries are answered by the host's collision service. Throws sdk::Error.
[[nodiscard]] Obstacle buildObstacle(const Services &services, const std::string &name,
                                     const std::shared_ptr<PlacedMesh> &mesh, const ObstacleSurface &surface,
                                     const std::optional<Fix> &motion);

}  // namespace pointbased
