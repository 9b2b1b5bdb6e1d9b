// SPDX-License-Identifier: Apache-2.0
// Predicts which parts of a skin may touch each other in the next steps. Private to the core.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "contact/contact_skin.h"

namespace pointbased::detail {

/// Spacings: parts of one skin that are farther apart cannot touch within a step. Larger: more candidates.
inline constexpr double kSelfContactReach = 0.13;

/// Candidate pairs for self-contact of a skin, for several steps at once: patches that come near each other within a
/// horizon if every vertex keeps its velocity. The list is valid until vertices have deviated from this prediction so
/// far that other patches may meet.
/// @threads  one
class SkinForecast {
 public:
  /// Linear lower bound of the distance of two parts: distance when the list was built, m, and its rate from then on,
  /// m/s.
  struct Separation {
    float distance = 0.0f, rate = 0.0f;
    [[nodiscard]] float at(float time) const { return distance + time * rate; }
    [[nodiscard]] float leastUntil(float time) const { return std::min(distance, at(time)); }
  };
  struct Pair {
    Index first = 0, second = 0;  ///< patches
    Separation separation;
  };

  /// @param sameTissueDistance  triangles within this distance at rest are the same tissue and never collide, m
  /// @param reach  search distance, m
  SkinForecast(MovingSkin &skin, double sameTissueDistance, double reach);

  /// Whether the list is valid for the coming step, as set by MovingSkin::move().
  [[nodiscard]] bool isStillValid();
  /// Builds the list for the coming step and for some steps after it.
  void rebuild();
  void invalidate() { listDisplacements_.clear(); }
  [[nodiscard]] const std::vector<Pair> &pairs() const { return pairs_; }
  /// Whether a pair may come nearer than `reach` within two steps. After isStillValid() or rebuild().
  [[nodiscard]] bool mayTouch(const Pair &pair) const {
    return std::min(pair.separation.at(begin_), pair.separation.at(end_)) - deviation_ <= reach_;
  }
  /// Whether any pair does with the current velocities. The result depends on the state alone, not on when the list was
  /// built.
  [[nodiscard]] bool predictsContact() const {
    return std::any_of(pairs_.begin(), pairs_.end(),
                       [this](const Pair &pair) { return mayTouch(pair) && isWithinReach(pair); });
  }
  /// Number of the list: increases whenever it is rebuilt.
  [[nodiscard]] std::uint64_t revision() const { return revision_; }

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
    Box now, atHorizon, normals;  // atHorizon: after the horizon
  };
  // Bounding sphere of a triangle.
  struct BoundingSphere {
    Eigen::Vector3f centre = Eigen::Vector3f::Zero();
    float radius = 0.0f;  // m
    std::uint64_t revision = 0;
  };
  // Deviation of the vertices from the prediction. The bound from phyxels alone is several times too large where light
  // phyxels oscillate. Occasionally the vertices themselves are measured; from then on, phyxels bound the change.
  struct Deviation {
    std::vector<Vec3> current, measured;  // m, [phyxels]; measured: at the last measurement
    double measuredMax = 0.0;             // m, largest of a vertex at the last measurement
    double measure(const ContactSkin &skin);
  };
  // Directions in which a patch faces, unit.
  struct FaceDirections {
    std::array<Eigen::Vector3f, 6> normals{};
    std::size_t count = 0;
    bool isComplete = true;  // false: the patch has more directions than fit
    std::uint64_t revision = 0;
    [[nodiscard]] std::span<const Eigen::Vector3f> directions() const { return std::span(normals).first(count); }
  };

  void refit(float horizon);
  void findRings();
  void updateNormals(float horizon);
  void addPatch(Index patch, float horizon, Motion &node) const;
  [[nodiscard]] bool mayFace(Index a, Index b) const;
  [[nodiscard]] bool mayComeNear(Index a, Index b) const;
  void addPairIfNear(Index a, Index b, float horizon);
  [[nodiscard]] bool areSameTissue(Index triangle, Index other) const;
  [[nodiscard]] bool isWithinReach(const Pair &pair) const;
  [[nodiscard]] const BoundingSphere &boundingSphereOf(Index triangle);
  template <class Corners>
  [[nodiscard]] Separation separationAlong(const Eigen::Vector3f &direction, const Corners &first,
                                           const Corners &second) const;
  [[nodiscard]] bool facesPatch(Index a, Index b, float horizon);
  [[nodiscard]] Eigen::Vector3f centreOf(Index patch) const;
  [[nodiscard]] Separation separationOf(Index a, Index b, float horizon);
  [[nodiscard]] const FaceDirections &faceDirectionsOf(Index patch);

  MovingSkin &skin_;
  double sameTissueDistance_;
  float reach_, listReach_;                              // m: pairs that come nearer than listReach_ are listed
  std::vector<Motion> nodes_;                            // of the tree
  std::vector<Index> nodeOf_;                            // [patches]
  std::vector<std::pair<Index, Index>> traversalStack_;  // scratch storage of rebuild()
  std::vector<Eigen::Vector3f> positions_, velocities_;  // [vertices] m, m/s, relative to their mean
  Csr rings_;                                            // [patches] triangles adjacent to its corners
  std::array<std::vector<Corner>, 2> normals_;           // [triangles] unit
  std::vector<FaceDirections> faceDirections_;           // [patches]
  std::vector<BoundingSphere> spheres_, restSpheres_;    // [triangles]
  std::uint64_t revision_ = 0;
  std::vector<Pair> pairs_;
  // [phyxels] when the list was built, relative to the mean of the carriers, m and m/s; velocities one step before,
  // m/s.
  std::vector<Vec3> listDisplacements_, listVelocities_, lastVelocities_;
  Vec3 lastMeanVelocity_ = Vec3::Zero();                 // m/s, of the carriers
  std::array<Deviation, 2> deviations_;                  // now, and at the end of the step
  double horizon_ = 0.0, steps_, velocityChange_ = 0.0;  // s; steps to look ahead; m/s, in the last step
  std::size_t validSteps_ = 0;                           // steps since the list was built
  float begin_ = 0.0f, end_ = 0.0f, deviation_ = 0.0f;   // of this step, s since the list was built; m, two vertices
};

}  // namespace pointbased::detail
