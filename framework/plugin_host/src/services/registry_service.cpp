// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "arguments.h"
#include "c3de/core/text.h"
#include "services/services.h"

namespace c3de::plugin_host {
namespace {

constexpr std::uint64_t kMaxInterfaces = 64;

c3de_status C3DE_CALL addClass(void *ctx, const c3de_class *cls) noexcept {
  return serveOnMain(ctx, "registry.add_class", [&](PluginContext &plugin) {
    const c3de_class in = tableOf(cls, "class");
    ClassRegistry::Entry entry;
    entry.info.id = idOf(in.id, "class id");
    entry.info.label = labelOf(in.label, "class label");
    entry.info.doc = labelOf(in.doc, "class doc", Lines::many);
    entry.info.plugin = plugin.id();
    if (in.ifaces_n > kMaxInterfaces)
      throw Refusal(C3DE_E_ARG, fmt::format("{}: ifaces_n is {}, accepted are at most {}", entry.info.id, in.ifaces_n,
                                            kMaxInterfaces));
    if (in.ifaces_n > 0) requireNonNull(in.ifaces, "ifaces");
    for (std::uint64_t i = 0; i < in.ifaces_n; ++i) entry.info.interfaces.push_back(idOf(in.ifaces[i], "interface id"));
    entry.factory = in.factory;
    entry.create = in.create;
    const std::string id = entry.info.id;
    std::string takenBy;
    if (!plugin.host().classes.add(std::move(entry), takenBy))
      throw Refusal(C3DE_E_EXISTS, fmt::format("class {} is registered by plugin {} already", id, takenBy));
  });
}

c3de_status C3DE_CALL removeClass(void *ctx, c3de_str id) noexcept {
  return serveOnMain(ctx, "registry.remove_class", [&](PluginContext &plugin) {
    const std::string name = textOf(id, "class id");
    if (!plugin.host().classes.remove(name, plugin.id()))
      throw Refusal(C3DE_E_NOT_FOUND, fmt::format("plugin {} has no class '{}'", plugin.id(), name));
  });
}

c3de_status C3DE_CALL enumClasses(void *ctx, c3de_str interfaceId, void *self,
                                  c3de_status(C3DE_CALL *each)(void *self, const c3de_class_info *info)) noexcept {
  return serve(ctx, "registry.enum_classes", [&](PluginContext &plugin) -> c3de_status {
    requireNonNull(each, "each");
    // A copy, because each() may register or remove classes.
    for (const ClassInfo &info : plugin.host().classes.list(textOf(interfaceId, "interface id"))) {
      std::vector<c3de_str> interfaces;
      for (const std::string &name : info.interfaces) interfaces.push_back(toAbi(name));
      const c3de_class_info out{sizeof(c3de_class_info), 0,
                                toAbi(info.id),          toAbi(info.label),
                                toAbi(info.doc),         toAbi(info.plugin),
                                interfaces.data(),       interfaces.size()};
      if (const c3de_status status = each(self, &out); status != C3DE_OK) return status;
    }
    return C3DE_OK;
  });
}

c3de_status C3DE_CALL create(void *ctx, c3de_str classId, c3de_object **out) noexcept {
  return serveOnMain(ctx, "registry.create", [&](PluginContext &plugin) {
    *requireNonNull(out, "out") = nullptr;
    *out = plugin.host().classes.create(textOf(classId, "class id"));
  });
}

}  // namespace

c3de_registry_v1 makeRegistryTable(PluginContext *plugin) {
  return {sizeof(c3de_registry_v1), kServiceRevision, plugin, &addClass, &removeClass, &enumClasses, &create};
}

}  // namespace c3de::plugin_host
