// SPDX-License-Identifier: Apache-2.0
#include "logic/display_units.h"

#include <limits>

#include "support/catch.h"

using namespace c3de;
using namespace c3de::ui;

namespace {

ParameterDecl declaration(const std::string &unit, double low, double high) {
  ParameterDecl decl;
  decl.id = "test." + unit;
  decl.type = C3DE_PARAM_F64;
  decl.unit = unit;
  decl.max = std::numeric_limits<double>::infinity();
  decl.softMin = low;
  decl.softMax = high;
  decl.fallback = high;
  return decl;
}

ParameterValue number(const ParameterDecl &decl, double x) {
  ParameterValue value;
  value.id = decl.id;
  value.type = C3DE_PARAM_F64;
  value.num = x;
  return value;
}

}  // namespace

TEST_CASE("a stiffness in Pa is shown in kPa, a length in m in mm, and every number comes back as it was") {
  const ParameterDecl stiffness = declaration("Pa", 100.0, 1e6), length = declaration("m", 0.001, 0.05);
  CHECK(shownDeclaration(stiffness).unit == "kPa");
  CHECK(shownDeclaration(stiffness).softMax == 1000.0);
  CHECK(shownDeclaration(stiffness).fallback == 1000.0);
  CHECK(shownDeclaration(stiffness).max == std::numeric_limits<double>::infinity());
  CHECK(shownDeclaration(length).unit == "mm");
  CHECK(shownDeclaration(length).softMin == 1.0);
  for (int i = 1; i < 5000; ++i) {
    const double kPa = 0.01 * i, mm = 0.1 * i;
    const double Pa = declaredValue(stiffness, number(stiffness, kPa)).num;
    const double m = declaredValue(length, number(length, mm)).num;
    // Typed, stored and shown again it is the same number, to the digits that a double has.
    CHECK_THAT(declaredValue(stiffness, shownValue(stiffness, number(stiffness, Pa))).num, WithinRel(Pa, 1e-15));
    CHECK_THAT(declaredValue(length, shownValue(length, number(length, m))).num, WithinRel(m, 1e-15));
  }
  CHECK(shownValue(length, number(length, 0.0085)).num == 8.5);
  CHECK(declaredValue(length, number(length, 2.5)).num == 0.0025);
}

TEST_CASE("units without a better one, and texts, stay as they are") {
  for (const ParameterDecl &decl : {declaration("Pa/m", 0.0, 1e6), declaration("s", 1e-5, 0.02),
                                    declaration("Pa", 0.0, 5.0), declaration("m", 0.0, 500.0)}) {
    CHECK(shownDeclaration(decl).unit == decl.unit);
    CHECK(shownValue(decl, number(decl, 3.0)).num == 3.0);
    CHECK(declaredValue(decl, number(decl, 3.0)).num == 3.0);
  }
  const ParameterDecl length = declaration("m", 0.001, 0.05);
  ParameterValue automatic;
  automatic.type = C3DE_PARAM_TEXT;
  automatic.text = "auto";
  CHECK(shownValue(length, automatic).text == "auto");
}

TEST_CASE("vectors are shown component by component") {
  ParameterDecl corner = declaration("m", -1.0, 1.0);
  corner.type = C3DE_PARAM_VEC3;
  ParameterValue at;
  at.type = C3DE_PARAM_VEC3;
  at.vec = {-0.2, 0.0375, 1.0};
  const ParameterValue shown = shownValue(corner, at);
  CHECK(shown.vec == Vec3{-200.0, 37.5, 1000.0});
  CHECK(declaredValue(corner, shown).vec == at.vec);
}

TEST_CASE("the user's units apply to lengths, pressures and forces, and every number comes back as it was") {
  const DisplayUnits units{DisplayUnits::Length::cm, DisplayUnits::Pressure::mmHg, DisplayUnits::Force::mN};
  const ParameterDecl stiffness = declaration("Pa", 100.0, 1e6), low = declaration("Pa", 0.0, 5.0),
                      length = declaration("m", 0.001, 0.05), force = declaration("N", 0.0, 10.0);
  CHECK(shownDeclaration(stiffness, units).unit == "mmHg");
  CHECK(shownDeclaration(low, units).unit == "mmHg");
  CHECK(shownDeclaration(length, units).unit == "cm");
  CHECK(shownDeclaration(length, units).softMax == 5.0);
  CHECK(shownDeclaration(force, units).unit == "mN");
  CHECK_THAT(shownValue(stiffness, number(stiffness, 13332.2), units).num, WithinRel(100.0, 1e-12));
  CHECK_THAT(declaredValue(stiffness, number(stiffness, 100.0), units).num, WithinRel(13332.2, 1e-12));
  CHECK(shownValue(length, number(length, 0.0085), units).num == 0.85);
  CHECK(declaredValue(length, number(length, 2.5), units).num == 0.025);
  CHECK(declaredValue(force, number(force, 250.0), units).num == 0.25);
  const DisplayUnits pascal{DisplayUnits::Length::mm, DisplayUnits::Pressure::Pa, DisplayUnits::Force::N};
  CHECK(shownDeclaration(stiffness, pascal).unit == "Pa");
  CHECK(shownDeclaration(declaration("Pa/m", 0.0, 1e6), units).unit == "Pa/m");
}

TEST_CASE("a text with a number and its unit is shown in the user's unit with as many digits") {
  const DisplayUnits units{DisplayUnits::Length::cm, DisplayUnits::Pressure::mmHg, DisplayUnits::Force::mN};
  CHECK(shownText(units, "12.3 mm") == "1.23 cm");
  CHECK(shownText(units, "0.25 N") == "250 mN");
  CHECK(shownText(units, "0.2537 N") == "253.7 mN");
  CHECK(shownText(units, "-4 mm") == "-0.4 cm");
  CHECK(shownText(units, "13.3 kPa") == "99.8 mmHg");
  CHECK(shownText(units, "1e-05 N") == "0.01 mN");
  for (const char *text : {"–", "12.3 mm²", "7 s", "about 3 mm", "mm", "", "5", "3 mm and 4 mm"})
    CHECK(shownText(units, text) == text);
  CHECK(shownText({}, "12.3 mm") == "12.3 mm");
  const DisplayUnits pascal{DisplayUnits::Length::mm, DisplayUnits::Pressure::Pa, DisplayUnits::Force::N};
  CHECK(shownText(pascal, "1.25 kPa") == "1250 Pa");
}

TEST_CASE("a typed number may have another unit of the same quantity") {
  CHECK(numberInUnit("9", "kPa") == 9.0);
  CHECK(numberInUnit("9 kPa", "kPa") == 9.0);
  CHECK(numberInUnit("9000 Pa", "kPa") == 9.0);
  CHECK(numberInUnit("0.009 MPa", "kPa") == 9.0);
  CHECK_THAT(numberInUnit("100 mmHg", "kPa").value_or(0.0), WithinRel(13.3322, 1e-12));
  CHECK(numberInUnit("0.5 m", "mm") == 500.0);
  CHECK(numberInUnit("5 cm", "mm") == 50.0);
  CHECK(numberInUnit("5 mm", "mm") == 5.0);
  CHECK(numberInUnit("2 l", "ml") == 2000.0);
  CHECK(numberInUnit("5 mm", "cm") == 0.5);
  CHECK(numberInUnit("0.25 N", "mN") == 250.0);
  CHECK_THAT(numberInUnit("13.3322 kPa", "mmHg").value_or(0.0), WithinRel(100.0, 1e-12));
  CHECK_FALSE(numberInUnit("5 kg", "mm"));
  CHECK_FALSE(numberInUnit("Pa", "kPa"));
  CHECK_FALSE(numberInUnit("5 N", "kPa"));
  CHECK_FALSE(numberInUnit("", "mm"));
}
