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
  CHECK_FALSE(numberInUnit("5 kg", "mm"));
  CHECK_FALSE(numberInUnit("Pa", "kPa"));
  CHECK_FALSE(numberInUnit("5 N", "kPa"));
  CHECK_FALSE(numberInUnit("", "mm"));
}
