// SPDX-License-Identifier: Apache-2.0
// Written with the SDK: its constructor throws, and a thunk converts that into a status.
#include "c3de/sdk/sdk.hpp"

namespace {

class Thrower {
 public:
  static constexpr c3de::sdk::PluginInfo info{.id = "test.sdk_throws", .version = "1.0.0"};
  explicit Thrower(c3de::sdk::Host) { throw c3de::sdk::Error(C3DE_E_IO, "the presets cannot be read"); }
};

}  // namespace

C3DE_DEFINE_PLUGIN(Thrower)
