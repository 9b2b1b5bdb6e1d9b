// SPDX-License-Identifier: Apache-2.0
#include "simulator/point_sets.h"

#include <cmath>

#include "c3de/sdk/structs.hpp"
#include "fields/field_rows.h"
#include "simulator/body_fields.h"

namespace pointbased {
namespace {

using sdk::Error;

std::vector<Vec3> readPoints(const c3de_view &view, const char *what) {
  const auto rows = sdk::orThrow(sdk::readVec3(view, what));
  std::vector<Vec3> out;
  out.reserve(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    out.emplace_back(rows[i][0], rows[i][1], rows[i][2]);
    if (!out.back().allFinite())
      throw Error(C3DE_E_ARG, std::string(what) + ": row " + std::to_string(i) + " is not finite");
  }
  return out;
}

[[noreturn]] void unknownField(std::uint32_t field) {
  throw Error(C3DE_E_ARG, "field " + std::to_string(field) + " is not one of this set");
}

const char *nameOf(std::uint32_t field) {
  switch (field) {
    case C3DE_FIELD_REFERENCE_POSITION: return C3DE_SIM_FIELD_REFERENCE_POSITION;
    case C3DE_FIELD_POSITION: return C3DE_SIM_FIELD_POSITION;
    case C3DE_FIELD_VELOCITY: return C3DE_SIM_FIELD_VELOCITY;
    case C3DE_FIELD_MASS: return C3DE_SIM_FIELD_MASS;
    case C3DE_FIELD_VOLUME: return C3DE_SIM_FIELD_VOLUME;
    case C3DE_FIELD_GRADIENT: return "deformation_gradient";
    case C3DE_FIELD_STRAIN: return "strain_green";
    case C3DE_FIELD_STRESS: return "stress_pk2";
    default: unknownField(field);
  }
}

c3de_view indexView(const std::vector<Index> &values) { return {values.data(), values.size(), 1, C3DE_U32, 0}; }

constexpr c3de_phyxel_set_v1 kPhyxelSetTable{sizeof(c3de_phyxel_set_v1),
                                             1,
                                             sdk::thunk<PhyxelSet, &PhyxelSet::count>,
                                             sdk::thunk<PhyxelSet, &PhyxelSet::read>,
                                             sdk::thunk<PhyxelSet, &PhyxelSet::neighbours>,
                                             sdk::thunk<PhyxelSet, &PhyxelSet::assign>,
                                             sdk::thunk<PhyxelSet, &PhyxelSet::move>};

constexpr c3de_surfel_set_v1 kSurfelSetTable{sizeof(c3de_surfel_set_v1),
                                             2,
                                             sdk::thunk<SurfelSet, &SurfelSet::count>,
                                             sdk::thunk<SurfelSet, &SurfelSet::read>,
                                             sdk::thunk<SurfelSet, &SurfelSet::owners>,
                                             sdk::thunk<SurfelSet, &SurfelSet::assign>,
                                             sdk::thunk<SurfelSet, &SurfelSet::triangles>};

}  // namespace

PhyxelSet::PhyxelSet(PluginContext &context) : context_(context) {}
PhyxelSet::PhyxelSet(PluginContext &context, sdk::Ref<WorldSimulator> simulator, std::uint64_t body)
    : context_(context), simulator_(std::move(simulator)), body_(body) {}

std::array<sdk::Interface, 1> PhyxelSet::interfaces() { return {sdk::interfaceOf(kPhyxelSetTable)}; }

void PhyxelSet::withBody(const std::function<void(const Body &)> &read) const {
  if (simulator_) {
    if (!simulator_->parts().queries.readBody(body_, read))
      throw Error(C3DE_E_STALE, "the body of this phyxel set was removed");
    return;
  }
  if (!own_) throw Error(C3DE_E_STATE, "the phyxel set is empty; assign() gives it points");
  read(*own_);
}

std::uint64_t PhyxelSet::count() {
  std::uint64_t n = 0;
  if (!simulator_ && !own_) return 0;
  withBody([&](const Body &body) { n = body.rest().phyxelCount(); });
  return n;
}

void PhyxelSet::read(std::uint32_t field, c3de_mview out) {
  withBody([&](const Body &body) { readBodyField(body, C3DE_SIM_ON_POINTS, nameOf(field), out); });
}

void PhyxelSet::neighbours(c3de_view *offsets, c3de_view *indices) {
  withBody([&](const Body &body) {
    if (restOfReturned_ != body.sharedRest()) {
      restOfReturned_ = body.sharedRest();
      returnedNeighbours_ = neighboursOf(*restOfReturned_);
    }
    sdk::notNull(offsets, "offsets") = indexView(returnedNeighbours_.offsets);
    sdk::notNull(indices, "indices") = indexView(returnedNeighbours_.indices);
  });
}

void PhyxelSet::assign(c3de_view positionsView, c3de_view volumesView, double density, std::uint32_t neighbours) {
  if (simulator_) throw Error(C3DE_E_STATE, "the phyxels of a simulator are not assigned; add a body instead");
  PhyxelCloud cloud;
  cloud.positions = readPoints(positionsView, "positions");
  const auto volumes = sdk::orThrow(sdk::asRows<double, 1>(volumesView, "volumes"));
  if (volumes.size() != cloud.positions.size())
    throw Error(C3DE_E_ARG,
                std::to_string(cloud.positions.size()) + " positions, " + std::to_string(volumes.size()) + " volumes");
  if (cloud.positions.empty()) throw Error(C3DE_E_ARG, "no positions");
  if (neighbours < 3 || neighbours > 500)
    throw Error(C3DE_E_ARG, "neighbours = " + std::to_string(neighbours) + " is not accepted; accepted: 3 … 500");
  double total = 0.0;
  for (std::size_t i = 0; i < volumes.size(); ++i) {
    const double v = volumes[i][0];
    if (!std::isfinite(v) || v <= 0.0)
      throw Error(C3DE_E_ARG, "volumes: row " + std::to_string(i) + " is not finite and > 0");
    cloud.volumes.push_back(v);
    cloud.contactRadii.push_back(0.5 * std::cbrt(v));
    total += v;
  }
  cloud.spacing = std::cbrt(total / static_cast<double>(volumes.size()));
  Material material;
  material.restDensity = density;
  if (const auto valid = validate(material); !valid) throw Error(C3DE_E_ARG, valid.error());
  const ParallelFor parallelFor = context_.services.parallelFor();
  auto rest = buildRestState(cloud, {static_cast<int>(neighbours), 1.8}, total, Surface{}, {}, parallelFor);
  own_ = std::make_unique<Body>("phyxels", std::move(rest), Constitution{{material}, kCloudStabilisation}, parallelFor);
}

void PhyxelSet::move(c3de_view view) {
  if (simulator_) throw Error(C3DE_E_STATE, "the phyxels of a simulator move by its steps");
  if (!own_) throw Error(C3DE_E_STATE, "the phyxel set is empty; assign() gives it points");
  const std::vector<Vec3> positions = readPoints(view, "positions");
  const RestState &rest = own_->rest();
  if (positions.size() != rest.phyxelCount())
    throw Error(C3DE_E_ARG,
                std::to_string(positions.size()) + " positions for " + std::to_string(rest.phyxelCount()) + " phyxels");
  for (std::size_t i = 0; i < positions.size(); ++i)
    own_->state().displacements[i] = positions[i] - rest.origin - rest.positions[i];
  own_->computeGradients(context_.services.parallelFor());
}

SurfelSet::SurfelSet(sdk::Ref<WorldSimulator> simulator, std::uint64_t body)
    : simulator_(std::move(simulator)), body_(body) {}

std::array<sdk::Interface, 1> SurfelSet::interfaces() { return {sdk::interfaceOf(kSurfelSetTable)}; }

void SurfelSet::withBody(const std::function<void(const Body &)> &read) const {
  if (simulator_) {
    if (!simulator_->parts().queries.readBody(body_, read))
      throw Error(C3DE_E_STALE, "the body of this surfel set was removed");
    return;
  }
  if (!phyxels_) throw Error(C3DE_E_STATE, "the surfel set is empty; assign() binds points to a phyxel set");
  phyxels_->withBody(read);
}

std::uint64_t SurfelSet::count() {
  if (!simulator_) return own_.count();
  std::uint64_t n = 0;
  withBody([&](const Body &body) { n = body.rest().surfels.count(); });
  return n;
}

void SurfelSet::read(std::uint32_t field, c3de_mview out) {
  if (field != C3DE_FIELD_REFERENCE_POSITION && field != C3DE_FIELD_POSITION && field != C3DE_FIELD_NORMAL)
    unknownField(field);
  withBody([&](const Body &body) {
    if (simulator_)
      return readBodyField(body, C3DE_SIM_ON_SURFACE, field == C3DE_FIELD_NORMAL ? "normal" : nameOf(field), out);
    const RestState &rest = body.rest();
    const std::size_t n = own_.count();
    if (field == C3DE_FIELD_REFERENCE_POSITION)
      return writeVectors(out, n, [&](std::size_t s) -> Vec3 { return rest.origin + own_.positions[s]; });
    std::vector<Vec3> positions(n), normals(ownNormals_.size());
    updateSurfels(own_, ownNormals_, rest.positions, body.state().displacements, positions, normals, serialFor());
    if (field == C3DE_FIELD_POSITION)
      return writeVectors(out, n, [&](std::size_t s) -> Vec3 { return rest.origin + positions[s]; });
    if (normals.size() != n) throw Error(C3DE_E_STATE, "these surfels were bound without normals");
    writeVectors(out, n, [&](std::size_t s) { return normals[s]; });
  });
}

void SurfelSet::owners(c3de_view *offsets, c3de_view *indices, c3de_view *weights) {
  withBody([&](const Body &body) {
    if (simulator_ && restOfReturned_ != body.sharedRest()) {
      restOfReturned_ = body.sharedRest();
      owners_ = restOfReturned_->surfels.expanded(restOfReturned_->positions);
    }
    const Interpolation &kept = simulator_ ? owners_ : own_;
    sdk::notNull(offsets, "offsets") = indexView(kept.phyxels.offsets);
    sdk::notNull(indices, "indices") = indexView(kept.phyxels.indices);
    sdk::notNull(weights, "weights") = {kept.weights.data(), kept.weights.size(), 1, C3DE_F64, 0};
  });
}

void SurfelSet::assign(c3de_object *phyxels, c3de_view positionsView, c3de_view normalsView) {
  if (simulator_) throw Error(C3DE_E_STATE, "the surfels of a simulator are the vertices of its mesh");
  // Only sets of this plugin can be bound: a phyxel set of another binary has its own layout.
  const void *table = nullptr;
  if (!phyxels || phyxels->vt->query(phyxels, sdk::str(C3DE_POINTBASED_PHYXEL_SET_ID), 1, &table) < 0 ||
      table != &kPhyxelSetTable)
    throw Error(C3DE_E_ARG, "phyxels: not a phyxel set of this plugin");
  const std::vector<Vec3> world = readPoints(positionsView, "positions");
  std::vector<Vec3> normals;
  if (normalsView.count > 0) normals = readPoints(normalsView, "normals");
  if (!normals.empty() && normals.size() != world.size())
    throw Error(C3DE_E_ARG,
                std::to_string(world.size()) + " positions, " + std::to_string(normals.size()) + " normals");
  auto set = sdk::Ref<PhyxelSet>::share(PhyxelSet::from(phyxels));
  Interpolation binding;
  set->withBody([&](const Body &body) {
    std::vector<Vec3> local;
    local.reserve(world.size());
    for (const Vec3 &x : world) local.push_back(x - body.rest().origin);
    binding = body.rest().bind(local, normals);
  });
  own_ = std::move(binding);
  ownNormals_ = std::move(normals);
  phyxels_ = std::move(set);
}

void SurfelSet::triangles(c3de_view *out) {
  if (!simulator_) {
    sdk::notNull(out, "out") = {nullptr, 0, 3, C3DE_U32, 0};
    return;
  }
  withBody([&](const Body &body) { restOfTriangles_ = body.sharedRest(); });
  static_assert(sizeof(restOfTriangles_->skin[0]) == 3 * sizeof(std::uint32_t));
  sdk::notNull(out, "out") = {restOfTriangles_->skin.data(), restOfTriangles_->skin.size(), 3, C3DE_U32, 0};
}

}  // namespace pointbased
