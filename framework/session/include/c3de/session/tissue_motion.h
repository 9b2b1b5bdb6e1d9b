// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "c3de/abi/iface/simulator.h"
#include "c3de/core/expected.h"
#include "c3de/imaging/displacement.h"
#include "c3de/session/body_states.h"
#include "c3de/session/tissue_places.h"

namespace c3de::session {

/// How labels have moved and changed, of the voxels that were followed; sums of labels are those of a tissue.
struct LabelMotion {
  double reference_m3 = 0.0, end_m3 = 0.0;  ///< volume at rest and now
  double displacementSum_m = 0.0, largestDisplacement_m = 0.0;
  double minJ = 0.0;                     ///< smallest det F
  std::size_t followed = 0, sample = 0;  ///< voxels; those that were not found again count in neither sum

  [[nodiscard]] bool isKnown() const { return followed > 0; }
  [[nodiscard]] double meanDisplacement_m() const { return displacementSum_m / static_cast<double>(followed); }
  void add(const LabelMotion &other);
};

/// Of each label of TissuePlaces::labels.
struct TissueMotion {
  TissuePlaces places;
  std::vector<LabelMotion> labels;
  /// Of all labels of a tissue, or of the background (their count).
  [[nodiscard]] LabelMotion ofTissue(std::size_t tissue) const;
};

/// What a simulator says of its bodies as they are now.
struct TissueSnapshot {
  std::shared_ptr<const imaging::DisplacementGrid> u;
  std::vector<BodyState> skins;
};
/// On a grid of a quarter of the spacing around the bodies, coarser where that is more than 144 points along an axis;
/// live: of half the spacing and up to 72 points, which takes an eighth of the time.
enum class TissueDetail { full, live };
/// The error (ErrorCode::state): the simulator does not say. [sim]
[[nodiscard]] Expected<TissueSnapshot> readTissues(const c3de_simulator_v1 *table, c3de_object *simulator,
                                                   TissueDetail detail = TissueDetail::full);
/// The same from a displacement of this state that is there already, which takes next to no time. The error as well:
/// its grid does not hold all bodies. [sim]
[[nodiscard]] Expected<TissueSnapshot> readTissues(c3de_object *simulator,
                                                   std::shared_ptr<const imaging::DisplacementGrid> u);
/// Any thread. @param goesOn  asked for every label; false ends it with ErrorCode::cancelled
[[nodiscard]] Expected<std::vector<TissueMotion>> followTissues(const TissueSnapshot &snapshot,
                                                                const std::vector<TissuePlaces> &bodies,
                                                                const std::function<bool()> &goesOn = {});
/// Both, in full: from the displacement that the simulator tells of an image, x with x - u(x) = X for each voxel of a
/// sample, and det F = 1 / det(1 - grad u) there. So it is smoothed over about a spacing. Rigid tissues are said to
/// stay. [sim]
[[nodiscard]] Expected<std::vector<TissueMotion>> tissueMotions(const c3de_simulator_v1 *table, c3de_object *simulator,
                                                                const std::vector<TissuePlaces> &bodies);

/// One row for each label, CSV: `body,label,name,tissue,material,rigid,voxels,volume [m3],…`. Errors: output.
[[nodiscard]] Expected<void> writeTissueTable(const std::filesystem::path &file,
                                              const std::vector<TissueMotion> &bodies);

}  // namespace c3de::session
