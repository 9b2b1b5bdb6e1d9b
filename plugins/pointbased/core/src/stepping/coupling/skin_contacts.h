// SPDX-License-Identifier: Apache-2.0
// Skins and skin pairs that persist between steps. Private to the core.
#pragma once

#include <map>
#include <memory>

#include "contact/skin_pair.h"
#include "pointbased/body.h"
#include "pointbased/contact_settings.h"

namespace pointbased::detail {

/// Skins of bodies, and pairs of skins that have been within reach of each other.
/// @threads one; different pairs of different skins may be used at once
class SkinContacts {
 public:
  /// Ids of two bodies, or of one body twice; the smaller one first.
  using PairId = std::pair<std::size_t, std::size_t>;

  /// Whether a body has a skin that others can touch.
  [[nodiscard]] static bool hasSkin(const Body &body) { return !body.rest().skin.empty(); }
  struct Owner {
    std::size_t id = 0;
    const Body &body;
    /// True if it fits another body (ContactPairSettings::fits). The skins of such bodies are inaccurate by fractions
    /// of a spacing, so a coarse skin is as good as the displayed one.
    bool isPiece = false;
  };
  [[nodiscard]] static Owner ownerOf(std::size_t id, const Body &body, const ContactPairs &pairs);
  /// Skin of the body's present reference.
  [[nodiscard]] MovingSkin &skinOf(const Owner &owner);
  /// @param first, second  the smaller id first
  /// @param fits           ContactPairSettings::fits
  [[nodiscard]] SkinPair &pairOf(const Owner &first, const Owner &second, double friction, bool fits = false);
  [[nodiscard]] const std::map<PairId, std::unique_ptr<SkinPair>> &pairs() const { return pairs_; }

  /// Bound that decides when a body may touch itself.
  struct SelfContactBound {
    std::shared_ptr<const RestState> of;
    /// Null as long as a bound from phyxels alone is sufficient: a skin that touches nothing is not created.
    const ContactSkin *skin = nullptr;
    double gain = 1.0;       ///< upper bound of a vertex's travel over that of the farthest phyxel
    double clearance = 0.0;  ///< m, lower bound of the relative travel from rest that skin vertices still have
    /// m, mean: twice the volume over the area, which is the radius of a tube. 0: unknown.
    double thickness = 0.0;
    /// Whether the spacing resolves the folds of the body: a tube is wider than one piece of tissue.
    [[nodiscard]] bool isResolved() const { return !(thickness > 0.0) || thickness >= kMinThickness * of->spacing; }
    static constexpr double kMinThickness = 0.75;  ///< spacings

    /// Updates `clearance` from the displacements since rest, without their common rigid motion.
    void measure(std::span<const Vec3> displacements);
    [[nodiscard]] double vertexBound(const TravelBound &bound) const {
      return skin != nullptr ? bound.ofVertices(*skin) : gain * bound.ofPhyxels();
    }
  };
  /// Initially at rest: parts of the skin that are nearer to each other there do not touch.
  [[nodiscard]] SelfContactBound &selfContactBound(std::size_t id, const Body &body);
  /// Same, using the bounds of its skin from now on.
  [[nodiscard]] SelfContactBound &measuredSelfContactBound(const Owner &owner);
  /// Pair of a body with itself; null: it has not been checked yet.
  [[nodiscard]] SkinPair *ownPair(std::size_t id) const {
    const auto found = pairs_.find({id, id});
    return found == pairs_.end() ? nullptr : found->second.get();
  }

  /// Call at the beginning of a step: clears the sums of pairs that are not at rest.
  /// @param isAtRest  rests(id of a body)
  template <class Rests>
  void beginSums(const Rests &isAtRest) {
    for (auto &[id, pair] : pairs_)
      if (!isAtRest(id.first) || !isAtRest(id.second)) pair->beginSum();
  }
  /// Call when a body has other materials.
  void invalidateModuli(std::size_t id) {
    if (const auto found = skins_.find(id); found != skins_.end()) found->second.moving->setModuli({});
    for (auto &[both, pair] : pairs_)
      if (both.first == id || both.second == id) pair->invalidateSearch();
  }
  /// Resets everything, or the data of one body.
  void clear();
  void remove(std::size_t id);

 private:
  struct Skin {
    std::shared_ptr<const RestState> of;
    bool isPiece = false;
    std::unique_ptr<MovingSkin> moving;
  };
  std::map<std::size_t, Skin> skins_;
  std::map<PairId, std::unique_ptr<SkinPair>> pairs_;
  std::map<std::size_t, SelfContactBound> selfContactBounds_;
};

}  // namespace pointbased::detail
