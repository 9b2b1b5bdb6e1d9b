// SPDX-License-Identifier: Apache-2.0
#include "parameters.h"

#include <cstdio>

#include "c3de/abi/iface/parameter_ids.h"

namespace mass_spring {
namespace {

using sdk::Error;

constexpr std::array kWorld{
    sdk::vec3Param({C3DE_PARAM_ID_GRAVITY, "Gravity", "m/s²", "Acceleration of everything that is free", "World"},
                   {-1e4, 1e4, -20.0, 20.0}, {0.0, -9.81, 0.0}),
    sdk::boolParam(
        {C3DE_PARAM_ID_BOX_ENABLED, "Walls", "", "Walls that masses do not pass; they take their speed", "World"},
        false),
    sdk::vec3Param({C3DE_PARAM_ID_BOX_MIN, "Walls from", "m", "Lower corner of the walls", "World"},
                   {-1e4, 1e4, -1.0, 1.0}, {-1.0, -1.0, -1.0}),
    sdk::vec3Param({C3DE_PARAM_ID_BOX_MAX, "Walls to", "m", "Upper corner of the walls", "World"},
                   {-1e4, 1e4, -1.0, 1.0}, {1.0, 1.0, 1.0}),
    sdk::numberParam({C3DE_PARAM_ID_DAMPING, "Damping", "1/s", "Rate at which all velocities decay; 0: none", "Solver"},
                     {0.0, 1e6, 0.0, 20.0}, 0.5),
    sdk::autoParam({"solver.dt", "Step", "s", "auto: the stable one; a longer one is refused", "Solver"},
                   {0.0, 1.0, 1e-5, 1e-2}, C3DE_PARAM_MIN_OPEN | C3DE_PARAM_LOG_SCALE),
};

constexpr std::array kBody{
    sdk::numberParam({C3DE_PARAM_ID_YOUNGS_MODULUS, "Young's modulus", "Pa",
                      "Stiffness at small strain; Poisson's ratio of the lattice is 1/4", "Material"},
                     {0.0, 1e12, 100.0, 1e6}, 6000.0, C3DE_PARAM_MIN_OPEN | C3DE_PARAM_LOG_SCALE),
    sdk::numberParam({C3DE_PARAM_ID_DENSITY, "Density", "kg/m³", "Mass per volume at rest", "Material"},
                     {0.0, 1e6, 100.0, 3000.0}, 1060.0, C3DE_PARAM_MIN_OPEN),
    sdk::numberParam({"material.retardation_time", "Retardation time", "s",
                      "Springs are damped by their stiffness times this; rigid motion is not", "Material"},
                     {0.0, 1e3, 0.0, 0.05}, 0.001),
    sdk::autoParam({C3DE_PARAM_ID_SPACING, "Spacing", "m", "Of the lattice; auto: by the count", "Sampling"},
                   {0.0, 1e4, 0.001, 0.05}, C3DE_PARAM_NEEDS_RESET | C3DE_PARAM_MIN_OPEN | C3DE_PARAM_LOG_SCALE),
    sdk::integerParam({C3DE_PARAM_ID_COUNT, "Count", "", "Cells of the lattice, about, when the spacing is auto",
                       "Sampling", C3DE_PARAM_ID_SPACING},
                      {1.0, 1e6, 50.0, 5000.0}, 1000.0, C3DE_PARAM_NEEDS_RESET | C3DE_PARAM_LOG_SCALE),
};

std::string numberText(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

std::string shown(const c3de_param_value &v) {
  switch (v.type) {
    case C3DE_PARAM_TEXT:
    case C3DE_PARAM_CHOICE: return '"' + std::string(sdk::text(v.text)) + '"';
    case C3DE_PARAM_VEC3:
      return "[" + numberText(v.vec[0]) + ", " + numberText(v.vec[1]) + ", " + numberText(v.vec[2]) + "]";
    case C3DE_PARAM_BOOL: return v.num != 0.0 ? "true" : "false";
    default: return numberText(v.num);
  }
}

std::string accepted(const c3de_param_decl &d) {
  if (d.type == C3DE_PARAM_BOOL) return "true or false";
  if (d.type == C3DE_PARAM_CHOICE) {
    std::string list;
    for (std::uint64_t i = 0; i < d.choices_n; ++i) list += (i > 0 ? " | " : "") + std::string(sdk::text(d.choices[i]));
    return list;
  }
  const std::string range = numberText(d.min) + ((d.flags & C3DE_PARAM_MIN_OPEN) ? " < value " : " <= value ") +
                            ((d.flags & C3DE_PARAM_MAX_OPEN) ? "< " : "<= ") + numberText(d.max) +
                            (d.unit.len > 0 ? " " + std::string(sdk::text(d.unit)) : "");
  if (d.type == C3DE_PARAM_VEC3) return "three numbers, each " + range;
  if (d.type == C3DE_PARAM_I64) return "a whole number, " + range;
  return (d.flags & C3DE_PARAM_AUTO) ? "\"auto\" or " + range : range;
}

bool isAutoText(const c3de_param_value &v) {
  return (v.type == C3DE_PARAM_TEXT || v.type == C3DE_PARAM_CHOICE) && sdk::text(v.text) == "auto";
}

/// The text of the declaration; null: it has none such.
const c3de_str *chosen(const c3de_param_decl &d, const c3de_param_value &v) {
  if (v.type != C3DE_PARAM_TEXT && v.type != C3DE_PARAM_CHOICE) return nullptr;
  for (std::uint64_t i = 0; i < d.choices_n; ++i)
    if (sdk::text(d.choices[i]) == sdk::text(v.text)) return &d.choices[i];
  return nullptr;
}

bool fits(const c3de_param_decl &d, const c3de_param_value &v) {
  const auto inRange = [&](double x) {
    return std::isfinite(x) && ((d.flags & C3DE_PARAM_MIN_OPEN) ? x > d.min : x >= d.min) &&
           ((d.flags & C3DE_PARAM_MAX_OPEN) ? x < d.max : x <= d.max);
  };
  if ((d.flags & C3DE_PARAM_AUTO) && isAutoText(v)) return true;
  if (d.type == C3DE_PARAM_BOOL) return v.type == C3DE_PARAM_BOOL;
  if (d.type == C3DE_PARAM_CHOICE) return chosen(d, v) != nullptr;
  if (d.type == C3DE_PARAM_VEC3)
    return v.type == C3DE_PARAM_VEC3 && inRange(v.vec[0]) && inRange(v.vec[1]) && inRange(v.vec[2]);
  return (v.type == C3DE_PARAM_F64 || v.type == C3DE_PARAM_I64) && inRange(v.num) &&
         (d.type != C3DE_PARAM_I64 || v.num == std::floor(v.num));
}

}  // namespace

std::span<const c3de_param_decl> worldDeclarations() { return kWorld; }
std::span<const c3de_param_decl> bodyDeclarations() { return kBody; }

const c3de_param_decl &ParameterValues::declaration(std::string_view id) const {
  std::string known;
  for (const c3de_param_decl &d : declarations_) {
    if (sdk::text(d.id) == id) return d;
    known += " " + std::string(sdk::text(d.id));
  }
  throw Error(C3DE_E_NOT_FOUND, "unknown parameter '" + std::string(id) + "'; known:" + known);
}

void ParameterValues::set(const c3de_param_value &in) {
  const c3de_param_decl &d = declaration(sdk::text(in.id));
  if (!fits(d, in))
    throw Error(C3DE_E_ARG,
                std::string(sdk::text(d.id)) + " = " + shown(in) + " is not accepted; accepted: " + accepted(d));
  c3de_param_value kept{};
  kept.size = sizeof kept;
  kept.id = d.id;
  const bool isAuto = d.type != C3DE_PARAM_CHOICE && isAutoText(in);
  kept.type = isAuto ? C3DE_PARAM_TEXT : d.type;
  kept.num = in.num;
  if (isAuto) kept.text = sdk::str("auto");
  if (d.type == C3DE_PARAM_CHOICE) kept.text = *chosen(d, in);
  std::copy_n(in.vec, 3, kept.vec);
  values_[std::string(sdk::text(d.id))] = kept;
}

void ParameterValues::set(const c3de_param_value *values, std::uint64_t n, std::uint64_t stride) {
  ParameterValues changed = *this;
  for (std::uint64_t i = 0; i < n; ++i) changed.set(sdk::readElement(values, i, stride, "value"));
  *this = std::move(changed);
}

c3de_param_value ParameterValues::value(std::string_view id) const {
  if (const auto found = values_.find(id); found != values_.end()) return found->second;
  const c3de_param_decl &d = declaration(id);
  c3de_param_value out{};
  out.size = sizeof out;
  out.id = d.id;
  out.type = d.type != C3DE_PARAM_CHOICE && sdk::text(d.fallback_text) == "auto" ? C3DE_PARAM_TEXT : d.type;
  out.num = d.fallback;
  out.text = d.fallback_text;
  std::copy_n(d.fallback_vec, 3, out.vec);
  return out;
}

}  // namespace mass_spring
