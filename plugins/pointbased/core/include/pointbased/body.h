// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "pointbased/contact.h"
#include "pointbased/elastic_foundation.h"
#include "pointbased/engine.h"
#include "pointbased/live_support.h"
#include "pointbased/patch_solver.h"
#include "pointbased/rest_state.h"

namespace pointbased {

namespace detail {
class RigidFrame;
class VectorForces;
}  // namespace detail

/// State variables.
struct State {
  std::vector<Vec3> displacements;  ///< [phyxels] u, m
  std::vector<Vec3> velocities;     ///< [phyxels] m/s
  PointHistory history;             ///< [points] plastic and viscous memory
  /// s, or load factor: time of the last support positions; nothing: none yet
  std::optional<double> supportTime = std::nullopt;
};

/// Rigid motion that a support prescribes for material points of a body.
struct SupportedMotion {
  RigidMotion motion;            ///< in the frame of the phyxels
  Vec3 velocity = Vec3::Zero();  ///< m/s, of the requested point
};

/// What a support exerts on the body.
struct Reaction {
  Vec3 force = Vec3::Zero();   ///< N
  Vec3 torque = Vec3::Zero();  ///< N m, about `centre`
  Vec3 centre = Vec3::Zero();  ///< world, m
};

/// Damped springs between some phyxels and a target that the user moves: a pinch, a clamp.
struct Grab {
  std::vector<Index> phyxels;
  std::vector<double> weights;  ///< sum 1; the grabbed point is Σ w x
  Vec3 target = Vec3::Zero();   ///< world, m
  /// [phyxels] m, position of each relative to the target, before `rotation`. Every phyxel then has its own spring,
  /// with a stiffness proportional to its weight, and the grabbed part keeps its shape. The stiffnesses sum to
  /// heldMass() × frequency². Empty: one spring, on the grabbed point.
  std::vector<Vec3> arms;
  Mat3 rotation = Mat3::Identity();
  double frequency = 50.0;  ///< rad/s of the mass it holds; reduced where the step would not be stable with it
  double dampingRatio = 1.0;
  /// N; limits the force so that a tool that is pulled away does not tear the body
  double maxForce = std::numeric_limits<double>::infinity();
};

/// kg that the springs of a grab with `arms` hold: the mean of the masses over the largest weight. Depends little on how
/// mass is lumped, unlike the single masses. The grab must have phyxels.
/// @param masses  [phyxels] kg
[[nodiscard]] double heldMass(const Grab &grab, std::span<const double> masses);

struct GrabStatus {
  Vec3 point = Vec3::Zero();   ///< world, m, where the grabbed point is
  Vec3 force = Vec3::Zero();   ///< N
  Vec3 torque = Vec3::Zero();  ///< N m, about `point`
  double mass = 0.0;           ///< kg that it holds
};

/// One of the grabs on a body.
struct ActiveGrab {
  std::uint64_t id = 0;  ///< unique within the body
  Grab grab;
  GrabStatus status;  ///< of the last evaluation
};

/// A defect of a state from which the body cannot continue.
struct GuardFinding {
  Index phyxel = 0;
  std::string quantity;  ///< its name and value
  std::string help;      ///< the setting that would help
};

/// Everything of a body that steps change, stored so that the simulation can continue from there.
struct BodyCheckpoint {
  std::shared_ptr<const RestState> rest;
  State state;
  ContactState contact;
  std::optional<GuardFinding> stopped;
  std::size_t rereferenceCount = 0;
  Vec3 referenceShiftMoment = Vec3::Zero();  ///< kg m
  bool rigid = false, free = false;
};

/// A deformable body: rest state, constitution, state, and the scratch storage of its step.
class Body {
 public:
  Body(std::string name, std::shared_ptr<const RestState> rest, Constitution constitution,
       const ParallelFor &parallelFor);
  ~Body();
  Body(Body &&) noexcept;
  Body &operator=(Body &&) noexcept;

  [[nodiscard]] const std::string &name() const { return name_; }
  [[nodiscard]] const RestState &rest() const { return *rest_; }
  [[nodiscard]] const std::shared_ptr<const RestState> &sharedRest() const { return rest_; }
  [[nodiscard]] const Constitution &constitution() const { return constitution_; }
  [[nodiscard]] const Material &material() const { return constitution_.materials.front(); }
  [[nodiscard]] const State &state() const { return state_; }
  [[nodiscard]] State &state() { return state_; }
  /// Inertia, kg, including what scaleMasses() adds.
  [[nodiscard]] std::span<const double> masses() const { return masses_; }
  /// Same without the added mass, kg.
  [[nodiscard]] std::span<const double> restMasses() const { return restMasses_.empty() ? masses_ : restMasses_; }
  /// Mass that scaleMasses() has added to phyxels that are not held, kg, and their number.
  [[nodiscard]] std::pair<double, std::size_t> addedMass() const;
  /// Mass around a phyxel that moves with a support and takes no part in the motion of the others, kg; empty: none.
  [[nodiscard]] std::span<const double> supportMasses() const { return supportMasses_; }
  /// kg: the gravity force is weights()[i] g. For a free body these are its masses, so that it falls without strain.
  /// For a held body they are ρ ∫N_j, the consistent load for statics.
  [[nodiscard]] std::span<const double> weights() const { return weights_.empty() ? masses_ : weights_; }
  /// weights / masses; empty: ones.
  [[nodiscard]] std::span<const double> gravityShares() const { return gravityShares_; }
  /// Reciprocal masses, 1/kg; 0 for held phyxels.
  [[nodiscard]] std::span<const double> inverseMasses() const { return inverseMasses_; }
  /// F of the evaluation points at the last evaluation; the identity before the first. After evaluate() they are
  /// computed on demand by the calling thread: call once before a parallel loop.
  [[nodiscard]] std::span<const Mat3> gradients() const;
  /// v P of the evaluation points; same remarks as for gradients().
  [[nodiscard]] std::span<const Mat3> stresses() const;
  /// Internal forces, loads and foundation forces of the last evaluation, N; without gravity, supports and contact.
  [[nodiscard]] std::span<const Vec3> forces() const { return forces_; }
  [[nodiscard]] std::span<Vec3> forces() { return forces_; }

  /// Takes effect with the next force evaluation; the stable step is computed again. History that the new materials do
  /// not need is dropped; history that they newly need starts fresh.
  void setConstitution(Constitution constitution, const ParallelFor &parallelFor);

  /// Mass scaling: phyxels of the few small or stiff cells that limit the explicit step get more inertia. Mass is added
  /// until the stable step at rest is `step`, or until a twentieth of the mass of the movable part has been added.
  /// Weights are unchanged, so that equilibrium is not affected. Bodies without supports, and those whose step would
  /// become less than half as long again, are not changed. Persists across setConstitution().
  /// @param step  s; 0: no added mass
  /// @source  Belytschko, Liu, Moran, Elkhodary, Nonlinear Finite Elements for Continua and Structures, 2014, ch. 6
  void scaleMasses(double step, const ParallelFor &parallelFor);

  /// Initial velocities, m/s and rad/s about the centre of mass: part of the initial state.
  void setInitialVelocity(const Vec3 &velocity, const Vec3 &angularVelocity);

  /// Largest explicit step at rest without margin, s; infinite for a body without internal forces.
  [[nodiscard]] double stableStepAtRest() const { return stableStepFor(1.0); }
  /// The same at the present deformation, from the tangent moduli of the last force evaluation.
  [[nodiscard]] double stableStep() const { return stableStepFor(tangentRatio_); }
  [[nodiscard]] double restFrequency() const { return restFrequency_; }

  /// Precision of the force kernels; takes effect with the next evaluation. Materials that flow or relax are always
  /// computed in double precision.
  void setPrecision(Precision precision);
  [[nodiscard]] Precision precision() const { return precision_; }
  /// Whether evaluate() and elasticEnergy() run vector kernels: not on a renewed reference, nor for clouds that flow or
  /// relax.
  [[nodiscard]] bool vectorised() const { return vectorForces_ != nullptr; }
  /// Whether evaluateInternal(), linearise() and forceDifferential() are available: not for materials that flow or
  /// relax.
  [[nodiscard]] bool vectorisedTangent() const { return vectorised() && !constitution_.hasHistory(); }

  /// Computes forces() and tangentRatio() of the present state, with loads at time (or load factor) t: all that an
  /// explicit step needs. Fused if the body is vectorised(); otherwise by the stages below, with plastic flow and Prony
  /// terms over dt.
  void evaluate(double t, double dt, const ParallelFor &parallelFor);
  /// For a body with vectorisedTangent(), in double precision whatever precision() is: forces() without loads (and
  /// optionally without viscous forces); the tangent there; and its products df = -K du, including viscous forces of
  /// velocities viscousScale du.
  void evaluateInternal(bool viscous, const ParallelFor &parallelFor);
  /// Call after displacements have been changed from outside: invalidates stored values at the evaluation points.
  void invalidatePointValues() { gradientsStale_ = stressesStale_ = vectorised(); }
  void linearise(const ParallelFor &parallelFor);
  void forceDifferential(std::span<const Vec3> du, double viscousScale, std::span<Vec3> df,
                         const ParallelFor &parallelFor);

  /// Stages of a force evaluation at the present state, in order.
  void computeGradients(const ParallelFor &parallelFor);
  /// @return  number of points that flowed during dt
  std::size_t computeFlow(double dt, const ParallelFor &parallelFor);
  /// @param dt  s: Prony terms advance by it; 0: they do not change
  void computeStresses(double dt, const ParallelFor &parallelFor);
  /// Same as computeStresses(), but the memory of the Prony terms does not advance.
  void computeTrialStresses(double dt, const ParallelFor &parallelFor);
  /// Stresses of the elastic and plastic part only.
  void computeElasticStresses(const ParallelFor &parallelFor);
  /// Internal forces, foundation forces, and loads at time (or load factor) t.
  void computeForces(double t, const ParallelFor &parallelFor);
  void computeInternalForces(const ParallelFor &parallelFor);

  /// Load factor of a fix or load with a ramp at time t; `t` itself in a quasi-static solution.
  bool quasiStatic = false;
  [[nodiscard]] double factor(double ramp, double t) const;

  /// Moves held phyxels to their prescribed positions at time t.
  /// @param rates  also sets their velocities
  void placeHeld(double t, bool rates);
  /// Target displacements of the held patches at time t, in the order of their rows.
  [[nodiscard]] std::span<const Vec3> patchTargets(double t);
  [[nodiscard]] std::span<const Vec3> lastPatchTargets() const { return patchTargets_; }
  [[nodiscard]] PatchSolver &patches() { return patches_; }
  [[nodiscard]] const PatchSolver &patches() const { return patches_; }
  [[nodiscard]] std::span<const std::uint8_t> heldMask() const { return heldMask_; }
  [[nodiscard]] bool held() const { return !heldPhyxels_.empty() || patches_.rows() > 0; }
  /// Motion of the support that holds a material point; empty where the point is free. Everything in the region of a
  /// fix moves with it; phyxels near its boundary also carry free material and may be displaced from it.
  /// @param X  first reference, world, m
  [[nodiscard]] std::optional<SupportedMotion> supportAt(const Vec3 &X) const;
  /// Motion of one fix, in the frame of the phyxels.
  [[nodiscard]] RigidMotion supportMotion(std::size_t fix) const;
  /// By fix: phyxels in its region, or within one spacing of it.
  struct HeldPhyxel {
    Index phyxel;
    Index fix;
  };
  [[nodiscard]] std::span<const HeldPhyxel> phyxelsNearSupports() const { return nearSupports_; }
  /// Moves surfels that are held by supports to their prescribed positions, and rotates their normals.
  /// @param positions  [surfels] m, in the frame of the phyxels
  /// @param normals    [surfels] unit, or empty
  void placeHeldSurfels(std::span<Vec3> positions, std::span<Vec3> normals) const;
  /// @param positions  [surfels] m, world
  void placeHeldSurfels(std::span<Vec3f> positions, std::span<Vec3f> normals) const;

  /// Elastic foundation of the body; takes effect with the next force evaluation.
  /// Errors: settings that validate() refuses; a foundation that acts on a body without a surface or with a renewed
  /// reference.
  [[nodiscard]] Result<void> setFoundation(const Foundation &foundation);
  [[nodiscard]] ElasticFoundation &foundation() { return foundation_; }
  [[nodiscard]] const ElasticFoundation &foundation() const { return foundation_; }
  /// Upper bound of what attachments (attachment.h) to other bodies and obstacles add to the squared frequencies of the
  /// body, 1/s²; 0: no attachments.
  void setAttachedFrequency(double squared) { attachedFrequency_ = squared; }
  [[nodiscard]] bool attached() const { return attachedFrequency_ > 0.0; }
  /// Present force and torque of the foundation, about the centre of the body in the reference.
  [[nodiscard]] Reaction foundationReaction() const;
  /// Supports added while the body is simulated; they are settings, which a reset does not remove. Take effect with the
  /// next step. Ignored while the body is rigid.
  void setLiveSupports(std::vector<LiveSupport> supports);
  [[nodiscard]] std::span<const LiveSupport> liveSupports() const { return liveSupports_; }
  /// Present reactions of the supports, then of liveSupports(): from the forces on held phyxels (internal, loads,
  /// gravity) and from the patches.
  [[nodiscard]] std::vector<Reaction> reactions(const Vec3 &gravity) const;

  /// Computed in double precision.
  [[nodiscard]] ElasticEnergy elasticEnergy(std::span<Eigen::Vector2d> perPoint = {}) const;
  [[nodiscard]] ElasticEnergy elasticEnergy(const ParallelFor &parallelFor) const;
  [[nodiscard]] double kineticEnergy() const;
  [[nodiscard]] double totalMass() const;  ///< kg, including mass that supports carry

  /// Young's modulus around the contact points, Pa.
  [[nodiscard]] std::span<const double> contactModuli() const { return contactModuli_; }
  /// Pa, Young's modulus around each point.
  [[nodiscard]] std::vector<double> moduliAt(const Interpolation &points) const;
  /// x and v of the contact points in the world; valid until the next call.
  std::span<const Vec3> contactPositions(const ParallelFor &parallelFor);
  std::span<const Vec3> contactVelocities(const ParallelFor &parallelFor);

  /// Continues from another reference with the same shape, velocities, elastic strain and mass (rereferencing.h). The
  /// stored state becomes the new state; contact is searched again; grabs persist where the phyxels are unchanged.
  void rereference(std::shared_ptr<const RestState> rest, State state, const ParallelFor &parallelFor);
  /// Number of renewed references since the start.
  [[nodiscard]] std::size_t rereferenceCount() const { return rereferenceCount_; }
  /// Σ m (displacement from the first reference to the present one), kg m.
  [[nodiscard]] const Vec3 &referenceShiftMoment() const { return referenceShiftMoment_; }

  /// A rigid body keeps its shape. It is static in its reference, without velocity: no stage runs and nothing moves it.
  /// With `free` it moves as a rigid body with the masses of its phyxels, in explicit steps. The body returns to its
  /// initial state in either case.
  void setRigid(bool rigid, bool free = false);
  [[nodiscard]] bool rigid() const { return rigid_; }
  /// True if it is rigid and moves. False if part of it is held, or in a static solution; it is static then.
  [[nodiscard]] bool isFreeRigid() const { return rigid_ && free_ && !quasiStatic && !held(); }
  /// The `free` argument of setRigid(), whether it is rigid or not.
  [[nodiscard]] bool rigidIsFree() const { return free_; }
  /// True if it is rigid and does not move.
  [[nodiscard]] bool isStatic() const { return rigid_ && !isFreeRigid(); }
  /// Mass and inertia of a rigid body; valid after setRigid().
  [[nodiscard]] const detail::RigidFrame &rigidFrame() const { return *rigidFrame_; }

  /// N per phyxel, from outside of the model, added to those of the scene. Constant over a step and retained until set
  /// again. Quasi-static: multiplied by the load factor.
  /// @param forces  [phyxels], finite; empty: none. Holds the previous forces on return
  void swapExternalForces(std::vector<Vec3> &forces);
  [[nodiscard]] std::span<const Vec3> externalForces() const { return externalForces_; }

  /// Stores the state before a step, in case the step fails.
  void keepState();
  void restoreState();
  [[nodiscard]] const State &savedStateCopy() const { return kept_; }
  /// Returns to the initial state, bit for bit.
  void reset();
  [[nodiscard]] BodyCheckpoint checkpoint() const;
  /// Restores a stored state, with the present material and without grabs. History that the earlier material did not
  /// need starts fresh.
  /// @return  false: nothing is changed, because the body was rigid or free at that time and is not now, or the reverse
  bool restore(const BodyCheckpoint &checkpoint, const ParallelFor &parallelFor);
  /// Values that an explicit step reuses from the previous one. Viscous forces are those of its midpoint and would
  /// differ if evaluated again.
  struct IntegratorState {
    std::vector<Vec3> forces;  ///< [phyxels] N
    double tangentRatio = 1.0;
    bool forcesCurrent = false;
  };
  [[nodiscard]] IntegratorState integratorCarry() const { return {forces_, tangentRatio_, forcesCurrent}; }
  void restoreIntegratorState(IntegratorState integratorCarry) {
    forces_ = std::move(integratorCarry.forces);
    tangentRatio_ = integratorCarry.tangentRatio;
    forcesCurrent = integratorCarry.forcesCurrent;
  }

  /// Why the body is stopped in its last valid state while the simulation continues; empty: it is not stopped.
  std::optional<GuardFinding> stopped;
  /// Same as text, with names and a remedy; empty: it is not stopped.
  [[nodiscard]] std::string stopMessage() const;
  std::vector<ActiveGrab> grabs;
  ContactState contact;
  bool forcesCurrent = false;

 private:
  struct HeldSurfel {
    Index surfel, fix;
  };
  void resizeForRestState();
  void addPatchesOf(const ConstrainedRegion &part, Index fix);
  void shareGravity();
  void findHeldSurfels();
  void bindFoundation();
  void frameRigid();
  [[nodiscard]] Vec3 firstReference(Index phyxel) const;
  [[nodiscard]] double stableStepFor(double tangentRatio) const;
  void addMasses(const ParallelFor &parallelFor);
  void updateMassDependents();
  void vectorise(const ParallelFor &parallelFor);
  [[nodiscard]] double frequencyAtRest(const ParallelFor &parallelFor) const;
  void makePoints() const;
  [[nodiscard]] detail::VectorForces &doublePrecisionForces() const;
  void addLoads(double t, const ParallelFor &parallelFor);
  void stressesInto(double dt, const PointHistory &before, PointHistory *after, bool viscous,
                    const ParallelFor &parallelFor);

  std::string name_;
  std::shared_ptr<const RestState> rest_, first_;
  std::size_t rereferenceCount_ = 0;
  Vec3 referenceShiftMoment_ = Vec3::Zero();
  Constitution constitution_;
  State state_, kept_;
  PointHistory trial_;
  Vec3 initialVelocity_ = Vec3::Zero(), initialAngularVelocity_ = Vec3::Zero();
  std::vector<double> masses_, inverseMasses_, supportMasses_;
  std::vector<double> restMasses_;  // empty: no mass is added
  double scaledStep_ = 0.0;         // s, of scaleMasses()
  std::vector<double> weights_, supportWeights_, gravityShares_;
  std::vector<double> contactModuli_;
  std::vector<Index> carrier_;  // fix that carries the phyxel
  std::vector<HeldPhyxel> heldPhyxels_, nearSupports_;
  std::vector<HeldSurfel> heldSurfels_;
  std::vector<std::uint8_t> heldMask_;
  PatchSolver patches_;
  ElasticFoundation foundation_;
  double foundationFrequency_ = 0.0;  // rad/s, a bound
  double attachedFrequency_ = 0.0;    // 1/s², a bound
  bool rigid_ = false, free_ = false;
  std::unique_ptr<const detail::RigidFrame> rigidFrame_;  // of a rigid body
  std::vector<LiveSupport> liveSupports_;
  std::vector<Index> fixOfPatch_;  // fixes of the rest state, then liveSupports_
  std::vector<Vec3> patchPoints_, patchShifts_, patchTargets_;
  std::vector<Vec3> externalForces_;  // empty: none
  std::vector<Vec3> forces_, entryForces_, contactPositions_, contactVelocities_;
  // At the points; out of date after evaluate() by vector kernels until requested; empty until they are needed.
  mutable std::vector<Mat3> gradients_, stresses_;
  mutable std::vector<double> tangentRatios_;
  mutable bool gradientsStale_ = false, stressesStale_ = false;
  std::vector<Mat3> rates_;
  std::unique_ptr<detail::VectorForces> vectorForces_;
  // of a body in single precision, created on demand
  mutable std::unique_ptr<detail::VectorForces> doublePrecisionForces_;
  Precision precision_ = Precision::doublePrecision;
  std::vector<HourglassStrain> relaxedModes_;  // of the last stress evaluation; empty: none
  double tangentRatio_ = 1.0;
  double restFrequency_ = 0.0;  // rad/s
};

}  // namespace pointbased
