// SPDX-License-Identifier: Apache-2.0
// A body whose mass sits in points: what acts on them, and its state in time. The forces within are a method's own.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string_view>

#include "c3de/abi/iface/simulator.h"
#include "lattice.h"

namespace mass_spring {

/// Of a cell.
struct Elasticity {
  double youngsModulus_Pa = 0.0, density_kg_m3 = 0.0, retardationTime_s = 0.0, poissonRatio = 0.25;
};

/// How far loads and motions have come: those with a ramp by the time, of a quasi-static solution all by one factor.
struct Moment {
  double time_s = 0.0;
  std::optional<double> factor = std::nullopt;
  [[nodiscard]] double of(double ramp_s, double began_s = 0.0) const;
};

/// A rigid motion that is reached at the end of the ramp.
struct Motion {
  Vec3 displacement_m{}, rotation_rad{}, centre_m{};
  double ramp_s = 0.0;
  [[nodiscard]] Vec3 of(const Vec3 &point, const Moment &moment) const;
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

/// How far points are inside of an obstacle, as the way out, m; added to `out`, one per point.
using Obstacle = std::function<void(const Moment &moment, const std::vector<Vec3> &points, std::vector<Vec3> &out)>;

/// What acts on a body from outside.
struct Loading {
  Moment moment;
  Vec3 gravity_m_s2{};
  std::vector<Vec3> external_N;   ///< one per point, or empty
  std::vector<SurfaceLoad> more;  ///< loads beside those that came with the body
  /// The skin is pushed out of them, by kPush E / h per area and way.
  std::vector<Obstacle> obstacles;
};

class PointBody {
 public:
  /// What the next steps follow from.
  struct State {
    std::vector<Vec3> positions, velocities;
  };
  /// What the forces within come from, for reports: "springs", 1200.
  struct Elements {
    std::string_view name;
    std::size_t count = 0;
  };

  virtual ~PointBody() = default;
  PointBody(const PointBody &) = delete;
  PointBody &operator=(const PointBody &) = delete;

  /// Stiffness, masses and stable step anew. @param materials  one per cell
  virtual void setMaterials(std::vector<Elasticity> materials) = 0;
  [[nodiscard]] virtual double elasticEnergy_J() const = 0;
  [[nodiscard]] virtual Elements elements() const = 0;
  /// Per point; empty: the method has no such thing.
  [[nodiscard]] virtual std::vector<double> stretches() const { return {}; }
  /// What is wrong with a body that has come to rest, for people; empty: nothing.
  [[nodiscard]] virtual std::string trouble() const { return {}; }
  /// A material point by those that carry mass. @param off  how far outside of the body's cells it lies, m
  [[nodiscard]] virtual Bound bind(const Vec3 &point, double *off = nullptr) const { return lattice_.bind(point, off); }
  /// Whether a support of this region holds the point.
  [[nodiscard]] virtual bool isHeldBy(const c3de_sim_region &region, std::uint32_t point) const;

  void addSupport(Support support);
  void setInitialVelocity(const Vec3 &velocity_m_s, const Vec3 &angular_rad_s);
  void reset();
  /// One step of semi-implicit Euler; supports are at its end then.
  void step(double dt_s, double damping_1_s, const Loading &loading);
  /// What acts on the points at their present places into forces(). @param dt_s  of the step to come; 0: at rest
  void computeForces(double dt_s, const Loading &loading);
  /// What is held goes where its motion leads; @param dt_s  0: without a velocity
  void moveSupports(const Moment &moment, double dt_s);
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
  /// For who moves the points otherwise than step() does.
  [[nodiscard]] State &state() { return state_; }
  /// At rest.
  [[nodiscard]] const std::vector<Vec3> &points() const { return points_; }
  [[nodiscard]] const std::vector<double> &masses() const { return masses_; }
  [[nodiscard]] const std::vector<double> &volumes() const { return volumes_; }
  [[nodiscard]] const std::vector<std::uint8_t> &held() const { return held_; }
  [[nodiscard]] const std::vector<Support> &supports() const { return supports_; }
  static constexpr double kPush = 30.0;

  /// N/m, one per point: as diagonal matrix at least the stiffness of the body at rest.
  [[nodiscard]] const std::vector<double> &stiffnesses() const { return stiffnesses_; }
  /// Likewise of what pushes it out of obstacles at its present place.
  [[nodiscard]] const std::vector<double> &pushStiffnesses() const { return pushes_; }
  [[nodiscard]] double stableStep_s() const { return stableStep_s_; }
  /// What may be asked for beyond stableStep_s().
  [[nodiscard]] virtual double longestStep_s() const { return stableStep_s_; }
  [[nodiscard]] double mass_kg() const;
  [[nodiscard]] double volume_m3() const;
  [[nodiscard]] Vec3 momentum() const;
  [[nodiscard]] Vec3 angularMomentum() const;
  [[nodiscard]] Vec3 centre() const;
  [[nodiscard]] double kineticEnergy_J() const;
  /// What a support takes up: N, and N m about the origin at the present places; of body, loads and gravity on its
  /// points, turned round.
  struct Reaction {
    Vec3 force_N{}, torque_Nm{};
  };
  [[nodiscard]] Reaction reaction(const Support &support, const Vec3 &gravity_m_s2) const;
  /// Of body, loads and hand in the last step, N, one per point; gravity is not in it.
  [[nodiscard]] const std::vector<Vec3> &forces() const { return forces_; }
  [[nodiscard]] std::vector<Vec3> onSkin(const std::vector<Vec3> &ofPoints) const;

  std::vector<SurfaceLoad> loads;       ///< those that came with the body
  std::map<std::uint64_t, Hold> holds;  ///< by their handles

 protected:
  /// Points at the corners of the cells.
  PointBody(Lattice lattice, Surface skin);
  PointBody(Lattice lattice, Surface skin, std::vector<Vec3> points);
  /// Once there are masses and bind() works.
  void bindSkin();
  void keepMaterials(std::vector<Elasticity> materials) { materials_ = std::move(materials); }
  /// Masses and volumes of cells go to their corners. @pre the points are those
  void addMassesOfCells();
  /// @param points  stiffnesses()
  /// @param fastest_1_s2  bound of the squares of the frequencies
  /// @param slowestDecay_s  damping over stiffness, at most
  void setStiffness(std::vector<double> points, double fastest_1_s2, double slowestDecay_s);
  /// Adds what the points do to each other at their places: addForce(). @param dt_s  of the step to come; 0: at rest
  virtual void addInternalForces(double dt_s) = 0;
  /// Whether points move by the velocity from before the step (forward Euler).
  [[nodiscard]] virtual bool movesByOldVelocity() const { return false; }
  void addForce(std::uint32_t point, const Vec3 &force_N) { forces_[point] += force_N; }
  void setMasses(std::vector<double> masses_kg, std::vector<double> volumes_m3) {
    masses_ = std::move(masses_kg);
    volumes_ = std::move(volumes_m3);
  }

 private:
  void addLoad(const SurfaceLoad &load, const Moment &moment);
  void addHolds();
  void addContact(const Loading &loading);

  Lattice lattice_;
  Surface skin_;
  std::vector<Bound> bound_;  // of the skin's vertices
  std::vector<Elasticity> materials_;
  std::vector<Vec3> points_;
  std::vector<double> masses_, volumes_, stiffnesses_;
  std::vector<double> skinAreas_, pushes_;  // m², of the skin's vertices; N/m, of the points
  std::vector<std::uint8_t> held_;
  std::vector<Support> supports_;
  Vec3 initialVelocity_{}, initialAngularVelocity_{};
  double frequency_1_s_ = 0.0, stableStep_s_ = 0.0;
  State state_;
  std::vector<Vec3> forces_;
};

/// In regions of the scene.
[[nodiscard]] bool contains(const c3de_sim_region &region, const Vec3 &x);

}  // namespace mass_spring
