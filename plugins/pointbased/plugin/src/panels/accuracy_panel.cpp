// SPDX-License-Identifier: Apache-2.0
#include "panels/accuracy_panel.h"

#include <algorithm>
#include <cmath>

#include "base/number_text.h"

namespace pointbased {
namespace {

double part(double of, double whole) { return whole > 0.0 ? std::clamp(of / whole, 0.0, 1.0) : 0.0; }

// Error target as a fraction of the largest displacement.
double targetError(const AccuracyPrediction &promise) {
  switch (promise.wish.kind) {
    case AccuracyTarget::Kind::share: return promise.wish.value;
    case AccuracyTarget::Kind::length:
      return promise.choice.largest > 0.0 ? promise.wish.value / promise.choice.largest : 0.0;
    default: return kStandardError;
  }
}

// The used part of a target. The figure itself is in the statement.
void targetBar(sdk::Ui &ui, const AccuracyPrediction &promise) {
  if (promise.wish.kind != AccuracyTarget::Kind::share && promise.wish.kind != AccuracyTarget::Kind::length) return;
  const double wished = targetError(promise), likely = promise.choice.error.likely;
  ui.value("Error target", twoDigits(100.0 * wished) + " % of the largest displacement");
  ui.progress(part(likely, wished), twoDigits(100.0 * part(likely, wished)) + " % of the target reached");
}

void costBar(sdk::Ui &ui, const BodySnapshot &body, const AccuracyPrediction &promise) {
  const double now = 1e3 * kFrame * body.cost, promised = promise.choice.frame_ms;
  const bool isBudget = promise.wish.kind == AccuracyTarget::Kind::budget;
  const double whole = 1e3 * (isBudget ? promise.wish.value : kStandardBudget);
  ui.value("Frame time",
           (now > 0.0 ? twoDigits(now) + " ms now, " : std::string()) + twoDigits(promised) + " ms predicted");
  ui.tooltip(
      "Computing time of 1/60 s of simulated time. Without an accuracy target the prediction is for a reference "
      "machine");
  if (promise.choice.touching_ms > 0.0) ui.text(touchingText(promise));
  const double shown = now > 0.0 ? now : promised;
  ui.progress(part(shown, whole), twoDigits(shown) + " of " + twoDigits(whole) + " ms");
}

void tissueBar(sdk::Ui &ui, const BodySnapshot &body) {
  const StiffnessRange range = stiffnessRangeOf(*body.values);
  const double E = body.youngsModulus;
  ui.value("Tissue stiffness", twoDigits(1e-3 * range.low) + " … " + twoDigits(1e-3 * range.high) + " kPa");
  ui.tooltip(range.isKnown
                 ? "Range of Young's modulus in the literature for this tissue. The result cannot be more accurate "
                   "than this range"
                 : "The range of this Young's modulus is unknown; ±50 % is typical of living tissue");
  ui.progress(part(range.high - range.low, 2.0 * E), "displacements " + twoDigits(100.0 * (E / range.high - 1.0)) +
                                                         " … +" + twoDigits(100.0 * (E / range.low - 1.0)) + " %");
}

}  // namespace

void drawAccuracyStatement(sdk::Ui &ui, const BodySnapshot &body) {
  if (body.rigid) {
    ui.text("Rigid: no discretisation error.");
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
          "scaling). Gravity forces are unchanged, so equilibrium is not affected");
    }
  }
  if (body.promise && body.promise->survey) {
    targetBar(ui, *body.promise);
    costBar(ui, body, *body.promise);
    if (!body.promise->choice.unmet.empty()) ui.text(body.promise->choice.unmet);
  }
  tissueBar(ui, body);
}

void drawOtherTarget(sdk::Ui &ui, const ParameterValues &world) {
  const AccuracyTarget target = accuracyTargetOf(world);
  if (target.kind == AccuracyTarget::Kind::share)
    ui.value("Accuracy target", "error at most " + twoDigits(100.0 * target.value) + " % of the largest displacement");
  else if (target.kind == AccuracyTarget::Kind::budget)
    ui.value("Accuracy target", "best accuracy within " + twoDigits(1e3 * target.value) + " ms per frame");
  else
    return;
  ui.tooltip("A value in mm replaces it");
}

void drawUnmetTarget(sdk::Ui &ui, const BodySnapshot &body) {
  if (!body.rigid && body.promise && body.promise->survey && !body.promise->choice.unmet.empty())
    ui.text(body.promise->choice.unmet);
}

}  // namespace pointbased
