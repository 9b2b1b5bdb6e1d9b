// SPDX-License-Identifier: Apache-2.0
// The accuracy setting: the accuracy target of bodies, the sampling chosen for it, and the accuracy predicted for that
// sampling.
#pragma once

#include <array>
#include <memory>
#include <mutex>
#include <optional>

#include "base/parameters.h"
#include "c3de/abi/iface/parameter_ids.h"
#include "pointbased/accuracy.h"
#include "pointbased/adaptive_sampling.h"

namespace pointbased {

/// Read from the world's parameters. A budget is the share of one of accuracy.bodies.
[[nodiscard]] AccuracyTarget accuracyTargetOf(const ParameterValues &world);
/// Ids of the accuracy targets; at most one of them may differ from auto.
inline constexpr std::array<std::string_view, 3> kAccuracyTargets{C3DE_PARAM_ID_ERROR_PERCENT, C3DE_PARAM_ID_ERROR_MM,
                                                                  C3DE_PARAM_ID_BUDGET_MS};
[[nodiscard]] bool isAccuracyTarget(std::string_view id);
/// A new target replaces the previous one. Two targets in the same call contradict each other and are refused.
[[nodiscard]] sdk::Result<void> resolveAccuracyTarget(ParameterValues &world, const c3de_param_value *values,
                                                      std::uint64_t n, std::uint64_t stride);
/// The target as a scene writes it: "error_percent = 5". Empty for the standard target.
[[nodiscard]] std::string textOf(const AccuracyTarget &wish);

/// Whether single precision, accurate to a millionth of the strains, is far more accurate than the target requires.
[[nodiscard]] bool isFarCoarserThanSingle(const AccuracyTarget &wish);

/// Speed of this machine. Measured once, stored in the settings of the plugin, and measured again when the machine has
/// changed. Any thread; the first call of a run may take a second.
class MachineSpeedCache {
 public:
  MachineSpeedCache(sdk::Host host, const Services &services) : host_(host), services_(services) {}
  [[nodiscard]] const MachineSpeed &speed();

 private:
  sdk::Host host_;
  const Services &services_;
  std::mutex mutex_;
  std::optional<MachineSpeed> speed_;
};

/// Input of the accuracy setting for building one body.
struct SamplingRequest {
  AccuracyTarget wish;
  Vec3 gravity = Vec3::Zero();  ///< m/s²
  CostSetting setting;
  /// measureFrame() of a built body in its world. Empty: the predicted time is used.
  std::function<double(const Body &, const StopRequest *)> frameTime;
};

/// Outcome of a request for finer cells, as display text.
[[nodiscard]] std::string adaptiveText(const AdaptiveSampling &adaptive);
/// How much mass scaling has added to a body; empty if none.
[[nodiscard]] std::string addedMassText(const Body &body);

/// What was chosen for a body whose sampling is not specified.
struct AccuracyPrediction {
  AccuracyTarget wish;
  SamplingChoice choice;
  std::shared_ptr<const AccuracySurvey> survey;  ///< null: there is no prediction
  std::string unpredicted;                       ///< why there is no prediction; `choice` is then only a count
  bool isMeasured = false;  ///< choice.frame_ms was measured on the body at rest, otherwise it is predicted

  [[nodiscard]] bool supposed() const { return survey && survey->supposed; }
  /// Called once the body has been built.
  void built(const RestState &rest);
  /// Called with the measured time of one frame, ms; 0 if it could not be measured.
  void measured(double ms);
};

/// Throws sdk::Error if a body specifies its own sampling in a world that specifies its accuracy.
void refuseConflictingSampling(const std::string &name, const ParameterValues &body, const AccuracyTarget &wish);

/// What contact adds to the time of a frame: "3.2 ms more while …".
[[nodiscard]] std::string touchingText(const AccuracyPrediction &promise);
/// One line of display text; empty if there is nothing to report.
[[nodiscard]] std::string noticeOf(const std::string &name, const AccuracyPrediction &promise);

}  // namespace pointbased
