// SPDX-License-Identifier: Apache-2.0
#include "stepping/monitoring/contact_pressure.h"

#include <algorithm>
#include <cmath>

namespace pointbased::detail {
namespace {

double normalImpulseOf(const Contact &contact) {
  return contact.normalImpulse > 0.0 ? contact.normalImpulse + contact.projectionImpulse : 0.0;
}

// Distributes an amount to the phyxels that carry a point, by φ.
void distribute(const Interpolation &binding, Index point, double amount, std::vector<double> &out) {
  for (Index e = binding.phyxels.offsets[point]; e < binding.phyxels.offsets[point + 1]; ++e)
    out[binding.phyxels.indices[e]] += binding.weights[e] * amount;
}

void distributeAreas(const Interpolation &binding, std::span<const double> areas, std::vector<double> &out) {
  std::fill(out.begin(), out.end(), 0.0);
  for (std::size_t p = 0; p < binding.count(); ++p) distribute(binding, static_cast<Index>(p), areas[p], out);
}

// Weights of moving least squares may be negative: phyxels that carry hardly any skin have no pressure.
void addQuotients(std::span<const double> forces, std::span<const double> areas, std::vector<double> &out) {
  const double least = 1e-6 * *std::max_element(areas.begin(), areas.end());
  for (std::size_t i = 0; i < out.size(); ++i)
    if (areas[i] > least) out[i] += std::max(0.0, forces[i] / areas[i]);
}

}  // namespace

double pressedArea(const SkinPair &pair) {
  double area = 0.0;
  for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
    const ContactSkin &skin = pair.skin(side);
    std::vector<double> parts(skin.count(), 0.0);
    for (const SkinContact &contact : pair.active()) {
      if (!(normalImpulseOf(contact) > 0.0)) continue;
      for (const SkinContact::Part &part : contact.parts)
        if (part.ofSecond == (side == 1)) parts[part.vertex] += std::abs(part.weight);
    }
    for (std::size_t v = 0; v < parts.size(); ++v) area += 0.5 * std::min(1.0, parts[v]) * skin.areas[v];
  }
  return area;
}

PressureOnSkin::PressureOnSkin(const Body &body)
    : body_(body), pressures_(body.rest().phyxelCount(), 0.0), forces_(pressures_.size()), areas_(pressures_.size()) {}

// Contacts store the impulses of their last substep, sums those of the whole step: sums are distributed like impulses.
void PressureOnSkin::addObstacles() {
  const ContactState &contact = body_.contact;
  const ContactPoints &points = body_.rest().contact;
  if (!(contact.sums.duration > 0.0) || contact.active.empty()) return;
  const std::size_t walls = contact.sums.of.size() - 1;
  std::vector<double> total(walls + 1, 0.0);
  const auto numberOf = [walls](const Contact &one) {
    return one.obstacle == Contact::kWall ? walls : static_cast<std::size_t>(one.obstacle);
  };
  for (const Contact &one : contact.active) total[numberOf(one)] += normalImpulseOf(one);
  std::fill(forces_.begin(), forces_.end(), 0.0);
  bool any = false;
  for (const Contact &one : contact.active) {
    const double impulse = normalImpulseOf(one);
    const std::size_t o = numberOf(one);
    if (!(impulse > 0.0)) continue;
    distribute(points.binding, one.point,
               contact.sums.of[o].normalImpulseSum / contact.sums.duration * impulse / total[o], forces_);
    any = true;
  }
  if (!any) return;
  distributeAreas(points.binding, points.areas, areas_);
  addQuotients(forces_, areas_, pressures_);
}

void PressureOnSkin::addSkin(const SkinPair &pair, std::size_t side) {
  double total = 0.0;
  for (const SkinContact &one : pair.active()) total += normalImpulseOf(one);
  if (!(total > 0.0) || !(pair.sum().duration > 0.0)) return;
  const ContactSkin &skin = pair.skin(side);
  std::fill(forces_.begin(), forces_.end(), 0.0);
  for (const SkinContact &one : pair.active()) {
    const double force = pair.sum().normalImpulseSum / pair.sum().duration * normalImpulseOf(one) / total;
    if (!(force > 0.0)) continue;
    for (const SkinContact::Part &part : one.parts)
      if (part.ofSecond == (side == 1)) distribute(skin.vertices, part.vertex, std::abs(part.weight) * force, forces_);
  }
  distributeAreas(skin.vertices, skin.areas, areas_);
  addQuotients(forces_, areas_, pressures_);
}

}  // namespace pointbased::detail
