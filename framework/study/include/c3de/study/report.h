// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "c3de/study/outcome.h"

namespace c3de::study {

/// Points joined by a line: of one grid, with equal values of its study parameters that have texts (evaluation, law,
/// …).
struct Curve {
  std::string label;
  std::vector<std::size_t> points;  ///< in the plan, in its order
};
[[nodiscard]] std::vector<Curve> curvesOf(const Study &study, const Plan &plan, std::size_t ofCase);
/// Distinguishes a point from the others of its curve: "10 mm", "substeps 4".
[[nodiscard]] std::string pointLabel(const Study &study, const Point &point);

/// The name with which the labels of all points of a case begin, so that it is written once; empty if they have none.
[[nodiscard]] std::string commonParameter(const Study &study, std::size_t ofCase);

/// Work-precision diagram of a case as a separate picture (SVG, no script): error against cost, both logarithmic.
/// Points on the front are filled, failures are crosses at the top, the uncertainty of the reference is a band.
[[nodiscard]] std::string diagramOf(const Study &study, const Plan &plan, const Outcome &outcome, std::size_t ofCase,
                                    bool hasTitle = true);

/// All cases in one picture (SVG): a small diagram for each, with the curves that at least two cases have.
[[nodiscard]] std::string overviewOf(const Study &study, const Plan &plan, const Outcome &outcome);

/// The whole study as one self-contained page (HTML), for screens and paper.
[[nodiscard]] std::string reportOf(const Study &study, const Plan &plan, const Program &program,
                                   const Outcome &outcome);

/// Three digits, "0.0123", "1.2e-5".
[[nodiscard]] std::string threeDigits(double value);
/// "formula", "finite elements", "measurement", "Richardson extrapolation"
[[nodiscard]] std::string shownKind(const std::string &kind);
/// Text escaped for XML.
[[nodiscard]] std::string escaped(const std::string &text);

}  // namespace c3de::study
