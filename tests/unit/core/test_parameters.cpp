// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>
#include <vector>

#include "c3de/core/parameter.h"
#include "c3de/core/text.h"
#include "support/catch.h"

using namespace c3de;

namespace {

ParameterDecl poisson() {
  ParameterDecl d;
  d.id = "material.poisson_ratio";
  d.min = -1.0;
  d.max = 0.5;
  d.flags = C3DE_PARAM_MIN_OPEN | C3DE_PARAM_MAX_OPEN;
  return d;
}

ParameterValue number(double x) {
  ParameterValue v;
  v.id = "x";
  v.num = x;
  return v;
}

}  // namespace

TEST_CASE("open ends, finiteness and whole numbers are checked") {
  CHECK(checkParameter(poisson(), number(0.45)));
  CHECK_FALSE(checkParameter(poisson(), number(0.5)));
  CHECK_FALSE(checkParameter(poisson(), number(-1.0)));
  CHECK_FALSE(checkParameter(poisson(), number(std::nan(""))));
  ParameterDecl count = poisson();
  count.type = C3DE_PARAM_I64;
  count.max = 10.0;
  CHECK(checkParameter(count, number(3.0)));
  CHECK_FALSE(checkParameter(count, number(3.5)));
}

TEST_CASE("infinity is accepted where the declared range reaches it and nowhere else") {
  const double infinity = std::numeric_limits<double>::infinity();
  ParameterDecl yield = poisson();
  yield.min = 0.0;
  CHECK_FALSE(checkParameter(yield, number(infinity)));
  yield.max = infinity;
  CHECK_FALSE(checkParameter(yield, number(infinity)));  // an open end
  yield.flags = 0;
  CHECK(checkParameter(yield, number(infinity)));
  CHECK(checkParameter(yield, number(0.1)));
  CHECK_FALSE(checkParameter(yield, number(-infinity)));
  CHECK_FALSE(checkParameter(yield, number(std::nan(""))));
}

TEST_CASE("a refusal names the parameter, the value and what is accepted") {
  const auto checked = checkParameter(poisson(), number(0.7));
  REQUIRE_FALSE(checked);
  CHECK_THAT(checked.error().message,
             Contains("material.poisson_ratio") && Contains("0.7") && Contains("-1 < value < 0.5"));
}

TEST_CASE("auto is accepted where it is declared and nowhere else") {
  ParameterValue text;
  text.type = C3DE_PARAM_TEXT;
  text.text = "auto";
  CHECK_FALSE(checkParameter(poisson(), text));
  ParameterDecl dt = poisson();
  dt.flags |= C3DE_PARAM_AUTO;
  CHECK(checkParameter(dt, text));
  text.text = "automatic";
  CHECK_FALSE(checkParameter(dt, text));
}

TEST_CASE("an unknown key is answered with the nearest known one") {
  const std::vector<ParameterDecl> decls{poisson()};
  const auto found = findParameter(decls, "material.poison_ratio");
  REQUIRE_FALSE(found);
  CHECK_THAT(found.error().message, Contains("did you mean 'material.poisson_ratio'"));
  CHECK_THAT(findParameter(decls, "colour").error().message, Contains("known: material.poisson_ratio"));
  CHECK(findParameter(decls, "material.poisson_ratio"));
}

TEST_CASE("the nearest name is near or none") {
  const std::vector<std::string> names{"gravity", "damping", "dt"};
  CHECK(nearestName("gravty", names) == "gravity");
  CHECK(nearestName("dampign", names) == "damping");
  CHECK(nearestName("completely_else", names).empty());
}

TEST_CASE("numbers are written without a locale and read back the same") {
  for (const double x : {0.1, 1e-300, 6000.0, -2.5e17, 1.0 / 3.0}) CHECK(std::stod(formatNumber(x)) == x);
  CHECK(formatNumber(0.5) == "0.5");
}
