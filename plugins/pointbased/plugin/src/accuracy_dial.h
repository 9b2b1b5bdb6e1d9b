// SPDX-License-Identifier: Apache-2.0
// The dial: what is wished of the accuracy of bodies, what was chosen for it, and what that promises.
#pragma once

#include <array>
#include <memory>
#include <mutex>
#include <optional>

#include "c3de/abi/iface/parameter_ids.h"
#include "parameters.h"
#include "pointbased/accuracy.h"
#include "pointbased/adaptive_sampling.h"

namespace pointbased {

/// Of the world's parameters; a budget is the share of one of accuracy.bodies.
[[nodiscard]] AccuracyWish wishOf(const ParameterValues &world);
/// Ids of the wishes, of which one may be other than auto.
inline constexpr std::array<std::string_view, 3> kWishes{C3DE_PARAM_ID_ERROR_PERCENT, C3DE_PARAM_ID_ERROR_MM,
                                                         C3DE_PARAM_ID_BUDGET_MS};
[[nodiscard]] bool isAWish(std::string_view id);
/// A wish takes the place of the one before; two of them in the same call contradict each other.
[[nodiscard]] sdk::Result<void> settleWishes(ParameterValues &world, const c3de_param_value *values, std::uint64_t n,
                                             std::uint64_t stride);
/// The wish as a scene says it: "error_percent = 5"; empty: the standard one.
[[nodiscard]] std::string textOf(const AccuracyWish &wish);

/// Whether single precision, good to a millionth of the strains, is far better than what is wished.
[[nodiscard]] bool isFarCoarserThanSingle(const AccuracyWish &wish);

/// How fast this machine is: measured once, kept in the settings of the plugin, measured again where it has become
/// another one. Any thread; the first call of a run may take a second.
class SpeedKeeper {
 public:
  SpeedKeeper(sdk::Host host, const Services &services) : host_(host), services_(services) {}
  [[nodiscard]] const MachineSpeed &speed();

 private:
  sdk::Host host_;
  const Services &services_;
  std::mutex mutex_;
  std::optional<MachineSpeed> speed_;
};

/// What the builder of a body asks the dial.
struct DialRequest {
  AccuracyWish wish;
  Vec3 gravity = Vec3::Zero();  ///< m/s²
  CostSetting setting;
  /// measureFrame() of a built body in its world; empty: what is predicted counts
  std::function<double(const Body &, const StopRequest *)> frameTime;
};

/// What has become of a wish for finer cells, for a person.
[[nodiscard]] std::string adaptiveText(const AdaptiveSampling &adaptive);
/// How much mass scaling has added to a body; empty: nothing.
[[nodiscard]] std::string addedMassText(const Body &body);

/// What was chosen for a body whose sampling nobody has said.
struct AccuracyPromise {
  AccuracyWish wish;
  SamplingChoice choice;
  std::shared_ptr<const AccuracySurvey> survey;  ///< null: there is no prediction
  std::string unpredicted;                       ///< why there is no prediction; `choice` is but a count then
  bool isMeasured = false;  ///< choice.frame_ms is what the body took at rest, else what is predicted

  [[nodiscard]] bool supposed() const { return survey && survey->supposed; }
  /// The body has been built.
  void built(const RestState &rest);
  /// A frame of it takes so long, ms; 0: that could not be measured.
  void measured(double ms);
};

/// Refuses a body that says how fine it is sampled in a world that says how accurate it is to be, as sdk::Error.
void refuseTwoWays(const std::string &name, const ParameterValues &body, const AccuracyWish &wish);

/// What contact adds to a frame: "3.2 ms more while …".
[[nodiscard]] std::string touchingText(const AccuracyPromise &promise);
/// One line for people; empty: there is nothing that they should know.
[[nodiscard]] std::string noticeOf(const std::string &name, const AccuracyPromise &promise);

}  // namespace pointbased
