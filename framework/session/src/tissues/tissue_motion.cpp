// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/tissue_motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "base/placement_matrix.h"
#include "c3de/core/csv.h"
#include "c3de/core/output_file.h"
#include "c3de/core/text.h"
#include "c3de/imaging/displacement.h"
#include "c3de/imaging/masks.h"
#include "c3de/imaging/warp_grid.h"
#include "c3de/scene/simulation.h"
#include "c3de/session/body_displacement.h"
#include "c3de/session/body_states.h"
#include "tissues/material_follower.h"

namespace c3de::session {
namespace {

constexpr double kMargin = 1.0;           // spacings around the bodies
constexpr double kRim = 1000.0;           // spacings: the displacement stays constant across the margin
constexpr std::size_t kMostPoints = 144;  // along an axis
constexpr double kFineness = 0.5;         // relative to the grid for images: steps of a quarter of the spacing

}  // namespace

void LabelMotion::add(const LabelMotion &other) {
  reference_m3 += other.reference_m3;
  end_m3 += other.end_m3;
  if (other.isKnown()) minJ = isKnown() ? std::min(minJ, other.minJ) : other.minJ;
  largestDisplacement_m = std::max(largestDisplacement_m, other.largestDisplacement_m);
  displacementSum_m += other.displacementSum_m;
  followed += other.followed;
  sample += other.sample;
}

LabelMotion TissueMotion::ofTissue(std::size_t tissue) const {
  LabelMotion all;
  double mean_m4 = 0.0;  // weighted by volume, because labels represent different volumes per sample
  for (std::size_t i = 0; i < labels.size(); ++i)
    if (places.labels[i].tissue == tissue) {
      all.add(labels[i]);
      if (labels[i].isKnown()) mean_m4 += labels[i].reference_m3 * labels[i].meanDisplacement_m();
    }
  if (all.isKnown()) all.displacementSum_m = mean_m4 / all.reference_m3 * static_cast<double>(all.followed);
  return all;
}

Expected<std::vector<TissueMotion>> tissueMotions(const c3de_simulator_v1 *table, c3de_object *simulator,
                                                  const std::vector<TissueVoxels> &bodies) {
  if (bodies.empty()) return std::vector<TissueMotion>{};
  const auto snapshot = readTissues(table, simulator);
  if (!snapshot) return tl::unexpected(snapshot.error());
  return followTissues(*snapshot, bodies);
}

Expected<TissueSnapshot> readTissues(const c3de_simulator_v1 *table, c3de_object *simulator, TissueDetail detail) {
  const bool isFull = detail == TissueDetail::full;
  const PresentBodies present = presentBodies(table, simulator);
  imaging::FollowingGrid grid(
      {.mostPoints = isFull ? kMostPoints : kMostPoints / 2, .coarsestStep = std::numeric_limits<double>::infinity()});
  grid.follow(present.box, (isFull ? kFineness : 2.0 * kFineness) * present.spacing_mm, kMargin * present.spacing_mm);
  auto u = std::make_shared<imaging::DisplacementGrid>();
  u->geometry = grid.geometry();
  if (!readDisplacement(table, simulator, kRim * present.spacing_mm, *u))
    return fail(ErrorCode::state, "the simulator does not say how far its bodies have moved");
  auto skins = readBodyStates(simulator, BodyParts::skin, {});
  if (!skins) return tl::unexpected(skins.error());
  return TissueSnapshot{std::move(u), std::move(*skins)};
}

Expected<TissueSnapshot> readTissues(c3de_object *simulator, std::shared_ptr<const imaging::DisplacementGrid> u) {
  auto skins = readBodyStates(simulator, BodyParts::skin, {});
  if (!skins) return tl::unexpected(skins.error());
  imaging::WorldBox bodies;
  for (const BodyState &body : *skins)
    for (const Vec3 &x : body.skin.vertices) bodies.add(x);
  if (!imaging::boxOf(u->geometry).holds(bodies))
    return fail(ErrorCode::state, "the grid of the displacement does not contain all bodies");
  return TissueSnapshot{std::move(u), std::move(*skins)};
}

Expected<std::vector<TissueMotion>> followTissues(const TissueSnapshot &snapshot,
                                                  const std::vector<TissueVoxels> &bodies,
                                                  const std::function<bool()> &goesOn) {
  const imaging::DisplacementGrid &u = *snapshot.u;
  std::vector<TissueMotion> all;
  for (const TissueVoxels &places : bodies) {
    const Mat4 placed = matrixOf(places.placement);
    const double scale3 = dot(Vec3{placed[0], placed[1], placed[2]},
                              cross(Vec3{placed[4], placed[5], placed[6]}, Vec3{placed[8], placed[9], placed[10]}));
    imaging::WorldBox box;
    for (const LabelVoxels &label : places.labels)
      for (const Vec3 &X : label.sample) box.add(transformPoint(placed, X));
    TissueMotion motion{places, {}};
    motion.labels.resize(places.labels.size());
    if (box.isEmpty()) {
      all.push_back(std::move(motion));
      continue;
    }
    const MaterialFollower follower(u, box, ownPoints(snapshot.skins, places.body, u.geometry));
    for (std::size_t i = 0; i < places.labels.size(); ++i) {
      if (goesOn && !goesOn()) return fail(ErrorCode::cancelled, "tracking of the labels was cancelled");
      const LabelVoxels &label = places.labels[i];
      LabelMotion &out = motion.labels[i];
      out.reference_m3 = 1e-9 * std::abs(scale3) * places.voxel_mm3 * static_cast<double>(label.voxels);
      out.sample = label.sample.size();
      // Rigid tissue is fixed, whereas the displacement around it is smoothed across it.
      if (places.tissueAt(label.tissue).isRigid) {
        out.end_m3 = out.reference_m3;
        out.minJ = 1.0;
        out.followed = out.sample;
        continue;
      }
      double sum = 0.0;
      for (const Vec3 &scanned : label.sample) {
        const auto found = follower.find(transformPoint(placed, scanned));
        if (!found) continue;
        const double way_m = norm(found->displacement) / scene::kMillimetresPerMetre;
        out.minJ = out.followed == 0 ? found->J : std::min(out.minJ, found->J);
        out.largestDisplacement_m = std::max(out.largestDisplacement_m, way_m);
        out.displacementSum_m += way_m;
        sum += found->J;
        ++out.followed;
      }
      if (out.isKnown()) out.end_m3 = out.reference_m3 * sum / static_cast<double>(out.followed);
    }
    all.push_back(std::move(motion));
  }
  return all;
}

Expected<void> writeTissueTable(const std::filesystem::path &file, const std::vector<TissueMotion> &bodies) {
  std::string text =
      "body,label,name,tissue,material,rigid,voxels,volume [m3],volume at the end [m3],mean displacement "
      "[m],largest displacement [m],min J\n";
  for (const TissueMotion &body : bodies)
    for (std::size_t i = 0; i < body.labels.size(); ++i) {
      const LabelVoxels &label = body.places.labels[i];
      const LabelMotion &motion = body.labels[i];
      const scene::SceneTissue tissue = body.places.tissueAt(label.tissue);
      text += csvCell(body.places.body) + ',' + (label.value == 0 ? "" : std::to_string(label.value)) + ',' +
              csvCell(label.name) + ',' + csvCell(tissue.label) + ',' + csvCell(tissue.preset) + ',' +
              (tissue.isRigid ? "true" : "false") + ',' + std::to_string(label.voxels) + ',' +
              formatNumber(motion.reference_m3);
      if (motion.isKnown())
        for (const double x : {motion.end_m3, motion.meanDisplacement_m(), motion.largestDisplacement_m, motion.minJ})
          text += ',' + formatNumber(x);
      else
        text += ",,,,";
      text += '\n';
    }
  return writeWholeFile(file, text);
}

}  // namespace c3de::session
