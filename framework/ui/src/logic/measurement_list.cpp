// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/measurement_list.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "c3de/core/csv.h"
#include "c3de/core/text.h"
#include "c3de/registry/edit_list.h"

namespace c3de::ui {
namespace {

constexpr double kNotMoved_mm = 1e-3;

/// One digit after the point for mm and degrees, two for cm.
std::string numberText(const MeasurementRow &row, const std::optional<double> &value, bool hasSign = false) {
  if (!value) return "–";
  const int decimals = row.kind != MeasureKind::angle && row.length.factor < 1.0 ? 2 : 1;
  return hasSign ? fmt::format("{:+.{}f}", row.shown(*value), decimals)
                 : fmt::format("{:.{}f}", row.shown(*value), decimals);
}

}  // namespace

const char *kindName(MeasureKind kind) {
  return kind == MeasureKind::landmark ? "Landmark" : kind == MeasureKind::distance ? "Distance" : "Angle";
}

std::optional<double> angle_deg(const Vec3 &a, const Vec3 &vertex, const Vec3 &c) {
  const Vec3 u = a - vertex, v = c - vertex;
  if (norm(u) == 0.0 || norm(v) == 0.0) return std::nullopt;
  return std::atan2(norm(cross(u, v)), dot(u, v)) * 180.0 / std::numbers::pi;
}

const MeasuredPoint *MeasurementSet::point(const std::string &name) const {
  const auto found = std::find_if(points.begin(), points.end(), [&](const auto &one) { return one.name == name; });
  return found == points.end() ? nullptr : &*found;
}

const Measure *MeasurementSet::measure(const std::string &name) const {
  const auto found = std::find_if(measures.begin(), measures.end(), [&](const auto &one) { return one.name == name; });
  return found == measures.end() ? nullptr : &*found;
}

std::string MeasurementSet::freeName(const std::string &kind) const {
  std::string name;
  for (std::size_t i = 1; name.empty() || has(name); ++i) name = kind + " " + std::to_string(i);
  return name;
}

void MeasurementSet::remove(const std::string &name) {
  std::erase_if(points, [&](const MeasuredPoint &one) { return one.name == name; });
  std::erase_if(measures, [&](const Measure &one) {
    return one.name == name || std::find(one.points.begin(), one.points.end(), name) != one.points.end();
  });
}

Expected<void> MeasurementSet::rename(const std::string &name, const std::string &wanted) {
  if (wanted.empty()) return fail(ErrorCode::usage, "the name is empty; accepted: at least one character");
  if (wanted == name) return {};
  if (has(wanted))
    return fail(ErrorCode::usage,
                "there is already a measurement '" + displayText(wanted) + "'; accepted: another name");
  for (MeasuredPoint &one : points)
    if (one.name == name) one.name = wanted;
  for (Measure &one : measures) {
    if (one.name == name) one.name = wanted;
    std::replace(one.points.begin(), one.points.end(), name, wanted);
  }
  return {};
}

void MeasurementSet::setHidden(const std::string &name, bool isHidden) {
  for (MeasuredPoint &one : points)
    if (one.name == name) one.isHidden = isHidden;
  for (Measure &one : measures)
    if (one.name == name) one.isHidden = isHidden;
}

void MeasurementSet::setTarget(const std::string &name, const std::optional<Vec3> &at_mm) {
  for (MeasuredPoint &one : points)
    if (one.name == name) one.target_mm = at_mm;
}

void MeasurementSet::mergeScene(const MeasurementSet &scene) {
  const MeasurementSet before = std::move(*this);
  *this = scene;
  for (const MeasuredPoint &one : before.points)
    if (!one.isOfScene && !has(one.name)) points.push_back(one);
  for (const Measure &one : before.measures)
    if (!one.isOfScene && !has(one.name) &&
        std::all_of(one.points.begin(), one.points.end(), [&](const std::string &name) { return point(name); }))
      measures.push_back(one);
}

std::string MeasurementRow::referenceText() const { return numberText(*this, reference); }
std::string MeasurementRow::nowText() const { return numberText(*this, now); }

std::string MeasurementRow::changeText() const {
  return numberText(*this, reference && now ? std::optional(*now - *reference) : std::nullopt, true);
}

std::string MeasurementRow::label() const {
  const std::string space = kind == MeasureKind::angle ? "" : " ";
  const bool isSame = reference && now && std::abs(*now - *reference) < kNotMoved_mm;
  if (kind == MeasureKind::landmark) return isSame || !now ? std::string() : nowText() + " " + unit();
  return (isSame ? nowText() : referenceText() + " → " + nowText()) + space + unit();
}

struct MeasurementList::Step {
  MeasurementList *list;
  MeasurementSet before, after;
  std::uint64_t revisionBefore, revisionAfter;
};

void MeasurementList::show(const MeasurementSet &set, std::uint64_t revision) {
  set_ = set;
  revision_ = revision;
  if (!set_.has(selected)) selected.clear();
}

void MeasurementList::edit(const std::string &label, MeasurementSet set) {
  if (set == set_) return;
  auto step = std::make_unique<Step>(Step{this, set_, set, revision_, ++lastRevision_});
  show(set, step->revisionAfter);
  if (!edits_) return;
  registry::Edit edit;
  edit.label = label;
  edit.undo = [](void *self) noexcept -> c3de_status {
    const auto *one = static_cast<Step *>(self);
    one->list->show(one->before, one->revisionBefore);
    return C3DE_OK;
  };
  edit.redo = [](void *self) noexcept -> c3de_status {
    const auto *one = static_cast<Step *>(self);
    one->list->show(one->after, one->revisionAfter);
    return C3DE_OK;
  };
  edit.release = [](void *self) noexcept { delete static_cast<Step *>(self); };
  edit.owner = "c3de.measurements";
  edit.self = step.release();
  edits_->add(std::move(edit));
}

void MeasurementList::assign(MeasurementSet set) {
  if (edits_) edits_->removeOwnedBy("c3de.measurements");
  if (set == set_) return;
  show(set, ++lastRevision_);
}

void MeasurementList::addPositions(const std::map<std::string, Vec3> &positions_mm, double time_s) {
  positions_ = positions_mm;
  ++positionsRevision_;
  while (!samples_.empty() && samples_.back().time_s >= time_s) samples_.pop_back();
  if (samples_.empty()) interval_s_ = 0.0;
  // The latest one is always kept; it is replaced until it is far enough from the one before it.
  const std::size_t n = samples_.size();
  if (n > 1 && samples_[n - 1].time_s - samples_[n - 2].time_s < interval_s_) samples_.pop_back();
  samples_.push_back({time_s, positions_mm});
  if (samples_.size() < kMostSamples) return;
  std::deque<Sample> kept;
  for (std::size_t i = 0; i < samples_.size(); ++i)
    if (i % 2 == 0 || i + 1 == samples_.size()) kept.push_back(std::move(samples_[i]));
  samples_ = std::move(kept);
  constexpr double kOfMean = 0.99;  // samples at equal intervals remain so in spite of rounding
  interval_s_ = kOfMean * (samples_.back().time_s - samples_.front().time_s) / static_cast<double>(samples_.size() - 1);
}

void MeasurementList::forgetPositions() {
  positions_.clear();
  samples_.clear();
  interval_s_ = 0.0;
}

Vec3 MeasurementList::positionOf(const MeasuredPoint &point) const {
  const auto found = positions_.find(point.name);
  return found == positions_.end() ? point.reference_mm : found->second;
}

bool MeasurementList::hasMoved() const {
  return std::any_of(set_.points.begin(), set_.points.end(), [this](const MeasuredPoint &one) {
    return norm(positionOf(one) - one.reference_mm) > kNotMoved_mm;
  });
}

/// @param at_mm  null: at rest
std::optional<double> MeasurementList::valueOf(const std::string &name,
                                               const std::map<std::string, Vec3> *at_mm) const {
  const auto place = [&](const std::string &point) -> std::optional<Vec3> {
    const MeasuredPoint *one = set_.point(point);
    if (!one) return std::nullopt;
    if (!at_mm) return one->reference_mm;
    const auto found = at_mm->find(point);
    return found == at_mm->end() ? std::nullopt : std::optional(found->second);
  };
  if (const MeasuredPoint *one = set_.point(name)) {
    const auto at = place(name);
    return at ? std::optional(norm(*at - one->reference_mm)) : std::nullopt;
  }
  const Measure *measure = set_.measure(name);
  if (!measure) return std::nullopt;
  std::vector<Vec3> at;
  for (const std::string &point : measure->points) {
    const auto one = place(point);
    if (!one) return std::nullopt;
    at.push_back(*one);
  }
  return measure->isAngle() ? angle_deg(at[0], at[1], at[2]) : norm(at[0] - at[1]);
}

MeasurementRow MeasurementList::rowOf(const std::string &name, MeasureKind kind, bool isHidden) const {
  std::map<std::string, Vec3> at_mm;
  for (const MeasuredPoint &one : set_.points) at_mm[one.name] = positionOf(one);
  MeasurementRow row{name, kind, isHidden, valueOf(name, nullptr), valueOf(name, &at_mm), {}, length_};
  if (const MeasuredPoint *point = set_.point(name); point && point->target_mm)
    row.error_mm = {norm(point->reference_mm - *point->target_mm), norm(positionOf(*point) - *point->target_mm)};
  return row;
}

std::vector<MeasurementRow> MeasurementList::rows() const {
  std::vector<MeasurementRow> rows;
  for (const MeasuredPoint &one : set_.points) rows.push_back(rowOf(one.name, MeasureKind::landmark, one.isHidden));
  for (const Measure &one : set_.measures)
    rows.push_back(rowOf(one.name, one.isAngle() ? MeasureKind::angle : MeasureKind::distance, one.isHidden));
  return rows;
}

std::optional<MeasurementRow> MeasurementList::row(const std::string &name) const {
  if (const MeasuredPoint *one = set_.point(name)) return rowOf(name, MeasureKind::landmark, one->isHidden);
  if (const Measure *one = set_.measure(name))
    return rowOf(name, one->isAngle() ? MeasureKind::angle : MeasureKind::distance, one->isHidden);
  return std::nullopt;
}

std::optional<TargetErrors> MeasurementList::targetErrors() const {
  std::vector<std::array<double, 2>> all;
  for (const MeasuredPoint &one : set_.points)
    if (one.target_mm) all.push_back({norm(one.reference_mm - *one.target_mm), norm(positionOf(one) - *one.target_mm)});
  if (all.empty()) return std::nullopt;
  TargetErrors out;
  out.count = all.size();
  const auto n = static_cast<double>(all.size());
  for (std::size_t k = 0; k < 2; ++k) {
    for (const auto &one : all) {
      out.mean_mm[k] += one[k] / n;
      out.max_mm[k] = std::max(out.max_mm[k], one[k]);
    }
    double squares = 0.0;
    for (const auto &one : all) squares += (one[k] - out.mean_mm[k]) * (one[k] - out.mean_mm[k]);
    if (all.size() > 1) out.sd_mm[k] = std::sqrt(squares / (n - 1.0));
  }
  return out;
}

std::vector<CurvePoint2> MeasurementList::curve(const std::string &name) const {
  std::vector<CurvePoint2> out;
  for (const Sample &sample : samples_)
    if (const auto value = valueOf(name, &sample.at_mm)) out.push_back({sample.time_s, *value});
  return out;
}

std::string MeasurementList::tableCsv() const {
  std::string text =
      "name,kind,unit,at rest,now,change,error at rest [" + length_.name + "],error now [" + length_.name + "]\n";
  for (const MeasurementRow &row : rows()) {
    const auto cell = [&](const std::optional<double> &value) {
      return value ? fmt::format("{:.6g}", row.shown(*value)) : std::string();
    };
    const std::string unit = row.kind == MeasureKind::angle ? "degrees" : length_.name;
    std::optional<double> change;
    if (row.reference && row.now) change = *row.now - *row.reference;
    text += fmt::format("{},{},{},{},{},{},{},{}\n", csvCell(row.name),
                        row.kind == MeasureKind::angle      ? "angle"
                        : row.kind == MeasureKind::distance ? "distance"
                                                            : "landmark",
                        unit, cell(row.reference), cell(row.now), cell(change),
                        row.error_mm ? cell((*row.error_mm)[0]) : "", row.error_mm ? cell((*row.error_mm)[1]) : "");
  }
  return text;
}

std::string MeasurementList::curvesCsv() const {
  std::string text = "time [s]";
  const std::vector<MeasurementRow> all = rows();
  for (const MeasurementRow &row : all)
    text += ',' + csvCell(row.name + (row.kind == MeasureKind::angle      ? " [degrees]"
                                      : row.kind == MeasureKind::landmark ? " displacement [" + length_.name + "]"
                                                                          : " [" + length_.name + "]"));
  text += '\n';
  for (const Sample &sample : samples_) {
    text += fmt::format("{:.9g}", sample.time_s);
    for (const MeasurementRow &row : all) {
      const auto value = valueOf(row.name, &sample.at_mm);
      text += value ? fmt::format(",{:.9g}", row.shown(*value)) : ",";
    }
    text += '\n';
  }
  return text;
}

}  // namespace c3de::ui
