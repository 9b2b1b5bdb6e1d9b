// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/live_parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "c3de/core/text.h"
#include "c3de/session/simulator_access.h"

namespace c3de::session {
namespace {

constexpr std::string_view kBody = "body.", kMaterial = "material.", kOption = "--set ";

/// For callers who wrote no option.
Error withoutOption(Error error) {
  if (error.message.starts_with(kOption)) error.message.erase(0, kOption.size());
  return error;
}

bool isDeclared(const std::vector<ParameterDecl> &decls, std::string_view id) {
  return std::any_of(decls.begin(), decls.end(), [&](const ParameterDecl &one) { return one.id == id; });
}

/// The only id that ends with the key; empty: none, or several.
std::string fullId(const std::vector<ParameterDecl> &decls, const std::string &key) {
  if (std::string inMaterial = kMaterial.data() + key; isDeclared(decls, inMaterial)) return inMaterial;
  const std::string ending = "." + key;
  std::string found;
  for (const ParameterDecl &one : decls) {
    if (!one.id.ends_with(ending)) continue;
    if (!found.empty()) return {};
    found = one.id;
  }
  return found;
}

}  // namespace

Expected<void> applyAssignment(scene::SceneFile &scene, const std::string &assignment,
                               const scene::MaterialLibrary &materials) {
  auto applied = scene::applyOverride(scene, assignment, &materials);
  if (applied) return applied;
  const std::size_t equals = std::min(assignment.find('='), assignment.size());
  const std::size_t dot = assignment.rfind('.', equals);
  if (assignment.starts_with(kBody) && dot != std::string::npos && dot > kBody.size())
    if (const std::string longer = assignment.substr(0, dot + 1) + kMaterial.data() + assignment.substr(dot + 1);
        scene::applyOverride(scene, longer, &materials))
      return {};
  return tl::unexpected(withoutOption(applied.error()));
}

Expected<LiveParameters> LiveParameters::create(Session &session, c3de_object *simulator,
                                                const SimulationSource &source) {
  const auto table = simulatorTable(simulator);
  if (!table) return tl::unexpected(table.error());
  LiveParameters made(session, simulator, *table);
  auto world = simulatorDeclarations(simulator, C3DE_SIM_SCOPE_WORLD);
  if (!world) return tl::unexpected(world.error());
  auto body = simulatorDeclarations(simulator, C3DE_SIM_SCOPE_BODY);
  if (!body) return tl::unexpected(body.error());
  made.ofWorld_ = std::move(*world);
  made.ofBody_ = std::move(*body);
  for (const ParameterDecl &decl : made.ofWorld_) made.world_[decl.id] = decl.fallbackValue();
  for (const auto &entry : source) {
    const auto *scene = std::get_if<SharedScene>(&entry);
    if (scene == nullptr) {
      made.isWorldKnown_ = false;
      continue;
    }
    const auto values = scene::fitToDeclarations(**scene, (*scene)->world, made.ofWorld_);
    if (!values) return tl::unexpected(values.error());
    for (const ParameterValue &value : *values) made.world_[value.id] = value;
  }
  if (!made.isWorldKnown_) made.world_.clear();
  return made;
}

const std::vector<std::pair<std::string, c3de_handle>> &LiveParameters::bodies() const {
  c3de_handle handle{};
  std::size_t count = 0;
  const auto status = simulatorStatus(table_, simulator_);
  const std::uint64_t all = status ? status->bodies : 0;
  // A handle keeps its name, and stating the mass of a body costs more than the call.
  for (std::uint64_t i = 0; i < all; ++i) {
    if (table_->body_at(simulator_, i, &handle) < 0) break;
    if (count < bodies_.size() && bodies_[count].second.v == handle.v) {
      ++count;
      continue;
    }
    c3de_sim_body_info info{};
    info.size = sizeof info;
    if (table_->body_info(simulator_, handle, &info) < 0) continue;
    bodies_.resize(count);
    bodies_.emplace_back(std::string(fromAbi(info.name)), handle);
    ++count;
  }
  bodies_.resize(count);
  (void)session_->plugins().takeError();
  return bodies_;
}

std::vector<LiveParameters::Parameter> LiveParameters::all() const {
  std::vector<Parameter> all;
  for (const ParameterDecl &decl : ofWorld_) all.push_back({decl.id, decl});
  for (const auto &[name, handle] : bodies())
    for (const ParameterDecl &decl : ofBody_) all.push_back({kBody.data() + name + "." + decl.id, decl});
  return all;
}

Expected<LiveParameters::Target> LiveParameters::find(std::string_view path) const {
  const std::string text(path);
  if (isDeclared(ofWorld_, path)) return Target{{}, {}, text};
  // Of names that begin alike, the longest.
  std::pair<std::string, c3de_handle> best;
  const auto &all = bodies();
  for (const auto &body : all)
    if (path.size() > kBody.size() + body.first.size() && path.starts_with(kBody) &&
        path.substr(kBody.size()).starts_with(body.first) && path[kBody.size() + body.first.size()] == '.' &&
        body.first.size() >= best.first.size())
      best = body;
  if (!best.first.empty()) {
    const std::string key = text.substr(kBody.size() + best.first.size() + 1);
    if (isDeclared(ofBody_, key)) return Target{best.first, best.second, key};
    if (const std::string id = fullId(ofBody_, key); !id.empty()) return Target{best.first, best.second, id};
  }
  return tl::unexpected(unknown(text, all));
}

Error LiveParameters::unknown(const std::string &path,
                              const std::vector<std::pair<std::string, c3de_handle>> &bodies) const {
  std::vector<std::string> known;
  for (const ParameterDecl &decl : ofWorld_) known.push_back(decl.id);
  std::string names;
  for (const auto &body : bodies) {
    names += (names.empty() ? "" : ", ") + body.first;
    for (const ParameterDecl &decl : ofBody_) {
      known.push_back(kBody.data() + body.first + "." + decl.id);
      if (decl.id.starts_with(kMaterial))
        known.push_back(kBody.data() + body.first + "." + decl.id.substr(kMaterial.size()));
    }
  }
  const std::string nearest = nearestName(path, known);
  return {ErrorCode::usage,
          fmt::format("{}: there is no such parameter of the running simulation{}; bodies: {}; parameters of the "
                      "scene itself can only be set when it is opened",
                      displayText(path), nearest.empty() ? "" : "; did you mean '" + nearest + "'?",
                      names.empty() ? "none" : names)};
}

Error LiveParameters::reasonOf(std::string_view path, c3de_status code) const {
  const std::string reason = session_->plugins().takeError();
  const bool isUse = code == C3DE_E_ARG || code == C3DE_E_NOT_FOUND || code == C3DE_E_UNSUPPORTED;
  return {isUse ? ErrorCode::usage : ErrorCode::state,
          fmt::format("{}: {}", path, reason.empty() ? fmt::format("status {}", code) : reason)};
}

Expected<ParameterValue> LiveParameters::get(std::string_view path) const {
  const auto target = find(path);
  if (!target) return tl::unexpected(target.error());
  if (target->body.empty()) {
    if (const auto known = world_.find(target->id); known != world_.end()) return known->second;
    return fail(ErrorCode::state, fmt::format("{}: its value is not known, because changes of the session may have set "
                                              "it; it can be set",
                                              path));
  }
  c3de_param_value value{};
  value.size = sizeof value;
  const c3de_status code = table_->get_body_param(simulator_, target->handle, toAbi(target->id), &value);
  if (code < 0) return tl::unexpected(reasonOf(path, code));
  return ParameterValue::from(value);
}

Expected<void> LiveParameters::set(std::string_view path, std::string_view text) {
  const auto target = find(path);
  if (!target) return tl::unexpected(target.error());
  const bool isOfWorld = target->body.empty();
  // The reader of scenes knows presets and all forms of values.
  scene::SceneFile only;
  if (!isOfWorld) only.bodies.emplace_back().name = target->body;
  const std::string fullPath = isOfWorld ? target->id : fmt::format("{}{}.{}", kBody, target->body, target->id);
  if (auto read = scene::applyOverride(only, fmt::format("{}={}", fullPath, text), &session_->materials()); !read)
    return tl::unexpected(withoutOption(read.error()));
  const auto values = scene::fitToDeclarations(only, isOfWorld ? only.world : only.bodies.front().params,
                                               isOfWorld ? ofWorld_ : ofBody_);
  if (!values) return tl::unexpected(withoutOption(values.error()));
  if (values->empty())
    return fail(ErrorCode::usage, fmt::format("{}: cannot be set while the simulation exists", path));
  std::vector<c3de_param_value> abi;
  for (const ParameterValue &value : *values) abi.push_back(value.abi());
  if (isOfWorld) {
    if (const c3de_status code = table_->set_world(simulator_, abi.data(), abi.size(), sizeof abi.front()); code < 0)
      return tl::unexpected(reasonOf(path, code));
    for (const ParameterValue &value : *values) world_[value.id] = value;
    return {};
  }
  // The simulator takes one value after the other: those before a refused one are set back.
  std::vector<ParameterValue> earlier;
  for (const c3de_param_value &value : abi) {
    c3de_param_value before{};
    before.size = sizeof before;
    c3de_status code = table_->get_body_param(simulator_, target->handle, value.id, &before);
    if (code >= 0) {
      ParameterValue copy = ParameterValue::from(before);
      copy.id = fromAbi(value.id);
      code = table_->set_body_param(simulator_, target->handle, &value);
      if (code >= 0) earlier.push_back(std::move(copy));
    }
    if (code >= 0) continue;
    Error error = reasonOf(path, code);
    for (auto one = earlier.rbegin(); one != earlier.rend(); ++one) {
      const c3de_param_value back = one->abi();
      (void)table_->set_body_param(simulator_, target->handle, &back);
    }
    (void)session_->plugins().takeError();
    return tl::unexpected(std::move(error));
  }
  return {};
}

}  // namespace c3de::session
