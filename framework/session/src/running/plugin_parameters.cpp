// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/plugin_parameters.h"

#include <charconv>
#include <optional>
#include <string_view>

#include "c3de/core/text.h"

namespace c3de::session {
namespace {

std::optional<double> numberOf(std::string_view text) {
  double value = 0.0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  return code == std::errc() && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

std::optional<Vec3> vectorOf(std::string_view text) {
  Vec3 value{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t comma = axis < 2 ? text.find(',') : text.size();
    if (comma == std::string_view::npos) return std::nullopt;
    const auto number = numberOf(text.substr(0, comma));
    if (!number) return std::nullopt;
    value[axis] = *number;
    text.remove_prefix(std::min(comma + 1, text.size()));
  }
  return value;
}

/// Converts to the declared type. A text that is not a valid value is passed on as text, which the check refuses.
ParameterValue valueOf(const ParameterDecl &decl, const std::string &text) {
  ParameterValue value;
  value.id = decl.id;
  value.type = C3DE_PARAM_TEXT;
  value.text = text;
  if (decl.type == C3DE_PARAM_CHOICE || decl.type == C3DE_PARAM_TEXT) {
    value.type = decl.type;
  } else if (decl.type == C3DE_PARAM_BOOL && (text == "true" || text == "false")) {
    value.type = decl.type;
    value.num = text == "true" ? 1.0 : 0.0;
  } else if (const auto vector = vectorOf(text); decl.type == C3DE_PARAM_VEC3 && vector) {
    value.type = decl.type;
    value.vec = *vector;
  } else if (const auto number = numberOf(text);
             (decl.type == C3DE_PARAM_F64 || decl.type == C3DE_PARAM_I64) && number) {
    value.type = decl.type;
    value.num = *number;
  }
  return value;
}

}  // namespace

Expected<void> setPluginParameter(registry::ParameterRegistry &parameters,
                                  const std::vector<plugin_host::PluginInfo> &plugins, const std::string &assignment) {
  const std::string what = "--plugin-param " + assignment + ": ";
  const std::size_t colon = assignment.find(':'), equals = assignment.find('=');
  if (colon == std::string::npos || equals == std::string::npos || colon == 0 || equals < colon + 2)
    return fail(ErrorCode::usage, what + "accepted: PLUGIN:ID=VALUE, for example org.c3de.magnet:strength=20");
  const std::string plugin = assignment.substr(0, colon), id = assignment.substr(colon + 1, equals - colon - 1),
                    text = assignment.substr(equals + 1);
  std::vector<std::string> owners;
  for (const plugin_host::PluginInfo &one : plugins)
    if (!parameters.ownedBy(one.id).empty()) owners.push_back(one.id);
  const std::vector<Handle> sets = parameters.ownedBy(plugin);
  if (sets.empty()) {
    const std::string nearest = nearestName(plugin, owners);
    return fail(ErrorCode::usage, what + "no plugin '" + plugin + "' has parameters" +
                                      (nearest.empty() ? "" : "; did you mean " + nearest + "?"));
  }
  std::vector<std::string> ids;
  for (const Handle set : sets)
    for (const ParameterDecl &decl : parameters.find(set)->decls) {
      ids.push_back(decl.id);
      if (decl.id != id) continue;
      if (const auto done = parameters.set(set, valueOf(decl, text), true); !done)
        return fail(ErrorCode::usage, what + done.error().message);
      return {};
    }
  const std::string nearest = nearestName(id, ids);
  std::string all;
  for (const std::string &one : ids) all += (all.empty() ? "" : ", ") + one;
  return fail(ErrorCode::usage, what + "there is no parameter '" + id + "'" +
                                    (nearest.empty() ? "; there are: " + all : "; did you mean " + nearest + "?"));
}

}  // namespace c3de::session
