// SPDX-License-Identifier: Apache-2.0
#include "stepping/implicit/stage_solution.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/number_text.h"
#include "pointbased/step_composition.h"
#include "stepping/implicit/island_problem.h"

namespace pointbased::detail {
namespace {

constexpr int kContactRounds = 4;                   // solutions of a stage until no new contacts are found
constexpr int kRoundsOfBodies = 8;                  // same, if the surfaces move as well
constexpr double kConfirmingOfDisplacements = 0.1;  // for steps in which only displacements have to be accurate
constexpr double kLoosestOfDisplacements = 0.3;
constexpr double kLargestTolerance = 0.1;  // spacings: displacements in an impact may be metres
constexpr double kRoughTolerance = 100.0;  // tolerances within which a solution is sufficient to determine the contacts
// change of the contact forces that is accepted, relative to all contact forces
constexpr double kForceTolerance = 1e-2;
// Spacings: largest depth of a contact point of a fast body behind an obstacle at the end of a time stage. Beyond it
// the stage is solved again with a contact that is stiffer by kStiffnessFactor, at most kMaxStiffenings times. A
// decelerated body of height H penetrates by rho H |dv/dt| d/(30 E): 9 mm at 300 m/s in steps of 1/60 s, for 60 mm of
// 50 kPa.
constexpr double kMaxDepth = 0.1, kStiffnessFactor = 30.0;
constexpr int kMaxStiffenings = 2;
// Speed of a fast body, in speeds of pressure waves: an impact rho c v at this speed penetrates about 0.06 spacings.
constexpr double kFastFraction = 0.5;

void addWork(const NewtonResult &solved, NewtonResult &sum) {
  const int iterations = sum.iterations, linear = sum.linearIterations, factorisations = sum.factorisations;
  sum = solved;
  sum.iterations += iterations;
  sum.linearIterations += linear;
  sum.factorisations += factorisations;
}

// Start of the solution of a stage: of the free motion and the other candidates the state of lowest energy. Free motion
// deep into an obstacle is a poor start.
std::vector<Vec3> bestGuess(IncrementalPotential &problem, const std::vector<std::vector<Vec3>> &guesses) {
  std::size_t best = 0;
  double lowest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < guesses.size() && guesses.size() > 1; ++k) {
    const double energy = problem.setState(guesses[k]) ? problem.energy() : std::numeric_limits<double>::infinity();
    if (!(energy < lowest)) continue;
    lowest = energy;
    best = k;
  }
  return guesses[best];
}

// End of a stage with inertia, gravity and damping only: for a falling body the solution.
void predictFreeMotion(const Body &body, const Environment &env, const ImplicitStage &stage, bool isAlone,
                       std::span<Vec3> u) {
  const bool falls = isAlone && !body.held() && pointsInContact(body.contact).empty();
  const Vec3 gained = falls ? Vec3(stage.h * stage.h * env.gravity) : Vec3(Vec3::Zero());
  const double slower = falls ? 1.0 / (1.0 + env.damping * stage.h) : 1.0;
  for (std::size_t i = 0; i < u.size(); ++i) u[i] = stage.p[i] + slower * (stage.h * stage.q[i] + gained);
}

class StageSolution {
 public:
  StageSolution(std::span<const StageMember> members, StageCoupling *coupling, NewtonSolver &solver,
                const StageRequest &request)
      : coupling_(coupling), solver_(solver), request_(request) {
    parts_.reserve(members.size());
    for (const StageMember &member : members) {
      parts_.emplace_back(member, start_.size());
      const std::vector<Vec3> &u = member.body->state().displacements;
      start_.insert(start_.end(), u.begin(), u.end());
    }
    u_ = start_;
    settings_ = newtonSettings(*members.front().body, *members.front().environment, isStatic());
    for (const StageMember &member : members) applySettingsOf(member);
    if (coupling_) {
      coupling_->begin(start_, stage().end, stage().contactSpan, isStatic());
      coupling_->find(start_);
    }
    const bool isAlone = !coupling_ || !coupling_->acts();
    for (Part &part : parts_) {
      if (!isStatic()) predictFreeMotion(*part.body, *part.env, *part.stage, isAlone, of(part, u_));
      // Held phyxels and the phyxels that they carry start at their prescribed positions.
      part.body->placeHeld(part.stage->end, false);
      const std::vector<Vec3> &placed = part.body->state().displacements;
      placed_.insert(placed_.end(), placed.begin(), placed.end());
    }
    applySupports(u_);
    std::vector<StageProblem *> problems;
    for (Part &part : parts_) problems.push_back(&part.problem);
    if (coupling_) island_.emplace(std::move(problems), *coupling_);
  }

  StageResult solve() {
    bool complete = true;
    std::string passes;
    if (touches()) {
      begin();
      complete = solveContacts();
      if (complete) passes = passage();
      for (int n = 0; n < kMaxStiffenings && complete && !passes.empty(); ++n) {
        for (Part &part : parts_) part.problem.penalty().stiffness *= kStiffnessFactor;
        solution_.clear();
        complete = solveContacts();
        // If there is no solution with a stiffer contact, it still passes through.
        if (complete && result_.good()) passes = passage();
      }
      // A solve that was cancelled or left the finite numbers has its own reason.
      if (!complete || result_.outcome == NewtonOutcome::cancelled || result_.outcome == NewtonOutcome::notFinite)
        passes.clear();
      if (!passes.empty()) result_.outcome = NewtonOutcome::iterationLimit;
    } else {
      (void)newton([&](const NewtonResult &) { return isWanted(); });
    }
    // Also for an abandoned stage: another scheme may start where this one ended.
    (void)problem().setState(u_);
    if (StageProblem &first = parts_.front().problem; result_.good() && !coupling_ && first.movesFreely()) {
      const Vec3 left = first.translationToMomentum();
      for (Vec3 &u : u_) u += left;
      (void)first.setState(u_);
    }
    for (Part &part : parts_) {
      ContactState &memory = part.body->contact;
      memory.stageForceSums.begin(part.env->obstacles.size());
      if (!part.touches) continue;
      sumContactForces(pointsOf(part), part.problem.penalty(), of(part, start_), of(part, u_), memory);
      if (complete && result_.good())
        endContactStage(pointsOf(part), part.problem.penalty(), of(part, start_), of(part, u_), memory);
    }
    if (coupling_ && complete && result_.good()) coupling_->finish(u_, request_.weight);
    return {result_, std::move(passes)};
  }

 private:
  // Result of a round of contact.
  enum class Round { again, restart, done, abortedSteps };

  // One body of the stage.
  struct Part {
    Part(const StageMember &member, std::size_t firstPhyxel)
        : body(member.body), env(member.environment), stage(member.stage), first(firstPhyxel),
          problem(*member.body, *member.environment, *member.stage),
          touches(stagesOf(*member.body, *member.environment).contact) {}
    Body *body;
    const Environment *env;
    const ImplicitStage *stage;
    std::size_t first;  // of its phyxels
    StageProblem problem;
    bool touches;  // with obstacles or walls
    ContactForces forces;
  };

  [[nodiscard]] const ImplicitStage &stage() const { return *parts_.front().stage; }
  [[nodiscard]] bool isStatic() const { return !(stage().h > 0.0); }
  [[nodiscard]] IncrementalPotential &problem() {
    return island_ ? static_cast<IncrementalPotential &>(*island_) : parts_.front().problem;
  }
  [[nodiscard]] static std::span<Vec3> of(const Part &part, std::vector<Vec3> &all) {
    return std::span<Vec3>(all).subspan(part.first, part.body->rest().phyxelCount());
  }
  [[nodiscard]] static const ContactPoints &pointsOf(const Part &part) { return part.body->rest().contact; }
  // Pairs may approach each other during the stage.
  [[nodiscard]] bool touches() const {
    return (coupling_ && coupling_->hasPairs()) ||
           std::any_of(parts_.begin(), parts_.end(), [](const Part &part) { return part.touches; });
  }
  [[nodiscard]] bool isWanted() const { return !request_.shouldContinue || request_.shouldContinue(); }
  [[nodiscard]] bool shouldFinish() const { return !request_.shouldFinish || request_.shouldFinish(); }

  // Settings suitable for all members.
  void applySettingsOf(const StageMember &member) {
    const Environment &env = *member.environment;
    const NewtonSettings own = newtonSettings(*member.body, env, isStatic());
    settings_.toleranceDisplacement = std::min(settings_.toleranceDisplacement, own.toleranceDisplacement);
    settings_.strongTolerance = std::min(settings_.strongTolerance, own.strongTolerance);
    const ImplicitStage &of = *member.stage;
    if (isStatic() || !(of.tolerance > 0.0)) return;
    settings_.confirmingTolerance = kConfirmingOfDisplacements;
    settings_.trustRegion = true;
    settings_.loosestTolerance = kLoosestOfDisplacements;
    if (!(env.tolerance > 0.0)) settings_.relativeStepTolerance = of.tolerance;
    settings_.largestTolerance = std::min(settings_.largestTolerance, kLargestTolerance * member.body->rest().spacing);
  }

  // Call from the first contact on: obstacles and skins shorten steps.
  void expectContact() {
    settings_.calibrateFromFirstStep = true;
    settings_.trustRegion = false;
    settings_.loosestTolerance = 0.0;
  }

  void applySupports(std::vector<Vec3> &at) const {
    for (const Part &part : parts_) {
      const std::span<const std::uint8_t> mask = part.body->heldMask();
      for (std::size_t i = 0; i < mask.size(); ++i)
        if (mask[i]) at[part.first + i] = placed_[part.first + i];
    }
  }

  void findContactsOnPath() {
    for (Part &part : parts_) {
      if (!part.touches) continue;
      Body &body = *part.body;
      const ParallelFor &parallelFor = *part.env->parallelFor;
      const double span = part.stage->contactSpan;
      const std::span<const Vec3> from = of(part, start_), to = of(part, u_);
      std::copy(from.begin(), from.end(), body.state().displacements.begin());
      for (std::size_t i = 0; i < to.size(); ++i)
        body.state().velocities[i] = span > 0.0 ? Vec3((to[i] - from[i]) / span) : Vec3(Vec3::Zero());
      findContacts(part.env->obstacles, part.env->box, request_.from, span, kContactMargin * body.rest().spacing,
                   body.contactPositions(parallelFor), body.contactVelocities(parallelFor), pointsOf(part).radii,
                   body.contact, parallelFor);
    }
    if (coupling_) coupling_->find(u_);
  }

  [[nodiscard]] bool newton(const std::function<bool(const NewtonResult &)> &watch) {
    if (restarted_ || (touches() && contactCount() > 0)) expectContact();
    parts_.front().env->clock->measure(kSolve,
                                       [&] { addWork(solver_.solve(problem(), u_, settings_, watch), result_); });
    settings_.toleranceDisplacement = std::max(settings_.toleranceDisplacement, result_.tolerance);
    settings_.relativeStepTolerance = 0.0;
    return result_.good();
  }

  void updateFriction() {
    for (Part &part : parts_)
      if (part.touches)
        updateNormalForces(pointsOf(part), part.problem.penalty(), of(part, start_), of(part, u_), part.body->contact);
    if (coupling_) coupling_->updateNormalForces(u_);
  }
  void recordForces() {
    for (Part &part : parts_)
      if (part.touches)
        part.forces.record(pointsOf(part), part.problem.penalty(), of(part, start_), of(part, u_), part.body->contact);
    if (coupling_) coupling_->record(u_);
  }
  [[nodiscard]] double changeOfForces() {
    double change = coupling_ ? coupling_->changeTo(u_) : 0.0;
    for (Part &part : parts_)
      if (part.touches)
        change = std::max(change, part.forces.changeTo(pointsOf(part), part.problem.penalty(), of(part, start_),
                                                       of(part, u_), part.body->contact));
    return change;
  }

  struct SavedContacts {
    std::vector<std::vector<Contact>> ofParts;
    StageCoupling::Contacts ofPairs;
  };
  [[nodiscard]] SavedContacts saveContacts() const {
    SavedContacts out;
    for (const Part &part : parts_) out.ofParts.push_back(part.body->contact.active);
    if (coupling_) out.ofPairs = coupling_->contacts();
    return out;
  }
  void restoreContacts(const SavedContacts &known) {
    for (std::size_t k = 0; k < parts_.size(); ++k) parts_[k].body->contact.active = known.ofParts[k];
    if (coupling_) coupling_->setContacts(known.ofPairs);
  }
  [[nodiscard]] std::size_t contactCount() const {
    std::size_t count = coupling_ ? coupling_->contactCount() : 0;
    for (const Part &part : parts_) count += part.body->contact.active.size();
    return count;
  }

  void begin() {
    freeMotion_ = u_;
    findContactsOnPath();
    if (isStatic() || contactCount() == 0) return;
    std::vector<std::vector<Vec3>> guesses{u_, start_};
    if (!request_.initialGuess.empty())
      guesses.emplace_back(request_.initialGuess.begin(), request_.initialGuess.end());
    for (std::vector<Vec3> &at : guesses) applySupports(at);
    u_ = bestGuess(problem(), guesses);
  }

  // Whether the approach speed of the body and an obstacle that it touches exceeds a fraction of its slowest waves.
  [[nodiscard]] bool isFast(Part &part) {
    const double span = part.stage->contactSpan;
    if (!(span > 0.0)) return false;
    double slowest = std::numeric_limits<double>::infinity(), travel = 0.0, surface = 0.0;
    for (const Material &m : part.body->constitution().materials)
      slowest = std::min(slowest, std::sqrt(m.waveModulus() / m.restDensity));
    const std::span<const Vec3> from = of(part, start_), to = of(part, freeMotion_);
    for (std::size_t i = 0; i < to.size(); ++i) travel = std::max(travel, (to[i] - from[i]).norm());
    for (const Contact &c : part.body->contact.active) surface = std::max(surface, c.surfaceVelocity.norm());
    return travel / span + surface > kFastFraction * slowest;
  }

  // Description of the obstacle that the solution of a fast body passes through: contact points are behind its surface
  // that were in front of it. Empty: none.
  [[nodiscard]] std::string passage() {
    if (isStatic() || !result_.good()) return {};
    for (Part &part : parts_) {
      if (!part.touches || !isFast(part)) continue;
      double deepest = kMaxDepth * part.body->rest().spacing;
      std::optional<Index> passed;
      for (Contact contact : part.body->contact.active) {
        contact.stiffness = 1.0;  // N/m: the force in N is the depth in m
        const double depth =
            contactForceAt(pointsOf(part), contact, part.problem.penalty(), of(part, start_), of(part, u_)).normal;
        if (!(depth > deepest)) continue;
        deepest = depth;
        passed = contact.obstacle;
      }
      if (passed)
        return "it would pass through " +
               (*passed == Contact::kWall ? std::string("a wall of the world's box")
                                          : "obstacle '" + part.env->obstacles[*passed].name + "'") +
               ", " + number(1e3 * deepest, 3) + " mm deep at the end of the step";
    }
    return {};
  }

  // @return  false: abandoned, because request_.shouldFinish() has returned false
  bool solveContacts() {
    for (int round = 0; round < (coupling_ ? kRoundsOfBodies : kContactRounds); ++round) {
      const Round outcome = solveRound(round);
      if (outcome == Round::done) return true;
      if (outcome == Round::abortedSteps) return false;
      if (outcome != Round::restart) continue;
      // Once more from the free motion, without abandoning.
      restarted_ = true;
      u_ = freeMotion_;
      round = -1;
    }
    return true;
  }

  Round solveRound(int round) {
    // Before the iterations have converged, checks whether friction has changed with the present contact forces, or
    // whether the stage is to be abandoned: further iterations would be wasted.
    bool hasChecked = restarted_ || round > 0, isAbandoned = false;
    const auto checkContacts = [&](const NewtonResult &r) {
      if (!isWanted()) return false;
      if (hasChecked || r.iterations == 0 || r.lastStep > kRoughTolerance * settings_.toleranceDisplacement)
        return true;
      hasChecked = true;
      const SavedContacts before = saveContacts();
      recordForces();
      updateFriction();
      isAbandoned = !shouldFinish() || changeOfForces() > kForceTolerance;
      if (!isAbandoned) restoreContacts(before);
      return !isAbandoned;
    };
    const std::size_t before = contactCount();
    if (!newton(checkContacts) && !isAbandoned) return afterFailure();
    if (!isAbandoned) solution_ = u_;
    result_.outcome = NewtonOutcome::converged;
    // With the contact planes that the solution meets, and friction from its normal forces, the contact forces must
    // agree with those of the solution; otherwise it is solved again with the new ones.
    if (!isAbandoned) recordForces();
    updateFriction();
    findContactsOnPath();
    updateFriction();
    if (!shouldFinish()) return Round::abortedSteps;
    if (isAbandoned) return Round::again;
    double change = changeOfForces();
    if (coupling_ && change <= kForceTolerance && !coupling_->isFoundAtState()) {
      coupling_->find(u_);
      updateFriction();
      change = changeOfForces();
    }
    const bool hasConverged = change <= kForceTolerance || (!coupling_ && round > 0 && contactCount() == before);
    return hasConverged ? Round::done : Round::again;
  }

  Round afterFailure() {
    if (result_.outcome == NewtonOutcome::cancelled || result_.outcome == NewtonOutcome::notFinite) return Round::done;
    if (!solution_.empty()) {
      // Friction remains that of the previous solution.
      u_ = solution_;
      result_.outcome = NewtonOutcome::converged;
      return Round::done;
    }
    return restarted_ || isStatic() ? Round::done : Round::restart;
  }

  std::vector<Part> parts_;
  StageCoupling *coupling_;
  std::optional<IslandProblem> island_;
  NewtonSolver &solver_;
  const StageRequest &request_;
  NewtonSettings settings_;
  std::vector<Vec3> start_, u_, placed_, freeMotion_;
  std::vector<Vec3> solution_;  // the most recent one
  NewtonResult result_;
  bool restarted_ = false;
};

}  // namespace

NewtonSettings newtonSettings(const Body &body, const Environment &env, bool isStatic) {
  NewtonSettings settings;
  settings.toleranceDisplacement = env.tolerance > 0.0 ? env.tolerance : (isStatic ? 1e-6 : 1e-5) * body.rest().spacing;
  settings.preconditioner = env.preconditioner;
  settings.stop = env.stop;
  settings.maxIterations = isStatic ? 60 : 30;
  // Under an obstacle inexact static steps are erratic: a cube under a plate took ten times as long with a tenth.
  settings.strongTolerance = isStatic && env.contact() ? 0.01 : 0.1;
  return settings;
}

std::string failureOf(const NewtonResult &result) {
  switch (result.outcome) {
    case NewtonOutcome::converged: return {};
    case NewtonOutcome::cancelled: return "cancelled";
    default: break;
  }
  const char *what = result.outcome == NewtonOutcome::iterationLimit ? "the equilibrium was not found in time"
                     : result.outcome == NewtonOutcome::notFinite    ? "a quantity is not finite"
                                                                     : "the energy could not be lowered further";
  return std::string(what) + " (residual " + number(result.residual, 4) + " N after " +
         std::to_string(result.iterations) + " iterations, last correction " + number(1000.0 * result.lastStep, 4) +
         " mm)";
}

std::vector<Index> pointsInContact(const ContactState &contact) {
  std::vector<Index> points;
  for (const Contact &c : contact.active)
    if (c.normalForce > 0.0 && (points.empty() || points.back() != c.point)) points.push_back(c.point);
  return points;
}

StageResult solveStage(std::span<const StageMember> members, StageCoupling *coupling, NewtonSolver &solver,
                       const StageRequest &request) {
  return StageSolution(members, coupling, solver, request).solve();
}

StageResult solveStage(Body &body, NewtonSolver &solver, const Environment &env, const ImplicitStage &stage,
                       const StageRequest &request) {
  const StageMember alone{&body, &env, &stage};
  return solveStage(std::span<const StageMember>(&alone, 1), nullptr, solver, request);
}

bool findContactsAlong(Body &body, const Environment &env, std::span<const Vec3> start, double time, double dt) {
  State &state = body.state();
  const std::vector<Vec3> u = state.displacements, v = state.velocities;
  for (std::size_t i = 0; i < u.size(); ++i) {
    state.velocities[i] = (u[i] - start[i]) / dt;
    state.displacements[i] = start[i];
  }
  const std::span<const Vec3> velocities = body.contactVelocities(*env.parallelFor);
  findContacts(env.obstacles, env.box, time, dt, kContactMargin * body.rest().spacing,
               body.contactPositions(*env.parallelFor), velocities, body.rest().contact.radii, body.contact,
               *env.parallelFor);
  state.displacements = u;
  state.velocities = v;
  return std::any_of(body.contact.active.begin(), body.contact.active.end(), [&](const Contact &c) {
    return c.gap + dt * (velocities[c.point] - c.surfaceVelocity).dot(c.normal) < 0.0;
  });
}

}  // namespace pointbased::detail
