// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <optional>

#include "c3de/abi/iface/simulator.h"
#include "parameters.h"
#include "placed_mesh.h"
#include "pointbased/displacement_field.h"
#include "pointbased/occupancy.h"
#include "pointbased/rest_state.h"

namespace pointbased {

/// Another material in a region of a body.
struct BodyPart {
  std::string name;  ///< of a tissue; may be empty
  Region region;
  ParameterValues values;        ///< complete: what the part does not say is as in the body
  std::vector<std::string> own;  ///< ids that the part says itself
};

/// What of space a body fills, where the scene puts it.
struct FillSource {
  std::vector<float> values;
  Occupancy occupancy;  ///< of `values`
  FillSource(std::vector<float> all, Occupancy placed) : values(std::move(all)), occupancy(std::move(placed)) {
    occupancy.fill = values;
  }
  FillSource(const FillSource &) = delete;
  FillSource &operator=(const FillSource &) = delete;
};

/// What a body was made from, and can be made from again.
struct BodySource {
  std::shared_ptr<const sdk::MeshHandle> mesh;
  Placement placement;
  std::shared_ptr<const FillSource> fill;  ///< null: the inside of the mesh
  std::vector<Fix> fixes;
  std::vector<std::uint32_t> fixNumbers;  ///< of reports and messages
  std::vector<std::string> fixNames;      ///< their numbers where they have none
  std::vector<Load> loads;
  std::vector<std::uint32_t> loadNumbers;
  std::vector<BodyPart> parts;                              ///< later ones win
  std::shared_ptr<const std::vector<std::string>> tissues;  ///< names of these, for those who share them
  std::vector<Refinement> refinements;
  std::vector<Load> hands;  ///< what hands have done to it so far: loads of the trial of an adaptive sampling
  std::optional<std::array<float, 3>> colour;                    ///< sRGB; none: any
  Vec3 velocity = Vec3::Zero(), angularVelocity = Vec3::Zero();  ///< m/s, rad/s; at the start
};

/// Reads what add_body was given, without the mesh. Errors as sdk::Error with their place.
/// @param values  of the body: what a part does not say is as there
[[nodiscard]] BodySource readSource(const c3de_sim_body &body, const ParameterValues &values);

/// A region of the host. Errors as sdk::Error, with their place.
/// @param placement  of the body that it is of; null: it may not be a fill
[[nodiscard]] Region readRegion(const c3de_sim_region *region, const sdk::ErrorPlace &where,
                                const Placement *placement = nullptr);

/// A load of add_load. Errors as sdk::Error.
[[nodiscard]] Load readLoad(const c3de_sim_load *load);

/// A rotation by a quaternion x, y, z, w of unit length to 1e-6. Errors as sdk::Error, `what` in front.
[[nodiscard]] Mat3 readRotation(const double *xyzw, const char *what);

/// A grid of the host. Errors as sdk::Error, `what` in front.
[[nodiscard]] FieldGrid readGrid(const c3de_sim_grid &grid, const char *what);

/// A rigid motion as a fix without a region; nothing: stands still. Errors as sdk::Error.
[[nodiscard]] std::optional<Fix> readMotion(const c3de_sim_motion *motion, const char *what);

}  // namespace pointbased
