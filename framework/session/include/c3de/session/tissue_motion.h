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
#include "c3de/session/tissue_voxels.h"

namespace c3de::session {

/// Displacement and deformation of labels, from the tracked voxels. Sums over labels are those of a tissue.
struct LabelMotion {
  double reference_m3 = 0.0, end_m3 = 0.0;  ///< reference volume and present volume
  double displacementSum_m = 0.0, largestDisplacement_m = 0.0;
  double minJ = 0.0;                     ///< smallest det F
  std::size_t followed = 0, sample = 0;  ///< voxels; those that were not found again count in neither sum

  [[nodiscard]] bool isKnown() const { return followed > 0; }
  [[nodiscard]] double meanDisplacement_m() const { return displacementSum_m / static_cast<double>(followed); }
  void add(const LabelMotion &other);
};

/// One entry for each label of TissueVoxels::labels.
struct TissueMotion {
  TissueVoxels places;
  std::vector<LabelMotion> labels;
  /// Over all labels of a tissue, or of the background (index: number of tissues).
  [[nodiscard]] LabelMotion ofTissue(std::size_t tissue) const;
};

/// What a simulator reports about the present state of its bodies.
struct TissueSnapshot {
  std::shared_ptr<const imaging::DisplacementGrid> u;
  std::vector<BodyState> skins;
};
/// Full: a grid around the bodies at a quarter of the spacing, coarser where an axis would exceed 144 points. Live:
/// half the spacing and up to 72 points, which takes an eighth of the time.
enum class TissueDetail { full, live };
/// The error (ErrorCode::state): the simulator does not provide it. [sim]
[[nodiscard]] Expected<TissueSnapshot> readTissues(const c3de_simulator_v1 *table, c3de_object *simulator,
                                                   TissueDetail detail = TissueDetail::full);
/// Same, from an existing displacement of this state, at almost no cost. Additional error: its grid does not contain
/// all bodies. [sim]
[[nodiscard]] Expected<TissueSnapshot> readTissues(c3de_object *simulator,
                                                   std::shared_ptr<const imaging::DisplacementGrid> u);
/// Any thread. @param goesOn  called for every label; false ends it with ErrorCode::cancelled
[[nodiscard]] Expected<std::vector<TissueMotion>> followTissues(const TissueSnapshot &snapshot,
                                                                const std::vector<TissueVoxels> &bodies,
                                                                const std::function<bool()> &goesOn = {});
/// Both at full detail. From the displacement that the simulator reports for an image: x with x - u(x) = X for each
/// voxel of a sample, and det F = 1 / det(1 - grad u) there. The result is thus smoothed over about one spacing. Rigid
/// tissues are reported as fixed. [sim]
[[nodiscard]] Expected<std::vector<TissueMotion>> tissueMotions(const c3de_simulator_v1 *table, c3de_object *simulator,
                                                                const std::vector<TissueVoxels> &bodies);

/// One row for each label, CSV: `body,label,name,tissue,material,rigid,voxels,volume [m3],…`. Errors: output.
[[nodiscard]] Expected<void> writeTissueTable(const std::filesystem::path &file,
                                              const std::vector<TissueMotion> &bodies);

}  // namespace c3de::session
