// SPDX-License-Identifier: Apache-2.0
#include "pointbased/cloud_quality.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "base/disjoint_sets.h"
#include "base/symmetric_eigen.h"

namespace pointbased {

std::string CloudQuality::warning() const {
  std::string text;
  const auto add = [&text, this](std::size_t count, const std::string &what) {
    text +=
        (text.empty() ? "" : "; ") + std::to_string(count) + " of " + std::to_string(phyxels) + " phyxels have " + what;
  };
  const std::string few12 = std::to_string(kFewNeighbours), many100 = std::to_string(kManyNeighbours);
  const double enough = kUnusualPart * static_cast<double>(phyxels);
  if (static_cast<double>(few) > enough)
    add(few, "fewer than " + few12 + " neighbours; " + few12 + " to " + many100 + " are usual");
  if (static_cast<double>(many) > enough)
    add(many, "more than " + many100 + " neighbours; " + few12 + " to " + many100 + " are usual");
  if (coincident > 0) add(coincident, "the place of another one and follow the same neighbours");
  return text;
}

CloudQuality inspectCloud(const RestState &rest) {
  CloudQuality out;
  if (rest.evaluation != Evaluation::phyxels) return out;
  const StencilSet &s = rest.stencils;
  out.phyxels = rest.phyxelCount();
  const double same = kCoincident * rest.spacing;
  for (Index i = 0; i < rest.neighbors.rows(); ++i) {
    const std::size_t count = rest.neighbors.offsets[i + 1] - rest.neighbors.offsets[i];
    out.few += count < kFewNeighbours ? 1 : 0;
    out.many += count > kManyNeighbours ? 1 : 0;
    bool coincides = false;
    for (Index k = rest.neighbors.offsets[i]; k < rest.neighbors.offsets[i + 1]; ++k) {
      const Index j = rest.neighbors.indices[k];
      coincides = coincides || (j < i && (rest.positions[j] - rest.positions[i]).squaredNorm() <= same * same);
    }
    out.coincident += coincides ? 1 : 0;
  }
  for (std::size_t q = 0; q < s.pointCount(); ++q) {
    const int rank = s.rank[q];
    out.flat += rank < 3 ? 1 : 0;
    if (rank == 0) continue;
    // The weights of the control are those of the fit up to a factor, which does not affect a condition number.
    const Vec3 anchor = rest.positions[s.phyxels.indices[s.phyxels.offsets[q]]];
    Mat3 A = Mat3::Zero();
    for (Index e = s.phyxels.offsets[q] + 1; e < s.phyxels.offsets[q + 1]; ++e) {
      const Vec3 d = rest.positions[s.phyxels.indices[e]] - anchor;
      A += s.weights[e] * d * d.transpose();
    }
    const Vec3 values = detail::symmetricEigenvalues(A);
    out.condition = std::max(out.condition, values[2] / values[3 - rank]);
  }
  return out;
}

std::string volumeWarning(const RestState &rest) {
  if (!(rest.countedVolume > 0.0) || std::abs(rest.countedVolume / rest.shapeVolume - 1.0) <= kVolumeMismatch)
    return {};
  char text[300];
  std::snprintf(text, sizeof text,
                "its surface encloses %.4g mL, but %.4g mL were found inside: it is open, goes through itself, or is "
                "in parts thinner than the distance of its phyxels, %.3g mm; the mass is that of the former",
                1e6 * rest.shapeVolume, 1e6 * rest.countedVolume, 1e3 * rest.spacing);
  return text;
}

std::string tornWarning(const RestState &rest) {
  if (rest.components < 2 || rest.skin.empty()) return {};
  DisjointSets joined(rest.surfels.count());
  std::vector<std::uint8_t> used(rest.surfels.count(), 0);
  for (const auto &[a, b, c] : rest.skin) {
    used[a] = used[b] = used[c] = 1;
    joined.join(a, b);
    joined.join(a, c);
  }
  std::size_t pieces = 0;
  for (Index i = 0; i < used.size(); ++i)
    if (used[i] != 0 && joined.find(i) == i) ++pieces;
  if (rest.components <= pieces) return {};
  char text[300];
  std::snprintf(text, sizeof text,
                "its surface has %zu connected piece%s, but its phyxels, %.3g mm apart, make %zu parts that nothing "
                "joins and that "
                "move apart: it is in places too thin for them; a smaller sampling.spacing keeps it together",
                pieces, pieces == 1 ? "" : "s", 1e3 * rest.spacing, rest.components);
  return text;
}

namespace {

// Triangles without common vertices are separate pieces even where their vertices coincide.
template <class Triangles>
bool isClosed(const Triangles &skin) {
  std::vector<std::pair<Index, Index>> edges, back;
  for (const auto &[a, b, c] : skin)
    for (const auto &[from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
      edges.emplace_back(from, to);
      back.emplace_back(to, from);
    }
  std::sort(edges.begin(), edges.end());
  std::sort(back.begin(), back.end());
  return edges == back;
}

}  // namespace

std::string gluedWarning(const RestState &rest) {
  if (rest.skin.empty()) return {};
  DisjointSets joined(rest.surfels.count());
  for (const auto &[a, b, c] : rest.skin) {
    joined.join(a, b);
    joined.join(a, c);
  }
  std::map<Index, double> volumes;  // negative: a cavity
  for (const auto &[a, b, c] : rest.skin) {
    const auto at = [&](Index i) { return rest.surfels.position(i, rest.positions); };
    volumes[joined.find(a)] += at(a).dot(at(b).cross(at(c))) / 6.0;
  }
  const double cell = rest.spacing * rest.spacing * rest.spacing;
  const auto pieces = static_cast<std::size_t>(
      std::count_if(volumes.begin(), volumes.end(), [&](const auto &piece) { return piece.second >= cell; }));
  if (rest.components >= pieces || !isClosed(rest.skin)) return {};
  char text[300];
  std::snprintf(
      text, sizeof text,
      "its surface has %zu pieces that lie apart, but its cells of %.3g mm make %zu: gaps thinner than about a "
      "sixteenth of a cell close; a smaller sampling.spacing keeps them open",
      pieces, 1e3 * rest.spacing, rest.components);
  return text;
}

}  // namespace pointbased
