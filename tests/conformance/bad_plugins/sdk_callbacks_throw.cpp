// SPDX-License-Identifier: Apache-2.0
// Written with the SDK: its periodic callbacks throw, in functions that return nothing.
#include <stdexcept>

#include "c3de/sdk/sdk.hpp"

namespace {

namespace sdk = c3de::sdk;

class Thrower : public sdk::Panel {
 public:
  static constexpr sdk::PluginInfo info{.id = "test.sdk_callbacks_throw", .version = "1.0.0"};
  explicit Thrower(sdk::Host host) {
    sdk::orThrow(show(host, "test.panel", "Throwing panel"));
    watch_ = sdk::orThrow(sdk::Simulation(host).watch(
        {}, {}, [](c3de_handle, std::uint64_t, double) { throw std::runtime_error("thrown after a step"); }));
    frame_ = sdk::orThrow(sdk::Time(host).addFrameCallback([] { throw std::runtime_error("thrown in a frame"); }));
  }
  void draw(sdk::Ui &) override { throw std::runtime_error("thrown in a panel"); }

 private:
  sdk::SimulationWatch watch_;
  sdk::FrameCallback frame_;
};

}  // namespace

C3DE_DEFINE_PLUGIN(Thrower)
