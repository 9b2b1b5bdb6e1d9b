// SPDX-License-Identifier: Apache-2.0
// A body of masses and springs: its forces, and its state in time.
#pragma once

#include <cstdint>
#include <map>

#include "c3de/abi/iface/simulator.h"
#include "lattice.h"

namespace mass_spring {

/// Of a cell.
struct Elasticity {
  double youngsModulus_Pa = 0.0, density_kg_m3 = 0.0, retardationTime_s = 0.0;
};

/// A rigid motion that is reached at the end of the ramp.
struct Motion {
  Vec3 displacement_m{}, rotation_rad{}, centre_m{};
  double ramp_s = 0.0;
  [[nodiscard]] Vec3 of(const Vec3 &point, double time_s) const;
};

struct Support {
  std::uint32_t number = 0;
  std::vector<std::uint32_t> nodes;
  std::optional<Motion> motion;
};

struct SurfaceLoad {
  std::vector<std::uint32_t> triangles;  // of the skin
  double area_m2 = 0.0;                  // theirs, at rest
  Vec3 force_N{};
  double pressure_Pa = 0.0;
  bool isDead = false;
  double ramp_s = 0.0, began_s = 0.0;
};

/// A hand: a damped spring between the middle of some masses and a target.
struct Hold {
  std::vector<std::uint32_t> nodes;
  std::vector<double> weights;
  Vec3 target_m{}, offset_m{};  // from the point that was named to the middle that is held
  double stiffness_N_m = 0.0, damping_Ns_m = 0.0;
  double mass_kg = 0.0;
  double mostForce_N = 0.0;    // 0: any
  Vec3 middle_m{}, force_N{};  // of the last step
};

class SpringBody {
 public:
  /// What the next steps follow from.
  struct State {
    std::vector<Vec3> positions, velocities;
  };

  /// @param materials  one per cell of the lattice
  SpringBody(Lattice lattice, Surface skin, std::vector<Elasticity> materials);

  /// Stiffness, masses and stable step anew. @param materials  one per cell
  void setMaterials(std::vector<Elasticity> materials);
  void addSupport(Support support);
  void setInitialVelocity(const Vec3 &velocity_m_s, const Vec3 &angular_rad_s);
  void reset();
  /// One step of semi-implicit Euler.
  /// @param external_N  one per node, or empty
  /// @param more  loads beside those that came with the body
  void step(double time_s, double dt_s, const Vec3 &gravity_m_s2, double damping_1_s,
            const std::vector<Vec3> &external_N, const std::vector<SurfaceLoad> &more);
  /// Masses do not pass these walls.
  void keepWithin(const Vec3 &low_m, const Vec3 &high_m);
  [[nodiscard]] bool isFinite() const;
  /// @pre its sizes are those of this body
  void setState(State state);

  /// @throws sdk::Error  no mass within reach of a step
  [[nodiscard]] Hold holdAround(const c3de_sim_hold &asked) const;

  [[nodiscard]] const Lattice &lattice() const { return lattice_; }
  [[nodiscard]] const Surface &skin() const { return skin_; }
  [[nodiscard]] const std::vector<Elasticity> &materials() const { return materials_; }
  [[nodiscard]] const State &state() const { return state_; }
  [[nodiscard]] const std::vector<double> &masses() const { return masses_; }
  [[nodiscard]] const std::vector<double> &volumes() const { return volumes_; }
  [[nodiscard]] const std::vector<std::uint8_t> &held() const { return held_; }
  [[nodiscard]] const std::vector<Support> &supports() const { return supports_; }
  [[nodiscard]] double stableStep_s() const { return stableStep_s_; }
  [[nodiscard]] double mass_kg() const;
  [[nodiscard]] double volume_m3() const;
  [[nodiscard]] Vec3 momentum() const;
  [[nodiscard]] Vec3 angularMomentum() const;
  [[nodiscard]] Vec3 centre() const;
  [[nodiscard]] double kineticEnergy_J() const;
  [[nodiscard]] double elasticEnergy_J() const;
  /// What a support takes up, N: the forces of springs and loads on its masses, turned round.
  [[nodiscard]] Vec3 reaction(const Support &support) const;
  /// Of springs, loads and hand in the last step, N, one per node; gravity is not in it.
  [[nodiscard]] const std::vector<Vec3> &forces() const { return forces_; }
  /// Mean length of the springs at a node over their length at rest.
  [[nodiscard]] std::vector<double> stretches() const;
  [[nodiscard]] std::vector<Vec3> onSkin(const std::vector<Vec3> &ofNodes) const;
  [[nodiscard]] std::size_t springCount() const { return springs_.size(); }

  std::vector<SurfaceLoad> loads;       ///< those that came with the body
  std::map<std::uint64_t, Hold> holds;  ///< by their handles

 private:
  struct Spring {
    std::uint32_t a = 0, b = 0;
    double length_m = 0.0, stiffness_N_m = 0.0, damping_Ns_m = 0.0;
  };

  void addSprings();
  void addLoad(const SurfaceLoad &load, double time_s);
  void addHolds();

  Lattice lattice_;
  Surface skin_;
  std::vector<Bound> bound_;  // of the skin's vertices
  std::vector<Elasticity> materials_;
  std::vector<Spring> springs_;
  std::vector<double> masses_, volumes_;
  std::vector<std::uint8_t> held_;
  std::vector<Support> supports_;
  Vec3 initialVelocity_{}, initialAngularVelocity_{};
  double frequency_1_s_ = 0.0, stableStep_s_ = 0.0;
  State state_;
  std::vector<Vec3> forces_;
};

}  // namespace mass_spring
