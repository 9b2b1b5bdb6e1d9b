// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "discretisation/lattice/lattice_grid.h"

/// Samples of the body inside its cut cells: 64 in each.
namespace pointbased::lattice {

inline constexpr int kNoSample = -1;

/// Signed distances of the samples of some cells, m. If the shape provides no distances: ± the edge. If it provides
/// shares: values that shareOf() maps to these shares, and for small cells that are definitely full or empty, values
/// that are certain for View::depth().
/// @param out  [cells]
void sampleCells(const Questions &ask, const CellSet &set, std::span<const Cell> cells, std::span<Samples> out,
                 const ParallelFor &parallelFor);

/// A sample of a cell.
struct Place {
  Index cell = kNone;
  int sample = kNoSample;
  [[nodiscard]] bool found() const { return sample != kNoSample; }
};

/// The samples of one cell.
struct View {
  const Samples *distances = nullptr;  ///< none: full
  double edge = 0.0;
  bool measured = true;

  [[nodiscard]] double share(int s) const {
    return distances == nullptr ? 1.0 : shareOf((*distances)[static_cast<std::size_t>(s)], edge / kSamplesPerAxis);
  }
  [[nodiscard]] bool connects(int s) const { return share(s) > kConnectingShare; }
  [[nodiscard]] bool inside(int s) const {
    return distances == nullptr || (*distances)[static_cast<std::size_t>(s)] < 0.0;
  }
  /// Lower bound of the distance of a sample inside from the surface.
  [[nodiscard]] double depth(int s) const {
    if (distances == nullptr) return std::max(0.0, edge * (0.5 * std::sqrt(3.0) - sampleOffset(s).norm()));
    return measured ? std::max(0.0, -(*distances)[static_cast<std::size_t>(s)]) : 0.0;
  }
};

[[nodiscard]] inline View viewOf(const CellSet &set, std::size_t cell) {
  const Cell &c = set.cells[cell];
  return {c.samples == kNone ? nullptr : &set.samples[c.samples], set.edge(c), set.measured};
}

/// The sample inside reached from a sample outside by descending the distance; not found: the descent ends outside.
[[nodiscard]] Place rootOf(const CellSet &set, Place place);

/// Segments through the body that only the shape can decide, queried together.
class CrossingQuestions {
 public:
  CrossingQuestions(const BodyShape &shape, const CellSet &set) : shape_(shape), set_(set) {}
  void add(const Place &from, const Place &to) {
    from_.push_back(world(from));
    to_.push_back(world(to));
  }
  [[nodiscard]] std::vector<std::uint8_t> ask(const ParallelFor &parallelFor) const {
    std::vector<std::uint8_t> crosses(from_.size());
    parallelFor(from_.size(), 64, [&](std::size_t begin, std::size_t end) {
      shape_.crosses(std::span<const Vec3>(from_).subspan(begin, end - begin),
                     std::span<const Vec3>(to_).subspan(begin, end - begin),
                     std::span<std::uint8_t>(crosses).subspan(begin, end - begin));
    });
    return crosses;
  }

 private:
  [[nodiscard]] Vec3 world(const Place &place) const {
    const Cell &c = set_.cells[place.cell];
    return set_.frame.world(set_.centre(c) + set_.edge(c) * sampleOffset(place.sample));
  }
  const BodyShape &shape_;
  const CellSet &set_;
  std::vector<Vec3> from_, to_;
};

}  // namespace pointbased::lattice
