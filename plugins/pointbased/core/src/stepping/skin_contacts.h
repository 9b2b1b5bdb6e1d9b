// SPDX-License-Identifier: Apache-2.0
// What contact between bodies knows of their skins from step to step. Private to the core.
#pragma once

#include <map>
#include <memory>

#include "contact/skin_pair.h"
#include "pointbased/body.h"
#include "pointbased/contact_settings.h"
#include "pointbased/simulator.h"

namespace pointbased::detail {

/// Skins of bodies, and pairs of skins that have come near each other.
/// @threads one; different pairs of different skins may be used at once
class SkinContacts {
 public:
  /// Two bodies, or one and itself, by ids, the smaller one first.
  using PairId = std::pair<std::size_t, std::size_t>;

  /// Whether a body has a skin that others can touch.
  [[nodiscard]] static bool hasSkin(const Body &body) { return !body.rest().skin.empty(); }
  struct Owner {
    std::size_t id = 0;
    const Body &body;
    /// Fits another body (ContactPairSettings::fits): skins of such are off by parts of a spacing, so a coarse one
    /// serves as well as what is drawn.
    bool isPiece = false;
  };
  [[nodiscard]] static Owner ownerOf(std::size_t id, const Body &body, const Simulator::ContactPairs &pairs);
  /// Of the body's present reference.
  [[nodiscard]] MovingSkin &skinOf(const Owner &owner);
  /// @param first, second  the smaller id first
  /// @param fits           ContactPairSettings::fits
  [[nodiscard]] SkinPair &pairOf(const Owner &first, const Owner &second, double friction, bool fits = false);
  [[nodiscard]] const std::map<PairId, std::unique_ptr<SkinPair>> &pairs() const { return pairs_; }

  /// When a body may touch itself.
  struct RoomOfSelf {
    std::shared_ptr<const RestState> of;
    /// Null as long as a bound by phyxels alone has told: a skin that meets nothing is not made.
    const ContactSkin *skin = nullptr;
    double gain = 1.0;  ///< no vertex goes farther than this times the farthest phyxel
    double left = 0.0;  ///< m, at least, that vertices of its skin may still move against each other from rest
    /// m, in the mean: twice the volume over the area, which is the radius of a tube. 0: not known.
    double thickness = 0.0;
    /// Whether the spacing tells its folds apart: a tube is wider than what is one piece of tissue.
    [[nodiscard]] bool isResolved() const { return !(thickness > 0.0) || thickness >= kThinnest * of->spacing; }
    static constexpr double kThinnest = 0.75;  ///< spacings

    /// Looks how far they have gone from rest, apart from a motion of all together.
    void measure(std::span<const Vec3> displacements);
    [[nodiscard]] double farthest(const FarthestWay &way) const {
      return skin != nullptr ? way.ofVertices(*skin) : gain * way.ofPhyxels();
    }
  };
  /// At rest at first: places of the skin that lie nearer to each other there do not touch.
  [[nodiscard]] RoomOfSelf &roomOfSelf(std::size_t id, const Body &body);
  /// The same, with the bounds of its skin from here on.
  [[nodiscard]] RoomOfSelf &roomOfSkin(const Owner &owner);
  /// That of a body and itself; null: it has not been looked at yet.
  [[nodiscard]] SkinPair *ownPair(std::size_t id) const {
    const auto found = pairs_.find({id, id});
    return found == pairs_.end() ? nullptr : found->second.get();
  }

  /// A step begins: nothing has passed in it yet between those that do not rest. @param rests(id of a body)
  template <class Rests>
  void beginSums(const Rests &rests) {
    for (auto &[id, pair] : pairs_)
      if (!rests(id.first) || !rests(id.second)) pair->beginSum();
  }
  /// A body has other materials.
  void forgetModuli(std::size_t id) {
    if (const auto found = skins_.find(id); found != skins_.end()) found->second.moving->setModuli({});
    for (auto &[both, pair] : pairs_)
      if (both.first == id || both.second == id) pair->findAnew();
  }
  /// Begins anew: of all, and of one body.
  void forget();
  void forget(std::size_t id);

 private:
  struct Skin {
    std::shared_ptr<const RestState> of;
    bool isPiece = false;
    std::unique_ptr<MovingSkin> moving;
  };
  std::map<std::size_t, Skin> skins_;
  std::map<PairId, std::unique_ptr<SkinPair>> pairs_;
  std::map<std::size_t, RoomOfSelf> roomsOfSelf_;
};

}  // namespace pointbased::detail
