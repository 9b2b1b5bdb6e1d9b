// SPDX-License-Identifier: Apache-2.0
// Fronts, frequencies and samples.
#include <cmath>
#include <numbers>

#include "c3de/geometry/winding_number.h"
#include "c3de/study/first_frequency.h"
#include "c3de/study/pareto.h"
#include "c3de/study/sampling.h"
#include "support/catch.h"

using namespace c3de;
using namespace c3de::study;

TEST_CASE("A point is off the front only where another is as accurate and cheaper by more than the noise") {
  const std::vector<Tradeoff> points{{1.0, 1.2, 0.10},   // cheap
                                     {2.0, 2.2, 0.05},   // better
                                     {2.1, 2.4, 0.06},   // worse, more expensive, but within the noise of the first
                                     {2.3, 2.5, 0.06},   // more expensive by more than that noise
                                     {9.0, 9.1, 0.05},   // no better and much more expensive
                                     {9.0, 9.1, 0.01}};  // best
  CHECK(paretoFront(points, 0.0) == std::vector<bool>{true, true, true, false, false, true});
  // Below the floor no result is better than the others.
  CHECK(paretoFront(points, 0.2) == std::vector<bool>{true, false, false, false, false, false});
  CHECK(paretoFront({}, 0.0).empty());
}

TEST_CASE("The first frequency is the lowest one that a signal swings with, of even and uneven samples") {
  for (const double jitter : {0.0, 0.4})
    for (const double frequency : {3.7, 5.0, 21.3}) {
      std::vector<double> time, signal;
      const double dt = 1e-3;
      for (int i = 0; i < 2000; ++i) {
        const double t = dt * (i + jitter * std::sin(1.7 * i));
        time.push_back(t);
        // On a slope, with a higher one that is as strong.
        signal.push_back(4.0 + 0.5 * t + std::sin(2.0 * std::numbers::pi * frequency * t + 0.3) +
                         std::sin(2.0 * std::numbers::pi * 6.27 * frequency * t));
      }
      const auto found = firstFrequency(time, signal);
      REQUIRE(found);
      CHECK_THAT(*found, WithinRel(frequency, 2e-3));  // linear interpolation between samples is slightly lower
    }
}

TEST_CASE("Too few periods, no swing and too few samples have no frequency") {
  std::vector<double> time, slow, still;
  for (int i = 0; i < 500; ++i) {
    time.push_back(1e-3 * i);
    slow.push_back(std::sin(2.0 * std::numbers::pi * 4.0 * time.back()));
    still.push_back(0.25);
  }
  CHECK_THAT(firstFrequency(time, slow).error().message, Contains("periods of the first frequency"));
  CHECK_THAT(firstFrequency(time, still).error().message, Contains("does not oscillate"));
  CHECK_THAT(firstFrequency(std::span(time).first(5), std::span(slow).first(5)).error().message, Contains("5 samples"));
}

namespace {

/// A box in mm with outward faces.
geometry::TriangleMesh box(const Vec3 &min, const Vec3 &max) {
  geometry::TriangleMesh mesh;
  for (unsigned i = 0; i < 8; ++i)
    mesh.vertices.push_back({(i & 1u) ? max[0] : min[0], (i & 2u) ? max[1] : min[1], (i & 4u) ? max[2] : min[2]});
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

}  // namespace

TEST_CASE("Samples lie inside and on the skins, share by volume and area, and are the same for the same seed") {
  const std::vector<Skin> skins{{"large", box({0, 0, 0}, {200, 100, 100})}, {"small", box({300, 0, 0}, {350, 50, 50})}};
  const auto samples = drawSamples(skins, 2000, 5);
  REQUIRE(samples);
  CHECK(samples->skinBegin == samples->inside);
  CHECK_THAT(static_cast<double>(samples->inside), WithinAbs(2000.0, 2.0));
  double volume = 0.0, area = 0.0, meanX = 0.0;
  const geometry::WindingNumber winding(skins[0].mesh);
  for (std::size_t i = 0; i < samples->points.size(); ++i) {
    const auto &point = samples->points[i];
    if (i < samples->inside) {
      volume += samples->weights[i];
      if (point.body == "large") {
        CHECK(winding.at(1e3 * point.at_m) > 0.5);
        meanX += samples->weights[i] * point.at_m[0];
      }
    } else {
      area += samples->weights[i];
      if (point.body != "large") continue;
      double off = 1.0;
      for (std::size_t a = 0; a < 3; ++a)
        off = std::min({off, std::abs(point.at_m[a]), std::abs(point.at_m[a] - (a == 0 ? 0.2 : 0.1))});
      CHECK(off < 1e-12);
    }
  }
  CHECK_THAT(volume, WithinRel(0.002 + 0.000125, 1e-9));
  CHECK_THAT(area, WithinRel(0.1 + 0.015, 1e-9));
  CHECK_THAT(meanX / 0.002, WithinAbs(0.1, 0.005));  // of 1900 points: a standard deviation of 0.0013
  const auto again = drawSamples(skins, 2000, 5), other = drawSamples(skins, 2000, 6);
  CHECK(again->points.back().at_m == samples->points.back().at_m);
  CHECK(other->points.back().at_m != samples->points.back().at_m);
}

TEST_CASE("A body without an inside cannot be sampled") {
  auto flat = box({0, 0, 0}, {1, 1, 1});
  flat.triangles.clear();
  CHECK_THAT(drawSamples({{"flat", flat}}, 100, 1).error().message, Contains("body 'flat'"));
}
