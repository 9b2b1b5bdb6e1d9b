// SPDX-License-Identifier: Apache-2.0
#include "fields/colouring.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/number_text.h"

namespace pointbased {
namespace {

constexpr double kMillimetres = 1e3, kKilopascals = 1e-3, kPercent = 100.0;
constexpr auto kMinInterval = std::chrono::milliseconds(33);
constexpr int kRestPerCost = 4;       // at most a fifth of the time is used
constexpr double kQuantile = 0.98;    // single values at clamps and edges do not determine the range
constexpr double kShrinkBelow = 0.4;  // fraction of the range

struct Meaning {
  const char *title, *unit, *of;
};

Meaning meaningOf(ColourBy by) {
  switch (by) {
    case ColourBy::vonMises: return {"Stress (von Mises)", "kPa", ""};
    case ColourBy::error: return {"Strain error", "%", "of the mean strain\n"};
    case ColourBy::stabilisation: return {"Stabilisation", "%", "of the elastic energy\n"};
    case ColourBy::verified: return {"Error, verified", "mm", ""};
    case ColourBy::contactPressure: return {"Contact pressure", "kPa", ""};
    default: return {"Displacement", "mm", ""};
  }
}

/// A smaller range shows only round-off.
double leastRange(ColourBy by, const Colouring::Bodies &bodies) {
  if (by == ColourBy::error || by == ColourBy::stabilisation) return 1.0;
  if (by == ColourBy::displacement) return 1e-2;
  if (by == ColourBy::verified) return 1e-6;
  if (by == ColourBy::contactPressure) return 1e-3;
  double stiffest = 0.0;
  for (const auto &[id, body] : bodies)
    for (const Material &m : body->constitution().materials) stiffest = std::max(stiffest, m.youngsModulus);
  return std::max(1e-6 * stiffest * kKilopascals, 1e-12);
}

/// Mean over the phyxels whose cell contains an evaluation point.
void meansAtPoints(const RestState &rest, std::span<const double> perPhyxel, std::vector<double> &out) {
  const Csr &phyxels = rest.stencils.phyxels;
  out.resize(rest.pointCount());
  for (std::size_t q = 0; q < out.size(); ++q) {
    double sum = 0.0;
    for (Index e = phyxels.offsets[q]; e < phyxels.offsets[q + 1]; ++e) sum += perPhyxel[phyxels.indices[e]];
    out[q] = rest.evaluation == Evaluation::phyxels
                 ? perPhyxel[q]
                 : sum / std::max<double>(1.0, phyxels.offsets[q + 1] - phyxels.offsets[q]);
  }
}

void coloursOf(std::span<const double> values, const ColourScale &scale, std::vector<Rgba8> &out) {
  out.resize(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) out[i] = colourOf(values[i], scale.low, scale.high);
}

}  // namespace

void ValueReader::read(const Body &body, const ViewSettings &view, std::span<const double> given,
                       const ParallelFor &parallelFor, BodyValues &out) {
  const RestState &rest = body.rest();
  if (view.colourBy == ColourBy::verified) {
    // For a body that was refused there is no error to show.
    out = BodyValues();
    out.surfels.assign(rest.surfels.count(), 0.0);
    for (std::size_t i = 0; i < std::min(given.size(), out.surfels.size()); ++i)
      out.surfels[i] = kMillimetres * given[i];
    return;
  }
  const bool ownAtPoints = view.colourBy == ColourBy::vonMises && view.points == PointsShown::evaluationPoints;
  perPhyxel_.resize(rest.phyxelCount());
  out.whole = 0.0;
  switch (view.colourBy) {
    case ColourBy::error:
      out.whole = kPercent * estimateError(body, &perPhyxel_, error_, parallelFor).relative;
      for (double &value : perPhyxel_) value *= kPercent;
      break;
    case ColourBy::stabilisation:
      out.whole = kPercent * estimateError(body, nullptr, error_, parallelFor).stabilisationShare;
      stabilisationShares(body, error_, perPhyxel_);
      for (double &value : perPhyxel_) value *= kPercent;
      break;
    case ColourBy::vonMises:
      pointStresses_.resize(rest.pointCount());
      phyxelStresses_.resize(rest.phyxelCount());
      cauchyStresses(body, pointStresses_, stress_, parallelFor);
      phyxelMeans(rest, pointStresses_, phyxelStresses_);
      for (std::size_t i = 0; i < perPhyxel_.size(); ++i) perPhyxel_[i] = kKilopascals * vonMises(phyxelStresses_[i]);
      break;
    case ColourBy::contactPressure:
      for (std::size_t i = 0; i < perPhyxel_.size(); ++i)
        perPhyxel_[i] = i < given.size() ? kKilopascals * given[i] : 0.0;
      break;
    default:
      for (std::size_t i = 0; i < perPhyxel_.size(); ++i)
        perPhyxel_[i] = kMillimetres * body.state().displacements[i].norm();
  }
  out.surfels.resize(rest.surfels.count());
  interpolateScalars(rest.surfels, perPhyxel_, out.surfels, parallelFor);
  out.points.clear();
  if (!view.showsPoints()) return;
  if (view.points == PointsShown::phyxels) {
    out.points = perPhyxel_;
  } else if (ownAtPoints) {
    out.points.resize(rest.pointCount());
    for (std::size_t q = 0; q < out.points.size(); ++q) out.points[q] = kKilopascals * vonMises(pointStresses_[q]);
  } else {
    meansAtPoints(rest, perPhyxel_, out.points);
  }
}

double roundedUp(double x) {
  constexpr std::array kSteps{1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0};
  const double power = std::pow(10.0, std::floor(std::log10(x)));
  for (const double step : kSteps)
    if (x <= step * power * (1.0 + 1e-12)) return step * power;
  return 10.0 * power;
}

double AutoRange::update(std::vector<double> values, double least) {
  double wanted = 0.0;
  std::erase_if(values, [](double v) { return !std::isfinite(v); });
  if (!values.empty()) {
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(kQuantile * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    wanted = *at;
  }
  wanted = std::max(wanted, least);
  if (wanted > high_ || wanted < kShrinkBelow * high_) high_ = roundedUp(wanted);
  return high_;
}

bool Colouring::isDue(const Bodies &bodies, const ViewSettings &view, Clock::time_point now) const {
  if (!(view == view_) || entries_.size() != bodies.size()) return true;
  for (const auto &[id, body] : bodies) {
    const auto found = entries_.find(id);
    if (found == entries_.end() || found->second.colours.rest != &body->rest()) return true;
  }
  return now - updated_ >= std::max<Clock::duration>(kMinInterval, kRestPerCost * cost_);
}

bool Colouring::update(const Bodies &bodies, const ViewSettings &view, const ParallelFor &parallelFor,
                       Clock::time_point now) {
  if (view.colourBy == ColourBy::material) {
    forget();
    return true;
  }
  if (!isDue(bodies, view, now)) return false;
  const Clock::time_point begin = Clock::now();
  if (view.colourBy != view_.colourBy) range_.forget();
  view_ = view;
  std::erase_if(entries_, [&](const auto &entry) { return !bodies.contains(entry.first); });
  for (const auto &[id, body] : bodies) {
    std::vector<double> given;
    const BodyVerification *verified = verification_ ? verification_->body(id) : nullptr;
    if (view.colourBy == ColourBy::verified && verified) given = verified->result.skinErrors;
    if (view.colourBy == ColourBy::contactPressure && pressures_) pressures_(id, given);
    entries_[id].reader.read(*body, view, given, parallelFor, entries_[id].values);
  }
  scale_ = scaleOf(bodies, view);
  for (const auto &[id, body] : bodies) {
    Entry &entry = entries_[id];
    entry.colours.rest = &body->rest();
    coloursOf(entry.values.surfels, *scale_, entry.colours.surfels);
    coloursOf(entry.values.points, *scale_, entry.colours.points);
  }
  updated_ = now;
  ++generation_;
  cost_ = Clock::now() - begin;
  return true;
}

ColourScale Colouring::scaleOf(const Bodies &bodies, const ViewSettings &view) {
  const Meaning meaning = meaningOf(view.colourBy);
  ColourScale scale{view.colourBy, 0.0, 1.0, meaning.title, meaning.unit, {}};
  double largest = 0.0, whole = 0.0;
  std::vector<double> all;
  for (const auto &[id, entry] : entries_) {
    all.insert(all.end(), entry.values.surfels.begin(), entry.values.surfels.end());
    for (const auto *values : {&entry.values.surfels, &entry.values.points})
      for (const double value : *values)
        if (std::isfinite(value)) largest = std::max(largest, value);
    whole = std::max(whole, entry.values.whole);
  }
  // Values without contact are irrelevant to the range.
  if (view.colourBy == ColourBy::contactPressure) std::erase_if(all, [](double v) { return !(v > 0.0); });
  scale.high = view.range ? *view.range : range_.update(std::move(all), leastRange(view.colourBy, bodies));
  scale.note = meaning.of + ("largest " + significant(largest) + " ") + meaning.unit;
  if (view.colourBy == ColourBy::error || view.colourBy == ColourBy::stabilisation)
    scale.note += std::string(bodies.size() > 1 ? "\nworst body " : "\nwhole body ") + significant(whole) + " %";
  return scale;
}

void Colouring::setVerification(std::shared_ptr<const WorldVerification> verification) {
  if (verification == verification_) return;
  verification_ = std::move(verification);
  if (view_.colourBy == ColourBy::verified) forget();
}

const Colouring::Colours *Colouring::of(std::uint64_t body) const {
  const auto found = entries_.find(body);
  return found == entries_.end() ? nullptr : &found->second.colours;
}

void Colouring::forget() {
  entries_.clear();
  scale_.reset();
  range_.forget();
  view_ = ViewSettings();
  cost_ = {};
}

}  // namespace pointbased
