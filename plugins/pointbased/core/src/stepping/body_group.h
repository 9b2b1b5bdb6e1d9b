// SPDX-License-Identifier: Apache-2.0
// Bodies that may touch each other or are attached, in lock step. Private to the core.
#pragma once

#include "stepping/attachment_layer.h"
#include "stepping/body_stepper.h"
#include "stepping/explicit_substep.h"
#include "stepping/group_step.h"
#include "stepping/joint_contact.h"
#include "stepping/skin_contacts.h"

namespace pointbased::detail {

/// Advances bodies that may touch each other or are attached to something, all in the same steps: explicit ones in the
/// substeps of the one that needs the smallest. What the guard refuses of one is undone for all. Bodies that
/// stand (Body::stands()), and those that have stopped, are touched.
class BodyGroup {
 public:
  struct Member {
    std::size_t id = 0;
    BodyStepper *runner = nullptr;
  };

  void clear();
  void add(std::size_t id, BodyStepper &runner) { members_.push_back({id, &runner}); }
  /// Members by their number here.
  void join(SkinPair &pair, std::size_t first, std::size_t second) { pairs_.push_back({&pair, first, second}); }
  void attach(const JoinedLayer &layer) { layers_.push_back(layer); }
  [[nodiscard]] std::span<const Member> members() const { return members_; }
  [[nodiscard]] std::span<const JoinedPair> pairs() const { return pairs_; }

  /// Tells the members that they exchange energy with each other.
  void tellMembers();
  /// As BodyStepper::advance() and advanceAgain().
  /// @param orders  [members], each in its own surroundings
  [[nodiscard]] double advance(std::span<const StepContext> orders, double span);
  void advanceAgain(std::span<const StepContext> orders, double span);
  /// As BodyStepper::loadUpTo(), likewise.
  void loadUpTo(std::span<const StepContext> orders, double factor);
  /// After an implicit or static step was ended half way: how far it had come, and what would help. Empty: they take
  /// explicit steps.
  [[nodiscard]] std::string whatWouldFit(const WorldSettings &world) const;
  /// Nothing of earlier steps is used by the next one but the state.
  void startSolverAnew() { solver_.forget(); }

 private:
  [[nodiscard]] bool moves(std::size_t k) const {
    const BodyStepper &runner = *members_[k].runner;
    return !runner.body().stands() && !runner.stopped();
  }
  [[nodiscard]] double tryToAdvance(std::span<const StepContext> orders, double span, std::uint64_t mostSubsteps);
  struct Refused {
    std::size_t member = 0;
    BodyStepper::Refusal why;
  };
  using Gone = tl::expected<double, Refused>;
  [[nodiscard]] Gone advanceOnce(std::span<const StepContext> orders, double span, std::uint64_t mostSubsteps);
  /// Looks at the energy of all together, at `time`. @return whose has grown most, if that of all has
  [[nodiscard]] std::optional<Refused> lookAtEnergy(std::span<const StepContext> orders, double time);
  /// As BodyStepper::againFromMark().
  [[nodiscard]] Gone againFromMarks(std::span<const StepContext> orders, double span);
  /// s, of the marks of all that move; nothing: they are not of one time.
  [[nodiscard]] std::optional<double> timeOfMarks() const;
  /// What integrates all of them: explicit steps where one is rigid and free; else something implicit where one of them
  /// is; of Integrator::automatic, where some touch,
  /// what is predicted to cost less for all.
  [[nodiscard]] Integrator integratorIn(const WorldSettings &world) const;
  /// For a step, and for what is taken of it again.
  void takeScheme(std::span<const StepContext> orders);
  /// The first of them; null: none.
  [[nodiscard]] const BodyStepper *freeRigid() const;
  [[nodiscard]] bool explicitIsCheaper(const WorldSettings &world) const;
  [[nodiscard]] std::string names() const;  // of those that move
  [[nodiscard]] Gone advanceImplicit(std::span<const StepContext> orders, double span, Integrator scheme);
  /// Fills parts_ and coupling_ for those that move.
  void gatherCoupling(std::span<const StepContext> orders);
  /// Member, and phyxel of it.
  [[nodiscard]] std::pair<std::size_t, Index> ownerOf(Index phyxelOfParts) const;
  [[nodiscard]] Gone advanceExplicit(std::span<const StepContext> orders, double span, std::uint64_t mostSubsteps);
  /// s, that all of them can take now.
  [[nodiscard]] Gone maxSubstep(std::span<const StepContext> orders, double time, double left);
  void gatherSkins();
  [[nodiscard]] AttachmentLayer::Sides sidesOf(std::size_t layer, double time) const;
  /// Adds the forces of all attachments to those of the members that move.
  /// @param onlyFresh  to those alone whose forces have been evaluated since
  void addLayerForces(double time, bool onlyFresh = false);
  /// @return whether anything has torn
  bool tearLayers(double time);
  void turnLayers(double time);
  /// @param goesOn  the last substep of these members was the one before: rows of contacts are those of its end
  void substep(std::span<const StepContext> orders, double time, double dt, bool goesOn);

  Integrator scheme_ = Integrator::explicitVerlet;  // of the step that is being taken
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
  std::vector<MovedSkin> skins_;     // of all pairs, once each
  double turned_ = 0.0;              // rad, that normals of attachments have turned since the last look
  std::vector<std::uint8_t> fresh_;  // [members] 1: forces were evaluated at the beginning of the substep
};

}  // namespace pointbased::detail
