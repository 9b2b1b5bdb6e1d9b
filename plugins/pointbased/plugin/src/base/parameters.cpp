// SPDX-License-Identifier: Apache-2.0
#include "base/parameters.h"

#include "base/accuracy_target.h"
#include "c3de/abi/iface/parameter_ids.h"
#include "c3de/sdk/structs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace pointbased {
namespace {

using namespace c3de::sdk;

constexpr std::array<c3de_str, 4> kLaws{str("neo_hookean"), str("stvk"), str("corotated"), str("linear")};
constexpr std::array<c3de_str, 6> kIntegrators{str("auto"),     str("explicit"),       str("implicit"),
                                               str("midpoint"), str("backward_euler"), str("quasistatic")};
constexpr std::array<c3de_str, 3> kPrecisions{str("auto"), str("double"), str("single")};
constexpr std::array<c3de_str, 5> kPreconditioners{str("auto"), str("multigrid"), str("block_jacobi"),
                                                   str("incomplete"), str("factorised")};
constexpr std::array<c3de_str, 3> kAdaptive{str("auto"), str("on"), str("off")};
constexpr std::array<c3de_str, 3> kOrders{str("auto"), str("linear"), str("quadratic")};
constexpr std::array<c3de_str, 3> kEvaluations{str("auto"), str("stress_points"), str("phyxels")};
constexpr std::array<c3de_str, 3> kSurfaces{str("opaque"), str("transparent"), str("hidden")};
constexpr std::array<c3de_str, 3> kPoints{str("evaluation_points"), str("phyxels"), str("none")};
constexpr std::array<c3de_str, 7> kColourings{str("material"),         str("displacement"), str("von_mises"),
                                              str("contact_pressure"), str("error"),        str("stabilisation"),
                                              str("verified")};
constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kRetardationTime = 0.02;  // s: soft tissue of 3 kPa and 60 Pa s
constexpr double kFar = 1e6;               // m; beyond it, doubles no longer resolve a micrometre next to a body

constexpr std::array kWorld{
    vec3Param({"world.gravity", "Gravity", "m/s²", "Acceleration of everything; zero: floating", "Gravity"},
              {-1000.0, 1000.0, -10.0, 10.0}, {0.0, 0.0, 0.0}),
    vec3Param(
        {"world.scan_gravity", "Gravity of the scan", "m/s²",
         "Gravity in which the scan was taken: bodies are in balance with it where they lie, so only what gravity "
         "differs from it moves them; zero: they begin without stress and sag",
         "World"},
        {-1000.0, 1000.0, -10.0, 10.0}, {0.0, 0.0, 0.0}),
    boolParam({"world.box.enabled", "World box", "", "Walls that confine all bodies", "World"}, false),
    vec3Param({"world.box.min", "Box, lower corner", "m", "Lower corner of the walls", "World"},
              {-kFar, kFar, -1.0, 1.0}, {-1.0, -1.0, -1.0}),
    vec3Param({"world.box.max", "Box, upper corner", "m", "Upper corner of the walls", "World"},
              {-kFar, kFar, -1.0, 1.0}, {1.0, 1.0, 1.0}),
    numberParam({"world.box.friction", "Wall friction", "", "Coulomb coefficient of the walls; 0: slippery", "World"},
                {0.0, 10.0, 0.0, 1.0}, 0.3),
    numberParam({"world.box.restitution", "Wall restitution", "",
                 "Part of its speed with which a point of the skin leaves the walls in explicit steps; 0: what arrives "
                 "stays, 1: "
                 "contact takes no energy",
                 "World"},
                {0.0, 1.0, 0.0, 1.0}, 0.0, C3DE_PARAM_ADVANCED),
    boolParam({C3DE_PARAM_ID_CONTACT_ENABLED, "Contact between bodies", "",
               "Contact of bodies with each other and with themselves; contact with obstacles and walls is always on",
               "Contact"},
              true),
    boolParam({C3DE_PARAM_ID_CONTACT_SELF, "Contact with itself", "",
               "Folds of a body touch each other; a fine skin that lies in many folds takes long", "Contact"},
              true, C3DE_PARAM_ADVANCED),
    numberParam({C3DE_PARAM_ID_CONTACT_FRICTION, "Friction between bodies", "",
                 "Coulomb coefficient of bodies with each other and with themselves, where a pair says nothing of its "
                 "own; 0: slippery",
                 "Contact"},
                {0.0, 10.0, 0.0, 1.0}, 0.3),
    choiceParam(
        {"solver.integrator", "Integrator", "",
         "auto: explicit or implicit, what is predicted to cost less for a body. explicit: velocity Verlet, in "
         "substeps where stability needs them. implicit: second order, for stiff bodies. "
         "midpoint: second order without any damping. backward_euler: first order, damps. quasistatic: equilibrium "
         "under loads that grow",
         "Solver"},
        kIntegrators, "auto"),
    autoParam({"solver.dt", "Step", "s",
               "Size of a step. auto: explicit 0.8 of the largest stable one, implicit 1/60; a larger explicit one is "
               "divided "
               "into substeps, a smaller one costs time",
               "Solver"},
              {1e-9, 1.0, 1e-5, 0.02}, C3DE_PARAM_LOG_SCALE),
    numberParam({"solver.damping", "Damping", "1/s",
                 "Mass-proportional: velocities, those of a fall too, decay by exp(-damping t); 0: none", "Solver"},
                {0.0, 1e4, 0.0, 20.0}, 0.0),
    autoParam({"solver.tolerance_mm", "Tolerance", "mm",
               "Implicit and quasi-static: converged when a full correction moves no phyxel further. auto: 1e-5 of the "
               "spacing, quasi-static 1e-6. Increments below ten times that are solved to 0.2 %",
               "Solver"},
              {1e-12, 1000.0, 1e-6, 1.0}, C3DE_PARAM_LOG_SCALE | C3DE_PARAM_ADVANCED),
    integerParam({"solver.load_steps", "Load steps", "", "Quasi-static: increments of the load; halved where one fails",
                  "Solver"},
                 {1.0, 10000.0, 1.0, 50.0}, 10.0),
    autoParam(
        {"solver.step_budget", "Time for a step", "s",
         "A step that exceeds this computing time is abandoned: the previous state is kept, and a remedy is proposed. "
         "Time used by other programs and for drawing does not count. No step is abandoned while a tool holds or "
         "touches tissue. auto: 10 s in a window, no limit without one",
         "Solver"},
        {0.01, 1e6, 0.1, 60.0}, C3DE_PARAM_LOG_SCALE),
    boolParam({"solver.sleep", "Sleep", "",
               "Bodies that have come to rest cost nothing until something touches or changes them", "Solver"},
              true),
    choiceParam({"solver.preconditioner", "Preconditioner", "", "Of the linear solutions; auto: by size, as measured",
                 "Solver"},
                kPreconditioners, "auto"),
    choiceParam(
        {"solver.precision", "Precision", "",
         "Of the forces in explicit steps. single: about 1.5 times as fast, strains to about 1e-6. auto: single where "
         "an accuracy is wished that is far coarser than that, else double. Implicit and quasi-static solutions are "
         "double always",
         "Solver"},
        kPrecisions, "auto"),
    autoParam({C3DE_PARAM_ID_ERROR_PERCENT, "Error at most, in %", "%",
               "Largest error of the skin at rest, as a fraction of the largest displacement; bodies that are built "
               "from now on are sampled for it. auto: 5 % where that is affordable",
               "Accuracy"},
              {0.01, 100.0, 0.5, 20.0}, C3DE_PARAM_LOG_SCALE),
    autoParam({C3DE_PARAM_ID_ERROR_MM, "Error at most, in mm", "mm",
               "Largest error of the skin at rest; bodies that are built from now on are sampled for it. auto: "
               "use the other targets",
               "Error in mm"},
              {1e-6, 1e4, 0.01, 10.0}, C3DE_PARAM_LOG_SCALE),
    autoParam({C3DE_PARAM_ID_BUDGET_MS, "Budget", "ms",
               "What 1/60 s of simulated time may take to compute, all bodies together: as accurate as that allows",
               "Accuracy"},
              {0.01, 1e5, 1.0, 100.0}, C3DE_PARAM_LOG_SCALE),
    integerParam({C3DE_PARAM_ID_ACCURACY_BODIES, "Bodies", "", "How many bodies share the budget", "Accuracy"},
                 {1.0, 1e6, 1.0, 100.0}, 1.0, C3DE_PARAM_ADVANCED),
    choiceParam(
        {"view.surface", "Surface", "", "Display of the skin; interior points are visible unless it is opaque", "View"},
        kSurfaces, "opaque"),
    choiceParam(
        {"view.points", "Points inside", "",
         "evaluation_points: where strain and stress are evaluated, inside the body; phyxels: what carries mass and "
         "moves, on a lattice the corners of its cells, some of them outside of the body",
         "View"},
        kPoints, "evaluation_points"),
    choiceParam(
        {"view.colour", "Colour by", "",
         "material: plain. displacement: from the rest position, mm. von_mises: Cauchy stress, kPa. contact_pressure: "
         "by "
         "which others press on the skin, kPa. error: how far off "
         "the strains are by estimate, % of the body's mean. stabilisation: energy that the cells cannot resolve, %. "
         "verified: error of the displacement after Verify, mm; plain once the state moves on",
         "Colour"},
        kColourings, "material"),
    autoParam(
        {"view.range", "Colour range", "",
         "Value of the last colour, in the unit of the legend; what is larger has the last colour too. auto: above "
         "nearly all values, a round number",
         "View"},
        {0.0, 1e15, 0.1, 1000.0}, C3DE_PARAM_LOG_SCALE | C3DE_PARAM_MIN_OPEN),
};

constexpr c3de_param_decl integerOrAuto(c3de_param_decl d) {
  d.type = C3DE_PARAM_I64;
  return d;
}

constexpr c3de_param_decl neighboursParam() {
  return integerOrAuto(autoParam({"sampling.neighbours", "Neighbours", "",
                                  "Nearest neighbours of a phyxel (26: a lattice's first shells); auto: all within the "
                                  "support. More: softer and slower, not better",
                                  "Sampling"},
                                 {3.0, 500.0, 8.0, 100.0}, C3DE_PARAM_NEEDS_RESET));
}

constexpr std::array kBody{
    choiceParam(
        {"material.law", "Law", "",
         "neo_hookean: resists collapse and recovers from inversion; stvk: linear in Green strain, softens under "
         "compression; corotated: linear in the stretch; linear: small strain and small rotation only",
         "Material"},
        kLaws, "neo_hookean"),
    numberParam({"material.youngs_modulus", "Young's modulus", "Pa",
                 "Stiffness; the stable step shrinks with its root. Liver about 6 kPa", "Stiffness"},
                {0.0, 1e12, 100.0, 1e6}, 6000.0, C3DE_PARAM_LOG_SCALE | C3DE_PARAM_MIN_OPEN),
    autoParam(
        {C3DE_PARAM_ID_YOUNGS_MODULUS_LOW, "Young's modulus, at least", "Pa",
         "Where the stiffness of such tissue begins: nothing is computed from it, it is shown beside the error. auto: "
         "half",
         "Material"},
        {0.0, 1e12, 100.0, 1e6}, C3DE_PARAM_LOG_SCALE | C3DE_PARAM_MIN_OPEN | C3DE_PARAM_ADVANCED),
    autoParam({C3DE_PARAM_ID_YOUNGS_MODULUS_HIGH, "Young's modulus, at most", "Pa",
               "Where it ends. auto: half as much again", "Material"},
              {0.0, 1e12, 100.0, 1e6}, C3DE_PARAM_LOG_SCALE | C3DE_PARAM_MIN_OPEN | C3DE_PARAM_ADVANCED),
    numberParam({"material.poisson_ratio", "Poisson's ratio", "",
                 "Resistance to a change of volume; near 0.5 the stable step becomes very small", "Material"},
                {-1.0, 0.5, 0.0, 0.49}, 0.45, C3DE_PARAM_MIN_OPEN | C3DE_PARAM_MAX_OPEN),
    numberParam({"material.density", "Density", "kg/m³", "Mass per volume at rest", "Material"},
                {0.0, 1e6, 100.0, 3000.0}, 1060.0, C3DE_PARAM_MIN_OPEN),
    numberParam({"material.viscosity", "Viscosity", "Pa s",
                 "Damps deformation, not rigid motion: viscous stress 2 eta dE/dt. Large values shrink the stable step",
                 "Material"},
                {0.0, 1e9, 0.0, 50.0}, 0.0),
    numberParam({"material.volume_stiffness", "Volume stiffness", "Pa",
                 "Müller's volume conservation: k_v/2 (J - 1)² on top of Poisson's ratio; 0: none", "Material"},
                {0.0, 1e12, 0.0, 1e6}, 0.0, C3DE_PARAM_ADVANCED),
    numberParam({"material.plastic.yield", "Yield", "",
                 "Elastic deviatoric strain (Hencky norm) above which the material flows; inf: never", "Plasticity"},
                {0.0, kNever, 0.0, 1.0}, kNever),
    numberParam({"material.plastic.creep", "Creep", "",
                 "Part of the excess strain that flows within the creep time; 1: at once, 0: elastic", "Plasticity"},
                {0.0, 1.0, 0.0, 1.0}, 1.0),
    numberParam({"material.plastic.creep_time", "Creep time", "s", "Time to which creep refers", "Plasticity"},
                {0.0, 1e9, 0.001, 10.0}, 1.0 / 60.0, C3DE_PARAM_MIN_OPEN | C3DE_PARAM_LOG_SCALE),
    numberParam({"material.plastic.max", "Largest flow", "",
                 "Cap of the plastic strain (Hencky norm); 0: elastic, inf: the body can melt", "Plasticity"},
                {0.0, kNever, 0.0, 5.0}, kNever),
    numberParam({"material.prony1.share", "Relaxation 1, share", "",
                 "Part of the shear modulus that relaxes with the first time; 0: none", "Relaxation"},
                {0.0, 1.0, 0.0, 0.9}, 0.0, C3DE_PARAM_MAX_OPEN | C3DE_PARAM_TOGETHER),
    numberParam({"material.prony1.time", "Relaxation 1, time", "s", "Relaxation time", "Relaxation"},
                {0.0, 1e9, 0.01, 100.0}, 1.0, C3DE_PARAM_MIN_OPEN | C3DE_PARAM_LOG_SCALE | C3DE_PARAM_TOGETHER),
    numberParam({"material.prony2.share", "Relaxation 2, share", "", "The same for a second time", "Relaxation"},
                {0.0, 1.0, 0.0, 0.9}, 0.0, C3DE_PARAM_MAX_OPEN | C3DE_PARAM_TOGETHER),
    numberParam({"material.prony2.time", "Relaxation 2, time", "s", "Relaxation time", "Relaxation"},
                {0.0, 1e9, 0.01, 100.0}, 10.0, C3DE_PARAM_MIN_OPEN | C3DE_PARAM_LOG_SCALE | C3DE_PARAM_TOGETHER),
    numberParam({"surroundings.stiffness", "Held by surroundings", "Pa/m",
                 "Elastic foundation: surrounding tissue pulls every surface point to its reference position, stress "
                 "per displacement. 0: none. 3e4: an organ sinks some millimetres under its own weight",
                 "Surroundings"},
                {0.0, 1e12, 0.0, 1e6}, 0.0),
    autoParam({"surroundings.tangential", "Along the surface", "Pa/m", "The same across the normal; auto: as much",
               "Surroundings"},
              {0.0, 1e12, 0.0, 1e6}, C3DE_PARAM_ADVANCED),
    numberParam({"surroundings.retardation_time", "Retardation time", "s",
                 "Of the tissue around (Kelvin-Voigt): it damps by its stiffness times this time; 0: swings undamped",
                 "Surroundings"},
                {0.0, 1e6, 0.0, 0.1}, kRetardationTime, C3DE_PARAM_ADVANCED),
    boolParam({"rigid", "Rigid", "",
               "Keeps its shape and stays fixed in its reference position, at no cost. For bone, which would otherwise "
               "limit every step. Other bodies collide with it",
               "Surroundings"},
              false),
    boolParam({C3DE_PARAM_ID_FREE, "Free", "",
               "Where it is rigid: it moves with its mass, by weight, loads, hands and what it touches, instead of "
               "being fixed: a loose implant or bone. Deformable bodies always move",
               "Surroundings"},
              false),
    choiceParam({"sampling.evaluation", "Evaluation", "",
                 "stress_points: cells of a lattice cut by the body, accurate at any sampling; phyxels: the method of "
                 "Müller et "
                 "al. 2004; auto: stress_points",
                 "Sampling"},
                kEvaluations, "auto", C3DE_PARAM_NEEDS_RESET),
    autoParam({"sampling.spacing", "Spacing", "m",
               "Distance of the phyxels; auto: chosen by the count. Too large: the shape is not resolved; too small: "
               "slow, for "
               "count and step both",
               "Sampling"},
              {0.0, 1e4, 0.001, 0.05}, C3DE_PARAM_NEEDS_RESET | C3DE_PARAM_MIN_OPEN | C3DE_PARAM_LOG_SCALE),
    integerOrAuto(autoParam(
        {"sampling.count", "Count", "",
         "How many phyxels, within some per cent, when the spacing is auto. auto: 1000, of thin bodies up "
         "to 4000, so that the spacing is at most half of the thickness",
         "Sampling", C3DE_PARAM_ID_SPACING},
        {1.0, static_cast<double>(kMaximumPhyxels), 50.0, 5000.0}, C3DE_PARAM_NEEDS_RESET | C3DE_PARAM_LOG_SCALE)),
    choiceParam(
        {"sampling.adaptive", "Refine here", "",
         "stress_points: cells are halved where a trial solution under supports, loads and hands has most of its "
         "error, for as many phyxels in all; few that would shorten explicit steps get more inertia. auto: bodies of "
         "several tissues that something leads or loads",
         "Sampling"},
        kAdaptive, "auto", C3DE_PARAM_NEEDS_RESET),
    numberParam({"sampling.surface_spacing", "Surface spacing", "m",
                 "stress_points: cells that the surface cuts are divided until they are at most this; 0: as inside",
                 "Sampling"},
                {0.0, 1e4, 0.0, 0.02}, 0.0, C3DE_PARAM_NEEDS_RESET | C3DE_PARAM_ADVANCED),
    choiceParam(
        {"sampling.order", "Order", "",
         "stress_points: shape functions of the cells that the surface cuts. linear: from their corners. quadratic: "
         "from up to four phyxels in a line as well, which bends alike in every direction of the lattice. A simulated "
         "second then takes 2.3 to 2.8 times as long. auto: quadratic where the accuracy setting chooses it. With a "
         "specified spacing or count: quadratic for elongated or flat bodies with curved or tilted faces, else linear",
         "Sampling"},
        kOrders, "auto", C3DE_PARAM_NEEDS_RESET | C3DE_PARAM_ADVANCED),
    numberParam({"sampling.jitter", "Jitter", "",
                 "stress_points: phyxels inside are moved at random by up to this part of the spacing", "Sampling"},
                {0.0, 0.3, 0.0, 0.3}, 0.0, C3DE_PARAM_NEEDS_RESET | C3DE_PARAM_ADVANCED),
    neighboursParam(),
    numberParam({"sampling.support", "Support", "spacings", "Radius of the neighbourhood when neighbours is auto",
                 "Sampling", "sampling.neighbours"},
                {1.01, 6.0, 1.5, 3.0}, 1.8, C3DE_PARAM_NEEDS_RESET),
    autoParam({"sampling.stabilisation", "Stabilisation", "",
               "Control of the modes that one evaluation per point cannot see; auto: 0.92 for stress_points, 0.1 for "
               "phyxels; "
               "0: rattles, above 1: stiff in bending",
               "Sampling"},
              {0.0, 100.0, 0.0, 1.0}, C3DE_PARAM_ADVANCED),
};

constexpr std::array kObstacle{
    numberParam({"friction", "Friction", "", "Coulomb coefficient; 0: slippery", "Obstacle"}, {0.0, 10.0, 0.0, 1.0},
                0.3),
    numberParam({"restitution", "Restitution", "",
                 "Fraction of the impact speed with which a skin point rebounds in explicit steps; 0: no rebound, "
                 "1: contact dissipates no energy",
                 "Obstacle"},
                {0.0, 1.0, 0.0, 1.0}, 0.0),
};

std::string format(double value) {
  char buffer[40];
  std::snprintf(buffer, sizeof buffer, "%g", value);
  return buffer;
}

std::string accepted(const c3de_param_decl &d) {
  std::string out;
  if (d.type == C3DE_PARAM_CHOICE) {
    for (std::uint64_t i = 0; i < d.choices_n; ++i) out += (i ? " | " : "") + std::string(text(d.choices[i]));
    return out;
  }
  if (d.type == C3DE_PARAM_BOOL) return "true or false";
  out = format(d.min) + ((d.flags & C3DE_PARAM_MIN_OPEN) ? " < value " : " <= value ") +
        ((d.flags & C3DE_PARAM_MAX_OPEN) ? "< " : "<= ") + format(d.max);
  if (d.unit.len > 0) out += " " + std::string(text(d.unit));
  if (d.type == C3DE_PARAM_I64) out = "a whole number, " + out;
  if (d.type == C3DE_PARAM_VEC3) out = "three numbers, each " + out;
  if (d.flags & C3DE_PARAM_AUTO) out = "\"auto\" or " + out;
  return out;
}

bool inRange(const c3de_param_decl &d, double x) {
  if (!std::isfinite(x) && x != d.max) return false;
  const bool low = (d.flags & C3DE_PARAM_MIN_OPEN) ? x > d.min : x >= d.min;
  const bool high = (d.flags & C3DE_PARAM_MAX_OPEN) ? x < d.max : x <= d.max;
  return low && high;
}

bool fits(const c3de_param_decl &d, const c3de_param_value &v) {
  const bool isText = v.type == C3DE_PARAM_TEXT || v.type == C3DE_PARAM_CHOICE;
  const bool isNumber = v.type == C3DE_PARAM_F64 || v.type == C3DE_PARAM_I64;
  if ((d.flags & C3DE_PARAM_AUTO) && isText) return text(v.text) == "auto";
  switch (d.type) {
    case C3DE_PARAM_F64: return isNumber && inRange(d, v.num);
    case C3DE_PARAM_I64: return isNumber && inRange(d, v.num) && v.num == std::floor(v.num);
    case C3DE_PARAM_BOOL: return v.type == C3DE_PARAM_BOOL;
    case C3DE_PARAM_VEC3:
      return v.type == C3DE_PARAM_VEC3 && inRange(d, v.vec[0]) && inRange(d, v.vec[1]) && inRange(d, v.vec[2]);
    case C3DE_PARAM_CHOICE:
      return isText && std::any_of(d.choices, d.choices + d.choices_n,
                                   [&](const c3de_str &choice) { return text(choice) == text(v.text); });
    default: return isText;
  }
}

std::string shown(const c3de_param_value &v) {
  switch (v.type) {
    case C3DE_PARAM_TEXT:
    case C3DE_PARAM_CHOICE: return '"' + std::string(text(v.text)) + '"';
    case C3DE_PARAM_VEC3: return "[" + format(v.vec[0]) + ", " + format(v.vec[1]) + ", " + format(v.vec[2]) + "]";
    case C3DE_PARAM_BOOL: return v.num != 0.0 ? "true" : "false";
    default: return format(v.num);
  }
}

}  // namespace

std::span<const c3de_param_decl> worldDeclarations() { return kWorld; }
std::span<const c3de_param_decl> bodyDeclarations() { return kBody; }
std::span<const c3de_param_decl> obstacleDeclarations() { return kObstacle; }

const c3de_param_decl *ParameterValues::declaration(std::string_view id) const {
  for (const c3de_param_decl &d : declarations_)
    if (c3de::sdk::text(d.id) == id) return &d;
  return nullptr;
}

sdk::Result<void> ParameterValues::set(const c3de_param_value &value) {
  const std::string id(c3de::sdk::text(value.id));
  const c3de_param_decl *d = declaration(id);
  if (!d) {
    std::string known;
    for (const c3de_param_decl &k : declarations_) known += " " + std::string(c3de::sdk::text(k.id));
    return Failure{C3DE_E_NOT_FOUND, "unknown parameter '" + id + "'; known:" + known};
  }
  if (!fits(*d, value))
    return Failure{C3DE_E_ARG, id + " = " + shown(value) + " is not accepted; accepted: " + accepted(*d)};
  values_[id] = {value.type, value.num, std::string(c3de::sdk::text(value.text)),
                 Vec3(value.vec[0], value.vec[1], value.vec[2])};
  return {};
}

sdk::Result<void> ParameterValues::set(const c3de_param_value *values, std::uint64_t n, std::uint64_t stride) {
  for (std::uint64_t i = 0; i < n; ++i)
    if (auto done = set(c3de::sdk::readElement(values, i, stride, "parameter")); !done) return done;
  return {};
}

double ParameterValues::number(std::string_view id) const {
  if (const auto found = values_.find(id); found != values_.end()) return found->second.num;
  return declaration(id)->fallback;
}

bool ParameterValues::isAuto(std::string_view id) const {
  if (const auto found = values_.find(id); found != values_.end())
    return found->second.type == C3DE_PARAM_TEXT || found->second.type == C3DE_PARAM_CHOICE;
  return c3de::sdk::text(declaration(id)->fallback_text) == "auto";
}

std::string ParameterValues::text(std::string_view id) const {
  if (const auto found = values_.find(id); found != values_.end()) return found->second.text;
  return std::string(c3de::sdk::text(declaration(id)->fallback_text));
}

bool ParameterValues::differs(std::string_view id) const {
  const auto found = values_.find(id);
  if (found == values_.end()) return false;
  const c3de_param_decl *d = declaration(id);
  return d->type == C3DE_PARAM_CHOICE ? found->second.text != c3de::sdk::text(d->fallback_text)
                                      : found->second.num != d->fallback;
}

Vec3 ParameterValues::vector(std::string_view id) const {
  if (const auto found = values_.find(id); found != values_.end()) return found->second.vec;
  const double *v = declaration(id)->fallback_vec;
  return {v[0], v[1], v[2]};
}

sdk::Result<c3de_param_value> ParameterValues::get(std::string_view id) const {
  const c3de_param_decl *d = declaration(id);
  if (!d) return Failure{C3DE_E_NOT_FOUND, "unknown parameter '" + std::string(id) + "'"};
  c3de_param_value out{};
  out.size = sizeof out;
  out.id = d->id;
  if (const auto found = values_.find(id); found != values_.end()) {
    out.type = found->second.type;
    out.num = found->second.num;
    out.text = str(found->second.text);
    for (int i = 0; i < 3; ++i) out.vec[i] = found->second.vec[i];
    return out;
  }
  out.type = isAuto(id) ? C3DE_PARAM_TEXT : d->type;
  out.num = d->fallback;
  out.text = d->fallback_text;
  for (int i = 0; i < 3; ++i) out.vec[i] = d->fallback_vec[i];
  return out;
}

WorldSettings worldSettings(const ParameterValues &v) {
  WorldSettings world;
  world.gravity = v.vector("world.gravity") - v.vector("world.scan_gravity");
  world.box.enabled = v.number("world.box.enabled") != 0.0;
  world.box.min = v.vector("world.box.min");
  world.box.max = v.vector("world.box.max");
  world.box.friction = v.number("world.box.friction");
  world.box.restitution = v.number("world.box.restitution");
  const std::string integrator = v.text("solver.integrator");
  world.integrator = integrator == "implicit"         ? Integrator::implicitSdirk
                     : integrator == "midpoint"       ? Integrator::implicitMidpoint
                     : integrator == "backward_euler" ? Integrator::backwardEuler
                     : integrator == "quasistatic"    ? Integrator::quasiStatic
                     : integrator == "explicit"       ? Integrator::explicitVerlet
                                                      : Integrator::automatic;
  world.dt = v.isAuto("solver.dt") ? 0.0 : v.number("solver.dt");
  world.damping = v.number("solver.damping");
  world.tolerance = v.isAuto("solver.tolerance_mm") ? 0.0 : 1e-3 * v.number("solver.tolerance_mm");
  world.loadSteps = static_cast<int>(v.number("solver.load_steps"));
  const std::string precision = v.text("solver.precision");
  const bool isSingle = precision == "single" || (precision == "auto" && isFarCoarserThanSingle(accuracyTargetOf(v)));
  world.precision = isSingle ? Precision::singlePrecision : Precision::doublePrecision;
  world.sleep = v.number("solver.sleep") != 0.0;
  const std::string preconditioner = v.text("solver.preconditioner");
  world.preconditioner = preconditioner == "multigrid"      ? Preconditioner::multigrid
                         : preconditioner == "block_jacobi" ? Preconditioner::blockJacobi
                         : preconditioner == "incomplete"   ? Preconditioner::incomplete
                         : preconditioner == "factorised"   ? Preconditioner::factorised
                                                            : Preconditioner::automatic;
  return world;
}

ContactSettings contactSettings(const ParameterValues &v) {
  return {v.number(C3DE_PARAM_ID_CONTACT_ENABLED) != 0.0, v.number(C3DE_PARAM_ID_CONTACT_SELF) != 0.0,
          v.number(C3DE_PARAM_ID_CONTACT_FRICTION)};
}

double stepBudget(const ParameterValues &v, bool hasWindow) {
  if (!v.isAuto("solver.step_budget")) return v.number("solver.step_budget");
  return hasWindow ? 10.0 : std::numeric_limits<double>::infinity();
}

ViewSettings viewSettings(const ParameterValues &v) {
  ViewSettings view;
  const std::string surface = v.text("view.surface"), points = v.text("view.points"), colour = v.text("view.colour");
  view.surface = surface == "transparent" ? SurfaceShown::transparent
                 : surface == "hidden"    ? SurfaceShown::hidden
                                          : SurfaceShown::opaque;
  view.points = points == "phyxels" ? PointsShown::phyxels
                : points == "none"  ? PointsShown::none
                                    : PointsShown::evaluationPoints;
  view.colourBy = colour == "displacement"       ? ColourBy::displacement
                  : colour == "von_mises"        ? ColourBy::vonMises
                  : colour == "error"            ? ColourBy::error
                  : colour == "stabilisation"    ? ColourBy::stabilisation
                  : colour == "verified"         ? ColourBy::verified
                  : colour == "contact_pressure" ? ColourBy::contactPressure
                                                 : ColourBy::material;
  if (!v.isAuto("view.range")) view.range = v.number("view.range");
  return view;
}

bool isOfTheView(std::string_view id) { return id.rfind("view.", 0) == 0; }

Material materialOf(const ParameterValues &v) {
  Material m;
  const std::string law = v.text("material.law");
  m.law = law == "stvk"        ? MaterialLaw::stVenantKirchhoff
          : law == "corotated" ? MaterialLaw::corotated
          : law == "linear"    ? MaterialLaw::linear
                               : MaterialLaw::neoHookean;
  m.youngsModulus = v.number("material.youngs_modulus");
  m.poissonRatio = v.number("material.poisson_ratio");
  m.restDensity = v.number("material.density");
  m.viscosity = v.number("material.viscosity");
  m.volumeStiffness = v.number("material.volume_stiffness");
  m.plastic = {v.number("material.plastic.yield"), v.number("material.plastic.creep"),
               v.number("material.plastic.creep_time"), v.number("material.plastic.max")};
  m.prony = {PronyTerm{v.number("material.prony1.share"), v.number("material.prony1.time")},
             PronyTerm{v.number("material.prony2.share"), v.number("material.prony2.time")}};
  return m;
}

StiffnessRange stiffnessRangeOf(const ParameterValues &v) {
  const double E = v.number("material.youngs_modulus");
  StiffnessRange range{0.5 * E, 1.5 * E, false};
  if (v.isAuto(C3DE_PARAM_ID_YOUNGS_MODULUS_LOW) || v.isAuto(C3DE_PARAM_ID_YOUNGS_MODULUS_HIGH)) return range;
  range.low = std::min(E, v.number(C3DE_PARAM_ID_YOUNGS_MODULUS_LOW));
  range.high = std::max(E, v.number(C3DE_PARAM_ID_YOUNGS_MODULUS_HIGH));
  range.isKnown = true;
  return range;
}

Foundation foundationOf(const ParameterValues &v) {
  Foundation foundation;
  foundation.stiffness = v.number("surroundings.stiffness");
  foundation.tangential =
      v.isAuto("surroundings.tangential") ? foundation.stiffness : v.number("surroundings.tangential");
  foundation.retardationTime = v.number("surroundings.retardation_time");
  return foundation;
}

bool isOfTheSurroundings(std::string_view id) { return id.rfind("surroundings.", 0) == 0; }

bool isRigid(const ParameterValues &v) { return v.number("rigid") != 0.0; }

bool isFree(const ParameterValues &v) { return isRigid(v) && v.number(C3DE_PARAM_ID_FREE) != 0.0; }

Evaluation evaluationOf(const ParameterValues &v) {
  return v.text("sampling.evaluation") == "phyxels" ? Evaluation::phyxels : Evaluation::stressPoints;
}

double stabilisationOf(const ParameterValues &v) {
  if (!v.isAuto("sampling.stabilisation")) return v.number("sampling.stabilisation");
  return evaluationOf(v) == Evaluation::phyxels ? kCloudStabilisation : kLatticeStabilisation;
}

LatticeSampling samplingOf(const ParameterValues &v) {
  LatticeSampling sampling;
  sampling.spacing = v.isAuto("sampling.spacing") ? 0.0 : v.number("sampling.spacing");
  sampling.count = v.isAuto("sampling.count") ? 0 : static_cast<std::size_t>(v.number("sampling.count"));
  sampling.surfaceSpacing = v.number("sampling.surface_spacing");
  sampling.jitter = v.number("sampling.jitter");
  sampling.order = v.text("sampling.order") == "quadratic" ? LatticeOrder::quadratic : LatticeOrder::linear;
  return sampling;
}

NeighborChoice neighborChoiceOf(const ParameterValues &v) {
  const double count = v.isAuto("sampling.neighbours") ? 0.0 : v.number("sampling.neighbours");
  return {static_cast<int>(count), v.number("sampling.support")};
}

}  // namespace pointbased
