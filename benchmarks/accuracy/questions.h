// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bench/report.h"

namespace bench {

/// Checks the predictions of the accuracy setting.
///
/// Bodies, materials and loads that the model was not fitted to, drawn by seed (random_problems.h), each with an
/// accuracy target of 3, 5, 10 or 20 % of its largest displacement. For each: two trials, the chosen sampling, and then
///   error   the body solved with its own law at that sampling, against eight times as many phyxels; the remaining
///           error of that reference is added by the order of the model
///   cost    the time per frame of the body in half a second of explicit steps under its loads, against the
///           time measured when it was built
/// --fit: errors of solutions with the linear law at up to five samplings of each body against a fine one, and the
/// coefficients of the model by least squares. Those in choose_sampling.cpp are from seeds 0 … 29. --second-order: for
/// quadratic functions. --orders: errors of both orders against a fine solution with quadratic functions. --adaptive:
/// errors of solutions with cells of uniform size, of the same number of cells some of which are halved
/// (adaptSampling()), and of 1.68 times as many cells of uniform size.
void checkPredictions(const Options &options, Report &report);

/// Compares the errors of organs at the default sampling with the predicted errors.
///
/// A ventricle, a hip bone, a gut and a vessel by formulas, and the named meshes (scaled to a length of 12 cm if their
/// file has no unit that fits an organ), of 6 kPa and Poisson's ratio 0.45. Each
///   hangs    from its upper quarter
///   gripped  the ends of its longest axis are held, and one is moved across it by a tenth of its length
///   pinched  a region of the skin, a quarter of the length wide, is pulled out by as much, with one end held
/// For each: the sampling that is chosen without an accuracy target (--phyxels: that one instead), its predicted error,
/// and the difference to a solution of half the spacing by verify(), which is within a factor of 1.5 of the true error.
void checkOrgans(const Options &options, Report &report);

}  // namespace bench
