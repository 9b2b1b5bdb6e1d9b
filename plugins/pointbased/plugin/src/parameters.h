// SPDX-License-Identifier: Apache-2.0
// The one table of parameters: panel, scene file, command line and checks are fed from it.
#pragma once

#include <map>

#include "pointbased/body.h"
#include "pointbased/simulator.h"
#include "services.h"
#include "view_settings.h"

namespace pointbased {

[[nodiscard]] std::span<const c3de_param_decl> worldDeclarations();
[[nodiscard]] std::span<const c3de_param_decl> bodyDeclarations();
[[nodiscard]] std::span<const c3de_param_decl> obstacleDeclarations();

/// Values by id; what is missing has its default.
class ParameterValues {
 public:
  explicit ParameterValues(std::span<const c3de_param_decl> declarations) : declarations_(declarations) {}

  /// Checks against the declaration: C3DE_E_NOT_FOUND, C3DE_E_ARG with what is accepted.
  [[nodiscard]] sdk::Result<void> set(const c3de_param_value &value);
  [[nodiscard]] sdk::Result<void> set(const c3de_param_value *values, std::uint64_t n, std::uint64_t stride);

  [[nodiscard]] double number(std::string_view id) const;
  [[nodiscard]] bool isAuto(std::string_view id) const;
  [[nodiscard]] std::string text(std::string_view id) const;
  /// Whether a number or a choice is other than its default.
  [[nodiscard]] bool differs(std::string_view id) const;
  [[nodiscard]] Vec3 vector(std::string_view id) const;
  /// Text is borrowed from this.
  [[nodiscard]] sdk::Result<c3de_param_value> get(std::string_view id) const;
  [[nodiscard]] std::span<const c3de_param_decl> declarations() const { return declarations_; }

 private:
  struct Value {
    std::uint32_t type;
    double num;
    std::string text;
    Vec3 vec;
  };
  [[nodiscard]] const c3de_param_decl *declaration(std::string_view id) const;

  std::span<const c3de_param_decl> declarations_;
  std::map<std::string, Value, std::less<>> values_;
};

[[nodiscard]] WorldSettings worldSettings(const ParameterValues &values);
[[nodiscard]] ContactSettings contactSettings(const ParameterValues &values);
/// s that a step may compute before it is given up; infinite: no limit.
[[nodiscard]] double stepBudget(const ParameterValues &values, bool hasWindow);
[[nodiscard]] ViewSettings viewSettings(const ParameterValues &values);
/// Whether a parameter of the world says only what is shown.
[[nodiscard]] bool isOfTheView(std::string_view id);
[[nodiscard]] Material materialOf(const ParameterValues &values);
/// Where Young's modulus of a tissue lies, Pa.
struct StiffnessRange {
  double low = 0.0, high = 0.0;
  bool isKnown = false;  ///< false: half of it less and more
};
[[nodiscard]] StiffnessRange stiffnessRangeOf(const ParameterValues &values);
[[nodiscard]] Foundation foundationOf(const ParameterValues &values);
[[nodiscard]] bool isOfTheSurroundings(std::string_view id);
[[nodiscard]] bool isRigid(const ParameterValues &values);
/// Rigid, and moves with its mass.
[[nodiscard]] bool isFree(const ParameterValues &values);
[[nodiscard]] Evaluation evaluationOf(const ParameterValues &values);
[[nodiscard]] double stabilisationOf(const ParameterValues &values);
/// Without refinements, held regions and materials.
/// Count 0: automatic.
[[nodiscard]] LatticeSampling samplingOf(const ParameterValues &values);
[[nodiscard]] NeighborChoice neighborChoiceOf(const ParameterValues &values);

}  // namespace pointbased
