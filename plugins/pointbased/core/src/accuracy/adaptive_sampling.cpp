// SPDX-License-Identifier: Apache-2.0
#include "pointbased/adaptive_sampling.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "accuracy/trial_solution.h"
#include "base/number_text.h"
#include "pointbased/error_estimate.h"

namespace pointbased {
namespace {

constexpr double kBasePart = 0.6;  // of the requested phyxels, before cells are halved
// Least share of the error in halved cells. From here on the error is smaller than that of the same number of cells of
// one size (bench_accuracy dial --adaptive, 24 random bodies).
constexpr double kMinShare = 0.72;

using Place = FinerCells::Place;

struct CellError {
  Place at{};
  double error = 0.0;   // J
  double volume = 0.0;  // m³, of the body in the cell
};

/// The coarsest cells of a lattice that contain evaluation points, with their errors, worst first.
std::vector<CellError> cellErrors(const Body &body, const FinerCells &lattice, std::span<const double> errors) {
  const RestState &rest = body.rest();
  std::map<Place, std::size_t> numbers;
  std::vector<CellError> cells;
  for (std::size_t q = 0; q < rest.pointCount(); ++q) {
    const Place at = lattice.placeOf(rest.origin + rest.pointCentres[q]);
    const auto [found, isNew] = numbers.try_emplace(at, cells.size());
    if (isNew) cells.push_back({at});
    CellError &cell = cells[found->second];
    cell.error += errors[q];
    cell.volume += rest.stencils.volumes[q];
  }
  std::sort(cells.begin(), cells.end(), [](const CellError &a, const CellError &b) {
    return a.error != b.error ? a.error > b.error : a.at < b.at;
  });
  return cells;
}

/// Number of cells, from the first on, whose halving adds about `more` phyxels. Midpoints of edges and faces become
/// phyxels if all cells around are halved. Of the eight parts of a cut cell only some contain material.
std::size_t halvedFor(std::span<const CellError> cells, double edge, double more) {
  std::map<Place, std::size_t> order;
  for (std::size_t i = 0; i < cells.size(); ++i) order.emplace(cells[i].at, i);
  // A corner is counted for the last of the cells around it.
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

/// The coarsest cells of a lattice, none of them halved yet.
FinerCells cellsOf(const RestState &rest) {
  return {rest.origin + rest.latticeCorner, rest.stencils.axes, rest.spacing, {}, 0.5 * rest.spacing};
}

}  // namespace

Result<AdaptiveSampling> adaptSampling(const AccuracyProblem &problem, const ParallelFor &parallelFor,
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

  FinerCells finer = cellsOf(rest);
  std::vector<CellError> cells = cellErrors(trial, finer, scratch.errors);
  const auto errorOf = [](std::span<const CellError> some) {
    double sum = 0.0;
    for (const CellError &cell : some) sum += cell.error;
    return sum;
  };
  const double all = errorOf(cells);
  out.cells = cells.size();
  out.evenStep = std::cbrt(kBasePart) * trial.stableStepAtRest();
  const auto phyxels = static_cast<double>(rest.phyxelCount());
  const double wanted = isCount ? static_cast<double>(out.sampling.count) : phyxels / kBasePart;
  const std::size_t halved = halvedFor(cells, rest.spacing, wanted - phyxels);
  const std::span<const CellError> worst = std::span(cells).first(halved);
  out.share = all > 0.0 ? errorOf(worst) / all : 0.0;
  if (halved == 0 || !(out.share >= kMinShare)) {
    const auto percent = [](double share) { return detail::number(100.0 * share, 2) + " %"; };
    out.uniform = "its error arises too evenly for that: " + percent(out.share) + " of it in " +
                  percent(static_cast<double>(halved) / static_cast<double>(out.cells)) + " of the cells; " +
                  percent(kMinShare) + " are needed";
    return out;
  }
  out.halved = halved;
  out.sampling.spacing = rest.spacing;
  for (const CellError &cell : worst) finer.places.push_back(cell.at);
  std::sort(finer.places.begin(), finer.places.end());
  out.sampling.finer = std::move(finer);
  return out;
}

}  // namespace pointbased
