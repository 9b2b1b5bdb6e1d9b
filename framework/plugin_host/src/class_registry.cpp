// SPDX-License-Identifier: Apache-2.0
#include "class_registry.h"

#include <algorithm>

#include "c3de/core/text.h"
#include "first_sizes.h"
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
    createFn = found->second.create;
  }
  // Outside the lock: the factory may look up other classes.
  c3de_object *object = nullptr;
  const c3de_status status = createFn(factory, &object);
  if (status < 0) {
    const std::string reason = takeLastError();
    throw Refusal(status, id + ": " + (reason.empty() ? statusName(status) : reason));
  }
  if (!object || !object->vt || object->vt->size < FirstSize<c3de_object_vt>::value || !object->vt->retain ||
      !object->vt->release || !object->vt->query)
    throw Refusal(C3DE_E_INTERNAL, id + ": the class made an object without a complete function table");
  return object;
}

}  // namespace c3de::plugin_host
