// My plugin: a tool that says where in the world the person has clicked. It needs a window.
#include <cstdio>

#include "c3de/sdk/sdk.hpp"

namespace {

namespace sdk = c3de::sdk;

class MyPlugin : public sdk::Tool {
 public:
  static constexpr sdk::PluginInfo info{
      .id = "org.example.my_plugin", .version = "0.1.0", .displayName = "My plugin", .vendor = "Your name", .license = "MIT"};
  static constexpr std::array needs{sdk::required<c3de_log_v1>(), sdk::optional<c3de_tools_v1>()};

  explicit MyPlugin(sdk::Host host) : log_(host) {
    // Without a window there are no tools, and that is no error.
    if (host.service<c3de_tools_v1>())
      sdk::orThrow(add(host, {.id = "org.example.my_plugin.tool",
                              .label = "My plugin",
                              .hint = "Click to see where you look",
                              .shortcut = 0}));
  }

  bool onEvent(const c3de_event &event) override {
    if (event.type != C3DE_EVENT_PRESS || event.button != C3DE_BUTTON_LEFT) return false;
    char text[160];
    std::snprintf(text, sizeof text, "ray from %.1f, %.1f, %.1f mm along %.3f, %.3f, %.3f", event.ray_origin_mm[0],
                  event.ray_origin_mm[1], event.ray_origin_mm[2], event.ray_direction[0], event.ray_direction[1],
                  event.ray_direction[2]);
    log_.info(text);
    return true;
  }

 private:
  sdk::Log log_;
};

}  // namespace

C3DE_DEFINE_PLUGIN(MyPlugin)
