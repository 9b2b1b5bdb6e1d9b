// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>

#include "arguments.h"
#include "c3de/core/per_thread.h"
#include "services/services.h"

namespace c3de::plugin_host {
namespace {

std::shared_ptr<SharedTree> find(PluginContext &plugin, c3de_handle tree) {
  auto found = plugin.host().trees.find(handleOf(tree));
  if (!found) throw Refusal(C3DE_E_STALE, fmt::format("there is no tree of handle {}", textOf(tree)));
  return found;
}

/// For functions that change a tree: only its owner may.
std::shared_ptr<SharedTree> findOwn(PluginContext &plugin, c3de_handle tree) {
  auto found = find(plugin, tree);
  if (found->owner != plugin.id())
    throw Refusal(C3DE_E_STATE, fmt::format("the tree of handle {} belongs to plugin {}", textOf(tree), found->owner));
  return found;
}

void requireSameCount(const char *a, std::size_t aCount, const char *b, std::size_t bCount) {
  if (aCount != bCount) throw Refusal(C3DE_E_ARG, fmt::format("{}: {} rows, {}: {} rows", a, aCount, b, bCount));
}

c3de_ray_hit abiHit(const collision::RayHit &hit) {
  return {hit.t, hit.triangle, 0, {hit.bary[0], hit.bary[1], hit.bary[2]}};
}

c3de_status C3DE_CALL create(void *ctx, c3de_view positions, c3de_view triangles, c3de_handle *out) noexcept {
  return serve(ctx, "collision.create", [&](PluginContext &plugin) {
    requireNonNull(out, "out")->v = 0;
    const auto vertices = positionsOf(positions, "positions");
    const auto corners = trianglesOf(triangles, "triangles", vertices.size());
    auto tree = std::make_shared<SharedTree>(plugin.id(), orRefuse(collision::AabbTree::build(vertices, corners)));
    writeHandle(out, plugin.host().trees.add(std::move(tree)));
  });
}

c3de_status C3DE_CALL destroy(void *ctx, c3de_handle tree) noexcept {
  return serve(ctx, "collision.destroy", [&](PluginContext &plugin) {
    (void)findOwn(plugin, tree);
    plugin.host().trees.remove(handleOf(tree));
  });
}

c3de_status C3DE_CALL refit(void *ctx, c3de_handle tree, c3de_view positions) noexcept {
  return serve(ctx, "collision.refit", [&](PluginContext &plugin) {
    const auto shared = findOwn(plugin, tree);
    const auto vertices = positionsOf(positions, "positions");
    const std::unique_lock lock(shared->mutex);
    if (vertices.size() != shared->tree.vertexCount())
      throw Refusal(C3DE_E_ARG, fmt::format("positions: {} rows, the tree has {} vertices", vertices.size(),
                                            shared->tree.vertexCount()));
    orRefuse(shared->tree.refit(vertices));
  });
}

c3de_status C3DE_CALL rebuild(void *ctx, c3de_handle tree) noexcept {
  return serve(ctx, "collision.rebuild", [&](PluginContext &plugin) {
    const auto shared = findOwn(plugin, tree);
    const std::unique_lock lock(shared->mutex);
    shared->tree.rebuild();
  });
}

c3de_status C3DE_CALL rays(void *ctx, c3de_handle tree, c3de_view origins, c3de_view directions, double tMax,
                           c3de_ray_hit *out) noexcept {
  return serve(ctx, "collision.rays", [&](PluginContext &plugin) {
    const auto shared = find(plugin, tree);
    const PointRows from(origins, "origins"), along(directions, "directions");
    requireSameCount("origins", from.rows().size(), "directions", along.rows().size());
    if (!(tMax >= 0.0)) throw Refusal(C3DE_E_ARG, fmt::format("t_max is {}, accepted: 0 or above", tMax));
    if (!from.rows().empty()) requireNonNull(out, "out");
    const std::shared_lock lock(shared->mutex);
    for (std::size_t i = 0; i < from.rows().size(); ++i)
      out[i] = abiHit(shared->tree.ray(from.rows()[i], along.rows()[i], tMax));
  });
}

c3de_status C3DE_CALL segments(void *ctx, c3de_handle tree, c3de_view from, c3de_view to, c3de_ray_hit *out) noexcept {
  return serve(ctx, "collision.segments", [&](PluginContext &plugin) {
    const auto shared = find(plugin, tree);
    const PointRows begin(from, "from"), end(to, "to");
    requireSameCount("from", begin.rows().size(), "to", end.rows().size());
    if (!begin.rows().empty()) requireNonNull(out, "out");
    const std::shared_lock lock(shared->mutex);
    for (std::size_t i = 0; i < begin.rows().size(); ++i)
      out[i] = abiHit(shared->tree.segment(begin.rows()[i], end.rows()[i]));
  });
}

c3de_status C3DE_CALL closest(void *ctx, c3de_handle tree, c3de_view points, c3de_view maxDistances,
                              c3de_closest *out) noexcept {
  return serve(ctx, "collision.closest", [&](PluginContext &plugin) {
    const auto shared = find(plugin, tree);
    const PointRows at(points, "points");
    const auto ranges = numbersOf(maxDistances, "max_distances");
    if (ranges.size() != 1) requireSameCount("points", at.rows().size(), "max_distances", ranges.size());
    for (const double range : ranges)
      if (!(range >= 0.0)) throw Refusal(C3DE_E_ARG, fmt::format("max_distances: {}, accepted: 0 or above", range));
    if (!at.rows().empty()) requireNonNull(out, "out");
    const std::shared_lock lock(shared->mutex);
    for (std::size_t i = 0; i < at.rows().size(); ++i) {
      const auto found = shared->tree.closest(at.rows()[i], ranges.size() == 1 ? ranges[0] : ranges[i]);
      out[i] = {{found.point[0], found.point[1], found.point[2]},
                {found.normal[0], found.normal[1], found.normal[2]},
                found.distance,
                found.triangle,
                0,
                {found.bary[0], found.bary[1], found.bary[2]}};
    }
  });
}

c3de_status C3DE_CALL sphere(void *ctx, c3de_handle tree, const double *centre3, double radius, std::uint32_t *out,
                             std::uint64_t capacity, std::uint64_t *needed) noexcept {
  return serve(ctx, "collision.sphere", [&](PluginContext &plugin) -> c3de_status {
    const auto shared = find(plugin, tree);
    const Vec3 centre = pointOf(centre3, "centre3");
    if (!(radius >= 0.0) || !std::isfinite(radius))
      throw Refusal(C3DE_E_ARG, fmt::format("radius is {}, accepted: 0 or above", radius));
    requireNonNull(needed, "needed");
    if (capacity > 0) requireNonNull(out, "out");
    // Reused between queries, because this is called once per contact candidate and step.
    auto &found = perThread<std::vector<std::uint32_t>, struct FoundInSphere>();
    {
      const std::shared_lock lock(shared->mutex);
      shared->tree.sphere(centre, radius, found);
    }
    *needed = found.size();
    const std::size_t n = std::min<std::uint64_t>(found.size(), capacity);
    std::copy_n(found.begin(), n, out);
    return n < found.size() ? C3DE_S_TRUNCATED : C3DE_OK;
  });
}

c3de_status C3DE_CALL pairs(void *ctx, c3de_handle first, c3de_handle second, double maxDistance, std::uint32_t *out2,
                            std::uint64_t capacity, std::uint64_t *needed) noexcept {
  return serve(ctx, "collision.pairs", [&](PluginContext &plugin) -> c3de_status {
    const auto a = find(plugin, first), b = find(plugin, second);
    if (!(maxDistance >= 0.0) || !std::isfinite(maxDistance))
      throw Refusal(C3DE_E_ARG, fmt::format("max_distance is {}, accepted: 0 or above", maxDistance));
    requireNonNull(needed, "needed");
    if (capacity > 0) requireNonNull(out2, "out2");
    auto &found = perThread<std::vector<std::array<std::uint32_t, 2>>, struct FoundPairs>();
    {
      // Shared locks in a fixed order: a refit waiting between the two would block both.
      const std::shared_lock lower((a.get() < b.get() ? a : b)->mutex);
      const std::shared_lock upper =
          a == b ? std::shared_lock<std::shared_mutex>() : std::shared_lock((a.get() < b.get() ? b : a)->mutex);
      a->tree.pairs(b->tree, maxDistance, found);
    }
    *needed = found.size();
    const std::size_t n = std::min<std::uint64_t>(found.size(), capacity);
    for (std::size_t i = 0; i < n; ++i) std::copy(found[i].begin(), found[i].end(), out2 + 2 * i);
    return n < found.size() ? C3DE_S_TRUNCATED : C3DE_OK;
  });
}

}  // namespace

c3de_collision_v1 makeCollisionTable(PluginContext *plugin) {
  return {sizeof(c3de_collision_v1),
          2,
          plugin,
          &create,
          &destroy,
          &refit,
          &rebuild,
          &rays,
          &segments,
          &closest,
          &sphere,
          &pairs};
}

}  // namespace c3de::plugin_host
