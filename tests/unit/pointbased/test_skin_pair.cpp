// SPDX-License-Identifier: Apache-2.0
// Pairs of moving skins: what touches, and the forecast of what may.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "contact/contact_skin.h"
#include "contact/skin_forecast.h"
#include "contact/skin_pair.h"
#include "support/catch.h"

using namespace pointbased;

namespace {

// A skin of n x n squares of `edge` whose vertices are its phyxels, facing up or down.
std::shared_ptr<const detail::ContactSkin> sheetSkin(int n, double edge, bool up) {
  Interpolation vertices;
  vertices.phyxels.offsets.assign(1, 0);
  std::vector<std::array<Index, 3>> triangles;
  const auto at = [&](int i, int j) { return static_cast<Index>(j * (n + 1) + i); };
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      vertices.positions.push_back(edge * Vec3(i, j, 0.08 * std::sin(1.3 * i) * std::cos(0.9 * j)));
      vertices.phyxels.indices.push_back(at(i, j));
      vertices.phyxels.offsets.push_back(at(i, j) + 1);
      vertices.weights.push_back(1.0);
      vertices.gradients.push_back(Vec3::Zero());
    }
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i)
      for (std::array<Index, 3> t : {std::array{at(i, j), at(i + 1, j), at(i + 1, j + 1)},
                                     std::array{at(i, j), at(i + 1, j + 1), at(i, j + 1)}}) {
        if (!up) std::swap(t[1], t[2]);
        triangles.push_back(t);
      }
  return detail::makeContactSkin(std::move(vertices), std::move(triangles), {1e9}, {}, {});
}

struct TwoSheets {
  detail::MovingSkin lower{sheetSkin(12, 1.0, true), Vec3::Zero(), 2.0};
  detail::MovingSkin upper{sheetSkin(12, 1.0, false), Vec3::Zero(), 2.0};
  std::vector<Vec3> still = std::vector<Vec3>(lower.skin().count(), Vec3::Zero()), ways = still, speeds = still;
  detail::SkinPairSettings settings{
      .offset = 0.04, .thickness = 0.03, .stiffness = 50.0, .margin = 0.02, .recoverySpeed = 1.0, .minReach = 0.3};

  TwoSheets() {
    for (detail::MovingSkin *skin : {&lower, &upper}) skin->setModuli(std::vector<double>(still.size(), 1e4));
  }
  void find(detail::SkinPair &pair, double dt) {
    lower.move(still, still, {}, dt);
    upper.move(ways, speeds, {}, dt);
    pair.find(dt);
  }
};

}  // namespace

TEST_CASE("what touches does not depend on when it was looked for before") {
  TwoSheets sheets;
  detail::SkinPair pair(sheets.lower, sheets.upper, sheets.settings);
  std::size_t touching = 0;
  for (int k = 0; k < 400; ++k) {
    // Up, down and sideways by less than the validity margin of the gathered pairs, so that some are checked late.
    for (std::size_t v = 0; v < sheets.ways.size(); ++v) {
      const double phase = 0.11 * k + 0.3 * static_cast<double>(v % 13);
      sheets.ways[v] = Vec3(0.3 + 0.02 * std::sin(0.05 * k), 0.2, 0.1 + 0.03 * std::sin(phase));
      sheets.speeds[v] = Vec3(0.001 * std::cos(0.05 * k), 0.0, 0.0033 * std::cos(phase));
    }
    sheets.find(pair, 1.0);
    detail::SkinPair fresh(sheets.lower, sheets.upper, sheets.settings);
    sheets.find(fresh, 1.0);
    sheets.find(fresh, 1.0);
    REQUIRE(pair.active().size() == fresh.active().size());
    for (std::size_t c = 0; c < fresh.active().size(); ++c) {
      REQUIRE(pair.active()[c].key == fresh.active()[c].key);
      REQUIRE(pair.active()[c].gap == fresh.active()[c].gap);
    }
    touching += fresh.active().size();
  }
  CHECK(touching > 1000);
}

TEST_CASE("where a skin touches itself does not depend on when it was looked at before") {
  // A sheet folded along its middle; its arms flap against each other, without a strain: sharp edges are detected when
  // the pairs are gathered.
  detail::MovingSkin skin(sheetSkin(24, 1.0, true), Vec3::Zero(), 2.0);
  skin.setModuli(std::vector<double>(skin.skin().count(), 1e4));
  const detail::SkinPairSettings settings{.offset = 0.04,
                                          .thickness = 0.03,
                                          .stiffness = 50.0,
                                          .margin = 0.02,
                                          .recoverySpeed = 1.0,
                                          .sameTissueDistance = 3.0};
  const auto place = [&](std::size_t v, double time) -> Vec3 {
    const Vec3 &rest = skin.skin().vertices.positions[v];
    const double from = rest.x() - 12.0, side = from > 0.0 ? 1.0 : -1.0;
    if (from == 0.0) return {0.1, rest.y(), rest.z()};
    const double beat = std::sin(0.07 * time) * std::abs(from) / 12.0;
    return {-std::abs(from), rest.y(), side * (0.1 + 0.085 * beat) + 0.05 * rest.z()};
  };
  std::vector<Vec3> ways(skin.skin().count()), speeds = ways;
  const auto find = [&](detail::SkinPair &pair) {
    skin.move(ways, speeds, {}, 1.0);
    pair.find(1.0);
  };
  detail::SkinPair pair(skin, skin, settings);
  std::size_t touching = 0, served = 0, within = 0;
  for (int k = 0; k < 400; ++k) {
    for (std::size_t v = 0; v < ways.size(); ++v) {
      ways[v] = place(v, k) - skin.skin().vertices.positions[v];
      speeds[v] = place(v, k + 0.5) - place(v, k - 0.5);
    }
    skin.move(ways, speeds, {}, 1.0);
    served += pair.predictedContact().has_value() ? 1 : 0;
    if (k == 0) find(pair);  // overlaps at the first check are a separate case
    find(pair);
    detail::SkinPair fresh(skin, skin, settings);
    find(fresh);
    find(fresh);
    REQUIRE(pair.active().size() == fresh.active().size());
    for (std::size_t c = 0; c < fresh.active().size(); ++c) {
      REQUIRE(pair.active()[c].key == fresh.active()[c].key);
      REQUIRE(pair.active()[c].gap == fresh.active()[c].gap);
    }
    touching += fresh.active().size();
    if (k % 40 != 20) continue;
    // All pairs, one by one.
    const std::vector<Vec3> &rest = skin.skin().vertices.positions;
    for (Index v = 0; v < skin.skin().count(); ++v) {
      double nearest = 1e9;
      for (Index t = 0; t < skin.skin().triangles.size(); ++t) {
        const auto &[a, b, c] = skin.skin().triangles[t];
        if ((rest[v] - (rest[a] + rest[b] + rest[c]) / 3.0).norm() < settings.sameTissueDistance + 1.0) continue;
        nearest = std::min(nearest, skin.nearestOn(t, skin.position(v)).squared);
      }
      if (!(std::sqrt(nearest) < settings.offset + 0.9 * settings.margin)) continue;
      ++within;
      CHECK(std::any_of(fresh.active().begin(), fresh.active().end(),
                        [&](const auto &contact) { return !contact.isOfEdges() && contact.parts[0].vertex == v; }));
    }
  }
  CAPTURE(touching, served, within);
  CHECK(touching > 1000);
  CHECK(within > 100);
  CHECK(served > 300);
}

TEST_CASE("the forecast of a skin asks its vertices where light phyxels swing about") {
  // A folded sheet whose arms flap against each other. Each vertex is carried by its own phyxel, and by ten light ones
  // that many vertices share and that move erratically, like phyxels that only a sliver of a body reaches.
  constexpr std::size_t kLight = 40, kEach = 10;
  constexpr double kWeight = 0.03;
  const auto plain = sheetSkin(24, 1.0, true);
  Interpolation vertices;
  vertices.phyxels.offsets.assign(1, 0);
  vertices.positions = plain->vertices.positions;
  const std::size_t own = vertices.positions.size();
  for (std::size_t v = 0; v < own; ++v) {
    vertices.phyxels.indices.push_back(static_cast<Index>(v));
    vertices.weights.push_back(1.0 - kEach * kWeight);
    for (std::size_t k = 0; k < kEach; ++k) {
      vertices.phyxels.indices.push_back(static_cast<Index>(own + (7 * v + 9 * k) % kLight));
      vertices.weights.push_back(kWeight);
    }
    vertices.phyxels.offsets.push_back(static_cast<Index>(vertices.phyxels.indices.size()));
  }
  vertices.gradients.assign(vertices.weights.size(), Vec3::Zero());
  std::vector<float> influence(own + kLight, 1.0f);
  std::fill(influence.begin() + static_cast<std::ptrdiff_t>(own), influence.end(), static_cast<float>(kWeight));
  const auto carried = detail::makeContactSkin(std::move(vertices), plain->triangles, {1e9}, {}, influence);
  detail::MovingSkin skin(carried, Vec3::Zero(), 2.0);
  constexpr double kApart = 3.0, kNear = 0.26;
  detail::SkinForecast forecast(skin, kApart, kNear);
  const std::vector<Vec3> &rest = carried->vertices.positions;
  const auto wayOf = [&](std::size_t i, double time) -> Vec3 {
    if (i >= own) {
      const double phase = 0.7 * time + 2.4 * static_cast<double>(i);
      return {0.3 * std::cos(phase), 0.3 * std::sin(1.3 * phase), 0.3 * std::sin(phase)};
    }
    const double from = rest[i].x() - 12.0, side = from > 0.0 ? 1.0 : -1.0;
    const double beat = std::sin(0.03 * time) * std::abs(from) / 12.0;
    const Vec3 to(0.1 - std::abs(from), rest[i].y(), side * (0.9 + 0.82 * beat) + 0.05 * rest[i].z());
    return (to - rest[i]) / (1.0 - kEach * kWeight);
  };
  std::vector<Vec3> ways(own + kLight), speeds = ways;
  std::size_t looks = 0, near = 0;
  for (int k = 0; k < 400; ++k) {
    for (std::size_t i = 0; i < ways.size(); ++i) {
      ways[i] = wayOf(i, k);
      speeds[i] = wayOf(i, k + 0.5) - wayOf(i, k - 0.5);
    }
    skin.move(ways, speeds, influence, 1.0);
    if (!forecast.isStillValid()) {
      forecast.rebuild();
      ++looks;
    }
    if (k % 5 != 0) continue;
    // All near pairs are listed, whenever they were checked.
    const std::vector<detail::PatchTree::Patch> &patches = skin.tree().patches();
    const auto isListed = [&](Index v, Index t) {
      const auto has = [](const std::vector<Index> &all, Index one) {
        return std::find(all.begin(), all.end(), one) != all.end();
      };
      return std::any_of(forecast.pairs().begin(), forecast.pairs().end(), [&](const auto &pair) {
        const auto &first = patches[pair.first], &second = patches[pair.second];
        return forecast.mayTouch(pair) && ((has(first.corners, v) && has(second.triangles, t)) ||
                                           (has(second.corners, v) && has(first.triangles, t)));
      });
    };
    for (Index v = 0; v < own; ++v)
      for (Index t = 0; t < carried->triangles.size(); ++t) {
        const auto &[a, b, c] = carried->triangles[t];
        if ((rest[v] - (rest[a] + rest[b] + rest[c]) / 3.0).norm() < kApart + 1.0 ||
            skin.nearestOn(t, skin.position(v)).squared > kNear * kNear)
          continue;
        ++near;
        CHECK(isListed(v, t));
      }
  }
  CAPTURE(looks, near);
  CHECK(near > 100);
  CHECK(looks < 40);
}

TEST_CASE("what has overlapped at the start and has parted does not overlap again") {
  TwoSheets sheets;
  detail::SkinPair pair(sheets.lower, sheets.upper, sheets.settings);
  const auto lift = [&](double z) { std::fill(sheets.ways.begin(), sheets.ways.end(), Vec3(0.3, 0.2, z)); };
  lift(-0.1);
  sheets.find(pair, 1e-3);
  CHECK(pair.toleratedOverlap() > 0.05);
  lift(10.0);
  sheets.find(pair, 1e-3);
  CHECK(pair.toleratedOverlap() == 0.0);
}
