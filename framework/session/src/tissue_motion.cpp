// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/tissue_motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "c3de/core/csv.h"
#include "c3de/core/output_file.h"
#include "c3de/core/text.h"
#include "c3de/imaging/displacement.h"
#include "c3de/imaging/masks.h"
#include "c3de/imaging/warp_grid.h"
#include "c3de/scene/simulation.h"
#include "c3de/session/body_states.h"
#include "c3de/session/displacement_sampler.h"
#include "placement_matrix.h"

namespace c3de::session {
namespace {

using Mat3 = std::array<Vec3, 3>;  // columns

constexpr double kMargin = 1.0;           // spacings around the bodies
constexpr double kRim = 1000.0;           // spacings: within the margin the displacement goes on as it is at the border
constexpr std::size_t kMostPoints = 144;  // along an axis
constexpr std::uint8_t kInside = 2, kBeside = 1;  // of points of a grid, to a body
constexpr double kFineness = 0.5;                 // of the grid that images go by: steps of a quarter of the spacing

double determinant(const Mat3 &m) { return dot(m[0], cross(m[1], m[2])); }

/// m y = b; the determinant is not 0.
Vec3 solved(const Mat3 &m, const Vec3 &b) {
  const double d = 1.0 / determinant(m);
  return {d * dot(b, cross(m[1], m[2])), d * dot(m[0], cross(b, m[2])), d * dot(m[0], cross(m[1], b))};
}

/// Finds material points again in a displacement that is told by present places.
class Follower {
 public:
  /// @param reference  around all that will be followed
  /// @param own        [points of u] 0: what lies there is not of its body, kBeside: beside it; empty: all is of it
  Follower(const imaging::DisplacementGrid &u, const imaging::WorldBox &reference, std::vector<std::uint8_t> own)
      : u_(u), own_(std::move(own)), toIndex_(imaging::affineInverse(u.geometry.indexToWorld)), low_(reference.low) {
    const Vec3 steps = u.geometry.spacing();
    step_ = std::min({steps[0], steps[1], steps[2]});
    for (std::size_t a = 0; a < 3; ++a)
      size_[a] = static_cast<std::size_t>((reference.high[a] - low_[a]) / (2.0 * step_)) + 1;
    seeds_.assign(size_[0] * size_[1] * size_[2], Seed{});
    std::size_t p = 0;
    const auto &n = u.geometry.size;
    for (std::size_t k = 0; k < n[2]; ++k)
      for (std::size_t j = 0; j < n[1]; ++j)
        for (std::size_t i = 0; i < n[0]; ++i, ++p) {
          // A gap: the displacement leads to where this material is no more.
          if (u.gap_mm[p] > u.leastGap() || (!own_.empty() && own_[p] == 0)) continue;
          const Vec3 d{u.xyz_mm[3 * p], u.xyz_mm[3 * p + 1], u.xyz_mm[3 * p + 2]};
          const Vec3 x = u.geometry.worldAt({static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
          const bool isInside = own_.empty() || own_[p] == kInside;
          if (const auto cell = cellOf(x - d, {}); cell && (isInside || !seeds_[*cell].isInside))
            seeds_[*cell] = {x, isInside};
        }
  }

  struct Found {
    Vec3 displacement{};
    double J = 1.0;  ///< det F
  };
  /// Nothing: the displacement does not lead there.
  [[nodiscard]] std::optional<Found> find(const Vec3 &X) const {
    std::optional<Found> best;
    double least = std::numeric_limits<double>::infinity();
    // Where pieces of a body have parted, what lies beside one is where the other was: near the body it is found.
    for (const Vec3 &seed : seedsOf(X)) {
      const auto found = findFrom(seed, X);
      if (!found) continue;
      const double outside = outsideAt(X + found->displacement);
      if (outside < least) {
        least = outside;
        best = found;
      }
      if (least <= step_) break;
    }
    return best;
  }

 private:
  static constexpr double kClose = 1e-4, kEnough = 0.05;  // of a step
  /// A present place.
  struct Seed {
    Vec3 x{std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0};  ///< NaN: none
    bool isInside = false;                                       ///< of the body, not only beside it
  };

  [[nodiscard]] std::optional<Found> findFrom(Vec3 x, const Vec3 &X) const {
    const auto miss = [&] { return X - (x - u_.toldAt(x)); };
    Vec3 missing = miss();
    // Newton's method: exact where motion is affine, however far the body has turned.
    for (int i = 0; i < 16 && norm(missing) > kClose * step_; ++i) {
      const Mat3 slope = inverseGradient(x);
      if (determinant(slope) == 0.0) return std::nullopt;
      Vec3 way = solved(slope, missing);
      if (const double length = norm(way); length > 2.0 * step_) way = (2.0 * step_ / length) * way;
      x = x + way;
      missing = miss();
    }
    const double J = 1.0 / determinant(inverseGradient(x));
    if (!(norm(missing) <= kEnough * step_) || !std::isfinite(J) || !isOwnAt(x)) return std::nullopt;
    return Found{x - X, J};
  }
  /// About how far a place is from points inside the body, mm; infinity: farther than a step.
  [[nodiscard]] double outsideAt(const Vec3 &x) const {
    if (own_.empty()) return 0.0;
    const Vec3 index = transformPoint(toIndex_, x);
    const auto &n = u_.geometry.size;
    double least = std::numeric_limits<double>::infinity();
    for (int k = -1; k <= 1; ++k)
      for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i) {
          const Vec3 at{std::floor(index[0] + 0.5) + i, std::floor(index[1] + 0.5) + j, std::floor(index[2] + 0.5) + k};
          bool isThere = true;
          for (std::size_t a = 0; a < 3; ++a) isThere = isThere && at[a] >= 0.0 && at[a] < static_cast<double>(n[a]);
          if (!isThere) continue;
          const std::size_t p = static_cast<std::size_t>(at[0]) +
                                n[0] * (static_cast<std::size_t>(at[1]) + n[1] * static_cast<std::size_t>(at[2]));
          if (own_[p] == kInside) least = std::min(least, norm(u_.geometry.worldAt(at) - x));
        }
    return least;
  }
  [[nodiscard]] bool isOwnAt(const Vec3 &x) const {
    if (own_.empty()) return true;
    const Vec3 index = transformPoint(toIndex_, x);
    const auto &n = u_.geometry.size;
    std::array<std::size_t, 3> at{};
    for (std::size_t a = 0; a < 3; ++a) {
      const double nearest = std::floor(index[a] + 0.5);
      if (!(nearest >= 0.0 && nearest < static_cast<double>(n[a]))) return false;
      at[a] = static_cast<std::size_t>(nearest);
    }
    return own_[at[0] + n[0] * (at[1] + n[1] * at[2])] != 0;
  }
  /// dX/dx
  [[nodiscard]] Mat3 inverseGradient(const Vec3 &x) const {
    Mat3 out{};
    const double h = 0.5 * step_;
    for (std::size_t a = 0; a < 3; ++a) {
      Vec3 way{};
      way[a] = h;
      out[a] = (-0.5 / h) * (u_.toldAt(x + way) - u_.toldAt(x - way));
      out[a][a] += 1.0;
    }
    return out;
  }
  [[nodiscard]] std::optional<std::size_t> cellOf(const Vec3 &X, const std::array<int, 3> &beside) const {
    std::array<std::size_t, 3> at{};
    for (std::size_t a = 0; a < 3; ++a) {
      const double cell = std::floor((X[a] - low_[a]) / (2.0 * step_)) + beside[a];
      if (!(cell >= 0.0 && cell < static_cast<double>(size_[a]))) return std::nullopt;
      at[a] = static_cast<std::size_t>(cell);
    }
    return at[0] + size_[0] * (at[1] + size_[1] * at[2]);
  }
  /// Near first, those inside of the body before those beside it.
  [[nodiscard]] std::vector<Vec3> seedsOf(const Vec3 &X) const {
    std::array<std::pair<int, Vec3>, 27> found;
    std::size_t count = 0;
    for (int k = -1; k <= 1; ++k)
      for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i) {
          const auto cell = cellOf(X, {i, j, k});
          if (!cell || std::isnan(seeds_[*cell].x[0])) continue;
          found[count++] = {std::abs(i) + std::abs(j) + std::abs(k) + (seeds_[*cell].isInside ? 0 : 4),
                            seeds_[*cell].x};
        }
    if (count == 0) return {X};
    std::stable_sort(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(count),
                     [](const auto &a, const auto &b) { return a.first < b.first; });
    std::vector<Vec3> seeds(count);
    std::transform(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(count), seeds.begin(),
                   [](const auto &one) { return one.second; });
    return seeds;
  }

  const imaging::DisplacementGrid &u_;
  std::vector<std::uint8_t> own_;
  Mat4 toIndex_;
  Vec3 low_;
  double step_ = 1.0;
  std::array<std::size_t, 3> size_{};
  std::vector<Seed> seeds_;  ///< by cells of the reference, two steps wide
};

/// Points of a grid that are inside a body or beside it, and not inside another one: where bodies, or pieces of one,
/// have moved apart what lies between them goes with either. Empty: its skin is not known.
std::vector<std::uint8_t> ownPoints(const std::vector<BodyState> &bodies, const std::string &name,
                                    const imaging::VolumeGeometry &grid) {
  std::vector<std::uint8_t> own;
  for (const BodyState &body : bodies)
    if (body.name == name && !body.skin.triangles.empty()) own = imaging::maskOf(body.skin, grid).voxels;
  if (own.empty()) return {};
  // Alone it may be thinner than the grid: what lies beside it is found from wherever it is.
  for (std::uint8_t &one : own) one = one != 0 ? kInside : bodies.size() == 1 ? kBeside : 0;
  // Beside it: along each axis in turn.
  constexpr std::ptrdiff_t kFar = 2;
  std::size_t stride = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::vector<std::uint8_t> before = own;
    const auto n = static_cast<std::ptrdiff_t>(grid.size[a]);
    for (std::size_t v = 0; v < own.size(); ++v) {
      if (before[v] != 0) continue;
      const auto at = static_cast<std::ptrdiff_t>(v / stride % grid.size[a]);
      for (std::ptrdiff_t d = std::max(-kFar, -at); d <= std::min(kFar, n - 1 - at) && own[v] == 0; ++d)
        if (before[static_cast<std::size_t>(static_cast<std::ptrdiff_t>(v) + d * static_cast<std::ptrdiff_t>(stride))])
          own[v] = kBeside;
    }
    stride *= grid.size[a];
  }
  for (const BodyState &body : bodies) {
    if (body.name == name) continue;
    const std::vector<std::uint8_t> other = imaging::maskOf(body.skin, grid).voxels;
    for (std::size_t v = 0; v < own.size(); ++v)
      if (other[v] != 0) own[v] = 0;
  }
  return own;
}

}  // namespace

void LabelMotion::add(const LabelMotion &other) {
  reference_m3 += other.reference_m3;
  end_m3 += other.end_m3;
  if (other.isKnown()) minJ = isKnown() ? std::min(minJ, other.minJ) : other.minJ;
  largestDisplacement_m = std::max(largestDisplacement_m, other.largestDisplacement_m);
  displacementSum_m += other.displacementSum_m;
  followed += other.followed;
  sample += other.sample;
}

LabelMotion TissueMotion::ofTissue(std::size_t tissue) const {
  LabelMotion all;
  double mean_m4 = 0.0;  // the volumes behind samples differ
  for (std::size_t i = 0; i < labels.size(); ++i)
    if (places.labels[i].tissue == tissue) {
      all.add(labels[i]);
      if (labels[i].isKnown()) mean_m4 += labels[i].reference_m3 * labels[i].meanDisplacement_m();
    }
  if (all.isKnown()) all.displacementSum_m = mean_m4 / all.reference_m3 * static_cast<double>(all.followed);
  return all;
}

Expected<std::vector<TissueMotion>> tissueMotions(const c3de_simulator_v1 *table, c3de_object *simulator,
                                                  const std::vector<TissuePlaces> &bodies) {
  if (bodies.empty()) return std::vector<TissueMotion>{};
  const auto snapshot = readTissues(table, simulator);
  if (!snapshot) return tl::unexpected(snapshot.error());
  return followTissues(*snapshot, bodies);
}

Expected<TissueSnapshot> readTissues(const c3de_simulator_v1 *table, c3de_object *simulator, TissueDetail detail) {
  const bool isFull = detail == TissueDetail::full;
  const PresentBodies present = presentBodies(table, simulator);
  imaging::FollowingGrid grid(
      {.mostPoints = isFull ? kMostPoints : kMostPoints / 2, .coarsestStep = std::numeric_limits<double>::infinity()});
  grid.follow(present.box, (isFull ? kFineness : 2.0 * kFineness) * present.spacing_mm, kMargin * present.spacing_mm);
  auto u = std::make_shared<imaging::DisplacementGrid>();
  u->geometry = grid.geometry();
  if (!readDisplacement(table, simulator, kRim * present.spacing_mm, *u))
    return fail(ErrorCode::state, "the simulator does not say how far its bodies have moved");
  auto skins = readBodyStates(simulator, BodyParts::skin, {});
  if (!skins) return tl::unexpected(skins.error());
  return TissueSnapshot{std::move(u), std::move(*skins)};
}

Expected<TissueSnapshot> readTissues(c3de_object *simulator, std::shared_ptr<const imaging::DisplacementGrid> u) {
  auto skins = readBodyStates(simulator, BodyParts::skin, {});
  if (!skins) return tl::unexpected(skins.error());
  imaging::WorldBox bodies;
  for (const BodyState &body : *skins)
    for (const Vec3 &x : body.skin.vertices) bodies.add(x);
  if (!imaging::boxOf(u->geometry).holds(bodies))
    return fail(ErrorCode::state, "the grid of the displacement does not hold all bodies");
  return TissueSnapshot{std::move(u), std::move(*skins)};
}

Expected<std::vector<TissueMotion>> followTissues(const TissueSnapshot &snapshot,
                                                  const std::vector<TissuePlaces> &bodies,
                                                  const std::function<bool()> &goesOn) {
  // As the simulator says it: what of the image stays, or has been left, is nothing to the tissue.
  imaging::DisplacementGrid u;
  u.geometry = snapshot.u->geometry;
  u.xyz_mm = snapshot.u->xyz_mm;
  u.gap_mm = snapshot.u->gap_mm;
  std::vector<TissueMotion> all;
  for (const TissuePlaces &places : bodies) {
    const Mat4 placed = matrixOf(places.placement);
    const double scale3 = determinant(
        {Vec3{placed[0], placed[1], placed[2]}, {placed[4], placed[5], placed[6]}, {placed[8], placed[9], placed[10]}});
    imaging::WorldBox box;
    for (const LabelPlaces &label : places.labels)
      for (const Vec3 &X : label.sample) box.add(transformPoint(placed, X));
    TissueMotion motion{places, {}};
    motion.labels.resize(places.labels.size());
    if (box.isEmpty()) {
      all.push_back(std::move(motion));
      continue;
    }
    const Follower follower(u, box, ownPoints(snapshot.skins, places.body, u.geometry));
    for (std::size_t i = 0; i < places.labels.size(); ++i) {
      if (goesOn && !goesOn()) return fail(ErrorCode::cancelled, "following the labels was ended");
      const LabelPlaces &label = places.labels[i];
      LabelMotion &out = motion.labels[i];
      out.reference_m3 = 1e-9 * std::abs(scale3) * places.voxel_mm3 * static_cast<double>(label.voxels);
      out.sample = label.sample.size();
      // What is held is known to stay; the displacement around it is smoothed over it.
      if (places.tissueAt(label.tissue).isRigid) {
        out.end_m3 = out.reference_m3;
        out.minJ = 1.0;
        out.followed = out.sample;
        continue;
      }
      double sum = 0.0;
      for (const Vec3 &scanned : label.sample) {
        const auto found = follower.find(transformPoint(placed, scanned));
        if (!found) continue;
        const double way_m = norm(found->displacement) / scene::kMillimetresPerMetre;
        out.minJ = out.followed == 0 ? found->J : std::min(out.minJ, found->J);
        out.largestDisplacement_m = std::max(out.largestDisplacement_m, way_m);
        out.displacementSum_m += way_m;
        sum += found->J;
        ++out.followed;
      }
      if (out.isKnown()) out.end_m3 = out.reference_m3 * sum / static_cast<double>(out.followed);
    }
    all.push_back(std::move(motion));
  }
  return all;
}

Expected<void> writeTissueTable(const std::filesystem::path &file, const std::vector<TissueMotion> &bodies) {
  std::string text =
      "body,label,name,tissue,material,rigid,voxels,volume [m3],volume at the end [m3],mean displacement "
      "[m],largest displacement [m],min J\n";
  for (const TissueMotion &body : bodies)
    for (std::size_t i = 0; i < body.labels.size(); ++i) {
      const LabelPlaces &label = body.places.labels[i];
      const LabelMotion &motion = body.labels[i];
      const scene::SceneTissue tissue = body.places.tissueAt(label.tissue);
      text += csvCell(body.places.body) + ',' + (label.value == 0 ? "" : std::to_string(label.value)) + ',' +
              csvCell(label.name) + ',' + csvCell(tissue.label) + ',' + csvCell(tissue.preset) + ',' +
              (tissue.isRigid ? "true" : "false") + ',' + std::to_string(label.voxels) + ',' +
              formatNumber(motion.reference_m3);
      if (motion.isKnown())
        for (const double x : {motion.end_m3, motion.meanDisplacement_m(), motion.largestDisplacement_m, motion.minJ})
          text += ',' + formatNumber(x);
      else
        text += ",,,,";
      text += '\n';
    }
  return writeWholeFile(file, text);
}

}  // namespace c3de::session
