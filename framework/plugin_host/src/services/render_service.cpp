// SPDX-License-Identifier: Apache-2.0
#include "c3de/render/renderer.h"

#include <fmt/format.h>

#include <cmath>

#include "arguments.h"
#include "c3de/scene/scene_graph.h"
#include "services/services.h"

namespace c3de::plugin_host {
namespace {

render::Renderer &renderer(PluginContext &plugin) { return *plugin.services().renderer; }

SceneProxy &find(PluginContext &plugin, c3de_handle proxy) {
  SceneProxy *found = plugin.host().proxies.find(handleOf(proxy));
  if (!found)
    throw Refusal(C3DE_E_STALE,
                  fmt::format("there is no proxy of handle {}; its node may have been removed", textOf(proxy)));
  if (found->owner != plugin.id())
    throw Refusal(C3DE_E_STATE,
                  fmt::format("the proxy of handle {} belongs to plugin {}", textOf(proxy), found->owner));
  return *found;
}

render::Material materialOf(const c3de_material *material) {
  const c3de_material in = structOf(material, "material");
  render::Material out;
  for (std::size_t k = 0; k < 4; ++k) {
    if (!(in.colour[k] >= 0.0f && in.colour[k] <= 1.0f))
      throw Refusal(C3DE_E_ARG, fmt::format("material colour[{}] is {}, accepted: 0 to 1", k, in.colour[k]));
    out.colour[k] = in.colour[k];
  }
  out.twoSided = in.two_sided != 0;
  out.inSlices = in.in_slices != 0;
  return out;
}

Vec3f labelPointOf(const double *at3) {
  const Vec3 at = pointOf(at3, "at3");
  return {static_cast<float>(at[0]), static_cast<float>(at[1]), static_cast<float>(at[2])};
}

void requireNode(PluginContext &plugin, c3de_handle node) {
  if (!plugin.services().sceneGraph->find(handleOf(node)))
    throw Refusal(C3DE_E_STALE, fmt::format("there is no scene node of handle {}", textOf(node)));
}

void keep(PluginContext &plugin, c3de_handle node, Handle drawn, ProxyKind kind, std::size_t count,
          const render::Material &material, c3de_handle *out) {
  if (drawn.isNull()) throw Refusal(C3DE_E_GPU, "the renderer could not make the proxy");
  writeHandle(out,
              plugin.host().proxies.add({plugin.id(), handleOf(node), drawn, kind, count, material.colour[3], true}));
}

c3de_status C3DE_CALL createMesh(void *ctx, c3de_handle node, c3de_view positions, c3de_view triangles,
                                 const c3de_material *material, c3de_handle *out) noexcept {
  return serveOnMain(ctx, "render.create_mesh", [&](PluginContext &plugin) {
    requireNonNull(out, "out")->v = 0;
    requireNode(plugin, node);
    const auto points = floatPositionsOf(positions, "positions");
    const auto corners = trianglesOf(triangles, "triangles", points.size());
    const render::Material look = materialOf(material);
    keep(plugin, node, renderer(plugin).createMesh(points, corners, look), ProxyKind::mesh, points.size(), look, out);
  });
}

c3de_status C3DE_CALL createSpheres(void *ctx, c3de_handle node, c3de_view centres, double radius,
                                    const c3de_material *material, c3de_handle *out) noexcept {
  return serveOnMain(ctx, "render.create_spheres", [&](PluginContext &plugin) {
    requireNonNull(out, "out")->v = 0;
    requireNode(plugin, node);
    const auto points = floatPositionsOf(centres, "centres");
    const auto r = static_cast<float>(finiteOf(radius, "radius"));
    if (!(r > 0.0f)) throw Refusal(C3DE_E_ARG, fmt::format("radius is {}, accepted: above 0", radius));
    const render::Material look = materialOf(material);
    keep(plugin, node, renderer(plugin).createSpheres(points, r, look), ProxyKind::spheres, points.size(), look, out);
  });
}

void requirePairs(std::size_t count) {
  if (count % 2 != 0)
    throw Refusal(C3DE_E_ARG, fmt::format("points: {} rows, accepted: an even number (pairs)", count));
}

c3de_status C3DE_CALL createLines(void *ctx, c3de_handle node, c3de_view points, float width_px,
                                  const c3de_material *material, c3de_handle *out) noexcept {
  return serveOnMain(ctx, "render.create_lines", [&](PluginContext &plugin) {
    requireNonNull(out, "out")->v = 0;
    requireNode(plugin, node);
    const auto pairs = floatPositionsOf(points, "points");
    requirePairs(pairs.size());
    if (!(width_px > 0.0f) || !std::isfinite(width_px))
      throw Refusal(C3DE_E_ARG, fmt::format("width_px is {}, accepted: above 0", width_px));
    const render::Material look = materialOf(material);
    keep(plugin, node, renderer(plugin).createLines(pairs, width_px, look), ProxyKind::lines, pairs.size(), look, out);
  });
}

c3de_status C3DE_CALL createLabel(void *ctx, c3de_handle node, const double *at3, c3de_str text,
                                  const c3de_material *material, c3de_handle *out) noexcept {
  return serveOnMain(ctx, "render.create_label", [&](PluginContext &plugin) {
    requireNonNull(out, "out")->v = 0;
    requireNode(plugin, node);
    const Vec3f at = labelPointOf(at3);
    const std::string label = labelOf(text, "text", Lines::many);
    const render::Material look = materialOf(material);
    keep(plugin, node, renderer(plugin).createLabel(at, label, look), ProxyKind::label, 1, look, out);
  });
}

std::vector<render::Colour> coloursOf(const c3de_view &view, float opacity) {
  if (view.comps != 3 && view.comps != 4)
    throw Refusal(C3DE_E_ARG, fmt::format("colours: comps {}, accepted: 3 or 4", view.comps));
  const RowLayout rows = layoutOf(view, "colours", view.comps, {C3DE_F32, C3DE_U8});
  std::vector<render::Colour> out(rows.count);
  for (std::size_t i = 0; i < rows.count; ++i) {
    const unsigned char *row = rows.data + i * rows.stride;
    render::Colour colour{0, 0, 0, opacity};
    for (std::uint32_t k = 0; k < view.comps; ++k) {
      if (view.dtype == C3DE_U8)
        colour[k] = static_cast<float>(row[k]) / 255.0f;
      else
        std::memcpy(&colour[k], row + k * sizeof(float), sizeof(float));
      if (!(colour[k] >= 0.0f && colour[k] <= 1.0f))
        throw Refusal(C3DE_E_ARG, fmt::format("colours: row {} has {}, accepted: 0 to 1", i, colour[k]));
    }
    out[i] = colour;
  }
  return out;
}

constexpr std::size_t kMaxLegendColours = 1024;

render::Legend legendOf(const c3de_legend *legend) {
  const c3de_legend in = structOf(legend, "legend");
  render::Legend out;
  out.title = labelOf(in.title, "title");
  out.unit = labelOf(in.unit, "unit");
  out.note = labelOf(in.note, "note", Lines::many);
  out.low = finiteOf(in.low, "low");
  out.high = finiteOf(in.high, "high");
  if (!(out.low < out.high))
    throw Refusal(C3DE_E_ARG, fmt::format("low is {}, high is {}, accepted: low below high", out.low, out.high));
  if (in.colours.count < 2 || in.colours.count > kMaxLegendColours)
    throw Refusal(C3DE_E_ARG, fmt::format("colours: {} rows, accepted: 2 to {}", in.colours.count, kMaxLegendColours));
  out.colours = coloursOf(in.colours, 1.0f);
  return out;
}

c3de_status C3DE_CALL createLegend(void *ctx, c3de_handle node, const c3de_legend *legend, c3de_handle *out) noexcept {
  return serveOnMain(ctx, "render.create_legend", [&](PluginContext &plugin) {
    requireNonNull(out, "out")->v = 0;
    requireNode(plugin, node);
    const render::Legend made = legendOf(legend);
    keep(plugin, node, renderer(plugin).createLegend(made), ProxyKind::legend, 0, {}, out);
  });
}

c3de_status C3DE_CALL setLegend(void *ctx, c3de_handle proxy, const c3de_legend *legend) noexcept {
  return serveOnMain(ctx, "render.set_legend", [&](PluginContext &plugin) {
    const SceneProxy &p = find(plugin, proxy);
    if (p.kind != ProxyKind::legend) throw Refusal(C3DE_E_ARG, "the proxy is not a legend");
    renderer(plugin).setLegend(p.drawn, legendOf(legend));
  });
}

void requireCount(const char *name, std::size_t count, std::size_t wanted) {
  if (count != wanted)
    throw Refusal(C3DE_E_ARG, fmt::format("{}: {} rows, the proxy has {} points", name, count, wanted));
}

c3de_status C3DE_CALL update(void *ctx, c3de_handle proxy, std::uint32_t attribute, c3de_view values) noexcept {
  return serveOnMain(ctx, "render.update", [&](PluginContext &plugin) {
    SceneProxy &p = find(plugin, proxy);
    if (p.kind == ProxyKind::label) throw Refusal(C3DE_E_ARG, "the proxy is a label, which has set_label only");
    if (p.kind == ProxyKind::legend) throw Refusal(C3DE_E_ARG, "the proxy is a legend, which has set_legend only");
    bool done = false;
    switch (attribute) {
      case C3DE_ATTR_POSITIONS: {
        const auto points = floatPositionsOf(values, "positions");
        if (p.kind == ProxyKind::mesh) requireCount("positions", points.size(), p.count);
        if (p.kind == ProxyKind::lines) requirePairs(points.size());
        done = renderer(plugin).setPositions(p.drawn, points);
        if (done) p.count = points.size();
        break;
      }
      case C3DE_ATTR_NORMALS: {
        if (p.kind != ProxyKind::mesh) throw Refusal(C3DE_E_ARG, "normals are for meshes only");
        const auto normals = floatPositionsOf(values, "normals");
        requireCount("normals", normals.size(), p.count);
        done = renderer(plugin).setNormals(p.drawn, normals);
        break;
      }
      case C3DE_ATTR_COLOURS: {
        if (values.count == 0) {
          done = renderer(plugin).setColours(p.drawn, {});
          break;
        }
        const auto colours = coloursOf(values, p.opacity);
        requireCount("colours", colours.size(), p.count);
        done = renderer(plugin).setColours(p.drawn, colours);
        break;
      }
      case C3DE_ATTR_RADII: {
        if (p.kind != ProxyKind::spheres) throw Refusal(C3DE_E_ARG, "radii are for spheres only");
        const auto numbers = numbersOf(values, "radii");
        requireCount("radii", numbers.size(), p.count);
        std::vector<float> radii;
        radii.reserve(numbers.size());
        for (const double r : numbers) {
          if (!(r >= 0.0) || !std::isfinite(static_cast<float>(r)))
            throw Refusal(C3DE_E_ARG, fmt::format("radii: row {} is {}, accepted: 0 or above", radii.size(), r));
          radii.push_back(static_cast<float>(r));
        }
        done = renderer(plugin).setRadii(p.drawn, radii);
        break;
      }
      default:
        throw Refusal(
            C3DE_E_ARG,
            fmt::format("attribute is {}, accepted: 1 (positions), 2 (normals), 3 (colours), 4 (radii)", attribute));
    }
    if (!done) throw Refusal(C3DE_E_GPU, "the renderer did not take the values");
  });
}

c3de_status C3DE_CALL setLabel(void *ctx, c3de_handle proxy, const double *at3, c3de_str text) noexcept {
  return serveOnMain(ctx, "render.set_label", [&](PluginContext &plugin) {
    const SceneProxy &p = find(plugin, proxy);
    if (p.kind != ProxyKind::label) throw Refusal(C3DE_E_ARG, "the proxy is not a label");
    renderer(plugin).setLabel(p.drawn, labelPointOf(at3), labelOf(text, "text", Lines::many));
  });
}

c3de_status C3DE_CALL setMaterial(void *ctx, c3de_handle proxy, const c3de_material *material) noexcept {
  return serveOnMain(ctx, "render.set_material", [&](PluginContext &plugin) {
    SceneProxy &p = find(plugin, proxy);
    const render::Material look = materialOf(material);
    renderer(plugin).setMaterial(p.drawn, look);
    p.opacity = look.colour[3];
  });
}

c3de_status C3DE_CALL setVisible(void *ctx, c3de_handle proxy, std::uint32_t visible) noexcept {
  return serveOnMain(ctx, "render.set_visible", [&](PluginContext &plugin) {
    SceneProxy &p = find(plugin, proxy);
    p.visible = visible != 0;
    renderer(plugin).setVisible(p.drawn, p.visible && plugin.services().sceneGraph->isVisible(p.node));
  });
}

c3de_status C3DE_CALL destroy(void *ctx, c3de_handle proxy) noexcept {
  return serveOnMain(ctx, "render.destroy", [&](PluginContext &plugin) {
    (void)find(plugin, proxy);
    plugin.host().proxies.remove(handleOf(proxy));
  });
}

}  // namespace

c3de_render_v1 makeRenderTable(PluginContext *plugin) {
  return {sizeof(c3de_render_v1), kRenderRevision, plugin,    &createMesh,  &createSpheres, &createLines,
          &createLabel,           &update,         &setLabel, &setMaterial, &setVisible,    &destroy,
          &createLegend,          &setLegend};
}

}  // namespace c3de::plugin_host
