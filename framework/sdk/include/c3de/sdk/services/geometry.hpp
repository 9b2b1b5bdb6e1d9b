// SPDX-License-Identifier: Apache-2.0
// Meshes, and trees for collision queries.
#pragma once

#include <array>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "c3de/sdk/owned.hpp"
#include "c3de/sdk/services/service.hpp"
#include "c3de/sdk/view.hpp"

namespace c3de::sdk {

using MeshHandle = Owned<c3de_mesh_v1, &c3de_mesh_v1::release>;

class Mesh : public Service<c3de_mesh_v1> {
 public:
  using Service::Service;
  /// @param unit  C3DE_UNIT_M, _MM or _CM, of the numbers in the file; _UNKNOWN: what it says, else mm
  Result<MeshHandle> load(std::string_view path, std::uint32_t unit, const c3de_progress *progress = nullptr) const {
    return own<&c3de_mesh_v1::load, MeshHandle>(str(path), unit, progress);
  }
  Result<MeshHandle> create(c3de_view positions_mm, c3de_view triangles) const {
    return own<&c3de_mesh_v1::create, MeshHandle>(positions_mm, triangles);
  }
  Result<c3de_mesh_info> info(c3de_handle mesh) const {
    c3de_mesh_info out{};
    out.size = sizeof out;
    if (auto done = call<&c3de_mesh_v1::info>(mesh, &out); !done) return done.failure();
    return out;
  }
  Result<std::string> report(c3de_handle mesh) const {
    TextSink sink;
    if (auto done = call<&c3de_mesh_v1::report>(mesh, sink.sink()); !done) return done.failure();
    return sink.take();
  }
  /// Borrowed until the mesh is released; mm.
  Result<Rows<const double, 3>> positions(c3de_handle mesh) const {
    c3de_view view{};
    if (auto done = call<&c3de_mesh_v1::positions>(mesh, &view); !done) return done.failure();
    return asRows<double, 3>(view, "mesh positions");
  }
  Result<Rows<const std::uint32_t, 3>> triangles(c3de_handle mesh) const {
    c3de_view view{};
    if (auto done = call<&c3de_mesh_v1::triangles>(mesh, &view); !done) return done.failure();
    return asRows<std::uint32_t, 3>(view, "mesh triangles");
  }
  Result<void> windingNumbers(c3de_handle mesh, c3de_view points_mm, std::span<double> out) const {
    return call<&c3de_mesh_v1::winding_numbers>(mesh, points_mm, mutableRows<double, 1>(out));
  }
};

using CollisionTree = Owned<c3de_collision_v1, &c3de_collision_v1::destroy>;

class Collision : public Service<c3de_collision_v1> {
 public:
  using Service::Service;
  Result<CollisionTree> create(c3de_view positions, c3de_view triangles) const {
    return own<&c3de_collision_v1::create, CollisionTree>(positions, triangles);
  }
  Result<void> refit(c3de_handle tree, c3de_view positions) const {
    return call<&c3de_collision_v1::refit>(tree, positions);
  }
  Result<void> rebuild(c3de_handle tree) const { return call<&c3de_collision_v1::rebuild>(tree); }
  /// First hit of each ray with t in [0, tMax]; out has one entry per ray.
  Result<void> rays(c3de_handle tree, std::span<const Vec3> origins, std::span<const Vec3> directions, double tMax,
                    std::span<c3de_ray_hit> out) const {
    if (out.size() != origins.size()) return sizes("rays", origins.size(), out.size());
    return call<&c3de_collision_v1::rays>(tree, rows<double, 3>(origins), rows<double, 3>(directions), tMax,
                                          out.data());
  }
  Result<c3de_ray_hit> ray(c3de_handle tree, const Vec3 &origin, const Vec3 &direction,
                           double tMax = std::numeric_limits<double>::infinity()) const {
    c3de_ray_hit hit{};
    if (auto done = rays(tree, {&origin, 1}, {&direction, 1}, tMax, {&hit, 1}); !done) return done.failure();
    return hit;
  }
  Result<void> segments(c3de_handle tree, std::span<const Vec3> from, std::span<const Vec3> to,
                        std::span<c3de_ray_hit> out) const {
    if (out.size() != from.size()) return sizes("segments", from.size(), out.size());
    return call<&c3de_collision_v1::segments>(tree, rows<double, 3>(from), rows<double, 3>(to), out.data());
  }
  /// @param maxDistances  one per point, or one for all
  Result<void> closest(c3de_handle tree, std::span<const Vec3> points, std::span<const double> maxDistances,
                       std::span<c3de_closest> out) const {
    if (out.size() != points.size()) return sizes("closest", points.size(), out.size());
    return call<&c3de_collision_v1::closest>(tree, rows<double, 3>(points), scalars(maxDistances), out.data());
  }
  /// Triangles that meet the sphere, ascending.
  Result<void> sphere(c3de_handle tree, const Vec3 &centre, double radius, std::vector<std::uint32_t> &out) const {
    if (!table_) return absent();
    if (out.size() < 32) out.resize(32);
    std::uint64_t needed = 0;
    c3de_status status = table_->sphere(table_->ctx, tree, centre.data(), radius, out.data(), out.size(), &needed);
    if (status == C3DE_S_TRUNCATED) {
      out.resize(static_cast<std::size_t>(needed));
      status = table_->sphere(table_->ctx, tree, centre.data(), radius, out.data(), out.size(), &needed);
    }
    if (status < 0) return host_.failure(status);
    out.resize(static_cast<std::size_t>(needed));
    return {};
  }
  /// Triangles of two trees, or of one, that are no farther apart (0: that meet), ascending; of revision 2.
  Result<void> pairs(c3de_handle first, c3de_handle second, double maxDistance,
                     std::vector<std::array<std::uint32_t, 2>> &out) const {
    if (!table_) return absent();
    if (table_->rev < 2) return Failure{C3DE_E_VERSION, "the host finds no pairs (c3de.collision/1 of revision 1)"};
    if (out.size() < 32) out.resize(32);
    std::uint64_t needed = 0;
    const auto ask = [&] {
      return table_->pairs(table_->ctx, first, second, maxDistance, out.front().data(), out.size(), &needed);
    };
    c3de_status status = ask();
    if (status == C3DE_S_TRUNCATED) {
      out.resize(static_cast<std::size_t>(needed));
      status = ask();
    }
    if (status < 0) return host_.failure(status);
    out.resize(static_cast<std::size_t>(needed));
    return {};
  }

 private:
  static Failure sizes(const char *what, std::size_t in, std::size_t out) {
    return {C3DE_E_ARG,
            std::string(what) + ": " + std::to_string(in) + " queries, room for " + std::to_string(out) + " results"};
  }
};

}  // namespace c3de::sdk
