// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/SparseCore>

#include "pointbased/interpolation.h"
#include "pointbased/obstacle.h"
#include "pointbased/supports.h"
#include "pointbased/surface.h"
#include "pointbased/types.h"

namespace pointbased {

/// Contact points of a body's skin: the vertices of its surface, thinned where they are much denser than the phyxels,
/// with additional points in larger triangles. Const.
struct ContactPoints {
  Interpolation binding;
  std::vector<Vec3> normals;  ///< N, unit
  std::vector<double> areas;  ///< m²; their sum is the area of the surface
  /// m, kept as distance between a point and an obstacle; empty: 0. Bodies without a surface collide with their
  /// phyxels, which are balls
  std::vector<double> radii;
  std::vector<double> spacings = {};  ///< m, of the cells that carry a point; empty: ContactPenalty::spacing for all

  [[nodiscard]] std::size_t count() const { return binding.count(); }
};

/// @param spacing  of the phyxels, m. One point is chosen in every cube of half this size that the surface crosses:
///                 three or four per phyxel of the skin. More points make contact slower, not better, because the faces
///                 of a cell have no other shapes
[[nodiscard]] SurfacePoints chooseContactPoints(const Surface &surface, double spacing);
/// Same for a body of several connected pieces. A small piece with fewer than kMinPointsPerPiece of these points gets
/// closer ones, down to a sixteenth of the spacing: a piece supported by a single point would rotate about it and pass
/// through the floor.
/// @param pieceOf  [vertices] of the surface: number of the piece that carries the vertex
[[nodiscard]] SurfacePoints chooseContactPoints(const Surface &surface, double spacing, std::span<const Index> pieceOf);
inline constexpr std::size_t kMinPointsPerPiece = 12;
/// Chosen points with their `binding`. The spacing of a point is that of its phyxels, as the body's spacing halved zero
/// or more times.
/// @param phyxels  m, at rest
/// @param spacing  m, of the body
[[nodiscard]] ContactPoints bindContactPoints(SurfacePoints chosen, Interpolation binding,
                                              std::span<const Vec3> phyxels, double spacing);

/// Plane that a point must not pass within the present step.
struct Contact {
  Index point = 0;
  Vec3 normal = Vec3::UnitZ();             ///< unit, out of the obstacle, at the beginning of the step
  double gap = 0.0;                        ///< m, at the beginning of the step; negative: inside
  double stiffness = 0.0;                  ///< N/m, against a negative gap; 0: impenetrable
  double thickness = 0.0;                  ///< m: permitted depth of a negative gap if there is a stiffness
  Vec3 surfaceVelocity = Vec3::Zero();     ///< m/s, of the obstacle there
  double friction = 0.0;                   ///< Coulomb
  double restitution = 0.0;                ///< 0 … 1: rebound speed over arrival speed
  Index obstacle = 0;                      ///< number of the obstacle; kWall for the world box
  double normalImpulse = 0.0;              ///< N s, of the last solution (warm start)
  Vec3 frictionImpulse = Vec3::Zero();     ///< N s, of the last solution (warm start)
  double projectionImpulse = 0.0;          ///< N s, of the last velocity projection (warm start)
  Vec3 projectionFriction = Vec3::Zero();  ///< N s, of the last velocity projection (warm start)
  // For implicit and static solutions:
  double normalForce = 0.0;  ///< N, of the last solution
  /// m, penetration at which the contact began; it is not pushed back at once
  double initialPenetration = 0.0;
  /// m, elastic tangential displacement at the beginning of the stage, which friction holds
  Vec3 tangentialDisplacement = Vec3::Zero();
  Vec3 position = Vec3::Zero();  ///< m, world, of the point at the beginning of the step: where `gap` was measured
  static constexpr Index kWall = 0xffffffffu;
};

/// Accumulated action of an obstacle on a body.
struct ContactSum {
  Vec3 impulse = Vec3::Zero();    ///< N s, on the body
  double normalImpulseSum = 0.0;  ///< N s, sum of the normal impulses, without direction
};

/// Sums over a step, by obstacle. Static solutions use the load factor in place of time.
struct ContactSums {
  std::vector<ContactSum> of;  ///< [obstacles + 1], the walls last; empty: no step since contact was reset
  double duration = 0.0;       ///< s

  void begin(std::size_t obstacles) {
    of.assign(obstacles + 1, ContactSum());
    duration = 0.0;
  }
  /// @param obstacle  Contact::obstacle
  [[nodiscard]] ContactSum &at(Index obstacle) { return of[obstacle == Contact::kWall ? of.size() - 1 : obstacle]; }
};

/// Contact state of one body that persists between steps.
struct ContactState {
  /// Removes the obstacle with this number; the numbers of later obstacles decrease by one.
  void removeObstacle(Index obstacle);

  /// Clearance of a point from an obstacle, in the obstacle's rest frame. The obstacle is queried again when the
  /// relative travel of point and obstacle exceeds the clearance.
  struct ClearanceCache {
    Vec3 at = Vec3::Zero();  ///< m, query position
    double distance = 0.0;   ///< m, to the surface; +inf: more than reach
    double reach = -1.0;     ///< m; negative: never queried
    Vec3 normal = Vec3::Zero();
    double swept = 0.0;  ///< m: distance ahead that was searched for other faces
    bool ahead = false;  ///< another face was found ahead:
    Vec3 aheadNormal = Vec3::Zero();
    double aheadOffset = 0.0;  ///< m, aheadNormal · x on that face
  };
  std::vector<std::vector<ClearanceCache>> clearance;  ///< [obstacles][points]
  /// Last position of a point on the outer side of an obstacle. A point that has passed through, even through a sheet
  /// without an inside, is detected by the crossing on its path from there.
  struct LastOutside {
    Vec3 position = Vec3::Zero();  ///< m, in the frame of the obstacle at rest
    bool isKnown = false;
  };
  std::vector<std::vector<LastOutside>> lastOutside;  ///< [obstacles][points]
  std::vector<Contact> active;                        ///< of the present step, sorted by point, then obstacle
  /// m, largest penetration of a point at the beginning of any step since the start
  double deepest = 0.0;
  double margin = 0.0;         ///< m, of the last findContacts()
  double searchTime = 0.0;     ///< s, or load factor: time of the last findContacts()
  ContactSums sums;            ///< of the last step
  ContactSums stageForceSums;  ///< N in place of N s: of the last stage of an implicit or static step
  // Scratch storage, so that a step does not allocate
  struct ClosestPointQueries {
    std::vector<Index> points, candidates;
    std::vector<Vec3> positions, travels;
    std::vector<double> ranges;
    std::vector<SurfacePoint> answers;
  } queries;
  std::vector<Contact> previous;
  /// Neighbouring contact points are checked in blocks. A block is skipped until the phyxels that carry it, or an
  /// obstacle, can have moved as far as the clearance of its nearest point.
  struct Blocks {
    /// [points], [blocks] m: a point, a block has no contact until the block has moved this far
    std::vector<double> travelLimits, blockTravelLimits;
    std::vector<double> travels;  ///< [blocks] m, upper bound of a point's travel since the first search
    /// [blocks] ratio of a point's travel to chunk travel times maxInfluence: the largest Σ |φ|/maxInfluence
    std::vector<double> gains;
    std::vector<float> maxInfluence;  ///< [phyxels][3], or empty
    Csr chunks;                       ///< [blocks] chunks of phyxels that carry them
    std::vector<double> chunkTravelSince,
        chunkStepTravel;  ///< [chunks] m: largest travel of a phyxel since the last search, and in this step
    double margin = 0.0;
    WorldBox box;
    std::vector<Vec3> displacementsAtSearch;   ///< [phyxels] m, displacements at the last search
    std::vector<RigidMotion> motionsAtSearch;  ///< [obstacles] at the last search; of moving ones only
    double size = 0.0;                         ///< m, radius of all points at rest around the first one
    Csr points;                                ///< [blocks]
    std::vector<Index> checkedBlocks;          ///< blocks with points that are checked
    std::vector<std::uint64_t> checkedBits;    ///< one bit per point: checked
    std::vector<Index> checkedPoints;          ///< points that were checked last, ascending
    std::vector<Vec3> positions, velocities;   ///< [points]
  } blocks;
  /// kg m, Σ mass · displacement of depenetration since the last energy check
  Vec3 depenetrationMoment = Vec3::Zero();
  struct Solution {
    std::vector<double> inverseMasses;  ///< [contacts] 1/kg
    /// [contacts] m/s per N s, decrease of the smallest normal velocity as the impulse grows; m/s, its lower limit
    std::vector<double> compliances, minVelocityLimits;
    std::vector<double> impulses, minVelocities, friction;
    std::vector<Index> subset;  ///< contacts of the next sweep: those that press or nearly do
    std::vector<Vec3> tangential;
    std::vector<Vec3> change;        ///< [slots] m/s
    std::vector<Vec3> arrivals;      ///< [arriving contacts] m/s, relative to the surface
    std::vector<Vec3> splitImpulse;  ///< [phyxels] m/s, subtracted from `touched` at the end of the step; empty: none
    // The contacts over the phyxels that they touch, contiguous in memory (contact/contact_kernel.h):
    std::vector<Index> rows, slots;          ///< [contacts + 1], [entries]
    std::vector<double> weights, responses;  ///< [entries] φ, φ/m
    std::vector<Index> touched, slotOf;      ///< [slots] phyxel, [phyxels] slot
    std::vector<double> velocities;          ///< [slots][4] m/s
    std::vector<double> records;  ///< [contacts][16]: normal, velocity of the surface, tangential impulse, 1/w
    // Rigid bodies that a contact moves (rigid_particles.h): rows of parts, first slots, numbers of each part
    std::vector<Index> rigidRows, rigidSlots;
    std::vector<double> rigidParts;
  } solution;
};

/// Finds contacts that are possible in a step of dt, from the world positions and velocities of the points at its
/// beginning. Fills memory.active; persisting contacts keep their stored state.
///
/// A point within the margin of a surface gets the plane of its closest point. In addition, the path of a moving point
/// is traced (segment crossing). A surface that the path crosses gives a contact with the plane there; one that the
/// path does not cross gives none, however near. A crossing on the path from the last outside position detects that a
/// point has passed through.
///
/// @param obstacles  queries in the rest frame of the obstacle; Obstacle::motion positions it
/// @param time       s, at the beginning of the step
/// @param margin     m: closer contacts are active even without motion
/// @param radii      [points] m, subtracted from the gaps; empty: 0
void findContacts(std::span<const Obstacle> obstacles, const WorldBox &box, double time, double dt, double margin,
                  std::span<const Vec3> positions, std::span<const Vec3> velocities, std::span<const double> radii,
                  ContactState &memory, const ParallelFor &parallelFor);

/// Points of a body as carried by its phyxels at present.
struct CarriedPoints {
  const ContactPoints &points;
  Vec3 origin = Vec3::Zero();                       ///< world, m, of the frame of the phyxels
  std::span<const Vec3> displacements, velocities;  ///< [phyxels] m, m/s
  std::span<const float> maxInfluence = {};         ///< [phyxels] upper bound of |φ| of each; empty: 1
};

/// Same contacts. Blocks of points are skipped until the body and the obstacles have moved as far as the clearance of
/// their nearest point. A body in free flight costs one pass over its phyxels.
void findContacts(std::span<const Obstacle> obstacles, const WorldBox &box, double time, double dt, double margin,
                  const CarriedPoints &body, ContactState &memory, const ParallelFor &parallelFor);

/// Largest approach speed between a point and an obstacle of memory.active, m/s: the change that an impact can cause
/// within a step, to which the step size has to be adapted.
/// @param velocities  [phyxels] m/s
[[nodiscard]] double closingSpeed(const ContactState &memory, const Interpolation &binding,
                                  std::span<const Vec3> velocities);

struct ImpulseSettings {
  int sweeps = 20;             ///< of projected Gauss-Seidel; ends earlier if no change exceeds the tolerance
  double tolerance = 5e-3;     ///< of the largest normal speed
  double leastSpeed = 0.0;     ///< m/s: smaller changes are ignored
  double splitImpulse = 0.2;   ///< fraction of a penetration removed per step
  double recoverySpeed = 0.1;  ///< m/s, limit for that: a body that starts inside is pushed out slowly
};

/// Impulses between the points and the obstacles, with Coulomb friction, such that no active contact closes beyond its
/// gap within dt. They act on the velocities of the phyxels: projected Gauss-Seidel over memory.active in its order,
/// warm started as far as that lowers the energy. v_p = Σ φ v_j; an impulse p acts as φ_j p / m_j. The action is on the
/// phyxels, not on the points, with the force and torque of the contact. Serial, bitwise reproducible.
///
/// Penetrations are removed by a velocity that acts in the drift only: projectContactVelocities() removes it again.
///
/// @param inverseMasses  [phyxels] 1/kg; 0 for those with a prescribed displacement
/// @return  total impulse on the body, N s (for reports; without the split impulses)
/// @source  Jean, The non-smooth contact dynamics method, CMAME 177, 1999 (impulses, Gauss-Seidel); Cline and Pai,
///          Post-stabilization for rigid body simulation with contact and constraints, ICRA 2003 (positions apart from
///          velocities)
Vec3 solveContactImpulses(const Interpolation &binding, std::span<const double> inverseMasses, double dt,
                          const ImpulseSettings &settings, ContactState &memory, std::span<Vec3> velocities);

/// After the second half of a step: removes the velocities that moved points out of penetrations, and the velocities
/// into the surfaces of closed contacts, with friction, so that a resting body has no velocity. Never adds kinetic
/// energy (relative to the obstacles) and never pulls.
void projectContactVelocities(const Interpolation &binding, std::span<const double> inverseMasses, double dt,
                              ContactState &memory, std::span<Vec3> velocities);

/// Adds the impulses of a completed explicit substep and its length dt to memory.sums. Impulses that remove
/// penetrations are not included; the step takes these back. No effect if ContactSums::begin() has not been called.
void sumContactImpulses(double dt, ContactState &memory);

/// Contact as an energy, for implicit and quasi-static steps, over the planes of memory.active, moved by
/// surfaceVelocity · h. `start` and `now` are displacements of the phyxels at the beginning of the stage and at
/// present:
///
///     U = Σ_p  k_p/2 min(0, g_p)²  +  (|s_p| <= r_p ? k_p/2 |s_p|² : μ N_p (|s_p| - r_p/2)),   k_p = k A_p / d_p
///
/// g is the gap (plus the penetration at which the contact began, Contact::initialPenetration), s =
/// Contact::tangentialDisplacement plus the tangential displacement since, N the normal force of the last solution
/// (lagged), and r = μ N / k_p. Friction is a spring until it slides, so sticking contacts do not creep.
struct ContactPenalty {
  double stiffness = 0.0;          ///< k over E
  std::span<const double> moduli;  ///< [points] E, Pa, of the material in contact; empty: Contact::stiffness is k_p
  double spacing = 0.0;            ///< d, m, if ContactPoints::spacings is empty
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
/// Adds the diagonal blocks of the Hessian; the second function adds all of it as triplets.
void addContactBlocks(const ContactPoints &points, const ContactState &memory, const ContactPenalty &penalty,
                      std::span<const Vec3> start, std::span<const Vec3> now, std::span<Mat3> blocks);
void addContactTriplets(const ContactPoints &points, const ContactState &memory, const ContactPenalty &penalty,
                        std::span<const Vec3> start, std::span<const Vec3> now,
                        std::vector<Eigen::Triplet<double>> &out);
/// Force of one contact at `now`: along its normal, N, and the friction force.
struct ContactForce {
  double normal = 0.0;
  Vec3 friction = Vec3::Zero();
};
[[nodiscard]] ContactForce contactForceAt(const ContactPoints &points, const Contact &contact,
                                          const ContactPenalty &penalty, std::span<const Vec3> start,
                                          std::span<const Vec3> now);
/// Contact forces at every point of a skin, for comparison.
class ContactForces {
 public:
  /// Stores the present forces on the points, N.
  void record(const ContactPoints &points, const ContactPenalty &penalty, std::span<const Vec3> start,
              std::span<const Vec3> now, const ContactState &memory);
  /// Σ_p |change of the force on p since record()| over Σ_p of all present contact forces; 0 if there is no contact now
  /// and there was none before.
  [[nodiscard]] double changeTo(const ContactPoints &points, const ContactPenalty &penalty, std::span<const Vec3> start,
                                std::span<const Vec3> now, const ContactState &memory);

 private:
  std::vector<Vec3> recorded_, present_;  // [points] N
};
/// Stores the normal forces of the present state in the contacts; friction of the next solution uses them.
void updateNormalForces(const ContactPoints &points, const ContactPenalty &penalty, std::span<const Vec3> start,
                        std::span<const Vec3> now, ContactState &memory);
/// Fills memory.stageForceSums with the forces at `now`.
void sumContactForces(const ContactPoints &points, const ContactPenalty &penalty, std::span<const Vec3> start,
                      std::span<const Vec3> now, ContactState &memory);
/// Adds memory.stageForceSums for `span` s (or load factor) to memory.sums. No effect if ContactSums::begin() has not
/// been called.
void addStageForces(double span, ContactState &memory);
/// Call once at the end of a stage: transfers stored friction displacements and remaining initial penetrations to the
/// next stage.
void endContactStage(const ContactPoints &points, const ContactPenalty &penalty, std::span<const Vec3> start,
                     std::span<const Vec3> now, ContactState &memory);

}  // namespace pointbased
