// SPDX-License-Identifier: Apache-2.0
#include "panels/controller.h"

#include "panels/accuracy_panel.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <utility>

#include "base/file_text.h"
#include "base/number_text.h"
#include "panels/contact_panel.h"
#include "report/composition.h"

namespace pointbased {
namespace {

bool isEqual(const c3de_param_value &a, const c3de_param_value &b) {
  return a.type == b.type && a.num == b.num && sdk::text(a.text) == sdk::text(b.text) &&
         std::equal(std::begin(a.vec), std::end(a.vec), std::begin(b.vec));
}

constexpr double kFarBelow = 5.0;  // a ratio of stable steps for which rigid bodies are proposed

const std::array<std::string, 4> kUnitNames{"as specified, else mm", "mm", "cm", "m"};
constexpr std::array<std::uint32_t, 4> kUnits{C3DE_UNIT_UNKNOWN, C3DE_UNIT_MM, C3DE_UNIT_CM, C3DE_UNIT_M};

std::string hexadecimal(std::uint64_t value) {
  char text[24];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(value));
  return text;
}

std::string millimetres(const Vec3 &x) {
  return fixed(1e3 * x[0], 2) + " " + fixed(1e3 * x[1], 2) + " " + fixed(1e3 * x[2], 2) + " mm";
}

std::string_view modeName(std::uint32_t mode) {
  switch (mode) {
    case C3DE_SIM_PLAYING: return "playing";
    case C3DE_SIM_PAUSED: return "paused";
    case C3DE_SIM_FAILED: return "failed: the last good state is shown; reset to continue";
    default: return "stopped, at the initial state";
  }
}

void setBodyParameter(WorldSimulator &simulator, std::uint64_t body, const ParameterEntry &value) {
  (void)simulator.parts().changes.make(SetBodyParameter{simulator.parts().queries.nameOfBody(body), value});
}

}  // namespace

Controller::Controller(const Services &services, const MaterialLaws &laws, const Tools &tools)
    : services_(services), tools_(tools), mode_(services.host), laws_(laws), verification_(services),
      obstacles_(services, tools.move), loads_(tools.load) {
  declareBody();
  worldParameters_ = sdk::orThrow(services_.params.declare(
      "World", worldDeclarations(), [this](const c3de_param_value &value) { worldParameterChanged(value); }));
}

// Declares the parameters again when laws have been added.
void Controller::declareBody() {
  if (declared_.data() == laws_.declarations().data()) return;
  declared_ = laws_.declarations();
  nextValues_ = ParameterValues(declared_);
  bodyParameters_ = {};
  bodyParameters_ = sdk::orThrow(services_.params.declare(
      "Body", declared_, [this](const c3de_param_value &value) { bodyParameterChanged(value); }));
}

bool Controller::isMoving() const {
  const auto state = services_.simulation.state(simulator_->node());
  return state && state->mode == C3DE_SIM_PLAYING;
}

sdk::Result<void> Controller::verify() {
  if (!simulator_) return sdk::Failure{C3DE_E_STATE, "there is no simulation; open a scene or a mesh first"};
  const auto snapshot = simulator_->snapshot();
  if (!snapshot || snapshot->bodies.empty()) return sdk::Failure{C3DE_E_STATE, "there is no body to verify"};
  if (isMoving()) return sdk::Failure{C3DE_E_STATE, "pause first: what is verified is the paused state"};
  return verification_.begin(*simulator_);
}

void Controller::setSimulator(WorldSimulator *simulator, SimulatorView *view) {
  obstacles_.setSimulator(simulator);
  loads_.setSimulator(simulator);
  simulator_ = simulator;
  pendingEdits_ = std::make_shared<std::atomic<int>>(0);
  view_ = view;
  body_ = 0;
  if (!simulator_) return;
  declareBody();
  followedWorld_ = simulator_->parts().parameters.shown();
  const ParameterValues world = simulator_->parts().parameters.values();
  for (const c3de_param_decl &d : worldDeclarations())
    if (const auto value = world.get(sdk::text(d.id))) (void)worldParameters_.set(*value);
}

// The panel's values are those of the body it shows: the first one, until it is removed.
void Controller::followBody(const Snapshot *snapshot) {
  if (!snapshot) return;
  if (const BodySnapshot *same = body_ != 0 ? snapshot->body(body_) : nullptr) return followValues(*same);
  body_ = 0;
  if (!snapshot->bodies.empty()) showBody(snapshot->bodies.front());
}

/// Shows values that were set outside of the panel, for example by a replay. An edit that has not been applied yet is
/// kept.
void Controller::followValues(const BodySnapshot &body) {
  if (body.values == followed_ || *pendingEdits_ > 0) return;
  const std::shared_ptr<const ParameterValues> before = std::exchange(followed_, body.values);
  for (const c3de_param_decl &d : declared_) {
    const std::string_view id = sdk::text(d.id);
    const auto now = body.values->get(id), last = before->get(id), shown = bodyParameters_.get(id);
    if (!now || !last || !shown || isEqual(*now, *last) || !isEqual(*shown, *last)) continue;
    (void)nextValues_.set(*now);
    (void)bodyParameters_.set(*now);
  }
}

/// The same for the values of the world.
void Controller::followWorld() {
  if (*pendingEdits_ > 0) return;
  const std::shared_ptr<const ParameterValues> values = simulator_->parts().parameters.shown();
  if (values == followedWorld_) return;
  const std::shared_ptr<const ParameterValues> before = std::exchange(followedWorld_, values);
  for (const c3de_param_decl &d : worldDeclarations()) {
    const std::string_view id = sdk::text(d.id);
    const auto now = values->get(id), shown = worldParameters_.get(id);
    const auto last = before ? before->get(id) : shown;
    if (!now || !last || !shown || isEqual(*now, *last) || !isEqual(*shown, *last)) continue;
    (void)worldParameters_.set(*now);
  }
}

void Controller::showBody(const BodySnapshot &body) {
  body_ = body.id;
  followed_ = body.values;
  nextValues_ = *body.values;
  for (const c3de_param_decl &d : declared_)
    if (const auto value = nextValues_.get(sdk::text(d.id))) (void)bodyParameters_.set(*value);
}

void Controller::draw(sdk::Ui &ui) {
  if (!simulator_) {
    ui.text("No simulation is open.");
    return;
  }
  const std::shared_ptr<const Snapshot> snapshot = simulator_->snapshot();
  followBody(snapshot.get());
  followWorld();
  mode_.draw(ui);
  if (snapshot) drawWarnings(ui, *snapshot);
  if (snapshot && snapshot->bodies.size() > 1) chooseBody(ui, *snapshot);
  drawActiveTools(ui, snapshot.get());
  if (mode_.isSimple())
    drawSimple(ui, snapshot.get());
  else
    drawAll(ui, snapshot.get());
}

// The settings of the active tool come first, where they are seen at once.
void Controller::drawActiveTools(sdk::Ui &ui, const Snapshot *snapshot) {
  if (tools_.pinch.isActive()) drawPinch(ui);
  if (tools_.touch.isActive()) drawTouch(ui, tools_.touch, snapshot);
  if (tools_.grasp.isActive()) drawGrasp(ui, tools_.grasp, snapshot);
  if (tools_.move.isActive()) obstacles_.draw(ui, snapshot);
  // The simple mode has them where the tool is activated.
  if (tools_.load.isActive() && !mode_.isSimple()) loads_.draw(ui, snapshot);
}

// Above the first heading: a search does not hide them.
void Controller::drawWarnings(sdk::Ui &ui, const Snapshot &snapshot) {
  for (const std::string &notice : snapshot.notices) ui.text(notice);
  suggestRigid(ui, snapshot);
}

// In the order of use.
void Controller::drawAll(sdk::Ui &ui, const Snapshot *snapshot) {
  drawRun(ui, snapshot);
  drawAccuracy(ui, snapshot);
  drawMaterial(ui);
  if (!tools_.load.isActive()) loads_.draw(ui, snapshot);
  drawWorld(ui);
  ui.heading("Contact and attachments");
  ui.params(worldParameters_.handle(), "Contact");
  if (snapshot) drawContacts(ui, *snapshot);
  drawView(ui, snapshot);
  drawBody(ui, snapshot);
  if (!tools_.pinch.isActive()) drawPinch(ui);
  if (!tools_.touch.isActive()) drawTouch(ui, tools_.touch, snapshot);
  if (!tools_.grasp.isActive()) drawGrasp(ui, tools_.grasp, snapshot);
  if (!tools_.move.isActive()) obstacles_.draw(ui, snapshot);
  ui.heading("Plasticity");
  ui.params(bodyParameters_.handle(), "Plasticity");
  ui.heading("Relaxation");
  ui.params(bodyParameters_.handle(), "Relaxation");
  ui.heading("Solver");
  ui.params(worldParameters_.handle(), "Solver");
  if (snapshot) drawStages(ui, *snapshot);
}

void Controller::drawBody(sdk::Ui &ui, const Snapshot *snapshot) {
  ui.heading("Body");
  (void)ui.fileButton("browse", "Browse…", "obj;stl;ply;vtk", path_);
  (void)ui.inputText("path", "File", path_);
  ui.tooltip("A closed surface: OBJ, STL, PLY or VTK polydata");
  (void)ui.choice("unit", "Unit of the file", unit_, kUnitNames);
  (void)ui.checkbox("replace", "Replace the present body", replace_);
  if (job_) {
    if (const auto state = services_.jobs.progress(*job_)) {
      ui.progress(state->fraction, state->what);
      if (ui.button("cancel", "Cancel")) (void)services_.jobs.cancel(*job_);
    }
  } else {
    if (ui.button("load", "Load", !path_.empty() && !isCapturing_)) load();
    ui.tooltip("Reads the surface and fills it with phyxels as set below; what is there stays when that fails");
    ui.sameLine();
    if (ui.button("rebuild", "Rebuild", body_ != 0 && !isCapturing_)) rebuild();
    ui.tooltip("Fills the present body again with the sampling below");
  }
  const BodySnapshot *body = snapshot ? snapshot->body(body_) : nullptr;
  if (body) {
    if (snapshot->bodies.size() == 1) ui.value("Body", body->name);
    const std::size_t held = body->rigid ? 0 : body->held;
    ui.value("Phyxels", std::to_string(body->phyxels.size()) + (held > 0 ? ", " + std::to_string(held) + " held" : ""));
    ui.tooltip(held > 0 ? "Those that supports and rigid tissue hold count as well" : "");
    ui.value("Surfels", std::to_string(body->surfels.size()));
    const bool isQuadratic = !body->rest->stencils.quadratic.points.empty();
    ui.value("Spacing", fixed(1e3 * body->rest->spacing, 2) + " mm" + (isQuadratic ? ", quadratic cells" : ""));
    ui.tooltip(isQuadratic ? "Cells that the surface cuts have quadratic shape functions (Order, sampling.order)" : "");
    ui.value("Neighbours", std::to_string(body->neighbours.min) + " … " + std::to_string(body->neighbours.max) +
                               ", mean " + fixed(body->neighbours.mean, 1));
    ui.value("Mass", significant(body->mass, 4) + " kg");
    ui.value("Asleep", body->asleep ? "yes" : "no");
    ui.tooltip("At rest: costs nothing until touched");
    ui.value("Computed", body->computed);
    ui.tooltip("What integrates the body (solver.integrator), and what its forces are computed with");
    ui.value("Volume", significant(1e6 * body->rest->shapeVolume, 4) + " ml");
  }
  ui.params(bodyParameters_.handle(), "Sampling");
}

void Controller::drawAccuracy(sdk::Ui &ui, const Snapshot *snapshot) {
  ui.heading("Accuracy");
  const bool isSimple = mode_.isSimple();
  const BodySnapshot *body = snapshot ? snapshot->body(body_) : nullptr;
  if (body) drawAccuracyStatement(ui, *body);
  verification_.draw(ui, *simulator_, snapshot, isMoving());
  if (!isSimple) {
    if (ui.button("finer", "Refine here", !isBusy() && body && !body->rigid)) makeFiner(*body);
    ui.tooltip(
        "Resamples the body with the same number of phyxels: smaller cells where supports, loads and previous pulls "
        "cause most of the error; the simulation restarts");
  }
  verification_.drawResult(ui, snapshot);
  ui.params(worldParameters_.handle(), "Error in mm");
  if (isSimple)
    drawOtherTarget(ui, simulator_->parts().parameters.values());
  else
    ui.params(worldParameters_.handle(), "Accuracy");
  if (!snapshot) return;
  if (ui.button("apply_wish", "Apply to all bodies", !isBusy() && !snapshot->bodies.empty()))
    applyAccuracyTarget(*snapshot);
  ui.tooltip("Resamples every body to meet the accuracy target; the simulation restarts");
  if (body && !isSimple) drawAccuracyBars(ui, *body);
  if (body && isSimple) drawUnmetTarget(ui, *body);
  startTrials(*snapshot);
}

// Once for each body, in parallel to the steps.
void Controller::startTrials(const Snapshot &snapshot) {
  if (job_ || trials_ || std::all_of(snapshot.bodies.begin(), snapshot.bodies.end(), [](const BodySnapshot &body) {
        return body.rigid || body.hasTrials;
      }))
    return;
  auto run = [simulator = sdk::Ref<WorldSimulator>::share(simulator_)](sdk::Progress progress) -> sdk::Result<void> {
    simulator->parts().accuracy.computeTrials(progress, serialFor());
    return {};
  };
  const auto job = services_.jobs.submit("Estimating the accuracy", std::move(run),
                                         [this, node = simulator_->node()](const sdk::Result<void> &result) {
                                           trials_.reset();
                                           if (!result)
                                             services_.log.warn("estimating the accuracy: " + result.failure().message);
                                           // A command makes the solver publish, so that the result is shown while it
                                           // is paused.
                                           (void)services_.simulation.post(node, [] {});
                                         });
  if (job) trials_ = *job;
}

void Controller::chooseBody(sdk::Ui &ui, const Snapshot &snapshot) {
  std::vector<std::string> names;
  std::uint32_t index = 0;
  for (const BodySnapshot &body : snapshot.bodies) {
    if (body.id == body_) index = static_cast<std::uint32_t>(names.size());
    names.push_back(body.name);
  }
  if (ui.choice("body", "Body", index, names)) showBody(snapshot.bodies[index]);
  ui.tooltip("Whose figures and parameters are shown");
}

// Bone next to soft tissue: no step of the whole is longer than the stable step of bone, or it is solved at high cost.
void Controller::suggestRigid(sdk::Ui &ui, const Snapshot &snapshot) {
  const BodySnapshot *stiffest = nullptr;
  for (const BodySnapshot &body : snapshot.bodies)
    if (!body.rigid && (!stiffest || body.stableStep < stiffest->stableStep)) stiffest = &body;
  if (!stiffest) return;
  const BodySnapshot *next = nullptr;
  for (const BodySnapshot &body : snapshot.bodies)
    if (!body.rigid && &body != stiffest && (!next || body.stableStep < next->stableStep)) next = &body;
  if (!next || !(stiffest->stableStep * kFarBelow < next->stableStep)) return;
  ui.text(stiffest->name + " limits the speed: its stable step is " + significant(1e3 * stiffest->stableStep, 2) +
          " ms, " + significant(next->stableStep / stiffest->stableStep, 2) + " times below that of " + next->name +
          ".");
  if (ui.button("make_rigid", "Make " + stiffest->name + " rigid")) makeRigid(stiffest->id);
  ui.tooltip("It stays fixed in its reference position at no cost. To undo, clear Surroundings, Rigid");
}

void Controller::makeRigid(std::uint64_t body) {
  c3de_param_value value{};
  value.size = sizeof value;
  value.id = sdk::str("rigid");
  value.type = C3DE_PARAM_BOOL;
  value.num = 1.0;
  if (body == body_) {
    (void)nextValues_.set(value);
    (void)bodyParameters_.set(value);
  }
  (void)services_.simulation.post(simulator_->node(),
                                  [simulator = sdk::Ref<WorldSimulator>::share(simulator_), body, value] {
                                    setBodyParameter(*simulator, body, ParameterEntry(value));
                                  });
}

void Controller::drawMaterial(sdk::Ui &ui) {
  ui.heading("Material");
  ui.params(bodyParameters_.handle(), "Stiffness");
  ui.params(bodyParameters_.handle(), "Material");
  ui.heading("Surroundings");
  ui.params(bodyParameters_.handle(), "Surroundings");
}

void Controller::drawWorld(sdk::Ui &ui) {
  ui.heading("World");
  ui.params(worldParameters_.handle(), "Gravity");
  ui.params(worldParameters_.handle(), "World");
}

void Controller::drawRun(sdk::Ui &ui, const Snapshot *snapshot) {
  ui.heading("Run");
  const auto state = services_.simulation.state(simulator_->node());
  const std::uint32_t mode = state ? state->mode : C3DE_SIM_STOPPED;
  const bool playing = mode == C3DE_SIM_PLAYING;
  if (playing) {
    if (ui.button("pause", "Pause")) transport(C3DE_TRANSPORT_PAUSE);
  } else if (ui.button("play", mode == C3DE_SIM_PAUSED ? "Continue" : "Play", mode != C3DE_SIM_FAILED)) {
    transport(C3DE_TRANSPORT_PLAY);
  }
  ui.sameLine();
  if (ui.button("step", "Step", !playing && mode != C3DE_SIM_FAILED)) transport(C3DE_TRANSPORT_STEP);
  ui.sameLine();
  if (ui.button("stop", "Stop", mode != C3DE_SIM_STOPPED)) transport(C3DE_TRANSPORT_STOP);
  ui.tooltip("Ends and goes back to the initial state");
  ui.sameLine();
  if (ui.button("reset", "Reset")) transport(C3DE_TRANSPORT_RESET);
  ui.tooltip("Back to the initial state, bit for bit; goes on if it was playing");

  ui.value("State", modeName(mode));
  if (!snapshot) return;
  ui.value("Simulated time", fixed(snapshot->time, 3) + " s");
  if (mode_.isSimple()) return;
  ui.value("Steps", std::to_string(snapshot->steps));
  ui.value("Step size", significant(1e3 * snapshot->dt, 3) + " ms");
  if (state) ui.value("Real-time factor", playing ? fixed(state->real_time_factor, 2) : std::string("–"));
  if (const BodySnapshot *body = snapshot->body(body_)) {
    ui.value("Kinetic energy", significant(body->energy.kinetic, 3) + " J");
    ui.value("Elastic energy", significant(body->energy.elastic, 3) + " J");
    const double total = body->energy.elastic + body->energy.stabilisation;
    ui.value("Computing", body->cost > 0.0 ? significant(body->cost, 3) + " s per simulated second" : std::string("–"));
    ui.value("Stabilisation share",
             total > 0.0 ? fixed(100.0 * body->energy.stabilisation / total, 1) + " %" : std::string("–"));
    ui.tooltip(
        "Part of the elastic energy that controls what the sampling cannot resolve; much above 5 %: use a smaller "
        "spacing");
  }
  ui.value("State hash", hexadecimal(snapshot->hash));
}

void Controller::drawStages(sdk::Ui &ui, const Snapshot &snapshot) {
  drawComposition(ui, snapshot.compositions, snapshot.stages);
  if (!snapshot.events.empty()) ui.text("Latest event: " + snapshot.events.back().text);
}

void Controller::drawColours(sdk::Ui &ui, const Snapshot *snapshot) {
  ui.params(worldParameters_.handle(), "Colour");
  if (!snapshot || !snapshot->colours) return;
  const ColourScale &scale = *snapshot->colours;
  ui.value("Colours",
           scale.title + ", " + significant(scale.low, 4) + " … " + significant(scale.high, 4) + " " + scale.unit);
  std::string note = scale.note;
  for (std::size_t at; (at = note.find('\n')) != std::string::npos;) note.replace(at, 1, "; ");
  ui.value("Shown", note);
}

void Controller::drawView(sdk::Ui &ui, const Snapshot *snapshot) {
  if (!view_) return;
  ui.heading("View");
  drawColours(ui, snapshot);
  ui.params(worldParameters_.handle(), "View");
}

void Controller::drawPinch(sdk::Ui &ui) {
  ui.heading("Pinch");
  if (ui.button("pinch", tools_.pinch.isActive() ? "Pinch is active" : "Activate pinch tool", !tools_.pinch.isActive()))
    (void)tools_.pinch.select();
  ui.tooltip(
      "Press on the organ, in the 3D view or in a slice, and drag. Release the button or press Escape to end the pull");
  (void)ui.slider("pinch_hz", "Stiffness", "Hz", pinchSettings_.frequency_hz, 1.0, 60.0);
  ui.tooltip("Frequency of the spring on the mass it holds: the same feel for small and large organs");
  (void)ui.slider("pinch_radius", "Patch radius", "mm", pinchSettings_.radius_mm, 2.0, 60.0);
  ui.tooltip("Size of the patch that is held, from the next press on; at least two spacings");
  (void)ui.slider("pinch_most", "Largest force", "N", pinchSettings_.largestForce, 0.0, 20.0);
  ui.tooltip(
      "Force limit of the pinch, from the next press on; 0: none. The pull never exceeds 4 times Young's "
      "modulus "
      "times the squared radius");
  tools_.pinch.setSettings(pinchSettings_);
  if (const auto &hold = tools_.pinch.hold()) {
    if (hold->surfel)
      ui.value("Held surfel", std::to_string(*hold->surfel));
    else
      ui.value("Held inside", hold->what);
    if (!hold->idleReason.empty()) ui.value("Nothing moves", hold->idleReason);
    ui.value("Pinch force", fixed(hold->force, 3) + " N");
    ui.value("Held mass", significant(1e3 * hold->mass, 3) + " g");
    ui.value("Held point", millimetres(hold->point));
    ui.value("Hand", millimetres(hold->target));
  } else {
    ui.value("Pinch force", "–");
    if (!tools_.pinch.refusal().empty()) ui.value("Not held", tools_.pinch.refusal());
  }
}

void Controller::transport(std::uint32_t action) {
  if (action == C3DE_TRANSPORT_STOP || action == C3DE_TRANSPORT_RESET) tools_.pinch.cancel();
  if (const auto done = services_.simulation.transport(simulator_->node(), action); !done)
    report("Simulation", done.failure().message);
}

void Controller::bodyParameterChanged(const c3de_param_value &value) {
  (void)nextValues_.set(value);
  for (const c3de_param_decl &d : declared_)
    if (sdk::text(d.id) == sdk::text(value.id) && (d.flags & C3DE_PARAM_NEEDS_RESET)) return;
  if (!simulator_ || body_ == 0) return;
  simulator_->abandonLongStep();
  postEdit([body = body_, owned = ParameterEntry(value)](WorldSimulator &simulator) {
    setBodyParameter(simulator, body, owned);
  });
}

void Controller::postEdit(std::function<void(WorldSimulator &)> edit) {
  struct Pending {
    explicit Pending(std::shared_ptr<std::atomic<int>> of) : count(std::move(of)) { ++*count; }
    ~Pending() { --*count; }
    Pending(const Pending &) = delete;
    Pending &operator=(const Pending &) = delete;
    std::shared_ptr<std::atomic<int>> count;
  };
  (void)services_.simulation.post(simulator_->node(),
                                  [simulator = sdk::Ref<WorldSimulator>::share(simulator_), edit = std::move(edit),
                                   pending = std::make_shared<Pending>(pendingEdits_)] { edit(*simulator); });
}

void Controller::worldParameterChanged(const c3de_param_value &value) {
  if (!simulator_) return;
  ParameterValues copy(worldDeclarations());
  if (!copy.set(value)) return;
  const std::string id(sdk::text(value.id));
  // The other targets as shown in the panel; the simulator resets them itself.
  if (isAccuracyTarget(id) && !copy.isAuto(id))
    for (const std::string_view other : kAccuracyTargets)
      if (other != id) (void)worldParameters_.set(sdk::textValue(other, "auto"));
  if (!isOfTheView(id)) simulator_->abandonLongStep();
  postEdit([owned = ParameterEntry(value)](WorldSimulator &simulator) {
    (void)simulator.parts().changes.make(SetWorldParameters{{owned}});
  });
}

void Controller::load() {
  const auto simulator = sdk::Ref<WorldSimulator>::share(simulator_);
  const std::string path = path_;
  const std::uint32_t unit = kUnits[unit_];
  const std::uint64_t before = replace_ ? body_ : 0;
  const ParameterValues values = nextValues_;
  const Work work{"Loading " + fileName(path), "Load", "load " + fileStem(path)};
  auto run = [this, simulator, path, unit, before, values,
              hasChanged = work.hasChanged](sdk::Progress progress) -> sdk::Result<void> {
    auto mesh = services_.meshes.load(path, unit, progress.abi());
    if (!mesh) return mesh.failure();
    LoadBody change;
    change.name = fileStem(path);
    change.mesh = dataOf(services_, mesh->handle());
    change.values = entriesOf(values);
    // A replacement is placed where the previous one was.
    if (before != 0)
      if (const auto source = simulator->parts().bodies.source(before)) {
        change.placement.position = source->placement.position;
        change.replaced = simulator->parts().queries.nameOfBody(before);
      }
    (void)simulator->parts().changes.make(std::move(change), progress);
    *hasChanged = true;
    return {};
  };
  start(work, std::move(run));
}

void Controller::start(const Work &work, std::function<sdk::Result<void>(sdk::Progress)> run) {
  auto begin = [this, work, run = std::move(run), of = simulator_] {
    isCapturing_ = false;
    if (simulator_ != of) return;
    const auto job =
        services_.jobs.submit(work.job, run, [this, work](const sdk::Result<void> &result) { finish(work, result); });
    if (job) {
      job_ = *job;
    } else {
      report(work.title, job.failure().message);
    }
  };
  if (!services_.history.canCapture()) return begin();
  if (simulator_) simulator_->abandonLongStep();  // captured between two steps
  const auto captured = services_.history.capture(begin);
  isCapturing_ = captured.ok();
  if (!captured) report(work.title, captured.failure().message);
}

void Controller::applyAccuracyTarget(const Snapshot &snapshot) {
  std::vector<std::pair<std::uint64_t, ParameterValues>> bodies;
  for (const BodySnapshot &body : snapshot.bodies) {
    if (body.rigid) continue;
    ParameterValues values = *body.values;
    for (const char *id : {"sampling.spacing", "sampling.count"}) sdk::orThrow(values.set(sdk::textValue(id, "auto")));
    bodies.emplace_back(body.id, std::move(values));
  }
  startRebuilding({"Sampling the bodies for the accuracy target", "Rebuild", "sample for the accuracy"},
                  std::move(bodies), true);
}

void Controller::makeFiner(const BodySnapshot &body) {
  ParameterValues values = *body.values;
  sdk::orThrow(values.set(sdk::textValue("sampling.adaptive", "on")));
  startRebuilding({"Finding where the error arises", "Rebuild", "refine " + body.name}, {{body.id, std::move(values)}});
}

void Controller::rebuild() {
  const std::shared_ptr<const Snapshot> snapshot = simulator_->snapshot();
  const BodySnapshot *body = snapshot ? snapshot->body(body_) : nullptr;
  if (!body) return;
  startRebuilding({"Resampling the organ", "Rebuild", "rebuild " + body->name}, {{body_, nextValues_}});
}

void Controller::startRebuilding(const Work &work, std::vector<std::pair<std::uint64_t, ParameterValues>> bodies,
                                 bool sharesTarget) {
  const auto simulator = sdk::Ref<WorldSimulator>::share(simulator_);
  start(work,
        [simulator, all = std::move(bodies), sharesTarget,
         hasChanged = work.hasChanged](sdk::Progress progress) -> sdk::Result<void> {
          Changes &changes = simulator->parts().changes;
          if (sharesTarget)
            (void)changes.make(SetWorldParameters{{ParameterEntry(
                sdk::integerValue(C3DE_PARAM_ID_ACCURACY_BODIES, static_cast<std::int64_t>(all.size())))}});
          for (const auto &[body, values] : all) {
            (void)changes.make(RebuildBody{simulator->parts().queries.nameOfBody(body), entriesOf(values)}, progress);
            *hasChanged = true;
          }
          return {};
        });
}

void Controller::finish(const Work &work, const sdk::Result<void> &result) {
  job_.reset();
  // A job that was cancelled or failed may have changed the first of several bodies.
  if (*work.hasChanged && services_.history.canCapture())
    if (const auto added = services_.history.addCaptured(work.undoLabel); !added)
      services_.log.warn("'" + work.undoLabel + "' cannot be undone: " + added.failure().message);
  if (!result) {
    if (result.failure().status != C3DE_E_CANCELLED) report(work.title, result.failure().message);
    return;
  }
  if (simulator_) {
    // A command makes the solver publish, so that the new body is shown while it is paused.
    (void)services_.simulation.post(simulator_->node(), [] {});
  }
}

void Controller::report(const std::string &title, const std::string &text) {
  services_.log.info(title + ": " + text);
  (void)services_.notifier.notify(C3DE_LOG_ERROR, title, text);
}

}  // namespace pointbased
