// SPDX-License-Identifier: Apache-2.0
#include "c3de/core/plugin_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "c3de/core/first_size.h"
#include "c3de/core/log.h"
#include "c3de/core/plugin_call.h"
#include "c3de/core/text.h"

namespace c3de {
namespace {

using AnyFunction = void (*)();

}  // namespace

std::string sizeProblem(std::uint64_t size, std::size_t least, const char *type) {
  return fmt::format("its member size is {}; at least {} is required ({})", size, least, type);
}

std::string slotProblem(const void *table, std::uint32_t size, std::uint32_t rev, std::span<const TableSlot> slots) {
  rev = std::max<std::uint32_t>(rev, 1);
  for (const TableSlot &slot : slots) {
    if (slot.rev > rev) continue;
    if (slot.offset + sizeof(AnyFunction) > size)
      return fmt::format("its size {} ends before {}, which revision {} has", size, slot.name, slot.rev);
    AnyFunction function = nullptr;
    std::memcpy(&function, static_cast<const unsigned char *>(table) + slot.offset, sizeof function);
    if (!function) return fmt::format("{} is null, revision {} has it", slot.name, slot.rev);
  }
  return {};
}

std::string objectProblem(const c3de_object *object) {
  if (!object) return "the object is null";
  if (!object->vt) return "the object has no table of functions";
  return tableProblem(object->vt);
}

Expected<const void *> queryObject(c3de_object *object, std::string_view interfaceId, std::uint32_t minRev) {
  if (std::string problem = objectProblem(object); !problem.empty()) return fail(ErrorCode::plugin, std::move(problem));
  const void *table = nullptr;
  c3de_status status = C3DE_E_EXCEPTION;
  try {
    status = object->vt->query(object, toAbi(interfaceId), minRev, &table);
  } catch (...) {
    return fail(ErrorCode::plugin,
                fmt::format("query() of the object threw an exception for {}: {}", interfaceId, textOfException()));
  }
  if (status < 0 || table == nullptr)
    return fail(ErrorCode::plugin, fmt::format("the object does not implement {} (status {})", interfaceId, status));
  return table;
}

void releaseObject(c3de_object *object) noexcept {
  if (!object) return;
  try {
    object->vt->release(object);
  } catch (...) {
    try {
      log(LogLevel::error, "an exception left release of an object: " + textOfException());
    } catch (...) {
    }
  }
}

}  // namespace c3de
