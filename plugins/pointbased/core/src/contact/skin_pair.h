// SPDX-License-Identifier: Apache-2.0
// Contact between two skins, or of a skin with itself. Private to the core.
#pragma once

#include <algorithm>
#include <optional>
#include <utility>

#include "contact/skin_forecast.h"
#include "pointbased/contact.h"

namespace pointbased::detail {

/// Unilateral constraint between a point of one skin and a point of the other within a step: vertex against face, or
/// edge against edge. `gap` is the remaining distance between the skins.
struct SkinContact : Contact {
  std::uint64_t key = 0;  ///< identifies the two features, ascending within a pair
  /// Vertices of both skins; their weighted sum is the displacement of the first point relative to the second.
  struct Part {
    Index vertex = 0;
    bool ofSecond = false;
    double weight = 0.0;
  };
  std::array<Part, 4> parts{};
  /// State when the contact was found, for contacts that are reused in later steps (SkinPair::isStillValid()): gap, m,
  /// and displacement of the first point relative to the second from the displacements of the phyxels. Empty before
  /// JointContact::gather().
  struct SearchState {
    double gap = 0.0;
    Vec3 displacement = Vec3::Zero();
  };
  std::optional<SearchState> atSearch;
  [[nodiscard]] bool isOfEdges() const { return key >> 62 == 2; }
};

struct SkinPairSettings {
  double friction = 0.3;
  double offset = 0.0;               ///< m, distance below which a layer between the skins resists
  double thickness = 0.0;            ///< m, of that layer: its largest compression
  double stiffness = 0.0;            ///< of the layer, as a multiple of modulus / spacing of the softer body, Pa/m
  double margin = 0.0;               ///< m: contacts closer than this count as active even when nothing moves
  double recoverySpeed = 0.0;        ///< m/s, largest speed at which initial overlap is reduced; 0: it remains
  double recoveryCompression = 0.0;  ///< m, compression of the layer that this may cause
  /// m, for a skin with itself: parts within this distance at rest are the same tissue and never collide
  double sameTissueDistance = 0.0;
  double minReach = 0.0;  ///< m: least search distance of the candidate list, however slow the skins are
};

/// Finds the contacts of two moving skins in three stages. A broad phase lists pairs of patches within reach of each
/// other; a list is reused over several steps. A second stage gathers candidate pairs of vertices and faces, and of
/// edges, in every step, or for several steps where little moves. The narrow phase tests these candidates. The contacts
/// found do not depend on when the lists were built.
///
/// Contacts are the local minima of the distance between the skins only: a vertex above the interior of a face, or
/// outside an edge or a corner that is its nearest feature, and two edges whose shortest connection leaves both skins.
/// If none of these distances is negative, no triangles intersect.
/// @threads  one
class SkinPair {
 public:
  /// @param second  the same object as `first` for a skin with itself
  SkinPair(MovingSkin &first, MovingSkin &second, const SkinPairSettings &settings);

  [[nodiscard]] const SkinPairSettings &settings() const { return settings_; }
  [[nodiscard]] double spacing() const { return spacing_; }  ///< m, of the finer skin
  [[nodiscard]] const ContactSkin &skin(std::size_t side) const { return skins_[side].skin->skin(); }
  [[nodiscard]] MovingSkin &moving(std::size_t side) { return *skins_[side].skin; }
  void setFriction(double friction) {
    if (std::exchange(settings_.friction, friction) != friction) invalidateSearch();
  }
  void setRecoverySpeed(double recoverySpeed) { settings_.recoverySpeed = recoverySpeed; }
  enum class StepKind {
    explicitStep,  ///< explicit: neighbouring features remain neighbours within a step
    implicitStep,  ///< implicit: motion is swept to the first crossing
    quasiStatic,   ///< quasi-static: swept as well; initial overlap is removed at once
  };
  void setStepKind(StepKind kind) { stepKind_ = kind; }
  /// For a skin with itself: whether it may touch itself in the coming step, as set by MovingSkin::move(). Empty: the
  /// forecast is outdated, call recomputePredictedContact().
  [[nodiscard]] std::optional<bool> predictedContact();
  /// Same as predictedContact(), but always from a new forecast of the whole skin.
  [[nodiscard]] bool recomputePredictedContact();
  /// Fills active() for a step of dt from the state set by MovingSkin::move(). Contacts that persist keep their
  /// impulses.
  /// @param isRepeat  repeats the same step: initial overlap is not reduced further
  void find(double dt, bool isRepeat = false);
  /// Whether the coming step can reuse the contacts of the last find(): neither skin moves so far that a contact
  /// outside active() could press. The caller has to update the gaps. After MovingSkin::move().
  [[nodiscard]] bool isStillValid() const;
  /// Invalidates the contacts of the last find() for further steps.
  void invalidateSearch() { validTravel_ = 0.0; }
  /// Updates position and normal of contacts with an impulse after the skins have moved
  /// (MovingSkin::invalidatePositions()), so that a further impulse between the two points has no torque. Gaps are not
  /// updated.
  void updateActive();
  [[nodiscard]] std::vector<SkinContact> &active() { return active_; }
  [[nodiscard]] const std::vector<SkinContact> &active() const { return active_; }
  /// State that the next step takes over from the last one.
  struct State {
    std::vector<SkinContact> active;
    std::array<std::vector<double>, 2> initialPenetrations;  // [sides][vertices] m, or empty
    std::array<std::vector<std::uint8_t>, 2> isInside;       // [sides][vertices]
    double toleratedOverlap = 0.0;
    std::array<std::vector<Vec3>, 2> displacementsAtSearch;  // [sides][phyxels] m, displacements
    double validTravel = 0.0;                                // m, remaining travel for which the contacts are valid
  };
  [[nodiscard]] State state() const {
    return {active_,
            {skins_[0].initialPenetration, skins_[1].initialPenetration},
            {skins_[0].isInside, skins_[1].isInside},
            toleratedOverlap_,
            sinceSearch_.reference,
            validTravel_};
  }
  void restore(const State &state);

  /// Impulse that the second skin exerts on the first, summed over some time.
  struct Sum {
    Vec3 impulse = Vec3::Zero();    ///< N s
    double normalImpulseSum = 0.0;  ///< N s, sum of the magnitudes of the normal impulses
    double duration = 0.0;          ///< s
  };
  [[nodiscard]] const Sum &sum() const { return sum_; }
  void beginSum() { sum_ = Sum(); }
  void setSum(const Sum &sum) { sum_ = sum; }
  /// Adds the contacts of a completed step of dt.
  void addToSum(double dt);
  /// Deepest overlap of the last find(), m; 0: none. Initial overlap is included only while it is being reduced.
  [[nodiscard]] double depth() const { return depth_; }
  /// Largest initial overlap that is still tolerated, m; 0: none.
  [[nodiscard]] double toleratedOverlap() const { return toleratedOverlap_; }
  /// Whether initial overlap has been reduced since the last call, which does work on the bodies.
  [[nodiscard]] bool consumeOverlapReduction() { return std::exchange(overlapReduced_, false); }

 private:
  /// A vertex and a triangle of the other skin within reach of each other.
  struct VertexFacePair {
    Index vertex = 0, triangle = 0;
    bool ofSecond = false;  // side of the vertex
    [[nodiscard]] bool isOf(const VertexFacePair &other) const {
      return vertex == other.vertex && ofSecond == other.ofSecond;
    }
  };
  /// Patches within reach of each other. `separation` is the distance of their boxes minus the travel of both skins
  /// since the list was built.
  struct PatchPair {
    Index first = 0, second = 0;
    double separation = 0.0;  // m
  };
  /// Candidates of one vertex. They are not tested until both skins together have moved by `idleTravel` since
  /// they were gathered.
  struct VertexCandidates {
    std::size_t begin = 0, end = 0;  // range in vertexFacePairs_
    double idleTravel = 0.0;         // m
  };
  struct EdgeCandidates {
    Index first = 0, second = 0;
    double idleTravel = 0.0;  // m
  };
  /// Upper bound of the travel of both skins together, from the displacements of the phyxels.
  struct Travel {
    std::array<std::vector<Vec3>, 2> reference;  // [sides][phyxels] m, initial displacements; empty: none
    void clear() {
      for (std::vector<Vec3> &side : reference) side.clear();
    }
    void start(const SkinPair &pair);
    [[nodiscard]] double since(const SkinPair &pair) const;  // m
  };
  struct PairedSkin {
    MovingSkin *skin = nullptr;
    std::vector<double> initialPenetration;  // [vertices] m, initial overlap that is still tolerated; empty: none
    std::vector<std::uint8_t> isInside;      // [vertices] 1: inside the other skin at the last test
  };

  [[nodiscard]] bool isSelf() const { return skins_[0].skin == skins_[1].skin; }
  void measureVertexTravel();
  void measureCandidateTravel(bool hasGathered);
  void rebasePatchPairs();
  bool updatePatchPairs();
  bool updateForecast();
  void findPatchPairs(double reach);
  void markVerticesInside(std::size_t side);
  void gatherCandidates();
  void addDeepVertices(bool ofSecond);
  void gatherVertices(bool ofSecond, Index patch, Index otherPatch, double reach);
  void gatherEdges(Index patch, Index otherPatch, double reach);
  [[nodiscard]] const MovingSkin::PatchFeatures &featuresOf(std::size_t side, Index patch) const;
  [[nodiscard]] bool areSameTissue(const Vec3 &a, const Vec3 &b) const;  // positions at rest, m
  /// Whether two edges are the same tissue, by the distances of their ends at rest.
  [[nodiscard]] bool areSameTissue(const std::array<Index, 2> &edge, const std::array<Index, 2> &other) const;
  void updateVertexContact(VertexCandidates &group);
  void updateEdgeContact(EdgeCandidates &pair);
  /// Point of a face of the other skin that a vertex touches, or may touch within the step.
  struct FacePoint {
    Index triangle = kNoTriangle;
    Vec3 weights = Vec3::Zero(), normal = Vec3::Zero();
    double distance = 0.0;  // m, of the vertex at the beginning of the step; negative: it is inside
  };
  /// First face that a vertex crosses on its path from outside.
  [[nodiscard]] FacePoint firstCrossing(std::span<const VertexFacePair> candidates) const;
  /// Face above which the vertex is at the end of its path, if there is one.
  [[nodiscard]] FacePoint faceAtEnd(std::span<const VertexFacePair> candidates) const;
  /// Offset of a vertex from a triangle of the other skin, m: smaller where cells are refined.
  [[nodiscard]] double layerOffset(const VertexFacePair &of, Index triangle) const;
  /// @param number  of the contact of this vertex; 0: the nearest, the only one with the stiffness of the layer
  void addVertexContact(const VertexFacePair &of, const FacePoint &at, Index number, double friction);
  void addNeighbouringFaces(std::span<const VertexFacePair> candidates, const FacePoint &first, double within,
                            double friction);
  /// Factor of offset and thickness of the layer, 0 … 1: less than 1 where cells at one of these vertices are refined.
  template <class... Vertices>
  [[nodiscard]] double refinementFactor(std::size_t side, Vertices... vertices) const {
    return std::min({1.0, skins_[side].skin->spacingAt(vertices) / spacing_...});
  }
  [[nodiscard]] double initialPenetration(std::size_t side, Index vertex) const {
    return skins_[side].initialPenetration.empty() ? 0.0 : skins_[side].initialPenetration[vertex];
  }
  /// Whether initial overlap is reduced. Otherwise it is regarded as a fit and remains.
  [[nodiscard]] bool resolvesInitialOverlap() const { return settings_.recoverySpeed > 0.0; }
  void recordInitialPenetration();
  void relaxInitialPenetration();
  void restoreInitialPenetration(double &initialPenetration, double overlap) const;
  /// @param distance  signed distance of the two skins there, m; negative: they overlap
  /// @param tolerated  part of the overlap that is tolerated since the start, m
  void add(SkinContact contact, double distance, double tolerated);
  void warmStartContacts();

  std::array<PairedSkin, 2> skins_;
  SkinPairSettings settings_;
  double spacing_;
  std::vector<PatchPair> patchPairs_;
  std::vector<std::pair<Index, Index>> traversalStack_;  // scratch storage of PatchTree::visitPairsWithin()
  std::vector<std::uint8_t> isListed_;                   // scratch storage of findPatchPairs()
  std::vector<VertexFacePair> vertexFacePairs_;          // sorted by side, vertex, triangle
  std::vector<VertexCandidates> vertices_;
  std::vector<EdgeCandidates> edges_;
  std::optional<SkinForecast> forecast_;  // for a skin with itself, instead of the list by distance
  std::uint64_t forecastRevision_ = 0;    // SkinForecast::revision() when patchPairs_ was filled
  Travel sinceList_, sinceGathered_, sinceSearch_;
  double validTravel_ = 0.0;  // m, travel of both skins since find() for which its contacts remain
                              // valid
  std::array<std::vector<Vec3>, 2> positionsAtListing_;  // [sides][vertices] m, positions when the list was built
  // Vertices of the candidates, first those of listed patches, then those deep inside; and their positions when
  // gathered, m.
  std::array<std::vector<Index>, 2> candidateVertices_;
  std::array<std::size_t, 2> listedCount_{};  // [sides] number of vertices of listed patches
  std::array<std::vector<Vec3>, 2> positionsAtGathering_;
  double listReach_ = 0.0;                                // m
  double travelSinceList_ = 0.0, stepTravel_ = 0.0;       // m, of both skins together: since the list was built, and in
                                                          // this step
  double reuseDistance_ = 0.0, travelSinceGather_ = 0.0;  // m: travel for which candidates remain valid, and travel
                                                          // since they were gathered
  StepKind stepKind_ = StepKind::explicitStep;
  bool isFirstSearch_ = true, reducesOverlap_ = true, overlapReduced_ = false;
  double toleratedBefore_ = 0.0;  // m, toleratedOverlap_ at the beginning of the step
  double dt_ = 0.0;
  std::vector<SkinContact> active_, previous_;
  double depth_ = 0.0, toleratedOverlap_ = 0.0;
  Sum sum_;
};

}  // namespace pointbased::detail
