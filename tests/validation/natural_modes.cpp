// SPDX-License-Identifier: Apache-2.0
#include "natural_modes.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SparseCholesky>
#include <cmath>
#include <stdexcept>

namespace validation {

using namespace pointbased;

std::vector<Mode> naturalModes(Body &body, int count) {
  const RestState &rest = body.rest();
  const std::size_t n = rest.phyxelCount();
  std::vector<Eigen::Triplet<double>> triplets;
  body.computeGradients(serialFor());
  stiffnessTriplets(body.constitution(), rest.stencils, rest.positions, body.state().displacements, body.gradients(),
                    body.state().history, 0.0, 0.0, triplets);
  if (body.patches().rows() > 0) body.patches().addTriplets(triplets);

  std::vector<int> number(3 * n, -1);
  int unknowns = 0;
  for (std::size_t i = 0; i < n; ++i)
    if (body.inverseMasses()[i] > 0.0)
      for (std::size_t c = 0; c < 3; ++c) number[3 * i + c] = unknowns++;
  Eigen::VectorXd root(unknowns);  // of the masses
  for (std::size_t i = 0; i < 3 * n; ++i)
    if (number[i] >= 0) root[number[i]] = std::sqrt(body.masses()[i / 3]);

  // M^-1/2 K M^-1/2 is an ordinary symmetric problem.
  std::vector<Eigen::Triplet<double>> scaled;
  for (const auto &t : triplets) {
    const int row = number[static_cast<std::size_t>(t.row())], column = number[static_cast<std::size_t>(t.col())];
    if (row >= 0 && column >= 0) scaled.emplace_back(row, column, t.value() / (root[row] * root[column]));
  }
  Eigen::SparseMatrix<double> A(unknowns, unknowns);
  A.setFromTriplets(scaled.begin(), scaled.end());
  const double largest = body.restFrequency() * body.restFrequency();
  const double shift = 1e-6 * largest;
  for (int i = 0; i < unknowns; ++i) A.coeffRef(i, i) += shift;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factors(A);
  if (factors.info() != Eigen::Success) throw std::runtime_error("the stiffness matrix could not be factorised");

  const int block = count + 10;
  Eigen::MatrixXd X(unknowns, block);
  for (int j = 0; j < block; ++j)  // smooth and rough alike
    for (int i = 0; i < unknowns; ++i) X(i, j) = std::sin(1.7 + (j + 1) * 0.37 * i + 0.011 * j * j * i);
  Eigen::VectorXd values, before = Eigen::VectorXd::Zero(block);
  for (int iteration = 0; iteration < 100; ++iteration) {
    const Eigen::MatrixXd solved = factors.solve(X);
    const Eigen::MatrixXd Q = Eigen::HouseholderQR<Eigen::MatrixXd>(solved).householderQ() *
                              Eigen::MatrixXd::Identity(unknowns, block);
    const Eigen::MatrixXd small = Q.transpose() * (A * Q);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(small);
    X = Q * eigen.eigenvectors();
    values = eigen.eigenvalues();
    if ((values - before).head(count).norm() < 1e-7 * values.head(count).norm()) break;
    before = values;
  }
  std::vector<Mode> modes;
  for (int j = 0; j < count; ++j) {
    Mode mode;
    mode.frequency = std::sqrt(std::max(0.0, values[j] - shift)) / (2.0 * EIGEN_PI);
    // So small that laws and modal energies are quadratic.
    std::vector<Vec3> u(n, Vec3::Zero());
    for (std::size_t i = 0; i < 3 * n; ++i)
      if (number[i] >= 0) u[i / 3][static_cast<int>(i % 3)] = X(number[i], j) / root[number[i]];
    double most = 0.0;
    for (const Vec3 &v : u) most = std::max(most, v.norm());
    for (Vec3 &v : u) v *= 1e-6 * rest.spacing / most;
    std::vector<Mat3> gradients(rest.pointCount());
    deformationGradients(rest.stencils, u, gradients, serialFor());
    const ElasticEnergy energy =
        elasticEnergy(body.constitution(), rest.stencils, rest.positions, u, gradients, body.state().history);
    mode.control = energy.stabilisation / (energy.strain + energy.stabilisation);
    modes.push_back(mode);
  }
  return modes;
}

}  // namespace validation
