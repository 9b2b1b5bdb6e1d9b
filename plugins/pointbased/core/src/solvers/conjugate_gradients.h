// SPDX-License-Identifier: Apache-2.0
// Preconditioned conjugate gradients over phyxels, truncated for Newton's method, and the sums they need. Private.
#pragma once

#include <cmath>
#include <vector>

#include "pointbased/types.h"

namespace pointbased::detail {

/// Σ a_i · b_i in a fixed order (blocks of 512, four running sums each): the same bits whatever runs the rest, and less
/// round-off than one running sum.
[[nodiscard]] double dot(std::span<const Vec3> a, std::span<const Vec3> b);
/// y += s x
void addScaled(double s, std::span<const Vec3> x, std::span<Vec3> y);
/// Largest |v_i|, and where; NaN with the first phyxel that is not finite.
struct Largest {
  double value = 0.0;
  Index at = 0;
};
[[nodiscard]] Largest largest(std::span<const Vec3> v);

/// out = operator(in); `out` is overwritten.
using Apply = std::function<void(std::span<const Vec3> in, std::span<Vec3> out)>;

enum class LinearEnd {
  tolerance,          ///< as exact as asked for
  iterations,         ///< out of iterations
  radius,             ///< x has come as far as it may
  negativeCurvature,  ///< A is not positive along the next search direction; x is what came before it
  notFinite           ///< A or M gave no usable number
};

/// A x = b by conjugate gradients with preconditioner M, in pieces: run() may be called again with a smaller tolerance,
/// and restart() goes on from the present x with another M.
///
/// Stops when |r| in the norm of M^-1 is below tolerance times |b|, and the energy that the last eighth of the
/// iterations gained is below tolerance² of all of it: with a weak preconditioner the residual of a slender body is
/// small long before its bending is found, and the second test sees that.
/// @source  Hestenes and Stiefel, J. Res. NBS 49, 1952; truncation: Steihaug, SIAM J. Numer. Anal. 20, 1983; the gain
///          as an estimate of the error: Strakos and Tichy, ETNA 13, 2002
class ConjugateGradients {
 public:
  /// From x = 0. `b` must outlive the solve.
  void begin(std::span<const Vec3> b, const Apply &precondition);
  /// From the present x with another M.
  void restart(const Apply &product, const Apply &precondition);
  /// At most `iterations` more, and no farther than `radius` from zero in the norm of M: where the path of iterates
  /// crosses it x stays on it, along a direction of negative curvature as well, unless it is infinite.
  [[nodiscard]] LinearEnd run(const Apply &product, const Apply &precondition, double tolerance, int iterations,
                              double radius);

  [[nodiscard]] std::span<const Vec3> x() const { return x_; }
  /// |x| in the norm of M. It grows with every iteration.
  [[nodiscard]] double length() const { return std::sqrt(xMx_); }
  /// b·x - 1/2 x·A x
  [[nodiscard]] double gain() const { return 0.5 * total_ + gainOnRadius_; }
  /// The point of the path of iterates from zero to x at that |x|, between recorded ones on a straight line.
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
  std::vector<Recorded> recorded_;  // iterates, each half as long again as the one before
  std::size_t recordedCount_ = 0;
  double xMx_ = 0.0, xMp_ = 0.0, gainOnRadius_ = 0.0;
  std::vector<double> gains_;  // α r·z of every iteration since begin() or restart()
  double rz_ = 0.0, reference_ = 0.0, total_ = 0.0, pMp_ = 0.0;
  int iterations_ = 0;
};

}  // namespace pointbased::detail
