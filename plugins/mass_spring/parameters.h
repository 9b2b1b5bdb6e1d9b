// SPDX-License-Identifier: Apache-2.0
// What scenes, command line and panels can say, and its values.
#pragma once

#include <map>
#include <span>

#include "vectors.h"

namespace mass_spring {

[[nodiscard]] std::span<const c3de_param_decl> worldDeclarations();
[[nodiscard]] std::span<const c3de_param_decl> bodyDeclarations();

/// Values that fit their declarations; what was not set has its default.
class ParameterValues {
 public:
  explicit ParameterValues(std::span<const c3de_param_decl> declarations) : declarations_(declarations) {}
  /// @throws sdk::Error  unknown id, or a value that is not accepted; nothing has changed then
  void set(const c3de_param_value &value);
  void set(const c3de_param_value *values, std::uint64_t n, std::uint64_t stride);
  [[nodiscard]] double number(std::string_view id) const { return value(id).num; }
  [[nodiscard]] Vec3 vector(std::string_view id) const { return vectorOf(value(id).vec); }
  /// Of a choice.
  [[nodiscard]] std::string_view text(std::string_view id) const { return sdk::text(value(id).text); }
  [[nodiscard]] bool isAuto(std::string_view id) const { return value(id).type == C3DE_PARAM_TEXT; }
  /// @throws sdk::Error  unknown id
  [[nodiscard]] c3de_param_value value(std::string_view id) const;
  [[nodiscard]] std::span<const c3de_param_decl> declarations() const { return declarations_; }
  [[nodiscard]] const c3de_param_decl &declaration(std::string_view id) const;

 private:
  std::span<const c3de_param_decl> declarations_;
  std::map<std::string, c3de_param_value, std::less<>> values_;  // texts are of declarations, or "auto"
};

}  // namespace mass_spring
