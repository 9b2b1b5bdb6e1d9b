// SPDX-License-Identifier: Apache-2.0
// Classes that a plugin offers, and objects of all classes.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "c3de/sdk/guard.hpp"
#include "c3de/sdk/object.hpp"
#include "c3de/sdk/services/service.hpp"

namespace c3de::sdk {

/// A class to offer; everything is copied by the host. `make` returns an object with a count of one.
struct ClassOffer {
  std::string_view id{}, label{}, doc{};
  std::vector<std::string_view> interfaces{};
  c3de_status(C3DE_CALL *create)(void *factory, c3de_object **out) = nullptr;
  void *factory = nullptr;
};

class Registry : public Service<c3de_registry_v1> {
 public:
  using Service::Service;

  Result<void> add(const ClassOffer &offer) const {
    std::vector<c3de_str> interfaces;
    for (const std::string_view id : offer.interfaces) interfaces.push_back(str(id));
    const c3de_class cls{sizeof(c3de_class), 1,
                         str(offer.id),      str(offer.label),
                         str(offer.doc),     interfaces.data(),
                         interfaces.size(),  offer.factory,
                         offer.create};
    return call<&c3de_registry_v1::add_class>(&cls);
  }
  /// Offers Derived, whose constructor takes Factory& (the plugin, or what its objects need); Factory must outlive it.
  template <class Derived, class Factory>
  Result<void> add(std::string_view id, std::string_view label, std::string_view doc, Factory &factory) const {
    ClassOffer offer{id, label, doc, {}, nullptr, &factory};
    for (const Interface &entry : Derived::interfaces()) offer.interfaces.push_back(entry.id);
    offer.create = [](void *self, c3de_object **out) noexcept -> c3de_status {
      return guard([&] { *out = make<Derived>(*static_cast<Factory *>(self)).detach()->abi(); });
    };
    return add(offer);
  }
  Result<void> remove(std::string_view id) const { return call<&c3de_registry_v1::remove_class>(str(id)); }

  /// A new object of a class, also of another plugin.
  Result<Ref<>> create(std::string_view classId) const {
    c3de_object *object = nullptr;
    if (auto done = call<&c3de_registry_v1::create>(str(classId), &object); !done) return done.failure();
    return Ref<>::adopt(object);
  }
  /// Ids of the classes that list an interface, all classes when it is empty; sorted.
  Result<std::vector<std::string>> classesWith(std::string_view interfaceId) const {
    std::vector<std::string> ids;
    const auto each = [](void *self, const c3de_class_info *info) noexcept -> c3de_status {
      return guard([&] { static_cast<std::vector<std::string> *>(self)->emplace_back(text(info->id)); });
    };
    if (auto done = call<&c3de_registry_v1::enum_classes>(str(interfaceId), &ids, +each); !done) return done.failure();
    return ids;
  }
};

}  // namespace c3de::sdk
