// SPDX-License-Identifier: Apache-2.0
#include "solvers/conjugate_gradients.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pointbased::detail {

namespace {

// Curvature below this part of that of M counts as zero: the step along it would be unbounded.
constexpr double kFlat = 1e-12;

const double *flat(std::span<const Vec3> v) { return v.front().data(); }
double *flat(std::span<Vec3> v) { return v.front().data(); }

}  // namespace

double dot(std::span<const Vec3> a, std::span<const Vec3> b) {
  if (a.empty()) return 0.0;
  constexpr std::size_t kBlock = 512;
  const double *x = flat(a), *y = flat(b);
  const std::size_t n = 3 * a.size();
  double sum = 0.0;
  for (std::size_t begin = 0; begin < n; begin += kBlock) {
    const std::size_t end = std::min(n, begin + kBlock), quads = begin + (end - begin) / 4 * 4;
    double s[4] = {0.0, 0.0, 0.0, 0.0};
    for (std::size_t i = begin; i < quads; i += 4)
      for (std::size_t k = 0; k < 4; ++k) s[k] += x[i + k] * y[i + k];
    for (std::size_t i = quads; i < end; ++i) s[i - quads] += x[i] * y[i];
    sum += (s[0] + s[1]) + (s[2] + s[3]);
  }
  return sum;
}

void addScaled(double s, std::span<const Vec3> x, std::span<Vec3> y) {
  if (x.empty()) return;
  const double *from = flat(x);
  double *to = flat(y);
  const std::size_t n = 3 * x.size();
  for (std::size_t i = 0; i < n; ++i) to[i] += s * from[i];
}

Largest largest(std::span<const Vec3> v) {
  Largest out;
  double best = 0.0;
  for (std::size_t i = 0; i < v.size(); ++i) {
    const double squared = v[i].squaredNorm();
    if (squared <= best) continue;
    out.at = static_cast<Index>(i);
    best = squared;
    if (!std::isfinite(squared) && !v[i].allFinite())
      return {std::numeric_limits<double>::quiet_NaN(), static_cast<Index>(i)};
  }
  // Vectors whose squares leave the range of doubles are measured without squares.
  out.value = v.empty() ? 0.0 : v[out.at].stableNorm();
  return out;
}

void ConjugateGradients::begin(std::span<const Vec3> b, const Apply &precondition) {
  b_ = b;
  x_.assign(b.size(), Vec3::Zero());
  r_.assign(b.begin(), b.end());
  steepest_.resize(b.size());
  z_.resize(b.size());
  q_.resize(b.size());
  iterations_ = 0;
  precondition(b_, steepest_);
  z_ = steepest_;
  recordedCount_ = 0;
  goDown();
}

void ConjugateGradients::restart(const Apply &product, const Apply &precondition) {
  product(x_, q_);
  for (std::size_t i = 0; i < r_.size(); ++i) r_[i] = b_[i] - q_[i];
  precondition(b_, steepest_);
  precondition(r_, z_);
  goDown();
}

void ConjugateGradients::goDown() {
  reference_ = std::sqrt(std::max(0.0, dot(b_, steepest_)));
  p_.assign(z_.begin(), z_.end());
  rz_ = pMp_ = dot(r_, z_);
  // Gain of the initial x: 1/2 b·x = 1/2 x·A x if x is exact; used only as a measure.
  gains_.clear();
  total_ = std::max(0.0, dot(b_, x_));
  xMx_ = total_;  // for an x found with another M: norm by A, which M approximates
  xMp_ = dot(x_, r_);
  gainOnRadius_ = 0.0;
}

bool ConjugateGradients::accurate(double tolerance) const {
  if (rz_ == 0.0) return true;
  if (gains_.empty() || std::sqrt(std::max(0.0, rz_)) > tolerance * reference_) return false;
  const std::size_t window = 1 + gains_.size() / 8;
  double tail = 0.0;
  for (std::size_t i = gains_.size() - window; i < gains_.size(); ++i) tail += gains_[i];
  return tail <= tolerance * tolerance * total_ || gains_.size() == 1;
}

LinearEnd ConjugateGradients::run(const Apply &product, const Apply &precondition, double tolerance, int iterations,
                                  double radius) {
  if (!std::isfinite(rz_) || rz_ < 0.0) return LinearEnd::notFinite;
  for (int k = 0;; ++k) {
    if (accurate(tolerance)) return LinearEnd::tolerance;
    if (k >= iterations) return LinearEnd::iterations;
    product(p_, q_);
    const double curvature = dot(p_, q_);
    if (!std::isfinite(curvature)) return LinearEnd::notFinite;
    const bool isFlat = curvature <= kFlat * pMp_;
    if (isFlat && !std::isfinite(radius)) return LinearEnd::negativeCurvature;

    const double alpha = isFlat ? 0.0 : rz_ / curvature;
    const double longer = xMx_ + alpha * (2.0 * xMp_ + alpha * pMp_);
    if (isFlat || longer >= radius * radius) {
      const double room = std::max(0.0, radius * radius - xMx_);
      const double onto = room / (xMp_ + std::sqrt(xMp_ * xMp_ + room * pMp_));
      addScaled(onto, p_, x_);
      gainOnRadius_ = onto * (rz_ - 0.5 * onto * curvature);
      xMx_ = std::max(xMx_, radius * radius);
      ++iterations_;
      return LinearEnd::radius;
    }
    addScaled(alpha, p_, x_);
    addScaled(-alpha, q_, r_);
    gains_.push_back(alpha * rz_);
    total_ += gains_.back();
    ++iterations_;
    xMp_ += alpha * pMp_;
    xMx_ = longer;
    recordIterate();

    precondition(r_, z_);
    const double next = dot(r_, z_);
    if (!std::isfinite(next) || next < 0.0) return LinearEnd::notFinite;
    const double beta = next / rz_;
    for (std::size_t i = 0; i < p_.size(); ++i) p_[i] = z_[i] + beta * p_[i];
    rz_ = next;
    pMp_ = next + beta * beta * pMp_;  // z is M-orthogonal to the previous p, and to x
    xMp_ *= beta;
  }
}

void ConjugateGradients::recordIterate() {
  constexpr double kApart = 1.5;
  if (recordedCount_ > 0 && length() < kApart * recorded_[recordedCount_ - 1].length) return;
  if (recordedCount_ == recorded_.size()) recorded_.emplace_back();
  recorded_[recordedCount_].length = length();
  recorded_[recordedCount_].x.assign(x_.begin(), x_.end());
  ++recordedCount_;
}

void ConjugateGradients::pointOnPath(double length, std::vector<Vec3> &out) const {
  std::size_t next = 0;
  while (next < recordedCount_ && recorded_[next].length < length) ++next;
  const std::span<const Vec3> to = next < recordedCount_ ? std::span<const Vec3>(recorded_[next].x) : x();
  const double end = next < recordedCount_ ? recorded_[next].length : this->length();
  const double begin = next > 0 ? recorded_[next - 1].length : 0.0;
  const double part = end > begin ? std::min(1.0, (length - begin) / (end - begin)) : 1.0;
  out.assign(to.size(), Vec3::Zero());
  addScaled(part, to, out);
  if (next > 0) addScaled(1.0 - part, recorded_[next - 1].x, out);
}

}  // namespace pointbased::detail
