// SPDX-License-Identifier: Apache-2.0
// Serialises the state of a simulation.
#include <cstring>
#include <stdexcept>

#include "stepping/simulation/simulator_checkpoint.h"

namespace pointbased {
namespace {

constexpr std::uint64_t kFormat = 4, kFormatWithoutGrabs = 3;

/// Appends its arguments; the reader below reads the same in the same order.
class StateWriter {
 public:
  static constexpr bool kReads = false;
  template <class T>
  void numbers(T *values, std::size_t n) {
    bytes_.append(reinterpret_cast<const char *>(values), n * sizeof(T));
  }
  std::size_t size(std::size_t n) {
    auto size = static_cast<std::uint64_t>(n);
    numbers(&size, 1);
    return n;
  }
  void text(std::string &value) {
    size(value.size());
    bytes_ += value;
  }
  [[nodiscard]] std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

class StateReader {
 public:
  static constexpr bool kReads = true;
  explicit StateReader(std::string_view bytes) : left_(bytes) {}
  template <class T>
  void numbers(T *values, std::size_t n) {
    if (n > left_.size() / sizeof(T)) throw std::runtime_error("the state ends too early");
    if (n > 0) std::memcpy(values, left_.data(), n * sizeof(T));
    left_.remove_prefix(n * sizeof(T));
  }
  std::size_t size(std::size_t) {
    std::uint64_t size = 0;
    numbers(&size, 1);
    // Every element has at least one byte: a damaged size is not allocated.
    if (size > left_.size()) throw std::runtime_error("the state ends too early");
    return static_cast<std::size_t>(size);
  }
  void text(std::string &value) {
    value.resize(size(0));
    numbers(value.data(), value.size());
  }
  void expectEnd() const {
    if (!left_.empty()) throw std::runtime_error("bytes stand behind the end of the state");
  }

 private:
  std::string_view left_;
};

/// Serialises numbers member by member: padding is not part of the state.
template <class Coder>
class Archive {
 public:
  explicit Archive(Coder &coder) : coder_(coder) {}

  template <class T>
  void operator()(T &value) {
    if constexpr (std::is_same_v<T, bool>) {
      std::uint8_t byte = value ? 1 : 0;
      coder_.numbers(&byte, 1);
      value = byte != 0;
    } else if constexpr (std::is_arithmetic_v<T>) {
      coder_.numbers(&value, 1);
    } else {
      walk(value);
    }
  }
  template <class T>
  void operator()(std::vector<T> &values) {
    const std::size_t n = coder_.size(values.size());
    if constexpr (Coder::kReads) values.resize(n);
    for (T &value : values) (*this)(value);
  }
  template <class Scalar, int kRows, int kColumns>
  void operator()(Eigen::Matrix<Scalar, kRows, kColumns> &matrix) {
    coder_.numbers(matrix.data(), static_cast<std::size_t>(matrix.size()));
  }
  void operator()(std::string &text) { coder_.text(text); }
  template <class T>
  void operator()(std::optional<T> &value) {
    bool has = value.has_value();
    (*this)(has);
    if constexpr (Coder::kReads) value = has ? std::optional<T>(T()) : std::nullopt;
    if (value) (*this)(*value);
  }

 private:
  void walk(RigidMotion &motion) {
    (*this)(motion.rotation);
    (*this)(motion.centre);
    (*this)(motion.displacement);
  }
  void walk(detail::Guidance &guidance) {
    (*this)(guidance.from);
    (*this)(guidance.to);
    (*this)(guidance.begin);
    (*this)(guidance.duration);
  }
  void walk(ActiveGrab &active) {
    (*this)(active.id);
    (*this)(active.grab.phyxels);
    (*this)(active.grab.weights);
    (*this)(active.grab.target);
    (*this)(active.grab.arms);
    (*this)(active.grab.rotation);
    (*this)(active.grab.frequency);
    (*this)(active.grab.dampingRatio);
    (*this)(active.grab.maxForce);
    (*this)(active.status.point);
    (*this)(active.status.force);
    (*this)(active.status.torque);
    (*this)(active.status.mass);
  }
  void walk(GuardFinding &finding) {
    (*this)(finding.phyxel);
    (*this)(finding.quantity);
    (*this)(finding.help);
  }
  void walk(PronyPoint &point) {
    (*this)(point.previous);
    for (Mat3 &term : point.internal) (*this)(term);
  }
  void walk(HourglassHistory &modes) {
    (*this)(modes.previous);
    for (HourglassStrain &term : modes.relaxed) (*this)(term);
  }
  void walk(Contact &c) {
    (*this)(c.point);
    (*this)(c.normal);
    (*this)(c.gap);
    (*this)(c.surfaceVelocity);
    (*this)(c.friction);
    (*this)(c.restitution);
    (*this)(c.obstacle);
    (*this)(c.normalImpulse);
    (*this)(c.frictionImpulse);
    (*this)(c.projectionImpulse);
    (*this)(c.projectionFriction);
    (*this)(c.normalForce);
    (*this)(c.initialPenetration);
    (*this)(c.tangentialDisplacement);
  }
  void walk(ContactState::LastOutside &last) {
    (*this)(last.position);
    (*this)(last.isKnown);
  }
  void walk(ContactState::ClearanceCache &known) {
    (*this)(known.at);
    (*this)(known.distance);
    (*this)(known.reach);
    (*this)(known.normal);
    (*this)(known.swept);
    (*this)(known.ahead);
    (*this)(known.aheadNormal);
    (*this)(known.aheadOffset);
  }
  void walk(detail::SubstepController &substeps) { substeps.walk(*this); }
  void walk(detail::SleepDetector &watch) { watch.walk(*this); }

  Coder &coder_;
};

struct SavedBody {
  detail::BodyStepper::Checkpoint checkpoint;
  detail::BodyStepper::SleepState sleepState;
  Body::IntegratorState integratorCarry;
  std::vector<Vec3> patchForces;  // N, of supports
  std::vector<ActiveGrab> grabs;
  std::vector<Vec3> externalForces;  // N
};

/// Of the obstacles, in their order.
struct SavedObstacle {
  bool isInstrument = false;
  std::optional<detail::Guidance> guidance;
};

/// Cached clearances are included: queried again at another position, the plane of a contact would differ in its last
/// digits.
template <class Coder>
void walk(Archive<Coder> &archive, SavedBody &saved, bool hasGrabs) {
  State &state = saved.checkpoint.body.state;
  archive(state.displacements);
  archive(state.velocities);
  archive(state.history.plasticInverse);
  archive(state.history.plasticBefore);
  archive(state.history.prony);
  archive(state.history.modes);
  ContactState &contact = saved.checkpoint.body.contact;
  archive(contact.active);
  archive(contact.lastOutside);
  archive(contact.clearance);
  archive(contact.deepest);
  archive(contact.margin);
  archive(contact.depenetrationMoment);
  archive(contact.solution.splitImpulse);
  archive(saved.checkpoint.body.referenceShiftMoment);
  archive(saved.checkpoint.substeps);
  archive(saved.checkpoint.scale);
  archive(saved.checkpoint.goodSteps);
  archive(saved.patchForces);
  archive(saved.integratorCarry.forces);
  archive(saved.integratorCarry.tangentRatio);
  archive(saved.integratorCarry.forcesCurrent);
  archive(saved.sleepState.watch);
  archive(saved.sleepState.asleep);
  if (!hasGrabs) return;
  archive(saved.grabs);
  archive(saved.externalForces);
  archive(saved.checkpoint.body.stopped);
}

/// Why the state of a body cannot be saved; empty: it can.
std::string saveError(const Body &body) {
  if (body.isStatic() || body.rereferenceCount() == 0) return {};
  return "body '" + body.name() +
         "' has flowed so far that its reference is a later shape; states are kept of the first one";
}

bool isMotion(const RigidMotion &motion) {
  constexpr double kTolerance = 1e-5;
  return motion.rotation.allFinite() && motion.centre.allFinite() && motion.displacement.allFinite() &&
         (motion.rotation.transpose() * motion.rotation - Mat3::Identity()).norm() < kTolerance;
}

bool isGuidance(const detail::Guidance &guidance) {
  return isMotion(guidance.from) && isMotion(guidance.to) && std::isfinite(guidance.begin) &&
         std::isfinite(guidance.duration) && guidance.duration >= 0.0;
}

bool fits(const ActiveGrab &active, std::size_t phyxels) {
  const Grab &grab = active.grab;
  return !grab.phyxels.empty() && grab.weights.size() == grab.phyxels.size() &&
         (grab.arms.empty() || grab.arms.size() == grab.phyxels.size()) && grab.target.allFinite() &&
         grab.rotation.allFinite() && grab.frequency >= 0.0 && grab.dampingRatio >= 0.0 && grab.maxForce >= 0.0 &&
         std::all_of(grab.phyxels.begin(), grab.phyxels.end(), [phyxels](Index i) { return i < phyxels; }) &&
         std::all_of(grab.weights.begin(), grab.weights.end(), [](double w) { return std::isfinite(w); }) &&
         std::all_of(grab.arms.begin(), grab.arms.end(), [](const Vec3 &arm) { return arm.allFinite(); });
}

/// @param obstacles  with which the body can have contacts
bool fits(const SavedBody &saved, const Body &body, std::size_t obstacles) {
  const State &state = saved.checkpoint.body.state;
  PointHistory initial;
  initial.reset(body.constitution(), body.rest().pointCount(), body.rest().stencils.isLattice());
  const std::size_t n = body.rest().phyxelCount();
  const auto allFinite = [](const auto &values) {
    return std::all_of(values.begin(), values.end(), [](const auto &v) { return v.allFinite(); });
  };
  const ContactState &contact = saved.checkpoint.body.contact;
  const std::size_t points = body.rest().contact.count();
  return state.displacements.size() == n && state.velocities.size() == n &&
         saved.patchForces.size() == body.patches().forces().size() && allFinite(saved.patchForces) &&
         (saved.externalForces.empty() || saved.externalForces.size() == n) && allFinite(saved.externalForces) &&
         saved.integratorCarry.forces.size() == n && allFinite(saved.integratorCarry.forces) &&
         allFinite(state.displacements) && allFinite(state.velocities) && allFinite(state.history.plasticInverse) &&
         state.history.plasticInverse.size() == initial.plasticInverse.size() && state.history.plasticBefore.empty() &&
         state.history.prony.size() == initial.prony.size() && state.history.modes.size() == initial.modes.size() &&
         std::all_of(contact.active.begin(), contact.active.end(),
                     [&](const Contact &c) {
                       return c.point < points && (c.obstacle == Contact::kWall || c.obstacle < obstacles);
                     }) &&
         std::all_of(contact.clearance.begin(), contact.clearance.end(),
                     [&](const auto &known) { return known.empty() || known.size() == points; }) &&
         std::all_of(contact.lastOutside.begin(), contact.lastOutside.end(),
                     [&](const auto &last) { return last.empty() || last.size() == points; }) &&
         std::all_of(saved.grabs.begin(), saved.grabs.end(), [n](const ActiveGrab &grab) { return fits(grab, n); });
}

std::vector<SavedObstacle> savedObstacles(const detail::ObstacleSet &obstacles) {
  std::vector<SavedObstacle> saved;
  for (const std::size_t id : obstacles.ids) {
    SavedObstacle &one = saved.emplace_back();
    one.isInstrument = obstacles.instruments.contains(id);
    if (const auto found = obstacles.guidances.find(id); found != obstacles.guidances.end())
      one.guidance = found->second;
  }
  return saved;
}

template <class Coder>
void walk(Archive<Coder> &archive, std::vector<SavedObstacle> &saved) {
  std::uint64_t count = saved.size();
  archive(count);
  for (std::uint64_t o = 0; o < count; ++o) {
    // A damaged number ends at the end of the bytes.
    if constexpr (Coder::kReads) saved.emplace_back();
    archive(saved[o].isInstrument);
    archive(saved[o].guidance);
  }
}

/// Throws std::runtime_error.
void expectFit(const std::vector<SavedObstacle> &saved, std::size_t obstacles, std::size_t instruments) {
  const auto isInstrument = [](const SavedObstacle &one) { return one.isInstrument; };
  const auto count = static_cast<std::size_t>(std::count_if(saved.begin(), saved.end(), isInstrument));
  if (count != instruments || saved.size() != obstacles + instruments)
    throw std::runtime_error("the state has another number of obstacles or instruments");
  for (const SavedObstacle &one : saved)
    if (one.guidance && !isGuidance(*one.guidance))
      throw std::runtime_error("the state has a motion of an obstacle that is not possible");
}

/// Adds the instruments where they were among the obstacles. @return their ids
std::vector<std::size_t> restoreObstacles(detail::SimulationState &state, const std::vector<SavedObstacle> &saved,
                                          std::vector<Obstacle> instruments) {
  std::vector<std::size_t> ids;
  detail::ObstacleSet &obstacles = state.obstacles;
  for (std::size_t o = 0; o < saved.size(); ++o) {
    if (!saved[o].isInstrument) continue;
    const auto at = static_cast<std::ptrdiff_t>(o);
    obstacles.all.insert(obstacles.all.begin() + at, std::move(instruments[ids.size()]));
    obstacles.ids.insert(obstacles.ids.begin() + at, state.nextId);
    obstacles.instruments.insert(state.nextId);
    ids.push_back(state.nextId++);
  }
  state.updateSurroundings();
  for (std::size_t o = 0; o < saved.size(); ++o)
    if (saved[o].guidance) state.guide(obstacles.ids[o], *saved[o].guidance);
  return ids;
}

}  // namespace

Result<std::string> StateArchive::save() {
  StateWriter writer;
  Archive archive(writer);
  std::uint64_t format = kFormat, bodies = state_.bodies.size(), steps = state_.progress.steps;
  double time = state_.progress.time, loadFactor = state_.progress.loadFactor;
  archive(format);
  archive(bodies);
  archive(steps);
  archive(time);
  archive(loadFactor);
  for (const auto &[id, stepper] : state_.bodies)
    if (const std::string why = saveError(stepper->body()); !why.empty()) return tl::unexpected(why);
  std::vector<SavedObstacle> obstacles = savedObstacles(state_.obstacles);
  walk(archive, obstacles);
  state_.skins.clear();
  for (const auto &island : state_.islands.list) island->resetSolver();
  for (const auto &[id, stepper] : state_.bodies) {
    stepper->resetSolvers();
    const std::span<const Vec3> patchForces = std::as_const(stepper->body()).patches().forces();
    const std::span<const Vec3> externalForces = stepper->body().externalForces();
    SavedBody saved{stepper->checkpoint(),
                    stepper->sleepState(),
                    stepper->body().integratorCarry(),
                    {patchForces.begin(), patchForces.end()},
                    stepper->body().grabs,
                    {externalForces.begin(), externalForces.end()}};
    walk(archive, saved, true);
  }
  for (const auto &[id, layer] : state_.attachments) {
    std::vector<std::uint8_t> torn = layer->torn();
    archive(torn);
  }
  return writer.take();
}

Result<std::vector<std::size_t>> StateArchive::load(std::string_view bytes, std::vector<Obstacle> instruments) {
  detail::SimulatorCheckpoint checkpoint;
  std::vector<SavedObstacle> obstacles;
  const std::size_t others = state_.obstacles.all.size() - state_.obstacles.instruments.size();
  std::map<std::size_t, SavedBody> saved;
  try {
    StateReader reader(bytes);
    Archive archive(reader);
    std::uint64_t format = 0, bodies = 0;
    archive(format);
    if (format != kFormat && format != kFormatWithoutGrabs)
      throw std::runtime_error("the state is of format " + std::to_string(format));
    archive(bodies);
    archive(checkpoint.progress.steps);
    archive(checkpoint.progress.time);
    archive(checkpoint.progress.loadFactor);
    if (bodies != state_.bodies.size() || !std::isfinite(checkpoint.progress.time) || checkpoint.progress.time < 0.0 ||
        !(checkpoint.progress.loadFactor >= 0.0 && checkpoint.progress.loadFactor <= 1.0))
      throw std::runtime_error("the state's time or number of bodies is not possible");
    if (format == kFormat) walk(archive, obstacles);
    if (format == kFormatWithoutGrabs) obstacles.resize(others);
    expectFit(obstacles, others, instruments.size());
    for (const auto &[id, stepper] : state_.bodies) {
      SavedBody &one = saved[id];
      walk(archive, one, format == kFormat);
      if (!fits(one, stepper->body(), state_.ownObstacleCount(id) + obstacles.size()))
        throw std::runtime_error("the state of body '" + stepper->body().name() + "' is not one that it can have");
    }
    for (const auto &[id, layer] : state_.attachments) {
      std::vector<std::uint8_t> &torn = checkpoint.torn[id];
      archive(torn);
      const std::vector<std::uint8_t> before = layer->torn();
      if (!layer->setTorn(torn))
        throw std::runtime_error("the state of attachment '" + layer->settings().name +
                                 "' is not one that it can have");
      (void)layer->setTorn(before);
    }
    reader.expectEnd();
  } catch (const std::runtime_error &error) {
    return tl::unexpected(std::string(error.what()));
  }
  state_.reset();
  std::vector<std::size_t> ids = restoreObstacles(state_, obstacles, std::move(instruments));
  for (auto &[id, stepper] : state_.bodies) {
    SavedBody &one = saved.at(id);
    const BodyCheckpoint fresh = stepper->body().checkpoint();
    one.checkpoint.body.rest = fresh.rest;
    one.checkpoint.body.rigid = fresh.rigid;
    one.checkpoint.body.free = fresh.free;
    if (checkpoint.progress.steps > 0)
      one.checkpoint.body.state.supportTime =
          state_.quasiStatic() ? checkpoint.progress.loadFactor : checkpoint.progress.time;
    (void)stepper->restore(one.checkpoint, state_.parallelFor);
    stepper->body().grabs = std::move(one.grabs);
    stepper->setSleepState(std::move(one.sleepState));
    std::copy(one.patchForces.begin(), one.patchForces.end(), stepper->body().patches().forces().begin());
    // Before the forces, which contain them.
    stepper->body().swapExternalForces(one.externalForces);
    stepper->body().restoreIntegratorState(std::move(one.integratorCarry));
  }
  for (auto &[id, torn] : checkpoint.torn) (void)state_.attachments.at(id)->setTorn(std::move(torn));
  state_.progress = checkpoint.progress;
  return ids;
}

}  // namespace pointbased
