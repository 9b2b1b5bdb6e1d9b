// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "c3de/abi/params.h"
#include "c3de/core/expected.h"
#include "c3de/core/vec.h"

namespace c3de {

/// Owning form of c3de_param_value.
struct ParameterValue {
  std::uint32_t type = C3DE_PARAM_F64;
  std::string id;
  double num = 0.0;
  std::string text;
  Vec3 vec{};

  [[nodiscard]] c3de_param_value abi() const;  ///< borrows from this
  [[nodiscard]] static ParameterValue from(const c3de_param_value &value);
  [[nodiscard]] std::string display() const;  ///< the value as text, without unit
};

/// Owning form of c3de_param_decl.
struct ParameterDecl {
  std::uint32_t type = C3DE_PARAM_F64;
  std::string id, label, unit, doc, group;
  double min = 0.0, max = 0.0, softMin = 0.0, softMax = 0.0;
  double fallback = 0.0;
  std::string fallbackText;
  Vec3 fallbackVec{};
  std::vector<std::string> choices;
  std::uint32_t flags = 0;
  std::string alternativeTo;  ///< id of a parameter for the same quantity; empty: none

  [[nodiscard]] static ParameterDecl from(const c3de_param_decl &decl);
  [[nodiscard]] ParameterValue fallbackValue() const;
  [[nodiscard]] std::string accepted() const;  ///< for example "0 < value < 0.5", "stvk | neo_hookean"
};

/// Checks type, finiteness and range. The error names the parameter, the value, its unit and what is accepted.
[[nodiscard]] Expected<void> checkParameter(const ParameterDecl &decl, const ParameterValue &value);

/// The declaration of an id; the error names the nearest known id.
[[nodiscard]] Expected<const ParameterDecl *> findParameter(const std::vector<ParameterDecl> &decls,
                                                            std::string_view id);

/// Reads declarations passed through the ABI (array with stride).
[[nodiscard]] std::vector<ParameterDecl> readDeclarations(const c3de_param_decl *decls, std::uint64_t n,
                                                          std::uint64_t stride);

}  // namespace c3de
