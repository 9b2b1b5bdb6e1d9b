// SPDX-License-Identifier: Apache-2.0
// The guaranteed layout: a change of a number or a type in this file breaks every plugin built before it. New members
// are appended, with a new line here. 64-bit systems.
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "c3de/abi/entry.h"
#include "c3de/abi/object.h"

namespace {

#define AT(type, member, offset, ...)                                 \
  static_assert(offsetof(type, member) == offset, #type "." #member); \
  static_assert(std::is_same_v<decltype(type::member), __VA_ARGS__>, #type "." #member)
#define SIZE(type, size) \
  static_assert(sizeof(type) == size && std::is_trivial_v<type> && std::is_standard_layout_v<type>)

static_assert(C3DE_ABI_MAJOR == 1u);
static_assert(C3DE_OK == 0 && C3DE_S_TRUNCATED == 1 && C3DE_E_ARG == -1 && C3DE_E_VERSION == -2 &&
              C3DE_E_UNSUPPORTED == -3 && C3DE_E_EXISTS == -4 && C3DE_E_NOT_FOUND == -5 && C3DE_E_STALE == -6 &&
              C3DE_E_STATE == -7 && C3DE_E_THREAD == -8 && C3DE_E_NOMEM == -9 && C3DE_E_IO == -10 &&
              C3DE_E_FORMAT == -11 && C3DE_E_CANCELLED == -12 && C3DE_E_TIMEOUT == -13 && C3DE_E_DIVERGED == -14 &&
              C3DE_E_GPU == -15 && C3DE_E_EXCEPTION == -16 && C3DE_E_INTERNAL == -17);
static_assert(C3DE_F32 == 1u && C3DE_F64 == 2u && C3DE_U8 == 3u && C3DE_I32 == 4u && C3DE_U32 == 5u && C3DE_U64 == 6u);
static_assert(C3DE_REQUIRED == 1u && C3DE_OPTIONAL == 2u && C3DE_OFFER_HEADLESS == 1u && C3DE_OFFER_PROBE == 2u);

// base.h
static_assert(std::is_same_v<c3de_status, std::int32_t>);
SIZE(c3de_handle, 8);
AT(c3de_handle, v, 0, std::uint64_t);
SIZE(c3de_str, 16);
AT(c3de_str, ptr, 0, const char *);
AT(c3de_str, len, 8, std::uint64_t);
SIZE(c3de_view, 32);
AT(c3de_view, data, 0, const void *);
AT(c3de_view, count, 8, std::uint64_t);
AT(c3de_view, comps, 16, std::uint32_t);
AT(c3de_view, dtype, 20, std::uint32_t);
AT(c3de_view, stride, 24, std::int64_t);
SIZE(c3de_mview, 32);
AT(c3de_mview, data, 0, void *);
AT(c3de_mview, count, 8, std::uint64_t);
AT(c3de_mview, comps, 16, std::uint32_t);
AT(c3de_mview, dtype, 20, std::uint32_t);
AT(c3de_mview, stride, 24, std::int64_t);
SIZE(c3de_sink, 16);
AT(c3de_sink, self, 0, void *);
AT(c3de_sink, put, 8, c3de_status(C3DE_CALL *)(void *, const void *, std::uint64_t));

// entry.h
SIZE(c3de_offer, 56);
AT(c3de_offer, size, 0, std::uint32_t);
AT(c3de_offer, abi_min, 4, std::uint32_t);
AT(c3de_offer, abi_max, 8, std::uint32_t);
AT(c3de_offer, abi_minor, 12, std::uint32_t);
AT(c3de_offer, host_name, 16, c3de_str);
AT(c3de_offer, host_version, 32, c3de_str);
AT(c3de_offer, flags, 48, std::uint64_t);
SIZE(c3de_answer, 280);
AT(c3de_answer, size, 0, std::uint32_t);
AT(c3de_answer, abi_major, 4, std::uint32_t);
AT(c3de_answer, abi_minor, 8, std::uint32_t);
AT(c3de_answer, reserved, 12, std::uint32_t);
AT(c3de_answer, plugin, 16, const c3de_plugin *);
AT(c3de_answer, why_not, 24, char[256]);
SIZE(c3de_service_req, 32);
AT(c3de_service_req, size, 0, std::uint32_t);
AT(c3de_service_req, flags, 4, std::uint32_t);
AT(c3de_service_req, id, 8, c3de_str);
AT(c3de_service_req, min_rev, 24, std::uint32_t);
AT(c3de_service_req, reserved, 28, std::uint32_t);
SIZE(c3de_host, 56);
AT(c3de_host, size, 0, std::uint32_t);
AT(c3de_host, rev, 4, std::uint32_t);
AT(c3de_host, ctx, 8, void *);
AT(c3de_host, get_service, 16, c3de_status(C3DE_CALL *)(void *, c3de_str, std::uint32_t, const void **));
AT(c3de_host, set_error, 24, void(C3DE_CALL *)(void *, c3de_status, c3de_str));
AT(c3de_host, take_error, 32, c3de_status(C3DE_CALL *)(void *, c3de_sink));
AT(c3de_host, set_error_at, 40, void(C3DE_CALL *)(void *, c3de_status, c3de_str, const c3de_error_place *));
AT(c3de_host, callback_failed, 48, void(C3DE_CALL *)(void *));
SIZE(c3de_plugin, 144);
AT(c3de_plugin, size, 0, std::uint32_t);
AT(c3de_plugin, rev, 4, std::uint32_t);
AT(c3de_plugin, id, 8, c3de_str);
AT(c3de_plugin, version, 24, c3de_str);
AT(c3de_plugin, display_name, 40, c3de_str);
AT(c3de_plugin, vendor, 56, c3de_str);
AT(c3de_plugin, license, 72, c3de_str);
AT(c3de_plugin, needs, 88, const c3de_service_req *);
AT(c3de_plugin, needs_n, 96, std::uint64_t);
AT(c3de_plugin, needs_stride, 104, std::uint64_t);
AT(c3de_plugin, create, 112, c3de_status(C3DE_CALL *)(const c3de_host *, void **));
AT(c3de_plugin, start, 120, c3de_status(C3DE_CALL *)(void *));
AT(c3de_plugin, stop, 128, c3de_status(C3DE_CALL *)(void *));
AT(c3de_plugin, destroy, 136, void(C3DE_CALL *)(void *));
static_assert(std::is_same_v<c3de_plugin_query_fn, c3de_status(C3DE_CALL *)(const c3de_offer *, c3de_answer *)>);

// object.h
SIZE(c3de_object, 8);
AT(c3de_object, vt, 0, const c3de_object_vt *);
SIZE(c3de_object_vt, 32);
AT(c3de_object_vt, size, 0, std::uint32_t);
AT(c3de_object_vt, rev, 4, std::uint32_t);
AT(c3de_object_vt, retain, 8, std::uint32_t(C3DE_CALL *)(c3de_object *));
AT(c3de_object_vt, release, 16, std::uint32_t(C3DE_CALL *)(c3de_object *));
AT(c3de_object_vt, query, 24, c3de_status(C3DE_CALL *)(c3de_object *, c3de_str, std::uint32_t, const void **));
SIZE(c3de_class, 88);
AT(c3de_class, size, 0, std::uint32_t);
AT(c3de_class, rev, 4, std::uint32_t);
AT(c3de_class, id, 8, c3de_str);
AT(c3de_class, label, 24, c3de_str);
AT(c3de_class, doc, 40, c3de_str);
AT(c3de_class, ifaces, 56, const c3de_str *);
AT(c3de_class, ifaces_n, 64, std::uint64_t);
AT(c3de_class, factory, 72, void *);
AT(c3de_class, create, 80, c3de_status(C3DE_CALL *)(void *, c3de_object **));

}  // namespace
