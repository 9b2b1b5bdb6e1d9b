// My plugin: a wind along x on every body that is simulated.
#include "c3de/sdk/sdk.hpp"

namespace {

namespace sdk = c3de::sdk;

constexpr double kAcceleration_m_s2 = 1.0;

class MyPlugin {
 public:
  static constexpr sdk::PluginInfo info{
      .id = "org.example.my_plugin", .version = "0.1.0", .displayName = "My plugin", .vendor = "Your name", .license = "MIT"};
  static constexpr std::array needs{sdk::required<c3de_forces_v1>()};

  explicit MyPlugin(sdk::Host host) : field_(sdk::orThrow(sdk::Forces(host).add("wind", blow))) {}

 private:
  // On the simulation's thread, before each step, for each body.
  static sdk::Result<void> blow(const c3de_force_call &call) {
    for (std::uint64_t i = 0; i < call.count; ++i) call.forces_N[3 * i] += call.masses_kg[i] * kAcceleration_m_s2;
    return {};
  }

  sdk::ForceField field_;
};

}  // namespace

C3DE_DEFINE_PLUGIN(MyPlugin)
