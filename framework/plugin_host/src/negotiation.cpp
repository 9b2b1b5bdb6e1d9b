// SPDX-License-Identifier: Apache-2.0
#include "negotiation.h"

#include <fmt/format.h>

#include <cstring>

#include "arguments.h"
#include "c3de/core/text.h"
#include "last_error.h"
#include "refusal.h"
#include "services/catalogue.h"

namespace c3de::plugin_host {
namespace {

// A larger descriptor is invalid data, not a newer one.
constexpr std::uint32_t kPlausibleSize = 65536;
constexpr std::uint64_t kMaxNeeds = 256;

[[noreturn]] void refuseDescriptor(const std::string &why) { throw Refusal(C3DE_E_ARG, "bad descriptor: " + why); }

std::string majors(const c3de_offer &offer) {
  return offer.abi_min == offer.abi_max ? fmt::format("{}", offer.abi_min)
                                        : fmt::format("{} to {}", offer.abi_min, offer.abi_max);
}

/// Calls the query function; throws Refusal.
const c3de_plugin *query(c3de_plugin_query_fn queryFn, const c3de_offer &offer) {
  c3de_answer answer{};
  answer.size = sizeof answer;
  c3de_status status = C3DE_E_EXCEPTION;
  try {
    status = queryFn(&offer, &answer);
  } catch (const std::exception &e) {
    throw Refusal(C3DE_E_EXCEPTION,
                  fmt::format("an exception left {}: {}", C3DE_PLUGIN_QUERY_SYMBOL, displayText(e.what())));
  } catch (...) {
    throw Refusal(C3DE_E_EXCEPTION, fmt::format("an exception left {}", C3DE_PLUGIN_QUERY_SYMBOL));
  }
  answer.why_not[sizeof answer.why_not - 1] = '\0';
  if (status < 0) {
    const std::string why = displayText(answer.why_not);
    throw Refusal(status, fmt::format("the plugin declines: {} (this host serves plugin ABI {})",
                                      why.empty() ? statusName(status) : why, majors(offer)));
  }
  if (answer.abi_major < offer.abi_min || answer.abi_major > offer.abi_max)
    throw Refusal(C3DE_E_VERSION,
                  fmt::format("built for plugin ABI {}, this host serves {}: get {}", answer.abi_major, majors(offer),
                              answer.abi_major > offer.abi_max ? "a newer host or an older build of the plugin"
                                                               : "a newer build of the plugin"));
  if (!answer.plugin) refuseDescriptor("the plugin is null");
  return answer.plugin;
}

void checkNeeds(const c3de_plugin &plugin, const Services &services) {
  if (plugin.needs_n > kMaxNeeds)
    refuseDescriptor(fmt::format("needs_n is {}, accepted are at most {}", plugin.needs_n, kMaxNeeds));
  if (plugin.needs_n == 0) return;
  if (!plugin.needs) refuseDescriptor(fmt::format("needs is null, needs_n is {}", plugin.needs_n));
  std::uint64_t stride = 0;
  try {
    stride = strideOf(plugin.needs, plugin.needs_stride, "needs");
  } catch (const Refusal &refusal) {
    refuseDescriptor(refusal.what());
  }
  const auto *bytes = reinterpret_cast<const unsigned char *>(plugin.needs);
  for (std::uint64_t i = 0; i < plugin.needs_n; ++i) {
    const auto need = structOf(reinterpret_cast<const c3de_service_req *>(bytes + i * stride), "needs entry");
    const std::string id = idOf(need.id, "needs id");
    if (need.flags != C3DE_REQUIRED && need.flags != C3DE_OPTIONAL)
      refuseDescriptor(fmt::format("needs {}: flags is {}, accepted: 1 (required), 2 (optional)", id, need.flags));
    if (need.flags != C3DE_REQUIRED) continue;
    try {
      (void)findService(id, need.min_rev, services);
    } catch (const Refusal &refusal) {
      const char *action =
          refusal.status() == C3DE_E_UNSUPPORTED ? "" : "; get a newer host or an older build of the plugin";
      throw Refusal(refusal.status(), fmt::format("needs {}{}", refusal.what(), action));
    }
  }
}

Candidate checkDescriptor(const c3de_plugin *descriptor, const Services &services) {
  std::uint32_t size = 0;
  std::memcpy(&size, descriptor, sizeof size);
  if (size < MinimumSize<c3de_plugin>::value || size > kPlausibleSize)
    refuseDescriptor(fmt::format("its member size is {}, accepted: from {} on", size, MinimumSize<c3de_plugin>::value));
  Candidate out;
  out.plugin = structOf(descriptor, "descriptor");
  try {
    out.id = idOf(out.plugin.id, "id");
    out.version = labelOf(out.plugin.version, "version");
    out.displayName = labelOf(out.plugin.display_name, "display_name");
    out.vendor = labelOf(out.plugin.vendor, "vendor");
    out.license = labelOf(out.plugin.license, "license");
  } catch (const Refusal &refusal) {
    refuseDescriptor(refusal.what());
  }
  if (const std::string problem = tableProblem(&out.plugin); !problem.empty()) refuseDescriptor(problem);
  checkNeeds(out.plugin, services);
  return out;
}

}  // namespace

Expected<Candidate> negotiate(const DynamicLibrary &library, const Services &services) {
  // dlsym and GetProcAddress require the conversion from void* to a function pointer.
  const auto queryFn = reinterpret_cast<c3de_plugin_query_fn>(library.symbol(C3DE_PLUGIN_QUERY_SYMBOL));
  if (!queryFn) return fail(ErrorCode::plugin, fmt::format("not a plugin: no symbol {}", C3DE_PLUGIN_QUERY_SYMBOL));
  c3de_offer offer{};
  offer.size = sizeof offer;
  offer.abi_min = offer.abi_max = C3DE_ABI_MAJOR;
  offer.abi_minor = C3DE_ABI_MINOR;
  offer.host_name = toAbi("C3DE");
  offer.host_version = toAbi(C3DE_VERSION);
  if (!services.renderer && !services.panels) offer.flags |= C3DE_OFFER_HEADLESS;
  try {
    return checkDescriptor(query(queryFn, offer), services);
  } catch (const std::exception &refusal) {
    return fail(ErrorCode::plugin, refusal.what());
  }
}

}  // namespace c3de::plugin_host
