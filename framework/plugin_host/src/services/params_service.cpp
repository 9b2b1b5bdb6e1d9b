// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <set>

#include "arguments.h"
#include "c3de/registry/parameter_registry.h"
#include "services/callbacks.h"
#include "services/services.h"

namespace c3de::plugin_host {
namespace {

constexpr std::uint64_t kMaxDeclarations = 4096, kMaxChoices = 1024;
constexpr std::uint32_t kKnownFlags = C3DE_PARAM_LOG_SCALE | C3DE_PARAM_NEEDS_RESET | C3DE_PARAM_ADVANCED |
                                      C3DE_PARAM_MIN_OPEN | C3DE_PARAM_MAX_OPEN | C3DE_PARAM_AUTO | C3DE_PARAM_TOGETHER;

/// Checks everything on which later readers of the declaration rely.
ParameterDecl declarationOf(const c3de_param_decl *decl) {
  const c3de_param_decl in = structOf(decl, "declaration");
  const std::string id = idOf(in.id, "parameter id");
  if (in.type < C3DE_PARAM_F64 || in.type > C3DE_PARAM_VEC3)
    throw Refusal(C3DE_E_ARG, fmt::format("{}: type is {}, accepted: 1 to 6", id, in.type));
  if (in.flags & ~kKnownFlags)
    throw Refusal(C3DE_E_UNSUPPORTED,
                  fmt::format("{}: flags {:#x} are not known to this host", id, in.flags & ~kKnownFlags));
  for (const c3de_str text : {in.label, in.unit, in.doc, in.group, in.fallback_text}) (void)textOf(text, id.c_str());
  if (in.choices_n > kMaxChoices)
    throw Refusal(C3DE_E_ARG,
                  fmt::format("{}: choices_n is {}, accepted are at most {}", id, in.choices_n, kMaxChoices));
  if (in.choices_n > 0) requireNonNull(in.choices, "choices");
  for (std::uint64_t i = 0; i < in.choices_n; ++i)
    if (textOf(in.choices[i], "choice").empty()) throw Refusal(C3DE_E_ARG, id + ": a choice is empty");
  const bool isNumber = in.type == C3DE_PARAM_F64 || in.type == C3DE_PARAM_I64 || in.type == C3DE_PARAM_VEC3;
  if (isNumber && !(in.min <= in.max))
    throw Refusal(C3DE_E_ARG, fmt::format("{}: min {} is not below max {}", id, in.min, in.max));
  if (isNumber && (!std::isfinite(in.soft_min) || !std::isfinite(in.soft_max)))
    throw Refusal(C3DE_E_ARG,
                  fmt::format("{}: soft_min {} and soft_max {} must be finite", id, in.soft_min, in.soft_max));
  ParameterDecl out = ParameterDecl::from(in);
  if (const auto checked = checkParameter(out, out.fallbackValue()); !checked)
    throw Refusal(C3DE_E_ARG, "the default does not fit: " + checked.error().message);
  return out;
}

registry::ParameterSet &find(PluginContext &plugin, c3de_handle set) {
  registry::ParameterSet *found = plugin.services().parameters->find(handleOf(set));
  if (!found) throw Refusal(C3DE_E_STALE, fmt::format("there is no parameter set of handle {}", textOf(set)));
  return *found;
}

const ParameterDecl &declarationIn(const registry::ParameterSet &set, const std::string &id) {
  const auto decl = findParameter(set.decls, id);
  if (!decl) throw Refusal(C3DE_E_NOT_FOUND, decl.error().message);
  return **decl;
}

c3de_status C3DE_CALL declare(void *ctx, c3de_str title, const c3de_param_decl *decls, std::uint64_t n,
                              std::uint64_t stride, const c3de_param_listener *listener, c3de_handle *out) noexcept {
  return serveOnMain(ctx, "params.declare", [&](PluginContext &plugin) {
    requireNonNull(out, "out")->v = 0;
    registry::ParameterSet set;
    set.owner = plugin.id();
    set.title = labelOf(title, "title");
    if (n == 0 || n > kMaxDeclarations)
      throw Refusal(C3DE_E_ARG, fmt::format("n is {}, accepted: 1 to {}", n, kMaxDeclarations));
    requireNonNull(decls, "decls");
    const std::uint64_t step = strideOf(decls, stride, "decls");
    std::set<std::string> ids;
    const auto *bytes = reinterpret_cast<const unsigned char *>(decls);
    for (std::uint64_t i = 0; i < n; ++i) {
      set.decls.push_back(declarationOf(reinterpret_cast<const c3de_param_decl *>(bytes + i * step)));
      if (!ids.insert(set.decls.back().id).second)
        throw Refusal(C3DE_E_EXISTS, set.decls.back().id + " is declared twice");
    }
    std::shared_ptr<ListenerCallback> callback;
    if (listener) {
      const c3de_param_listener in = tableOf(listener, "listener");
      callback = std::make_shared<ListenerCallback>(plugin, in, set.title);
      set.listener = callback->trampoline();
    }
    const Handle handle = plugin.services().parameters->declare(std::move(set));
    plugin.parameterSets[handle.bits()] = std::move(callback);
    writeHandle(out, handle);
  });
}

c3de_status C3DE_CALL removeSet(void *ctx, c3de_handle set) noexcept {
  return serveOnMain(ctx, "params.remove", [&](PluginContext &plugin) {
    const registry::ParameterSet &found = find(plugin, set);
    if (found.owner != plugin.id())
      throw Refusal(C3DE_E_STATE, fmt::format("the set '{}' belongs to plugin {}", found.title, found.owner));
    plugin.services().parameters->remove(handleOf(set));
    plugin.parameterSets.erase(set.v);
  });
}

c3de_status C3DE_CALL get(void *ctx, c3de_handle set, c3de_str id, c3de_param_value *out) noexcept {
  return serveOnMain(ctx, "params.get", [&](PluginContext &plugin) {
    const registry::ParameterSet &found = find(plugin, set);
    const ParameterDecl &decl = declarationIn(found, textOf(id, "id"));
    const auto index = static_cast<std::size_t>(&decl - found.decls.data());
    writeStruct(out, found.values[index].abi(), "out");
  });
}

c3de_status C3DE_CALL setValue(void *ctx, c3de_handle set, const c3de_param_value *value) noexcept {
  return serveOnMain(ctx, "params.set", [&](PluginContext &plugin) {
    const registry::ParameterSet &found = find(plugin, set);
    const c3de_param_value in = structOf(value, "value");
    (void)textOf(in.text, "text");
    const ParameterDecl &decl = declarationIn(found, textOf(in.id, "id"));
    const ParameterValue owned = ParameterValue::from(in);
    if (const auto checked = checkParameter(decl, owned); !checked) throw Refusal(C3DE_E_ARG, checked.error().message);
    // The owner displays values without notification; changes by others notify the owner.
    const bool notifyListener = found.owner != plugin.id();
    orRefuse(plugin.services().parameters->set(handleOf(set), owned, notifyListener));
  });
}

}  // namespace

c3de_params_v1 makeParamsTable(PluginContext *plugin) {
  return {sizeof(c3de_params_v1), kServiceRevision, plugin, &declare, &removeSet, &get, &setValue};
}

}  // namespace c3de::plugin_host
