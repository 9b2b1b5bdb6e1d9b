// SPDX-License-Identifier: Apache-2.0
// Which parts of a skin may touch each other in the next steps. Private to the core.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "contact/contact_skin.h"

namespace pointbased::detail {

/// Spacings: what of one skin is farther apart does not touch in a step.
inline constexpr double kNearOfSelf = 0.13;

/// Candidate pairs for contact of a skin with itself, for several steps at once: those patches that come near each
/// other within a horizon if every vertex keeps its velocity. The list serves until vertices have deviated from that so
/// far that other patches may meet.
/// @threads one
class SkinForecast {
 public:
  /// Lower bound of the distance of two parts at the look, m, and of its rate from then on, m/s.
  struct Separation {
    float distance = 0.0f, rate = 0.0f;
    [[nodiscard]] float at(float time) const { return distance + time * rate; }
    [[nodiscard]] float leastUntil(float time) const { return std::min(distance, at(time)); }
  };
  struct Pair {
    Index first = 0, second = 0;  ///< patches
    Separation separation;
  };

  /// @param apart  m: triangles that lie within that at rest are one piece of tissue
  /// @param near   m: nothing that is farther apart is asked for
  SkinForecast(MovingSkin &skin, double apart, double near);

  /// Whether the list serves for the step that the skin is about to go (MovingSkin::move()).
  [[nodiscard]] bool serves();
  /// Lists anew for that step, and for some that follow.
  void look();
  void forget() { placeThen_.clear(); }
  [[nodiscard]] const std::vector<Pair> &pairs() const { return pairs_; }
  /// Whether a pair may come nearer than near in that step, or in twice as long; after serves() or look().
  [[nodiscard]] bool mayMeet(const Pair &pair) const {
    return std::min(pair.separation.at(begin_), pair.separation.at(end_)) - deviation_ <= near_;
  }
  /// Whether any does, with the velocities of now. It follows from the state alone, whatever was looked at before.
  [[nodiscard]] bool meets() const {
    return std::any_of(pairs_.begin(), pairs_.end(),
                       [this](const Pair &pair) { return mayMeet(pair) && isNear(pair); });
  }
  /// Of the list: another one, another number.
  [[nodiscard]] std::uint64_t number() const { return now_; }

 private:
  using Corner = Eigen::Array4f;  // the last component is 0
  struct Box {
    Corner low = Corner::Constant(1e30f), high = Corner::Constant(-1e30f);
    void add(const Corner &x) {
      low = low.min(x);
      high = high.max(x);
    }
    void add(const Box &other) {
      low = low.min(other.low);
      high = high.max(other.high);
    }
  };
  struct Motion {
    Box now, then, normals;  // then: at the horizon
  };
  // Around a triangle.
  struct Ball {
    Eigen::Vector3f middle = Eigen::Vector3f::Zero();
    float radius = 0.0f;  // m
    std::uint64_t seen = 0;
  };
  // How far vertices deviate from what was expected. Phyxels alone say several times as much as is so where light ones
  // swing about: now and then the vertices are asked, and phyxels say what has changed since.
  struct Deviation {
    std::vector<Vec3> ways, waysThen;  // [phyxels] m
    double mostThen = 0.0;             // m, of a vertex
    double measure(const ContactSkin &skin);
  };
  // Where a patch faces: unit.
  struct Facings {
    std::array<Eigen::Vector3f, 6> normals{};
    std::size_t count = 0;
    bool isComplete = true;  // otherwise there are more
    std::uint64_t seen = 0;
    [[nodiscard]] std::span<const Eigen::Vector3f> known() const { return std::span(normals).first(count); }
  };

  void refit(float horizon);
  void findRings();
  void updateNormals(float horizon);
  void addPatch(Index patch, float horizon, Motion &node) const;
  [[nodiscard]] bool mayFace(Index a, Index b) const;
  [[nodiscard]] bool mayComeNear(Index a, Index b) const;
  void compare(Index a, Index b, float horizon);
  [[nodiscard]] bool areOnePiece(Index triangle, Index other) const;
  [[nodiscard]] bool isNear(const Pair &pair) const;
  [[nodiscard]] const Ball &ballOf(Index triangle);
  template <class Corners>
  [[nodiscard]] Separation along(const Eigen::Vector3f &direction, const Corners &first, const Corners &second) const;
  [[nodiscard]] bool faces(Index a, Index b, float horizon);
  [[nodiscard]] Eigen::Vector3f middleOf(Index patch) const;
  [[nodiscard]] Separation separationOf(Index a, Index b, float horizon);
  [[nodiscard]] const Facings &facingsOf(Index patch);

  MovingSkin &skin_;
  double apart_;
  float near_, listed_;                               // m: pairs that come nearer than listed_ are listed
  std::vector<Motion> nodes_;                         // of the tree
  std::vector<Index> nodeOf_;                         // [patches]
  std::vector<std::pair<Index, Index>> open_;         // room for look()
  std::vector<Eigen::Vector3f> places_, velocities_;  // [vertices] m, m/s, seen from their mean
  Csr rings_;                                         // [patches] triangles at its corners
  std::array<std::vector<Corner>, 2> normals_;        // [triangles] unit
  std::vector<Facings> facings_;                      // [patches]
  std::vector<Ball> balls_, restBalls_;               // [triangles]
  std::uint64_t now_ = 0;
  std::vector<Pair> pairs_;
  // [phyxels] at the look, relative to the mean: m, m/s; and at the step before: m/s.
  std::vector<Vec3> placeThen_, velocityThen_, velocityBefore_;
  Vec3 meanBefore_ = Vec3::Zero();                       // m/s, of the carriers
  std::array<Deviation, 2> deviations_;                  // now, and at the end of the step
  double horizon_ = 0.0, steps_, velocityChange_ = 0.0;  // s; steps to look ahead; m/s, in the last step
  std::size_t served_ = 0;                               // steps since the look
  float begin_ = 0.0f, end_ = 0.0f, deviation_ = 0.0f;   // of this step: s since the look; m, of two vertices
};

}  // namespace pointbased::detail
