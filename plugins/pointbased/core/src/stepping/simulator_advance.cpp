// SPDX-License-Identifier: Apache-2.0
// All bodies of a simulation through a step: small ones side by side, each of the others with all threads.
#include <algorithm>
#include <chrono>

#include "pointbased/simulator.h"
#include "stepping/body_stepper.h"
#include "stepping/step_activity.h"

namespace pointbased {
namespace {

constexpr int kUsualLoadSteps = 10;
constexpr std::size_t kMostPointsBesides = 4000;  // more are worth all threads

}  // namespace

// Complaints of laws of plugins are the law's, which several bodies may share.
bool Simulator::goesBesides(const Body &body) {
  if (body.rest().pointCount() > kMostPointsBesides) return false;
  const std::vector<Material> &materials = body.constitution().materials;
  return std::none_of(materials.begin(), materials.end(), [](const Material &m) { return m.custom != nullptr; });
}

void Simulator::forBodies(const detail::StepContext &order, const AdvanceBody &advance) {
  struct Task {
    std::size_t id = 0;
    detail::BodyStepper *runner = nullptr;
    std::vector<std::pair<std::string, std::string>> events;
    StageClock clock{stageNames()};
    double seconds = 0.0;
    bool wasStopped = false;
  };
  std::vector<Task> small;
  std::vector<Task> large;
  for (auto &[id, runner] : bodies_) {
    if (runner->stopped() || runner->body().rigid()) continue;
    Task task;
    task.id = id;
    task.runner = runner.get();
    (goesBesides(runner->body()) ? small : large).push_back(std::move(task));
  }
  // One alone has all threads to itself.
  if (small.size() == 1) {
    large.push_back(std::move(small.front()));
    small.clear();
  }
  const auto run = [&](Task &task) {
    detail::StepContext own = order;
    own.environment.clock = &task.clock;
    own.reportEvent = [&task](const char *kind, const std::string &text) { task.events.emplace_back(kind, text); };
    activity_->enter(task.id);
    const auto begin = std::chrono::steady_clock::now();
    try {
      advance(*task.runner, own);
    } catch (const Stopped &) {
      task.wasStopped = true;  // it stays entered
      return;
    }
    task.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    activity_->leave(task.id);
  };
  const auto some = [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) run(small[k]);
  };
  // Loops within end by themselves, on the thread that they are called from.
  if (!small.empty()) plainLoops_(small.size(), 1, std::cref(some));
  for (Task &task : large) run(task);
  std::vector<Task> all = std::move(small);
  for (Task &task : large) all.push_back(std::move(task));
  std::sort(all.begin(), all.end(), [](const Task &a, const Task &b) { return a.id < b.id; });
  for (Task &task : all) {
    if (task.wasStopped) throw Stopped{};
    spent_[task.id] += task.seconds;
    clock_.add(task.clock);
    for (const auto &[kind, text] : task.events) reportEvent(kind, text);
  }
}

void Simulator::increaseLoad(const detail::StepContext &order) {
  const int increments = world_.loadSteps > 0 ? world_.loadSteps : kUsualLoadSteps;
  double next = std::min(1.0, loadFactor_ + 1.0 / increments);
  if (next > 1.0 - 1e-9) next = 1.0;
  forBodies(order, [next](detail::BodyStepper &body, const detail::StepContext &own) { body.loadUpTo(own, next); });
  if (!failed()) loadFactor_ = next;
}

double Simulator::advanceBodies(const detail::StepContext &order) {
  std::map<const detail::BodyStepper *, double> gone;
  for (const auto &[id, runner] : bodies_) gone[runner.get()] = order.dt;
  forBodies(order, [&gone](detail::BodyStepper &body, const detail::StepContext &own) {
    gone.find(&body)->second = body.advance(own, own.dt);
  });
  double span = order.dt;
  for (const auto &[body, way] : gone) span = std::min(span, way);
  if (!(span < order.dt)) return span;
  // Where the substeps of one were not enough, the others have gone too far.
  forBodies(order, [&gone, span](detail::BodyStepper &body, const detail::StepContext &own) {
    if (gone.find(&body)->second > span) body.advanceAgain(own, span);
  });
  return span;
}

}  // namespace pointbased
