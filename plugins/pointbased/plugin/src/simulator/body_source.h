// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <optional>

#include "base/parameters.h"
#include "base/placed_mesh.h"
#include "c3de/abi/iface/simulator.h"
#include "pointbased/displacement_field.h"
#include "pointbased/occupancy.h"
#include "pointbased/rest_state.h"

namespace pointbased {

/// Another material in a region of a body.
struct BodyPart {
  std::string name;  ///< of a tissue; may be empty
  Region region;
  ParameterValues values;        ///< complete: values the part does not specify are those of the body
  std::vector<std::string> own;  ///< ids that the part itself specifies
};

/// The region that a body fills, as placed by the scene.
struct FillSource {
  std::vector<float> values;
  Occupancy occupancy;  ///< of `values`
  FillSource(std::vector<float> all, Occupancy placed) : values(std::move(all)), occupancy(std::move(placed)) {
    occupancy.fill = values;
  }
  FillSource(const FillSource &) = delete;
  FillSource &operator=(const FillSource &) = delete;
};

/// What a body was built from, and can be rebuilt from.
struct BodySource {
  std::shared_ptr<const sdk::MeshHandle> mesh;
  Placement placement;
  std::shared_ptr<const FillSource> fill;  ///< null: the inside of the mesh
  std::vector<Fix> fixes;
  std::vector<std::uint32_t> fixNumbers;  ///< used in reports and messages
  std::vector<std::string> fixNames;      ///< their numbers where they have no name
  std::vector<Load> loads;
  std::vector<std::uint32_t> loadNumbers;
  std::vector<BodyPart> parts;                              ///< later ones take precedence
  std::shared_ptr<const std::vector<std::string>> tissues;  ///< names of the parts, for shared use
  std::vector<Refinement> refinements;
  std::vector<Load> grabs;  ///< pulls applied by grabs so far: loads of the trial of an adaptive sampling
  std::optional<std::array<float, 3>> colour;                    ///< sRGB; none: any
  Vec3 velocity = Vec3::Zero(), angularVelocity = Vec3::Zero();  ///< m/s, rad/s; initial values
};

/// Reads the arguments of add_body, without the mesh. Throws sdk::Error with the location of the error.
/// @param values  of the body: the defaults for values that a part does not specify
[[nodiscard]] BodySource readSource(const c3de_sim_body &body, const ParameterValues &values);

/// A region of the host. Throws sdk::Error with the location of the error.
/// @param placement  of the body that owns the region; null: the region may not be a fill
[[nodiscard]] Region readRegion(const c3de_sim_region *region, const sdk::ErrorPlace &where,
                                const Placement *placement = nullptr);

/// The load of an add_load call. Throws sdk::Error.
[[nodiscard]] Load readLoad(const c3de_sim_load *load);

/// A rotation from a quaternion x, y, z, w of unit length to 1e-6. Throws sdk::Error, prefixed with `what`.
[[nodiscard]] Mat3 readRotation(const double *xyzw, const char *what);

/// A grid of the host. Throws sdk::Error, prefixed with `what`.
[[nodiscard]] FieldGrid readGrid(const c3de_sim_grid &grid, const char *what);

/// A rigid motion as a fix without a region; nothing if it is static. Throws sdk::Error.
[[nodiscard]] std::optional<Fix> readMotion(const c3de_sim_motion *motion, const char *what);

}  // namespace pointbased
