// SPDX-License-Identifier: Apache-2.0
#include "loading/fitted_skins.h"

#include <utility>
#include <vector>

#include "c3de/collision/aabb_tree.h"

namespace c3de::session {
namespace {

constexpr int kRounds = 2;
constexpr double kGap = 1.0 / 3.0;  // of the reach: wider gaps are next to rims and belong to no pair of skins
constexpr double kFacing = -0.5;    // cosine of normals: excludes the opposite face of a thin layer

}  // namespace

Expected<void> fitSkins(std::span<geometry::TriangleMesh *const> skins, double reach_mm) {
  for (int round = 0; round < kRounds; ++round) {
    std::vector<collision::AabbTree> trees;
    for (const geometry::TriangleMesh *skin : skins) {
      auto tree = collision::AabbTree::build(skin->vertices, skin->triangles);
      if (!tree) return tl::unexpected(tree.error());
      trees.push_back(std::move(*tree));
    }
    for (std::size_t a = 0; a < skins.size(); ++a) {
      const std::vector<Vec3> normals = geometry::vertexNormals(*skins[a]);
      for (std::size_t v = 0; v < normals.size(); ++v) {
        Vec3 &x = skins[a]->vertices[v];
        const Vec3 before = x;
        for (std::size_t b = 0; b < skins.size(); ++b) {
          if (a == b) continue;
          const collision::ClosestPoint near = trees[b].closest(before, reach_mm);
          if (near.isFound() && near.distance <= kGap * reach_mm && dot(normals[v], near.normal) < kFacing)
            x = x + 0.5 * (near.point - before);
        }
      }
    }
  }
  return {};
}

}  // namespace c3de::session
