// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "c3de/abi/object.h"
#include "c3de/plugin_host/plugin_host.h"

namespace c3de::plugin_host {

/// The classes offered by plugins. Listing: any thread; all else: main thread.
class ClassRegistry {
 public:
  struct Entry {
    ClassInfo info;
    void *factory = nullptr;
    c3de_status(C3DE_CALL *create)(void *factory, c3de_object **out) = nullptr;
  };

  /// False, with the owner's id in `takenBy`, if a class of this id exists.
  bool add(Entry entry, std::string &takenBy);
  /// False if the plugin has no such class.
  bool remove(const std::string &id, const std::string &plugin);
  void removeOwnedBy(const std::string &plugin);
  /// Sorted by id; empty interface: all.
  [[nodiscard]] std::vector<ClassInfo> list(const std::string &interfaceId) const;
  /// Throws Refusal: C3DE_E_NOT_FOUND names the existing classes; otherwise the error of the factory.
  [[nodiscard]] c3de_object *create(const std::string &id);

  /// The plugin of an object created by create(), for messages; the name remains valid. Any thread.
  [[nodiscard]] const char *ownerOf(const c3de_object *object) const;

 private:
  mutable std::mutex mutex_;
  std::map<std::string, Entry> byId_;
  std::map<const c3de_object_vt *, const char *> ownerByTable_;
};

}  // namespace c3de::plugin_host
