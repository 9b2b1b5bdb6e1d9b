// SPDX-License-Identifier: Apache-2.0
// The single table of parameters, from which panel, scene file, command line and checks are generated.
#pragma once

#include <map>

#include "base/services.h"
#include "base/view_settings.h"
#include "pointbased/body.h"
#include "pointbased/simulator.h"

namespace pointbased {

[[nodiscard]] std::span<const c3de_param_decl> worldDeclarations();
[[nodiscard]] std::span<const c3de_param_decl> bodyDeclarations();
[[nodiscard]] std::span<const c3de_param_decl> obstacleDeclarations();

/// Values by id; missing values have their defaults.
class ParameterValues {
 public:
  explicit ParameterValues(std::span<const c3de_param_decl> declarations) : declarations_(declarations) {}

  /// Checks against the declaration: C3DE_E_NOT_FOUND, or C3DE_E_ARG with the accepted values.
  [[nodiscard]] sdk::Result<void> set(const c3de_param_value &value);
  [[nodiscard]] sdk::Result<void> set(const c3de_param_value *values, std::uint64_t n, std::uint64_t stride);

  [[nodiscard]] double number(std::string_view id) const;
  [[nodiscard]] bool isAuto(std::string_view id) const;
  [[nodiscard]] std::string text(std::string_view id) const;
  /// Whether a number or a choice differs from its default.
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
/// Computing time of a step, s, after which it is abandoned; infinite: no limit.
[[nodiscard]] double stepBudget(const ParameterValues &values, bool hasWindow);
[[nodiscard]] ViewSettings viewSettings(const ParameterValues &values);
/// Whether a parameter of the world affects only the display.
[[nodiscard]] bool isOfTheView(std::string_view id);
[[nodiscard]] Material materialOf(const ParameterValues &values);
/// Range of Young's modulus of a tissue, Pa.
struct StiffnessRange {
  double low = 0.0, high = 0.0;
  bool isKnown = false;  ///< false: the range is half less to half more
};
[[nodiscard]] StiffnessRange stiffnessRangeOf(const ParameterValues &values);
[[nodiscard]] Foundation foundationOf(const ParameterValues &values);
[[nodiscard]] bool isOfTheSurroundings(std::string_view id);
[[nodiscard]] bool isRigid(const ParameterValues &values);
/// Rigid, and moves according to its mass.
[[nodiscard]] bool isFree(const ParameterValues &values);
[[nodiscard]] Evaluation evaluationOf(const ParameterValues &values);
[[nodiscard]] double stabilisationOf(const ParameterValues &values);
/// Without refinements, held regions and materials. Count 0 means automatic.
[[nodiscard]] LatticeSampling samplingOf(const ParameterValues &values);
[[nodiscard]] NeighborChoice neighborChoiceOf(const ParameterValues &values);

}  // namespace pointbased
