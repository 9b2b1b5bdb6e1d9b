// SPDX-License-Identifier: Apache-2.0
// Preconditioned conjugate gradients over phyxels, truncated for Newton's method, and their sums. Private.
#pragma once

#include <cmath>
#include <vector>

#include "pointbased/types.h"

namespace pointbased::detail {

/// Σ a_i · b_i in a fixed order (blocks of 512, four running sums each): the same bits for any number of threads, and
/// less round-off than one running sum.
[[nodiscard]] double dot(std::span<const Vec3> a, std::span<const Vec3> b);
/// y += s x
void addScaled(double s, std::span<const Vec3> x, std::span<Vec3> y);
/// Largest |v_i| and its index; NaN with the first phyxel that is not finite.
struct Largest {
  double value = 0.0;
  Index at = 0;
};
[[nodiscard]] Largest largest(std::span<const Vec3> v);

/// out = operator(in); `out` is overwritten.
using Apply = std::function<void(std::span<const Vec3> in, std::span<Vec3> out)>;

enum class LinearEnd {
  tolerance,          ///< the requested tolerance is reached
  iterations,         ///< out of iterations
  radius,             ///< x has reached the trust-region radius
  negativeCurvature,  ///< A is not positive along the next search direction; x is the iterate before it
  notFinite           ///< A or M returned no finite number
};

/// Solves A x = b by conjugate gradients with preconditioner M, in stages: run() may be called again with a smaller
/// tolerance, and restart() continues from the current x with another M.
///
/// Stops if |r| in the norm of M^-1 is below tolerance times |b|, and if the energy gained by the last eighth of the
/// iterations is below tolerance² of the total. With a weak preconditioner the residual of a slender body is small long
/// before its bending is found; the second test detects that.
/// @source  Hestenes and Stiefel, J. Res. NBS 49, 1952; truncation: Steihaug, SIAM J. Numer. Anal. 20, 1983; the gain
/// as an estimate of the error: Strakos and Tichy, ETNA 13, 2002
class ConjugateGradients {
 public:
  /// Starts from x = 0. `b` must outlive the solve.
  void begin(std::span<const Vec3> b, const Apply &precondition);
  /// Continues from the current x with another M.
  void restart(const Apply &product, const Apply &precondition);
  /// Runs at most `iterations` more, within `radius` from zero in the norm of M. If the path of iterates crosses the
  /// radius, x is the intersection. The same applies to a direction of negative curvature, unless the radius is
  /// infinite.
  [[nodiscard]] LinearEnd run(const Apply &product, const Apply &precondition, double tolerance, int iterations,
                              double radius);

  [[nodiscard]] std::span<const Vec3> x() const { return x_; }
  /// The length |x| in the norm of M. It increases with every iteration.
  [[nodiscard]] double length() const { return std::sqrt(xMx_); }
  /// b·x - 1/2 x·A x
  [[nodiscard]] double gain() const { return 0.5 * total_ + gainOnRadius_; }
  /// The point with that |x| on the path of iterates from zero to x, linear between recorded iterates.
  void pointOnPath(double length, std::vector<Vec3> &out) const;
  /// M^-1 b of the last begin() or restart(): the preconditioned steepest descent.
  [[nodiscard]] std::span<const Vec3> preconditioned() const { return steepest_; }
  [[nodiscard]] int iterations() const { return iterations_; }  ///< since begin()

 private:
  void goDown();  // the first direction: z
  void recordIterate();
  [[nodiscard]] bool accurate(double tolerance) const;

  std::span<const Vec3> b_;
  std::vector<Vec3> x_, r_, z_, p_, q_, steepest_;
  struct Recorded {
    double length = 0.0;
    std::vector<Vec3> x;
  };
  std::vector<Recorded> recorded_;  // iterates, each 1.5 times as long as the one before
  std::size_t recordedCount_ = 0;
  double xMx_ = 0.0, xMp_ = 0.0, gainOnRadius_ = 0.0;
  std::vector<double> gains_;  // α r·z of every iteration since begin() or restart()
  double rz_ = 0.0, reference_ = 0.0, total_ = 0.0, pMp_ = 0.0;
  int iterations_ = 0;
};

}  // namespace pointbased::detail
