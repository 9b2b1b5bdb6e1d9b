// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/body_fit.h"

#include <nlohmann/json.hpp>

#include "support/catch.h"

using namespace c3de::session;

TEST_CASE("A fit warns of a curve whose first force is not that of the model") {
  ForceCurve curve;
  curve.displacement_m = {0.0, 0.001, 0.002};
  curve.force_N = {0.01, 0.5, 1.0};
  BodyFit fit;
  fit.verdict = FitVerdict::found;
  fit.predicted = {0.0, 0.5, 1.0};
  fit.measured = 1.0;
  fit.moduli = {{"rubber", 6e4, 5e4, 7e4, true}};
  const auto warnings = [&] { return nlohmann::json::parse(fitJson(fit, curve, {}))["warnings"]; };
  CHECK(warnings().empty());
  curve.force_N[0] = 0.1;
  REQUIRE(warnings().size() == 1);
  CHECK_THAT(warnings()[0].get<std::string>(),
             Contains("begins with 0.1 N, the model with 0 N: an offset of 10 %") && Contains("preload"));
  CHECK_THAT(fitLines(fit, curve, {}).back(), Contains("warning: the curve begins"));
  // With gravity the model begins with a force as well.
  fit.predicted[0] = 0.095;
  CHECK(warnings().empty());
  curve.displacement_m[0] = 0.0005;
  fit.predicted[0] = 0.3;
  CHECK(warnings().empty());
}
