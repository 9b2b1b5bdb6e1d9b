// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "pointbased/contact.h"
#include "pointbased/elastic_foundation.h"
#include "pointbased/engine.h"
#include "pointbased/patch_solver.h"
#include "pointbased/rest_state.h"

namespace pointbased {

namespace detail {
class RigidFrame;
class VectorForces;
}  // namespace detail

/// What moves.
struct State {
  std::vector<Vec3> displacements;  ///< [phyxels] u, m
  std::vector<Vec3> velocities;     ///< [phyxels] m/s
  PointHistory history;             ///< [points] plastic and viscous memory
  /// s, or load factor: when supports have put what they hold where it is; nothing: not yet
  std::optional<double> supportTime = std::nullopt;
};

/// What a support leads: material points of a body, rigidly.
struct SupportedMotion {
  RigidMotion motion;            ///< in the frame of the phyxels
  Vec3 velocity = Vec3::Zero();  ///< m/s, of the point that was asked for
};

/// What a support exerts on the body.
struct Reaction {
  Vec3 force = Vec3::Zero();   ///< N
  Vec3 torque = Vec3::Zero();  ///< N m, about `centre`
  Vec3 centre = Vec3::Zero();  ///< world, m
};

/// Damped springs between some phyxels and a place that somebody moves: the pinch, a clamp.
struct Grab {
  std::vector<Index> phyxels;
  std::vector<double> weights;  ///< sum 1; the grabbed point is Σ w x
  Vec3 target = Vec3::Zero();   ///< world, m
  /// [phyxels] m, where each belongs from the target, before `rotation`: every phyxel has a spring of its own, as
  /// strong as its weight beside the largest, and the held part keeps its shape. Empty: one spring, on the grabbed
  /// point.
  std::vector<Vec3> arms;
  Mat3 rotation = Mat3::Identity();
  double frequency = 50.0;  ///< rad/s of the mass it holds; lowered where the step would not carry it
  double dampingRatio = 1.0;
  /// N: a tool that is torn away must not tear the body apart
  double maxForce = std::numeric_limits<double>::infinity();
};

struct GrabStatus {
  Vec3 point = Vec3::Zero();   ///< world, m, where the grabbed point is
  Vec3 force = Vec3::Zero();   ///< N
  Vec3 torque = Vec3::Zero();  ///< N m, about `point`
  double mass = 0.0;           ///< kg that it holds
};

/// One of those who hold a body.
struct Hand {
  std::uint64_t id = 0;  ///< who it is; one body has no two of the same
  Grab grab;
  GrabStatus status;  ///< of the last evaluation
};

/// What is wrong with a state, so that the body does not go on from there.
struct GuardFinding {
  Index phyxel = 0;
  std::string quantity;  ///< what it is, with its value
  std::string help;      ///< the setting that would help
};

/// What steps change of a body, kept so that it can go on from there.
struct BodyCheckpoint {
  std::shared_ptr<const RestState> rest;
  State state;
  ContactState contact;
  std::optional<GuardFinding> stopped;
  std::size_t rereferenceCount = 0;
  Vec3 referenceShiftMoment = Vec3::Zero();  ///< kg m
  bool rigid = false, free = false;
};

/// A deformable body: rest state, constitution, state, and the scratch of its step.
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
  /// Inertia, kg: with what scaleMasses() adds.
  [[nodiscard]] std::span<const double> masses() const { return masses_; }
  /// The same without, kg.
  [[nodiscard]] std::span<const double> restMasses() const { return restMasses_.empty() ? masses_ : restMasses_; }
  /// Of phyxels that are not held: what scaleMasses() has added, kg, and to how many.
  [[nodiscard]] std::pair<double, std::size_t> addedMass() const;
  /// Mass around a phyxel that moves with a support and takes no part in the motion of the others, kg; empty: none.
  [[nodiscard]] std::span<const double> supportMasses() const { return supportMasses_; }
  /// kg: gravity pulls with weights()[i] g. Of a free body its masses, so that it falls without a strain; of a held one
  /// ρ ∫N_j, the load that is right for statics.
  [[nodiscard]] std::span<const double> weights() const { return weights_.empty() ? masses_ : weights_; }
  /// weights / masses; empty: ones.
  [[nodiscard]] std::span<const double> gravityShares() const { return gravityShares_; }
  /// 1/m, 1/kg; 0 for phyxels that are held.
  [[nodiscard]] std::span<const double> inverseMasses() const { return inverseMasses_; }
  /// F of the evaluation points at the last evaluation; the identity before the first.
  /// After evaluate() they are worked out when somebody asks, by the thread that asks: once before a parallel loop.
  [[nodiscard]] std::span<const Mat3> gradients() const;
  /// v P of the evaluation points, likewise.
  [[nodiscard]] std::span<const Mat3> stresses() const;
  /// Internal forces, loads and the foundation's of the last evaluation, N; without gravity, supports and contact.
  [[nodiscard]] std::span<const Vec3> forces() const { return forces_; }
  [[nodiscard]] std::span<Vec3> forces() { return forces_; }

  /// Takes effect with the next force evaluation; the stable step is found anew. History of what a material no longer
  /// needs is dropped, what it newly needs starts fresh.
  void setConstitution(Constitution constitution, const ParallelFor &parallelFor);

  /// Mass scaling: phyxels of few small or stiff cells, which alone ask for short explicit steps, get more inertia,
  /// until the stable step at rest is `step` or a twentieth of the mass of what can move has been added. Weights stay,
  /// so that nothing at rest feels it. Bodies that nothing holds, and those whose step would not become half as long
  /// again, stay what they are. Lasts for setConstitution().
  /// @param step  s; 0: no more
  /// @source  Belytschko, Liu, Moran, Elkhodary, Nonlinear Finite Elements for Continua and Structures, 2014, ch. 6
  void scaleMasses(double step, const ParallelFor &parallelFor);

  /// Initial velocities, m/s and rad/s about the centre of mass: part of the initial state.
  void setInitialVelocity(const Vec3 &velocity, const Vec3 &angularVelocity);

  /// Largest explicit step at rest without margin, s; infinite for a body without internal forces.
  [[nodiscard]] double stableStepAtRest() const { return stableStepFor(1.0); }
  /// The same at the present deformation, from the tangent moduli of the last force evaluation.
  [[nodiscard]] double stableStep() const { return stableStepFor(tangentRatio_); }
  [[nodiscard]] double restFrequency() const { return restFrequency_; }

  /// Of what the force kernels compute with; takes effect with the next evaluation. Materials that flow or relax are
  /// computed in double precision always.
  void setPrecision(Precision precision);
  [[nodiscard]] Precision precision() const { return precision_; }
  /// Whether evaluate() and elasticEnergy() run vector kernels: not on a renewed reference, nor with clouds that flow
  /// or relax.
  [[nodiscard]] bool vectorised() const { return vectorForces_ != nullptr; }
  /// Whether evaluateInternal(), linearise() and forceDifferential() are there too: not with materials that flow or
  /// relax.
  [[nodiscard]] bool vectorisedTangent() const { return vectorised() && !constitution_.remembers(); }

  /// forces() and tangentRatio() of the present state, loads at time (or load factor) t: all that an explicit step
  /// needs. Fused where the body is vectorised(), else the stages below, with plastic flow and Prony terms over dt.
  void evaluate(double t, double dt, const ParallelFor &parallelFor);
  /// Of a body with vectorisedTangent(), in double precision whatever precision() is: forces() without loads (and
  /// without viscous ones, if asked); the tangent there, and its products df = -K du, with viscous forces of velocities
  /// viscousScale du.
  void evaluateInternal(bool viscous, const ParallelFor &parallelFor);
  /// Displacements have been changed from outside: what is known of the points is old.
  void forgetPoints() { gradientsOld_ = stressesOld_ = vectorised(); }
  void linearise(const ParallelFor &parallelFor);
  void forceDifferential(std::span<const Vec3> du, double viscousScale, std::span<Vec3> df,
                         const ParallelFor &parallelFor);

  /// Stages of a force evaluation at the present state, in order.
  void computeGradients(const ParallelFor &parallelFor);
  /// @return points that flowed during dt
  std::size_t computeFlow(double dt, const ParallelFor &parallelFor);
  /// @param dt  s: Prony terms advance by it; 0: they stay
  void computeStresses(double dt, const ParallelFor &parallelFor);
  /// The same without moving on: the memory of the Prony terms stays.
  void computeTrialStresses(double dt, const ParallelFor &parallelFor);
  /// Stresses of the elastic and plastic part alone.
  void computeElasticStresses(const ParallelFor &parallelFor);
  /// Internal forces, those of the foundation, and loads at time (or load factor) t.
  void computeForces(double t, const ParallelFor &parallelFor);
  void computeInternalForces(const ParallelFor &parallelFor);

  /// Load factor of a fix or load with a ramp at time t; `t` itself in a quasi-static solution.
  bool quasiStatic = false;
  [[nodiscard]] double factor(double ramp, double t) const;

  /// Puts held phyxels where they belong at time t; rates: their velocities as well.
  void placeHeld(double t, bool rates);
  /// Target displacements of the held patches at time t, in the order of their rows.
  [[nodiscard]] std::span<const Vec3> patchTargets(double t);
  [[nodiscard]] std::span<const Vec3> lastPatchTargets() const { return patchTargets_; }
  [[nodiscard]] PatchSolver &patches() { return patches_; }
  [[nodiscard]] const PatchSolver &patches() const { return patches_; }
  [[nodiscard]] std::span<const std::uint8_t> heldMask() const { return heldMask_; }
  [[nodiscard]] bool held() const { return !heldPhyxels_.empty() || patches_.rows() > 0; }
  /// How the support moves that holds a material point; nothing where the point is free. All that lies in the region of
  /// a fix goes with it: phyxels beside its border carry free material, too, and may be elsewhere.
  /// @param X  first reference, world, m
  [[nodiscard]] std::optional<SupportedMotion> supportAt(const Vec3 &X) const;
  /// Of one fix, in the frame of the phyxels.
  [[nodiscard]] RigidMotion supportMotion(std::size_t fix) const;
  /// By fixes: phyxels that lie in their regions, or within a spacing of them.
  struct HeldPhyxel {
    Index phyxel;
    Index fix;
  };
  [[nodiscard]] std::span<const HeldPhyxel> phyxelsNearSupports() const { return nearSupports_; }
  /// Puts the surfels that supports hold where these are, and turns their normals.
  /// @param positions  [surfels] m, in the frame of the phyxels
  /// @param normals    [surfels] unit, or empty
  void placeHeldSurfels(std::span<Vec3> positions, std::span<Vec3> normals) const;
  /// @param positions  [surfels] m, world
  void placeHeldSurfels(std::span<Vec3f> positions, std::span<Vec3f> normals) const;

  /// How its surroundings hold it; takes effect with the next force evaluation. Errors: settings that validate()
  /// refuses; a body without a surface, or whose reference has been renewed, if it is to act.
  [[nodiscard]] Result<void> setFoundation(const Foundation &foundation);
  [[nodiscard]] ElasticFoundation &foundation() { return foundation_; }
  [[nodiscard]] const ElasticFoundation &foundation() const { return foundation_; }
  /// Attachments (attachment.h) to other bodies and obstacles add at most this to the squared frequencies of the body,
  /// 1/s²; 0: there are none.
  void setAttachedFrequency(double squared) { attachedFrequency_ = squared; }
  [[nodiscard]] bool attached() const { return attachedFrequency_ > 0.0; }
  /// What its surroundings exert now, about the body's centre in the reference.
  [[nodiscard]] Reaction foundationReaction() const;
  /// What the supports exert now: from the forces on held phyxels (internal, loads, gravity) and those of the patches.
  [[nodiscard]] std::vector<Reaction> reactions(const Vec3 &gravity) const;

  /// In double precision.
  [[nodiscard]] ElasticEnergy elasticEnergy(std::span<Eigen::Vector2d> perPoint = {}) const;
  [[nodiscard]] ElasticEnergy elasticEnergy(const ParallelFor &parallelFor) const;
  [[nodiscard]] double kineticEnergy() const;
  [[nodiscard]] double totalMass() const;  ///< with what supports carry, kg

  /// Young's modulus around the contact points, Pa.
  [[nodiscard]] std::span<const double> contactModuli() const { return contactModuli_; }
  /// Pa, Young's modulus around each point.
  [[nodiscard]] std::vector<double> moduliAt(const Interpolation &points) const;
  /// x and v of the contact points in the world; valid until the next call.
  std::span<const Vec3> contactPositions(const ParallelFor &parallelFor);
  std::span<const Vec3> contactVelocities(const ParallelFor &parallelFor);

  /// Goes on from another reference with the same shape, velocities, elastic strain and mass (rereferencing.h). What
  /// was kept is then the new state; contact is looked for anew; hands hold on where the phyxels stay the same ones.
  void rereference(std::shared_ptr<const RestState> rest, State state, const ParallelFor &parallelFor);
  /// How often since the start.
  [[nodiscard]] std::size_t rereferenceCount() const { return rereferenceCount_; }
  /// Σ m (way of the references from the first one to the present one), kg m.
  [[nodiscard]] const Vec3 &referenceShiftMoment() const { return referenceShiftMoment_; }

  /// A rigid body keeps its shape. It stands as it is in its reference, without velocity: no stage runs, nothing moves
  /// it; or, `free`, it moves as a rigid body of the masses of its phyxels, in explicit steps. In any case it goes to
  /// its initial state.
  void setRigid(bool rigid, bool free = false);
  [[nodiscard]] bool rigid() const { return rigid_; }
  /// It is rigid and moves. Not where something is fixed of it, nor in a static solution: there it stands.
  [[nodiscard]] bool free() const { return rigid_ && free_ && !quasiStatic && !held(); }
  /// What setRigid() was told, whether it is rigid or not.
  [[nodiscard]] bool freeWhereRigid() const { return free_; }
  /// It is rigid and does not move.
  [[nodiscard]] bool stands() const { return rigid_ && !free(); }
  /// Mass and inertia of a rigid body; after setRigid().
  [[nodiscard]] const detail::RigidFrame &rigidFrame() const { return *rigidFrame_; }

  /// N per phyxel, from outside of the model, added to those of the scene: constant over a step, kept until they are
  /// set again. Quasi-static: times the load factor.
  /// @param forces  [phyxels], finite; empty: none. Has those of before when this returns
  void swapExternalForces(std::vector<Vec3> &forces);
  [[nodiscard]] std::span<const Vec3> externalForces() const { return externalForces_; }

  /// The state before a step, kept in case the step fails.
  void keepState();
  void restoreState();
  [[nodiscard]] const State &keptState() const { return kept_; }
  /// To the initial state, bit for bit.
  void reset();
  [[nodiscard]] BodyCheckpoint checkpoint() const;
  /// The state that was kept, with the material of now; nothing holds the body by hand then. History that the material
  /// of then did not need starts fresh.
  /// @return false: nothing is changed, because the body was rigid or free then and is not now, or the other way round
  bool restore(const BodyCheckpoint &checkpoint, const ParallelFor &parallelFor);
  /// What an explicit step takes over from the one before it. Viscous forces are those of its middle: evaluated again,
  /// they would differ.
  struct Carried {
    std::vector<Vec3> forces;  ///< [phyxels] N
    double tangentRatio = 1.0;
    bool forcesCurrent = false;
  };
  [[nodiscard]] Carried carried() const { return {forces_, tangentRatio_, forcesCurrent}; }
  void carryOn(Carried carried) {
    forces_ = std::move(carried.forces);
    tangentRatio_ = carried.tangentRatio;
    forcesCurrent = carried.forcesCurrent;
  }

  /// Why the body stands still in its last good state although the simulation goes on; nothing: it does not.
  std::optional<GuardFinding> stopped;
  /// That in words, with names and remedy; empty: it does not stand still.
  [[nodiscard]] std::string stopMessage() const;
  std::vector<Hand> hands;
  ContactState contact;
  bool forcesCurrent = false;

 private:
  struct HeldSurfel {
    Index surfel, fix;
  };
  void layOut();
  void shareGravity();
  void findWhatSupportsHold();
  void bindFoundation();
  void frameRigid();
  [[nodiscard]] Vec3 firstReference(Index phyxel) const;
  [[nodiscard]] double stableStepFor(double tangentRatio) const;
  void addMasses(const ParallelFor &parallelFor);
  void followMasses();
  void vectorise(const ParallelFor &parallelFor);
  [[nodiscard]] double frequencyAtRest(const ParallelFor &parallelFor) const;
  void makePoints() const;
  [[nodiscard]] detail::VectorForces &exactForces() const;
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
  std::vector<Index> carrier_;  // fix that carries it
  std::vector<HeldPhyxel> heldPhyxels_, nearSupports_;
  std::vector<HeldSurfel> heldSurfels_;
  std::vector<std::uint8_t> heldMask_;
  PatchSolver patches_;
  ElasticFoundation foundation_;
  double foundationFrequency_ = 0.0;  // rad/s, a bound
  double attachedFrequency_ = 0.0;    // 1/s², likewise
  bool rigid_ = false, free_ = false;
  std::unique_ptr<const detail::RigidFrame> rigidFrame_;  // of a rigid body
  std::vector<Index> fixOfPatch_;
  std::vector<Vec3> patchPoints_, patchShifts_, patchTargets_;
  std::vector<Vec3> externalForces_;  // empty: none
  std::vector<Vec3> forces_, entryForces_, contactPositions_, contactVelocities_;
  // Of the points; old after evaluate() by vector kernels, until somebody asks for them; empty until they are needed.
  mutable std::vector<Mat3> gradients_, stresses_;
  mutable std::vector<double> tangentRatios_;
  mutable bool gradientsOld_ = false, stressesOld_ = false;
  std::vector<Mat3> rates_;
  std::unique_ptr<detail::VectorForces> vectorForces_;
  // of a body in single precision, once somebody needs them
  mutable std::unique_ptr<detail::VectorForces> exactForces_;
  Precision precision_ = Precision::doublePrecision;
  std::vector<HourglassStrain> relaxedModes_;  // of the last evaluation of stresses; empty: nothing
  double tangentRatio_ = 1.0;
  double restFrequency_ = 0.0;  // rad/s
};

}  // namespace pointbased
