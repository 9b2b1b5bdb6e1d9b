// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "c3de/abi/iface/matching.h"
#include "c3de/core/expected.h"
#include "c3de/core/progress.h"
#include "c3de/registration/rigid_registration.h"

namespace c3de::session {

/// Null: the simulator does not match bodies. Errors (plugin): its table is malformed.
[[nodiscard]] Expected<const c3de_matching_v0 *> matchingTable(c3de_object *simulator);

struct BodyMatchOptions {
  Mat4 measuredFromBody = kIdentity4;  ///< rigid motion from which the match starts
  bool isMotionKnown = false;          ///< it is exact and is not changed
  double noise_mm = 1.0;               ///< > 0: standard deviation of a point across the surface
  /// kPa/mm, >= 0: stiffness of the surroundings where the body has none and no support holds it
  double support_kPa_mm = 0.1;
  bool continuesLast = false;  ///< starts from the deformation of the last match of the body, as for the next frame
  /// Snapshots show each iteration during the match; a step ends that
  bool showsIterations = false;
};

/// How a body deforms to meet measured points.
struct BodyMatch {
  bool hasConverged = false;
  unsigned iterations = 0;
  Mat4 measuredFromBody = kIdentity4;  ///< rigid motion of the deformed body, in mm
  /// Distances of the points to the surface, root mean square by robust weights: at the start, after the rigid motion,
  /// now
  double before_mm = 0.0, rigid_mm = 0.0, after_mm = 0.0;
  double noise_mm = 0.0;  ///< of the points, as it was requested
  double usedPart = 0.0;  ///< 0 … 1: of the points; the others count as false
  double force_N = 0.0;   ///< sum of the magnitudes of the forces that were found
  /// Expected, without errors of the model; none: the simulator does not estimate them
  struct ExpectedError {
    double rms_mm = 0.0, largest_mm = 0.0;
    double unknownPart = 0.0;  ///< 0 … 1: of the body, which the points hardly determine
    /// So much of the body is hardly determined that the expected errors are lower bounds.
    [[nodiscard]] bool isLowerBound() const { return unknownPart > 0.2; }
  };
  std::optional<ExpectedError> error;
  std::vector<std::optional<double>> distance_mm;  ///< [points]; none: no part of the surface faces the point
  /// Expected errors at the vertices of the skin; none: the points determine hardly anything there. Empty: not known.
  std::vector<std::optional<double>> skinErrors_mm;
  std::vector<double> weights;            ///< [points] 0 … 1
  std::vector<double> landmarkErrors_mm;  ///< [pairs]
};

/// Deforms a body of the simulator so that its surface meets the points; the simulator is then in that state, held by
/// the forces that were found. Errors: the simulator does not match bodies, or has none of this name; its own reason
/// (plugin); cancelled. Nothing has changed then. Any thread.
/// @param owner      plugin of the simulator
/// @param takeError  returns the text of the last failed call
[[nodiscard]] Expected<BodyMatch> matchBody(c3de_object *simulator, const std::string &body,
                                            const registration::MeasuredSurface &measured,
                                            const BodyMatchOptions &options, const char *owner,
                                            const std::function<std::string()> &takeError,
                                            const ProgressFn &progress = {});

}  // namespace c3de::session
