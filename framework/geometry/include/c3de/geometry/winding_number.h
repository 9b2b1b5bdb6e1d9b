// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>

#include "c3de/geometry/triangle_mesh.h"

namespace c3de::geometry {

/// Generalised winding number of a triangle soup: about 1 inside, 0 outside, in between at holes. Robust where counting
/// ray hits is not: faces in the planes of the bounding box, holes, overlaps, duplicate faces.
///
/// @source Jacobson, Kavan, Sorkine-Hornung, Robust Inside-Outside Segmentation using Generalized Winding Numbers,
///         SIGGRAPH 2013; far field by dipoles as in Barill et al., Fast Winding Numbers for Soups and Clouds, SIGGRAPH
///         2018
class WindingNumber {
 public:
  /// Copies the required data; O(n log n).
  explicit WindingNumber(const TriangleMesh &mesh);
  ~WindingNumber();
  WindingNumber(WindingNumber &&) noexcept;
  WindingNumber &operator=(WindingNumber &&) noexcept;

  /// Within 0.01 of the exact sum over all triangles, also next to the surface. On the surface itself it is finite and
  /// between the values of the two sides.
  /// @threads any, concurrently
  [[nodiscard]] double at(const Vec3 &point_mm) const;
  void at(std::span<const Vec3> points_mm, std::span<double> out) const;

 private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace c3de::geometry
