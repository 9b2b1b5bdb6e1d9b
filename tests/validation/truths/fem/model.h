// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "law.h"

#include <array>
#include <istream>
#include <vector>

namespace truth {

inline constexpr int kNodesPerElement = 27;

/// Hexahedron with 27 nodes in lattice order: node (i, j, k), each 0..2, is number i + 3 j + 9 k.
struct Hex27 {
  std::array<int, kNodesPerElement> nodes;
  int law;  ///< index into Model::laws
};

/// A degree of freedom whose displacement is prescribed.
struct Held {
  int node;
  int axis;
  std::vector<double> values;  ///< [stage] displacement at the end of the stage, m
};

/// A force on a node, dead (keeps its direction); multiplied by the load factor.
struct NodalForce {
  int node;
  Eigen::Vector3d force;  ///< N
};

/// A face whose pressure follows the deformation: its lattice nodes in the element, normal t1 x t2 pointing outwards.
struct PressureFace {
  int element;
  std::array<int, 9> nodes;
  double pressure;  ///< Pa
};

struct Model {
  std::vector<Law> laws;
  std::vector<Eigen::Vector3d> nodes;  ///< X, m
  std::vector<Hex27> elements;
  std::vector<Held> held;
  std::vector<NodalForce> forces;
  std::vector<PressureFace> pressures;
  Eigen::Vector3d gravity = Eigen::Vector3d::Zero();  ///< m/s^2
  std::vector<double> loadFactors;                    ///< [stage] at its end; within a stage everything varies linearly
  int increments = 1;                                 ///< per stage; halved where Newton fails
};

/// Reads the plain text that ../truth_fem.py writes: sections `laws n`, `nodes n`, `elements n`, `stages n`, `held n`,
/// `forces n`, `pressures n`, `gravity`, `increments`, closed by `end`. @errors throws std::runtime_error
Model readModel(std::istream &in);

}  // namespace truth
