// SPDX-License-Identifier: Apache-2.0
// The arrow of a support or load, and the value that it has when its tip is dragged.
#pragma once

#include <optional>
#include <string>

#include "simulator/surface_condition.h"
#include "view/scene_pick.h"

namespace pointbased {

struct ConditionArrow {
  Vec3 from = Vec3::Zero();    ///< m, middle of the patch
  Vec3 vector = Vec3::Zero();  ///< m, to the tip
  Vec3 area = Vec3::Zero();    ///< m², present area vector of the patch, outwards
  [[nodiscard]] Vec3 tip() const { return from + vector; }
};

/// @param one               with its present positions
/// @param metresPerNewton   length of the arrow of a force; a displacement is drawn in its size
[[nodiscard]] ConditionArrow arrowOf(const ConditionSnapshot &one, double metresPerNewton);
/// The same with another value.
[[nodiscard]] ConditionArrow arrowOf(const ConditionSnapshot &one, const SurfaceCondition &value,
                                     double metresPerNewton);
/// N, of the total force of a load by its value.
[[nodiscard]] double forceOf(const ConditionSnapshot &one);

/// Where the ray has the tip of an arrow: in the plane through the tip that is parallel to the screen; of a pressure on
/// the line along its normal. Nothing if that is behind the eye, or if the line points at the viewer.
/// @param isSlice  the ray begins in the plane of a slice
[[nodiscard]] std::optional<Vec3> tipUnder(const PickRay &ray, const ConditionArrow &arrow, ConditionKind kind,
                                           bool isSlice);

/// The condition whose arrow has this vector, m. Its value is rounded to three digits and is in the accepted range.
[[nodiscard]] SurfaceCondition withArrow(const SurfaceCondition &condition, const ConditionArrow &arrow,
                                         const Vec3 &vector, double metresPerNewton);

/// Its value with the unit: "1.25 N", "2.666 kPa (20 mmHg)", "3.5 mm"; of a fix its name.
[[nodiscard]] std::string valueText(const SurfaceCondition &condition);

}  // namespace pointbased
