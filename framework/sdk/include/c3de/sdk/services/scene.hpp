// SPDX-License-Identifier: Apache-2.0
// Nodes of the scene, and what is drawn under them.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "c3de/sdk/owned.hpp"
#include "c3de/sdk/services/service.hpp"
#include "c3de/sdk/view.hpp"

namespace c3de::sdk {

using SceneNode = Owned<c3de_scene_v1, &c3de_scene_v1::remove_node>;

class Scene : public Service<c3de_scene_v1> {
 public:
  using Service::Service;
  Result<SceneNode> addNode(c3de_handle parent, std::string_view name) const {
    return own<&c3de_scene_v1::add_node, SceneNode>(parent, str(name));
  }
  /// Column-major, mm.
  Result<std::array<double, 16>> worldFromNode(c3de_handle node) const {
    std::array<double, 16> out{};
    if (auto done = call<&c3de_scene_v1::world_from_node>(node, out.data()); !done) return done.failure();
    return out;
  }
  Result<void> setVisible(c3de_handle node, bool visible) const {
    return call<&c3de_scene_v1::set_visible>(node, visible ? 1u : 0u);
  }
  Result<bool> isVisible(c3de_handle node) const {
    std::uint32_t visible = 0;
    if (auto done = call<&c3de_scene_v1::is_visible>(node, &visible); !done) return done.failure();
    return visible != 0;
  }
  Result<void> setBounds(c3de_handle node, const Vec3 &min, const Vec3 &max) const {
    return call<&c3de_scene_v1::set_bounds>(node, min.data(), max.data());
  }
};

struct Material {
  std::array<float, 4> colour{0.8f, 0.8f, 0.8f, 1.0f};  ///< sRGB and opacity
  bool twoSided = false;
  bool inSlices = false;  ///< lines, labels and spheres are drawn over the slices of an image, too
  [[nodiscard]] c3de_material abi() const noexcept {
    return {
        sizeof(c3de_material), twoSided ? 1u : 0u, {colour[0], colour[1], colour[2], colour[3]}, inSlices ? 1u : 0u};
  }
};

using Proxy = Owned<c3de_render_v1, &c3de_render_v1::destroy>;

/// What colours mean; the colours are borrowed.
struct Legend {
  std::string title, unit, note;
  double low = 0.0, high = 1.0;
  c3de_view colours{};  ///< comps 3 or 4, 2 rows at least, the one of `low` first
  [[nodiscard]] c3de_legend abi() const {
    return {sizeof(c3de_legend), 0, str(title), str(unit), str(note), low, high, colours};
  }
};

class Render : public Service<c3de_render_v1> {
 public:
  using Service::Service;
  Result<Proxy> createMesh(c3de_handle node, c3de_view positions, c3de_view triangles, const Material &material) const {
    const c3de_material m = material.abi();
    return own<&c3de_render_v1::create_mesh, Proxy>(node, positions, triangles, &m);
  }
  Result<Proxy> createSpheres(c3de_handle node, c3de_view centres, double radius, const Material &material) const {
    const c3de_material m = material.abi();
    return own<&c3de_render_v1::create_spheres, Proxy>(node, centres, radius, &m);
  }
  Result<Proxy> createLines(c3de_handle node, c3de_view points, float width_px, const Material &material) const {
    const c3de_material m = material.abi();
    return own<&c3de_render_v1::create_lines, Proxy>(node, points, width_px, &m);
  }
  Result<Proxy> createLabel(c3de_handle node, const Vec3 &at, std::string_view label, const Material &material) const {
    const c3de_material m = material.abi();
    return own<&c3de_render_v1::create_label, Proxy>(node, at.data(), str(label), &m);
  }
  /// @param attribute  C3DE_ATTR_*
  Result<void> update(c3de_handle proxy, std::uint32_t attribute, c3de_view values) const {
    return call<&c3de_render_v1::update>(proxy, attribute, values);
  }
  Result<void> setLabel(c3de_handle proxy, const Vec3 &at, std::string_view label) const {
    return call<&c3de_render_v1::set_label>(proxy, at.data(), str(label));
  }
  Result<void> setMaterial(c3de_handle proxy, const Material &material) const {
    const c3de_material m = material.abi();
    return call<&c3de_render_v1::set_material>(proxy, &m);
  }
  Result<void> setVisible(c3de_handle proxy, bool visible) const {
    return call<&c3de_render_v1::set_visible>(proxy, visible ? 1u : 0u);
  }
  /// False with a host of revision 1: nothing below is called then.
  [[nodiscard]] bool hasLegends() const noexcept { return table_ && table_->rev >= 2; }
  Result<Proxy> createLegend(c3de_handle node, const Legend &legend) const {
    if (!hasLegends()) return noLegends();
    const c3de_legend l = legend.abi();
    return own<&c3de_render_v1::create_legend, Proxy>(node, &l);
  }
  Result<void> setLegend(c3de_handle proxy, const Legend &legend) const {
    if (!hasLegends()) return noLegends();
    const c3de_legend l = legend.abi();
    return call<&c3de_render_v1::set_legend>(proxy, &l);
  }

 private:
  static Failure noLegends() { return {C3DE_E_UNSUPPORTED, "this host has no legends"}; }
};

}  // namespace c3de::sdk
