// SPDX-License-Identifier: Apache-2.0
#include "class_registry.h"

#include <fmt/format.h>

#include <algorithm>

#include "c3de/core/plugin_call.h"
#include "c3de/core/plugin_table.h"
#include "c3de/core/text.h"
#include "last_error.h"
#include "refusal.h"

namespace c3de::plugin_host {

bool ClassRegistry::add(Entry entry, std::string &takenBy) {
  const std::lock_guard lock(mutex_);
  const auto found = byId_.find(entry.info.id);
  if (found != byId_.end()) {
    takenBy = found->second.info.plugin;
    return false;
  }
  std::string id = entry.info.id;
  byId_.emplace(std::move(id), std::move(entry));
  return true;
}

bool ClassRegistry::remove(const std::string &id, const std::string &plugin) {
  const std::lock_guard lock(mutex_);
  const auto found = byId_.find(id);
  if (found == byId_.end() || found->second.info.plugin != plugin) return false;
  byId_.erase(found);
  return true;
}

void ClassRegistry::removeOwnedBy(const std::string &plugin) {
  const std::lock_guard lock(mutex_);
  std::erase_if(byId_, [&](const auto &item) { return item.second.info.plugin == plugin; });
}

std::vector<ClassInfo> ClassRegistry::list(const std::string &interfaceId) const {
  const std::lock_guard lock(mutex_);
  std::vector<ClassInfo> out;
  for (const auto &[id, entry] : byId_) {
    const auto &interfaces = entry.info.interfaces;
    if (interfaceId.empty() || std::find(interfaces.begin(), interfaces.end(), interfaceId) != interfaces.end())
      out.push_back(entry.info);
  }
  return out;
}

c3de_object *ClassRegistry::create(const std::string &id) {
  void *factory = nullptr;
  std::string owner;
  c3de_status(C3DE_CALL * createFn)(void *, c3de_object **) = nullptr;
  {
    const std::lock_guard lock(mutex_);
    const auto found = byId_.find(id);
    if (found == byId_.end()) {
      std::vector<std::string> known;
      for (const auto &item : byId_) known.push_back(item.first);
      std::string text = "no class '" + id + "'";
      if (const std::string nearest = nearestName(id, known); !nearest.empty())
        text += "; did you mean " + nearest + "?";
      text += known.empty() ? "; no classes are registered" : "; there are:";
      for (const std::string &name : known) text += " " + name;
      throw Refusal(C3DE_E_NOT_FOUND, text);
    }
    factory = found->second.factory;
    owner = found->second.info.plugin;
    createFn = found->second.create;
  }
  // Outside the lock, because the factory may look up other classes.
  const char *plugin = internedName(owner), *what = internedName("create of class " + id);
  if (PluginCall::hasReachedMaxNesting(plugin, what))
    throw Refusal(C3DE_E_STATE, fmt::format("class {} of plugin {}: {} nested plugin calls, more "
                                            "are not accepted; does a class create itself?",
                                            id, owner, PluginCall::kMaxNested));
  c3de_object *object = nullptr;
  c3de_status status = C3DE_E_EXCEPTION;
  try {
    const PluginCall call(plugin, what, CallKind::prompt);
    status = createFn(factory, &object);
  } catch (...) {
    throw Refusal(C3DE_E_EXCEPTION,
                  fmt::format("an exception left create of class {} of plugin {}: {}", id, owner, textOfException()));
  }
  if (status < 0) {
    const std::string reason = takeLastError();
    // A class that is composed of others passes on their reason, which need not be repeated for each.
    const bool isTold = reason.find("class " + id + " ") != std::string::npos;
    throw Refusal(status, isTold ? reason : id + ": " + (reason.empty() ? statusName(status) : reason));
  }
  if (const std::string problem = objectProblem(object); !problem.empty())
    throw Refusal(C3DE_E_INTERNAL, fmt::format("create of class {} of plugin {}: {}", id, owner, problem));
  {
    const std::lock_guard lock(mutex_);
    ownerByTable_[object->vt] = plugin;
  }
  return object;
}

const char *ClassRegistry::ownerOf(const c3de_object *object) const {
  const std::lock_guard lock(mutex_);
  const auto found = object ? ownerByTable_.find(object->vt) : ownerByTable_.end();
  return found != ownerByTable_.end() ? found->second : "(unknown)";
}

}  // namespace c3de::plugin_host
