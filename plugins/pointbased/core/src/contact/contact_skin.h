// SPDX-License-Identifier: Apache-2.0
// Collision surface of a body for contact between skins. Private to the core.
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
  std::array<Index, 2> triangles{kNoTriangle, kNoTriangle};  ///< on both sides; the second may be missing
};

/// Size of the cells that carry each point: the spacing of the body divided by a power of two, m.
/// @param phyxels  rest positions, m
[[nodiscard]] std::vector<double> spacingsAt(const Interpolation &binding, std::span<const Vec3> phyxels,
                                             double spacing);

/// Collision mesh of a skin: the displayed triangles or a coarsened set, subdivided where they are larger than the
/// cells that carry them. Immutable.
struct ContactSkin {
  Interpolation vertices;
  std::vector<std::array<Index, 3>> triangles;
  std::vector<SkinEdge> edges;
  std::vector<std::array<Index, 3>> edgesOf;  ///< [triangles] edge k runs from corner k to the next
  Csr trianglesOf;                            ///< [vertices]
  std::vector<double> areas;                  ///< [vertices] m², at rest; 0: vertex of no triangle
  std::vector<Index> carriers;                ///< phyxels that carry vertices, ascending; others do not move the skin
  /// Upper bounds of the displacement of any vertex, as factors of the displacements of the phyxels. `weightedGain`:
  /// no phyxel moves by more than 1 / its largest influence. `plainGain`: no phyxel moves by more than 1.
  double weightedGain = 1.0, plainGain = 1.0;

  [[nodiscard]] std::size_t count() const { return vertices.count(); }
};

/// Upper bound of the displacement of the vertices, from the displacements of the phyxels that carry them.
class TravelBound {
 public:
  /// @param maxInfluence  RestState::maxInfluence; empty: 1
  explicit TravelBound(std::span<const float> maxInfluence) : maxInfluence_(maxInfluence) {}
  void add(std::size_t phyxel, const Vec3 &displacement) {
    const double influence = maxInfluence_.empty() ? 1.0 : static_cast<double>(maxInfluence_[phyxel]);
    const double squared = displacement.squaredNorm();
    squared_ = std::max(squared_, squared);
    weighted_ = std::max(weighted_, influence * influence * squared);
  }
  [[nodiscard]] double ofPhyxels() const { return std::sqrt(squared_); }
  [[nodiscard]] double ofVertices(const ContactSkin &skin) const {
    if (!(squared_ > 0.0)) return 0.0;  // weightedGain may be infinite
    return std::min(skin.weightedGain * std::sqrt(weighted_), skin.plainGain * std::sqrt(squared_));
  }

 private:
  std::span<const float> maxInfluence_;
  double squared_ = 0.0, weighted_ = 0.0;
};

/// @param vertices  vertices of `triangles`, bound to phyxels
/// @param bind  binds the added points to phyxels
/// @param maxInfluence  [phyxels]; empty: 1
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
  [[nodiscard]] bool overlaps(const SkinBox &other) const {
    return (low.array() <= other.high.array()).all() && (other.low.array() <= high.array()).all();
  }
  [[nodiscard]] double squaredDistance(const Vec3 &x) const {
    return (low - x).cwiseMax(x - high).cwiseMax(0.0).squaredNorm();
  }
  [[nodiscard]] double squaredDistance(const SkinBox &other) const {
    return (low - other.high).cwiseMax(other.low - high).cwiseMax(0.0).squaredNorm();
  }
  /// Squared distance of the two points, one in each box, that are farthest from each other.
  [[nodiscard]] double maxSquaredDistance(const SkinBox &other) const {
    return (high - other.low).cwiseMax(other.high - low).squaredNorm();
  }
  [[nodiscard]] SkinBox expanded(double by) const { return {low.array() - by, high.array() + by}; }
};

/// Bounding volume hierarchy of a skin: a binary tree of boxes over patches of a few triangles, refitted as they move.
class PatchTree {
 public:
  explicit PatchTree(const ContactSkin &skin);
  void refit(std::span<const Vec3> positions);

  struct Patch {
    std::vector<Index> triangles, corners;
    std::vector<Index> vertices, edges;  ///< those that belong to no earlier patch
  };
  [[nodiscard]] const std::vector<Patch> &patches() const { return patches_; }
  static constexpr Index kNone = 0xffffffffu;
  struct Node {
    SkinBox box, rest;
    Index child = 0;      ///< the second child is child + 1
    Index patch = kNone;  ///< of a leaf; kNone: an inner node
    Index size = 0;       ///< number of triangles in the subtree
  };
  /// Children are stored behind their parents.
  [[nodiscard]] const std::vector<Node> &nodes() const { return nodes_; }
  [[nodiscard]] const SkinBox &bounds() const { return nodes_.front().box; }

  /// Calls visit(patch of this, patch of the other, squared distance of their boxes) for all pairs of patches whose
  /// boxes are nearer to each other than `reach`.
  /// @param open  scratch storage: pairs of nodes still to be visited
  template <class Visit>
  void visitPairsWithin(const PatchTree &other, double reach, std::vector<std::pair<Index, Index>> &open,
                        const Visit &visit) const {
    open.assign(1, {0, 0});
    while (!open.empty()) {
      const auto [a, b] = open.back();
      open.pop_back();
      const Node &own = nodes_[a], &others = other.nodes_[b];
      const double squared = own.box.squaredDistance(others.box);
      if (!(squared <= reach * reach)) continue;
      if (own.patch != kNone && others.patch != kNone)
        visit(own.patch, others.patch, squared);
      else if (others.patch != kNone || (own.patch == kNone && own.size >= others.size))
        for (const Index child : {own.child, own.child + 1}) open.emplace_back(child, b);
      else
        for (const Index child : {others.child, others.child + 1}) open.emplace_back(a, child);
    }
  }
  /// Calls visit(triangle), which returns the squared distance of that triangle from x, for every triangle that may be
  /// nearest to x. Nodes with the nearer box are visited first.
  template <class Visit>
  void nearest(const Vec3 &x, const Visit &visit) const {
    double nearest = std::numeric_limits<double>::infinity();
    std::array<std::pair<Index, double>, 64> stack;
    std::size_t depth = 0;
    stack[depth++] = {0, nodes_.front().box.squaredDistance(x)};
    while (depth > 0) {
      const auto [at, squared] = stack[--depth];
      if (!(squared < nearest)) continue;
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

/// The point of a triangle that is nearest to a given point.
struct NearestOnTriangle {
  Vec3 weights = Vec3::Zero();  ///< barycentric
  double squared = 0.0;         ///< m²
  /// 0: within the face; 1 … 3: on the edge from corner k - 1 to the next; 4 … 6: at corner k - 4
  int feature = 0;
};
/// @source  Ericson, Real-Time Collision Detection, 2005, ch. 5.1.5
[[nodiscard]] NearestOnTriangle nearestOnTriangle(const Vec3 &p, const Vec3 &a, const Vec3 &b, const Vec3 &c);

/// A skin at its current positions, moved by its phyxels. Positions, velocities and boxes are computed on demand, once
/// per state.
/// @threads  one
class MovingSkin {
 public:
  /// @param spacings  [vertices] size of the cells that carry them, m; empty: `spacing` for all
  MovingSkin(std::shared_ptr<const ContactSkin> skin, const Vec3 &origin, double spacing,
             std::vector<double> spacings = {});

  [[nodiscard]] const ContactSkin &skin() const { return *skin_; }
  [[nodiscard]] const PatchTree &tree() const { return tree_; }
  [[nodiscard]] double spacing() const { return spacing_; }
  [[nodiscard]] double spacingAt(Index v) const { return spacings_.empty() ? spacing_ : spacings_[v]; }
  /// Young's modulus under each vertex, Pa.
  void setModuli(std::vector<double> moduli) { moduli_ = std::move(moduli); }
  [[nodiscard]] double modulus(Index v) const { return moduli_[v]; }
  [[nodiscard]] bool hasModuli() const { return !moduli_.empty(); }

  /// Sets the state at the beginning of a step of dt. The spans must stay valid until the next call.
  /// @param maxInfluence  [phyxels]; empty: 1
  void move(std::span<const Vec3> displacements, std::span<const Vec3> velocities, std::span<const float> maxInfluence,
            double dt);
  /// Marks positions as outdated after the phyxels have moved within the same step.
  void invalidatePositions() { ++revision_; }
  /// Upper bound of the travel of any vertex in this step relative to the mean of the carriers, m. The mean itself
  /// travels meanStepTravel().
  [[nodiscard]] double stepTravel() const { return stepTravel_; }
  [[nodiscard]] const Vec3 &meanStepTravel() const { return meanStepTravel_; }
  [[nodiscard]] std::span<const Vec3> displacements() const { return displacements_; }
  [[nodiscard]] std::span<const Vec3> velocities() const { return velocities_; }
  [[nodiscard]] std::span<const float> maxInfluence() const { return maxInfluence_; }
  [[nodiscard]] double dt() const { return dt_; }
  /// Same as stepTravel(), computed from the vertices themselves: tighter but more expensive. Phyxels with almost no
  /// influence on the skin may be fast.
  [[nodiscard]] double stepTravelExact();
  /// Upper bound of the travel of any vertex since the phyxels had the displacements `reference`, relative to the mean of
  /// the carriers, m.
  /// @param mean  out: travel of the mean, m
  [[nodiscard]] double travelSince(std::span<const Vec3> reference, Vec3 &mean) const;

  [[nodiscard]] const Vec3 &position(Index v) {
    if (positionRevisions_[v] != revision_) computePosition(v);
    return positions_[v];
  }
  /// Velocity at the beginning of the step.
  [[nodiscard]] const Vec3 &velocity(Index v) {
    if (velocityRevisions_[v] != revision_) updateVelocity(v);
    return vertexVelocities_[v];
  }
  /// Whether the deformation at a vertex is inverted or has crushed the material to almost no volume.
  [[nodiscard]] bool isInverted(Index v);
  /// Bounds of the positions of the corners of a patch, and of their velocities.
  struct PatchMotion {
    SkinBox positions, velocities;
    std::uint64_t revision = 0;
  };
  [[nodiscard]] const PatchMotion &motionOf(Index patch);
  /// Two planes perpendicular to the mean normal of a patch that enclose all its corners.
  struct Slab {
    Vec3 normal = Vec3::Zero();    // unit
    double low = 0.0, high = 0.0;  // m, along the normal
    std::uint64_t revision = 0;
    /// Lower bound of the distance of a point from the patch, m. Where it is not positive there is no bound.
    [[nodiscard]] double distance(const Vec3 &x) const {
      const double along = normal.dot(x);
      return std::max(low - along, along - high);
    }
  };
  [[nodiscard]] const Slab &slabOf(Index patch);
  /// Same as Slab::distance(), for a patch of this skin.
  [[nodiscard]] double distance(Index patch, const Slab &slab);
  /// Boxes of the triangles of a patch, in their order, and of its sharp edges.
  struct PatchFeatures {
    std::vector<SkinBox> triangles;
    std::vector<std::pair<Index, SkinBox>> edges;
    std::uint64_t revision = 0;
    double minRise = 0.0;
  };
  /// An edge is sharp if it belongs to one triangle only. A convex edge is sharp if the sine of the angle between its
  /// face normals exceeds `sine`, or `rise` over the length of the edge, or if that angle is obtuse.
  /// @param rise  m
  [[nodiscard]] const PatchFeatures &featuresOf(Index patch, double minSine, double minRise);
  void updatePositions();
  /// Same, and refits the boxes of the tree.
  void refitTree();
  [[nodiscard]] std::span<const Vec3> positions() const { return positions_; }  ///< after updatePositions()

  /// Outward normals. The length of a face normal is twice the area of the triangle; edge and vertex normals are not
  /// normalised.
  [[nodiscard]] Vec3 faceNormal(Index triangle);
  [[nodiscard]] Vec3 edgeNormal(Index edge);
  [[nodiscard]] Vec3 vertexNormal(Index vertex);
  /// Area-weighted mean normal of the faces around a vertex, unit.
  [[nodiscard]] Vec3 areaWeightedNormal(Index vertex);
  /// Outward normal of the feature that NearestOnTriangle::feature names. Its sign separates inside from outside for
  /// points whose nearest point is on that feature.
  [[nodiscard]] Vec3 featureNormal(Index triangle, int feature);
  [[nodiscard]] NearestOnTriangle nearestOn(Index triangle, const Vec3 &x);
  [[nodiscard]] Vec3 pointOn(Index triangle, const Vec3 &weights);

  /// The triangle nearest to a point; of several, the one with the lowest number. After refitTree().
  [[nodiscard]] Index nearestTriangle(const Vec3 &x);
  [[nodiscard]] Vec3 nearestPoint(const Vec3 &x);
  /// m, negative inside. After refitTree().
  [[nodiscard]] double signedDistance(const Vec3 &x);

 private:
  void computePosition(Index v);
  void updateVelocity(Index v);
  [[nodiscard]] bool isSharp(Index edge, double minSine, double minRise);
  // Smallest and largest coordinate of the corners of a patch along a direction, m.
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
  std::vector<std::uint64_t> positionRevisions_, velocityRevisions_;
  std::vector<std::uint64_t> inversionRevisions_;  // [vertices] or empty; 2 × state number, + 1 if inverted
  std::vector<PatchMotion> motions_;               // [patches]
  std::vector<PatchFeatures> features_;            // [patches]
  std::vector<Slab> slabs_;                        // [patches]
  std::uint64_t revision_ = 1, treeRevision_ = 0;
  double stepTravel_ = 0.0, stepTravelExact_ = -1.0, dt_ = 0.0;
  Vec3 meanStepTravel_ = Vec3::Zero();
};

/// Parameters of the nearest points of two segments, from a0 to a1 and from b0 to b1, clamped to 0 … 1.
/// @source  Ericson 2005, ch. 5.1.9
struct NearestOfSegments {
  double onFirst = 0.0, onSecond = 0.0;
};
[[nodiscard]] NearestOfSegments nearestOfSegments(const Vec3 &a0, const Vec3 &a1, const Vec3 &b0, const Vec3 &b1);

}  // namespace pointbased::detail
