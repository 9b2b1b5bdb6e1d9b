// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <optional>

#include "base/services.h"

namespace pointbased {

/// Scale, then rotation about x, y, z, then position.
struct Placement {
  Vec3 position = Vec3::Zero();  ///< m
  Mat3 rotation = Mat3::Identity();
  double scale = 1.0;  ///< > 0
};

/// Reads the placement from the host's struct. Throws sdk::Error for values that are not finite, and for a matrix that
/// is not a rotation times a scale.
[[nodiscard]] Placement readPlacement(const c3de_sim_placement *placement);

/// A mesh of the host, in metres, where the scene places it, with its tree for distances. Immutable after construction,
/// except for the tree of picking tools, which only the main thread uses.
struct PlacedMesh {
  std::vector<Vec3> positions;  ///< m
  std::vector<Vec3> normals;    ///< unit, area-weighted
  std::vector<std::array<std::uint32_t, 3>> triangles;
  double volume = 0.0;  ///< m³
  Vec3 min = Vec3::Zero(), max = Vec3::Zero();
  sdk::CollisionTree tree;
  mutable sdk::CollisionTree pickTree;  ///< presentTree()
};

/// Transforms between mesh coordinates and the placed mesh.
class PlacementTransform {
 public:
  explicit PlacementTransform(const Placement &placement);
  [[nodiscard]] Vec3 metres(const Vec3 &mesh_mm) const {
    return linear_ * (kMetresPerMillimetre * mesh_mm) + position_;
  }
  [[nodiscard]] Vec3 millimetres(const Vec3 &placed_m) const {
    return inverse_ * (placed_m - position_) / kMetresPerMillimetre;
  }

 private:
  Mat3 linear_, inverse_;
  Vec3 position_;
};

/// Throws errors of the services as sdk::Error. Any thread.
[[nodiscard]] std::shared_ptr<PlacedMesh> placeMesh(const Services &services, c3de_handle mesh,
                                                    const Placement &placement);

/// The tree of the mesh whose points are at other positions, until the next call; nothing if they do not fit. Its first
/// call creates the tree. Main thread.
[[nodiscard]] std::optional<c3de_handle> presentTree(const Services &services, const PlacedMesh &mesh,
                                                     c3de_view positions);

/// The nearest point of its surface at rest. Throws errors of the services as sdk::Error.
[[nodiscard]] c3de_closest closestOn(const Services &services, const PlacedMesh &mesh, const Vec3 &point);
[[nodiscard]] c3de_closest closestOn(const Services &services, c3de_handle tree, const Vec3 &point);
/// Distance of a point outside a closed mesh, m; 0 inside. Throws errors of the services as sdk::Error.
[[nodiscard]] double distanceOff(const Services &services, const PlacedMesh &mesh, const Vec3 &point);
/// Area of its triangles, m².
[[nodiscard]] double areaOf(const PlacedMesh &mesh);
/// Four digits, for messages.
[[nodiscard]] std::string shortNumber(double value);

}  // namespace pointbased
