// SPDX-License-Identifier: Apache-2.0
// One body through the engine as a program would use it: filled, held, loaded, solved, measured.
#pragma once

#include <optional>

#include "pointbased/simulator.h"
#include "pointbased/verification.h"

namespace validation {

using pointbased::Mat3;
using pointbased::Region;
using pointbased::Vec3;

/// Region between two planes across an axis.
[[nodiscard]] Region slab(int axis, double low, double high);
/// A flat face of the border; so thin that it contains no volume.
[[nodiscard]] Region face(int axis, double at);

struct Problem {
  pointbased::BodyShape shape{};
  pointbased::Material material{};
  pointbased::BodyRecipe recipe{};
  pointbased::WorldSettings world{};
  std::vector<pointbased::Obstacle> obstacles{};
  std::vector<pointbased::Fix> supportsByHand{};  ///< parts of the surface; numbered after the fixes of the recipe

  /// A quasi-static problem of the laws' usual rubber: E = 10 kPa, nu = 0.3, 1000 kg/m³.
  static Problem rubber(const pointbased::BodyShape &shape, double spacing,
                        pointbased::MaterialLaw law = pointbased::MaterialLaw::stVenantKirchhoff);
  Problem &hold(const Region &region) { return move(region, Vec3::Zero()); }
  Problem &move(const Region &region, const Vec3 &displacement);
  Problem &turn(const Region &region, const Vec3 &rotation_deg, const Vec3 &centre);
  Problem &moveByHand(const Region &region, const Vec3 &displacement);
  Problem &pull(const Region &region, const Vec3 &force);
  Problem &atPhyxels();  ///< Müller's evaluation instead of stress points
};

/// A world with that body alone. Throws std::runtime_error with the reason for a refusal.
class SolvedBody {
 public:
  /// Builds the body; quasi-static problems are solved completely.
  explicit SolvedBody(const Problem &problem);
  /// The fine reference that a verification has solved.
  SolvedBody(const Problem &problem, const pointbased::Verification &verification);

  /// Verifies the current state; throws with the reason for a refusal.
  [[nodiscard]] pointbased::Verification verify(const Problem &problem);
  [[nodiscard]] pointbased::Simulator &simulator() { return simulator_; }
  [[nodiscard]] pointbased::Body &body() { return *simulator_.body(id_); }
  [[nodiscard]] const pointbased::RestState &rest() const { return *rest_; }
  [[nodiscard]] std::size_t id() const { return id_; }
  /// Steps until a time, s; the last step ends beyond it.
  void run(double until);

  /// Means over a part of the border, and over the part of the volume inside a region, m.
  [[nodiscard]] Vec3 meanOver(const Region &border);
  [[nodiscard]] Vec3 meanWithin(const Region &region);
  [[nodiscard]] Vec3 displacementAt(const Vec3 &X);
  [[nodiscard]] pointbased::Reaction reaction(std::size_t fix);
  /// About the origin of the world, N m.
  [[nodiscard]] Vec3 torqueAboutOrigin(std::size_t fix);
  /// Σ m v and Σ x × m v about the origin of the frame of the phyxels.
  [[nodiscard]] Vec3 momentum();
  [[nodiscard]] Vec3 angularMomentum();
  [[nodiscard]] double milliseconds() const { return milliseconds_; }

 private:
  [[nodiscard]] std::vector<Vec3> displacementsOf(const std::vector<Vec3> &points, const std::vector<Vec3> &normals);

  pointbased::BodyShape shape_;
  std::shared_ptr<const pointbased::RestState> rest_;
  pointbased::Simulator simulator_;
  std::size_t id_ = 0;
  std::optional<std::vector<pointbased::Reaction>> reactions_;  // instead of the simulator's
  double milliseconds_ = 0.0;
};

}  // namespace validation
