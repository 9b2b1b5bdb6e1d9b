// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/SparseCore>

#include "pointbased/interpolation.h"
#include "pointbased/obstacle.h"
#include "pointbased/supports.h"
#include "pointbased/surface.h"
#include "pointbased/types.h"

namespace pointbased {

/// Points of a body's skin where contact is felt: the vertices of its surface, thinned where they are much denser than
/// the phyxels, and points between them where triangles are larger. Const.
struct ContactPoints {
  Interpolation binding;
  std::vector<Vec3> normals;  ///< N, unit
  std::vector<double> areas;  ///< m²; their sum is the area of the surface
  /// m, kept between a point and an obstacle; empty: 0. Bodies without a surface touch with their phyxels, which are
  /// balls
  std::vector<double> radii;
  std::vector<double> spacings = {};  ///< m, of the cells that carry a point; empty: all are ContactPenalty::spacing

  [[nodiscard]] std::size_t count() const { return binding.count(); }
};

/// @param spacing  of the phyxels, m: one point of every cube of half of it that the surface passes, so three or four
///                 per phyxel of the skin; more make contact slower, not better, because a cell's faces have no other
///                 shapes
[[nodiscard]] SurfacePoints chooseContactPoints(const Surface &surface, double spacing);
/// The same for a body of several connected pieces. A piece so small that fewer than kLeastOfPiece of these points lie
/// on it gets closer ones, down to a sixteenth of the spacing: what is held up by a single point turns about it and
/// leaves through the floor.
/// @param pieceOf  [vertices] of the surface: the number of the piece that carries it
[[nodiscard]] SurfacePoints chooseContactPoints(const Surface &surface, double spacing, std::span<const Index> pieceOf);
inline constexpr std::size_t kLeastOfPiece = 12;
/// Chosen points as `binding` carries them. The spacing of a point is that of its phyxels, in halvings of the body's.
/// @param phyxels  m, at rest
/// @param spacing  m, of the body
[[nodiscard]] ContactPoints carriedContact(SurfacePoints chosen, Interpolation binding, std::span<const Vec3> phyxels,
                                           double spacing);

/// One side that a point may not pass within the present step.
struct Contact {
  Index point = 0;
  Vec3 normal = Vec3::UnitZ();          ///< unit, out of the obstacle, at the beginning of the step
  double gap = 0.0;                     ///< m, at the beginning of the step; negative: inside
  double stiffness = 0.0;               ///< N/m, of what resists a negative gap; 0: nothing passes the surface at all
  double thickness = 0.0;               ///< m: so far a gap may be negative where there is a stiffness
  Vec3 surfaceVelocity = Vec3::Zero();  ///< m/s, of the obstacle there
  double friction = 0.0;                ///< Coulomb
  double restitution = 0.0;             ///< 0 … 1: part of the speed of arrival with which a point leaves
  Index obstacle = 0;                   ///< number of the obstacle; kWall for the world box
  double normalImpulse = 0.0;           ///< N s, of the last solution (warm start)
  Vec3 frictionImpulse = Vec3::Zero();  ///< N s, likewise
  double settleImpulse = 0.0;           ///< N s, of the last settling (warm start)
  Vec3 settleFriction = Vec3::Zero();   ///< N s, likewise
  // Of implicit and static solutions:
  double normalForce = 0.0;  ///< N, of the last solution
  /// m, penetration that it began with and that is not pushed back at once
  double initialPenetration = 0.0;
  /// m, elastic tangential way at the beginning of the stage: what friction holds
  Vec3 tangentialDisplacement = Vec3::Zero();
  Vec3 place = Vec3::Zero();  ///< m, world, of the point at the beginning of the step: where `gap` was measured
  static constexpr Index kWall = 0xffffffffu;
};

/// What an obstacle has done to a body, over some time.
struct ContactSum {
  Vec3 impulse = Vec3::Zero();  ///< N s, on the body
  double pressing = 0.0;        ///< N s, of the normal forces alone, without direction
};

/// Sums over a step, by obstacle. Static solutions count by load factor in place of time.
struct ContactSums {
  std::vector<ContactSum> of;  ///< [obstacles + 1], the walls last; empty: no step since contact was looked for anew
  double span = 0.0;           ///< s, of what has been added

  void begin(std::size_t obstacles) {
    of.assign(obstacles + 1, ContactSum());
    span = 0.0;
  }
  /// @param obstacle  Contact::obstacle
  [[nodiscard]] ContactSum &at(Index obstacle) { return of[obstacle == Contact::kWall ? of.size() - 1 : obstacle]; }
};

/// What contact remembers of one body between steps.
struct ContactState {
  /// An obstacle of this number has gone, and those behind it have moved up.
  void forget(Index obstacle);

  /// What is known of a point and an obstacle, in the frame of the obstacle at rest. While the point stays within what
  /// is known nobody is asked: free flight and rest are cheap, and the obstacle's own motion counts like the point's.
  struct ClearanceCache {
    Vec3 at = Vec3::Zero();  ///< m, where it was asked
    double distance = 0.0;   ///< m, of the surface; +inf: more than reach
    double reach = -1.0;     ///< m; negative: never asked
    Vec3 normal = Vec3::Zero();
    double swept = 0.0;  ///< m: as far ahead it was looked for other sides
    bool ahead = false;  ///< there is one:
    Vec3 aheadNormal = Vec3::Zero();
    double aheadOffset = 0.0;  ///< m, aheadNormal · x on it
  };
  std::vector<std::vector<ClearanceCache>> clearance;  ///< [obstacles][points]
  /// The last place of a point on the right side of an obstacle. A point that has come to the other side, even of a
  /// sheet without inside, is known by the crossing on the way from there.
  struct Side {
    Vec3 place = Vec3::Zero();  ///< m, in the frame of the obstacle at rest
    bool known = false;
  };
  std::vector<std::vector<Side>> sides;  ///< [obstacles][points]
  std::vector<Contact> active;           ///< of the present step: by point, then obstacle
  /// m, deepest penetration of a point at the beginning of a step since the start
  double deepest = 0.0;
  double margin = 0.0;      ///< m, of the last findContacts()
  double lookedAt = 0.0;    ///< s, or load factor: time of the last findContacts()
  ContactSums sums;         ///< of the last step
  ContactSums stageForces;  ///< N in place of N s: of the last stage of an implicit or static step
  // scratch, so that a step allocates nothing
  struct ClosestPointQueries {
    std::vector<Index> points, candidates;
    std::vector<Vec3> positions, ways;
    std::vector<double> ranges;
    std::vector<SurfacePoint> answers;
  } questions;
  std::vector<Contact> previous;
  /// Points that are near each other are looked at together, and not before the phyxels that carry them, or an
  /// obstacle, can have come as near as the nearest of them was away.
  struct Blocks {
    /// [points], [blocks] m: until the way of the block is so long they meet nothing
    std::vector<double> limits, blockLimits;
    std::vector<double> ways;  ///< [blocks] m, the farthest that a point can have gone since the first search
    /// [blocks] of ways times maxInfluence to the way of a point: the largest Σ |φ|/maxInfluence
    std::vector<double> gains;
    std::vector<float> maxInfluence;  ///< [phyxels][3], or empty
    Csr chunks;                       ///< [blocks] chunks of phyxels that carry them
    std::vector<double> went, goes;   ///< [chunks] m: the farthest a phyxel has gone since the last search, and will go
    double margin = 0.0;
    WorldBox box;
    std::vector<Vec3> before;                 ///< [phyxels] m, displacements at the last search
    std::vector<RigidMotion> motions;         ///< [obstacles] at the last search; only of those that move
    double size = 0.0;                        ///< m, of the points at rest around the first
    Csr points;                               ///< [blocks]
    std::vector<Index> nearBlocks;            ///< that hold such
    std::vector<std::uint64_t> near;          ///< a bit of each point: looked at
    std::vector<Index> looked;                ///< points that were looked at last, ascending
    std::vector<Vec3> positions, velocities;  ///< [points]
  } blocks;
  Vec3 ledOut = Vec3::Zero();  ///< kg m, Σ mass · way by which points were led out since the energy was looked at
  struct Solution {
    std::vector<double> inverseMasses;  ///< [contacts] 1/kg
    /// [contacts] m/s per N s, by which the least normal velocity falls as the impulse grows; m/s, where it ends
    std::vector<double> compliances, floors;
    std::vector<double> impulses, least, friction;
    std::vector<Index> pressing;  ///< contacts that press after a sweep over all
    std::vector<Vec3> tangential;
    std::vector<Vec3> change;        ///< [slots] m/s
    std::vector<Vec3> arrivals;      ///< [contacts that arrive] m/s, relative to the surface
    std::vector<Vec3> splitImpulse;  ///< [phyxels] m/s, taken back from `touched` when the step settles; empty: none
    // The contacts over the phyxels that they touch, side by side in memory (kernels/contact_kernel.h):
    std::vector<Index> rows, slots;      ///< [contacts + 1], [entries]
    std::vector<double> shares, pushes;  ///< [entries] φ, φ/m
    std::vector<Index> touched, slotOf;  ///< [slots] phyxel, [phyxels] slot
    std::vector<double> velocities;      ///< [slots][4] m/s
    std::vector<double> sides;           ///< [contacts][16]: normal, velocity of the surface, tangential impulse, 1/w
    // Rigid bodies that a contact moves (rigid_particles.h): rows of parts, first of the slots, numbers of each part
    std::vector<Index> rigidRows, rigidSlots;
    std::vector<double> rigidParts;
  } solution;
};

/// Finds the contacts that a step of dt can meet, from the points' world positions and velocities at its beginning.
/// Fills memory.active, keeping what contacts that go on remember.
///
/// A point within the margin of a surface has the plane of its closest point. The way of a moving point is followed
/// besides (segment crossing): what it meets counts with its plane there, and what it passes by does not, however near.
/// From the last place on the right side a crossing also tells that a point has come through, and where.
///
/// @param obstacles  queries in the obstacle's own rest frame; motion gives where it is (Obstacle::motion)
/// @param time       s, at the beginning of the step
/// @param margin     m: contacts closer than this count as active even when nothing moves
/// @param radii      [points] m, taken from the gaps; empty: 0
void findContacts(std::span<const Obstacle> obstacles, const WorldBox &box, double time, double dt, double margin,
                  std::span<const Vec3> positions, std::span<const Vec3> velocities, std::span<const double> radii,
                  ContactState &memory, const ParallelFor &parallelFor);

/// Points of a body as its phyxels carry them now.
struct CarriedPoints {
  const ContactPoints &points;
  Vec3 origin = Vec3::Zero();                       ///< world, m, of the frame of the phyxels
  std::span<const Vec3> displacements, velocities;  ///< [phyxels] m, m/s
  std::span<const float> maxInfluence = {};         ///< [phyxels] at least the largest |φ| of each; empty: 1
};

/// The same contacts, without looking at points that cannot meet anything: blocks of points wait until the body and the
/// obstacles have gone as far as the nearest of them was away. A body in free flight costs one look at its phyxels.
void findContacts(std::span<const Obstacle> obstacles, const WorldBox &box, double time, double dt, double margin,
                  const CarriedPoints &body, ContactState &memory, const ParallelFor &parallelFor);

/// Largest speed at which a point and an obstacle of memory.active approach each other, m/s: what an impact can change
/// within a step, and the step has to be as short as that needs.
/// @param velocities  [phyxels] m/s
[[nodiscard]] double closingSpeed(const ContactState &memory, const Interpolation &binding,
                                  std::span<const Vec3> velocities);

struct ImpulseSettings {
  int sweeps = 20;             ///< of projected Gauss-Seidel; ends earlier when nothing changes by more than tolerance
  double tolerance = 5e-3;     ///< of the largest normal speed
  double leastSpeed = 0.0;     ///< m/s: nothing changes where it changes by less
  double splitImpulse = 0.2;   ///< part of a penetration undone per step
  double recoverySpeed = 0.1;  ///< m/s, most for it: a body that starts inside is led out, not thrown
};

/// Impulses between the points and the obstacles so that no active contact closes beyond its gap within dt, with
/// Coulomb friction, on the velocities of the phyxels: projected Gauss-Seidel over memory.active in its order, warm
/// started as far as that lowers the energy. v_p = Σ φ v_j, an impulse p acts as φ_j p / m_j. A hand on the phyxels,
/// not on the points: force and torque are those of the contact. Serial, the same bits always.
///
/// Penetrations are undone by a velocity that counts for the drift alone: settleContactVelocities() takes it back.
///
/// @param inverseMasses  [phyxels] 1/kg; 0 for held ones
/// @return total impulse on the body, N s (for reports; without that of the split impulses)
/// @source  Jean, The non-smooth contact dynamics method, CMAME 177, 1999 (impulses, Gauss-Seidel); Cline and Pai,
///          Post-stabilization for rigid body simulation with contact and constraints, ICRA 2003 (positions apart from
///          velocities)
Vec3 solveContactImpulses(const Interpolation &binding, std::span<const double> inverseMasses, double dt,
                          const ImpulseSettings &settings, ContactState &memory, std::span<Vec3> velocities);

/// After the second half of a step: takes from the velocities what led points out of penetrations, and what points into
/// the surfaces of contacts that are closed, with friction, so that a resting body has no velocity. Never adds kinetic
/// energy (relative to the obstacles) and never pulls.
void settleContactVelocities(const Interpolation &binding, std::span<const double> inverseMasses, double dt,
                             ContactState &memory, std::span<Vec3> velocities);

/// Adds the impulses of an explicit substep that is over, and its length dt, to memory.sums (without those that lead
/// out of penetrations, which the step takes back). Nothing where ContactSums::begin() has not been called.
void sumContactImpulses(double dt, ContactState &memory);

/// Contact as an energy, for implicit and quasi-static steps, over the planes of memory.active, moved by
/// surfaceVelocity · h; `start` and `now` are displacements of the phyxels at the beginning of the stage and at
/// present:
///
///     U = Σ_p  k_p/2 min(0, g_p)²  +  (|s_p| <= r_p ? k_p/2 |s_p|² : μ N_p (|s_p| - r_p/2)),   k_p = k A_p / d_p
///
/// g gap (with what the contact began with, Contact::initialPenetration), s = Contact::tangentialDisplacement + what
/// came since, N the normal force of the last solution (lagged), r = μ N / k_p. Friction is a spring until it slides,
/// so what holds does not creep.
struct ContactPenalty {
  double stiffness = 0.0;          ///< k over E
  std::span<const double> moduli;  ///< [points] E, Pa, of the material that touches; empty: Contact::stiffness is k_p
  double spacing = 0.0;            ///< d, m, where ContactPoints::spacings does not say
  double h = 0.0;                  ///< s, of the stage; quasi-static: of the load factor
};
[[nodiscard]] double contactEnergy(const ContactPoints &points, const ContactState &memory,
                                   const ContactPenalty &penalty, std::span<const Vec3> start,
                                   std::span<const Vec3> now);
/// Adds forces (minus the gradient) to the phyxels.
void addContactForces(const ContactPoints &points, const ContactState &memory, const ContactPenalty &penalty,
                      std::span<const Vec3> start, std::span<const Vec3> now, std::span<Vec3> forces);
/// Adds Hessian · du (positive semi-definite).
void addContactProduct(const ContactPoints &points, const ContactState &memory, const ContactPenalty &penalty,
                       std::span<const Vec3> start, std::span<const Vec3> now, std::span<const Vec3> du,
                       std::span<Vec3> out);
/// Adds the Hessian's diagonal blocks; and all of it as triplets.
void addContactBlocks(const ContactPoints &points, const ContactState &memory, const ContactPenalty &penalty,
                      std::span<const Vec3> start, std::span<const Vec3> now, std::span<Mat3> blocks);
void addContactTriplets(const ContactPoints &points, const ContactState &memory, const ContactPenalty &penalty,
                        std::span<const Vec3> start, std::span<const Vec3> now,
                        std::vector<Eigen::Triplet<double>> &out);
/// What one contact does at `now`: the force along its normal, N, and that of friction.
struct ContactPull {
  double normal = 0.0;
  Vec3 friction = Vec3::Zero();
};
[[nodiscard]] ContactPull contactPull(const ContactPoints &points, const Contact &contact,
                                      const ContactPenalty &penalty, std::span<const Vec3> start,
                                      std::span<const Vec3> now);
/// What contact does at every point of a skin, to be compared.
class ContactForces {
 public:
  /// Remembers the forces on the points, N, as they are now.
  void record(const ContactPoints &points, const ContactPenalty &penalty, std::span<const Vec3> start,
              std::span<const Vec3> now, const ContactState &memory);
  /// Σ_p |change of the force on p since record()| over Σ_p of all that presses now; 0 where nothing presses and
  /// nothing did.
  [[nodiscard]] double changeTo(const ContactPoints &points, const ContactPenalty &penalty, std::span<const Vec3> start,
                                std::span<const Vec3> now, const ContactState &memory);

 private:
  std::vector<Vec3> then_, now_;  // [points] N
};
/// Stores the normal forces of the present state in the contacts: what friction of the next solution uses.
void updateNormalForces(const ContactPoints &points, const ContactPenalty &penalty, std::span<const Vec3> start,
                        std::span<const Vec3> now, ContactState &memory);
/// Fills memory.stageForces with the forces at `now`.
void sumContactForces(const ContactPoints &points, const ContactPenalty &penalty, std::span<const Vec3> start,
                      std::span<const Vec3> now, ContactState &memory);
/// Adds memory.stageForces for `span` s (or load factor) to memory.sums. Nothing where ContactSums::begin() has not
/// been called.
void addStageForces(double span, ContactState &memory);
/// Once, at the end of a stage: what friction has stored and what is left of allowances goes to the next one.
void finishContactStage(const ContactPoints &points, const ContactPenalty &penalty, std::span<const Vec3> start,
                        std::span<const Vec3> now, ContactState &memory);

}  // namespace pointbased
