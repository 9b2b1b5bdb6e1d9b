// SPDX-License-Identifier: Apache-2.0
// The entry of a plugin:
//
//   class Probe {
//    public:
//     static constexpr c3de::sdk::PluginInfo info{.id = "org.example.probe", .version = "1.0.0", .displayName =
//     "Probe"}; static constexpr std::array needs{c3de::sdk::required<c3de_log_v1>()};  // may be left out explicit
//     Probe(c3de::sdk::Host host);  // gets services, registers; may throw void start();                          //
//     start and stop may be left out void stop();
//   };
//   C3DE_DEFINE_PLUGIN(Probe)
#pragma once

#include <array>
#include <cstdio>
#include <memory>
#include <span>

#include "c3de/abi/entry.h"
#include "c3de/sdk/guard.hpp"

namespace c3de::sdk {

struct PluginInfo {
  std::string_view id{};  ///< reverse-DNS, for example "org.example.probe"
  std::string_view version{}, displayName{}, vendor{}, license{};
};

/// An entry of Plugin::needs: without the service the plugin is refused at load, with a line that says so.
template <class Table>
[[nodiscard]] constexpr c3de_service_req required(std::uint32_t minRev = 1) noexcept {
  return {sizeof(c3de_service_req), C3DE_REQUIRED, str(kTableId<Table>), minRev, 0};
}
template <class Table>
[[nodiscard]] constexpr c3de_service_req optional(std::uint32_t minRev = 1) noexcept {
  return {sizeof(c3de_service_req), C3DE_OPTIONAL, str(kTableId<Table>), minRev, 0};
}

namespace detail {

template <class Plugin>
struct PluginEntry {
  static c3de_status C3DE_CALL create(const c3de_host *host, void **self) noexcept {
    hostOfThisPlugin.store(host);
    const c3de_status status = guard([&] { *self = std::make_unique<Plugin>(Host(host)).release(); });
    if (status < 0) hostOfThisPlugin.store(nullptr);
    return status;
  }
  static c3de_status C3DE_CALL start(void *self) noexcept {
    if constexpr (requires(Plugin & p) { p.start(); })
      return guard([&] { return static_cast<Plugin *>(self)->start(); });
    else
      return C3DE_OK;
  }
  static c3de_status C3DE_CALL stop(void *self) noexcept {
    if constexpr (requires(Plugin & p) { p.stop(); })
      return guard([&] { return static_cast<Plugin *>(self)->stop(); });
    else
      return C3DE_OK;
  }
  static void C3DE_CALL destroy(void *self) noexcept {
    delete static_cast<Plugin *>(self);
    hostOfThisPlugin.store(nullptr);
  }

  static constexpr auto needs() noexcept {
    if constexpr (requires { Plugin::needs; })
      return std::span<const c3de_service_req>(Plugin::needs);
    else
      return std::span<const c3de_service_req>();
  }
  static constexpr c3de_plugin kPlugin{sizeof(c3de_plugin),
                                       1,
                                       str(Plugin::info.id),
                                       str(Plugin::info.version),
                                       str(Plugin::info.displayName),
                                       str(Plugin::info.vendor),
                                       str(Plugin::info.license),
                                       needs().data(),
                                       needs().size(),
                                       sizeof(c3de_service_req),
                                       &create,
                                       &start,
                                       &stop,
                                       &destroy};

  /// Pure and without allocation, as the entry asks for.
  static c3de_status query(const c3de_offer *offer, c3de_answer *answer) noexcept {
    if (!offer || !answer || !C3DE_HAS(c3de_offer, offer, abi_max) || !C3DE_HAS(c3de_answer, answer, plugin))
      return C3DE_E_ARG;
    answer->abi_major = C3DE_ABI_MAJOR;
    answer->abi_minor = C3DE_ABI_MINOR;
    answer->plugin = nullptr;
    if (offer->abi_min > C3DE_ABI_MAJOR || offer->abi_max < C3DE_ABI_MAJOR) {
      if (C3DE_HAS(c3de_answer, answer, why_not))
        std::snprintf(answer->why_not, sizeof answer->why_not, "built for ABI %u, the host offers %u to %u",
                      C3DE_ABI_MAJOR, offer->abi_min, offer->abi_max);
      return C3DE_E_VERSION;
    }
    answer->plugin = &kPlugin;
    return C3DE_OK;
  }
};

}  // namespace detail
}  // namespace c3de::sdk

/// Emits the one exported function of the binary. Once per plugin, in a source file, outside namespaces.
#define C3DE_DEFINE_PLUGIN(PluginClass)                                                               \
  C3DE_EXPORT c3de_status C3DE_CALL c3de_plugin_query(const c3de_offer *offer, c3de_answer *answer) { \
    return ::c3de::sdk::detail::PluginEntry<PluginClass>::query(offer, answer);                       \
  }
