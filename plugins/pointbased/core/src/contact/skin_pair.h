// SPDX-License-Identifier: Apache-2.0
// Contact between two skins, or of a skin with itself. Private to the core.
#pragma once

#include <algorithm>
#include <optional>
#include <utility>

#include "contact/skin_forecast.h"
#include "pointbased/contact.h"

namespace pointbased::detail {

/// One side that a point of one skin and a point of the other may not pass within a step: a vertex and a face, or two
/// edges. `gap` is what is left between the skins.
struct SkinContact : Contact {
  std::uint64_t key = 0;  ///< of what touches what, ascending within a pair
  /// Vertices whose weighted sum is the way of the first point seen from the second; of either skin
  struct Part {
    Index vertex = 0;
    bool ofSecond = false;
    double weight = 0.0;
  };
  std::array<Part, 4> parts{};
  /// When it was found, for those who keep it longer than a step (SkinPair::serves()): m, gap, and the way of the first
  /// point seen from the second by displacements of phyxels; nothing before JointContact::gather().
  struct Found {
    double gap = 0.0;
    Vec3 way = Vec3::Zero();
  };
  std::optional<Found> found;
  [[nodiscard]] bool isOfEdges() const { return key >> 62 == 2; }
};

struct SkinPairSettings {
  double friction = 0.3;
  double offset = 0.0;      ///< m, from where on a layer between the skins resists
  double thickness = 0.0;   ///< m, of that layer: so far it can be compressed
  double stiffness = 0.0;   ///< of the layer, times the modulus of the softer body over its spacing, Pa/m
  double margin = 0.0;      ///< m: contacts closer than this count as active even when nothing moves
  double ease = 0.0;        ///< m/s, at which what overlaps at the start is led apart at most; 0: it stays
  double gentle = 0.0;      ///< m, by which the layer may be compressed for that
  double apart = 0.0;       ///< m, of a skin with itself: what lies nearer than that at rest is one piece of tissue
  double leastReach = 0.0;  ///< m: places that near are listed, however slow all is
};

/// Finds the contacts of two skins as they move. Patches within reach of each other are listed now and then; what of
/// them can touch is gathered in every step, or for several where little moves, and then looked at. What is found does
/// not depend on when that was.
///
/// Only places where the distance between the skins is least locally are contacts: a vertex over the interior of a
/// face, or beyond an edge or a corner that it is nearest to, and two edges whose shortest connection leads out of
/// both. If none of these distances is negative, no triangles cross.
/// @threads one
class SkinPair {
 public:
  /// @param second  the same object as the first: of a skin with itself
  SkinPair(MovingSkin &first, MovingSkin &second, const SkinPairSettings &settings);

  [[nodiscard]] const SkinPairSettings &settings() const { return settings_; }
  [[nodiscard]] double spacing() const { return spacing_; }  ///< m, of the finer one
  [[nodiscard]] const ContactSkin &skin(std::size_t side) const { return sides_[side].skin->skin(); }
  [[nodiscard]] MovingSkin &moving(std::size_t side) { return *sides_[side].skin; }
  void setFriction(double friction) {
    if (std::exchange(settings_.friction, friction) != friction) findAnew();
  }
  void setEase(double ease) { settings_.ease = ease; }
  enum class Steps {
    small,        ///< explicit: within one, what is near stays beside what it is beside
    longOnes,     ///< implicit: ways are followed to what they meet
    withoutTime,  ///< quasi-static: likewise; what is led apart goes there at once
  };
  void setSteps(Steps steps) { steps_ = steps; }
  /// Of a skin and itself: whether it may touch itself in the step that it is about to go (MovingSkin::move()), as far
  /// as is known; nothing: it has to be looked at.
  [[nodiscard]] std::optional<bool> foretold();
  /// Likewise, from a look at all of it.
  [[nodiscard]] bool mayTouch();
  /// Fills active() for a step of dt from where the skins are (MovingSkin::move()), keeping what contacts that go on
  /// remember.
  /// @param again  of the same step: what overlaps is not led farther apart
  void find(double dt, bool again = false);
  /// Whether the next step can do with what find() has found last: neither skin goes so far that more than what
  /// is active could press. Gaps are for the caller to follow. After MovingSkin::move().
  [[nodiscard]] bool serves() const;
  /// What has been found does not serve any more.
  void findAnew() { servesFor_ = 0.0; }
  /// The skins have moved on since (MovingSkin::moveOn()): what presses has its place and normal of now, so that a
  /// further impulse between the two points has no torque. Gaps stay.
  void renewPressing();
  [[nodiscard]] std::vector<SkinContact> &active() { return active_; }
  [[nodiscard]] const std::vector<SkinContact> &active() const { return active_; }
  /// All that the next step takes over from the last one.
  struct Memory {
    std::vector<SkinContact> active;
    std::array<std::vector<double>, 2> allowances;      // [sides][vertices] m, or empty
    std::array<std::vector<std::uint8_t>, 2> isInside;  // [sides][vertices]
    double allowed = 0.0;
    std::array<std::vector<Vec3>, 2> foundAt;  // [sides][phyxels] m, displacements
    double servesFor = 0.0;                    // m
  };
  [[nodiscard]] Memory memory() const {
    return {active_,
            {sides_[0].allowance, sides_[1].allowance},
            {sides_[0].isInside, sides_[1].isInside},
            allowed_,
            sinceFound_.from,
            servesFor_};
  }
  void setMemory(const Memory &memory);

  /// What passes from the second skin to the first, over some time.
  struct Sum {
    Vec3 impulse = Vec3::Zero();  ///< N s
    double pressing = 0.0;        ///< N s, of the normal forces alone, without direction
    double span = 0.0;            ///< s
  };
  [[nodiscard]] const Sum &sum() const { return sum_; }
  void beginSum() { sum_ = Sum(); }
  void setSum(const Sum &sum) { sum_ = sum; }
  /// A step of dt is over.
  void addToSum(double dt);
  /// m, deepest overlap of the last find(), with what has been allowed since the start unless that stays; 0: none.
  [[nodiscard]] double depth() const { return depth_; }
  /// m, deepest overlap that is allowed since the start; 0: none.
  [[nodiscard]] double allowed() const { return allowed_; }
  /// Whether something has been led apart since the last call, which takes work.
  [[nodiscard]] bool takeEased() { return std::exchange(wasEased_, false); }

 private:
  /// A vertex and a triangle of the other skin within reach of each other.
  struct Near {
    Index vertex = 0, triangle = 0;
    bool ofSecond = false;  // the vertex
    [[nodiscard]] bool isOf(const Near &other) const { return vertex == other.vertex && ofSecond == other.ofSecond; }
  };
  /// Patches that have been near each other, and how far apart they were, less what both had moved until then.
  struct NearPatches {
    Index first = 0, second = 0;
    double apart = 0.0;  // m, of their boxes
  };
  /// Of one vertex; not looked at before both skins have moved by `wake` since they were gathered.
  struct NearVertex {
    std::size_t begin = 0, end = 0;  // of near_
    double wake = 0.0;               // m
  };
  struct NearEdges {
    Index first = 0, second = 0;
    double wake = 0.0;  // m
  };
  /// How far both skins have moved together, at most, as far as phyxels tell.
  struct Travel {
    std::array<std::vector<Vec3>, 2> from;  // [sides][phyxels] m, displacements at the beginning; empty: none
    void forget() {
      for (std::vector<Vec3> &side : from) side.clear();
    }
    void begin(const SkinPair &pair);
    [[nodiscard]] double since(const SkinPair &pair) const;  // m
  };
  struct Side {
    MovingSkin *skin = nullptr;
    std::vector<double> allowance;       // [vertices] m, of overlap, that was there at the start; empty: none
    std::vector<std::uint8_t> isInside;  // [vertices] 1: it was last seen inside the other
  };

  [[nodiscard]] bool isSelf() const { return sides_[0].skin == sides_[1].skin; }
  void measureExactly();
  void measureGathered(bool hasGathered);
  void keepList();
  bool renewList();
  bool renewForecast();
  void list(double reach);
  void findInside(std::size_t side);
  void gatherNear();
  void addDeep(bool ofSecond);
  void gatherVertices(bool ofSecond, Index patch, Index otherPatch, double reach);
  void gatherEdges(Index patch, Index otherPatch, double reach);
  [[nodiscard]] const MovingSkin::PatchParts &partsOf(std::size_t side, Index patch) const;
  [[nodiscard]] bool areOnePiece(const Vec3 &a, const Vec3 &b) const;  // at rest, m
  /// All of one edge of a skin and all of another one, by their ends.
  [[nodiscard]] bool areOnePiece(const std::array<Index, 2> &edge, const std::array<Index, 2> &other) const;
  void lookAt(NearVertex &group);
  void lookAt(NearEdges &pair);
  /// The first of the triangles that the vertex meets on its way, from outside.
  struct Met {
    Index triangle = kNoTriangle;
    Vec3 weights = Vec3::Zero(), normal = Vec3::Zero();
    double away = 0.0;  // m, at the beginning
  };
  [[nodiscard]] Met followWay(std::span<const Near> near) const;
  /// The triangle that it is over at the end of its way, if it is over one.
  [[nodiscard]] Met overAtEnd(std::span<const Near> near) const;
  /// Of the layer's offset and thickness, 0 … 1: cells are smaller than elsewhere at one of these vertices.
  template <class... Vertices>
  [[nodiscard]] double refinedAt(std::size_t side, Vertices... vertices) const {
    return std::min({1.0, sides_[side].skin->spacingAt(vertices) / spacing_...});
  }
  [[nodiscard]] double allowance(std::size_t side, Index vertex) const {
    return sides_[side].allowance.empty() ? 0.0 : sides_[side].allowance[vertex];
  }
  /// Whether what overlaps at the start is led apart; else it is what fits.
  [[nodiscard]] bool leadsApart() const { return settings_.ease > 0.0; }
  void learnAllowances();
  void easeAllowances();
  void holdBack(double &allowance, double overlap) const;
  /// @param distance  m, of the two skins there; negative: they overlap
  /// @param allowed   m, of that, since the start
  void add(SkinContact contact, double distance, double allowed);
  void keepMemories();

  std::array<Side, 2> sides_;
  SkinPairSettings settings_;
  double spacing_;
  std::vector<NearPatches> listed_;
  std::vector<std::pair<Index, Index>> open_;  // room for PatchTree::near()
  std::vector<std::uint8_t> isListed_;         // room for list()
  std::vector<Near> near_;                     // by side, vertex, triangle
  std::vector<NearVertex> vertices_;
  std::vector<NearEdges> edges_;
  std::optional<SkinForecast> forecast_;  // of a skin and itself, instead of a list by reach
  std::uint64_t forecastOf_ = 0;          // its number when listed_ was filled
  Travel sinceList_, sinceGathered_, sinceFound_;
  double servesFor_ = 0.0;                     // m, that both may go since found
  std::array<std::vector<Vec3>, 2> listedAt_;  // [sides][vertices] m, places then
  // Vertices of what is gathered: those of patches on the list, then those of places deep inside; and where they were
  // then, m
  std::array<std::vector<Index>, 2> gatheredOf_;
  std::array<std::size_t, 2> listedCount_{};  // [sides] of them: of the list
  std::array<std::vector<Vec3>, 2> gatheredAt_;
  double listReach_ = 0.0;            // m
  double went_ = 0.0, goes_ = 0.0;    // m, of both together: since it was listed, and in this step
  double slack_ = 0.0, moved_ = 0.0;  // m: what was gathered serves so far; since then
  Steps steps_ = Steps::small;
  bool isFirst_ = true, eases_ = true, wasEased_ = false;
  double before_ = 0.0;  // m, allowed_ at the beginning of the step
  double dt_ = 0.0;
  std::vector<SkinContact> active_, previous_;
  double depth_ = 0.0, allowed_ = 0.0;
  Sum sum_;
};

}  // namespace pointbased::detail
