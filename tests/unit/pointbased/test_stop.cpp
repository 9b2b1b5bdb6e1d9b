// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <atomic>
#include <cstring>

#include "c3de/core/platform.h"
#include "contact_cases.h"
#include "shapes.h"
#include "support/catch.h"

using namespace pointbased;
using namespace shapes;

namespace {

/// Raised at the given check.
class AtLook final : public StopRequest {
 public:
  explicit AtLook(int look) : left_(look) {}
  [[nodiscard]] bool isRaised() const noexcept override { return left_.fetch_sub(1) <= 0; }
  [[nodiscard]] bool wasAsked() const { return left_ < 0; }

 private:
  mutable std::atomic<int> left_;
};

/// Never raised; measures the longest time without a check, in processor time: the machine may be busy with other work.
class Listening final : public StopRequest {
 public:
  [[nodiscard]] bool isRaised() const noexcept override {
    const double now = c3de::processorTime_s();
    longest_ = std::max(longest_, now - last_);
    last_ = now;
    return false;
  }
  [[nodiscard]] double longest_s() const {
    (void)isRaised();
    return longest_;
  }

 private:
  mutable double last_ = c3de::processorTime_s(), longest_ = 0.0;
};

/// A box that falls on the ground next to another that moves by its velocity.
std::unique_ptr<Simulator> twoBoxes(Integrator integrator, const Material &material = rubber(2e4, 20.0)) {
  auto simulator = std::make_unique<Simulator>();
  simulator->setWorld({.gravity = Vec3(0.0, -9.81, 0.0),
                       .integrator = integrator,
                       .dt = integrator == Integrator::quasiStatic ? 0.0 : 1.0 / 120.0,
                       .sleep = false});
  simulator->addObstacle(halfSpace(Vec3(0.0, 0.0, 0.0), Vec3(0.0, 1.0, 0.0), 0.3));
  for (const double x : {0.0, 0.3}) {
    auto body = latticeBox(Vec3(x, 0.001, 0.0), Vec3(x + 0.1, 0.101, 0.1), 0.025, material);
    body->setInitialVelocity(Vec3(0.1, -0.3, 0.0), Vec3(0.0, 0.0, 2.0));
    simulator->addBody(std::move(body));
  }
  return simulator;
}

template <class T>
bool sameBits(const std::vector<T> &a, const std::vector<T> &b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

bool sameBits(const PointHistory &a, const PointHistory &b) {
  return sameBits(a.plasticInverse, b.plasticInverse) && sameBits(a.plasticBefore, b.plasticBefore) &&
         sameBits(a.prony, b.prony) && sameBits(a.modes, b.modes);
}

}  // namespace

TEST_CASE("a step that is ended half way leaves the state before it, wherever it is ended") {
  for (const Integrator integrator :
       {Integrator::explicitVerlet, Integrator::implicitSdirk, Integrator::backwardEuler, Integrator::quasiStatic}) {
    INFO("integrator " << static_cast<int>(integrator));
    const auto simulator = twoBoxes(integrator);
    for (int k = 0; k < 4; ++k) REQUIRE(simulator->step());
    const std::uint64_t before = simulator->stateHash(), steps = simulator->steps();
    const double time = simulator->time(), load = simulator->loadFactor();
    int ended = 0;
    for (int look = 0;; look = 2 * look + 1) {
      const AtLook stop(look);
      const auto stepped = simulator->step(&stop);
      if (stepped) break;
      ++ended;
      CHECK(stepped.error().ended);
      CHECK(simulator->stateHash() == before);
      CHECK(simulator->steps() == steps);
      CHECK(simulator->time() == time);
      CHECK(simulator->loadFactor() == load);
      CHECK(simulator->stepper().stoppedBodies() == 0);
      CHECK(simulator->diagnostics().activity().empty());
    }
    CHECK(ended >= 5);  // at the beginning, at the end and between
    CHECK(simulator->stateHash() != before);
    CHECK(simulator->steps() == steps + 1);
  }
}

TEST_CASE("a step that is ended half way leaves what the material remembers") {
  Material material = rubber(2e4);
  material.plastic.yield = 0.01;
  material.plastic.creep = 0.5;
  material.prony = {{{0.3, 0.05}, {0.2, 0.5}}};
  // Statics would flow without end under its own weight.
  for (const Integrator integrator :
       {Integrator::explicitVerlet, Integrator::implicitSdirk, Integrator::backwardEuler}) {
    INFO("integrator " << static_cast<int>(integrator));
    const auto simulator = twoBoxes(integrator, material);
    for (int k = 0; k < 4; ++k) REQUIRE(simulator->step());
    std::vector<PointHistory> before;
    for (const std::size_t id : simulator->bodyIds()) before.push_back(simulator->body(id)->state().history);
    REQUIRE(before.front().plasticInverse.size() == before.front().prony.size());
    REQUIRE(std::any_of(before.front().plasticInverse.begin(), before.front().plasticInverse.end(),
                        [](const Mat3 &inverse) { return inverse != Mat3::Identity(); }));
    int ended = 0;
    for (int look = 0;; look = 2 * look + 1) {
      const AtLook stop(look);
      if (simulator->step(&stop)) break;
      ++ended;
      std::size_t body = 0;
      for (const std::size_t id : simulator->bodyIds())
        CHECK(sameBits(simulator->body(id)->state().history, before[body++]));
    }
    CHECK(ended >= 5);
    CHECK_FALSE(sameBits(simulator->body(simulator->bodyIds().front())->state().history, before.front()));
  }
}

TEST_CASE("explicit steps go on with the same bits after one was ended half way") {
  // Viscous forces at the beginning of a step use other velocities: there the bits differ.
  const auto elastic = [] {
    auto simulator = std::make_unique<Simulator>();
    simulator->setWorld({.gravity = Vec3(0.0, -9.81, 0.0), .integrator = Integrator::explicitVerlet});
    auto body = latticeBox(Vec3::Zero(), Vec3::Constant(0.1), 0.025, rubber(2e4));
    body->setInitialVelocity(Vec3(0.1, -0.3, 0.0), Vec3(0.0, 0.0, 9.0));
    simulator->addBody(std::move(body));
    return simulator;
  };
  const auto whole = elastic(), ended = elastic();
  for (int k = 0; k < 20; ++k) {
    const AtLook stop(3 * k);
    if (const auto stepped = ended->step(&stop); !stepped) REQUIRE(ended->step());
    REQUIRE(whole->step());
    REQUIRE(whole->stateHash() == ended->stateHash());
  }
}

TEST_CASE("reset after a step that was ended leads to the initial state, and a run from there has its bits") {
  const auto simulator = twoBoxes(Integrator::implicitSdirk);
  const std::uint64_t initial = simulator->stateHash();
  for (int k = 0; k < 3; ++k) REQUIRE(simulator->step());
  const std::uint64_t reached = simulator->stateHash();
  const AtLook stop(40);
  CHECK_FALSE(simulator->step(&stop));
  simulator->reset();
  CHECK(simulator->stateHash() == initial);
  CHECK(simulator->time() == 0.0);
  for (int k = 0; k < 3; ++k) REQUIRE(simulator->step());
  CHECK(simulator->stateHash() == reached);
}

TEST_CASE("a heavy implicit step looks at its request several times a second, within factorisations as well") {
  // Some 9 000 phyxels: the complete factorisation has fronts of hundreds of columns.
  Simulator simulator;
  simulator.setWorld({.gravity = Vec3(0.0, -9.81, 0.0),
                      .integrator = Integrator::backwardEuler,
                      .preconditioner = Preconditioner::factorised});
  Material stiff = rubber(1e6);
  stiff.poissonRatio = 0.49;
  auto body = latticeBox(Vec3::Zero(), Vec3::Constant(0.2), 0.01, stiff);
  body->setInitialVelocity(Vec3::Zero(), Vec3(0.0, 6.0, 3.0));
  simulator.addBody(std::move(body));
  const Listening stop;
  REQUIRE(simulator.step(&stop));
  CHECK(stop.longest_s() < 0.6);
}

TEST_CASE("what is built from stoppable loops ends with Stopped, and loops go on when nobody watches") {
  StoppableLoops loops(serialFor());
  const AtLook stop(2);
  std::size_t done = 0;
  const auto count = [&](std::size_t begin, std::size_t end) { done += end - begin; };
  {
    const StoppableLoops::Watch watch(loops, &stop);
    loops.parallelFor()(10, 1, count);
    CHECK_THROWS_AS(loops.parallelFor()(10, 1, count), Stopped);
    CHECK(done == 10);
  }
  loops.parallelFor()(10, 1, count);
  CHECK(done == 20);

  const BodyShape shape = box(Vec3::Zero(), Vec3::Constant(0.1));
  const BodyRecipe recipe{.sampling = {.spacing = 0.01}};
  for (int look = 0; look < 8; look = 2 * look + 1) {
    const AtLook early(look);
    const StoppableLoops::Watch watch(loops, &early);
    CHECK_THROWS_AS(buildRestState(shape, recipe, {}, loops.parallelFor()), Stopped);
  }
}

TEST_CASE("a body in the making ends wherever it is asked to, and looks often on one thread as well") {
  StoppableLoops loops(serialFor());
  for (const Evaluation evaluation : {Evaluation::stressPoints, Evaluation::phyxels}) {
    const bool lattice = evaluation == Evaluation::stressPoints;
    INFO((lattice ? "lattice" : "cloud"));
    const BodyRecipe recipe{.evaluation = evaluation, .sampling = {.spacing = 0.004}};  // some 16 000 phyxels
    const Constitution constitution{{rubber(2e4)}, lattice ? kLatticeStabilisation : kCloudStabilisation};
    const auto build = [&](const StopRequest &stop) {
      const StoppableLoops::Watch watch(loops, &stop);
      const auto rest = buildRestState(box(Vec3::Zero(), Vec3::Constant(0.1)), recipe, {}, loops.parallelFor());
      REQUIRE(rest);
      (void)Body("box", *rest, constitution, loops.parallelFor());
    };
    int ended = 0;
    for (int look = 0;; look = 2 * look + 1) {
      const AtLook stop(look);
      bool isEnded = false;
      try {
        build(stop);
      } catch (const Stopped &) {
        isEnded = true;
      }
      if (!isEnded) break;
      ++ended;
    }
    CHECK(ended >= 8);
    const Listening stop;
    build(stop);
    CHECK(stop.longest_s() < 0.1);

    // The frequency search is also ended.
    const auto rest = buildRestState(box(Vec3::Zero(), Vec3::Constant(0.1)), recipe, {}, serialFor());
    REQUIRE(rest);
    const AtLook late(8);
    const StoppableLoops::Watch watch(loops, &late);
    CHECK_THROWS_AS(Body("box", *rest, constitution, loops.parallelFor()), Stopped);
  }
}

TEST_CASE("a simulator says what it is busy with, and what would help") {
  Simulator simulator;
  WorldSettings world{.integrator = Integrator::implicitSdirk};
  simulator.setWorld(world);
  Material material = rubber(2e6);
  material.poissonRatio = 0.499;
  auto body = latticeBox(Vec3::Zero(), Vec3::Constant(0.1), 0.025, material);
  body->setInitialVelocity(Vec3::Zero(), Vec3(0.0, 3.0, 0.0));
  const std::size_t id = simulator.addBody(std::move(body));
  class Ask final : public StopRequest {
   public:
    explicit Ask(const Simulator &simulator) : simulator_(simulator) {}
    [[nodiscard]] bool isRaised() const noexcept override {
      if (line.empty()) line = simulator_.diagnostics().activity();
      return false;
    }
    mutable std::string line;

   private:
    const Simulator &simulator_;
  };
  CHECK(simulator.diagnostics().activity().empty());
  const Ask ask(simulator);
  REQUIRE(simulator.step(&ask));
  CHECK_THAT(ask.line, Contains("ν 0.499") && Contains("lower ν") && Contains("explicit"));
  CHECK(simulator.diagnostics().activity().empty());

  material.poissonRatio = 0.3;
  simulator.world().setConstitution(id, {{material}});
  world.integrator = Integrator::explicitVerlet;
  simulator.setWorld(world);
  const Ask again(simulator);
  REQUIRE(simulator.step(&again));
  CHECK_THAT(again.line, Contains("stable") && Contains("2e+06 Pa"));
}

TEST_CASE("of a step that was ended is said how far it came, and what fits by the speed that is measured") {
  Material material = rubber(1e6);
  material.poissonRatio = 0.3;
  for (const Integrator integrator : {Integrator::backwardEuler, Integrator::explicitVerlet, Integrator::quasiStatic}) {
    const auto simulator = twoBoxes(integrator, material);
    for (int k = 0; k < 2; ++k) REQUIRE(simulator->step());
    const std::uint64_t before = simulator->stateHash();
    const AtLook stop(integrator == Integrator::explicitVerlet ? 60 : 30);
    const auto ended = simulator->step(&stop);
    REQUIRE(!ended);
    REQUIRE(ended.error().ended);
    CHECK(ended.error().body == 2);
    const std::string text = simulator->stepper().suggestAffordableStep(ended.error(), 1e-4);
    INFO(text);
    CHECK_THAT(text, Contains("125 phyxels") && Contains("measured: "));
    if (integrator == Integrator::explicitVerlet) {
      CHECK_THAT(text, Contains("solver.dt = "));
      // Where forces take almost none of the time, something else does.
      CHECK_THAT(simulator->stepper().suggestAffordableStep(ended.error(), 100.0),
                 Contains("its forces take only") && Contains("contact") && !Contains("solver.dt"));
    } else {
      CHECK_THAT(text, Contains(" Newton step") && Contains("sampling.count = 50 or less"));
      CHECK_THAT(text, Contains(integrator == Integrator::quasiStatic ? "solver.load_steps" : "solver.dt = 0.0021"));
      // With enough time for explicit steps they are proposed first.
      CHECK((simulator->stepper().suggestAffordableStep(ended.error(), 100.0).find("explicit") != std::string::npos) ==
            (integrator == Integrator::backwardEuler));
    }
    // Measuring changes nothing.
    CHECK(simulator->stateHash() == before);
    const auto other = twoBoxes(integrator, material);
    for (int k = 0; k < 2; ++k) REQUIRE(other->step());
    const AtLook same(integrator == Integrator::explicitVerlet ? 60 : 30);
    REQUIRE(!other->step(&same));
    REQUIRE(other->step());
    REQUIRE(simulator->step());
    CHECK(simulator->stateHash() == other->stateHash());
  }
}
