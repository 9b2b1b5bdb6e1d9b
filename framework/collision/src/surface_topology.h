// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "c3de/core/vec.h"

namespace c3de::collision {

/// Which triangles meet at a vertex, and whether the surface is closed. Depends on the indices alone, so it is valid
/// for all positions of the vertices.
class SurfaceTopology {
 public:
  SurfaceTopology(std::size_t vertexCount, std::span<const Triangle> triangles);

  /// Every edge is traversed equally often in both directions.
  [[nodiscard]] bool isClosed() const { return closed_; }
  [[nodiscard]] std::span<const std::uint32_t> trianglesAt(unsigned vertex) const {
    return {list_.data() + begin_[vertex], begin_[vertex + 1] - begin_[vertex]};
  }

 private:
  std::vector<std::size_t> begin_;   ///< [vertexCount + 1] into list_
  std::vector<std::uint32_t> list_;  ///< ascending per vertex; a triangle that contains a vertex twice occurs twice
  bool closed_ = false;
};

}  // namespace c3de::collision
