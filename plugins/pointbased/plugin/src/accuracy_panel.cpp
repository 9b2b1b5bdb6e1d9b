// SPDX-License-Identifier: Apache-2.0
#include "accuracy_panel.h"

#include <algorithm>
#include <cmath>

namespace pointbased {
namespace {

double part(double of, double whole) { return whole > 0.0 ? std::clamp(of / whole, 0.0, 1.0) : 0.0; }

// Of the largest displacement.
double wishedError(const AccuracyPromise &promise) {
  switch (promise.wish.kind) {
    case AccuracyWish::Kind::share: return promise.wish.value;
    case AccuracyWish::Kind::length:
      return promise.choice.largest > 0.0 ? promise.wish.value / promise.choice.largest : 0.0;
    default: return kStandardError;
  }
}

void errorBar(sdk::Ui &ui, const BodySnapshot &body, const AccuracyPromise &promise) {
  ui.value("Error expected", errorText(promise));
  ui.tooltip(
      "At rest, of 95 % of the skin, as part of its largest displacement; in brackets where nine of ten bodies lie");
  if (promise.wish.kind != AccuracyWish::Kind::budget) {
    const double wished = wishedError(promise);
    ui.progress(part(promise.choice.error.share, wished),
                roughly(100.0 * promise.choice.error.share) + " of " + roughly(100.0 * wished) + " %");
  }
  ui.value("Estimated now", roughly(100.0 * body.error * body.error) + " %");
  ui.tooltip(
      "The square of the error estimate of the strains in the present state: about the part that displacements "
      "are off");
}

void costBar(sdk::Ui &ui, const BodySnapshot &body, const AccuracyPromise &promise) {
  const double now = 1e3 * kFrame * body.cost, promised = promise.choice.frame_ms;
  const bool isBudget = promise.wish.kind == AccuracyWish::Kind::budget;
  const double whole = 1e3 * (isBudget ? promise.wish.value : kStandardBudget);
  ui.value("A frame takes",
           (now > 0.0 ? roughly(now) + " ms now, " : std::string()) + roughly(promised) + " ms promised");
  ui.tooltip("Computing time of 1/60 s of simulated time. Without a wish the promise is for a machine to reckon with");
  if (promise.choice.touching_ms > 0.0) ui.text(touchingText(promise));
  const double shown = now > 0.0 ? now : promised;
  ui.progress(part(shown, whole), roughly(shown) + " of " + roughly(whole) + " ms");
}

void tissueBar(sdk::Ui &ui, const BodySnapshot &body) {
  const StiffnessRange range = stiffnessRangeOf(*body.values);
  const double E = body.youngsModulus;
  ui.value("Tissue stiffness", roughly(1e-3 * range.low) + " … " + roughly(1e-3 * range.high) + " kPa");
  ui.tooltip(range.isKnown
                 ? "The range of Young's modulus that the literature gives for the tissue: what is computed "
                   "is no better than what is known of it"
                 : "Nothing is known of the range of this Young's modulus; ±50 % are usual for living tissue");
  ui.progress(part(range.high - range.low, 2.0 * E), "displacements " + roughly(100.0 * (E / range.high - 1.0)) +
                                                         " … +" + roughly(100.0 * (E / range.low - 1.0)) + " %");
}

}  // namespace

void drawAccuracyBars(sdk::Ui &ui, const BodySnapshot &body) {
  if (body.rigid) return;
  if (body.adaptive) {
    ui.value("Halved cells", std::to_string(body.adaptive->halved) + " of " + std::to_string(body.adaptive->cells));
    ui.tooltip("Cells that had most of the error of a trial");
    if (body.adaptive->halved > 0) {
      ui.value("… had of the error", roughly(100.0 * body.adaptive->share) + " % of its square");
    } else {
      ui.text(adaptiveText(*body.adaptive));
    }
    if (!body.addedMass.empty()) {
      ui.value("Added inertia", body.addedMass);
      ui.tooltip(
          "Phyxels of the smallest and stiffest cells have more inertia, so that explicit steps are longer (mass "
          "scaling). Weights stay: nothing at rest feels it");
    }
  }
  if (!body.promise) {
    ui.text("The sampling was chosen by hand: nothing is promised.");
  } else if (!body.promise->survey) {
    ui.text("The error could not be predicted: " + body.promise->unpredicted);
  } else {
    errorBar(ui, body, *body.promise);
    costBar(ui, body, *body.promise);
    if (body.promise->supposed())
      ui.text("Nothing holds or loads it: expected as if it were held at its lowest tenth and hung.");
    if (!body.promise->choice.unmet.empty()) ui.text(body.promise->choice.unmet);
  }
  tissueBar(ui, body);
}

}  // namespace pointbased
