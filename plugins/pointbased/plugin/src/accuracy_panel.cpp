// SPDX-License-Identifier: Apache-2.0
#include "accuracy_panel.h"

#include <algorithm>
#include <cmath>

#include "number_text.h"

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

// How much of a wish is used up. The figure itself is in the statement.
void wishBar(sdk::Ui &ui, const AccuracyPromise &promise) {
  if (promise.wish.kind != AccuracyWish::Kind::share && promise.wish.kind != AccuracyWish::Kind::length) return;
  const double wished = wishedError(promise), likely = promise.choice.error.likely;
  ui.value("Wished error", twoDigits(100.0 * wished) + " % of the largest displacement");
  ui.progress(part(likely, wished), twoDigits(100.0 * part(likely, wished)) + " % of it used");
}

void costBar(sdk::Ui &ui, const BodySnapshot &body, const AccuracyPromise &promise) {
  const double now = 1e3 * kFrame * body.cost, promised = promise.choice.frame_ms;
  const bool isBudget = promise.wish.kind == AccuracyWish::Kind::budget;
  const double whole = 1e3 * (isBudget ? promise.wish.value : kStandardBudget);
  ui.value("A frame takes",
           (now > 0.0 ? twoDigits(now) + " ms now, " : std::string()) + twoDigits(promised) + " ms promised");
  ui.tooltip("Computing time of 1/60 s of simulated time. Without a wish the promise is for a machine to reckon with");
  if (promise.choice.touching_ms > 0.0) ui.text(touchingText(promise));
  const double shown = now > 0.0 ? now : promised;
  ui.progress(part(shown, whole), twoDigits(shown) + " of " + twoDigits(whole) + " ms");
}

void tissueBar(sdk::Ui &ui, const BodySnapshot &body) {
  const StiffnessRange range = stiffnessRangeOf(*body.values);
  const double E = body.youngsModulus;
  ui.value("Tissue stiffness", twoDigits(1e-3 * range.low) + " … " + twoDigits(1e-3 * range.high) + " kPa");
  ui.tooltip(range.isKnown
                 ? "The range of Young's modulus that the literature gives for the tissue: what is computed "
                   "is no better than what is known of it"
                 : "Nothing is known of the range of this Young's modulus; ±50 % are usual for living tissue");
  ui.progress(part(range.high - range.low, 2.0 * E), "displacements " + twoDigits(100.0 * (E / range.high - 1.0)) +
                                                         " … +" + twoDigits(100.0 * (E / range.low - 1.0)) + " %");
}

}  // namespace

void drawAccuracyStatement(sdk::Ui &ui, const BodySnapshot &body) {
  if (body.rigid) {
    ui.text("Rigid: it has no error of its own.");
    return;
  }
  for (const std::string &line : body.accuracy.lines()) {
    const std::size_t colon = line.find(": ");
    ui.value(line.substr(0, colon), line.substr(colon + 2));
  }
}

void drawAccuracyBars(sdk::Ui &ui, const BodySnapshot &body) {
  if (body.rigid) return;
  if (body.adaptive) {
    ui.value("Halved cells", std::to_string(body.adaptive->halved) + " of " + std::to_string(body.adaptive->cells));
    ui.tooltip("Cells that had most of the error of a trial");
    if (body.adaptive->halved > 0) {
      ui.value("… had of the error", twoDigits(100.0 * body.adaptive->share) + " % of its square");
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
  if (body.promise && body.promise->survey) {
    wishBar(ui, *body.promise);
    costBar(ui, body, *body.promise);
    if (!body.promise->choice.unmet.empty()) ui.text(body.promise->choice.unmet);
  }
  tissueBar(ui, body);
}

}  // namespace pointbased
