// SPDX-License-Identifier: Apache-2.0
#include "element.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace truth {
namespace {

constexpr int kPoints = 27;
using Shape = Eigen::Matrix<double, kNodesPerElement, 1>;
using Gradients = Eigen::Matrix<double, 3, kNodesPerElement>;

struct Quadratic {
  double value[3];
  double slope[3];
};

/// Lagrange polynomials of the nodes -1, 0, 1.
Quadratic quadratic(double t) {
  return {{0.5 * t * (t - 1.0), 1.0 - t * t, 0.5 * t * (t + 1.0)}, {t - 0.5, -2.0 * t, t + 0.5}};
}

const double kGauss[3] = {-std::sqrt(0.6), 0.0, std::sqrt(0.6)};
const double kWeight[3] = {5.0 / 9.0, 8.0 / 9.0, 5.0 / 9.0};

struct ReferencePoint {
  Shape shape;
  Gradients slope;  ///< by the coordinates of the reference cube
  Eigen::Vector3d at;
  double weight;
};

std::array<ReferencePoint, kPoints> makeReferencePoints() {
  std::array<ReferencePoint, kPoints> points;
  for (int q = 0; q < kPoints; ++q) {
    ReferencePoint &point = points[static_cast<std::size_t>(q)];
    const int a = q % 3, b = q / 3 % 3, c = q / 9;
    point.at = {kGauss[a], kGauss[b], kGauss[c]};
    point.weight = kWeight[a] * kWeight[b] * kWeight[c];
    const Quadratic u = quadratic(point.at.x()), v = quadratic(point.at.y()), w = quadratic(point.at.z());
    for (int n = 0; n < kNodesPerElement; ++n) {
      const int i = n % 3, j = n / 3 % 3, k = n / 9;
      point.shape(n) = u.value[i] * v.value[j] * w.value[k];
      point.slope.col(n) << u.slope[i] * v.value[j] * w.value[k], u.value[i] * v.slope[j] * w.value[k],
          u.value[i] * v.value[j] * w.slope[k];
    }
  }
  return points;
}

const std::array<ReferencePoint, kPoints> &referencePoints() {
  static const std::array<ReferencePoint, kPoints> points = makeReferencePoints();
  return points;
}

/// Gradients of the shape functions by X and the volume of the point.
double mapPoint(const ReferencePoint &point, const Gradients &X, Gradients &gradients) {
  const Mat3 jacobian = X * point.slope.transpose();
  gradients = jacobian.inverse().transpose() * point.slope;
  return point.weight * jacobian.determinant();
}

template <typename Field>
Gradients gather(const Hex27 &element, const Field &field) {
  Gradients out;
  for (int n = 0; n < kNodesPerElement; ++n) {
    out.col(n) = field[static_cast<std::size_t>(element.nodes[static_cast<std::size_t>(n)])];
  }
  return out;
}

}  // namespace

ElementResult evaluateElement(const Model &model, const Hex27 &element, const std::vector<Eigen::Vector3d> &positions,
                              const Eigen::Vector4d &tangentPressure) {
  ElementResult out;
  out.force.setZero();
  out.tangent.setZero();
  out.valid = true;
  out.smallestJacobian = 1e300;
  const Law &law = model.laws[static_cast<std::size_t>(element.law)];
  const Gradients X = gather(element, model.nodes);
  const Gradients x = gather(element, positions);
  const bool mixed = law.kind == LawKind::neoHookeanMixed;

  std::array<Gradients, kPoints> gradients;
  std::array<double, kPoints> volumes{};
  std::array<Mat3, kPoints> F;
  for (std::size_t q = 0; q < kPoints; ++q) {
    volumes[q] = mapPoint(referencePoints()[q], X, gradients[q]);
    F[q] = x * gradients[q].transpose();
    const double J = F[q].determinant();
    out.smallestJacobian = std::min(out.smallestJacobian, J);
    if (volumes[q] <= 0.0 || (J <= 0.0 && law.kind != LawKind::stvk && law.kind != LawKind::linear)) {
      out.valid = false;
      return out;
    }
  }

  // ln J projected onto 1, xi, eta, zeta: pressure = lambda * projection; d(projection) = M^-1 B du.
  Eigen::Matrix<double, 4, 4> mass = Eigen::Matrix<double, 4, 4>::Zero();
  Eigen::Matrix<double, 4, 1> volumeStrain = Eigen::Matrix<double, 4, 1>::Zero();
  Eigen::Matrix<double, 4, kElementDofs> B = Eigen::Matrix<double, 4, kElementDofs>::Zero();
  if (mixed) {
    for (std::size_t q = 0; q < kPoints; ++q) {
      Eigen::Matrix<double, 4, 1> basis;
      basis << 1.0, referencePoints()[q].at;
      mass += volumes[q] * basis * basis.transpose();
      volumeStrain += volumes[q] * std::log(F[q].determinant()) * basis;
      const Gradients spatial = F[q].inverse().transpose() * gradients[q];
      const Eigen::Map<const Eigen::Matrix<double, 1, kElementDofs>> row(spatial.data());
      B += volumes[q] * basis * row;
    }
    out.pressure.value = law.lambda * mass.llt().solve(volumeStrain);
    out.pressure.rate = law.lambda * mass.llt().solve(B);
    out.tangent += B.transpose() * out.pressure.rate;
  }

  Eigen::Matrix<double, kNodesPerElement, kNodesPerElement> blocks[3][3];
  for (auto &row : blocks) {
    for (auto &block : row) block.setZero();
  }
  for (std::size_t q = 0; q < kPoints; ++q) {
    const Eigen::Vector3d &at = referencePoints()[q].at;
    const auto pressureAt = [&at](const Eigen::Vector4d &p) { return p(0) + p.tail<3>().dot(at); };
    const StressPoint point = evaluate(law, F[q], {pressureAt(out.pressure.value), pressureAt(tangentPressure)});
    if (!point.valid) {
      out.valid = false;
      return out;
    }
    const Gradients forces = volumes[q] * point.stress * gradients[q];
    out.force += Eigen::Map<const Eigen::Matrix<double, kElementDofs, 1>>(forces.data());
    for (int i = 0; i < 3; ++i) {
      for (int k = i; k < 3; ++k) {
        const Gradients half = volumes[q] * point.tangent.block<3, 3>(3 * i, 3 * k) * gradients[q];
        blocks[i][k].noalias() += gradients[q].transpose() * half;
      }
    }
  }
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      for (int a = 0; a < kNodesPerElement; ++a) {
        for (int b = 0; b < kNodesPerElement; ++b) {
          out.tangent(3 * a + i, 3 * b + k) += i <= k ? blocks[i][k](a, b) : blocks[k][i](b, a);
        }
      }
    }
  }
  return out;
}

void addGravity(const Model &model, std::vector<Eigen::Vector3d> &forces) {
  for (const Hex27 &element : model.elements) {
    const Gradients X = gather(element, model.nodes);
    const double density = model.laws[static_cast<std::size_t>(element.law)].density;
    for (const ReferencePoint &point : referencePoints()) {
      Gradients unused;
      const double mass = density * mapPoint(point, X, unused);
      for (int n = 0; n < kNodesPerElement; ++n) {
        forces[static_cast<std::size_t>(element.nodes[static_cast<std::size_t>(n)])] +=
            mass * point.shape(n) * model.gravity;
      }
    }
  }
}

void addPressure(const Model &model, int index, double factor, const std::vector<Eigen::Vector3d> &x,
                 std::vector<Eigen::Vector3d> &forces, Eigen::Matrix<double, kElementDofs, kElementDofs> &tangent) {
  const auto cross = [](const Eigen::Vector3d &v) {
    Mat3 out;
    out << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
    return out;
  };
  const PressureFace &face = model.pressures[static_cast<std::size_t>(index)];
  const auto &nodes = model.elements[static_cast<std::size_t>(face.element)].nodes;
  const auto nodeOf = [&](int n) {
    return static_cast<std::size_t>(nodes[static_cast<std::size_t>(face.nodes[static_cast<std::size_t>(n)])]);
  };
  for (int q = 0; q < 9; ++q) {
    const Quadratic u = quadratic(kGauss[q % 3]), v = quadratic(kGauss[q / 3]);
    const double scale = -factor * face.pressure * kWeight[q % 3] * kWeight[q / 3];
    double shape[9], slopeU[9], slopeV[9];
    Eigen::Vector3d t1 = Eigen::Vector3d::Zero(), t2 = Eigen::Vector3d::Zero();
    for (int n = 0; n < 9; ++n) {
      shape[n] = u.value[n % 3] * v.value[n / 3];
      slopeU[n] = u.slope[n % 3] * v.value[n / 3];
      slopeV[n] = u.value[n % 3] * v.slope[n / 3];
      t1 += slopeU[n] * x[nodeOf(n)];
      t2 += slopeV[n] * x[nodeOf(n)];
    }
    for (int a = 0; a < 9; ++a) {
      forces[nodeOf(a)] += scale * shape[a] * t1.cross(t2);
      const int row = 3 * face.nodes[static_cast<std::size_t>(a)];
      for (int b = 0; b < 9; ++b) {
        const int column = 3 * face.nodes[static_cast<std::size_t>(b)];
        const Mat3 derivative = 0.5 * scale * shape[a] * (slopeV[b] * cross(t1) - slopeU[b] * cross(t2));
        tangent.block<3, 3>(row, column) -= derivative;
        tangent.block<3, 3>(column, row) -= derivative.transpose();
      }
    }
  }
}

}  // namespace truth
