// SPDX-License-Identifier: Apache-2.0
// Common part of all back ends: stores the proxies and validates calls. A back end only draws the stored proxies.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "c3de/render/renderer.h"

namespace c3de::render {

enum class ProxyKind { mesh, spheres, lines, label, legend };

/// Data of a back end for a proxy (graphics buffers); destroyed with it.
struct BackEndData {
  virtual ~BackEndData() = default;
};

/// Arrays that changed since the back end last read them.
struct StaleArrays {
  bool positions = true, normals = true, colours = true, radii = true;
};

struct Proxy {
  ProxyKind kind = ProxyKind::mesh;
  std::vector<Vec3f> positions;
  std::vector<Triangle> triangles;  ///< meshes
  std::vector<Vec3f> normals;       ///< meshes; see updateNormals()
  std::vector<Colour> colours;      ///< empty: the material's
  std::vector<float> radii;         ///< spheres; empty: `radius`
  float radius = 1.0f;              ///< spheres
  float width_px = 1.0f;            ///< lines
  Legend legend;                    ///< legends; positions is empty
  std::string text;                 ///< labels, UTF-8; positions has one element
  Material material;
  Mat4 transform = kIdentity4;
  bool visible = true;
  bool hasOwnNormals = false;  ///< given by setNormals
  bool normalsCurrent = false;
  bool hasTransparentColour = false;  ///< some element of `colours` has an opacity below 1
  StaleArrays stale;
  std::unique_ptr<BackEndData> backEnd;

  /// Some part of it is transparent.
  [[nodiscard]] bool isTransparent() const { return material.colour[3] < 1.0f || hasTransparentColour; }
  /// No part of it is visible.
  [[nodiscard]] bool isHidden() const {
    return !visible || !(material.colour[3] > 0.0f) || (positions.empty() && kind != ProxyKind::legend);
  }
  /// Computes the normals of a mesh if its positions changed and none were set.
  void updateNormals();
};

class RetainedRenderer : public Renderer {
 public:
  Handle createMesh(std::span<const Vec3f> positions, std::span<const Triangle> triangles,
                    const Material &material) override;
  Handle createSpheres(std::span<const Vec3f> centres, float radius, const Material &material) override;
  Handle createLines(std::span<const Vec3f> pairs, float width_px, const Material &material) override;
  Handle createLabel(const Vec3f &at, std::string_view text, const Material &material) override;
  Handle createLegend(const Legend &legend) override;
  bool setPositions(Handle proxy, std::span<const Vec3f> positions) override;
  bool setNormals(Handle proxy, std::span<const Vec3f> normals) override;
  bool setColours(Handle proxy, std::span<const Colour> colours) override;
  bool setRadii(Handle proxy, std::span<const float> radii) override;
  bool setLabel(Handle proxy, const Vec3f &at, std::string_view text) override;
  bool setLegend(Handle proxy, const Legend &legend) override;
  bool setMaterial(Handle proxy, const Material &material) override;
  bool setTransform(Handle proxy, const Mat4 &worldFromProxy) override;
  bool setVisible(Handle proxy, bool visible) override;
  bool destroy(Handle proxy) override;
  void setBackground(const Background &background) override;
  [[nodiscard]] std::uint64_t changes() const override { return changes_; }
  void forEachMesh(const std::function<void(const MeshView &)> &visit) const override;
  void forEachMark(const std::function<void(const MarkView &)> &visit) const override;

 protected:
  HandleTable<Proxy> proxies_;
  std::uint64_t changes_ = 0;  ///< incremented by every change of a proxy, and of the background
  Background background_;
};

/// The error of drawToImage for an invalid size; `largest` is the limit of the back end.
[[nodiscard]] Expected<void> checkImageSize(int width, int height, int largest);

}  // namespace c3de::render
