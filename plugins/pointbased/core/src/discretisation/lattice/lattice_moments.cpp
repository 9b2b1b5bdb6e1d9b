// SPDX-License-Identifier: Apache-2.0
#include "discretisation/lattice/lattice_moments.h"

namespace pointbased::lattice {
namespace {
constexpr double kSmall = 1.0 / kSamplesPerAxis;
}

void Moments::add(double part, const Vec3 &c, const Vec3 &variance) {
  share += part;
  first += part * c;
  mixed += part * Vec3(c[0] * c[1], c[0] * c[2], c[1] * c[2]);
  triple += part * c[0] * c[1] * c[2];
  const Vec3 squares = c.cwiseAbs2() + variance;
  second += part * squares;
  cubic += part * squares * c.transpose();
  quartic += part * squares.cwiseProduct(Vec3(c[1] * c[2], c[0] * c[2], c[0] * c[1]));
}

Vec3 Moments::variance() const { return (second / share - centroid().cwiseAbs2()).cwiseMax(0.0); }

// N_j = Π (1/2 + s_a ξ_a), expanded.
std::array<double, 8> Moments::functions() const {
  std::array<double, 8> result{};
  for (int j = 0; j < 8; ++j) {
    const Vec3 s(cornerSign(j, 0), cornerSign(j, 1), cornerSign(j, 2));
    const double bilinear = s[0] * s[1] * mixed[0] + s[0] * s[2] * mixed[1] + s[1] * s[2] * mixed[2];
    result[static_cast<std::size_t>(j)] =
        0.125 + (0.25 * s.dot(first) + 0.5 * bilinear + s[0] * s[1] * s[2] * triple) / share;
  }
  return result;
}

std::array<Vec3, 8> Moments::gradients() const {
  std::array<Vec3, 8> result;
  // mixed[a + b - 1] belongs to axes a and b.
  for (int j = 0; j < 8; ++j)
    for (int a = 0; a < 3; ++a) {
      const int b = a == 0 ? 1 : 0, c = a == 2 ? 1 : 2;
      const double sb = cornerSign(j, b), sc = cornerSign(j, c);
      result[static_cast<std::size_t>(j)][a] =
          cornerSign(j, a) * (0.25 + (0.5 * (sb * first[b] + sc * first[c]) + sb * sc * mixed[b + c - 1]) / share);
    }
  return result;
}

Moments fullCell() {
  Moments m;
  m.add(1.0, Vec3::Zero(), Vec3::Constant(1.0 / 12.0));
  return m;
}

std::array<double, 8> trilinear(const Vec3 &place) {
  std::array<double, 8> result{};
  for (int j = 0; j < 8; ++j)
    result[static_cast<std::size_t>(j)] =
        (0.5 + cornerSign(j, 0) * place[0]) * (0.5 + cornerSign(j, 1) * place[1]) * (0.5 + cornerSign(j, 2) * place[2]);
  return result;
}

std::array<Vec3, 8> trilinearGradients(const Vec3 &place) {
  std::array<Vec3, 8> result;
  for (int j = 0; j < 8; ++j) {
    const Vec3 s(cornerSign(j, 0), cornerSign(j, 1), cornerSign(j, 2));
    const Vec3 f = Vec3::Constant(0.5) + s.cwiseProduct(place);
    result[static_cast<std::size_t>(j)] = Vec3(s[0] * f[1] * f[2], s[1] * f[0] * f[2], s[2] * f[0] * f[1]);
  }
  return result;
}

SampleContent contentOf(const CellSet &set, const Cell &cell, int sample) {
  SampleContent content;
  content.centre = sampleOffset(sample);
  content.variance = Vec3::Constant(kSmall * kSmall / 12.0);
  if (cell.samples == kNone) {
    content.share = 1.0;
    return content;
  }
  const Samples &d = set.samples[cell.samples];
  content.share = shareOf(d[static_cast<std::size_t>(sample)], set.edge(cell) * kSmall);
  if (content.share <= 0.0 || content.share >= 1.0 || !set.measured) return content;
  Vec3 normal;
  for (int axis = 0; axis < 3; ++axis) {
    const int step = 1 << (2 * axis), at = sampleCoordinate(sample, axis);
    const int low = at > 0 ? sample - step : sample, high = at < kSamplesPerAxis - 1 ? sample + step : sample;
    normal[axis] = (d[static_cast<std::size_t>(high)] - d[static_cast<std::size_t>(low)]) /
                   static_cast<double>((high - low) / step);
  }
  const double length = normal.norm();
  if (!(length > 0.0)) return content;
  normal /= length;
  content.normal = normal;
  content.centre -= 0.5 * (1.0 - content.share) * kSmall * normal;
  content.variance -= kSmall * kSmall / 12.0 * (1.0 - content.share * content.share) * normal.cwiseAbs2();
  return content;
}

Eigen::Vector4d modeFactors(const CellSet &set, const CutCellFragment &part) {
  Eigen::Vector4d factors = Eigen::Vector4d::Ones();
  const Cell &cell = set.cells[part.cell];
  if (cell.samples == kNone || part.share > 0.999) return factors;
  // Content of the outer layers of samples on either side.
  Vec3 normal = Vec3::Zero();
  const Samples &d = set.samples[cell.samples];
  for (int s = 0; s < kSamples; ++s) {
    if ((part.samples >> s & 1) == 0) continue;
    const double share = shareOf(d[static_cast<std::size_t>(s)], set.edge(cell) * kSmall);
    for (int axis = 0; axis < 3; ++axis) {
      if (sampleCoordinate(s, axis) == 0) normal[axis] += share;
      if (sampleCoordinate(s, axis) == kSamplesPerAxis - 1) normal[axis] -= share;
    }
  }
  const Vec3 squares = normal.cwiseAbs2() / std::max(normal.squaredNorm(), 1e-30);
  const auto factor = [&](int i, int j) { return std::sqrt(std::max(0.02, 1.0 - 5.0 * squares[i] * squares[j])); };
  factors.head<3>() = Vec3(factor(0, 1), factor(0, 2), factor(1, 2));
  return factors;
}

Moments momentsOf(const CellSet &set, const CutCellFragment &part) {
  const Cell &cell = set.cells[part.cell];
  if (cell.samples == kNone) return fullCell();
  Moments moments;
  for (int s = 0; s < kSamples; ++s) {
    if ((part.samples >> s & 1) == 0) continue;
    const SampleContent content = contentOf(set, cell, s);
    if (content.share > 0.0) moments.add(content.share / kSamples, content.centre, content.variance);
  }
  return moments;
}

}  // namespace pointbased::lattice
