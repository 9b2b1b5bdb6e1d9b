// SPDX-License-Identifier: Apache-2.0
#include "tools/drawn_marks.h"

#include <array>

namespace pointbased {
namespace {

constexpr float kMarkWidth = 3.0f;  // px

}  // namespace

void DrawnMarks::lines(sdk::Proxy &lines, std::span<const Vec3> points, const sdk::Material &material) const {
  if (lines)
    (void)services_.render.update(lines.handle(), C3DE_ATTR_POSITIONS, viewOf(points));
  else if (auto made = services_.render.createLines(node_, viewOf(points), kMarkWidth, material))
    lines = std::move(*made);
}

// Its head has barbs on four sides, because a slice shows it from one side only.
void DrawnMarks::arrow(sdk::Proxy &arrow, const Vec3 &from, const Vec3 &vector, const sdk::Material &material) const {
  const double length = vector.norm();
  if (!(length > 0.0)) return arrow.reset();
  const Vec3 side = 0.12 * length * vector.unitOrthogonal(), other = side.cross(vector) / length;
  const Vec3 tip = from + vector, neck = tip - 0.25 * vector;
  lines(arrow,
        std::array<Vec3, 10>{from, tip, tip, neck + side, tip, neck - side, tip, neck + other, tip, neck - other},
        material);
}

void DrawnMarks::label(sdk::Proxy &label, const Vec3 &at, const std::string &text,
                       const sdk::Material &material) const {
  if (label)
    (void)services_.render.setLabel(label.handle(), toArray(at), text);
  else if (auto made = services_.render.createLabel(node_, toArray(at), text, material))
    label = std::move(*made);
}

void DrawnMarks::sphere(sdk::Proxy &sphere, const Vec3 &at, double radius, const sdk::Material &material) const {
  const std::span<const Vec3> centre(&at, 1);
  if (sphere)
    (void)services_.render.update(sphere.handle(), C3DE_ATTR_POSITIONS, viewOf(centre));
  else if (auto made = services_.render.createSpheres(node_, viewOf(centre), radius, material))
    sphere = std::move(*made);
}

}  // namespace pointbased
