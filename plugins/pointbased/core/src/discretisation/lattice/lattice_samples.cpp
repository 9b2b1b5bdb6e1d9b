// SPDX-License-Identifier: Apache-2.0
#include "discretisation/lattice/lattice_samples.h"

#include "discretisation/grid_sides.h"

namespace pointbased::lattice {
namespace {

// The neighbour of a sample, in its own cell or in the one behind the face.
Place neighbourOf(const CellSet &set, const Place &place, int axis, int sign) {
  const int to = sampleCoordinate(place.sample, axis) + sign;
  if (to >= 0 && to < kSamplesPerAxis) return {place.cell, place.sample + sign * (1 << (2 * axis))};
  const Cell &cell = set.cells[place.cell];
  // Centre of the small cell behind the face, in eighths of the finest cells.
  Cell3 at{};
  for (int a = 0; a < 3; ++a)
    at[static_cast<std::size_t>(a)] =
        8 * cell.at[static_cast<std::size_t>(a)] +
        (2 * sampleCoordinate(place.sample, a) + 1 + (a == axis ? 2 * sign : 0)) * cell.size;
  const auto floored = [](std::int32_t value) { return value < 0 ? -1 : value / 8; };
  const Index other = set.index.holding({floored(at[0]), floored(at[1]), floored(at[2])});
  if (other == kNone) return {};
  const Cell &behind = set.cells[other];
  int sample = 0;
  for (int a = 0; a < 3; ++a) {
    const std::int32_t within = at[static_cast<std::size_t>(a)] - 8 * behind.at[static_cast<std::size_t>(a)];
    sample |= std::clamp(within / (2 * behind.size), 0, kSamplesPerAxis - 1) << (2 * a);
  }
  return {other, sample};
}

}  // namespace

Place rootOf(const CellSet &set, Place place) {
  for (View view = viewOf(set, place.cell); !view.inside(place.sample); view = viewOf(set, place.cell)) {
    Place deepest = place;
    double least = (*view.distances)[static_cast<std::size_t>(place.sample)];
    for (int axis = 0; axis < 3; ++axis)
      for (int sign = -1; sign <= 1; sign += 2) {
        const Place next = neighbourOf(set, place, axis, sign);
        if (!next.found()) continue;
        const View there = viewOf(set, next.cell);
        const double distance =
            there.distances == nullptr ? -there.edge : (*there.distances)[static_cast<std::size_t>(next.sample)];
        if (distance >= least || !there.connects(next.sample)) continue;
        least = distance;
        deepest = next;
      }
    if (deepest.cell == place.cell && deepest.sample == place.sample) return {};
    place = deepest;
  }
  return place;
}

namespace {

// Two full neighbours are deeper than the distance between them; a full one and one that is cut are not.
constexpr double kBeyond = 0.55;

void sampleShares(const Questions &ask, const CellSet &set, std::span<const Cell> cells, std::span<Samples> out) {
  std::array<Vec3, kSamples> points;
  std::array<double, kSamples> parts{};
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const Vec3 centre = set.centre(cells[c]);
    const double edge = set.edge(cells[c]), width = edge / kSamplesPerAxis;
    for (int s = 0; s < kSamples; ++s) points[static_cast<std::size_t>(s)] = centre + edge * sampleOffset(s);
    ask.shares(points, width, parts, out[c]);
    for (std::size_t s = 0; s < kSamples; ++s) {
      double &distance = out[c][s];
      if (parts[s] >= 1.0)
        distance = std::min(distance, -kBeyond * width);
      else if (parts[s] <= 0.0)
        distance = std::max(distance, kBeyond * width);
      else
        distance = (0.5 - parts[s]) * width;
    }
  }
}

}  // namespace

void sampleCells(const Questions &ask, const CellSet &set, std::span<const Cell> cells, std::span<Samples> out,
                 const ParallelFor &parallelFor) {
  constexpr std::size_t kCellsPerBatch = 16;
  parallelFor(cells.size(), kCellsPerBatch, [&](std::size_t begin, std::size_t end) {
    if (ask.knowsShares()) {
      sampleShares(ask, set, cells.subspan(begin, end - begin), out.subspan(begin, end - begin));
      return;
    }
    std::vector<Vec3> points, representatives;
    std::vector<double> distances;
    std::vector<std::uint8_t> answers;
    std::vector<std::size_t> askedOf;
    detail::GridSides sides;
    for (std::size_t first = begin; first < end; first += kCellsPerBatch) {
      const std::size_t count = std::min(kCellsPerBatch, end - first);
      points.resize(count * kSamples);
      for (std::size_t i = 0; i < count; ++i) {
        const Vec3 centre = set.centre(cells[first + i]);
        const double edge = set.edge(cells[first + i]);
        for (int s = 0; s < kSamples; ++s)
          points[i * kSamples + static_cast<std::size_t>(s)] = centre + edge * sampleOffset(s);
      }
      if (!ask.measures()) {
        answers.resize(points.size());
        ask.inside(points, answers);
        for (std::size_t i = 0; i < count; ++i) {
          const double edge = set.edge(cells[first + i]);
          for (std::size_t s = 0; s < kSamples; ++s) out[first + i][s] = answers[i * kSamples + s] != 0 ? -edge : edge;
        }
        continue;
      }
      distances.resize(points.size());
      ask.distances(points, distances);
      representatives.clear();
      askedOf.resize(points.size());
      for (std::size_t i = 0; i < count; ++i) {
        const std::size_t at = i * kSamples;
        sides.find({kSamplesPerAxis, kSamplesPerAxis, kSamplesPerAxis}, set.edge(cells[first + i]) / kSamplesPerAxis,
                   std::span<const double>(distances).subspan(at, kSamples));
        for (std::size_t s = 0; s < kSamples; ++s) askedOf[at + s] = representatives.size() + sides.groups()[s];
        for (const std::size_t s : sides.deepest()) representatives.push_back(points[at + s]);
      }
      answers.resize(representatives.size());
      ask.inside(representatives, answers);
      for (std::size_t i = 0; i < count; ++i)
        for (std::size_t s = 0; s < kSamples; ++s) {
          const double d = distances[i * kSamples + s];
          out[first + i][s] = answers[askedOf[i * kSamples + s]] != 0 ? -d : d;
        }
    }
  });
}

}  // namespace pointbased::lattice
