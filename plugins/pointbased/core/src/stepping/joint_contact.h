// SPDX-License-Identifier: Apache-2.0
// The contacts of bodies that touch each other as one system. Private to the core.
#pragma once

#include "contact/skin_pair.h"
#include "stepping/rigid_state.h"

namespace pointbased::detail {

/// A pair of skins among the bodies of a JointContact.
struct JoinedPair {
  SkinPair *pair = nullptr;
  std::size_t first = 0, second = 0;  ///< numbers of their bodies there
};

/// Phyxels of several bodies as one row of unknowns, with the contacts between their skins and those of each with
/// obstacles and walls. What moves nothing (rigid or stopped bodies) has no inverse mass. A free rigid body that moves
/// enters with four particles in place of its phyxels (RigidParticles).
/// @threads one
class JointContact {
 public:
  void clear();
  /// @param moves  false: it stands still
  /// @param counts  false: it stands still, and its phyxels are not among the unknowns
  /// @param rigid  of a free rigid body that moves, and stays until clear(); null: of others
  void add(Body &body, bool moves, bool counts = true, RigidState *rigid = nullptr);

  /// Takes the contacts that have been found: of the pairs, and of each body those in Body::contact, if `obstacles`.
  void gather(std::span<const JoinedPair> pairs, double margin, bool obstacles = true);
  /// Whether the contacts of pairs that have been gathered last are still those: none of them has slid farther since
  /// than a small part of the layer between the skins.
  [[nodiscard]] bool serves();
  /// Takes these again, with gaps as they are now, and the contacts with obstacles and walls that have been found
  /// since. After serves().
  void gatherAgain();
  /// The contacts over all phyxels, as rows of signed weights; Contact::point is the row.
  [[nodiscard]] const ContactPoints &rows() const { return rows_; }
  [[nodiscard]] ContactState &state() { return state_; }
  [[nodiscard]] const ContactState &state() const { return state_; }
  /// What has been found for the contacts of pairs goes back to them.
  void giveBack(std::span<const JoinedPair> pairs);
  /// What the velocities will be, as far as the impulses of the last step tell: what rests on something is not taken
  /// for arriving there. After gather() of the contacts of that step.
  void predict();
  [[nodiscard]] std::span<const Vec3> predicted(std::size_t body) const {
    const Joined &joined = bodies_[body];
    if (joined.rigid) return joined.predicted;
    return std::span<const Vec3>(velocities_).subspan(joined.first, joined.body->rest().phyxelCount());
  }
  [[nodiscard]] bool empty() const { return state_.active.empty(); }

  /// Explicit steps: solveContactImpulses() and settleContactVelocities() of all of them together. What they find goes
  /// back to where the contacts came from.
  void solve(double dt, std::span<const JoinedPair> pairs);
  void settle(std::span<const JoinedPair> pairs);

 private:
  struct Joined {
    Body *body = nullptr;
    std::size_t first = 0;  // of its phyxels among all
    bool moves = true, counts = true;
    RigidState *rigid = nullptr;  // null: its phyxels are the unknowns
    std::size_t number = 0;       // among rigid_
    std::vector<Vec3> predicted;  // [phyxels] m/s, of a rigid one
  };
  void addEntry(Index of, double weight);
  void addRow(std::span<const Index> phyxels, std::span<const double> weights, const Joined &of, double scale);
  void endRow();
  void addContact(const Contact &contact);
  void addObstacles();
  void takeDisplacements();
  [[nodiscard]] Vec3 way(std::size_t row) const;  // m, from displacements_
  void takeVelocities();
  void giveVelocities();

  std::vector<Joined> bodies_;
  std::size_t count_ = 0;
  ContactPoints rows_;
  ContactState state_;
  double margin_ = 0.0;  // m, the least of the pairs
  bool gathersObstacles_ = true;
  std::vector<double> inverseMasses_;
  std::vector<RigidParticles> rigid_;
  std::vector<Vec3> velocities_;
  std::vector<Index> entryOf_;  // [phyxels] of the row that is being made; kNone
  /// A contact of a pair when it was gathered.
  struct Began {
    Vec3 way = Vec3::Zero();  // m, of the displacements
    double gap = 0.0;         // m
    double rise = 0.0;        // m, along its normal, since
  };
  std::vector<Began> began_;  // [contacts of pairs]
  std::vector<Vec3> displacements_;
};

}  // namespace pointbased::detail
