// SPDX-License-Identifier: Apache-2.0
// Stiffness matrix of one point as V^T H V. Private to the core.
#pragma once

#include <optional>

#include "forces/point_response.h"
#include "forces/viscous_hourglass.h"

namespace pointbased::detail {

using Matrix9 = Eigen::Matrix<double, 9, 9>;

/// A symmetric matrix with its negative eigenvalues removed.
Matrix9 positivePart(const Matrix9 &C);

/// K_jl = Σ g_jc g_ld C_cd + B_j^T H B_l + twist γ_j γ_l: C the 9x9 tangent of v P, B_j the change of B
/// (HourglassEnergy) by the displacement of entry j.
///
/// The isotropic control adds scale Σ_k w_k c_kj c_kl, c_kj = δ_kj - δ_aj - g_j (X_k - X_a): the change of r_k. For
/// flat stencils the rotation of the completed column is neglected.
class PointStiffness {
 public:
  using Columns = Eigen::Matrix<double, 9, 3>;
  using SecondColumns = Eigen::Matrix<double, 18, 3>;
  /// Factors of the blocks of one entry.
  struct Entry {
    Columns stress;                         ///< d(v P) by displacements of the entry
    Columns modes;                          ///< dB by displacements of the entry
    Columns conjugate;                      ///< dD = H dB
    SecondColumns second, secondConjugate;  ///< in place of modes and conjugate, with functions of second order
    Mat3 twist = Mat3::Zero();              ///< only if modes relax or are viscous: change of Q^T F^T a_xyz
  };

  PointStiffness(const Constitution &constitution, const StencilSet &s, std::size_t q, std::span<const Vec3> X,
                 std::span<const Vec3> u, std::span<const Mat3> gradients, const PointResponse &response,
                 double viscousScale)
      : s_(s), q_(q), gradientRows_(s, q), modeRows_(s, q), X_(X), control_(stabilisationOf(constitution, s)),
        modal_(response.material, constitution.stabilisation),
        viscous_(viscousHourglass(response.material, constitution.stabilisation)),
        viscousScale_(response.material.viscosity > 0.0 ? viscousScale : 0.0),
        linear_(response.material.law == MaterialLaw::linear),
        point_(modal_, s, q, linear_ ? Mat3(Mat3::Identity()) : gradients[q],
               control_ == Stabilisation::hourglass ? amplitudes(s, q, u) : Amplitudes(Amplitudes::Zero()),
               control_ == Stabilisation::hourglass ? s.variances[q] : Vec3(Vec3::Zero())) {
    if (control_ == Stabilisation::hourglass && response.material.relaxes()) {
      relaxing_.emplace(response.material, constitution.stabilisation, response.hourglassStep().freshSum);
      const RelaxingHourglassPoint point(*relaxing_, s, q, linear_ ? Mat3(Mat3::Identity()) : gradients[q],
                                         amplitudes(s, q, u), response.hourglassPast(q));
      point_.QD = point.QD.leftCols<3>();
      twistQD_ = point.QD.col(3);
      point_.twistStiffness = relaxing_->present().twist(s.volumes[q], s.variances[q]);
    }
    quadratic_ = control_ == Stabilisation::hourglass && !relaxing_ ? s.quadratic.find(q) : nullptr;
    if (quadratic_ != nullptr)
      quadraticPoint_.emplace(QuadraticEnergy(modal_), s, q, *quadratic_,
                              linear_ ? Mat3(Mat3::Identity()) : gradients[q],
                              secondGradient(bendsOf(s, q, *quadratic_, u), amplitudes(s, q, u)));
    if (control_ == Stabilisation::hourglass && viscousScale_ > 0.0)
      viscousTwist_ = viscousScale_ * viscous_.twist(s.volumes[q], s.variances[q]);
    const bool flat = s.rank[q] < 3;
    const Mat3 seen = flat ? seenDirections(s.rank[q], frameOfPoint(s, q)) : Mat3(Mat3::Identity());
    for (int c = 0; c < 9; ++c) {
      Mat3 unit = Mat3::Zero();
      unit(c % 3, c / 3) = 1.0;
      if (flat) unit = unit * seen;
      Mat3 dP = s.volumes[q] * response.differential(q, gradients[q], unit, viscousScale);
      if (flat) dP = dP * seen;
      elastic_.col(c) = Eigen::Map<const Eigen::Matrix<double, 9, 1>>(dP.data());
    }
    elastic_ = Matrix9(0.5 * (elastic_ + elastic_.transpose()));
    if (control_ == Stabilisation::isotropic && s.rank[q] > 0) {
      scale_ = residualScale(response.material, constitution.stabilisation, s.volumes[q]);
      const StabilisationPoint residual(s, q, gradients[q]);
      visible_ = residual.visibleDirections();
      const Index anchor = s.phyxels.indices[first()];
      for (Index e = first() + 1; e < last(); ++e) {
        const Vec3 d = s.unstrained(q, X[s.phyxels.indices[e]] - X[anchor]);
        moment_ += s.weights[e] * d * d.transpose();
        firstMoment_ += s.weights[e] * d;
        weight_ += s.weights[e];
      }
    }
  }

  void makePositive() { elastic_ = positivePart(elastic_); }

  [[nodiscard]] Entry entry(Index e) const {
    Entry out;
    const Vec3 &g = gradientRows_[e];
    out.stress = g[0] * elastic_.leftCols<3>() + g[1] * elastic_.middleCols<3>(3) + g[2] * elastic_.rightCols<3>();
    if (control_ != Stabilisation::hourglass) return out;
    const Vec3 row = modeRows_[e].head<3>(), turned = s_.axes.transpose() * g;
    if (quadratic_ != nullptr) addSecond(e, row, turned, out);
    for (int i = 0; i < 3; ++i) {
      Mat3 dB = point_.FQ.row(i).transpose() * row.transpose();
      if (!linear_) dB += turned * point_.A.row(i);
      Mat3 dD = (relaxing_ ? relaxing_->present() : modal_).conjugate(dB, point_.vs);
      if (viscousScale_ > 0.0) dD += viscousScale_ * viscous_.conjugate(dB, point_.vs);
      out.modes.col(i) = Eigen::Map<const Eigen::Matrix<double, 9, 1>>(dB.data());
      out.conjugate.col(i) = Eigen::Map<const Eigen::Matrix<double, 9, 1>>(dD.data());
      if (relaxing_ || viscousTwist_ > 0.0) {
        out.twist.col(i) = modeRows_[e][3] * point_.FQ.row(i).transpose();
        if (!linear_) out.twist.col(i) += point_.twist[i] * turned;
      }
    }
    return out;
  }

  /// Block of two entries without second derivatives of B: together, the blocks of a point are positive semi-definite
  /// if its tangent is.
  [[nodiscard]] Mat3 block(Index j, const Entry &ofJ, Index l, const Entry &ofL) const {
    const Vec3 &g = gradientRows_[j];
    Mat3 K = g[0] * ofL.stress.topRows<3>() + g[1] * ofL.stress.middleRows<3>(3) + g[2] * ofL.stress.bottomRows<3>();
    if (control_ == Stabilisation::hourglass) {
      // From this size on Eigen uses its product for large matrices, which costs ten times as much here.
      if (quadratic_ != nullptr)
        K += ofJ.second.transpose().lazyProduct(ofL.secondConjugate);
      else
        K += ofJ.modes.transpose().lazyProduct(ofL.conjugate);
      if (relaxing_)
        K += (point_.twistStiffness + viscousTwist_) * ofJ.twist.transpose().lazyProduct(ofL.twist);
      else
        K.diagonal().array() += point_.twistStiffness * modeRows_[j][3] * modeRows_[l][3];
      if (!relaxing_ && viscousTwist_ > 0.0) K += viscousTwist_ * ofJ.twist.transpose().lazyProduct(ofL.twist);
    } else if (scale_ > 0.0) {
      K += scale_ * residualCoefficient(j, l) * visible_;
    }
    return K;
  }

  /// Contribution of the second derivative of B to the diagonal block of an entry.
  [[nodiscard]] double curvature(Index e) const {
    if (control_ != Stabilisation::hourglass || linear_) return 0.0;
    if (quadratic_ != nullptr) {
      Eigen::Matrix<double, 6, 1> row;
      row << bendsRow(e), modeRows_[e].head<3>();
      return 2.0 * gradientRows_[e].dot(quadraticPoint_->QD * row);
    }
    double sum = 2.0 * gradientRows_[e].dot(point_.QD * modeRows_[e].head<3>());
    if (relaxing_) sum += 2.0 * modeRows_[e][3] * gradientRows_[e].dot(twistQD_);
    return sum;
  }

  [[nodiscard]] Index first() const { return s_.phyxels.offsets[q_]; }
  [[nodiscard]] Index last() const { return s_.phyxels.offsets[q_ + 1]; }

 private:
  [[nodiscard]] const Vec3 &bendsRow(Index e) const { return s_.quadratic.bends[quadratic_->first + (e - first())]; }
  // Change of the second derivatives by displacements of an entry, and of their conjugates.
  void addSecond(Index e, const Vec3 &mixed, const Vec3 &turned, Entry &out) const {
    Eigen::Matrix<double, 1, 6> row;
    row << bendsRow(e).transpose(), mixed.transpose();
    for (int i = 0; i < 3; ++i) {
      SecondGradient dB = quadraticPoint_->FQ.row(i).transpose() * row;
      if (!linear_) dB += turned * quadraticPoint_->H.row(i);
      SecondGradient dD = QuadraticEnergy(modal_).conjugate(dB, quadraticPoint_->vC);
      if (viscousScale_ > 0.0) dD += viscousScale_ * QuadraticEnergy(viscous_).conjugate(dB, quadraticPoint_->vC);
      out.second.col(i) = Eigen::Map<const Eigen::Matrix<double, 18, 1>>(dB.data());
      out.secondConjugate.col(i) = Eigen::Map<const Eigen::Matrix<double, 18, 1>>(dD.data());
    }
  }
  // Σ_k w_k c_kj c_kl, with D_k = X_k - X_a and c_k = δ_kj - δ_aj - g_j·D_k.
  [[nodiscard]] double residualCoefficient(Index j, Index l) const {
    const Index anchor = first();
    const Vec3 &gj = gradientRows_[j], &gl = gradientRows_[l];
    const double aj = j == anchor ? 1.0 : 0.0, al = l == anchor ? 1.0 : 0.0;
    double sum = aj * al * weight_ + gj.dot(moment_ * gl) + aj * gl.dot(firstMoment_) + al * gj.dot(firstMoment_);
    if (j != anchor) sum -= s_.weights[j] * (al + gl.dot(offset(j)));
    if (l != anchor) sum -= s_.weights[l] * (aj + gj.dot(offset(l)));
    if (j == l && j != anchor) sum += s_.weights[j];
    return sum;
  }
  [[nodiscard]] Vec3 offset(Index e) const {
    return s_.unstrained(q_, X_[s_.phyxels.indices[e]] - X_[s_.phyxels.indices[first()]]);
  }

  const StencilSet &s_;
  std::size_t q_;
  GradientRows gradientRows_;
  ModeRows modeRows_;
  std::span<const Vec3> X_;
  Stabilisation control_;
  HourglassEnergy modal_, viscous_;
  double viscousScale_, viscousTwist_ = 0.0;
  bool linear_;
  HourglassPoint point_;
  std::optional<RelaxingHourglass> relaxing_;
  const QuadraticPoints::Point *quadratic_ = nullptr;  // null: an ordinary point
  std::optional<QuadraticPoint> quadraticPoint_;
  Vec3 twistQD_ = Vec3::Zero();
  Matrix9 elastic_;
  double scale_ = 0.0, weight_ = 0.0;
  Mat3 visible_ = Mat3::Identity(), moment_ = Mat3::Zero();
  Vec3 firstMoment_ = Vec3::Zero();
};

}  // namespace pointbased::detail
