// SPDX-License-Identifier: Apache-2.0
#include "point_body.h"

#include <limits>
#include <map>
#include <numeric>

namespace mass_spring {
namespace {

// Springs that are pressed together pull less straight than at rest, and laws stiffen.
constexpr double kSafety = 0.7;
constexpr double kHandFrequency = 0.5;  // of a hand at most, of the fastest of the body

}  // namespace

double Moment::of(double ramp_s, double began_s) const {
  if (factor) return *factor;
  return ramp_s > 0.0 ? std::clamp((time_s - began_s) / ramp_s, 0.0, 1.0) : 1.0;
}

Vec3 Motion::of(const Vec3 &point, const Moment &moment) const {
  const double s = moment.of(ramp_s);
  return centre_m + rotationOf(s * rotation_rad) * (point - centre_m) + s * displacement_m;
}

PointBody::PointBody(Lattice lattice, Surface skin) : PointBody(lattice, std::move(skin), lattice.nodes()) {}

PointBody::PointBody(Lattice lattice, Surface skin, std::vector<Vec3> points)
    : lattice_(std::move(lattice)), skin_(refined(std::move(skin), lattice_.spacing())), points_(std::move(points)) {
  held_.assign(points_.size(), 0);
}

void PointBody::bindSkin() {
  for (const Vec3 &x : skin_.vertices) bound_.push_back(bind(x));
  skinAreas_.assign(skin_.vertices.size(), 0.0);
  for (const auto &[a, b, c] : skin_.triangles) {
    const Vec3 &x = skin_.vertices[a];
    const double area = 0.5 * length(cross(skin_.vertices[b] - x, skin_.vertices[c] - x));
    for (const std::uint32_t v : {a, b, c}) skinAreas_[v] += area / 3.0;
  }
  reset();
}

bool PointBody::isHeldBy(const c3de_sim_region &region, std::uint32_t point) const {
  return contains(region, points_[point]);
}

void PointBody::addMassesOfCells() {
  const double h = lattice_.spacing();
  masses_.assign(points_.size(), 0.0);
  volumes_ = masses_;
  for (std::size_t c = 0; c < lattice_.cells().size(); ++c) {
    const Lattice::Cell &cell = lattice_.cells()[c];
    for (const std::uint32_t node : cell.nodes) {
      volumes_[node] += cell.filled * h * h * h / 8.0;
      masses_[node] += materials_[c].density_kg_m3 * cell.filled * h * h * h / 8.0;
    }
  }
}

void PointBody::setStiffness(std::vector<double> points, double fastest_1_s2, double slowestDecay_s) {
  stiffnesses_ = std::move(points);
  frequency_1_s_ = std::sqrt(fastest_1_s2);
  // Semi-implicit Euler with forces of damping from before the step: w² dt² + 2 r dt <= 4, where r is the rate of the
  // damping.
  const double hand = kHandFrequency * frequency_1_s_;
  const double squared = fastest_1_s2 + hand * hand, rate = slowestDecay_s * fastest_1_s2 + hand;
  stableStep_s_ = kSafety * 4.0 / (rate + std::sqrt(rate * rate + 4.0 * squared));
}

void PointBody::addSupport(Support support) {
  for (const std::uint32_t n : support.nodes) held_[n] = 1;
  supports_.push_back(std::move(support));
  reset();
}

void PointBody::setInitialVelocity(const Vec3 &velocity_m_s, const Vec3 &angular_rad_s) {
  initialVelocity_ = velocity_m_s;
  initialAngularVelocity_ = angular_rad_s;
  reset();
}

void PointBody::reset() {
  const std::size_t n = points_.size();
  state_.positions = points_;
  state_.velocities.assign(n, initialVelocity_);
  const Vec3 middle = centre();
  for (std::size_t i = 0; i < n; ++i)
    state_.velocities[i] =
        held_[i] != 0 ? Vec3{} : initialVelocity_ + cross(initialAngularVelocity_, state_.positions[i] - middle);
  forces_.assign(n, Vec3{});
  holds.clear();
}

void PointBody::setState(State state) {
  state_ = std::move(state);
  forces_.assign(state_.positions.size(), Vec3{});
}

void PointBody::addLoad(const SurfaceLoad &load, const Moment &moment) {
  const double factor = moment.of(load.ramp_s, load.began_s);
  const auto corner = [&](std::uint32_t v) { return load.isDead ? skin_.vertices[v] : bound_[v].of(state_.positions); };
  for (const std::uint32_t t : load.triangles) {
    const auto &[a, b, c] = skin_.triangles[t];
    const Vec3 &x = skin_.vertices[a];
    const double restArea = 0.5 * length(cross(skin_.vertices[b] - x, skin_.vertices[c] - x));
    Vec3 force = (restArea / load.area_m2) * load.force_N;
    if (load.pressure_Pa != 0.0) {
      const Vec3 p = corner(a);
      force += (-0.5 * load.pressure_Pa) * cross(corner(b) - p, corner(c) - p);
    }
    for (const std::uint32_t v : {a, b, c})
      for (std::size_t k = 0; k < bound_[v].nodes.size(); ++k)
        forces_[bound_[v].nodes[k]] += (factor / 3.0 * bound_[v].weights[k]) * force;
  }
}

void PointBody::addHolds() {
  // Hands that hold the same masses add up.
  const double share = holds.empty() ? 1.0 : 1.0 / static_cast<double>(holds.size());
  for (auto &[id, hold] : holds) {
    Vec3 velocity{};
    hold.middle_m = {};
    for (std::size_t k = 0; k < hold.nodes.size(); ++k) {
      hold.middle_m += hold.weights[k] * state_.positions[hold.nodes[k]];
      velocity += hold.weights[k] * state_.velocities[hold.nodes[k]];
    }
    hold.force_N =
        share * (hold.stiffness_N_m * (hold.target_m + hold.offset_m - hold.middle_m) - hold.damping_Ns_m * velocity);
    const double size = length(hold.force_N);
    if (hold.mostForce_N > 0.0 && size > hold.mostForce_N) hold.force_N = (hold.mostForce_N / size) * hold.force_N;
    for (std::size_t k = 0; k < hold.nodes.size(); ++k) forces_[hold.nodes[k]] += hold.weights[k] * hold.force_N;
  }
}

void PointBody::addContact(const Loading &loading) {
  const std::vector<Vec3> skin = onSkin(state_.positions);
  std::vector<Vec3> out(skin.size(), Vec3{});
  for (const Obstacle &obstacle : loading.obstacles) obstacle(loading.moment, skin, out);
  double youngsModulus = 0.0;
  for (const Elasticity &m : materials_) youngsModulus = std::max(youngsModulus, m.youngsModulus_Pa);
  for (std::size_t v = 0; v < skin.size(); ++v) {
    if (out[v] == Vec3{}) continue;
    const double k = kPush * youngsModulus / lattice_.spacing() * skinAreas_[v];
    double sum = 0.0;
    for (const double w : bound_[v].weights) sum += std::abs(w);
    for (std::size_t n = 0; n < bound_[v].nodes.size(); ++n) {
      const double w = bound_[v].weights[n];
      forces_[bound_[v].nodes[n]] += (k * w) * out[v];
      pushes_[bound_[v].nodes[n]] += k * std::abs(w) * sum;
    }
  }
}

void PointBody::computeForces(double dt_s, const Loading &loading) {
  std::fill(forces_.begin(), forces_.end(), Vec3{});
  addInternalForces(dt_s);
  for (const SurfaceLoad &load : loads) addLoad(load, loading.moment);
  for (const SurfaceLoad &load : loading.more) addLoad(load, loading.moment);
  addHolds();
  pushes_.assign(points_.size(), 0.0);
  if (!loading.obstacles.empty()) addContact(loading);
  for (std::size_t i = 0; i < loading.external_N.size(); ++i) forces_[i] += loading.external_N[i];
}

void PointBody::step(double dt_s, double damping_1_s, const Loading &loading) {
  computeForces(dt_s, loading);
  const double kept = 1.0 / (1.0 + damping_1_s * dt_s);
  for (std::size_t i = 0; i < masses_.size(); ++i) {
    if (held_[i] != 0) continue;
    const Vec3 before = state_.velocities[i];
    state_.velocities[i] = kept * (before + dt_s * ((1.0 / masses_[i]) * forces_[i] + loading.gravity_m_s2));
    state_.positions[i] += dt_s * (movesByOldVelocity() ? before : state_.velocities[i]);
  }
  moveSupports({loading.moment.time_s + dt_s}, dt_s);
}

void PointBody::moveSupports(const Moment &moment, double dt_s) {
  for (const Support &support : supports_)
    for (const std::uint32_t i : support.nodes) {
      const Vec3 to = support.motion ? support.motion->of(points_[i], moment) : points_[i];
      state_.velocities[i] = dt_s > 0.0 ? (1.0 / dt_s) * (to - state_.positions[i]) : Vec3{};
      state_.positions[i] = to;
    }
}

void PointBody::keepWithin(const Vec3 &low_m, const Vec3 &high_m) {
  for (std::size_t i = 0; i < masses_.size(); ++i) {
    if (held_[i] != 0) continue;
    for (std::size_t a = 0; a < 3; ++a) {
      const double inside = std::clamp(state_.positions[i][a], low_m[a], high_m[a]);
      if (inside == state_.positions[i][a]) continue;
      state_.positions[i][a] = inside;
      state_.velocities[i][a] = 0.0;
    }
  }
}

bool PointBody::isFinite() const {
  return std::all_of(state_.positions.begin(), state_.positions.end(), [](const Vec3 &x) {
    return mass_spring::isFinite(x) && std::max({std::abs(x[0]), std::abs(x[1]), std::abs(x[2])}) < 1e6;
  });
}

Hold PointBody::holdAround(const c3de_sim_hold &asked) const {
  const double reach = std::max(asked.radius_m, 1.01 * lattice_.spacing());
  Hold out;
  std::copy_n(asked.at_m, 3, out.target_m.begin());
  double sum = 0.0;
  for (std::uint32_t i = 0; i < masses_.size(); ++i) {
    const double d = length(state_.positions[i] - out.target_m) / reach;
    if (d >= 1.0) continue;
    out.nodes.push_back(i);
    out.weights.push_back(masses_[i] * (1.0 - d * d));
    sum += out.weights.back();
  }
  if (!(sum > 0.0)) throw sdk::Error(C3DE_E_ARG, "hold: nothing of the body lies within the radius of the point");
  double youngsModulus = 0.0;
  for (const Elasticity &m : materials_) youngsModulus = std::max(youngsModulus, m.youngsModulus_Pa);
  double inverseMass = 0.0;
  for (std::size_t k = 0; k < out.nodes.size(); ++k) {
    out.weights[k] /= sum;
    inverseMass += out.weights[k] * out.weights[k] / masses_[out.nodes[k]];
    out.middle_m += out.weights[k] * state_.positions[out.nodes[k]];
  }
  out.offset_m = out.middle_m - out.target_m;
  out.mass_kg = 1.0 / inverseMass;
  out.mostForce_N = asked.max_force_N;
  // As asked for, or as stiff as the patch itself; as far as the step allows.
  const double wanted_1_s = asked.frequency_hz > 0.0 ? 2.0 * std::numbers::pi * asked.frequency_hz
                                                     : std::sqrt(2.0 * youngsModulus * reach / out.mass_kg);
  const double omega_1_s = std::min(wanted_1_s, kHandFrequency * frequency_1_s_);
  out.stiffness_N_m = out.mass_kg * omega_1_s * omega_1_s;
  out.damping_Ns_m = 2.0 * (asked.damping_ratio > 0.0 ? asked.damping_ratio : 1.0) * out.mass_kg * omega_1_s;
  return out;
}

double PointBody::mass_kg() const { return std::accumulate(masses_.begin(), masses_.end(), 0.0); }
double PointBody::volume_m3() const { return std::accumulate(volumes_.begin(), volumes_.end(), 0.0); }

Vec3 PointBody::momentum() const {
  Vec3 sum{};
  for (std::size_t i = 0; i < masses_.size(); ++i) sum += masses_[i] * state_.velocities[i];
  return sum;
}

Vec3 PointBody::angularMomentum() const {
  Vec3 sum{};
  for (std::size_t i = 0; i < masses_.size(); ++i) sum += masses_[i] * cross(state_.positions[i], state_.velocities[i]);
  return sum;
}

Vec3 PointBody::centre() const {
  Vec3 sum{};
  for (std::size_t i = 0; i < masses_.size(); ++i) sum += masses_[i] * state_.positions[i];
  return (1.0 / mass_kg()) * sum;
}

double PointBody::kineticEnergy_J() const {
  double sum = 0.0;
  for (std::size_t i = 0; i < masses_.size(); ++i)
    sum += 0.5 * masses_[i] * dot(state_.velocities[i], state_.velocities[i]);
  return sum;
}

PointBody::Reaction PointBody::reaction(const Support &support, const Vec3 &gravity_m_s2) const {
  Reaction sum;
  for (const std::uint32_t i : support.nodes) {
    const Vec3 force = forces_[i] + masses_[i] * gravity_m_s2;
    sum.force_N -= force;
    sum.torque_Nm -= cross(state_.positions[i], force);
  }
  return sum;
}

std::vector<Vec3> PointBody::onSkin(const std::vector<Vec3> &ofPoints) const {
  std::vector<Vec3> out;
  out.reserve(bound_.size());
  for (const Bound &b : bound_) out.push_back(b.of(ofPoints));
  return out;
}

}  // namespace mass_spring
