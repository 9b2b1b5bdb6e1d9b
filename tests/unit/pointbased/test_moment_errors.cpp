// SPDX-License-Identifier: Apache-2.0
#include "discretisation/lattice/moment_errors.h"

#include "shapes.h"
#include "support/catch.h"

using namespace pointbased;
using lattice::MomentErrors;

namespace {

constexpr double kEdge = 0.01, kCell = 1e-6, kSpacing = 6.0 * kEdge;

std::vector<Vec3> grid(int nx, int ny, int nz) {
  std::vector<Vec3> out;
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) out.push_back(kEdge * Vec3(i, j, k));
  return out;
}

struct Totals {
  double volume = 0.0;
  Vec3 first = Vec3::Zero();
  Mat3 second = Mat3::Zero();
};

Totals totalsOf(const std::vector<Vec3> &positions, const std::vector<double> &volumes, std::size_t from = 0,
                std::size_t to = ~std::size_t{0}) {
  Totals out;
  for (std::size_t i = from; i < std::min(to, positions.size()); ++i) {
    out.volume += volumes[i];
    out.first += volumes[i] * positions[i];
    out.second += volumes[i] * positions[i] * positions[i].transpose();
  }
  return out;
}

/// Volumes of cells in which surfaces across x have 1.3 times too much, taken from the layers below.
struct Case {
  std::vector<Vec3> positions;
  std::vector<double> right, volumes, available;
  MomentErrors errors;

  Case(const std::vector<Vec3> &at, int nx, std::vector<Index> components, double excess)
      : positions(at), right(at.size(), kCell), volumes(right), available(at.size(), 0.4 * kCell),
        errors(positions, std::move(components)) {
    const auto put = [&](std::size_t about, std::size_t i, double volume) {
      errors.add(static_cast<Index>(about), static_cast<Index>(i), volume);
      volumes[i] += volume;
    };
    const auto n = static_cast<std::size_t>(nx);
    for (std::size_t row = 0; row + n <= at.size(); row += n)
      for (const auto &[end, inner] : {std::pair(row, row + 1), std::pair(row + n - 1, row + n - 2)}) {
        put(inner, end, excess * kCell);
        put(inner, inner, -excess * kCell);
      }
    for (std::size_t i = 0; i < at.size(); ++i) available[i] = std::min(0.4 * kCell, 0.6 * volumes[i]);
  }
  void correct() { errors.correct(volumes, available, kSpacing, serialFor()); }
};

}  // namespace

TEST_CASE("errors of moments are corrected without taking more than is available") {
  Case c(grid(5, 4, 20), 5, std::vector<Index>(400, 0), 0.3);
  const std::vector<double> before = c.volumes;
  const Totals right = totalsOf(c.positions, c.right), wrong = totalsOf(c.positions, before);
  REQUIRE(wrong.second(0, 0) > 1.05 * right.second(0, 0));
  c.correct();
  const Totals now = totalsOf(c.positions, c.volumes);
  CHECK_THAT(now.volume, WithinRel(right.volume, 1e-12));
  CHECK((now.first - right.first).norm() < 1e-9 * right.first.norm());
  CHECK((now.second - right.second).norm() < 1e-9 * right.second.norm());
  for (std::size_t i = 0; i < before.size(); ++i) CHECK(c.volumes[i] > before[i] - c.available[i] * (1.0 + 1e-9));
  // Locally as well: each half of the length has its moment.
  const Totals half = totalsOf(c.positions, c.volumes, 0, 200), rightHalf = totalsOf(c.positions, c.right, 0, 200);
  CHECK_THAT(half.second(0, 0), WithinRel(rightHalf.second(0, 0), 0.01));
}

TEST_CASE("phyxels with little available limit the correction, and the centre of mass is right") {
  Case c(grid(5, 4, 20), 5, std::vector<Index>(400, 0), 0.3);
  // At one side even the first moments are wrong.
  for (Index i = 204; i < 400; i += 5) {
    c.errors.add(i - 1, i, 0.2 * kCell);
    c.errors.add(i - 1, i - 1, -0.2 * kCell);
    c.volumes[i] += 0.2 * kCell;
    c.volumes[i - 1] -= 0.2 * kCell;
  }
  for (std::size_t i = 0; i < 400; ++i) c.available[i] = (i % 3 == 0 ? 0.01 : 0.3) * c.volumes[i];
  const std::vector<double> before = c.volumes;
  const Totals right = totalsOf(c.positions, c.right), wrong = totalsOf(c.positions, before);
  c.correct();
  const Totals now = totalsOf(c.positions, c.volumes);
  CHECK_THAT(now.volume, WithinRel(right.volume, 1e-12));
  CHECK((now.first - right.first).norm() < 1e-9 * right.first.norm());
  CHECK(std::abs(now.second(0, 0) - right.second(0, 0)) < 0.5 * std::abs(wrong.second(0, 0) - right.second(0, 0)));
  for (std::size_t i = 0; i < before.size(); ++i) CHECK(c.volumes[i] > before[i] - c.available[i] * (1.0 + 1e-9));
}

TEST_CASE("moments that are accurate to two per cent change no volume") {
  Case c(grid(5, 4, 20), 5, std::vector<Index>(400, 0), 0.02);
  const std::vector<double> before = c.volumes;
  c.correct();
  CHECK(c.volumes == before);
}

TEST_CASE("components exchange no volume") {
  // The second one lies beside the first and has twice its errors.
  std::vector<Vec3> positions = grid(5, 4, 10);
  for (std::size_t i = 0; i < 200; ++i) positions.push_back(positions[i] + Vec3(6.0 * kEdge, 0.0, 0.0));
  std::vector<Index> components(400, 0);
  std::fill(components.begin() + 200, components.end(), Index{200});
  Case c(positions, 5, components, 0.3);
  for (Index i = 201; i < 400; i += 5) {
    c.errors.add(i, i - 1, 0.3 * kCell);
    c.errors.add(i, i, -0.3 * kCell);
    c.volumes[i - 1] += 0.3 * kCell;
    c.volumes[i] -= 0.3 * kCell;
    c.available[i] = 0.1 * kCell;
  }
  c.correct();
  for (const auto &[from, to] : {std::pair(0, 200), std::pair(200, 400)}) {
    const Totals now = totalsOf(c.positions, c.volumes, from, to), right = totalsOf(c.positions, c.right, from, to);
    CHECK_THAT(now.volume, WithinRel(right.volume, 1e-12));
    CHECK((now.first - right.first).norm() < 1e-9 * right.first.norm());
  }
}

TEST_CASE("bodies of one layer, of one phyxel and of none have finite volumes after the correction") {
  for (const auto &[nx, ny, nz] : {std::tuple(5, 5, 1), std::tuple(5, 1, 1), std::tuple(2, 1, 1)}) {
    Case c(grid(nx, ny, nz), nx, std::vector<Index>(static_cast<std::size_t>(nx * ny * nz), 0), 0.3);
    c.correct();
    CHECK_THAT(totalsOf(c.positions, c.volumes).volume, WithinRel(totalsOf(c.positions, c.right).volume, 1e-12));
    for (const double v : c.volumes) CHECK(v > 0.0);
  }
  std::vector<double> volumes{kCell};
  const std::vector<Vec3> one{Vec3(1, 2, 3)};
  MomentErrors alone(one, {0});
  alone.add(0, 0, kCell);
  alone.add(0, 0, -kCell);
  alone.correct(volumes, {0.4 * kCell}, kSpacing, serialFor());
  CHECK(volumes[0] == kCell);
  std::vector<double> none;
  MomentErrors({}, {}).correct(none, {}, kSpacing, serialFor());
}
