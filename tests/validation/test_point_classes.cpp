// SPDX-License-Identifier: Apache-2.0
// The classes Phyxel and Surfel as another plugin uses them: created by id, queried for their interface, filled with a
// cloud.
#include <array>
#include <cmath>
#include <cstring>

#include "c3de/geometry/mesh_io.h"
#include "simulator_session.h"
#include "support/catch.h"

using namespace c3de;
using test::SimulatorSession;

namespace {

constexpr const char *kPhyxelClass = C3DE_POINTBASED_PHYXEL_CLASS;
constexpr const char *kSurfelClass = C3DE_POINTBASED_SURFEL_CLASS;

template <class Table>
const Table *query(c3de_object *object, const char *id) {
  const void *table = nullptr;
  REQUIRE(object->vt->query(object, {id, std::strlen(id)}, 1, &table) == C3DE_OK);
  return static_cast<const Table *>(table);
}

c3de_view view(const std::vector<Vec3> &values) { return {values.data(), values.size(), 3, C3DE_F64, sizeof(Vec3)}; }
c3de_view view(const std::vector<double> &values) { return {values.data(), values.size(), 1, C3DE_F64, 0}; }
c3de_mview room(std::vector<Vec3> &values) { return {values.data(), values.size(), 3, C3DE_F64, sizeof(Vec3)}; }

std::vector<Vec3> lattice() {
  std::vector<Vec3> points;
  for (int z = 0; z < 4; ++z)
    for (int y = 0; y < 4; ++y)
      for (int x = 0; x < 4; ++x) points.push_back({0.01 * x, 0.01 * y, 0.01 * z});
  return points;
}

/// x' = A x + b, with A row by row.
constexpr std::array<double, 9> kA{1.2, 0.1, 0.0, 0.0, 0.9, 0.2, 0.05, 0.0, 1.1};
Vec3 moved(const Vec3 &x) {
  return {kA[0] * x[0] + kA[1] * x[1] + kA[2] * x[2] + 0.5, kA[3] * x[0] + kA[4] * x[1] + kA[5] * x[2],
          kA[6] * x[0] + kA[7] * x[1] + kA[8] * x[2]};
}

}  // namespace

TEST_CASE("a phyxel set of one's own answers masses, neighbours and the gradient of a motion") {
  SimulatorSession session(2);
  c3de_object *object = session.create(kPhyxelClass);
  const auto *set = query<c3de_phyxel_set_v1>(object, C3DE_POINTBASED_PHYXEL_SET_ID);
  CHECK(set->count(object) == 0);
  std::vector<Vec3> points = lattice();
  CHECK(set->read(object, C3DE_FIELD_POSITION, room(points)) == C3DE_E_STATE);

  const std::vector<double> volumes(points.size(), 1e-6);
  REQUIRE(set->assign(object, view(points), view(volumes), 1000.0, 26) == C3DE_OK);
  REQUIRE(set->count(object) == points.size());
  std::vector<double> masses(points.size());
  REQUIRE(set->read(object, C3DE_FIELD_MASS, {masses.data(), masses.size(), 1, C3DE_F64, 0}) == C3DE_OK);
  for (const double m : masses) CHECK_THAT(m, WithinRel(1e-3, 1e-12));

  c3de_view offsets{}, indices{};
  REQUIRE(set->neighbours(object, &offsets, &indices) == C3DE_OK);
  REQUIRE(offsets.count == points.size() + 1);
  CHECK(static_cast<const std::uint32_t *>(offsets.data)[points.size()] == indices.count);

  std::vector<Vec3> now;
  for (const Vec3 &x : points) now.push_back(moved(x));
  REQUIRE(set->move(object, view(now)) == C3DE_OK);
  std::vector<std::array<double, 9>> gradients(points.size());
  REQUIRE(set->read(object, C3DE_FIELD_GRADIENT, {gradients.data(), gradients.size(), 9, C3DE_F64, 0}) == C3DE_OK);
  for (const auto &F : gradients)
    for (std::size_t row = 0; row < 3; ++row)
      for (std::size_t column = 0; column < 3; ++column)
        CHECK_THAT(F[3 * column + row], WithinAbs(kA[3 * row + column], 1e-10));  // column-major
  CHECK(object->vt->release(object) == 0);
}

TEST_CASE("a phyxel set refuses what makes no cloud and keeps the one it has") {
  SimulatorSession session(1);
  c3de_object *object = session.create(kPhyxelClass);
  const auto *set = query<c3de_phyxel_set_v1>(object, C3DE_POINTBASED_PHYXEL_SET_ID);
  std::vector<Vec3> points = lattice();
  std::vector<double> volumes(points.size(), 1e-6);
  REQUIRE(set->assign(object, view(points), view(volumes), 1000.0, 26) == C3DE_OK);
  CHECK(set->assign(object, view(points), view(volumes), 1000.0, 2) == C3DE_E_ARG);
  CHECK(set->assign(object, view(points), view(volumes), -1.0, 26) == C3DE_E_ARG);
  volumes[3] = 0.0;
  CHECK(set->assign(object, view(points), view(volumes), 1000.0, 26) == C3DE_E_ARG);
  volumes.pop_back();
  CHECK(set->assign(object, view(points), view(volumes), 1000.0, 26) == C3DE_E_ARG);
  points[5][1] = std::nan("");
  CHECK(set->move(object, view(points)) == C3DE_E_ARG);
  std::vector<Vec3> small(3);
  CHECK(set->read(object, C3DE_FIELD_POSITION, room(small)) == C3DE_E_ARG);
  CHECK(set->read(object, 999, room(points)) == C3DE_E_ARG);
  CHECK(set->count(object) == 64);
  object->vt->release(object);
}

TEST_CASE("a surfel set of one's own follows its phyxels, also after the caller has let go of them") {
  SimulatorSession session(1);
  c3de_object *phyxels = session.create(kPhyxelClass);
  const auto *set = query<c3de_phyxel_set_v1>(phyxels, C3DE_POINTBASED_PHYXEL_SET_ID);
  const std::vector<Vec3> points = lattice();
  const std::vector<double> volumes(points.size(), 1e-6);
  REQUIRE(set->assign(phyxels, view(points), view(volumes), 1000.0, 26) == C3DE_OK);

  c3de_object *object = session.create(kSurfelClass);
  const auto *surfels = query<c3de_surfel_set_v1>(object, C3DE_POINTBASED_SURFEL_SET_ID);
  const std::vector<Vec3> surface{{0.0, 0.0, 0.03}, {0.015, 0.015, 0.035}}, normals{{0, 0, 1}, {0, 0, 1}};
  CHECK(surfels->assign(object, object, view(surface), view(normals)) == C3DE_E_ARG);  // not a phyxel set
  REQUIRE(surfels->assign(object, phyxels, view(surface), view(normals)) == C3DE_OK);
  REQUIRE(surfels->count(object) == 2);
  std::vector<Vec3> now;
  for (const Vec3 &x : points) now.push_back(moved(x));
  REQUIRE(set->move(phyxels, view(now)) == C3DE_OK);
  phyxels->vt->release(phyxels);

  std::vector<Vec3> at(2);
  REQUIRE(surfels->read(object, C3DE_FIELD_POSITION, room(at)) == C3DE_OK);
  for (std::size_t i = 0; i < 2; ++i) CHECK(norm(at[i] - moved(surface[i])) < 1e-11);
  REQUIRE(surfels->read(object, C3DE_FIELD_NORMAL, room(at)) == C3DE_OK);
  CHECK_THAT(norm(at[0]), WithinRel(1.0, 1e-12));

  c3de_view skin{};
  REQUIRE(surfels->triangles(object, &skin) == C3DE_OK);  // points without triangles have none
  CHECK(skin.count == 0);
  c3de_view offsets{}, indices{}, weights{};
  REQUIRE(surfels->owners(object, &offsets, &indices, &weights) == C3DE_OK);
  double sum = 0.0;
  for (std::uint64_t e = 0; e < weights.count; ++e) sum += static_cast<const double *>(weights.data)[e];
  CHECK_THAT(sum, WithinRel(2.0, 1e-12));
  CHECK(object->vt->release(object) == 0);
}

TEST_CASE("the phyxels of a simulator are read only, and stale when their body is removed") {
  SimulatorSession session(1);
  auto mesh = geometry::loadMesh(std::filesystem::path(testResourcesFolder()) / "meshes" / "organ.obj",
                                 geometry::LengthUnit::millimetre);
  REQUIRE(mesh);
  const c3de_handle body = session.addBody(*mesh, {}, {SimulatorSession::number("sampling.count", 200.0)});
  c3de_object *object = session.phyxelSet(body);
  const auto *set = query<c3de_phyxel_set_v1>(object, C3DE_POINTBASED_PHYXEL_SET_ID);
  std::vector<Vec3> points(static_cast<std::size_t>(set->count(object)));
  REQUIRE(points.size() > 150);
  CHECK(set->read(object, C3DE_FIELD_POSITION, room(points)) == C3DE_OK);
  CHECK(set->move(object, view(points)) == C3DE_E_STATE);
  session.remove(body);
  CHECK(set->read(object, C3DE_FIELD_POSITION, room(points)) == C3DE_E_STALE);
  object->vt->release(object);
}
