// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "c3de/study/outcome.h"

namespace c3de::study {

/// Points that are joined by a line: of one grid, and of one choice of its levers with texts (evaluation, law, …).
struct Curve {
  std::string label;
  std::vector<std::size_t> points;  ///< in the plan, in its order
};
[[nodiscard]] std::vector<Curve> curvesOf(const Study &study, const Plan &plan, std::size_t ofCase);
/// What tells a point from the others of its curve: "10 mm", "substeps 4".
[[nodiscard]] std::string pointLabel(const Study &study, const Point &point);

/// The name that the labels of all points of a case begin with, so that it can be said once; empty: they have none.
[[nodiscard]] std::string commonLever(const Study &study, std::size_t ofCase);

/// Work-precision diagram of a case as a picture of its own (SVG, no script): error against cost, both logarithmic; what
/// is on the front is filled, failures are crosses above, the uncertainty of the reference is a band.
[[nodiscard]] std::string diagramOf(const Study &study, const Plan &plan, const Outcome &outcome, std::size_t ofCase,
                                    bool hasTitle = true);

/// All cases beside each other in one picture (SVG): a small diagram each, of the curves that at least two cases have.
[[nodiscard]] std::string overviewOf(const Study &study, const Plan &plan, const Outcome &outcome);

/// All of the study as one page (HTML) that needs nothing beside it, for screens and paper.
[[nodiscard]] std::string reportOf(const Study &study, const Plan &plan, const Program &program,
                                   const Outcome &outcome);

/// Three digits, "0.0123", "1.2e-5".
[[nodiscard]] std::string threeDigits(double value);
/// "formula", "finite elements", "measurement", "Richardson extrapolation"
[[nodiscard]] std::string shownKind(const std::string &kind);
/// Text in XML.
[[nodiscard]] std::string escaped(const std::string &text);

}  // namespace c3de::study
