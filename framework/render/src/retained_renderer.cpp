// SPDX-License-Identifier: Apache-2.0
#include "retained_renderer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mesh_normals.h"

namespace c3de::render {
namespace {

Proxy makeProxy(ProxyKind kind, std::span<const Vec3f> positions, const Material &material) {
  Proxy proxy;
  proxy.kind = kind;
  proxy.positions.assign(positions.begin(), positions.end());
  proxy.material = material;
  return proxy;
}

bool isUsable(const Legend &legend) {
  return legend.colours.size() >= 2 && std::isfinite(legend.low) && std::isfinite(legend.high) &&
         legend.low < legend.high;
}

bool hasNoArrays(const Proxy &proxy) { return proxy.kind == ProxyKind::label || proxy.kind == ProxyKind::legend; }

bool isPositive(float value) { return std::isfinite(value) && value > 0.0f; }

}  // namespace

void Proxy::updateNormals() {
  if (hasOwnNormals || normalsCurrent) return;
  computeVertexNormals(positions, triangles, normals);
  normalsCurrent = true;
  stale.normals = true;
}

Handle RetainedRenderer::createMesh(std::span<const Vec3f> positions, std::span<const Triangle> triangles,
                                    const Material &material) {
  for (const Triangle &t : triangles)
    if (std::max({t[0], t[1], t[2]}) >= positions.size()) return {};
  Proxy proxy = makeProxy(ProxyKind::mesh, positions, material);
  proxy.triangles.assign(triangles.begin(), triangles.end());
  ++changes_;
  return proxies_.add(std::move(proxy));
}

Handle RetainedRenderer::createSpheres(std::span<const Vec3f> centres, float radius, const Material &material) {
  if (!isPositive(radius)) return {};
  Proxy proxy = makeProxy(ProxyKind::spheres, centres, material);
  proxy.radius = radius;
  ++changes_;
  return proxies_.add(std::move(proxy));
}

Handle RetainedRenderer::createLines(std::span<const Vec3f> pairs, float width_px, const Material &material) {
  if (!isPositive(width_px) || pairs.size() % 2 != 0) return {};
  Proxy proxy = makeProxy(ProxyKind::lines, pairs, material);
  proxy.width_px = width_px;
  ++changes_;
  return proxies_.add(std::move(proxy));
}

Handle RetainedRenderer::createLabel(const Vec3f &at, std::string_view text, const Material &material) {
  Proxy proxy = makeProxy(ProxyKind::label, {&at, 1}, material);
  proxy.text = text;
  ++changes_;
  return proxies_.add(std::move(proxy));
}

Handle RetainedRenderer::createLegend(const Legend &legend) {
  if (!isUsable(legend)) return {};
  Proxy proxy = makeProxy(ProxyKind::legend, {}, {});
  proxy.legend = legend;
  ++changes_;
  return proxies_.add(std::move(proxy));
}

bool RetainedRenderer::setPositions(Handle handle, std::span<const Vec3f> positions) {
  Proxy *proxy = proxies_.find(handle);
  if (!proxy || hasNoArrays(*proxy)) return false;
  const bool sameCount = positions.size() == proxy->positions.size();
  if (proxy->kind == ProxyKind::mesh && !sameCount) return false;
  if (proxy->kind == ProxyKind::lines && positions.size() % 2 != 0) return false;
  proxy->positions.assign(positions.begin(), positions.end());
  proxy->normalsCurrent = false;
  proxy->stale.positions = true;
  if (!sameCount) {
    // Colours and radii belong to the previous points.
    proxy->colours.clear();
    proxy->radii.clear();
    proxy->hasTransparentColour = false;
    proxy->stale.colours = proxy->stale.radii = true;
  }
  ++changes_;
  return true;
}

bool RetainedRenderer::setNormals(Handle handle, std::span<const Vec3f> normals) {
  Proxy *proxy = proxies_.find(handle);
  if (!proxy || proxy->kind != ProxyKind::mesh) return false;
  if (!normals.empty() && normals.size() != proxy->positions.size()) return false;
  proxy->normals.assign(normals.begin(), normals.end());
  proxy->hasOwnNormals = !normals.empty();
  proxy->normalsCurrent = false;
  proxy->stale.normals = true;
  ++changes_;
  return true;
}

bool RetainedRenderer::setColours(Handle handle, std::span<const Colour> colours) {
  Proxy *proxy = proxies_.find(handle);
  if (!proxy || hasNoArrays(*proxy)) return false;
  if (!colours.empty() && colours.size() != proxy->positions.size()) return false;
  proxy->colours.assign(colours.begin(), colours.end());
  proxy->hasTransparentColour =
      std::any_of(colours.begin(), colours.end(), [](const Colour &c) { return c[3] < 1.0f; });
  proxy->stale.colours = true;
  ++changes_;
  return true;
}

bool RetainedRenderer::setRadii(Handle handle, std::span<const float> radii) {
  Proxy *proxy = proxies_.find(handle);
  if (!proxy || proxy->kind != ProxyKind::spheres) return false;
  if (!radii.empty() && radii.size() != proxy->positions.size()) return false;
  proxy->radii.assign(radii.begin(), radii.end());
  proxy->stale.radii = true;
  ++changes_;
  return true;
}

bool RetainedRenderer::setLabel(Handle handle, const Vec3f &at, std::string_view text) {
  Proxy *proxy = proxies_.find(handle);
  if (!proxy || proxy->kind != ProxyKind::label) return false;
  proxy->positions.assign(1, at);
  proxy->text = text;
  ++changes_;
  return true;
}

bool RetainedRenderer::setLegend(Handle handle, const Legend &legend) {
  Proxy *proxy = proxies_.find(handle);
  if (!proxy || proxy->kind != ProxyKind::legend || !isUsable(legend)) return false;
  proxy->legend = legend;
  ++changes_;
  return true;
}

bool RetainedRenderer::setMaterial(Handle handle, const Material &material) {
  Proxy *proxy = proxies_.find(handle);
  if (!proxy) return false;
  proxy->material = material;
  ++changes_;
  return true;
}

bool RetainedRenderer::setTransform(Handle handle, const Mat4 &worldFromProxy) {
  Proxy *proxy = proxies_.find(handle);
  if (!proxy) return false;
  // Hosts set it every frame: only an actual change counts.
  if (proxy->transform != worldFromProxy) ++changes_;
  proxy->transform = worldFromProxy;
  return true;
}

bool RetainedRenderer::setVisible(Handle handle, bool visible) {
  Proxy *proxy = proxies_.find(handle);
  if (!proxy) return false;
  if (proxy->visible != visible) ++changes_;
  proxy->visible = visible;
  return true;
}

bool RetainedRenderer::destroy(Handle handle) {
  ++changes_;
  return proxies_.remove(handle);
}

void RetainedRenderer::setBackground(const Background &background) {
  background_ = background;
  ++changes_;
}

void RetainedRenderer::forEachMesh(const std::function<void(const MeshView &)> &visit) const {
  proxies_.forEach([&](Handle, const Proxy &proxy) {
    if (proxy.kind == ProxyKind::mesh && !proxy.isHidden())
      visit({proxy.positions, proxy.triangles, proxy.transform, proxy.material});
  });
}

void RetainedRenderer::forEachMark(const std::function<void(const MarkView &)> &visit) const {
  proxies_.forEach([&](Handle, const Proxy &proxy) {
    if (!proxy.material.inSlices || proxy.isHidden()) return;
    const auto show = [&](MarkView::Kind kind) {
      visit({kind, proxy.positions, proxy.radius, proxy.width_px, proxy.text, proxy.transform, proxy.material});
    };
    switch (proxy.kind) {
      case ProxyKind::spheres: return show(MarkView::Kind::spheres);
      case ProxyKind::lines: return show(MarkView::Kind::lines);
      case ProxyKind::label: return show(MarkView::Kind::label);
      case ProxyKind::mesh:
      case ProxyKind::legend: return;
    }
  });
}

Expected<void> checkImageSize(int width, int height, int largest) {
  if (width >= 1 && height >= 1 && width <= largest && height <= largest) return {};
  return fail(ErrorCode::usage,
              fmt::format("cannot draw an image of {} x {} pixels; each side must be 1 to {}", width, height, largest));
}

}  // namespace c3de::render
