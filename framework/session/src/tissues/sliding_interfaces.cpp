// SPDX-License-Identifier: Apache-2.0
#include "tissues/sliding_interfaces.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/placement_matrix.h"
#include "c3de/abi/iface/parameter_ids.h"
#include "c3de/core/log.h"
#include "c3de/scene/simulation.h"

namespace c3de::session {
namespace {

/// Signed distance of a point to a region, m; below 0 inside.
double distanceTo(const scene::SceneRegion &region, const Vec3 &x) {
  switch (region.kind) {
    case scene::SceneRegion::Kind::everywhere: return -std::numeric_limits<double>::infinity();
    case scene::SceneRegion::Kind::box: {
      double largest = -std::numeric_limits<double>::infinity();
      for (std::size_t a = 0; a < 3; ++a) largest = std::max({largest, region.a[a] - x[a], x[a] - region.b[a]});
      return largest;
    }
    case scene::SceneRegion::Kind::sphere: return norm(x - region.a) - region.radius;
    case scene::SceneRegion::Kind::halfSpace: return dot(x - region.a, region.b) / norm(region.b);
    case scene::SceneRegion::Kind::voxels: break;
  }
  return std::numeric_limits<double>::infinity();
}

/// Locations of the pieces of a body, placed at rest.
class Pieces {
 public:
  Pieces(std::shared_ptr<const scene::SceneBodyPieces> cut, const scene::ScenePlacement &placement)
      : cut_(std::move(cut)), fromScan_(matrixOf(placement)) {
    const Vec3 edges = cut_->tissues.geometry.spacing();
    const double scale = norm(Vec3{fromScan_[0], fromScan_[1], fromScan_[2]});
    halfVoxel_m_ = 0.501 * scale * std::max({edges[0], edges[1], edges[2]}) / scene::kMillimetresPerMetre;
  }

  struct RegionShare {
    std::vector<std::size_t> voxels;  ///< per piece
    Vec3 sum_m{};                     ///< sum of their centres
  };
  /// The voxels in a region: by voxel centres, or by whole voxels where the region is thinner than they are.
  [[nodiscard]] RegionShare in(const scene::SceneRegion &region) const {
    for (const double within : {0.0, halfVoxel_m_}) {
      RegionShare share{std::vector<std::size_t>(cut_->labels.size() + 1, 0), {}};
      std::size_t count = 0;
      visit([&](std::size_t piece, const Vec3 &x) {
        if (distanceTo(region, x) > within) return;
        ++share.voxels[piece];
        share.sum_m = share.sum_m + x;
        ++count;
      });
      if (count > 0) return share;
    }
    return {std::vector<std::size_t>(cut_->labels.size() + 1, 0), {}};
  }
  [[nodiscard]] std::size_t nearest(const Vec3 &at_m) const {
    std::size_t found = 0;
    double smallest = std::numeric_limits<double>::infinity();
    visit([&](std::size_t piece, const Vec3 &x) {
      const double distance = norm(x - at_m);
      if (distance < smallest) {
        smallest = distance;
        found = piece;
      }
    });
    return found;
  }
  [[nodiscard]] Vec3 centre(std::size_t piece) const {
    Vec3 sum{};
    std::size_t count = 0;
    visit([&](std::size_t one, const Vec3 &x) {
      if (one != piece) return;
      sum = sum + x;
      ++count;
    });
    return (1.0 / static_cast<double>(std::max<std::size_t>(count, 1))) * sum;
  }

 private:
  template <class F>
  void visit(F &&f) const {
    const imaging::VolumeGeometry &grid = cut_->tissues.geometry;
    std::size_t v = 0;
    for (std::size_t k = 0; k < grid.size[2]; ++k)
      for (std::size_t j = 0; j < grid.size[1]; ++j)
        for (std::size_t i = 0; i < grid.size[0]; ++i, ++v) {
          if (cut_->tissues.voxels[v] == 0) continue;
          const Vec3 x = grid.worldAt({static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
          f(cut_->pieces[v], (1.0 / scene::kMillimetresPerMetre) * transformPoint(fromScan_, x));
        }
  }

  std::shared_ptr<const scene::SceneBodyPieces> cut_;
  Mat4 fromScan_;
  double halfVoxel_m_ = 0.0;
};

std::size_t sumOf(const std::vector<std::size_t> &counts) {
  std::size_t sum = 0;
  for (const std::size_t count : counts) sum += count;
  return sum;
}

/// The piece of each voxel of the body: that of the label that determines its tissue.
std::vector<std::uint8_t> piecesOf(const scene::SceneVolume &volume, const BodySources::Layers &layers,
                                   const imaging::LabelMap &picked) {
  const auto background = static_cast<std::uint16_t>(volume.tissues.size() + 1);
  struct Of {
    std::uint16_t tissue = 0;
    std::uint8_t piece = 0;
  };
  std::vector<std::vector<Of>> table(layers.size(), std::vector<Of>(0x10000));
  for (std::vector<Of> &layer : table)
    for (Of &label : layer) label.tissue = background;
  for (std::size_t t = 0; t < volume.tissues.size(); ++t)
    for (const scene::SceneLabel &label : volume.tissues[t].labels)
      if (!volume.tissues[t].isEmpty) table[label.layer][label.value].tissue = static_cast<std::uint16_t>(t + 1);
  for (std::size_t s = 0; s < volume.slides.size(); ++s)
    for (const scene::SceneLabel &label : volume.slides[s].labels)
      table[label.layer][label.value].piece = static_cast<std::uint8_t>(s + 1);
  std::vector<std::uint8_t> pieces(picked.voxels.size(), 0);
  for (std::size_t v = 0; v < pieces.size(); ++v)
    for (std::size_t layer = layers.size(); layer-- > 0;) {
      const std::uint16_t value = layers[layer].voxels[v];
      if (value == 0 || table[layer][value].tissue != picked.voxels[v]) continue;
      pieces[v] = table[layer][value].piece;
      break;
    }
  return pieces;
}

/// Warns of sliding pieces that reach the border of the scan, where nothing holds them.
void reportOpenCut(const scene::SceneBody &body, const scene::SceneBodyPieces &cut) {
  const auto &n = cut.tissues.geometry.size;
  std::vector<std::size_t> open(cut.labels.size() + 1, 0);
  std::size_t v = 0;
  for (std::size_t k = 0; k < n[2]; ++k)
    for (std::size_t j = 0; j < n[1]; ++j)
      for (std::size_t i = 0; i < n[0]; ++i, ++v)
        if (cut.tissues.voxels[v] != 0 &&
            (i == 0 || j == 0 || k == 0 || i + 1 == n[0] || j + 1 == n[1] || k + 1 == n[2]))
          ++open[cut.pieces[v]];
  const std::vector<std::string> names = scene::namesOfPieces(body);
  for (std::size_t s = 0; s < names.size(); ++s)
    if (open[s + 1] > 0)
      log(LogLevel::warn, body.volume.file.string() + ": the scan ends in '" + names[s] + "' (" +
                              std::to_string(open[s + 1]) +
                              " voxels), so nothing keeps it from sliding out there; a [[fix]] of '" + names[s] +
                              "' at that border would");
}

/// Errors do not contain a location.
Expected<std::shared_ptr<const scene::SceneBodyPieces>> cutOf(const scene::SceneBody &body, BodySources &sources,
                                                              const ProgressFn &progress, Preparation &preparation) {
  const scene::SceneVolume &volume = body.volume;
  auto picked = sources.pick(volume, progress, preparation);
  if (!picked) return tl::unexpected(picked.error());
  const auto layers = sources.layersOf(volume, progress);
  if (!layers) return tl::unexpected(layers.error());
  auto cut = std::make_shared<scene::SceneBodyPieces>();
  cut->pieces = piecesOf(volume, **layers, *picked->tissues);
  cut->tissues = *picked->tissues;
  for (const scene::SceneSlidingPart &slide : volume.slides) cut->labels.push_back(slide.labels);

  std::vector<std::size_t> voxels(volume.slides.size() + 1, 0);
  bool isRestSoft = false;
  for (std::size_t v = 0; v < cut->pieces.size(); ++v) {
    const std::uint16_t tissue = cut->tissues.voxels[v];
    if (tissue == 0) continue;
    ++voxels[cut->pieces[v]];
    isRestSoft =
        isRestSoft || (cut->pieces[v] == 0 && (tissue > volume.tissues.size() || !volume.tissues[tissue - 1].isRigid));
  }
  reportOpenCut(body, *cut);
  for (std::size_t s = 0; s < volume.slides.size(); ++s)
    if (voxels[s + 1] == 0)
      return fail(ErrorCode::input, "slides: nothing of '" + volume.slides[s].names.front() +
                                        "' is of the body: labels of other tissues lie over all of it, or 'mend' has "
                                        "taken it away");
  if (!isRestSoft)
    return fail(ErrorCode::input, "slides: all that can move of '" + body.name +
                                      "' slides, and nothing is left for it to slide on; accepted: labels, or a "
                                      "'background', that do not slide");
  return cut;
}

const scene::ScenePiece &pieceOverrides(const scene::SceneBody &whole, std::size_t piece) {
  return piece == 0 ? whole.volume.rest : whole.volume.slides[piece - 1];
}

/// Whether the piece is fixed, whatever acts on it.
bool isAtRest(const scene::ScenePiece &piece) {
  return scene::trueOf(piece.params, C3DE_PARAM_ID_RIGID) && !scene::trueOf(piece.params, C3DE_PARAM_ID_FREE);
}

/// Checks that the overrides of the pieces are consistent.
Expected<void> checkPieces(const scene::SceneFile &scene, const scene::SceneBody &whole,
                           const std::vector<std::string> &names) {
  for (std::size_t p = 0; p < names.size(); ++p) {
    const scene::ScenePiece &overrides = pieceOverrides(whole, p);
    const std::string name = p == 0 ? scene::nameOfRest(whole) : names[p];
    const scene::SceneValue *free = scene::trueOf(overrides.params, C3DE_PARAM_ID_FREE);
    if (free && !scene::trueOf(overrides.params, C3DE_PARAM_ID_RIGID))
      return fail(ErrorCode::usage, scene.where(*free) + ": '" + name +
                                        "' deforms, and moves freely where nothing holds it; accepted: free = true of "
                                        "what is rigid, --set body." +
                                        name + ".rigid=true");
    if (overrides.velocity_m_s && isAtRest(overrides))
      return fail(ErrorCode::usage, scene.where(*scene::trueOf(overrides.params, C3DE_PARAM_ID_RIGID)) + ": '" + name +
                                        "' has a velocity and is rigid, which stands in its place; accepted: one of "
                                        "them, or --set body." +
                                        name + ".free=true");
  }
  return {};
}

/// Copies items that act in a region of the body to each piece that it meets, except fixed pieces; copies beyond the
/// first are appended.
template <class RegionItem, class Adapt>
void distribute(std::vector<RegionItem> &all, const scene::SceneBody &whole, const std::vector<std::string> &names,
                const Pieces &pieces, const Adapt &adapt) {
  const std::size_t count = all.size();
  for (std::size_t i = 0; i < count; ++i) {
    if (all[i].body != whole.name) continue;
    const RegionItem original = all[i];
    const Pieces::RegionShare in = pieces.in(original.region);
    bool isFirst = true;
    for (std::size_t p = 0; p < names.size(); ++p) {
      if (in.voxels[p] == 0 || isAtRest(pieceOverrides(whole, p))) continue;
      RegionItem own = original;
      own.body = names[p];
      adapt(own, in, p);
      if (std::exchange(isFirst, false))
        all[i] = std::move(own);
      else
        all.push_back(std::move(own));
    }
  }
}

void distributeContacts(scene::SceneFile &scene, const scene::SceneBody &body, const std::vector<std::string> &names) {
  std::vector<scene::SceneContactPair> &pairs = scene.contactPairs;
  const auto find = [&](const std::string &a, const std::string &b) {
    return std::find_if(pairs.begin(), pairs.end(), [&](const scene::SceneContactPair &pair) {
      return (pair.names[0] == a && pair.names[1] == b) || (pair.names[0] == b && pair.names[1] == a);
    });
  };
  const std::vector<scene::SceneContactPair> overrides = pairs;
  for (const scene::SceneContactPair &pair : overrides) {
    const auto &[a, b] = pair.names;
    if (a != body.name && b != body.name) continue;
    const std::string &other = a == body.name ? b : a;
    if (std::find(names.begin(), names.end(), other) != names.end()) continue;
    for (std::size_t p = 1; p < names.size(); ++p)
      if (find(names[p], other) == pairs.end()) {
        pairs.push_back(pair);
        pairs.back().names = {names[p], other};
      }
  }
  for (std::size_t p = 0; p < names.size(); ++p)
    for (std::size_t q = p + 1; q < names.size(); ++q) {
      auto pair = find(names[p], names[q]);
      if (pair == pairs.end()) {
        pairs.push_back({{names[p], names[q]}, {}, true, false, body.line});
        pair = pairs.end() - 1;
      }
      pair->fits = true;
      if (!pair->friction) pair->friction = body.volume.slidingFriction;
    }
}

/// Renames references to the rest alone, after items of the whole body have been distributed.
void renameRest(scene::SceneFile &scene, const scene::SceneBody &whole) {
  const std::string rest = scene::nameOfRest(whole);
  const auto rename = [&](std::string &name) {
    if (name == rest) name = whole.name;
  };
  for (scene::SceneFix &fix : scene.fixes) rename(fix.body);
  for (scene::SceneLoad &load : scene.loads) rename(load.body);
  for (scene::SceneProbe &probe : scene.probes) rename(probe.body);
  for (scene::SceneGrasp &grasp : scene.grasps) rename(grasp.body);
  for (scene::SceneAttachment &attachment : scene.attachments)
    for (std::string &name : attachment.names) rename(name);
  // A pair of the rest takes precedence over one of the whole body.
  std::vector<scene::SceneContactPair> &pairs = scene.contactPairs;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto overrides = pairs[i].names;
    for (std::string &name : pairs[i].names) rename(name);
    if (pairs[i].names == overrides) continue;
    const auto &[a, b] = pairs[i].names;
    for (std::size_t j = pairs.size(); j-- > 0;)
      if (j != i &&
          ((pairs[j].names[0] == a && pairs[j].names[1] == b) || (pairs[j].names[0] == b && pairs[j].names[1] == a))) {
        pairs[i].fits = pairs[i].fits || pairs[j].fits;
        if (!pairs[i].friction) pairs[i].friction = pairs[j].friction;
        pairs.erase(pairs.begin() + static_cast<std::ptrdiff_t>(j));
        if (j < i) --i;
      }
  }
}

/// The bodies of the pieces, the rest first.
std::vector<scene::SceneBody> bodiesOf(const scene::SceneBody &whole, const std::vector<std::string> &names,
                                       const std::shared_ptr<const scene::SceneBodyPieces> &cut, const Pieces &pieces) {
  const std::vector<std::size_t> voxels = pieces.in({}).voxels;
  const auto all = static_cast<double>(sumOf(voxels));
  std::vector<scene::SceneBody> bodies{scene::bodyOfRest(whole)};
  for (std::size_t s = 0; s < whole.volume.slides.size(); ++s) bodies.push_back(scene::bodyOfPiece(whole, s));
  Vec3 middle{};
  for (std::size_t p = 0; p < names.size(); ++p)
    middle = middle + (static_cast<double>(voxels[p]) / all) * pieces.centre(p);
  for (std::size_t p = 0; p < names.size(); ++p) {
    scene::SceneBody &body = bodies[p];
    body.volume.cut = cut;
    // Together they rotate as the whole body would.
    if (!pieceOverrides(whole, p).velocity_m_s)
      body.velocity_m_s = body.velocity_m_s + cross(whole.angularVelocity_rad_s, pieces.centre(p) - middle);
    if (isAtRest(pieceOverrides(whole, p))) body.velocity_m_s = body.angularVelocity_rad_s = {};
    for (scene::SceneValue &value : body.params)
      if (value.value.id == C3DE_PARAM_ID_COUNT && !value.isPieceOverride)
        value.value.num = std::max(1.0, std::round(value.value.num * static_cast<double>(voxels[p]) / all));
    std::erase_if(body.refinements, [&](const scene::SceneRefinement &refinement) {
      const std::vector<std::size_t> in = pieces.in(refinement.region).voxels;
      return in[p] == 0 && sumOf(in) > 0;
    });
  }
  return bodies;
}

}  // namespace

Expected<void> cutSlidingParts(scene::SceneFile &scene, BodySources &sources, const ProgressFn &progress,
                               Preparation &preparation) {
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    if (scene.bodies[b].volume.slides.empty()) continue;
    const scene::SceneBody whole = scene.bodies[b];
    const std::vector<std::string> names = [&] {
      std::vector<std::string> all = scene::namesOfPieces(whole);
      all.insert(all.begin(), whole.name);
      return all;
    }();
    if (auto good = checkPieces(scene, whole, names); !good) return good;
    const auto cut = cutOf(whole, sources, progress, preparation);
    if (!cut) return failInScene(cut.error(), scene, whole.line);
    const Pieces pieces(*cut, whole.placement);

    distribute(scene.fixes, whole, names, pieces, [](scene::SceneFix &fix, const Pieces::RegionShare &in, std::size_t) {
      // A rotation of the body rotates its pieces about a common centre.
      if (!fix.motion.centre_m) fix.motion.centre_m = (1.0 / static_cast<double>(sumOf(in.voxels))) * in.sum_m;
    });
    distribute(
        scene.loads, whole, names, pieces, [](scene::SceneLoad &load, const Pieces::RegionShare &in, std::size_t p) {
          if (!load.force_N) return;
          load.force_N = (static_cast<double>(in.voxels[p]) / static_cast<double>(sumOf(in.voxels))) * *load.force_N;
        });
    for (scene::SceneProbe &probe : scene.probes)
      if (probe.body == whole.name) probe.body = names[pieces.nearest(probe.at_m)];
    for (scene::SceneGrasp &grasp : scene.grasps)
      if (grasp.body == whole.name) grasp.body = names[pieces.nearest(grasp.at_m)];
    distributeContacts(scene, whole, names);
    renameRest(scene, whole);

    std::vector<scene::SceneBody> bodies = bodiesOf(whole, names, *cut, pieces);
    const auto at = scene.bodies.erase(scene.bodies.begin() + static_cast<std::ptrdiff_t>(b));
    scene.bodies.insert(at, std::make_move_iterator(bodies.begin()), std::make_move_iterator(bodies.end()));
    b += names.size() - 1;
  }
  return {};
}

}  // namespace c3de::session
