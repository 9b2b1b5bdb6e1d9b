// SPDX-License-Identifier: Apache-2.0
#include "c3de/study/richardson.h"

#include <cmath>

#include "support/catch.h"

using namespace c3de::study;

namespace {

std::array<std::vector<double>, 3> sequence(const std::array<double, 3> &h, double limit, double factor, double order) {
  std::array<std::vector<double>, 3> out;
  for (std::size_t i = 0; i < 3; ++i) out[i] = {limit + factor * std::pow(h[i], order)};
  return out;
}

}  // namespace

TEST_CASE("A sequence of known order gives its limit and its order, with any ratios") {
  for (const std::array<double, 3> h :
       {std::array{0.4, 0.2, 0.1}, std::array{0.02, 0.0133, 0.01}, std::array{9.0, 3.0, 2.5}})
    for (const double order : {0.5, 1.0, 2.0, 3.5}) {
      INFO(h[1] << " " << order);
      const auto found = extrapolate(h, sequence(h, -7.0, 3.0, order), {});
      REQUIRE(found);
      CHECK_THAT(found->order, WithinAbs(order, 1e-6));
      CHECK_THAT(found->value[0], WithinAbs(-7.0, 1e-6));
      const double correction = 3.0 * std::pow(h[2], order);
      CHECK_THAT(found->uncertainty, WithinRel(1.25 * correction, 1e-5));
    }
}

TEST_CASE("Runs that do not converge are refused: growing, equal or swinging differences") {
  const std::array h{0.4, 0.2, 0.1};
  CHECK_THAT(extrapolate(h, {{{1.0}, {1.1}, {1.3}}}, {}).error().message, Contains("order is not positive"));
  CHECK_THAT(extrapolate(h, {{{1.0}, {1.1}, {1.2}}}, {}).error().message, Contains("order is not positive"));
  CHECK_THAT(extrapolate(h, {{{1.0}, {1.0}, {1.2}}}, {}).error().message, Contains("order is not positive"));
  CHECK_THAT(extrapolate(h, {{{1.0}, {1.4}, {1.3}}}, {}).error().message, Contains("oscillates"));
  CHECK_THAT(extrapolate(h, {{{1.0}, {NAN}, {1.3}}}, {}).error().message, Contains("not finite"));
}

TEST_CASE("Runs that agree have their own value, and an order that is chance does not shrink the uncertainty") {
  const std::array h{0.4, 0.2, 0.1};
  const auto equal = extrapolate(h, {{{2.0}, {2.0}, {2.0}}}, {});
  REQUIRE(equal);
  CHECK(equal->value[0] == 2.0);
  CHECK(equal->uncertainty == 0.0);
  const auto lucky = extrapolate(h, {{{3.0}, {2.0}, {2.0 - 1e-9}}}, {});
  REQUIRE(lucky);
  CHECK(lucky->order > 20.0);
  CHECK_THAT(lucky->uncertainty, WithinRel(1.25e-9 / 15.0, 1e-3));  // of order 4
}

TEST_CASE("A field converges by its norm, each component to its own limit") {
  const std::array h{0.3, 0.2, 0.1};
  std::array<std::vector<double>, 3> f;
  for (std::size_t i = 0; i < 3; ++i) f[i] = {1.0 + 2.0 * h[i] * h[i], -5.0 - h[i] * h[i], 4.0};
  const auto found = extrapolate(h, f, {1.0, 2.0, 1.0});
  REQUIRE(found);
  CHECK_THAT(found->order, WithinAbs(2.0, 1e-6));
  CHECK_THAT(found->value[0], WithinAbs(1.0, 1e-9));
  CHECK_THAT(found->value[1], WithinAbs(-5.0, 1e-9));
  CHECK(found->value[2] == 4.0);
  CHECK_THAT(found->uncertainty, WithinRel(1.25 * 0.01 * std::sqrt(4.0 + 2.0), 1e-6));
  const auto largest = extrapolate(h, f, {});
  REQUIRE(largest);
  CHECK_THAT(largest->uncertainty, WithinRel(1.25 * 0.02, 1e-6));
}
