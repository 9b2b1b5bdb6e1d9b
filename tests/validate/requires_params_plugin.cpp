// SPDX-License-Identifier: Apache-2.0
// A good plugin that requires parameters or, by a build option, panels.
#include "c3de/sdk/sdk.hpp"

namespace {

namespace sdk = c3de::sdk;

constexpr std::array kParams{sdk::numberParam({.id = "size", .label = "Size", .unit = "m", .doc = "How large."},
                                              {.min = 0.0, .max = 1.0, .softMin = 0.0, .softMax = 1.0}, 0.5)};

class Plugin {
 public:
#if defined(REQUIRES_PANELS)
  static constexpr sdk::PluginInfo info{.id = "test.requires_panels", .version = "1.0.0", .displayName = "Panels"};
  static constexpr std::array needs{sdk::required<c3de_params_v1>(), sdk::required<c3de_panels_v1>()};
#else
  static constexpr sdk::PluginInfo info{.id = "test.requires_params", .version = "1.0.0", .displayName = "Parameters"};
  static constexpr std::array needs{sdk::required<c3de_params_v1>()};
#endif
  explicit Plugin(sdk::Host host)
      : params_(sdk::orThrow(sdk::Params(host).declare("Size", kParams, [](const c3de_param_value &) {}))) {}

 private:
  sdk::ParameterSet params_;
};

}  // namespace

C3DE_DEFINE_PLUGIN(Plugin)
