// SPDX-License-Identifier: Apache-2.0
#include "relaxation.h"

#include <cstdio>

#include "declarations.h"

namespace baselines {
namespace {

constexpr int kMaxEvaluations = 200000;
/// Laws stiffen; steps are shortened by this where forces grow out of bounds.
constexpr double kShorten = 0.5;
constexpr int kMaxShortenings = 6;

/// What is left of the forces on free points, and what all that bears or loads them amounts to.
struct Balance {
  double left_N = 0.0, borne_N = 0.0;
};

double squaredLoads(const PointBody &body, const Loading &loading) {
  double sum = 0.0;
  const auto add = [&](const std::vector<SurfaceLoad> &loads) {
    for (const SurfaceLoad &load : loads) {
      const double size = length(load.force_N) + std::abs(load.pressure_Pa) * load.area_m2,
                   part = loading.moment.of(load.ramp_s, load.began_s);
      sum += part * part * size * size / static_cast<double>(load.triangles.size());
    }
  };
  add(body.loads);
  add(loading.more);
  return sum;
}

class Descent {
 public:
  Descent(PointBody &body, const Loading &loading)
      : body_(body), loading_(loading), loads_N2_(squaredLoads(body, loading)) {
    body_.moveSupports(loading.moment, 0.0);
    std::fill(body_.state().velocities.begin(), body_.state().velocities.end(), Vec3{});
    start_ = body_.state().positions;
  }

  /// @return whether it has come to rest; false: forces grew out of bounds, or it took too long
  bool run(double tolerance, double stepLength, int &evaluations) {
    std::vector<Vec3> before = start_;
    body_.state().positions = start_;
    double t = 1.0, first_N = -1.0;
    for (; evaluations < kMaxEvaluations; ++evaluations) {
      body_.computeForces(0.0, loading_);
      const Balance is = balance();
      if (!std::isfinite(is.left_N)) return false;
      if (is.left_N <= tolerance * is.borne_N || is.left_N == 0.0) return true;
      if (first_N < 0.0) first_N = std::max(is.left_N, is.borne_N);
      if (is.left_N > 1e4 * first_N) return false;
      const double next = 0.5 * (1.0 + std::sqrt(1.0 + 4.0 * t * t));
      if (advance(before, stepLength, (t - 1.0) / next))
        t = next;
      else
        t = 1.0;
    }
    return false;
  }

 private:
  [[nodiscard]] Vec3 forceOn(std::size_t i) const {
    return body_.forces()[i] + body_.masses()[i] * loading_.gravity_m_s2;
  }
  [[nodiscard]] Balance balance() const {
    double left = 0.0, borne = loads_N2_;
    for (std::size_t i = 0; i < body_.masses().size(); ++i) {
      const Vec3 f = forceOn(i);
      const Vec3 weight = body_.masses()[i] * loading_.gravity_m_s2;
      (body_.held()[i] != 0 ? borne : left) += dot(f, f);
      borne += dot(weight, weight);
    }
    return {std::sqrt(left), std::sqrt(borne)};
  }
  /// A step along the forces, then some of the way on. @return whether that led downhill; else only the step is done
  bool advance(std::vector<Vec3> &before, double stepLength, double momentum) {
    std::vector<Vec3> &x = body_.state().positions;
    double downhill = 0.0;
    next_.resize(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Vec3 f = body_.held()[i] != 0 ? Vec3{} : forceOn(i);
      next_[i] = x[i] + (stepLength / (body_.stiffnesses()[i] + body_.pushStiffnesses()[i])) * f;
      downhill += dot(f, next_[i] - before[i]);
    }
    const bool goesOn = downhill >= 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      x[i] = next_[i] + (goesOn ? momentum : 0.0) * (next_[i] - before[i]);
      if (body_.held()[i] != 0) x[i] = next_[i];
    }
    before.swap(next_);
    return goesOn;
  }

  PointBody &body_;
  const Loading &loading_;
  double loads_N2_;
  std::vector<Vec3> start_, next_;
};

}  // namespace

void relax(PointBody &body, const Loading &loading, const ParameterValues &ofWorld) {
  Descent descent(body, loading);
  const double tolerance = ofWorld.number(kTolerance);
  int evaluations = 0;
  double stepLength = 1.0;
  for (int n = 0; n <= kMaxShortenings && evaluations < kMaxEvaluations; ++n, stepLength *= kShorten)
    if (descent.run(tolerance, stepLength, evaluations)) return;
  char text[80];
  std::snprintf(text, sizeof text, "comes to no rest within %d evaluations; help: more load steps", evaluations);
  throw sdk::Error(C3DE_E_DIVERGED, text);
}

}  // namespace baselines
