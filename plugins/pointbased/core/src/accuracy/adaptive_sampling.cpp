// SPDX-License-Identifier: Apache-2.0
#include "pointbased/adaptive_sampling.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "accuracy/trial_solution.h"
#include "base/number_text.h"
#include "forces/point_loops.h"
#include "pointbased/error_estimate.h"

namespace pointbased {
namespace {

constexpr double kBasePart = 0.6;  // of the wanted phyxels, before cells are halved
// bench_dial --adaptive, 24 random bodies: from here on the error is smaller than that of as many cells of one size.
constexpr double kLeastShare = 0.72;
constexpr double kStepOfCells = 0.8;  // stable steps of lattices, in edges over the speed of sound
// Of the trial's explicit step: cells of the material that decides it ask for half of it when they are halved, and are
// not to be left out where that is a little more than kStepOfCells.
constexpr double kShortestStep = 0.35;

using Place = FinerCells::Place;

struct PlaceHash {
  std::size_t operator()(const Place &p) const {
    return static_cast<std::size_t>((std::uint64_t(std::uint32_t(p[0])) * 73856093u) ^
                                    (std::uint64_t(std::uint32_t(p[1])) * 19349663u << 16) ^
                                    (std::uint64_t(std::uint32_t(p[2])) * 83492791u << 32));
  }
};

struct CellError {
  Place at{};
  double error = 0.0;   // J
  double volume = 0.0;  // m³, of the body in it
  double speed = 0.0;   // m/s, of sound in its stiffest material
};

/// The coarsest cells of a lattice that hold evaluation points, with what these err, worst first.
std::vector<CellError> cellErrors(const Body &body, std::span<const double> errors) {
  const RestState &rest = body.rest();
  const Mat3 inverse = rest.stencils.axes.transpose();
  std::unordered_map<Place, std::size_t, PlaceHash> numbers;
  std::vector<CellError> cells;
  for (std::size_t q = 0; q < rest.pointCount(); ++q) {
    const Vec3 local = inverse * (rest.pointCentres[q] - rest.latticeCorner) / rest.spacing;
    Place at{};
    for (int a = 0; a < 3; ++a) at[static_cast<std::size_t>(a)] = static_cast<std::int32_t>(std::floor(local[a]));
    const auto [found, isNew] = numbers.try_emplace(at, cells.size());
    if (isNew) cells.push_back({at});
    CellError &cell = cells[found->second];
    const Material &material = detail::materialOfPoint(body.constitution(), rest.stencils, q);
    cell.error += errors[q];
    cell.volume += rest.stencils.volumes[q];
    cell.speed = std::max(cell.speed, std::sqrt(material.waveModulus() / material.restDensity));
  }
  std::sort(cells.begin(), cells.end(), [](const CellError &a, const CellError &b) {
    return a.error != b.error ? a.error > b.error : a.at < b.at;
  });
  return cells;
}

/// How many of the cells, from the first on, make about so many phyxels more when they are halved. Corners in the
/// middle of edges and faces are phyxels where all cells around are halved; of cut cells only some of the eight hold
/// anything.
std::size_t halvedFor(std::span<const CellError> cells, double edge, double more) {
  std::unordered_map<Place, std::size_t, PlaceHash> order;
  for (std::size_t i = 0; i < cells.size(); ++i) order.emplace(cells[i].at, i);
  // A corner belongs to the last of the cells around it.
  std::vector<double> added(cells.size(), 0.0);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const double filled = std::min(1.0, 2.0 * cells[i].volume / (edge * edge * edge));
    for (int c = 0; c < 27; ++c) {
      const Place side{c % 3 - 1, c / 3 % 3 - 1, c / 9 - 1};
      if (side[0] != 0 && side[1] != 0 && side[2] != 0) continue;
      bool isLast = true;
      for (int n = 1; n < 8 && isLast; ++n) {
        Place beside = cells[i].at;
        bool touches = true;
        for (std::size_t a = 0; a < 3; ++a) {
          if ((n >> a & 1) == 0) continue;
          touches = touches && side[a] != 0;
          beside[a] += side[a];
        }
        if (!touches) continue;
        if (const auto other = order.find(beside); other != order.end()) isLast = other->second < i;
      }
      if (isLast) added[i] += filled;
    }
  }
  double sum = 0.0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    sum += added[i];
    if (sum > more) return i;
  }
  return cells.size();
}

FinerCells finerCells(const RestState &rest, std::span<const CellError> halved) {
  FinerCells out;
  out.corner = rest.origin + rest.latticeCorner;
  out.axes = rest.stencils.axes;
  out.edge = rest.spacing;
  out.spacing = 0.5 * rest.spacing;
  for (const CellError &cell : halved) out.places.push_back(cell.at);
  std::sort(out.places.begin(), out.places.end());
  return out;
}

}  // namespace

Result<AdaptiveSampling> adaptSampling(const AccuracyProblem &problem, bool isExplicit, const ParallelFor &parallelFor,
                                       const StopRequest *stop) {
  AdaptiveSampling out;
  out.sampling = problem.recipe.sampling;
  BodyRecipe recipe = problem.recipe;
  const bool isCount = !(recipe.sampling.spacing > 0.0);
  if (isCount)
    recipe.sampling.count = std::max<std::size_t>(
        1, static_cast<std::size_t>(std::lround(kBasePart * static_cast<double>(recipe.sampling.count))));
  const auto solved = detail::solvedTrial(
      {problem.shape, recipe, problem.constitution, problem.foundation, problem.gravity}, parallelFor, stop);
  if (!solved) return tl::unexpected(solved.error());
  Body &trial = **solved;
  const RestState &rest = trial.rest();
  trial.computeGradients(parallelFor);
  ErrorScratch scratch;
  (void)estimateError(trial, nullptr, scratch, parallelFor);

  std::vector<CellError> cells = cellErrors(trial, scratch.errors);
  double all = 0.0, worst = 0.0;
  for (const CellError &cell : cells) all += cell.error;
  out.cells = cells.size();
  if (isExplicit) {
    const double step = kShortestStep * trial.stableStepAtRest();
    std::erase_if(cells, [&](const CellError &cell) { return kStepOfCells * 0.5 * rest.spacing < step * cell.speed; });
  }
  double left = 0.0;
  for (const CellError &cell : cells) left += cell.error;
  const auto phyxels = static_cast<double>(rest.phyxelCount());
  const double wanted = isCount ? static_cast<double>(out.sampling.count) : phyxels / kBasePart;
  const std::size_t halved = halvedFor(cells, rest.spacing, wanted - phyxels);
  for (std::size_t i = 0; i < halved; ++i) worst += cells[i].error;
  out.share = all > 0.0 ? worst / all : 0.0;
  if (halved == 0 || !(out.share >= kLeastShare)) {
    const auto percent = [](double share) { return detail::number(100.0 * share, 2) + " %"; };
    out.uniform =
        left < kLeastShare * all
            ? "most of its error arises in cells of stiff material, whose halves would ask for explicit steps "
              "of about a third the length; solver.integrator = \"quasistatic\" or \"implicit\" has none"
            : "its error arises too evenly for that: " + percent(out.share) + " of it in " +
                  percent(static_cast<double>(halved) / static_cast<double>(out.cells)) + " of the cells; " +
                  percent(kLeastShare) + " are needed";
    return out;
  }
  out.halved = halved;
  out.sampling.spacing = rest.spacing;
  out.sampling.finer = finerCells(rest, std::span(cells).first(halved));
  return out;
}

}  // namespace pointbased
