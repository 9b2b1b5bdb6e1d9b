// SPDX-License-Identifier: Apache-2.0
// Loads that may have deformed a body. Private to the core.
#pragma once

#include <Eigen/Core>
#include <array>

#include "pointbased/rest_state.h"

namespace pointbased::detail {

/// Linear space of smooth loads: tractions around sites of the skin, three directions each; a uniform body force; and
/// the tractions of a uniform stress, of which pressure is one. A unit of each is a traction of about 1 Pa.
class LoadPatterns {
 public:
  /// Without sites of the skin if that has no area.
  explicit LoadPatterns(const RestState &rest);
  [[nodiscard]] std::size_t count() const { return 3 * sites_.size() + 3 + stresses_.size(); }
  /// N, on the phyxels, of a unit of one pattern.
  void forces(std::size_t pattern, std::span<Vec3> out) const;

 private:
  void addSites(const RestState &rest, const SurfacePoints &samples, const Interpolation &binding, double area);
  std::size_t phyxels_;
  std::vector<std::vector<double>> sites_;  // [phyxels] m², of a traction
  std::vector<double> bodyForce_;           // [phyxels] m²
  std::array<std::vector<Vec3>, 6> stresses_;
};

}  // namespace pointbased::detail
