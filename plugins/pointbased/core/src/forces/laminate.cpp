// SPDX-License-Identifier: Apache-2.0
#include "forces/laminate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "forces/point_loops.h"
#include "forces/vector_forces_parts.h"

namespace pointbased::detail {
namespace {

constexpr double kMaxJump = 0.7;
constexpr double kMinWay = 1e-6;  // of a cell, between the centres of two materials
constexpr double kAlike = 1e-6;   // relative difference of moduli
// Of the squared edge of a cell: flatter layers share strains as if they had this extent.
constexpr double kMinSpread = 1e-6;

// Some of the points of a cell, combined to one material: sums weighted by volume until they are divided.
struct Layer {
  double volume = 0.0, mu = 0.0, lambda = 0.0;
  Vec3 middle = Vec3::Zero(), squares = Vec3::Zero();  // m, m²: means of the position and of its squares
  Vec3 first = Vec3::Zero(), mixed = Vec3::Zero();     // as in CellShape
  Vec3 extent = Vec3::Zero();                          // m⁵: Σ v s, above 0

  void add(const StencilSet &s, std::size_t q, const Material &material) {
    const CellShape &shape = *s.cellShapeOf(q);
    const double edge = 0.25 / shape.gradient, v = s.volumes[q];
    const Vec3 place = 2.0 * edge * edge * shape.first;
    volume += v;
    mu += v * material.mu();
    lambda += v * (material.lambda() + material.volumeStiffness);
    middle += v * place;
    squares += v * (s.variances[q] + place.cwiseAbs2());
    first += v * shape.first;
    mixed += v * shape.mixed;
    extent += v * (s.variances[q] + Vec3::Constant(kMinSpread * edge * edge));
  }
  void divide() {
    mu /= volume;
    lambda /= volume;
    for (Vec3 *mean : {&middle, &squares, &first, &mixed}) *mean /= volume;
  }
};

// Normal of the border: from the centre of one layer to that of the other, scaled by the extents of both, which a skin
// may cut.
Vec3 normalOf(const Layer &one, const Layer &two, double edge) {
  const double all = one.volume + two.volume;
  const Vec3 way = one.middle - two.middle, middle = (one.volume * one.middle + two.volume * two.middle) / all,
             extent = (one.volume * one.squares + two.volume * two.squares) / all - middle.cwiseAbs2();
  if (!(way.norm() > kMinWay * edge) || !(extent.minCoeff() > 0.0)) return Vec3::Zero();
  return way.cwiseQuotient(extent).normalized();
}

// Number of points of a cell, softest first, that form the softer layer: up to the widest gap between their moduli.
std::size_t softerOf(const Constitution &constitution, const StencilSet &s, std::span<const Index> points) {
  std::size_t count = 1;
  double widest = 0.0;
  for (std::size_t k = 1; k < points.size(); ++k)
    if (const double gap =
            materialOfPoint(constitution, s, points[k]).mu() / materialOfPoint(constitution, s, points[k - 1]).mu();
        gap > widest) {
      widest = gap;
      count = k;
    }
  return count;
}

using Matrix9 = Eigen::Matrix<double, 9, 9>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

// For strains xx, yy, zz, yz, xz, xy, shears twice.
Matrix6 stiffnessOf(double mu, double lambda) {
  Matrix6 C = Matrix6::Zero();
  C.topLeftCorner<3, 3>().setConstant(lambda);
  C.diagonal() << 2.0 * mu + lambda, 2.0 * mu + lambda, 2.0 * mu + lambda, mu, mu, mu;
  return C;
}

// Strain of y nᵀ for every y.
Eigen::Matrix<double, 6, 3> strainOfJump(const Vec3 &n) {
  Eigen::Matrix<double, 6, 3> Y = Eigen::Matrix<double, 6, 3>::Zero();
  for (int c = 0; c < 3; ++c) {
    Y(c, c) = n[c];
    const int d = (c + 1) % 3, e = (c + 2) % 3;
    Y(3 + c, d) = n[e];
    Y(3 + c, e) = n[d];
  }
  return Y;
}

// Strains within the layers for those of the modes that vary along an axis: plane stress perpendicular to it for both
// layers together, shared across the border.
// @return per layer: from xx, yy, 2 xy to all six
std::array<Eigen::Matrix<double, 6, 3>, 2> sharedStrains(const std::array<Layer, 2> &layers, const Vec3 &normal,
                                                         int axis) {
  const std::array<int, 3> kept = {axis == 0 ? 1 : 0, axis == 2 ? 1 : 2, 3 + axis};
  const double all = layers[0].volume + layers[1].volume;
  std::array<Eigen::Matrix<double, 6, 9>, 2> all9;
  Matrix9 sum = Matrix9::Zero();
  for (std::size_t k = 0; k < 2; ++k) {
    Eigen::Matrix<double, 6, 9> &T = all9[k];
    T.setZero();
    for (int i = 0, free = 3; i < 6; ++i) {
      const auto found = std::ranges::find(kept, i);
      T(i, found != kept.end() ? static_cast<int>(found - kept.begin()) : free++) = 1.0;
    }
    T.rightCols<3>() = (k == 0 ? layers[1].volume : -layers[0].volume) / all * strainOfJump(normal);
    sum += layers[k].extent[axis] * T.transpose() * stiffnessOf(layers[k].mu, layers[k].lambda) * T;
  }
  const Eigen::Matrix<double, 6, 3> rest = -sum.bottomRightCorner<6, 6>().ldlt().solve(sum.bottomLeftCorner<6, 3>());
  std::array<Eigen::Matrix<double, 6, 3>, 2> out;
  for (std::size_t k = 0; k < 2; ++k) out[k] = all9[k].leftCols<3>() + all9[k].rightCols<6>() * rest;
  return out;
}

// Mode energies of a cell from its layers.
class SharedModes {
 public:
  SharedModes(const std::array<Layer, 2> &layers, const Vec3 &normal, double stabilisation) {
    Vec3 root;
    for (int axis = 0; axis < 3; ++axis) {
      strains_[static_cast<std::size_t>(axis)] = sharedStrains(layers, normal, axis);
      double shear = 0.0;
      for (std::size_t k = 0; k < 2; ++k) {
        const Eigen::Matrix<double, 6, 1> t = strains_[static_cast<std::size_t>(axis)][k].col(2);
        shear += layers[k].extent[axis] * t.dot(stiffnessOf(layers[k].mu, layers[k].lambda) * t);
      }
      root[axis] = std::sqrt(shear);
    }
    // Its square is θ 1 + (1 - θ)/3 for the shears in HourglassEnergy.
    const double warping = std::sqrt(kWarping);
    relieved_ = std::sqrt(stabilisation) * Matrix9::Identity();
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        relieved_(3 * i + 2, 3 * j + 2) =
            std::sqrt(stabilisation) * ((i == j ? warping : 0.0) + (1.0 - warping) / 3.0) * root[j] / root[i];
  }

  [[nodiscard]] ModeForm of(std::size_t layer, const Material &material, const Vec3 &extent) const {
    const Matrix6 C = stiffnessOf(material.mu(), material.lambda() + material.volumeStiffness);
    Matrix9 K = Matrix9::Zero();
    for (int axis = 0; axis < 3; ++axis) {
      const auto &T = strains_[static_cast<std::size_t>(axis)][layer];
      K.block<3, 3>(3 * axis, 3 * axis) = extent[axis] * T.transpose() * C * T;
    }
    return packed(relieved_.transpose() * K * relieved_);
  }

  // @param K  for xx, yy, 2 xy of the planes perpendicular to x, then y, then z
  static ModeForm packed(const Matrix9 &K) {
    ModeForm out;
    std::size_t at = 0;
    for (int i = 0; i < 9; i += 3)
      for (const auto &[r, c] : {std::pair(0, 0), std::pair(1, 0), std::pair(1, 1)}) out[at++] = K(i + r, i + c);
    for (int i = 0; i < 9; i += 3)
      for (int r = 0; r < 2; ++r)
        for (int c = 0; c < 3; ++c) out[at++] = K(i + r, 3 * c + 2);
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c <= r; ++c) out[at++] = K(3 * r + 2, 3 * c + 2);
    return out;
  }

 private:
  std::array<std::array<Eigen::Matrix<double, 6, 3>, 2>, 3> strains_;  // [axes][layers]
  Matrix9 relieved_;
};

}  // namespace

ModeForm Laminates::modesAt(const StencilSet &s, std::size_t q) const {
  if (at(q) != nullptr) return modes[of[q]];
  const HourglassEnergy &energy = plain[s.materials[q]];
  const Vec3 vs = s.volumes[q] * s.variances[q], root = vs.cwiseSqrt();
  Matrix9 K = Matrix9::Zero();
  for (int i = 0; i < 3; ++i) {
    K.block<2, 2>(3 * i, 3 * i) =
        vs[i] * (2.0 * energy.mu() * Eigen::Matrix2d::Identity() + Eigen::Matrix2d::Constant(energy.lambda()));
    for (int j = 0; j < 3; ++j)
      K(3 * i + 2, 3 * j + 2) = energy.mu() * root[i] * root[j] * ((i == j ? kWarping : 0.0) + (1.0 - kWarping) / 3.0);
  }
  return SharedModes::packed(K);
}

Laminates findLaminates(const StencilSet &s, const Constitution &constitution) {
  Laminates out;
  if (s.materials.empty() || !s.isLattice() || !s.reference.empty() || constitution.hasHistory()) return out;
  const bool withModes = constitution.stabilisation > 0.0;
  if (withModes)
    for (const Material &material : constitution.materials)
      out.plain.emplace_back(material, constitution.stabilisation);
  const auto muOf = [&](Index q) { return materialOfPoint(constitution, s, q).mu(); };
  std::vector<Index> points;
  for (Index q = 0; q < s.pointCount(); q += static_cast<Index>(points.size())) {
    points.assign(1, q);
    while (points.back() + 1 < s.pointCount() && std::ranges::equal(s.phyxels.row(q), s.phyxels.row(points.back() + 1)))
      points.push_back(points.back() + 1);
    if (points.size() == 1 || !std::ranges::all_of(points, [&](Index p) {
          return kernelKnows(materialOfPoint(constitution, s, p)) && s.cellShapeOf(p) != nullptr;
        }))
      continue;
    const Index cell = points.front();
    std::ranges::stable_sort(points, {}, muOf);
    const std::size_t softer = softerOf(constitution, s, points);
    std::array<Layer, 2> layers;
    for (std::size_t k = 0; k < points.size(); ++k)
      layers[k < softer ? 0 : 1].add(s, points[k], materialOfPoint(constitution, s, points[k]));
    for (Layer &layer : layers) layer.divide();
    const auto &[one, two] = layers;
    const double ofOne = one.volume / (one.volume + two.volume), ofTwo = 1.0 - ofOne;
    const double mu = ofTwo * one.mu + ofOne * two.mu, lambda = ofTwo * one.lambda + ofOne * two.lambda,
                 wave = lambda + 2.0 * mu;
    if (!(wave > 0.0) ||
        (std::abs(one.mu - two.mu) <= kAlike * mu && std::abs(one.lambda - two.lambda) <= kAlike * wave))
      continue;
    Laminate laminate;
    laminate.normal = normalOf(one, two, 0.25 / s.cellShapeOf(q)->gradient);
    if (laminate.normal == Vec3::Zero()) continue;
    std::array<Laminate::Moduli, 2> moduli;
    for (std::size_t k = 0; k < 2; ++k) {
      const double sign = k == 0 ? 1.0 : -1.0;
      moduli[k] = {sign * 2.0 * layers[k].mu / mu, sign * layers[k].lambda / wave, sign * 2.0 * layers[k].mu / wave};
    }
    laminate.limit = std::max(ofOne, ofTwo) / kMaxJump;
    laminate.cell = cell;
    std::optional<SharedModes> shared;
    if (withModes) shared.emplace(layers, laminate.normal, constitution.stabilisation);
    if (out.of.empty()) out.of.assign(s.pointCount(), Laminates::kNone);
    for (std::size_t k = 0; k < points.size(); ++k) {
      const Index p = points[k];
      const std::size_t layer = k < softer ? 0 : 1;
      laminate.share = layer == 0 ? ofTwo : -ofOne;
      laminate.own = moduli[layer];
      laminate.other = moduli[1 - layer];
      laminate.first = layers[1 - layer].first;
      laminate.mixed = layers[1 - layer].mixed;
      laminate.part = s.volumes[p] / layers[layer].volume;
      out.of[p] = static_cast<Index>(out.all.size());
      out.all.push_back(laminate);
      if (shared)
        out.modes.push_back(shared->of(layer, materialOfPoint(constitution, s, p), s.volumes[p] * s.variances[p]));
    }
  }
  return out;
}

void toMaterialGradients(const Laminates &laminates, const StencilSet &s, const Constitution &constitution,
                         std::span<Mat3> gradients) {
  const auto isOf = [&](std::size_t q, Index cell) {
    return q < s.pointCount() && laminates.at(q) != nullptr && laminates.at(q)->cell == cell;
  };
  for (std::size_t q = 0; q < laminates.of.size();) {
    const Laminate *laminate = laminates.at(q);
    if (laminate == nullptr) {
      ++q;
      continue;
    }
    const Index cell = laminate->cell;
    std::size_t end = q;
    std::array<Mat3, 2> means = {Mat3::Zero(), Mat3::Zero()};
    for (; isOf(end, cell); ++end)
      means[laminates.at(end)->share > 0.0 ? 0 : 1] +=
          laminates.at(end)->part * (s.axes.transpose() * gradients[end] * s.axes);
    for (; q < end; ++q) {
      laminate = laminates.at(q);
      const bool isLinear = materialOfPoint(constitution, s, q).law == MaterialLaw::linear;
      const Vec3 &n = laminate->normal;
      Vec3 b = Vec3::Zero();
      const auto add = [&](const Laminate::Moduli &of, const Mat3 &F) {
        const Mat3 E =
            isLinear ? Mat3(symmetric(F) - Mat3::Identity()) : Mat3(0.5 * (F.transpose() * F - Mat3::Identity()));
        const Vec3 En = E * n;
        const double nEn = n.dot(En);
        b -= of.shear * (En - nEn * n) + (of.trace * E.trace() + of.across * nEn) * n;
      };
      const Mat3 own = s.axes.transpose() * gradients[q] * s.axes, &other = means[laminate->share > 0.0 ? 1 : 0];
      add(laminate->own, own);
      add(laminate->other, other);
      const double ofOther = std::abs(laminate->share), k = laminate->limit;
      const Vec3 y =
          isLinear ? b : Vec3(((1.0 - ofOther) * own + ofOther * other) * b / std::sqrt(1.0 + k * k * b.squaredNorm()));
      gradients[q] += laminate->share * (s.axes * y) * (s.axes * n).transpose();
    }
  }
}

}  // namespace pointbased::detail
