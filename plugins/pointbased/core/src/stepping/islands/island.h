// SPDX-License-Identifier: Apache-2.0
// Bodies that may touch each other or are attached, advanced in lock step. Private to the core.
#pragma once

#include "stepping/coupling/attachment_layer.h"
#include "stepping/coupling/joint_contact.h"
#include "stepping/coupling/skin_contacts.h"
#include "stepping/explicit/explicit_substep.h"
#include "stepping/implicit/island_step.h"
#include "stepping/islands/body_stepper.h"

namespace pointbased::detail {

/// A set of bodies that may touch each other or are attached to something. They advance in lock step; explicit ones in
/// the substeps of the body that needs the smallest. If the guard refuses the state of one, the step of all is undone.
/// Static bodies (Body::isStatic()) and stopped ones take part in contact without moving.
class Island {
 public:
  struct Member {
    std::size_t id = 0;
    BodyStepper *stepper = nullptr;
  };

  void clear();
  void add(std::size_t id, BodyStepper &stepper) { members_.push_back({id, &stepper}); }
  /// Adds a contact pair; members by index.
  void join(SkinPair &pair, std::size_t first, std::size_t second) { pairs_.push_back({&pair, first, second}); }
  void attach(const JoinedLayer &layer) { layers_.push_back(layer); }
  [[nodiscard]] std::span<const Member> members() const { return members_; }
  [[nodiscard]] std::span<const JoinedPair> pairs() const { return pairs_; }

  /// Marks the members as exchanging energy with each other.
  void markEnergyExchange();
  /// Same as BodyStepper::advance() and advanceAgain(), for all members.
  /// @param contexts  [members], each in its own surroundings
  [[nodiscard]] double advance(std::span<const StepContext> contexts, double span);
  void advanceAgain(std::span<const StepContext> contexts, double span);
  /// Same as BodyStepper::loadUpTo(), for all members.
  void loadUpTo(std::span<const StepContext> contexts, double factor);
  /// After a cancelled implicit or static step: how far it had advanced, and what would help. Empty: the island makes
  /// explicit steps.
  [[nodiscard]] std::string suggestAffordableStep(const WorldSettings &world) const;
  /// Makes the next step depend on the state only, not on earlier steps.
  void resetSolver() { solver_.forget(); }

 private:
  [[nodiscard]] bool moves(std::size_t k) const {
    const BodyStepper &stepper = *members_[k].stepper;
    return !stepper.body().isStatic() && !stepper.stopped();
  }
  [[nodiscard]] double tryToAdvance(std::span<const StepContext> contexts, double span, std::uint64_t maxSubsteps);
  struct Refused {
    std::size_t member = 0;
    BodyStepper::Refusal why;
  };
  using Advance = tl::expected<double, Refused>;
  [[nodiscard]] Advance advanceOnce(std::span<const StepContext> contexts, double span, std::uint64_t maxSubsteps);
  /// Checks the total energy at `time`.
  /// @return  the member whose energy has grown most, if the total has grown
  [[nodiscard]] std::optional<Refused> checkEnergy(std::span<const StepContext> contexts, double time);
  /// Same as BodyStepper::repeatFromCheckpoint().
  [[nodiscard]] Advance repeatFromCheckpoints(std::span<const StepContext> contexts, double span);
  /// s, of the energy checkpoints of all that move; empty: their times differ.
  [[nodiscard]] std::optional<double> timeOfCheckpoints() const;
  /// Common integrator: explicit if a member is rigid and free; otherwise implicit if one of them is. With
  /// Integrator::automatic and members in contact, the one with the lower predicted cost for all.
  [[nodiscard]] Integrator integratorIn(const WorldSettings &world) const;
  /// Sets the scheme of a step, also for its repetitions.
  void chooseScheme(std::span<const StepContext> contexts);
  /// The first free rigid member; null: none.
  [[nodiscard]] const BodyStepper *freeRigid() const;
  [[nodiscard]] bool explicitIsCheaper(const WorldSettings &world) const;
  [[nodiscard]] std::string names() const;  // of those that move
  [[nodiscard]] Advance advanceImplicit(std::span<const StepContext> contexts, double span, Integrator scheme);
  /// Fills parts_ and coupling_ for those that move.
  void gatherCoupling(std::span<const StepContext> contexts);
  /// Member, and its phyxel.
  [[nodiscard]] std::pair<std::size_t, Index> ownerOf(Index phyxelOfParts) const;
  [[nodiscard]] Advance advanceExplicit(std::span<const StepContext> contexts, double span, std::uint64_t maxSubsteps);
  /// s, largest substep that all of them can make now.
  [[nodiscard]] Advance maxSubstep(std::span<const StepContext> contexts, double time, double left);
  void gatherSkins();
  [[nodiscard]] AttachmentLayer::AttachedState attachedState(std::size_t layer, double time) const;
  /// Adds the forces of all attachments to those of the members that move.
  /// @param onlyFresh  only to members whose forces were evaluated at the beginning of the substep
  void addLayerForces(double time, bool onlyFresh = false);
  /// @return  whether anything has torn
  bool tearLayers(double time);
  void updateLayerNormals(double time);
  /// @param continues  these members have just made the previous substep: rows of contacts are those at its end
  void substep(std::span<const StepContext> contexts, double time, double dt, bool continues);

  Integrator scheme_ = Integrator::explicitVerlet;  // of the present step
  std::vector<Member> members_;
  std::vector<JoinedPair> pairs_;
  std::vector<JoinedLayer> layers_;
  JointContact joint_;
  StageCoupling coupling_;
  std::vector<StepPart> parts_;  // of those that move
  NewtonSolver solver_;
  std::vector<ExplicitSubstep> substeps_;  // of those that move
  struct MovedSkin {
    MovingSkin *skin = nullptr;
    std::size_t member = 0;
  };
  std::vector<MovedSkin> skins_;     // of all pairs, without duplicates
  double normalRotation_ = 0.0;      // rad, rotation of the normals of attachments since the last update
  std::vector<std::uint8_t> fresh_;  // [members] 1: forces were evaluated at the beginning of the substep
};

}  // namespace pointbased::detail
