// SPDX-License-Identifier: Apache-2.0
// Predicts the error and cost of a body for other samplings, and chooses the cheapest sampling that meets a target.
#pragma once

#include <optional>

#include "pointbased/constitution.h"
#include "pointbased/elastic_foundation.h"
#include "pointbased/machine_speed.h"
#include "pointbased/rest_state.h"
#include "pointbased/stop_request.h"
#include "pointbased/surface.h"
#include "pointbased/world_settings.h"

namespace pointbased {

/// A body to be simulated, without its sampling.
struct AccuracyProblem {
  const BodyShape &shape;
  const BodyRecipe &recipe;
  const Constitution &constitution;
  Foundation foundation{};
  Vec3 gravity = Vec3::Zero();  ///< m/s²
};

/// Static solution of the body under its loads with few phyxels and the linear law: the solution for small loads,
/// scaled up.
struct TrialSolution {
  double spacing = 0.0;  ///< m
  std::size_t phyxels = 0, points = 0, contacts = 0;
  std::size_t quadraticPoints = 0;  ///< points with quadratic functions
  double stableStep = 0.0;          ///< s, explicit, at rest
  std::vector<Vec3> displacements;  ///< [samples] displacements of points of the skin, m
  double largest = 0.0;             ///< m, of `displacements`
};

/// Skin points at which solutions are compared: about `count`, distributed evenly over the area. Points with prescribed
/// motion are left out. World, m.
[[nodiscard]] SurfacePoints skinSamples(const Surface &surface, std::span<const Fix> fixes, std::size_t count);
/// Displacements of these points on a body, m.
[[nodiscard]] std::vector<Vec3> displacementsAt(const RestState &rest, std::span<const Vec3> displacements,
                                                const SurfacePoints &samples, const ParallelFor &parallelFor);

/// Solves with the sampling of the recipe.
/// Errors: those of buildRestState(); no equilibrium.
[[nodiscard]] Result<TrialSolution> solveTrial(const AccuracyProblem &problem, const SurfacePoints &samples,
                                               const ParallelFor &parallelFor, const StopRequest *stop = nullptr);
/// Solves with cells of uniform size. Same errors.
/// @param count  target number of phyxels
[[nodiscard]] Result<TrialSolution> solveTrial(const AccuracyProblem &problem, std::size_t count,
                                               const SurfacePoints &samples, const ParallelFor &parallelFor,
                                               const StopRequest *stop = nullptr);

/// Difference of two solutions on the skin, m: the 95th percentile over the samples.
[[nodiscard]] double skinDifference(const TrialSolution &a, const TrialSolution &b);

/// Result of the trial solutions of a body.
struct AccuracySurvey {
  TrialSolution coarse, fine;
  LatticeOrder order = LatticeOrder::linear;  ///< of the trials, and of the samplings that are predicted from them
  double volume = 0.0, area = 0.0;            ///< m³, m²
  double largest = 0.0;                       ///< m, displacement under the loads
  double difference = 0.0;                    ///< skinDifference() of the two, as a fraction of `largest`
  /// skinDifference() of the coarse trial and of the same cells with quadratic functions, as a fraction of `largest`:
  /// the error due to cells oblique to the body. 0 if the trials are already quadratic, if no cell is quadratic because
  /// the lattice fits the body, with jitter, or without a solution
  double orderDifference = 0.0;
  Vec3 worst = Vec3::Zero();  ///< world, m, at rest: skin sample with the largest difference
  /// Supports, loads or both are missing: the lowest tenth of the body was held, and its weight was the load
  bool supposed = false;

  [[nodiscard]] double phyxelsAt(double spacing) const;   ///< V/d³ inside, plus the number per area of the fine trial
  [[nodiscard]] double spacingFor(double phyxels) const;  ///< m, inverse of phyxelsAt()
};

/// Computes trial solutions, in some tenths of a second: with a seventh and with two fifths of automaticCount(), and
/// the first of them with quadratic functions too.
/// Errors: those of solveTrial(); trials that have nothing in common.
[[nodiscard]] Result<AccuracySurvey> surveyAccuracy(const AccuracyProblem &problem, const ParallelFor &parallelFor,
                                                    const StopRequest *stop = nullptr);

/// Error of the displacements of the skin at rest, 95th percentile, as a fraction of the largest displacement.
struct ErrorPrediction {
  double share = 0.0;            ///< expected: half of all bodies are below
  double low = 0.0, high = 0.0;  ///< nine of ten are between these
  double likely = 0.0;           ///< five of six are below
};

/// Uses a model of each order, fitted to random bodies (bench_accuracy dial --fit):
/// log e = a + b log Δ + p log(spacing / spacing of the fine trial), Δ² = difference² + (0.5 orderDifference)².
[[nodiscard]] ErrorPrediction predictError(const AccuracySurvey &survey, double spacing);

/// Conditions of a cost prediction other than the body.
struct CostSetting {
  WorldSettings world;
  bool contact = false;     ///< walls or obstacles
  bool touches = false;     ///< there are other bodies that it may touch
  std::size_t surfels = 0;  ///< vertices of the displayed skin
  MachineSpeed speed;
};

/// ms per frame of 1/60 s of simulated time; for a quasi-static solution, of the whole solution.
[[nodiscard]] double predictCost(const AccuracySurvey &survey, const Constitution &constitution,
                                 const CostSetting &setting, double spacing);

/// Fraction of a body's skin that is assumed to touch other bodies during contact.
inline constexpr double kTouched = 0.2;
/// Additional ms per frame while kTouched of the skin is in contact; 0: contact is impossible, or the solution is
/// quasi-static.
[[nodiscard]] double predictTouching(const AccuracySurvey &survey, const Constitution &constitution,
                                     const CostSetting &setting, double spacing);

/// Measured wall-clock time per frame of a body, ms, 95th percentile. The body starts at rest in its world, without
/// other bodies, and runs for half a simulated second or half a second of computing, because a bending body takes
/// shorter steps. 0: it cannot be stepped, is quasi-static, or was cancelled.
[[nodiscard]] double measureFrame(const Body &body, const WorldSettings &world, std::span<const Obstacle> obstacles,
                                  const ParallelFor &parallelFor, const StopRequest *stop);

/// Accuracy target of a body; one of these kinds.
struct AccuracyTarget {
  enum class Kind {
    /// error at most 5 % within 16 ms a frame, but at least automaticCount() phyxels, which suffice for grabbing as
    /// well. value: number of bodies that share this time
    standard,
    share,   ///< value: fraction of the largest displacement
    length,  ///< value: m
    budget   ///< value: s per frame of 1/60 s
  };
  Kind kind = Kind::standard;
  double value = 0.0;
};

/// The cheapest sampling for a target.
struct SamplingChoice {
  LatticeOrder order = LatticeOrder::linear;  ///< of the functions of cells
  double spacing = 0.0;                       ///< m
  std::size_t count = 0;
  ErrorPrediction error;
  double largest = 0.0;   ///< m, to which error.share refers
  double frame_ms = 0.0;  ///< predictCost() or measureFrame()
  /// predictTouching(); a budget includes it
  double touching_ms = 0.0;
  bool isInTime = true;  ///< within the time of the target, or of the default; true: it has none
  std::string unmet;     ///< empty: the target is met; else the reason, and what is possible
};

[[nodiscard]] SamplingChoice chooseSampling(const AccuracySurvey &survey, const Constitution &constitution,
                                            const CostSetting &setting, const AccuracyTarget &target);

/// Whether trials of second order are worth their time: suitsSecondOrder(), and one of
/// - the target is a budget;
/// - first order does not meet the target;
/// - first order needs more phyxels than the fine trial; without a target, than automaticCount().
/// @param first  of a survey of first order
[[nodiscard]] bool mayNeedSecondOrder(const AccuracySurvey &survey, const SamplingChoice &first,
                                      const Constitution &constitution, const AccuracyTarget &target);
/// Whether second order is preferable:
/// - only it meets the target, or both do and it takes less than 0.8 of the time;
/// - for a budget, or if neither meets the target: only it is within the time, or both are and its error is less than
///   0.8 of that of first order; if neither is within the time, it is faster.
[[nodiscard]] bool prefersSecondOrder(const SamplingChoice &first, const SamplingChoice &second,
                                      const AccuracyTarget &target);

/// Whether second order is worthwhile for this material: there is one, it neither flows nor relaxes, and a vectorised
/// kernel evaluates it.
[[nodiscard]] bool suitsSecondOrder(const Constitution &constitution);
/// Whether second order is worthwhile when the spacing or the count is specified: suitsSecondOrder(), the cells are
/// uniform, the body is elongated or flat, and its surface is oblique to the lattice.
/// - Elongated or flat: the longest edge of the box with the same second moments is at least four times the shortest.
///   Of several connected parts the largest counts.
/// - Oblique: the misalignment (latticeDirection() in src/discretisation/lattice) exceeds 0.05, for example with all
///   faces at 10 degrees, or a quarter of them round.
/// The spacing has no influence, so that a series of samplings has the same order throughout.
[[nodiscard]] bool suggestsSecondOrder(const BodyShape &shape, const BodyRecipe &recipe,
                                       const Constitution &constitution);

inline constexpr double kFrame = 1.0 / 60.0;      ///< s
inline constexpr double kStandardError = 0.05;    ///< of AccuracyTarget::Kind::standard
inline constexpr double kStandardBudget = 0.016;  ///< s
/// Fraction of a budget that is used: strained bodies take shorter steps, and frame times vary.
inline constexpr double kBudgetToUse = 0.7;
/// Range of the chosen phyxel counts.
inline constexpr double kMinChosenPhyxels = 50.0, kMaxChosenPhyxels = 100'000.0;

}  // namespace pointbased
