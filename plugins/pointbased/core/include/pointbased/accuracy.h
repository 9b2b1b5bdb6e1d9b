// SPDX-License-Identifier: Apache-2.0
// How far off a body will be at a sampling that it does not have yet, what that will cost, and the cheapest sampling
// that does what is wished.
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

/// A body as it is to be simulated, but for its sampling.
struct AccuracyProblem {
  const BodyShape &shape;
  const BodyRecipe &recipe;
  const Constitution &constitution;
  Foundation foundation{};
  Vec3 gravity = Vec3::Zero();  ///< m/s²
};

/// The body at rest under its loads, on few phyxels, by the linear law: what it is at small loads, scaled up.
struct TrialSolution {
  double spacing = 0.0;  ///< m
  std::size_t phyxels = 0, points = 0, contacts = 0;
  double stableStep = 0.0;  ///< s, at rest
  std::vector<Vec3> ways;   ///< [samples] displacements of points of the skin, m
  double largest = 0.0;     ///< m, of `ways`
};

/// Points of the skin at which solutions are compared: about `count` of them, evenly over its area; those left out
/// whose motion is prescribed. World, m.
[[nodiscard]] SurfacePoints skinSamples(const Surface &surface, std::span<const Fix> fixes, std::size_t count);
/// Displacements of such points of a body, m.
[[nodiscard]] std::vector<Vec3> displacementsAt(const RestState &rest, std::span<const Vec3> displacements,
                                                const SurfacePoints &samples, const ParallelFor &parallelFor);

/// With the sampling of its recipe. Errors: those of buildRestState(); no equilibrium.
[[nodiscard]] Result<TrialSolution> solveTrial(const AccuracyProblem &problem, const SurfacePoints &samples,
                                               const ParallelFor &parallelFor, const StopRequest *stop = nullptr);
/// With cells of one size. Errors likewise.
/// @param count  wanted phyxels
[[nodiscard]] Result<TrialSolution> solveTrial(const AccuracyProblem &problem, std::size_t count,
                                               const SurfacePoints &samples, const ParallelFor &parallelFor,
                                               const StopRequest *stop = nullptr);

/// Difference of two solutions on the skin that 95 % of its samples stay below, m.
[[nodiscard]] double skinDifference(const TrialSolution &a, const TrialSolution &b);

/// What two trials tell of a body.
struct AccuracySurvey {
  TrialSolution coarse, fine;
  double volume = 0.0, area = 0.0;  ///< m³, m²
  double largest = 0.0;             ///< m, displacement under the loads
  double difference = 0.0;          ///< skinDifference() of both, part of `largest`
  Vec3 worst = Vec3::Zero();        ///< world, m, at rest: the sample of the skin at which they differ most
  /// Nothing holds the body, or nothing loads it, or both: its lowest tenth was held, its weight was its load
  bool supposed = false;

  [[nodiscard]] double phyxelsAt(double spacing) const;   ///< V/d³ inside, and as many per area as in the fine trial
  [[nodiscard]] double spacingFor(double phyxels) const;  ///< m, the inverse
};

/// Two trials, some tenths of a second: of a seventh and of two fifths of automaticCount().
/// Errors: those of solveTrial(); trials that have nothing in common.
[[nodiscard]] Result<AccuracySurvey> surveyAccuracy(const AccuracyProblem &problem, const ParallelFor &parallelFor,
                                                    const StopRequest *stop = nullptr);

/// The error of displacements on the skin at rest, of 95 % of it, as part of the largest displacement.
struct ErrorPrediction {
  double share = 0.0;            ///< expected: half of all bodies are better
  double low = 0.0, high = 0.0;  ///< nine of ten are between
  double likely = 0.0;           ///< five of six are better
};

/// By a model that was fitted to random bodies (bench_dial --fit): from the difference of the trials and the way from
/// their spacing to the one asked for, log e = a + b log difference + p log(spacing / spacing of the fine trial).
[[nodiscard]] ErrorPrediction predictError(const AccuracySurvey &survey, double spacing);

/// What costs are reckoned with beside the body.
struct CostSetting {
  WorldSettings world;
  bool contact = false;     ///< walls or obstacles
  bool touches = false;     ///< there are other bodies that it may touch
  std::size_t surfels = 0;  ///< vertices of the skin that is drawn
  MachineSpeed speed;
};

/// ms that a frame of 1/60 s of simulated time takes; of a quasi-static solution the whole.
[[nodiscard]] double predictCost(const AccuracySurvey &survey, const Constitution &constitution,
                                 const CostSetting &setting, double spacing);

/// Part of a body's skin that is reckoned to touch other bodies, where they do.
inline constexpr double kTouched = 0.2;
/// ms that such a frame takes longer while kTouched of the skin touches; 0: nothing can be touched, or it is a
/// quasi-static solution.
[[nodiscard]] double predictTouching(const AccuracySurvey &survey, const Constitution &constitution,
                                     const CostSetting &setting, double spacing);

/// Wall-clock time that 95 % of the frames of a body stay below, ms: from rest in its world, by itself, for half a
/// simulated second or half a second of computing, because a body that bends takes shorter steps. 0: it cannot be
/// stepped, is quasi-static, or was ended by the request.
[[nodiscard]] double measureFrame(const Body &body, const WorldSettings &world, std::span<const Obstacle> obstacles,
                                  const ParallelFor &parallelFor, const StopRequest *stop);

/// What somebody wants of the accuracy of a body; one of them.
struct AccuracyWish {
  enum class Kind {
    /// error at most 5 % within 16 ms a frame, but at least automaticCount() phyxels, which serve hands as well; value:
    /// how many bodies share that time
    standard,
    share,   ///< value: of the largest displacement
    length,  ///< value: m
    budget   ///< value: s that a frame of 1/60 s may take
  };
  Kind kind = Kind::standard;
  double value = 0.0;
};

/// The cheapest sampling for a wish.
struct SamplingChoice {
  double spacing = 0.0;  ///< m
  std::size_t count = 0;
  ErrorPrediction error;
  double largest = 0.0;   ///< m, what error.share is of
  double frame_ms = 0.0;  ///< predictCost() or measureFrame()
  /// predictTouching(); a budget is for such frames too
  double touching_ms = 0.0;
  std::string unmet;  ///< empty: the wish is met; else why not, and what could be had
};

[[nodiscard]] SamplingChoice chooseSampling(const AccuracySurvey &survey, const Constitution &constitution,
                                            const CostSetting &setting, const AccuracyWish &wish);

inline constexpr double kFrame = 1.0 / 60.0;      ///< s
inline constexpr double kStandardError = 0.05;    ///< of AccuracyWish::Kind::standard
inline constexpr double kStandardBudget = 0.016;  ///< s
/// Part of a budget that is used: strained bodies take shorter steps, and frames scatter.
inline constexpr double kBudgetToUse = 0.7;
/// Between these it chooses.
inline constexpr double kFewestPhyxelsOfDial = 50.0, kMostPhyxelsOfDial = 100'000.0;

}  // namespace pointbased
