// SPDX-License-Identifier: Apache-2.0
#include "spring_body.h"

#include <limits>
#include <map>
#include <numeric>

namespace mass_spring {
namespace {

// Stiffness of the springs of one cell in units of Young's modulus times spacing: the isotropic lattice whose face and
// body diagonals bear alike. Derived in docs/plugin/mass_spring.md.
constexpr double kEdge = 3.0 / 5.0, kFaceDiagonal = 1.0 / 5.0, kBodyDiagonal = 3.0 / 20.0;
// Squared bound of the frequencies of one cell, times density spacing² / Young's modulus: twice the stiffness at a
// corner over an eighth of its mass. No assembly of cells swings faster than its fastest one.
constexpr double kFastest = 2.0 * (3.0 * kEdge / 4.0 + 3.0 * kFaceDiagonal / 2.0 + kBodyDiagonal) * 8.0;
// Springs that are pressed together pull less straight than at rest.
constexpr double kSafety = 0.7;
constexpr double kHandFrequency = 0.5;  // of a hand at most, of the fastest of the body

double factorOf(const SurfaceLoad &load, double time_s) {
  const double since = time_s - load.began_s;
  return load.ramp_s > 0.0 ? std::clamp(since / load.ramp_s, 0.0, 1.0) : 1.0;
}

}  // namespace

Vec3 Motion::of(const Vec3 &point, double time_s) const {
  const double s = ramp_s > 0.0 ? std::clamp(time_s / ramp_s, 0.0, 1.0) : 1.0;
  return centre_m + rotationOf(s * rotation_rad) * (point - centre_m) + s * displacement_m;
}

SpringBody::SpringBody(Lattice lattice, Surface skin, std::vector<Elasticity> materials)
    : lattice_(std::move(lattice)), skin_(refined(std::move(skin), lattice_.spacing())) {
  for (const Vec3 &x : skin_.vertices) bound_.push_back(lattice_.bind(x));
  held_.assign(lattice_.nodes().size(), 0);
  setMaterials(std::move(materials));
  reset();
}

void SpringBody::setMaterials(std::vector<Elasticity> materials) {
  materials_ = std::move(materials);
  const double h = lattice_.spacing();
  masses_.assign(lattice_.nodes().size(), 0.0);
  volumes_ = masses_;
  struct Sum {
    double stiffness = 0.0, damping = 0.0, length = 0.0;
  };
  std::map<std::pair<std::uint32_t, std::uint32_t>, Sum> sums;
  double fastest = 0.0, slowestDecay_s = 0.0;
  for (std::size_t c = 0; c < lattice_.cells().size(); ++c) {
    const Lattice::Cell &cell = lattice_.cells()[c];
    const Elasticity &m = materials_[c];
    fastest = std::max(fastest, kFastest * m.youngsModulus_Pa / (m.density_kg_m3 * h * h));
    slowestDecay_s = std::max(slowestDecay_s, m.retardationTime_s);
    for (std::size_t a = 0; a < 8; ++a) {
      volumes_[cell.nodes[a]] += cell.filled * h * h * h / 8.0;
      masses_[cell.nodes[a]] += m.density_kg_m3 * cell.filled * h * h * h / 8.0;
      for (std::size_t b = a + 1; b < 8; ++b) {
        const std::size_t differ = a ^ b, axes = (differ & 1) + (differ >> 1 & 1) + (differ >> 2);
        // An edge belongs to four cells, the diagonal of a face to two.
        const double share = axes == 1 ? kEdge / 4.0 : axes == 2 ? kFaceDiagonal / 2.0 : kBodyDiagonal;
        const double k = share * cell.filled * m.youngsModulus_Pa * h;
        Sum &sum = sums[{std::min(cell.nodes[a], cell.nodes[b]), std::max(cell.nodes[a], cell.nodes[b])}];
        sum.stiffness += k;
        sum.damping += k * m.retardationTime_s;
        sum.length = h * std::sqrt(static_cast<double>(axes));
      }
    }
  }
  springs_.clear();
  for (const auto &[ends, sum] : sums)
    springs_.push_back({ends.first, ends.second, sum.length, sum.stiffness, sum.damping});
  frequency_1_s_ = std::sqrt(fastest);
  // Semi-implicit Euler with forces of damping from before the step: w² dt² + 2 r dt <= 4, where r is the rate of the
  // damping.
  const double hand = kHandFrequency * frequency_1_s_;
  const double squared = fastest + hand * hand, rate = slowestDecay_s * fastest + hand;
  stableStep_s_ = kSafety * 4.0 / (rate + std::sqrt(rate * rate + 4.0 * squared));
}

void SpringBody::addSupport(Support support) {
  for (const std::uint32_t n : support.nodes) held_[n] = 1;
  supports_.push_back(std::move(support));
  reset();
}

void SpringBody::setInitialVelocity(const Vec3 &velocity_m_s, const Vec3 &angular_rad_s) {
  initialVelocity_ = velocity_m_s;
  initialAngularVelocity_ = angular_rad_s;
  reset();
}

void SpringBody::reset() {
  const std::size_t n = lattice_.nodes().size();
  state_.positions = lattice_.nodes();
  state_.velocities.assign(n, initialVelocity_);
  const Vec3 middle = centre();
  for (std::size_t i = 0; i < n; ++i)
    state_.velocities[i] =
        held_[i] != 0 ? Vec3{} : initialVelocity_ + cross(initialAngularVelocity_, state_.positions[i] - middle);
  forces_.assign(n, Vec3{});
  holds.clear();
}

void SpringBody::setState(State state) {
  state_ = std::move(state);
  forces_.assign(state_.positions.size(), Vec3{});
}

void SpringBody::addSprings() {
  for (const Spring &s : springs_) {
    const Vec3 d = state_.positions[s.b] - state_.positions[s.a];
    const double l = length(d);
    if (!(l > 0.0)) continue;  // no direction, no force
    const Vec3 n = (1.0 / l) * d;
    const double speed = dot(state_.velocities[s.b] - state_.velocities[s.a], n);
    const Vec3 f = (s.stiffness_N_m * (l - s.length_m) + s.damping_Ns_m * speed) * n;
    forces_[s.a] += f;
    forces_[s.b] -= f;
  }
}

void SpringBody::addLoad(const SurfaceLoad &load, double time_s) {
  const double factor = factorOf(load, time_s);
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
      for (std::size_t k = 0; k < 8; ++k) forces_[bound_[v].nodes[k]] += (factor / 3.0 * bound_[v].weights[k]) * force;
  }
}

void SpringBody::addHolds() {
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

void SpringBody::step(double time_s, double dt_s, const Vec3 &gravity_m_s2, double damping_1_s,
                      const std::vector<Vec3> &external_N, const std::vector<SurfaceLoad> &more) {
  std::fill(forces_.begin(), forces_.end(), Vec3{});
  addSprings();
  for (const SurfaceLoad &load : loads) addLoad(load, time_s);
  for (const SurfaceLoad &load : more) addLoad(load, time_s);
  addHolds();
  for (std::size_t i = 0; i < external_N.size(); ++i) forces_[i] += external_N[i];
  const double kept = 1.0 / (1.0 + damping_1_s * dt_s);
  for (std::size_t i = 0; i < masses_.size(); ++i) {
    if (held_[i] != 0) continue;
    state_.velocities[i] = kept * (state_.velocities[i] + dt_s * ((1.0 / masses_[i]) * forces_[i] + gravity_m_s2));
    state_.positions[i] += dt_s * state_.velocities[i];
  }
  for (const Support &support : supports_)
    for (const std::uint32_t i : support.nodes) {
      const Vec3 &rest = lattice_.nodes()[i];
      const Vec3 to = support.motion ? support.motion->of(rest, time_s + dt_s) : rest;
      state_.velocities[i] = (1.0 / dt_s) * (to - state_.positions[i]);
      state_.positions[i] = to;
    }
}

void SpringBody::keepWithin(const Vec3 &low_m, const Vec3 &high_m) {
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

bool SpringBody::isFinite() const {
  return std::all_of(state_.positions.begin(), state_.positions.end(), [](const Vec3 &x) {
    return mass_spring::isFinite(x) && std::max({std::abs(x[0]), std::abs(x[1]), std::abs(x[2])}) < 1e6;
  });
}

Hold SpringBody::holdAround(const c3de_sim_hold &asked) const {
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

double SpringBody::mass_kg() const { return std::accumulate(masses_.begin(), masses_.end(), 0.0); }
double SpringBody::volume_m3() const { return std::accumulate(volumes_.begin(), volumes_.end(), 0.0); }

Vec3 SpringBody::momentum() const {
  Vec3 sum{};
  for (std::size_t i = 0; i < masses_.size(); ++i) sum += masses_[i] * state_.velocities[i];
  return sum;
}

Vec3 SpringBody::angularMomentum() const {
  Vec3 sum{};
  for (std::size_t i = 0; i < masses_.size(); ++i) sum += masses_[i] * cross(state_.positions[i], state_.velocities[i]);
  return sum;
}

Vec3 SpringBody::centre() const {
  Vec3 sum{};
  for (std::size_t i = 0; i < masses_.size(); ++i) sum += masses_[i] * state_.positions[i];
  return (1.0 / mass_kg()) * sum;
}

double SpringBody::kineticEnergy_J() const {
  double sum = 0.0;
  for (std::size_t i = 0; i < masses_.size(); ++i)
    sum += 0.5 * masses_[i] * dot(state_.velocities[i], state_.velocities[i]);
  return sum;
}

double SpringBody::elasticEnergy_J() const {
  double sum = 0.0;
  for (const Spring &s : springs_) {
    const double longer = length(state_.positions[s.b] - state_.positions[s.a]) - s.length_m;
    sum += 0.5 * s.stiffness_N_m * longer * longer;
  }
  return sum;
}

Vec3 SpringBody::reaction(const Support &support) const {
  Vec3 sum{};
  for (const std::uint32_t i : support.nodes) sum -= forces_[i];
  return sum;
}

std::vector<double> SpringBody::stretches() const {
  std::vector<double> out(masses_.size(), 0.0), count(masses_.size(), 0.0);
  for (const Spring &s : springs_) {
    const double stretch = length(state_.positions[s.b] - state_.positions[s.a]) / s.length_m;
    for (const std::uint32_t end : {s.a, s.b}) {
      out[end] += stretch;
      count[end] += 1.0;
    }
  }
  for (std::size_t i = 0; i < out.size(); ++i) out[i] /= count[i];
  return out;
}

std::vector<Vec3> SpringBody::onSkin(const std::vector<Vec3> &ofNodes) const {
  std::vector<Vec3> out;
  out.reserve(bound_.size());
  for (const Bound &b : bound_) out.push_back(b.of(ofNodes));
  return out;
}

}  // namespace mass_spring
