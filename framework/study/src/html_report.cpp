// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>

#include "c3de/study/report.h"

namespace c3de::study {
namespace {

constexpr const char *kStyle = R"(
:root { color: #1c2733; background: #fff; font: 15px/1.5 Inter, 'Source Sans 3', 'Segoe UI', 'Helvetica Neue', 'DejaVu Sans', sans-serif; }
body { max-width: 60rem; margin: 2.5rem auto; padding: 0 1.25rem; }
h1 { font-size: 1.75rem; line-height: 1.2; margin: 0 0 .4rem; letter-spacing: -.01em; }
h2 { font-size: 1.2rem; margin: 2.75rem 0 .3rem; }
p { margin: .35rem 0; }
.meta, .note, figcaption { color: #5d6b79; font-size: .87rem; }
.meta { display: grid; grid-template-columns: max-content 1fr; gap: .1rem 1rem; margin: 1rem 0 0; }
.meta dt { color: #5d6b79; } .meta dd { margin: 0; color: #1c2733; overflow-wrap: anywhere; }
.problem { border-left: 3px solid #d55e00; padding: .3rem .8rem; background: #fdf4ee; }
figure { margin: .8rem 0; } figure svg { width: 100%; height: auto; }
table { border-collapse: collapse; width: 100%; font-size: .8rem; font-variant-numeric: tabular-nums; margin: .6rem 0; }
th { text-align: right; font-weight: 600; border-bottom: 1.5px solid #1c2733; padding: .25rem .5rem; vertical-align: bottom; line-height: 1.25; }
th small { display: block; font-weight: 400; color: #5d6b79; }
td { text-align: right; border-bottom: 1px solid #e3e7eb; padding: .2rem .5rem; white-space: nowrap; }
th:first-child, td:first-child, td.reason { text-align: left; }
tr.front td { font-weight: 600; } tr.group td { padding-top: .6rem; color: #5d6b79; font-weight: 600; }
td.reason { color: #a33f00; white-space: normal; }
.scroll { overflow-x: auto; }
@page { margin: 16mm; }
@media print { :root { font-size: 11px; } body { margin: 0; max-width: none; padding: 0; } table { font-size: 7.6px; } th, td { padding-left: .25rem; padding-right: .25rem; } section { break-inside: avoid-page; } figure, tr { break-inside: avoid; } }
)";

/// A column of the table of a case; columns without values are not shown.
struct Column {
  const char *title, *unit;
  double factor;
  std::optional<double> Errors::*of;
};
constexpr Column kColumns[]{{"L² error", "%", 100.0, &Errors::fieldL2},
                            {"skin, max", "mm", 1.0, &Errors::surfaceMax_mm},
                            {"skin, 95 %", "mm", 1.0, &Errors::surface95_mm},
                            {"energy norm", "%", 100.0, &Errors::energyNorm},
                            {"reaction", "%", 100.0, &Errors::reaction},
                            {"frequency", "%", 100.0, &Errors::frequency},
                            {"volume change", "%", 100.0, &Errors::volumeChange},
                            {"energy drift", "%/s", 100.0, &Errors::energyDrift_1_s},
                            {"momentum", "round-off", 1.0, &Errors::momentumRoundOff}};

std::string cell(const std::optional<double> &value, double factor) {
  return "<td>" + (value ? threeDigits(factor * *value) : std::string("–")) + "</td>";
}

/// For values that differ from others in their last digits.
std::string sixDigits(double value) { return fmt::format("{:.6g}", value); }

std::string heading(const std::string &title, const std::string &unit) {
  return "<th>" + title + "<small>" + unit + "</small></th>";
}

std::string tableHtml(const Study &study, const Plan &plan, const Outcome &outcome, std::size_t c) {
  const std::vector<Curve> curves = curvesOf(study, plan, c);
  const bool isMillimetres = study.cases[c].quantity.kind == Quantity::Kind::surface;
  const std::string unit = study.cases[c].quantity.unit();
  // The plotted error has a separate column.
  const auto drawn = [&]() -> std::optional<double> Errors::* {
    switch (study.cases[c].quantity.kind) {
      case Quantity::Kind::field: return &Errors::fieldL2;
      case Quantity::Kind::surface: return &Errors::surfaceMax_mm;
      case Quantity::Kind::reaction: return &Errors::reaction;
      case Quantity::Kind::frequency: return &Errors::frequency;
      default: return &Errors::quantity;
    }
  }();
  std::vector<const Column *> columns;
  for (const Column &column : kColumns)
    if (column.of != drawn && std::any_of(plan.points.begin(), plan.points.end(), [&](const Point &point) {
          return point.ofCase == c &&
                 outcome.points[static_cast<std::size_t>(&point - plan.points.data())].errors.*column.of;
        }))
      columns.push_back(&column);
  const bool hasValue = !study.cases[c].quantity.isField();
  const std::string costUnit = outcome.cases[c].hasTime ? "ms/s" : "ms";
  std::string text = "<div class=\"scroll\"><table>\n<thead><tr>" + heading("point", "&nbsp;");
  if (hasValue) text += heading("value", escaped(unit));
  text += heading("error", isMillimetres ? "mm" : "%");
  for (const Column *column : columns) text += heading(column->title, column->unit);
  text += heading("cost", costUnit) + heading("range", "least … most") + heading("step", "median, ms") +
          heading("step", "99 %, ms") + heading("step", "max, ms") + heading("CPU", "s");
  if (outcome.earlier) text += heading("before", isMillimetres ? "mm" : "%") + heading("before", costUnit);
  text += "</tr></thead>\n<tbody>\n";
  const std::size_t width = columns.size() + (hasValue ? 9 : 8) + (outcome.earlier ? 2 : 0);
  for (const Curve &curve : curves) {
    if (curves.size() > 1)
      text += fmt::format("<tr class=\"group\"><td colspan=\"{}\">{}</td></tr>\n", width, escaped(curve.label));
    for (const std::size_t p : curve.points) {
      const PointOutcome &point = outcome.points[p];
      text += std::string(point.isOnFront ? "<tr class=\"front\">" : "<tr>") + "<td>" +
              escaped(pointLabel(study, plan.points[p])) + (point.isBelowResolution ? " *" : "") + "</td>";
      if (!point.failure.empty()) {
        text += fmt::format("<td class=\"reason\" colspan=\"{}\">× {}: {}</td></tr>\n", width - 1,
                            escaped(point.failure), escaped(point.reason));
        continue;
      }
      if (hasValue) text += "<td>" + (point.errors.value ? sixDigits(*point.errors.value) : "–") + "</td>";
      text += cell(point.errors.quantity, isMillimetres ? 1.0 : 100.0);
      for (const Column *column : columns) text += cell(point.errors.*column->of, column->factor);
      const Cost &cost = *point.cost;
      text += cell(cost.median, 1.0) + "<td>" + threeDigits(cost.cheapest) + " … " + threeDigits(cost.dearest) +
              "</td>" + cell(cost.stepMedian_ms, 1.0) + cell(cost.step99_ms, 1.0) + cell(cost.stepMax_ms, 1.0) +
              cell(cost.cpu_s, 1.0);
      if (outcome.earlier) {
        const auto &before = outcome.earlier->points[p];
        text += before ? cell(before->error, isMillimetres ? 1.0 : 100.0) + cell(before->cost_ms, 1.0)
                       : std::string("<td>–</td><td>–</td>");
      }
      text += "</tr>\n";
    }
  }
  return text + "</tbody></table></div>\n";
}

std::string referenceText(const Case &one, const CaseOutcome &of) {
  if (!of.truth) return "no reference";
  const bool isMillimetres = one.quantity.kind == Quantity::Kind::surface;
  std::string text = shownKind(of.truth->kind) + " (" + of.truth->from + ")";
  if (of.truth->value)
    text += ", " + sixDigits(*of.truth->value) + " ± " + threeDigits(of.truth->uncertainty) + " " + one.quantity.unit();
  text +=
      "; uncertainty " + threeDigits((isMillimetres ? 1.0 : 100.0) * of.truth->bar) + (isMillimetres ? " mm" : " %");
  if (of.truth->order && std::isfinite(*of.truth->order)) text += ", observed order " + threeDigits(*of.truth->order);
  return text;
}

std::string caseHtml(const Study &study, const Plan &plan, const Outcome &outcome, std::size_t c) {
  const Case &one = study.cases[c];
  const CaseOutcome &of = outcome.cases[c];
  std::string text = "<section>\n<h2>" + escaped(one.name) + "</h2>\n";
  text += "<p class=\"note\">" + escaped(one.quantity.shown() + " in " + one.scene.filename().string()) +
          (one.until_s ? ", after " + threeDigits(*one.until_s) + " s" : "") +
          (one.steps ? ", after " + std::to_string(*one.steps) + " steps" : "") +
          ". Reference: " + escaped(referenceText(one, of)) + ".</p>\n";
  if (!of.error.empty()) text += "<p class=\"problem\">" + escaped(of.error) + "</p>\n";
  text += "<figure>\n" + diagramOf(study, plan, outcome, c, false) + "</figure>\n" + tableHtml(study, plan, outcome, c);
  bool isStarred = false;
  for (std::size_t p = 0; p < plan.points.size(); ++p)
    isStarred = isStarred || (plan.points[p].ofCase == c && outcome.points[p].isBelowResolution);
  if (isStarred) text += "<p class=\"note\">* nearer to the reference than that is certain.</p>\n";
  return text + "</section>\n";
}

}  // namespace

std::string reportOf(const Study &study, const Plan &plan, const Program &program, const Outcome &outcome) {
  std::string text =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
      "content=\"width=device-width, initial-scale=1\">\n<title>" +
      escaped(study.title) + "</title>\n<style>" + kStyle + "</style>\n</head>\n<body>\n";
  text += "<h1>" + escaped(study.title) + "</h1>\n";
  text +=
      "<p>Speed against accuracy. Of two points the lower one is more accurate, the left one cheaper; a point is on "
      "the front "
      "(filled, bold in the tables) as long as no other is at least as accurate and cheaper by more than the repeats "
      "scatter.</p>\n";
  const auto row = [](const std::string &name, const std::string &value) {
    return "<dt>" + name + "</dt><dd>" + escaped(value) + "</dd>\n";
  };
  text += "<dl class=\"meta\">\n" +
          row("Machine", outcome.cpu + ", " + std::to_string(outcome.processors) + " processors" +
                             (outcome.host.empty() ? "" : " (" + outcome.host + ")")) +
          row("Program", "c3de " + program.version + ", build " + program.build) +
          row("Study", study.source.filename().string() + ", seed " + std::to_string(study.seed) + ", " +
                           std::to_string(study.repeat) + (study.repeat == 1 ? " timed run" : " timed runs") +
                           " of each point") +
          row("Date", outcome.date);
  if (const auto &earlier = outcome.earlier)
    text += row("Compared with", "c3de " + earlier->version + ", " + earlier->date + ", " + earlier->cpu);
  text += "</dl>\n";
  if (study.cases.size() > 1) text += "<figure>\n" + overviewOf(study, plan, outcome) + "</figure>\n";
  for (std::size_t c = 0; c < study.cases.size(); ++c) text += caseHtml(study, plan, outcome, c);
  return text + "</body>\n</html>\n";
}

}  // namespace c3de::study
