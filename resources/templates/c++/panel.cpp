// My plugin: a panel with a button, and a line in the log. Without a window there is the line alone.
#include "c3de/sdk/sdk.hpp"

namespace {

namespace sdk = c3de::sdk;

class MyPlugin : public sdk::Panel {
 public:
  static constexpr sdk::PluginInfo info{
      .id = "org.example.my_plugin", .version = "0.1.0", .displayName = "My plugin", .vendor = "Your name", .license = "MIT"};
  static constexpr std::array needs{sdk::required<c3de_log_v1>(), sdk::optional<c3de_panels_v1>()};

  explicit MyPlugin(sdk::Host host) {
    sdk::Log(host).info("My plugin is there");
    if (host.service<c3de_panels_v1>()) sdk::orThrow(show(host, "org.example.my_plugin.panel", "My plugin"));
  }

  void draw(sdk::Ui &ui) override {
    ui.text("Pressed " + std::to_string(pressed_) + " times.");
    if (ui.button("press", "Press")) ++pressed_;
  }

 private:
  int pressed_ = 0;
};

}  // namespace

C3DE_DEFINE_PLUGIN(MyPlugin)
