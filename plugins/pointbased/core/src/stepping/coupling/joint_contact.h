// SPDX-License-Identifier: Apache-2.0
// Contacts of several bodies as one system. Private to the core.
#pragma once

#include "contact/skin_pair.h"
#include "stepping/coupling/rigid_state.h"

namespace pointbased::detail {

/// A pair of skins among the bodies of a JointContact.
struct JoinedPair {
  SkinPair *pair = nullptr;
  std::size_t first = 0, second = 0;  ///< indices of their bodies there
};

/// Phyxels of several bodies as one vector of unknowns, with the contacts between their skins and those of each with
/// obstacles and walls. Rigid static or stopped bodies have zero inverse mass. A moving free rigid body is represented
/// by four particles in place of its phyxels (RigidParticles).
/// @threads one
class JointContact {
 public:
  void clear();
  /// @param moves  false: it is static
  /// @param hasUnknowns  false: it is static, and its phyxels are not among the unknowns
  /// @param rigid  state of a moving free rigid body, valid until clear(); null: for others
  void add(Body &body, bool moves, bool hasUnknowns = true, RigidState *rigid = nullptr);

  /// Collects the contacts that have been found: of the pairs and, if `obstacles`, those in Body::contact of each body.
  void gather(std::span<const JoinedPair> pairs, double margin, bool obstacles = true);
  /// Whether the contacts of pairs that were gathered last are still valid: none of them has slid since by more than a
  /// small fraction of the layer between the skins.
  [[nodiscard]] bool isStillValid();
  /// Reuses these, with their present gaps, together with the contacts with obstacles and walls that have been found
  /// since. Call after isStillValid().
  void regather();
  /// The contacts over all phyxels, as rows of signed weights; Contact::point is the index of the row.
  [[nodiscard]] const ContactPoints &rows() const { return rows_; }
  [[nodiscard]] ContactState &state() { return state_; }
  [[nodiscard]] const ContactState &state() const { return state_; }
  /// Writes the results for the contacts of pairs back to the pairs.
  void writeBack(std::span<const JoinedPair> pairs);
  /// Predicts velocities from the impulses of the last step, so that resting bodies are not treated as arriving ones.
  /// Call after gather() of the contacts of that step.
  void predict();
  [[nodiscard]] std::span<const Vec3> predicted(std::size_t body) const {
    const Joined &joined = bodies_[body];
    if (joined.rigid) return joined.predicted;
    return std::span<const Vec3>(velocities_).subspan(joined.first, joined.body->rest().phyxelCount());
  }
  [[nodiscard]] bool empty() const { return state_.active.empty(); }

  /// Explicit steps: solveContactImpulses() and projectContactVelocities() for all bodies together. The results are
  /// written back to the sources of the contacts.
  void solve(double dt, std::span<const JoinedPair> pairs);
  void projectVelocities(std::span<const JoinedPair> pairs);

 private:
  struct Joined {
    Body *body = nullptr;
    std::size_t first = 0;  // index of its first phyxel among all
    bool moves = true, hasUnknowns = true;
    RigidState *rigid = nullptr;  // null: its phyxels are the unknowns
    std::size_t number = 0;       // index in rigid_
    std::vector<Vec3> predicted;  // [phyxels] m/s, of a rigid one
  };
  void addEntry(Index of, double weight);
  void addRow(std::span<const Index> phyxels, std::span<const double> weights, const Joined &of, double scale);
  void endRow();
  void addContact(const Contact &contact);
  void addObstacles();
  void loadDisplacements();
  [[nodiscard]] Vec3 rowDisplacement(std::size_t row) const;  // m, from displacements_
  void loadVelocities();
  void storeVelocities();

  std::vector<Joined> bodies_;
  std::size_t count_ = 0;
  ContactPoints rows_;
  ContactState state_;
  double margin_ = 0.0;  // m, the smallest of the pairs
  bool gathersObstacles_ = true;
  std::vector<double> inverseMasses_;
  std::vector<RigidParticles> rigid_;
  std::vector<Vec3> velocities_;
  std::vector<Index> entryOf_;  // [phyxels] in the row that is being built; kNone
  /// A contact of a pair when it was gathered.
  struct GatherSnapshot {
    Vec3 displacement = Vec3::Zero();  // m, of the displacements
    double gap = 0.0;                  // m
    double normalDisplacement = 0.0;   // m, along its normal, since then
  };
  std::vector<GatherSnapshot> gatherSnapshots_;  // [contacts of pairs]
  std::vector<Vec3> displacements_;
};

}  // namespace pointbased::detail
