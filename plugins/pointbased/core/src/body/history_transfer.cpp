// SPDX-License-Identifier: Apache-2.0
#include "body/history_transfer.h"

#include <algorithm>

#include "base/point_tree.h"

namespace pointbased::detail {
namespace {

constexpr std::size_t kNearest = 16;  // points among which one of the same material is searched

/// For every point of `rest` the point of `from` whose history it takes. `from` has points.
std::vector<Index> nearestOfSameMaterial(const Body &from, const RestState &rest) {
  const StencilSet &coarse = from.rest().stencils, &fine = rest.stencils;
  const auto materialOf = [](const StencilSet &s, std::size_t q) { return s.materials.empty() ? 0 : s.materials[q]; };
  const PointTree tree(from.rest().pointCentres);
  std::vector<Index> indices(kNearest), out(rest.pointCount());
  std::vector<double> squared(kNearest);
  for (std::size_t q = 0; q < out.size(); ++q) {
    const Vec3 at = rest.pointCentres[q] + rest.origin - from.rest().origin;
    const std::size_t found = tree.nearest(at, kNearest, indices.data(), squared.data());
    const auto end = indices.begin() + static_cast<std::ptrdiff_t>(found);
    const auto same =
        std::find_if(indices.begin(), end, [&](Index p) { return materialOf(coarse, p) == materialOf(fine, q); });
    out[q] = same == end ? indices.front() : *same;
  }
  return out;
}

template <class Value>
void take(const std::vector<Value> &from, const std::vector<Index> &points, std::vector<Value> &to) {
  if (from.empty() || to.empty()) return;
  for (std::size_t q = 0; q < to.size(); ++q) to[q] = from[points[q]];
}

}  // namespace

void transferPlasticStrain(const Body &from, State &to, const RestState &rest) {
  const std::vector<Mat3> &plastic = from.state().history.plasticInverse;
  if (plastic.empty() || to.history.plasticInverse.empty()) return;
  take(plastic, nearestOfSameMaterial(from, rest), to.history.plasticInverse);
}

void transferHistory(const Body &from, State &to, const RestState &rest) {
  const PointHistory &history = from.state().history;
  if (history.plasticInverse.empty() && history.prony.empty()) return;
  const std::vector<Index> points = nearestOfSameMaterial(from, rest);
  take(history.plasticInverse, points, to.history.plasticInverse);
  take(history.prony, points, to.history.prony);
}

}  // namespace pointbased::detail
