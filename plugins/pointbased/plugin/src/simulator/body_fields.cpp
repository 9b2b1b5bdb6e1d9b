// SPDX-License-Identifier: Apache-2.0
#include "simulator/body_fields.h"

#include <algorithm>
#include <array>
#include <string>

#include "c3de/sdk/text.hpp"
#include "fields/field_rows.h"
#include "pointbased/fields.h"

namespace pointbased {
namespace {

constexpr c3de_sim_field field(std::uint32_t on, std::string_view name, std::string_view unit, std::uint32_t comps) {
  return {sizeof(c3de_sim_field), on, sdk::str(name), sdk::str(unit), comps, 0};
}

constexpr std::array kFields{field(C3DE_SIM_ON_POINTS, C3DE_SIM_FIELD_REFERENCE_POSITION, "m", 3),
                             field(C3DE_SIM_ON_POINTS, C3DE_SIM_FIELD_POSITION, "m", 3),
                             field(C3DE_SIM_ON_POINTS, C3DE_SIM_FIELD_VELOCITY, "m/s", 3),
                             field(C3DE_SIM_ON_POINTS, C3DE_SIM_FIELD_MASS, "kg", 1),
                             field(C3DE_SIM_ON_POINTS, C3DE_SIM_FIELD_VOLUME, "m^3", 1),
                             field(C3DE_SIM_ON_POINTS, "deformation_gradient", "1", 9),
                             field(C3DE_SIM_ON_POINTS, "strain_green", "1", 9),
                             field(C3DE_SIM_ON_POINTS, "stress_pk2", "Pa", 9),
                             field(C3DE_SIM_ON_POINTS, C3DE_SIM_FIELD_EQUIVALENT_STRESS, "Pa", 1),
                             field(C3DE_SIM_ON_SURFACE, C3DE_SIM_FIELD_REFERENCE_POSITION, "m", 3),
                             field(C3DE_SIM_ON_SURFACE, C3DE_SIM_FIELD_POSITION, "m", 3),
                             field(C3DE_SIM_ON_SURFACE, "normal", "1", 3)};

constexpr std::array kContactFields{field(C3DE_SIM_ON_POINTS, "contact_pressure", "Pa", 1),
                                    field(C3DE_SIM_ON_SURFACE, "contact_pressure", "Pa", 1)};

std::vector<Mat3> gradientsOf(const Body &body) {
  std::vector<Mat3> gradients(body.rest().phyxelCount());
  phyxelGradients(body.rest(), body.gradients(), gradients);
  return gradients;
}

std::vector<Mat3> stressesOf(const Body &body) {
  StressScratch scratch;
  std::vector<Mat3> points(body.rest().pointCount()), means(body.rest().phyxelCount());
  secondPiolaStresses(body, points, scratch, serialFor());
  phyxelMeans(body.rest(), points, means);
  return means;
}

double vonMisesOf(const Mat3 &F, const Mat3 &S) {
  const double J = F.determinant();
  return J > 0.0 ? vonMises(F * S * F.transpose() / J) : 0.0;
}

void readOfPhyxels(const Body &body, std::string_view name, const c3de_mview &out) {
  const RestState &rest = body.rest();
  const std::size_t n = rest.phyxelCount();
  if (name == C3DE_SIM_FIELD_REFERENCE_POSITION)
    return writeVectors(out, n, [&](std::size_t i) -> Vec3 { return rest.origin + rest.positions[i]; });
  if (name == C3DE_SIM_FIELD_POSITION)
    return writeVectors(
        out, n, [&](std::size_t i) -> Vec3 { return rest.origin + rest.positions[i] + body.state().displacements[i]; });
  if (name == C3DE_SIM_FIELD_VELOCITY)
    return writeVectors(out, n, [&](std::size_t i) { return body.state().velocities[i]; });
  if (name == C3DE_SIM_FIELD_MASS) {  // including the part carried by supports
    const std::span<const double> carried = body.supportMasses();
    return writeScalars(out, n,
                        [&](std::size_t i) { return body.restMasses()[i] + (carried.empty() ? 0.0 : carried[i]); });
  }
  if (name == C3DE_SIM_FIELD_VOLUME) return writeScalars(out, n, [&](std::size_t i) { return rest.volumes[i]; });
  if (name == "stress_pk2") {
    const std::vector<Mat3> stresses = stressesOf(body);
    return writeMatrices(out, n, [&](std::size_t i) { return stresses[i]; });
  }
  const std::vector<Mat3> gradients = gradientsOf(body);
  if (name == "deformation_gradient") return writeMatrices(out, n, [&](std::size_t i) { return gradients[i]; });
  if (name == "strain_green")
    return writeMatrices(out, n, [&](std::size_t i) -> Mat3 { return greenStrain(gradients[i]); });
  const std::vector<Mat3> stresses = stressesOf(body);
  writeScalars(out, n, [&](std::size_t i) { return vonMisesOf(gradients[i], stresses[i]); });
}

void readOfSurfels(const Body &body, std::string_view name, const c3de_mview &out) {
  const RestState &rest = body.rest();
  const std::size_t n = rest.surfels.count();
  if (name == C3DE_SIM_FIELD_REFERENCE_POSITION)
    return writeVectors(out, n,
                        [&](std::size_t s) -> Vec3 { return rest.origin + rest.surfels.position(s, rest.positions); });
  std::vector<Vec3> positions(n), normals(rest.surfelNormals.size());
  updateSurfels(rest.surfels, rest.surfelNormals, rest.positions, body.state().displacements, positions, normals,
                serialFor());
  body.placeHeldSurfels(positions, normals);
  if (name == C3DE_SIM_FIELD_POSITION)
    return writeVectors(out, n, [&](std::size_t s) -> Vec3 { return rest.origin + positions[s]; });
  if (normals.size() != n) throw sdk::Error(C3DE_E_STATE, "these surfels have no normals");
  writeVectors(out, n, [&](std::size_t s) { return normals[s]; });
}

}  // namespace

std::span<const c3de_sim_field> bodyFields() { return kFields; }

std::span<const c3de_sim_field> contactFields() { return kContactFields; }

bool isContactField(std::uint32_t on, std::string_view name) {
  return std::any_of(kContactFields.begin(), kContactFields.end(),
                     [&](const c3de_sim_field &one) { return one.on == on && sdk::text(one.name) == name; });
}

void writeContactPressures(const Body &body, std::uint32_t on, const std::vector<double> &pressures,
                           const ParallelFor &parallelFor, const c3de_mview &out) {
  if (on == C3DE_SIM_ON_POINTS) return writeScalars(out, pressures.size(), [&](std::size_t i) { return pressures[i]; });
  std::vector<double> onSurface(body.rest().surfels.count());
  interpolateScalars(body.rest().surfels, pressures, onSurface, parallelFor);
  writeScalars(out, onSurface.size(), [&](std::size_t i) { return onSurface[i]; });
}

void readBodyField(const Body &body, std::uint32_t on, std::string_view name, const c3de_mview &out) {
  std::string known;
  for (const c3de_sim_field &one : kFields) {
    if (one.on != on) continue;
    if (sdk::text(one.name) == name) return (on == C3DE_SIM_ON_POINTS ? readOfPhyxels : readOfSurfels)(body, name, out);
    known += (known.empty() ? "" : ", ") + std::string(sdk::text(one.name));
  }
  if (known.empty())
    throw sdk::Error(C3DE_E_ARG, "on is " + std::to_string(on) + "; accepted: 1 (points), 2 (surface)");
  throw sdk::Error(C3DE_E_NOT_FOUND, "there is no field '" + std::string(name) + "'; there are: " + known);
}

}  // namespace pointbased
