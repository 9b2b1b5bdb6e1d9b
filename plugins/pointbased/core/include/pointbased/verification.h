// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "pointbased/simulator.h"

namespace pointbased {

/// Spacing of a body over that of its fine reference; the second value if the first would need too many phyxels.
inline constexpr double kFineReferenceRefinement = 2.0, kSmallFineReferenceRefinement = 1.5;
/// A fine reference with more phyxels is refused: minutes of solving and gigabytes for its factors.
inline constexpr std::size_t kMaxFineReferencePhyxels = 200'000;
/// Error of a solution over its difference from that of a spacing `refinement` times finer: 1 / (1 - refinement^-p) for
/// p = 2. In the validation cases it is 1.1 … 1.8 at 2 (test_verification).
[[nodiscard]] constexpr double errorOverDifference(double refinement) {
  return refinement * refinement / (refinement * refinement - 1.0);
}

/// Copy of a body in its present state with what acts on it, so that the simulation neither waits nor changes.
struct VerificationTarget {
  std::string name;
  BodyCheckpoint state;
  Constitution constitution;
  Foundation foundation;
  std::vector<Vec3> externalForces;  ///< [phyxels] N, or empty
  WorldSettings world;
  std::vector<Obstacle> obstacles;
  double clock = 0.0;  ///< argument of ramps: s, or load factor of a quasi-static solution
};
/// @param body  a body of this simulator
[[nodiscard]] VerificationTarget verificationTarget(const Simulator &simulator, std::size_t body);

struct VerifySettings {
  double refinement = kFineReferenceRefinement;       ///< >= kSmallFineReferenceRefinement
  std::size_t maxPhyxels = kMaxFineReferencePhyxels;  ///< of the fine reference
};

/// Estimated error of a body's solution, from its difference to the fine reference.
struct Verification {
  double spacing = 0.0, fineReferenceSpacing = 0.0;  ///< m
  std::size_t phyxels = 0, fineReferencePhyxels = 0;
  double seconds = 0.0;  ///< s, duration of the verification
  /// m, estimated errors of displacements: errorOverDifference() times the difference. Root mean square over the
  /// volume; bound for 95 % of the area of the skin; maximum over the skin.
  double errorRms = 0.0, error95 = 0.0, errorMax = 0.0;
  Vec3 worst = Vec3::Zero();  ///< world, m: present position of the skin point with the largest error
  /// m, of the skin of the fine reference; for a free body without its rigid motion. 0: only rounding
  double largestDisplacement = 0.0;
  double elasticEnergy = 0.0, fineReferenceElasticEnergy = 0.0;  ///< J, with their stabilisation
  std::vector<Reaction> reactions, fineReferenceReactions;       ///< by fix
  std::vector<double> skinErrors;                                ///< [surfels of the body] m
  /// Text on what the error does not include; empty: it is that of the whole solution.
  std::vector<std::string> limits;
  std::shared_ptr<const RestState> fineReferenceRest;
  std::vector<Vec3> fineReferenceDisplacements;  ///< [phyxels of the fine reference] m

  /// In % of the largest displacement; 0 where nothing is displaced.
  [[nodiscard]] double percent(double error) const {
    return largestDisplacement > 0.0 ? 100.0 * error / largestDisplacement : 0.0;
  }
};

/// Return false to cancel.
using VerifyProgress = std::function<bool(double fraction, const std::string &what)>;

/// Solves the present state of the body again on a finer lattice, its fine reference, and compares. The reference has
/// half of the spacing (a quarter near supports, if affordable; two thirds everywhere if a half is not).
///
/// The fine reference is in equilibrium with what acts on the body now: supports in their present positions, loads at
/// the present value of their ramps, gravity, surroundings. The residual of the balance of forces of the body, by
/// phyxel
///
///     r = -(elastic forces + loads + gravity + surroundings + springs of supports)
///
/// consists of inertia, damping, viscous and relaxing stress, contact, grabs and external forces. It is applied as
/// given: as a density of the mass r_i/m_i, interpolated to the fine reference; under points in contact as a density of
/// the skin. A body in motion is thus compared with the solution of the static problem for its present accelerations:
/// the elliptic reconstruction. Plastic strain is transferred from the nearest points. A body without supports keeps
/// its mean position and rotation; where it presses against something, it stays there instead. Quasi-static solutions
/// with contact or plastic flow are path-dependent: the fine reference follows the same path, from the beginning.
///
/// The error is estimated from the difference u_h/2 - u_h, which is (1 - 2^-p) of it if the error decreases with h^p.
/// The fine reference of a body evaluated at its phyxels is a lattice as well: its difference is nearly all of the
/// error.
///
/// Errors, with nothing changed: a body that is rigid, has stopped, is inverted, is too thin or not filled by the
/// recipe; a renewed reference; a fine reference of more than settings.maxPhyxels; no solution; "cancelled".
/// @param shape, recipe  used to fill the body; the spacing and count of the recipe are ignored
/// @param stop           null, or raised: cancelled within a fraction of a second
/// @threads any one, concurrently with steps of the simulation
/// @source  Makridakis and Nochetto, Elliptic reconstruction and a posteriori error estimates for parabolic problems,
///          SIAM J. Numer. Anal. 41, 2003; Roache, Perspective: a method for uniform reporting of grid refinement
///          studies, J. Fluids Eng. 116, 1994 (error from two spacings)
[[nodiscard]] Result<Verification> verify(const VerificationTarget &target, const BodyShape &shape,
                                          const BodyRecipe &recipe, const ParallelFor &parallelFor,
                                          const VerifyProgress &progress = {}, const StopRequest *stop = nullptr,
                                          const VerifySettings &settings = {});

}  // namespace pointbased
