// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pointbased/body.h"
#include "simulator/world_simulator.h"

namespace pointbased {

/// The registered class c3de.pointbased.Phyxel/1: the phyxels of a body or, when created on its own, a separate point
/// cloud.
class PhyxelSet : public sdk::Object<PhyxelSet> {
 public:
  explicit PhyxelSet(PluginContext &context);
  PhyxelSet(PluginContext &context, sdk::Ref<WorldSimulator> simulator, std::uint64_t body);

  // iface.phyxel_set
  std::uint64_t count();
  void read(std::uint32_t field, c3de_mview out);
  void neighbours(c3de_view *offsets, c3de_view *indices);
  void assign(c3de_view positions, c3de_view volumes, double density, std::uint32_t neighbours);
  void move(c3de_view positions);

  /// Calls the function with the body, own or of the simulator. Throws sdk::Error if there is none.
  void withBody(const std::function<void(const Body &)> &read) const;

  static std::array<sdk::Interface, 1> interfaces();

 private:
  PluginContext &context_;
  sdk::Ref<WorldSimulator> simulator_;
  std::uint64_t body_ = 0;
  std::unique_ptr<Body> own_;
  std::shared_ptr<const RestState> restOfReturned_;  // rest state of the neighbours last returned
  Csr returnedNeighbours_;
};

/// The registered class C3DE_POINTBASED_SURFEL_CLASS: the surface of a body, or points bound to a phyxel set.
class SurfelSet : public sdk::Object<SurfelSet> {
 public:
  explicit SurfelSet(PluginContext &) {}
  SurfelSet(sdk::Ref<WorldSimulator> simulator, std::uint64_t body);

  // iface.surfel_set
  std::uint64_t count();
  void read(std::uint32_t field, c3de_mview out);
  void owners(c3de_view *offsets, c3de_view *indices, c3de_view *weights);
  void assign(c3de_object *phyxels, c3de_view positions, c3de_view normals);
  void triangles(c3de_view *out);

  static std::array<sdk::Interface, 1> interfaces();

 private:
  void withBody(const std::function<void(const Body &)> &read) const;

  sdk::Ref<WorldSimulator> simulator_;
  std::uint64_t body_ = 0;
  sdk::Ref<PhyxelSet> phyxels_;
  Interpolation own_;
  std::vector<Vec3> ownNormals_;
  std::shared_ptr<const RestState> restOfReturned_;  // rest state of the owners() last returned
  Interpolation owners_;
  std::shared_ptr<const RestState> restOfTriangles_;  // rest state of the triangles() last returned
};

}  // namespace pointbased
