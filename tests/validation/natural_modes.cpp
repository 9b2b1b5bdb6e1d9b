// SPDX-License-Identifier: Apache-2.0
#include "natural_modes.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SparseCholesky>
#include <cmath>
#include <stdexcept>

namespace validation {

using namespace pointbased;

namespace {

/// M^-1/2 K M^-1/2 + shift: an ordinary symmetric problem, factorised.
struct Spectrum {
  explicit Spectrum(Body &body);
  std::vector<int> number;  // [3 phyxels] index of the unknown; -1: held
  int unknowns = 0;
  double shift = 0.0;    // rad²/s²
  Eigen::VectorXd root;  // of the masses
  Eigen::SparseMatrix<double> matrix;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factors;
};

Spectrum::Spectrum(Body &body) {
  const RestState &rest = body.rest();
  const std::size_t n = rest.phyxelCount();
  std::vector<Eigen::Triplet<double>> triplets, scaled;
  body.computeGradients(serialFor());
  stiffnessTriplets(body.constitution(), rest.stencils, rest.positions, body.state().displacements, body.gradients(),
                    body.state().history, 0.0, 0.0, triplets);
  if (body.patches().rows() > 0) body.patches().addTriplets(triplets);
  number.assign(3 * n, -1);
  for (std::size_t i = 0; i < n; ++i)
    if (body.inverseMasses()[i] > 0.0)
      for (std::size_t c = 0; c < 3; ++c) number[3 * i + c] = unknowns++;
  root.resize(unknowns);
  for (std::size_t i = 0; i < 3 * n; ++i)
    if (number[i] >= 0) root[number[i]] = std::sqrt(body.masses()[i / 3]);
  for (const auto &t : triplets) {
    const int row = number[static_cast<std::size_t>(t.row())], column = number[static_cast<std::size_t>(t.col())];
    if (row >= 0 && column >= 0) scaled.emplace_back(row, column, t.value() / (root[row] * root[column]));
  }
  shift = 1e-6 * body.restFrequency() * body.restFrequency();
  for (int i = 0; i < unknowns; ++i) scaled.emplace_back(i, i, shift);
  matrix.resize(unknowns, unknowns);
  matrix.setFromTriplets(scaled.begin(), scaled.end());
  factors.compute(matrix);
  if (factors.info() != Eigen::Success) throw std::runtime_error("the stiffness matrix could not be factorised");
}

double frequencyOf(double square) { return std::sqrt(std::max(0.0, square)) / (2.0 * EIGEN_PI); }

}  // namespace

std::vector<Mode> naturalModes(Body &body, int count) {
  const RestState &rest = body.rest();
  const std::size_t n = rest.phyxelCount();
  const Spectrum spectrum(body);
  const int unknowns = spectrum.unknowns;
  const int block = count + 10;
  Eigen::MatrixXd X(unknowns, block);
  for (int j = 0; j < block; ++j)  // both smooth and rough
    for (int i = 0; i < unknowns; ++i) X(i, j) = std::sin(1.7 + (j + 1) * 0.37 * i + 0.011 * j * j * i);
  Eigen::VectorXd values, before = Eigen::VectorXd::Zero(block);
  for (int iteration = 0; iteration < 100; ++iteration) {
    const Eigen::MatrixXd solved = spectrum.factors.solve(X);
    const Eigen::MatrixXd Q =
        Eigen::HouseholderQR<Eigen::MatrixXd>(solved).householderQ() * Eigen::MatrixXd::Identity(unknowns, block);
    const Eigen::MatrixXd small = Q.transpose() * (spectrum.matrix * Q);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(small);
    X = Q * eigen.eigenvectors();
    values = eigen.eigenvalues();
    if ((values - before).head(count).norm() < 1e-7 * values.head(count).norm()) break;
    before = values;
  }
  std::vector<Mode> modes;
  for (int j = 0; j < count; ++j) {
    Mode mode;
    mode.frequency = frequencyOf(values[j] - spectrum.shift);
    // So small that laws and hourglass energies are quadratic.
    std::vector<Vec3> u(n, Vec3::Zero());
    for (std::size_t i = 0; i < 3 * n; ++i)
      if (spectrum.number[i] >= 0)
        u[i / 3][static_cast<int>(i % 3)] = X(spectrum.number[i], j) / spectrum.root[spectrum.number[i]];
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

double frequencyOfShape(Body &body, const std::function<Vec3(const Vec3 &)> &shape) {
  const RestState &rest = body.rest();
  const Spectrum spectrum(body);
  Eigen::VectorXd x(spectrum.unknowns);
  for (std::size_t i = 0; i < rest.phyxelCount(); ++i) {
    const Vec3 u = shape(rest.positions[i]);
    for (std::size_t c = 0; c < 3; ++c)
      if (const int k = spectrum.number[3 * i + c]; k >= 0) x[k] = spectrum.root[k] * u[static_cast<int>(c)];
  }
  const Eigen::VectorXd y = spectrum.factors.solve(x);
  return frequencyOf(x.dot(y) / y.squaredNorm() - spectrum.shift);
}

}  // namespace validation
