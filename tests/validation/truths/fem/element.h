// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model.h"

namespace truth {

inline constexpr int kElementDofs = 3 * kNodesPerElement;

/// Pressure of a neoHookeanMixed element, linear in it: coefficients of 1, xi, eta, zeta, Pa. Its elimination puts
/// lambda ln J of a trial state into the tangent, which is far off when lambda is large. Newton's method on pressure
/// and displacement together uses `value + rate du` instead and gives the same equilibrium.
struct PressureState {
  Eigen::Vector4d value = Eigen::Vector4d::Zero();  ///< projected lambda ln J
  Eigen::Matrix<double, 4, kElementDofs> rate =
      Eigen::Matrix<double, 4, kElementDofs>::Zero();  ///< its derivative by u
};

/// Internal force (N) and tangent (N/m) of one element; degree of freedom 3 a + i is component i of node a.
struct ElementResult {
  Eigen::Matrix<double, kElementDofs, 1> force;
  Eigen::Matrix<double, kElementDofs, kElementDofs> tangent;
  double smallestJacobian;  ///< of F over the 27 Gauss points
  bool valid;
  PressureState pressure;  ///< only for neoHookeanMixed
};

/// Total-Lagrangian element with 3 x 3 x 3 Gauss points.
/// @param x                [node of the model] current positions, m
/// @param tangentPressure  Newton's prediction of the pressure, see PressureState
ElementResult evaluateElement(const Model &model, const Hex27 &element, const std::vector<Eigen::Vector3d> &x,
                              const Eigen::Vector4d &tangentPressure);

/// Adds density times gravity to `forces` [node].
void addGravity(const Model &model, std::vector<Eigen::Vector3d> &forces);

/// Adds -factor * pressure n da over a deformed face to `forces` [node], and subtracts the symmetric part of its
/// derivative from the tangent of the element.
/// @param face  index into model.pressures
void addPressure(const Model &model, int face, double factor, const std::vector<Eigen::Vector3d> &x,
                 std::vector<Eigen::Vector3d> &forces, Eigen::Matrix<double, kElementDofs, kElementDofs> &tangent);

}  // namespace truth
