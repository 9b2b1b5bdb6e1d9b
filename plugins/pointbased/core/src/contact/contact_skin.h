// SPDX-License-Identifier: Apache-2.0
// The skin of a body as other skins touch it. Private to the core.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "contact/skin_surface.h"
#include "pointbased/interpolation.h"
#include "pointbased/supports.h"

namespace pointbased::detail {

inline constexpr Index kNoTriangle = 0xffffffffu;

struct SkinEdge {
  std::array<Index, 2> ends{};
  std::array<Index, 2> triangles{kNoTriangle, kNoTriangle};  ///< on either side; the second may be missing
};

/// m, of the cells that carry points, in halvings of that of the body.
/// @param phyxels  m, at rest
[[nodiscard]] std::vector<double> spacingsAt(const Interpolation &binding, std::span<const Vec3> phyxels,
                                             double spacing);

/// Vertices, edges and triangles between which contact of skins is looked for: those that are drawn, or fewer, divided
/// where they are larger than the cells that carry them. Const.
struct ContactSkin {
  Interpolation vertices;
  std::vector<std::array<Index, 3>> triangles;
  std::vector<SkinEdge> edges;
  std::vector<std::array<Index, 3>> edgesOf;  ///< [triangles] edge k leads from corner k to the next
  Csr trianglesOf;                            ///< [vertices]
  std::vector<double> areas;                  ///< [vertices] m², at rest; 0: no corner of a triangle
  std::vector<Index> carriers;                ///< phyxels that carry vertices, ascending: others do not move the skin
  /// The farthest a vertex goes where no phyxel goes farther than one over its largest influence, and where none goes
  /// farther than one.
  double gain = 1.0, sum = 1.0;

  [[nodiscard]] std::size_t count() const { return vertices.count(); }
};

/// How far vertices go at most, by the ways of the phyxels that carry them.
class FarthestWay {
 public:
  /// @param maxInfluence  RestState::maxInfluence; empty: 1
  explicit FarthestWay(std::span<const float> maxInfluence) : maxInfluence_(maxInfluence) {}
  void add(std::size_t phyxel, const Vec3 &way) {
    const double influence = maxInfluence_.empty() ? 1.0 : static_cast<double>(maxInfluence_[phyxel]);
    const double squared = way.squaredNorm();
    squared_ = std::max(squared_, squared);
    weighted_ = std::max(weighted_, influence * influence * squared);
  }
  [[nodiscard]] double ofPhyxels() const { return std::sqrt(squared_); }
  [[nodiscard]] double ofVertices(const ContactSkin &skin) const {
    if (!(squared_ > 0.0)) return 0.0;  // a gain may be infinite
    return std::min(skin.gain * std::sqrt(weighted_), skin.sum * std::sqrt(squared_));
  }

 private:
  std::span<const float> maxInfluence_;
  double squared_ = 0.0, weighted_ = 0.0;
};

/// @param vertices      as phyxels carry those of `triangles`
/// @param bind          carries the points that are added
/// @param maxInfluence  [phyxels], or empty: 1
[[nodiscard]] std::shared_ptr<const ContactSkin> makeContactSkin(Interpolation vertices,
                                                                 std::vector<std::array<Index, 3>> triangles,
                                                                 const SkinResolution &resolution, const Binder &bind,
                                                                 std::span<const float> maxInfluence);

struct SkinBox {
  Vec3 low = Vec3::Constant(1e300), high = Vec3::Constant(-1e300);
  void add(const Vec3 &x) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  void add(const SkinBox &other) {
    low = low.cwiseMin(other.low);
    high = high.cwiseMax(other.high);
  }
  [[nodiscard]] bool meets(const SkinBox &other) const {
    return (low.array() <= other.high.array()).all() && (other.low.array() <= high.array()).all();
  }
  [[nodiscard]] double squaredDistance(const Vec3 &x) const {
    return (low - x).cwiseMax(x - high).cwiseMax(0.0).squaredNorm();
  }
  [[nodiscard]] double squaredDistance(const SkinBox &other) const {
    return (low - other.high).cwiseMax(other.low - high).cwiseMax(0.0).squaredNorm();
  }
  /// Of the two points of both that are farthest from each other.
  [[nodiscard]] double squaredFarthest(const SkinBox &other) const {
    return (high - other.low).cwiseMax(other.high - low).squaredNorm();
  }
  [[nodiscard]] SkinBox wider(double by) const { return {low.array() - by, high.array() + by}; }
};

/// The triangles of a skin in patches of a few, in a binary tree of boxes that is refitted as they move.
class PatchTree {
 public:
  explicit PatchTree(const ContactSkin &skin);
  void refit(std::span<const Vec3> positions);

  struct Patch {
    std::vector<Index> triangles, corners;
    std::vector<Index> vertices, edges;  ///< those that are no other patch's
  };
  [[nodiscard]] const std::vector<Patch> &patches() const { return patches_; }
  static constexpr Index kNone = 0xffffffffu;
  struct Node {
    SkinBox box, rest;
    Index child = 0;      ///< the other one behind it
    Index patch = kNone;  ///< of a leaf
    Index size = 0;       ///< triangles below it
  };
  /// Children behind their parents.
  [[nodiscard]] const std::vector<Node> &nodes() const { return nodes_; }
  [[nodiscard]] const SkinBox &bounds() const { return nodes_.front().box; }

  /// visit(patch of this, patch of the other, squared distance of their boxes) for those whose boxes are nearer to each
  /// other than `reach`.
  /// @param open   room for what is still to be looked at
  template <class Visit>
  void near(const PatchTree &other, double reach, std::vector<std::pair<Index, Index>> &open,
            const Visit &visit) const {
    open.assign(1, {0, 0});
    while (!open.empty()) {
      const auto [a, b] = open.back();
      open.pop_back();
      const Node &mine = nodes_[a], &theirs = other.nodes_[b];
      const double squared = mine.box.squaredDistance(theirs.box);
      if (!(squared <= reach * reach)) continue;
      if (mine.patch != kNone && theirs.patch != kNone)
        visit(mine.patch, theirs.patch, squared);
      else if (theirs.patch != kNone || (mine.patch == kNone && mine.size >= theirs.size))
        for (const Index child : {mine.child, mine.child + 1}) open.emplace_back(child, b);
      else
        for (const Index child : {theirs.child, theirs.child + 1}) open.emplace_back(a, child);
    }
  }
  /// visit(triangle) -> squared distance from x of that triangle, for those that may be nearest to x; the nearest
  /// first, as far as boxes tell.
  template <class Visit>
  void nearest(const Vec3 &x, const Visit &visit) const {
    double nearest = std::numeric_limits<double>::infinity();
    std::array<std::pair<Index, double>, 64> stack;
    std::size_t depth = 0;
    stack[depth++] = {0, nodes_.front().box.squaredDistance(x)};
    while (depth > 0) {
      const auto [at, away] = stack[--depth];
      if (!(away < nearest)) continue;
      const Node &node = nodes_[at];
      if (node.patch != kNone) {
        for (const Index t : patches_[node.patch].triangles) nearest = std::min(nearest, visit(t));
        continue;
      }
      const double left = nodes_[node.child].box.squaredDistance(x),
                   right = nodes_[node.child + 1].box.squaredDistance(x);
      const bool leftFirst = left <= right;
      stack[depth++] = leftFirst ? std::pair(node.child + 1, right) : std::pair(node.child, left);
      stack[depth++] = leftFirst ? std::pair(node.child, left) : std::pair(node.child + 1, right);
    }
  }

 private:
  std::vector<Node> nodes_;
  std::vector<Patch> patches_;
};

/// Where a point is nearest to a triangle.
struct NearestOnTriangle {
  Vec3 weights = Vec3::Zero();  ///< of the corners
  double squared = 0.0;         ///< m²
  /// 0: within the face; 1 … 3: on the edge from corner k - 1 to the next; 4 … 6: at corner k - 4
  int feature = 0;
};
/// @source  Ericson, Real-Time Collision Detection, 2005, ch. 5.1.5
[[nodiscard]] NearestOnTriangle nearestOnTriangle(const Vec3 &p, const Vec3 &a, const Vec3 &b, const Vec3 &c);

/// A skin where its phyxels have carried it. What is asked for is worked out once per state.
/// @threads one
class MovingSkin {
 public:
  /// @param spacings  [vertices] m, of the cells that carry them; empty: all are `spacing`
  MovingSkin(std::shared_ptr<const ContactSkin> skin, const Vec3 &origin, double spacing,
             std::vector<double> spacings = {});

  [[nodiscard]] const ContactSkin &skin() const { return *skin_; }
  [[nodiscard]] const PatchTree &tree() const { return tree_; }
  [[nodiscard]] double spacing() const { return spacing_; }
  [[nodiscard]] double spacingAt(Index v) const { return spacings_.empty() ? spacing_ : spacings_[v]; }
  /// Pa, Young's modulus under each vertex.
  void setModuli(std::vector<double> moduli) { moduli_ = std::move(moduli); }
  [[nodiscard]] double modulus(Index v) const { return moduli_[v]; }
  [[nodiscard]] bool hasModuli() const { return !moduli_.empty(); }

  /// The state at the beginning of a step of dt. The spans stay as they are until the next call.
  /// @param maxInfluence  [phyxels], or empty: 1
  void move(std::span<const Vec3> displacements, std::span<const Vec3> velocities, std::span<const float> maxInfluence,
            double dt);
  /// The same step, after the phyxels have moved.
  void moveOn() { ++now_; }
  /// m: no vertex goes farther in this step, seen from the mean of the phyxels that carry the skin, which goes
  /// meanGoes().
  [[nodiscard]] double goes() const { return goes_; }
  [[nodiscard]] const Vec3 &meanGoes() const { return meanGoes_; }
  [[nodiscard]] std::span<const Vec3> displacements() const { return displacements_; }
  [[nodiscard]] std::span<const Vec3> velocities() const { return velocities_; }
  [[nodiscard]] std::span<const float> maxInfluence() const { return maxInfluence_; }
  [[nodiscard]] double dt() const { return dt_; }
  /// As goes(), from the vertices themselves, which costs more. Phyxels that carry next to nothing may be fast.
  [[nodiscard]] double goesExactly();
  /// m: how far vertices have gone at most since phyxels had other displacements, seen from the mean of their carriers.
  /// @param mean  out: m, how far that has gone
  [[nodiscard]] double wentSince(std::span<const Vec3> then, Vec3 &mean) const;

  [[nodiscard]] const Vec3 &position(Index v) {
    if (seen_[v] != now_) place(v);
    return positions_[v];
  }
  /// That of the step.
  [[nodiscard]] const Vec3 &velocity(Index v) {
    if (velocitiesSeen_[v] != now_) takeVelocity(v);
    return vertexVelocities_[v];
  }
  /// Whether the tissue at a vertex is turned inside out, or crushed to next to nothing.
  [[nodiscard]] bool isInverted(Index v);
  /// Around the corners of a patch, and around their velocities.
  struct PatchMotion {
    SkinBox places, velocities;
    std::uint64_t seen = 0;
  };
  [[nodiscard]] const PatchMotion &motionOf(Index patch);
  /// Two planes across the mean normal of a patch, between which all its corners lie.
  struct Slab {
    Vec3 normal = Vec3::Zero();    // unit
    double low = 0.0, high = 0.0;  // m, along it
    std::uint64_t seen = 0;
    /// m, at least, from a point to the patch; not positive: it may be anywhere.
    [[nodiscard]] double distance(const Vec3 &x) const {
      const double along = normal.dot(x);
      return std::max(low - along, along - high);
    }
  };
  [[nodiscard]] const Slab &slabOf(Index patch);
  /// The same from a patch of this skin.
  [[nodiscard]] double distance(Index patch, const Slab &slab);
  /// Boxes of its triangles, in their order, and of those of its edges that are sharp.
  struct PatchParts {
    std::vector<SkinBox> triangles;
    std::vector<std::pair<Index, SkinBox>> edges;
    std::uint64_t seen = 0;
    double rise = 0.0;
  };
  /// @param sine, rise  an edge is sharp that stands out between its faces by an angle of this sine, or by so much of
  ///                    its length, m
  [[nodiscard]] const PatchParts &partsOf(Index patch, double sine, double rise);
  void placeVertices();
  /// The boxes around the triangles as well.
  void placeAll();
  [[nodiscard]] std::span<const Vec3> positions() const { return positions_; }  ///< after placeVertices()

  /// Outward normals: of a triangle twice its area long, of edges and vertices not normalised.
  [[nodiscard]] Vec3 faceNormal(Index triangle);
  [[nodiscard]] Vec3 edgeNormal(Index edge);
  [[nodiscard]] Vec3 vertexNormal(Index vertex);
  /// Unit: about where the skin around a vertex faces.
  [[nodiscard]] Vec3 facing(Index vertex);
  /// That of the part of a triangle that NearestOnTriangle::feature names: on its side lies what is nearest to it.
  [[nodiscard]] Vec3 outwardAt(Index triangle, int feature);
  [[nodiscard]] NearestOnTriangle nearestOn(Index triangle, const Vec3 &x);
  [[nodiscard]] Vec3 placeOn(Index triangle, const Vec3 &weights);

  /// The triangle that is nearest to a point; the first of several. After placeAll().
  [[nodiscard]] Index nearestTriangle(const Vec3 &x);
  [[nodiscard]] Vec3 nearestPlace(const Vec3 &x);
  /// m, negative inside. After placeAll().
  [[nodiscard]] double signedDistance(const Vec3 &x);

 private:
  void place(Index v);
  void takeVelocity(Index v);
  [[nodiscard]] bool isSharp(Index edge, double sine, double rise);
  // m, along a direction, of the corners of a patch: least and largest.
  [[nodiscard]] std::pair<double, double> extentOf(Index patch, const Vec3 &direction);
  std::shared_ptr<const ContactSkin> skin_;
  PatchTree tree_;
  Vec3 origin_;
  double spacing_;
  std::vector<double> spacings_;
  std::vector<double> moduli_;
  std::span<const Vec3> displacements_, velocities_;
  std::span<const float> maxInfluence_;
  std::vector<Vec3> positions_, vertexVelocities_;
  std::vector<std::uint64_t> seen_, velocitiesSeen_;
  std::vector<std::uint64_t> invertedSeen_;  // [vertices], or empty; twice the state it is of, and one more if it is
  std::vector<PatchMotion> motions_;         // [patches]
  std::vector<PatchParts> parts_;            // [patches]
  std::vector<Slab> slabs_;                  // [patches]
  std::uint64_t now_ = 1, treeOf_ = 0;
  double goes_ = 0.0, goesExactly_ = -1.0, dt_ = 0.0;
  Vec3 meanGoes_ = Vec3::Zero();
};

/// Where two segments are nearest to each other: parts of the way from a0 to a1 and from b0 to b1, clamped to 0 … 1.
/// @source  Ericson 2005, ch. 5.1.9
struct NearestOfSegments {
  double onFirst = 0.0, onSecond = 0.0;
};
[[nodiscard]] NearestOfSegments nearestOfSegments(const Vec3 &a0, const Vec3 &a1, const Vec3 &b0, const Vec3 &b1);

}  // namespace pointbased::detail
