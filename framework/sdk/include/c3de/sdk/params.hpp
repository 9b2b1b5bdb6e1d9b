// SPDX-License-Identifier: Apache-2.0
// Parameters: declarations for constant tables, values, and a declared set.
#pragma once

#include <functional>
#include <memory>

#include "c3de/sdk/services.hpp"

namespace c3de::sdk {

/// Naming part of a declaration, common to every type.
struct ParamText {
  std::string_view id{}, label{}, unit{}, doc{}, group{};
  std::string_view alternativeTo{};  ///< id of the parameter that it says in another way
};
struct ParamRange {
  double min = 0.0, max = 0.0;          ///< accepted; open ends by C3DE_PARAM_MIN_OPEN, C3DE_PARAM_MAX_OPEN
  double softMin = 0.0, softMax = 0.0;  ///< of the slider
};

[[nodiscard]] constexpr c3de_param_decl declareParam(std::uint32_t type, const ParamText &t, std::uint32_t flags) {
  c3de_param_decl d{};
  d.size = sizeof d;
  d.type = type;
  d.id = str(t.id);
  d.label = str(t.label);
  d.unit = str(t.unit);
  d.doc = str(t.doc);
  d.group = str(t.group);
  d.flags = flags;
  d.alternative_to = str(t.alternativeTo);
  return d;
}
[[nodiscard]] constexpr c3de_param_decl numberParam(const ParamText &t, const ParamRange &r, double fallback,
                                                    std::uint32_t flags = 0) {
  c3de_param_decl d = declareParam(C3DE_PARAM_F64, t, flags);
  d.min = r.min;
  d.max = r.max;
  d.soft_min = r.softMin;
  d.soft_max = r.softMax;
  d.fallback = fallback;
  return d;
}
/// A number that may also be the text "auto", which is its default.
[[nodiscard]] constexpr c3de_param_decl autoParam(const ParamText &t, const ParamRange &r, std::uint32_t flags = 0) {
  c3de_param_decl d = numberParam(t, r, 0.0, flags | C3DE_PARAM_AUTO);
  d.fallback_text = str("auto");
  return d;
}
[[nodiscard]] constexpr c3de_param_decl integerParam(const ParamText &t, const ParamRange &r, double fallback,
                                                     std::uint32_t flags = 0) {
  c3de_param_decl d = numberParam(t, r, fallback, flags);
  d.type = C3DE_PARAM_I64;
  return d;
}
[[nodiscard]] constexpr c3de_param_decl boolParam(const ParamText &t, bool fallback, std::uint32_t flags = 0) {
  c3de_param_decl d = declareParam(C3DE_PARAM_BOOL, t, flags);
  d.max = d.soft_max = 1.0;
  d.fallback = fallback ? 1.0 : 0.0;
  return d;
}
/// @param choices  static storage
template <std::size_t N>
[[nodiscard]] constexpr c3de_param_decl choiceParam(const ParamText &t, const std::array<c3de_str, N> &choices,
                                                    std::string_view fallback, std::uint32_t flags = 0) {
  c3de_param_decl d = declareParam(C3DE_PARAM_CHOICE, t, flags);
  d.choices = choices.data();
  d.choices_n = N;
  d.fallback_text = str(fallback);
  return d;
}
[[nodiscard]] constexpr c3de_param_decl textParam(const ParamText &t, std::string_view fallback,
                                                  std::uint32_t flags = 0) {
  c3de_param_decl d = declareParam(C3DE_PARAM_TEXT, t, flags);
  d.fallback_text = str(fallback);
  return d;
}
[[nodiscard]] constexpr c3de_param_decl vec3Param(const ParamText &t, const ParamRange &r, const Vec3 &fallback,
                                                  std::uint32_t flags = 0) {
  c3de_param_decl d = numberParam(t, r, 0.0, flags);
  d.type = C3DE_PARAM_VEC3;
  for (std::size_t i = 0; i < 3; ++i) d.fallback_vec[i] = fallback[i];
  return d;
}

/// Values; id and text are borrowed.
[[nodiscard]] constexpr c3de_param_value numberValue(std::string_view id, double value) {
  return {sizeof(c3de_param_value), C3DE_PARAM_F64, str(id), value, {nullptr, 0}, {0, 0, 0}};
}
[[nodiscard]] constexpr c3de_param_value integerValue(std::string_view id, std::int64_t value) {
  return {sizeof(c3de_param_value), C3DE_PARAM_I64, str(id), static_cast<double>(value), {nullptr, 0}, {0, 0, 0}};
}
[[nodiscard]] constexpr c3de_param_value boolValue(std::string_view id, bool value) {
  return {sizeof(c3de_param_value), C3DE_PARAM_BOOL, str(id), value ? 1.0 : 0.0, {nullptr, 0}, {0, 0, 0}};
}
[[nodiscard]] constexpr c3de_param_value textValue(std::string_view id, std::string_view value) {
  return {sizeof(c3de_param_value), C3DE_PARAM_TEXT, str(id), 0.0, str(value), {0, 0, 0}};
}
[[nodiscard]] constexpr c3de_param_value choiceValue(std::string_view id, std::string_view value) {
  return {sizeof(c3de_param_value), C3DE_PARAM_CHOICE, str(id), 0.0, str(value), {0, 0, 0}};
}
[[nodiscard]] constexpr c3de_param_value vec3Value(std::string_view id, const Vec3 &value) {
  return {sizeof(c3de_param_value), C3DE_PARAM_VEC3, str(id), 0.0, {nullptr, 0}, {value[0], value[1], value[2]}};
}

/// Element i of an array of growable structs with a stride in bytes (0: tight, in the size of the other side).
template <class T>
[[nodiscard]] const T &strided(const T *first, std::uint64_t i, std::uint64_t stride) noexcept {
  return *reinterpret_cast<const T *>(reinterpret_cast<const unsigned char *>(first) +
                                      i * (stride ? stride : first->size));
}

/// A declared set with its listener; removed in the destructor. Main thread.
class ParameterSet {
 public:
  using Changed = std::function<void(const c3de_param_value &)>;

  ParameterSet() noexcept = default;
  [[nodiscard]] c3de_handle handle() const noexcept { return registration_.handle(); }
  explicit operator bool() const noexcept { return static_cast<bool>(registration_); }

  /// Its text is valid until the next call on this set.
  Result<c3de_param_value> get(std::string_view id) const {
    const auto *table = registration_.table();
    if (!table) return Failure{C3DE_E_STATE, "the parameter set is not declared"};
    c3de_param_value out{};
    out.size = sizeof out;
    const c3de_status status = table->get(table->ctx, handle(), str(id), &out);
    if (status < 0) return currentHost().failure(status);
    return out;
  }
  /// Shows what is; does not call the listener.
  Result<void> set(const c3de_param_value &value) const {
    const auto *table = registration_.table();
    if (!table) return Failure{C3DE_E_STATE, "the parameter set is not declared"};
    return currentHost().check(table->set(table->ctx, handle(), &value));
  }

 private:
  friend class Params;
  // The listener is declared first, so that the registration goes before it.
  std::unique_ptr<Changed> changed_;
  Owned<c3de_params_v1, &c3de_params_v1::remove> registration_;
};

class Params : public Service<c3de_params_v1> {
 public:
  using Service::Service;

  /// @param changed  a person or another plugin changed the value, which fits its declaration; may be empty
  Result<ParameterSet> declare(std::string_view title, std::span<const c3de_param_decl> decls,
                               ParameterSet::Changed changed) const {
    return declare(title, decls.data(), decls.size(), sizeof(c3de_param_decl), std::move(changed));
  }
  /// As they come from iface.simulator's declarations().
  Result<ParameterSet> declare(std::string_view title, const c3de_param_decl *decls, std::uint64_t n,
                               std::uint64_t stride, ParameterSet::Changed changed) const {
    ParameterSet set;
    set.changed_ = std::make_unique<ParameterSet::Changed>(std::move(changed));
    const c3de_param_listener listener{sizeof(c3de_param_listener), 0, set.changed_.get(), &changedThunk};
    c3de_handle handle{0};
    if (auto declared = call<&c3de_params_v1::declare>(str(title), decls, n, stride, &listener, &handle); !declared)
      return declared.failure();
    set.registration_ = {table_, handle};
    return set;
  }

 private:
  static void C3DE_CALL changedThunk(void *self, const c3de_param_value *value) noexcept {
    guardQuietly("parameter listener", [&] {
      const auto &changed = *static_cast<ParameterSet::Changed *>(self);
      if (changed) changed(*value);
    });
  }
};

}  // namespace c3de::sdk
