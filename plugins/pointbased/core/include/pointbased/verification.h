// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "pointbased/simulator.h"

namespace pointbased {

/// Spacing of a body over that of its shadow; where that would have too many phyxels the second one.
inline constexpr double kShadowRefinement = 2.0, kSmallShadowRefinement = 1.5;
/// A shadow with more phyxels than this is refused: some minutes of solving and gigabytes for its factors.
inline constexpr std::size_t kMostShadowPhyxels = 200'000;
/// Error of a solution over its distance from that of a spacing `refinement` times finer: 1 / (1 - refinement^-p) for
/// p = 2. Of the validation cases it is 1.1 … 1.8 at 2 (test_verification).
[[nodiscard]] constexpr double errorOverDifference(double refinement) {
  return refinement * refinement / (refinement * refinement - 1.0);
}

/// A body as it stands, with what acts on it: a copy, so that nothing of the simulation waits or changes.
struct StandingBody {
  std::string name;
  BodyCheckpoint state;
  Constitution constitution;
  Foundation foundation;
  std::vector<Vec3> externalForces;  ///< [phyxels] N, or empty
  WorldSettings world;
  std::vector<Obstacle> obstacles;
  double clock = 0.0;  ///< what ramps count by: s, or load factor of a quasi-static solution
};
/// @param body  of this simulator
[[nodiscard]] StandingBody standingBody(const Simulator &simulator, std::size_t body);

struct VerifySettings {
  double refinement = kShadowRefinement;         ///< >= kSmallShadowRefinement
  std::size_t mostPhyxels = kMostShadowPhyxels;  ///< of the shadow
};

/// How far a body's solution is from the true one, from its distance to its shadow.
struct Verification {
  double spacing = 0.0, shadowSpacing = 0.0;  ///< m
  std::size_t phyxels = 0, shadowPhyxels = 0;
  double seconds = 0.0;  ///< it took
  /// m, estimated errors of displacements: errorOverDifference() times the difference. Root of the mean square over the
  /// volume; 95 % of the area of the skin, and all of it, are below the others.
  double errorRms = 0.0, error95 = 0.0, errorMax = 0.0;
  Vec3 worst = Vec3::Zero();  ///< world, m: where the skin now is that is farthest off
  /// m, of the shadow's skin; of a free body beyond its rigid motion. 0: what there is, is rounding
  double largestDisplacement = 0.0;
  double elasticEnergy = 0.0, shadowElasticEnergy = 0.0;  ///< J, with their stabilisation
  std::vector<Reaction> reactions, shadowReactions;       ///< by fix
  std::vector<double> skinErrors;                         ///< [surfels of the body] m
  /// What the error does not contain, for people; empty: it is that of the whole solution.
  std::vector<std::string> limits;
  std::shared_ptr<const RestState> shadowRest;
  std::vector<Vec3> shadowDisplacements;  ///< [phyxels of the shadow] m

  /// Of the largest displacement, %; 0 where nothing is displaced.
  [[nodiscard]] double percent(double error) const {
    return largestDisplacement > 0.0 ? 100.0 * error / largestDisplacement : 0.0;
  }
};

/// False: stop, somebody cancelled.
using VerifyProgress = std::function<bool(double fraction, const std::string &what)>;

/// Solves the standing body once more with a lattice of half the spacing (a quarter where supports are, if that can be
/// afforded; two thirds everywhere if a half cannot), its shadow, and compares.
///
/// The shadow is in equilibrium with what acts on the body now: supports where they are, loads as far as their ramps
/// have come, gravity, surroundings. What is left over of the balance of forces of the body, by phyxel
///
///     r = -(elastic forces + loads + gravity + surroundings + springs of supports)
///
/// is inertia, damping, viscous and relaxing stress, contact, hands and forces from outside. It is taken as given: as a
/// density of the mass r_i/m_i, interpolated to the shadow; under points that touch something as a density of the skin.
/// So a body in motion is compared with the solution of the static problem that its accelerations leave: the
/// elliptic reconstruction. Plastic strain is carried over from the nearest points. A body that nothing holds keeps the
/// mean position and turn it has; where it presses against something, it stays there instead. Quasi-static solutions
/// with contact or plastic flow depend on their way: the shadow goes the same way, from the beginning.
///
/// The error is estimated from the difference u_h/2 - u_h, which is (1 - 2^-p) of it where the error falls with h^p.
/// The shadow of a body evaluated at its phyxels is a lattice, too: its difference is nearly all of the error.
///
/// Errors, with nothing changed: a body that is rigid, has stopped, is inverted, is too thin or not filled by the
/// recipe; a reference that was renewed; a shadow of more than settings.mostPhyxels; no solution; "cancelled".
/// @param shape, recipe  what the body was filled from; the recipe's spacing and count are not used
/// @param stop           null, or raised: cancelled within a fraction of a second
/// @threads any one, beside steps of the simulation
/// @source  Makridakis and Nochetto, Elliptic reconstruction and a posteriori error estimates for parabolic problems,
///          SIAM J. Numer. Anal. 41, 2003; Roache, Perspective: a method for uniform reporting of grid refinement
///          studies, J. Fluids Eng. 116, 1994 (error from two spacings)
[[nodiscard]] Result<Verification> verify(const StandingBody &standing, const BodyShape &shape,
                                          const BodyRecipe &recipe, const ParallelFor &parallelFor,
                                          const VerifyProgress &progress = {}, const StopRequest *stop = nullptr,
                                          const VerifySettings &settings = {});

}  // namespace pointbased
