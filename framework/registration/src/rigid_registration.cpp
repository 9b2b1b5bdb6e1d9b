// SPDX-License-Identifier: Apache-2.0
#include "c3de/registration/rigid_registration.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "c3de/geometry/rigid_fit.h"
#include "measured_input.h"
#include "motions.h"
#include "point_tree.h"
#include "starts.h"

namespace c3de::registration {
namespace {

constexpr std::size_t kStarts = 96, kRefined = 12, kRefinedMirrored = 3;
constexpr std::size_t kCoarsePoints = 96, kRatedPoints = 300, kFinePoints = 600, kSearchPoints = 1500;
/// The noise explains a deviation up to this multiple of it: its estimate, and triangles in place of a surface.
constexpr double kExplained = 1.5;
/// Deviations beyond which a body has no resemblance to the points, and the extent of the points in the same role.
constexpr double kRefusedNoise = 5.0, kRefusedExtent = 0.05;
constexpr double kFewestInliers = 0.4;
/// Independent residuals of a body that has changed its shape: neighbours are displaced alike.
constexpr double kIndependent = 20.0;

struct Fitted {
  Mat4 bodyFromMeasured = kIdentity4;
  double cost = 0.0;  ///< mm², with the limit of the search
};

/// The search as a whole, for the measured points or their mirror image.
class Search {
 public:
  /// @param refined  number of different motions that are refined to the end
  Search(const TargetSurface &target, const RegistrationOptions &options, std::size_t refined, ThreadPool *pool,
         const ProgressFn &progress)
      : target_(target), options_(options), refined_(refined), pool_(pool), progress_(progress) {}

  /// Refined motions, the best first.
  [[nodiscard]] Expected<std::vector<Fitted>> run(const MovingPoints &all, double extent_mm, double from, double to);
  /// 3 deviations of the residuals of the best.
  [[nodiscard]] double limit_mm() const { return limit_mm_; }
  [[nodiscard]] double deviation_mm() const { return limit_mm_ / 3.0; }

 private:
  [[nodiscard]] bool report(double fraction, const char *what) const {
    return !progress_ || progress_(std::min(1.0, fraction), what);
  }
  void rate(const MovingPoints &moving, std::vector<Fitted> &all, double limit_mm, Feet feet) const;
  void keepDifferent(std::vector<Fitted> &all, const MovingPoints &moving, double apart_mm, std::size_t most) const;

  const TargetSurface &target_;
  const RegistrationOptions &options_;
  std::size_t refined_;
  ThreadPool *pool_;
  const ProgressFn &progress_;
  double limit_mm_ = 0.0;
};

tl::unexpected<Error> cancelled() { return fail(ErrorCode::cancelled, "the rigid registration was cancelled"); }

void Search::rate(const MovingPoints &moving, std::vector<Fitted> &all, double limit_mm, Feet feet) const {
  inParallel(pool_, all.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      all[i].cost = truncatedCost(target_, moving, all[i].bodyFromMeasured, limit_mm, feet);
  });
  std::stable_sort(all.begin(), all.end(), [](const Fitted &a, const Fitted &b) { return a.cost < b.cost; });
}

void Search::keepDifferent(std::vector<Fitted> &all, const MovingPoints &moving, double apart_mm,
                           std::size_t most) const {
  std::vector<Fitted> out;
  for (const Fitted &one : all) {
    if (out.size() >= most) break;
    if (std::none_of(out.begin(), out.end(), [&](const Fitted &o) {
          return distanceOf(o.bodyFromMeasured, one.bodyFromMeasured, moving.points) < apart_mm;
        }))
      out.push_back(one);
  }
  all = std::move(out);
}

Expected<std::vector<Fitted>> Search::run(const MovingPoints &all, double extent_mm, double from, double to) {
  const auto at = [&](double part) { return from + (to - from) * part; };
  if (!report(at(0.0), "searching positions")) return cancelled();
  const std::size_t n = all.points.size();
  const MovingPoints searched = all.subset(shuffledIndices(n, kSearchPoints));
  std::vector<Fitted> fits;
  for (const Mat4 &m : startsOf(target_, searched, kStarts, pool_)) fits.push_back({m, 0.0});
  if (!report(at(0.4), "refining positions")) return cancelled();

  const MovingPoints coarse = all.subset(shuffledIndices(n, kCoarsePoints));
  const MovingPoints rated = all.subset(shuffledIndices(n, kRatedPoints));
  const double reach = target_.reach_mm(), noise = options_.noise_mm;
  inParallel(pool_, fits.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      fits[i].bodyFromMeasured = refine(target_, coarse, fits[i].bodyFromMeasured, reach, noise, 25, Feet::near);
  });
  const double coarseLimit = std::max(3.0 * noise, 0.35 * reach);
  rate(rated, fits, coarseLimit, Feet::near);
  keepDifferent(fits, coarse, std::max(noise, 0.05 * extent_mm), refined_);
  if (!report(at(0.6), "fitting the surface")) return cancelled();

  const MovingPoints fine = all.subset(shuffledIndices(n, kFinePoints));
  inParallel(pool_, fits.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      fits[i].bodyFromMeasured = refine(target_, fine, fits[i].bodyFromMeasured, coarseLimit, noise, 30, Feet::exact);
  });
  rate(fine, fits, coarseLimit, Feet::exact);
  // The limit follows from the best, and the best from the limit: twice is sufficient.
  for (int i = 0; i < 2; ++i) {
    const double limit = std::max(coarseLimit, reach);
    limit_mm_ =
        3.0 * robustDeviation(distancesOf(target_, fine, fits.front().bodyFromMeasured, limit, Feet::exact), noise);
    rate(fine, fits, limit_mm_, Feet::exact);
  }
  keepDifferent(fits, fine, std::max(noise, 0.05 * extent_mm), refined_);
  if (!report(at(1.0), "fitting the surface")) return cancelled();
  return fits;
}

/// Variances of the motion and how they move the body.
struct Determination {
  double error_mm = 0.0;           ///< rms over the body of all parts of the motion
  double largest_mm = 0.0;         ///< of the least determined part
  Vec3 rotation{}, translation{};  ///< of that part, measured frame: rotation in mm at the arm
};

/// @param independent  number of independent residuals
Determination determine(const TargetSurface &target, const MovingPoints &moving, const Mat4 &m, double limit_mm,
                        double deviation_mm, double independent) {
  const double arm = 0.5 * target.diagonal_mm();
  const Vec3 &centre = target.centre();
  const auto rows = information(target, moving, m, limit_mm, centre, arm);
  Eigen::Matrix<double, 6, 6> matrix;
  for (Eigen::Index r = 0; r < 6; ++r)
    for (Eigen::Index c = 0; c < 6; ++c) matrix(r, c) = rows[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)];
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> eigen(matrix);
  const double perResidual = static_cast<double>(moving.points.size()) / independent;
  Determination out;
  double total = 0.0;
  for (Eigen::Index k = 0; k < 6; ++k) {
    const auto v = eigen.eigenvectors().col(k);
    const double variance =
        deviation_mm * deviation_mm * std::max(1.0, perResidual) / std::max(eigen.eigenvalues()[k], 1e-9);
    const Vec3 rotation{v[0] / arm, v[1] / arm, v[2] / arm}, translation{v[3], v[4], v[5]};
    double squares = 0.0;
    for (const Vec3 &p : target.samples().points) {
      const Vec3 u = cross(rotation, p - centre) + translation;
      squares += dot(u, u);
    }
    const double moved = variance * squares / static_cast<double>(target.samples().points.size());
    total += moved;
    if (std::sqrt(moved) > out.largest_mm) {
      out.largest_mm = std::sqrt(moved);
      const double scale = std::sqrt(variance);
      out.rotation = scale * arm * rotation;
      out.translation = scale * translation;
    }
  }
  out.error_mm = std::sqrt(total);
  return out;
}

/// The motion `m`, measured to body, displaced along a part of the motion so that the body moves by rms `by_mm`.
Mat4 displaced(const TargetSurface &target, const Mat4 &m, const Determination &d, double by_mm) {
  const double arm = 0.5 * target.diagonal_mm(), scale = by_mm / std::max(d.largest_mm, 1e-9);
  return multiply(
      withPoint(rotationOf((scale / arm) * d.rotation), target.centre(), target.centre() + scale * d.translation), m);
}

/// How far the least determined part of the motion is displaced to find other minima near the best: share of the
/// diagonal. Triangles and outliers make the sum of squares uneven.
constexpr double kDisplaced = 0.03;

/// The best of the fits from starts on both sides of a motion along its least determined part.
Mat4 bestNearby(const TargetSurface &target, const MovingPoints &all, const Mat4 &best, const Determination &d,
                double limit_mm, double noise_mm, ThreadPool *pool) {
  const MovingPoints fine = all.subset(shuffledIndices(all.points.size(), kFinePoints));
  std::array<Fitted, 5> fits{};
  inParallel(pool, fits.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const double by_mm = (static_cast<double>(k) - 2.0) * kDisplaced * target.diagonal_mm();
      const Mat4 start = k == 2 ? best : displaced(target, best, d, by_mm);
      fits[k].bodyFromMeasured = k == 2 ? best : refine(target, fine, start, 2.0 * limit_mm, noise_mm, 30, Feet::exact);
      fits[k].cost = truncatedCost(target, fine, fits[k].bodyFromMeasured, limit_mm, Feet::exact);
    }
  });
  return std::min_element(fits.begin(), fits.end(), [](const Fitted &a, const Fitted &b) { return a.cost < b.cost; })
      ->bodyFromMeasured;
}

/// Error of the motion as the points show it: half the difference of the motions of two halves of them, which begin on
/// different sides of the best, as a mean over several divisions, rms over the body.
double errorBetweenHalves(const TargetSurface &target, const MovingPoints &moving, const Mat4 &best,
                          const Determination &d, double limit_mm, double noise_mm, ThreadPool *pool) {
  const std::vector<std::size_t> indices = shuffledIndices(moving.points.size(), kFinePoints);
  constexpr std::size_t kDivisions = 3;
  std::array<Mat4, 2 * kDivisions> motions{};
  inParallel(pool, motions.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      std::vector<std::size_t> half;
      for (std::size_t i = 0; i < indices.size(); ++i)
        if ((i >> (k / 2)) % 2 == k % 2) half.push_back(indices[i]);
      const double by_mm = (k % 2 == 0 ? 1.0 : -1.0) * kDisplaced * target.diagonal_mm();
      motions[k] = geometry::rigidInverse(refine(target, moving.subset(half), displaced(target, best, d, by_mm),
                                                 2.0 * limit_mm, noise_mm, 20, Feet::exact));
    }
  });
  double squares = 0.0;
  for (std::size_t k = 0; k < motions.size(); k += 2) {
    const double apart = distanceOf(motions[k], motions[k + 1], target.samples().points);
    squares += 0.25 * apart * apart / static_cast<double>(kDivisions);
  }
  return std::sqrt(squares);
}

std::string directionText(const Vec3 &v) {
  const double length = std::max(norm(v), 1e-12);
  return fmt::format("({:.2f}, {:.2f}, {:.2f})", v[0] / length, v[1] / length, v[2] / length);
}

Residuals summarise(std::vector<double> distances, double limit_mm) {
  Residuals out;
  out.limit_mm = limit_mm;
  double squares = 0.0, inliers = 0.0;
  for (const double d : distances)
    if (d <= limit_mm) squares += d * d, inliers += 1.0;
  out.rms_mm = inliers > 0.0 ? std::sqrt(squares / inliers) : 0.0;
  out.inlierShare = inliers / static_cast<double>(distances.size());
  std::vector<double> sorted = distances;
  std::sort(sorted.begin(), sorted.end());
  out.p95_mm = sorted[static_cast<std::size_t>(0.95 * static_cast<double>(sorted.size() - 1))];
  out.distance_mm = std::move(distances);
  return out;
}

Residuals residualsAt(const TargetSurface &target, const std::vector<Vec3> &points, const Mat4 &bodyFromMeasured,
                      double limit_mm, ThreadPool *pool) {
  std::vector<double> distances(points.size());
  inParallel(pool, points.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      distances[i] =
          target.closest(transformPoint(bodyFromMeasured, points[i]), std::numeric_limits<double>::infinity()).distance;
  });
  return summarise(std::move(distances), limit_mm);
}

/// Share of the samples of the body near which inliers are.
double coverageOf(const TargetSurface &target, const MovingPoints &moving, const Residuals &after, const Mat4 &m,
                  const std::vector<double> &distances) {
  std::vector<Vec3> inliers;
  for (std::size_t i = 0; i < moving.points.size(); ++i)
    if (distances[i] <= after.limit_mm) inliers.push_back(transformPoint(m, moving.points[i]));
  if (inliers.size() < 2) return 0.0;
  const PointTree tree(inliers);
  std::vector<double> gaps;
  std::array<std::uint32_t, 2> index{};
  std::array<double, 2> squared{};
  for (const Vec3 &p : inliers)
    if (tree.nearest(p, 2, index.data(), squared.data()) == 2) gaps.push_back(std::sqrt(squared[1]));
  std::nth_element(gaps.begin(), gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2), gaps.end());
  // The nearest of random points is half a mean spacing away, and holes reach over two.
  const double near = std::max(2.5 * gaps[gaps.size() / 2], after.limit_mm);
  double covered = 0.0;
  for (const Vec3 &p : target.samples().points)
    if (tree.nearest(p, 1, index.data(), squared.data()) == 1 && squared[0] <= near * near) covered += 1.0;
  return covered / static_cast<double>(target.samples().points.size());
}

/// Of the nearer half of the points, which outliers do not change.
double rmsOfNearerHalf(const MovingPoints &moving, const Mat4 &m, const TargetSurface &target) {
  std::vector<double> distances = distancesOf(target, moving, m, target.diagonal_mm(), Feet::exact);
  std::sort(distances.begin(), distances.end());
  const std::size_t half = (distances.size() + 1) / 2;
  double squares = 0.0;
  for (std::size_t i = 0; i < half; ++i) squares += distances[i] * distances[i];
  return std::sqrt(squares / static_cast<double>(half));
}

MovingPoints mirrored(MovingPoints points) {
  for (Vec3 &p : points.points) p[0] = -p[0];
  for (Vec3 &n : points.normals) n[0] = -n[0];
  points.pairs.clear();
  return points;
}

/// The whole of registerRigid() after the checks.
class Registration {
 public:
  Registration(const TargetSurface &target, CheckedInput &input, const RegistrationOptions &options, ThreadPool *pool,
               const ProgressFn &progress)
      : target_(target), input_(input), options_(options), pool_(pool), progress_(progress) {}

  [[nodiscard]] Expected<RigidRegistration> run(const std::vector<Vec3> &allPoints);

 private:
  void addCandidates(const std::vector<Fitted> &fits, const Search &search);
  void judgeDetermination(const Search &search);
  void judgeResidual(const Search &search);
  [[nodiscard]] Expected<void> judgeMirrored(const Search &search);
  void warn(std::string sentence) { out_.warnings.push_back(std::move(sentence)); }
  [[nodiscard]] bool isExplained(const Search &search) const {
    return search.deviation_mm() <= kExplained * options_.noise_mm;
  }
  /// Number of independent residuals.
  [[nodiscard]] double independent(const Search &search) const {
    const double inliers = out_.after.inlierShare * static_cast<double>(input_.points.points.size());
    return std::max(6.0, isExplained(search) ? inliers : std::min(inliers, kIndependent));
  }

  const TargetSurface &target_;
  CheckedInput &input_;
  const RegistrationOptions &options_;
  ThreadPool *pool_;
  const ProgressFn &progress_;
  RigidRegistration out_;
  Mat4 best_ = kIdentity4;  ///< measured to body
  bool isAmbiguous_ = false, isRefused_ = false;
};

// The difference of two mean squares of n independent residuals has a deviation of about sqrt(2/n) of their variance.
void Registration::addCandidates(const std::vector<Fitted> &fits, const Search &search) {
  const double variance = search.deviation_mm() * search.deviation_mm();
  const double tolerance =
      4.0 * variance * std::max(out_.after.inlierShare, 0.1) * std::sqrt(2.0 / independent(search));
  const double apart = std::max(3.0 * options_.noise_mm, 0.05 * target_.diagonal_mm());
  for (const Fitted &fit : fits) {
    if (out_.candidates.size() >= options_.mostCandidates) break;
    if (fit.cost > fits.front().cost + tolerance) continue;
    const Mat4 motion = geometry::rigidInverse(fit.bodyFromMeasured);
    if (std::any_of(out_.candidates.begin(), out_.candidates.end(), [&](const RegistrationCandidate &other) {
          return distanceOf(other.measuredFromBody, motion, target_.samples().points) < apart;
        }))
      continue;
    const Residuals residuals =
        residualsAt(target_, input_.points.points, fit.bodyFromMeasured, search.limit_mm(), pool_);
    out_.candidates.push_back({motion, residuals.rms_mm, residuals.inlierShare});
  }
  if (out_.candidates.size() < 2) return;
  isAmbiguous_ = true;
  warn(fmt::format("{}{} motions fit the points equally well: measure more of the surface, or landmarks",
                   out_.candidates.size() == options_.mostCandidates ? "at least " : "", out_.candidates.size()));
}

void Registration::judgeDetermination(const Search &search) {
  const Determination d =
      determine(target_, input_.points, best_, search.limit_mm(), search.deviation_mm(), independent(search));
  const double halves =
      errorBetweenHalves(target_, input_.points, best_, d, search.limit_mm(), options_.noise_mm, pool_);
  out_.motionError_mm = std::min(target_.diagonal_mm(), std::max(d.error_mm, halves));
  const double accepted = std::max(3.0 * options_.noise_mm, 0.05 * target_.diagonal_mm());
  if (std::max(d.largest_mm, halves) <= accepted) return;
  isAmbiguous_ = true;
  if (d.largest_mm <= accepted)
    return warn(
        fmt::format("two halves of the points give motions that move the body by {:.3g} mm differently; "
                    "accepted: {:.3g} mm",
                    2.0 * halves, 2.0 * accepted));
  const Mat4 back = out_.measuredFromBody;
  const bool isRotation = norm(d.rotation) > norm(d.translation);
  warn(fmt::format("the points do not determine {} {}: it may move the body by {:.3g} mm; accepted: {:.3g} mm",
                   isRotation ? "the rotation about the axis" : "the translation along",
                   directionText(turned(back, isRotation ? d.rotation : d.translation)),
                   std::min(d.largest_mm, target_.diagonal_mm()), accepted));
}

void Registration::judgeResidual(const Search &search) {
  const double noise = options_.noise_mm, limit = std::max(kRefusedNoise * noise, kRefusedExtent * input_.extent_mm);
  if (out_.after.inlierShare < kFewestInliers) {
    isRefused_ = true;
    warn(fmt::format("only {:.0f} % of the points are within {:.3g} mm of the moved surface; accepted: {:.0f} %",
                     100.0 * out_.after.inlierShare, out_.after.limit_mm, 100.0 * kFewestInliers));
  } else if (search.deviation_mm() > limit) {
    isRefused_ = true;
    warn(
        fmt::format("the residual of {:.3g} mm is larger than {:.3g} mm, and the noise is {:g} mm: the points are of "
                    "another body, or in another unit, or the body has changed too much for a rigid motion",
                    out_.after.rms_mm, limit, noise));
  } else if (!isExplained(search)) {
    warn(
        fmt::format("the residual of {:.3g} mm is {:.1f} times the noise of {:g} mm: the body has changed its shape, "
                    "or the points are of another body",
                    out_.after.rms_mm, out_.after.rms_mm / noise, noise));
  }
  if (!isRefused_ && out_.after.inlierShare < 0.9)
    warn(fmt::format("{:.0f} % of the points are farther than {:.3g} mm from the moved surface and were left out",
                     100.0 * (1.0 - out_.after.inlierShare), out_.after.limit_mm));
}

Expected<void> Registration::judgeMirrored(const Search &search) {
  if (isExplained(search) && out_.after.inlierShare >= kFewestInliers) return {};
  Search other(target_, options_, kRefinedMirrored, pool_, progress_);
  const MovingPoints mirror = mirrored(input_.points);
  const auto found = other.run(mirror, input_.extent_mm, 0.55, 0.95);
  if (!found) return tl::unexpected(found.error());
  MovingPoints plain = input_.points;
  plain.pairs.clear();
  // Both with the same limit, so that outliers count equally. Many of them hide a difference that the nearer half
  // shows.
  const double limit = std::max(search.limit_mm(), other.limit_mm());
  const double own = std::sqrt(truncatedCost(target_, plain, best_, limit, Feet::exact));
  const double its = std::sqrt(truncatedCost(target_, mirror, found->front().bodyFromMeasured, limit, Feet::exact));
  const double ownHalf = rmsOfNearerHalf(plain, best_, target_);
  const double itsHalf = rmsOfNearerHalf(mirror, found->front().bodyFromMeasured, target_);
  constexpr double kMuchBetter = 0.5;
  if (!(its < kMuchBetter * own || itsHalf < kMuchBetter * ownHalf)) return {};
  isRefused_ = true;
  warn(
      fmt::format("mirrored, the points fit the surface with {:.3g} mm instead of {:.3g} mm: one of their axes has "
                  "the wrong sign; accepted: LPS in mm",
                  other.deviation_mm(), search.deviation_mm()));
  return {};
}

Expected<RigidRegistration> Registration::run(const std::vector<Vec3> &allPoints) {
  Search search(target_, options_, kRefined, pool_, progress_);
  auto fits = search.run(input_.points, input_.extent_mm, 0.05, 0.5);
  if (!fits) return tl::unexpected(fits.error());
  const Determination weakest = determine(target_, input_.points, fits->front().bodyFromMeasured, search.limit_mm(),
                                          search.deviation_mm(), static_cast<double>(input_.points.points.size()));
  fits->front().bodyFromMeasured = bestNearby(target_, input_.points, fits->front().bodyFromMeasured, weakest,
                                              search.limit_mm(), options_.noise_mm, pool_);
  if (progress_ && !progress_(0.55, "estimating the error")) return cancelled();
  best_ = fits->front().bodyFromMeasured;
  out_.warnings = input_.warnings;
  out_.measuredFromBody = geometry::rigidInverse(best_);
  out_.before = residualsAt(target_, allPoints, kIdentity4, search.limit_mm(), pool_);
  out_.after = residualsAt(target_, allPoints, best_, search.limit_mm(), pool_);
  const std::vector<double> distances =
      distancesOf(target_, input_.points, best_, 2.0 * search.limit_mm(), Feet::exact);
  out_.coverage = coverageOf(target_, input_.points, out_.after, best_, distances);
  judgeResidual(search);
  addCandidates(*fits, search);
  judgeDetermination(search);
  if (auto good = judgeMirrored(search); !good) return tl::unexpected(good.error());
  out_.verdict = isRefused_             ? RegistrationVerdict::refused
                 : isAmbiguous_         ? RegistrationVerdict::ambiguous
                 : !isExplained(search) ? RegistrationVerdict::unexplained
                                        : RegistrationVerdict::found;
  return std::move(out_);
}

}  // namespace

const char *nameOf(RegistrationVerdict verdict) {
  switch (verdict) {
    case RegistrationVerdict::found: return "found";
    case RegistrationVerdict::unexplained: return "unexplained";
    case RegistrationVerdict::ambiguous: return "ambiguous";
    case RegistrationVerdict::refused: break;
  }
  return "refused";
}

Expected<RigidRegistration> registerRigid(const geometry::TriangleMesh &body, const MeasuredSurface &measured,
                                          const RegistrationOptions &options, ThreadPool *pool,
                                          const ProgressFn &progress) {
  if (progress && !progress(0.0, "preparing the surface")) return cancelled();
  auto target = TargetSurface::of(body);
  if (!target) return tl::unexpected(target.error());
  target->fillGrid(pool);
  auto input = checkInput(*target, measured, options);
  if (!input) return tl::unexpected(input.error());
  return Registration(*target, *input, options, pool, progress).run(measured.points_mm);
}

Expected<Residuals> residualsOf(const geometry::TriangleMesh &body, const std::vector<Vec3> &points_mm,
                                const Mat4 &measuredFromBody, double limit_mm, ThreadPool *pool) {
  if (points_mm.empty()) return fail(ErrorCode::usage, "no measured points; accepted: one at least");
  if (auto good = checkFinite(points_mm, "measured point"); !good) return tl::unexpected(good.error());
  const auto target = TargetSurface::of(body);
  if (!target) return tl::unexpected(target.error());
  if (points_mm.size() >= kFewestSurfacePoints)
    if (auto good = checkExtent(medianExtent(points_mm), *target); !good) return tl::unexpected(good.error());
  return residualsAt(*target, points_mm, geometry::rigidInverse(measuredFromBody), limit_mm, pool);
}

}  // namespace c3de::registration
