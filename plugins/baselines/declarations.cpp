// SPDX-License-Identifier: Apache-2.0
#include "declarations.h"

#include "c3de/abi/iface/parameter_ids.h"
#include "c3de/sdk/params.hpp"

namespace baselines {
namespace {

using namespace c3de::sdk;

constexpr std::array<c3de_str, 2> kIntegrators{str("explicit"), str("quasistatic")};
constexpr std::array<c3de_str, 1> kSprings{str("springs")}, kClusters{str("shape_matching")}, kStvk{str("stvk")};
constexpr std::array<c3de_str, 4> kLaws{str("neo_hookean"), str("stvk"), str("corotated"), str("linear")};
constexpr std::array<c3de_str, 2> kFormulas{str("as_printed"), str("corrected")};
constexpr std::uint32_t kNew = C3DE_PARAM_NEEDS_RESET;

constexpr std::array kWorld{
    vec3Param({C3DE_PARAM_ID_GRAVITY, "Gravity", "m/s²", "Acceleration of everything that is free", "World"},
              {-1e4, 1e4, -20.0, 20.0}, {0.0, 0.0, 0.0}),
    boolParam({C3DE_PARAM_ID_BOX_ENABLED, "Walls", "", "Walls that points do not pass; they take their speed", "World"},
              false),
    vec3Param({C3DE_PARAM_ID_BOX_MIN, "Walls from", "m", "Lower corner of the walls", "World"}, {-1e4, 1e4, -1.0, 1.0},
              {-1.0, -1.0, -1.0}),
    vec3Param({C3DE_PARAM_ID_BOX_MAX, "Walls to", "m", "Upper corner of the walls", "World"}, {-1e4, 1e4, -1.0, 1.0},
              {1.0, 1.0, 1.0}),
    numberParam({C3DE_PARAM_ID_DAMPING, "Damping", "1/s", "Rate at which all velocities decay; 0: none", "Solver"},
                {0.0, 1e6, 0.0, 20.0}, 0.0),
    choiceParam({"solver.integrator", "Integrator", "",
                 "explicit: semi-implicit Euler, of the thesis as printed forward Euler; quasistatic: rest under loads "
                 "that grow",
                 "Solver"},
                kIntegrators, "explicit"),
    autoParam(
        {"solver.dt", "Step", "s", "auto: the stable one; a longer one is refused but by shape matching", "Solver"},
        {0.0, 1.0, 1e-5, 1e-2}, C3DE_PARAM_MIN_OPEN | C3DE_PARAM_LOG_SCALE),
    integerParam({"solver.load_steps", "Load steps", "", "Quasi-static: increments of load and motions", "Solver"},
                 {1.0, 10000.0, 1.0, 50.0}, 10.0),
    numberParam(
        {kTolerance, "Tolerance", "",
         "Quasi-static: at rest when the forces left are this part of what supports, loads and gravity bear", "Solver"},
        {1e-12, 0.1, 1e-6, 1e-2}, 1e-5, C3DE_PARAM_LOG_SCALE),
};

constexpr c3de_param_decl kStiffness =
    numberParam({C3DE_PARAM_ID_YOUNGS_MODULUS, "Young's modulus", "Pa", "Stiffness at small strain", "Material"},
                {0.0, 1e12, 100.0, 1e6}, 6000.0, C3DE_PARAM_MIN_OPEN | C3DE_PARAM_LOG_SCALE);
constexpr c3de_param_decl kDensity =
    numberParam({C3DE_PARAM_ID_DENSITY, "Density", "kg/m³", "Mass per volume at rest", "Material"},
                {0.0, 1e6, 100.0, 3000.0}, 1060.0, C3DE_PARAM_MIN_OPEN);
constexpr c3de_param_decl kSpacing =
    autoParam({C3DE_PARAM_ID_SPACING, "Spacing", "m", "Of the lattice; auto: by the count", "Sampling"},
              {0.0, 1e4, 0.001, 0.05}, kNew | C3DE_PARAM_MIN_OPEN | C3DE_PARAM_LOG_SCALE);
constexpr c3de_param_decl kCount =
    integerParam({C3DE_PARAM_ID_COUNT, "Count", "", "Cells of the lattice, about, when the spacing is auto", "Sampling",
                  C3DE_PARAM_ID_SPACING},
                 {1.0, 1e6, 50.0, 5000.0}, 1000.0, kNew | C3DE_PARAM_LOG_SCALE);

/// Poisson's ratio of a method that has but one.
constexpr c3de_param_decl onlyRatio(double nu, std::string_view doc) {
  return numberParam({C3DE_PARAM_ID_POISSON_RATIO, "Poisson's ratio", "", doc, "Material"}, {nu, nu, nu, nu}, nu);
}
constexpr c3de_param_decl kRatio =
    numberParam({C3DE_PARAM_ID_POISSON_RATIO, "Poisson's ratio", "", "Resistance to a change of volume", "Material"},
                {-1.0, 0.5, 0.0, 0.49}, 0.3, C3DE_PARAM_MIN_OPEN | C3DE_PARAM_MAX_OPEN);

constexpr std::array kMassSprings{
    choiceParam({kLaw, "Law", "", "Springs are linear in their length", "Material"}, kSprings, "springs", kNew),
    kStiffness,
    onlyRatio(0.25, "Of an isotropic lattice of springs"),
    kDensity,
    numberParam({"material.retardation_time", "Retardation time", "s",
                 "Springs are damped by their stiffness times this; rigid motion is not", "Material"},
                {0.0, 1e3, 0.0, 0.05}, 0.0),
    kSpacing,
    kCount};

constexpr std::array kShapeMatching{
    choiceParam({kLaw, "Law", "", "Points are drawn to goals", "Material"}, kClusters, "shape_matching", kNew),
    kStiffness,
    onlyRatio(0.0, "Goals keep their width: what is stretched does not thin"),
    kDensity,
    kSpacing,
    kCount,
    integerParam(
        {kReach, "Reach", "cells", "Clusters are a cell and this many around it in every direction", "Sampling"},
        {0.0, 5.0, 0.0, 3.0}, 0.0, kNew),
    numberParam(
        {kLinear, "Linear", "", "0: goals are rigid; towards 1: goals are stretched with the cluster", "Sampling"},
        {0.0, 1.0, 0.0, 0.9}, 0.0, kNew | C3DE_PARAM_MAX_OPEN)};

constexpr std::array kTetrahedra{
    choiceParam({kLaw, "Law", "", "As of the point-based method", "Material"}, kLaws, "neo_hookean", kNew),
    kStiffness,
    kRatio,
    kDensity,
    kSpacing,
    kCount};

constexpr std::array kThesis{
    choiceParam({kLaw, "Law", "", "Linear in the strain", "Material"}, kStvk, "stvk", kNew),
    kStiffness,
    kRatio,
    kDensity,
    kSpacing,
    kCount,
    integerParam({kNeighbours, "Neighbours", "", "Nearest phyxels of each", "Sampling"}, {6.0, 200.0, 8.0, 60.0}, 26.0,
                 kNew),
    choiceParam({kErrata, "Formulas", "", "As the thesis prints them, or without its errata", "Sampling"}, kFormulas,
                "as_printed", kNew)};

constexpr std::array kObstacle{
    numberParam({C3DE_PARAM_ID_FRICTION, "Friction", "", "There is none", "Obstacle"}, {0.0, 0.0, 0.0, 0.0}, 0.0)};

}  // namespace

std::span<const c3de_param_decl> worldOfBaselines() { return kWorld; }
std::span<const c3de_param_decl> ofMassSprings() { return kMassSprings; }
std::span<const c3de_param_decl> ofShapeMatching() { return kShapeMatching; }
std::span<const c3de_param_decl> ofTetrahedra() { return kTetrahedra; }
std::span<const c3de_param_decl> ofThesis() { return kThesis; }
std::span<const c3de_param_decl> ofObstacles() { return kObstacle; }

}  // namespace baselines
