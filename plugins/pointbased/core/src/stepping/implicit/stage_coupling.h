// SPDX-License-Identifier: Apache-2.0
// Coupling of several bodies within a stage of an implicit or static step. Private to the core.
#pragma once

#include "stepping/coupling/attachment_layer.h"
#include "stepping/coupling/joint_contact.h"

namespace pointbased::detail {

/// Contact between skins, as the penalty of contact.h with signed rows over the phyxels of all moving bodies, and
/// attachments. Displacements and forces are those of all these phyxels, body by body.
/// @threads one
class StageCoupling {
 public:
  void clear();
  /// Bodies that do not move have no phyxels here.
  void add(Body &body, bool moves);
  void join(std::span<const JoinedPair> pairs, std::span<const JoinedLayer> layers);
  [[nodiscard]] std::size_t phyxels() const { return count_; }

  /// Whether attachments to held or static parts hold the body against every rigid motion.
  [[nodiscard]] bool holds(const Body &body) const;
  /// Begins a stage at `start`, with attachments in their state at time `end`. Contact planes move for `span` (s, or
  /// load factor).
  void begin(std::span<const Vec3> start, double end, double span, bool isStatic);
  /// Finds contacts on the path from the start of the stage to `now`, with planes at the start. Where that path is
  /// nearly known, uses the contacts at `now` itself, which follow curved surfaces.
  void find(std::span<const Vec3> now);
  /// Whether find() has searched at `now` itself.
  [[nodiscard]] bool isFoundAtState() const { return foundAtState_; }
  [[nodiscard]] bool touches() const { return !joint_.empty(); }
  [[nodiscard]] bool hasPairs() const { return !pairs_.empty(); }
  [[nodiscard]] std::size_t contactCount() const { return joint_.state().active.size(); }
  [[nodiscard]] bool acts() const { return touches() || !layers_.empty(); }

  [[nodiscard]] double energy(std::span<const Vec3> now) const;
  void addForces(std::span<const Vec3> now, std::span<Vec3> forces) const;
  void addProduct(std::span<const Vec3> now, std::span<const Vec3> du, std::span<Vec3> out) const;
  void addBlocks(std::span<const Vec3> now, std::span<Mat3> blocks) const;
  void addTriplets(std::span<const Vec3> now, std::vector<Eigen::Triplet<double>> &out) const;

  /// Stores the normal forces at `now`; friction of the next solution uses them.
  void updateNormalForces(std::span<const Vec3> now);
  /// Stores the contact forces on the phyxels, for comparison (ContactForces).
  void record(std::span<const Vec3> now);
  [[nodiscard]] double changeTo(std::span<const Vec3> now);
  /// Ends a solved stage: stored friction displacements are transferred to the next one. Adds the impulses over
  /// `weight` (s, or load factor) to SkinPair::sum().
  void finish(std::span<const Vec3> now, double weight);

  /// The known contacts, and where they were found.
  struct Contacts {
    std::vector<std::vector<SkinContact>> ofPairs;
    std::vector<Vec3> base;
  };
  [[nodiscard]] Contacts contacts() const;
  void setContacts(const Contacts &contacts);
  /// Pairs and keys of contacts with a contact force, ascending.
  using ActiveContacts = std::vector<std::pair<std::size_t, std::uint64_t>>;
  [[nodiscard]] ActiveContacts activeContacts() const;
  /// Sums over this step so far, of every pair.
  [[nodiscard]] std::vector<SkinPair::Sum> sums() const;
  void setSums(const std::vector<SkinPair::Sum> &sums);
  void beginSums() {
    for (const JoinedPair &joined : pairs_) joined.pair->beginSum();
  }
  /// Whether a contact of the last stage has a normal force if the motion continues uniformly.
  /// @param known, to  s, from the beginning of the stage: its end, and the end of the continuation
  [[nodiscard]] bool hasContactAlong(double known, double to) const;

 private:
  /// Static bodies are included in their present state.
  [[nodiscard]] AttachmentLayer::AttachedState attachedState(const JoinedLayer &layer, std::span<const Vec3> now) const;
  template <class T>
  [[nodiscard]] std::span<T> partOf(std::size_t body, std::span<T> of) const;
  [[nodiscard]] ContactPenalty penalty() const { return {0.0, {}, 0.0, span_}; }
  void findAlong(std::span<const Vec3> now);
  void findFromBase(double dt);
  void gather();
  void contactForces(std::span<const Vec3> now, std::vector<Vec3> &out) const;

  struct Member {
    Body *body = nullptr;
    std::size_t first = 0, count = 0;  // of its phyxels; count 0: it does not move
  };
  std::vector<Member> members_;
  std::size_t count_ = 0;
  std::span<const JoinedPair> pairs_;
  std::span<const JoinedLayer> layers_;
  JointContact joint_;
  double end_ = 0.0, span_ = 0.0;
  bool isRepeat_ = false, isStatic_ = false, foundAtState_ = true;
  std::vector<Vec3> start_, base_;                         // m; base_: displacements for which gaps were measured
  std::vector<Vec3> searchEnd_;                            // m: end of the path that was searched last
  std::vector<std::vector<SkinContact>> contactsOfPaths_;  // [pairs] found on the paths of this stage
  std::vector<std::vector<Vec3>> displacementsOf_, velocitiesOf_;  // [members] m, m/s: referenced by their skins
  std::vector<Vec3> recorded_, present_;                           // [phyxels] N
};

}  // namespace pointbased::detail
