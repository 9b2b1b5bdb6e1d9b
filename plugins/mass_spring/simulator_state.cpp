// SPDX-License-Identifier: Apache-2.0
// What a state is, as a hash and as bytes.
#include <cmath>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include "c3de/abi/iface/parameter_ids.h"
#include "c3de/sdk/structs.hpp"
#include "simulator.h"

namespace mass_spring {
namespace {

using sdk::Error;

constexpr std::uint32_t kStateVersion = 1;

/// FNV-1a.
class Hash {
 public:
  void add(const void *bytes, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i)
      value_ = (value_ ^ static_cast<const unsigned char *>(bytes)[i]) * 0x100000001b3ull;
  }
  template <class T>
  void add(const T &number) {
    static_assert(std::is_arithmetic_v<T>);
    add(&number, sizeof number);
  }
  void add(const Vec3 &v) { add(v.data(), sizeof v); }
  void add(const std::string &text) {
    add(text.size());
    add(text.data(), text.size());
  }
  template <class T>
  void add(const std::vector<T> &values) {
    add(values.size());
    for (const T &value : values) add(value);
  }
  [[nodiscard]] std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325ull;
};

/// Numbers as they lie in memory.
template <class T>
void append(std::string &bytes, const T *values, std::size_t n) {
  static_assert(std::is_trivially_copyable_v<T>);
  bytes.append(reinterpret_cast<const char *>(values), n * sizeof(T));
}

class Reader {
 public:
  Reader(const void *bytes, std::uint64_t n) : at_(static_cast<const unsigned char *>(bytes)), left_(n) {}
  template <class T>
  T number() {
    T out{};
    take(&out, 1);
    return out;
  }
  template <class T>
  void take(T *out, std::size_t n) {
    if (n > left_ / sizeof(T)) throw Error(C3DE_E_FORMAT, "the state ends too early");
    std::memcpy(out, at_, n * sizeof(T));
    at_ += n * sizeof(T);
    left_ -= n * sizeof(T);
  }
  [[nodiscard]] std::uint64_t left() const { return left_; }

 private:
  const unsigned char *at_;
  std::uint64_t left_;
};

}  // namespace

/// What a state belongs to: everything that a scene says of the physics.
std::uint64_t Simulator::fingerprint() const {
  Hash hash;
  for (const c3de_param_decl &d : context_.method.world) {
    const c3de_param_value v = world_.value(sdk::text(d.id));
    hash.add(v.type);
    hash.add(v.num);
    hash.add(vectorOf(v.vec));
    if (d.type == C3DE_PARAM_CHOICE) hash.add(std::string(sdk::text(v.text)));
  }
  const auto isDeclared = [this](std::string_view id) {
    return std::any_of(context_.method.body.begin(), context_.method.body.end(),
                       [&](const c3de_param_decl &d) { return sdk::text(d.id) == id; });
  };
  for (const auto &[id, body] : bodies_) {
    const PointBody &p = *body.physics;
    hash.add(body.name);
    hash.add(p.points());
    hash.add(p.masses());
    hash.add(p.held());
    for (const Elasticity &m : p.materials()) {
      hash.add(m.youngsModulus_Pa);
      hash.add(m.density_kg_m3);
      hash.add(m.retardationTime_s);
      if (isDeclared(C3DE_PARAM_ID_POISSON_RATIO)) hash.add(m.poissonRatio);
    }
    for (const c3de_param_decl &d : context_.method.body)
      if (d.type == C3DE_PARAM_CHOICE) hash.add(std::string(body.values.text(sdk::text(d.id))));
    for (const Support &s : p.supports()) {
      hash.add(s.nodes);
      const Motion motion = s.motion.value_or(Motion{});
      for (const Vec3 &v : {motion.displacement_m, motion.rotation_rad, motion.centre_m}) hash.add(v);
      hash.add(motion.ramp_s);
    }
    for (const SurfaceLoad &load : p.loads) {
      hash.add(load.triangles);
      hash.add(load.force_N);
      hash.add(load.pressure_Pa);
      hash.add(load.isDead);
      hash.add(load.ramp_s);
    }
  }
  return hash.value();
}

void Simulator::stateHash(std::uint64_t *out) {
  const std::lock_guard lock(mutex_);
  Hash hash;
  hash.add(fingerprint());
  hash.add(steps_);
  hash.add(time_s_);
  for (const auto &[id, body] : bodies_) {
    hash.add(body.physics->state().positions);
    hash.add(body.physics->state().velocities);
    for (const auto &[number, load] : body.liveLoads) {
      hash.add(load.triangles);
      hash.add(load.force_N);
      hash.add(load.pressure_Pa);
      hash.add(load.began_s);
    }
    for (const auto &[number, hold] : body.physics->holds) {
      hash.add(hold.nodes);
      hash.add(hold.target_m);
      hash.add(hold.offset_m);
    }
  }
  sdk::notNull(out, "out") = hash.value();
}

c3de_status Simulator::saveState(c3de_sink sink) {
  const std::lock_guard lock(mutex_);
  std::string bytes;
  const std::uint64_t of = fingerprint(), count = bodies_.size();
  append(bytes, &kStateVersion, 1);
  append(bytes, &of, 1);
  append(bytes, &steps_, 1);
  append(bytes, &time_s_, 1);
  append(bytes, &count, 1);
  for (const auto &[id, body] : bodies_) {
    if (!body.physics->holds.empty())
      throw Error(C3DE_E_STATE, "somebody holds body '" + body.name + "'; let go of it first");
    if (!body.liveLoads.empty())
      throw Error(C3DE_E_STATE, "a load that came while it ran acts on body '" + body.name + "'; remove it first");
    const PointBody::State &state = body.physics->state();
    const std::uint64_t n = state.positions.size();
    append(bytes, &n, 1);
    append(bytes, state.positions.data(), n);
    append(bytes, state.velocities.data(), n);
  }
  return sdk::put(sink, bytes);
}

void Simulator::loadState(const void *bytes, std::uint64_t n) {
  if (bytes == nullptr && n > 0) throw Error(C3DE_E_ARG, "bytes is null");
  const std::lock_guard lock(mutex_);
  Reader in(bytes, n);
  if (const auto version = in.number<std::uint32_t>(); version != kStateVersion)
    throw Error(C3DE_E_VERSION, "the state is of version " + std::to_string(version) +
                                    " of this simulator's format; accepted: " + std::to_string(kStateVersion));
  if (in.number<std::uint64_t>() != fingerprint())
    throw Error(C3DE_E_ARG, "the state belongs to another scene: bodies, materials, supports, loads or world differ");
  const auto steps = in.number<std::uint64_t>();
  const auto time_s = in.number<double>();
  if (!std::isfinite(time_s) || time_s < 0.0 || in.number<std::uint64_t>() != bodies_.size())
    throw Error(C3DE_E_FORMAT, "the state's time or number of bodies is not possible");
  std::vector<PointBody::State> states;
  for (const auto &[id, body] : bodies_) {
    const std::size_t count = body.physics->masses().size();
    if (in.number<std::uint64_t>() != count)
      throw Error(C3DE_E_FORMAT, "the state has another number of masses for body '" + body.name + "'");
    PointBody::State state{std::vector<Vec3>(count), std::vector<Vec3>(count)};
    in.take(state.positions.data(), count);
    in.take(state.velocities.data(), count);
    for (std::size_t i = 0; i < count; ++i)
      if (!isFinite(state.positions[i]) || !isFinite(state.velocities[i]))
        throw Error(C3DE_E_FORMAT, "the state of body '" + body.name + "' is not finite");
    states.push_back(std::move(state));
  }
  if (in.left() != 0)
    throw Error(C3DE_E_FORMAT, std::to_string(in.left()) + " bytes stand behind the end of the state");
  resetAll();
  std::size_t i = 0;
  for (auto &[id, body] : bodies_) body.physics->setState(std::move(states[i++]));
  steps_ = steps;
  time_s_ = time_s;
}

}  // namespace mass_spring
