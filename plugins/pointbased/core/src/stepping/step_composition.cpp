// SPDX-License-Identifier: Apache-2.0
#include "pointbased/step_composition.h"

#include <algorithm>

#include "base/number_text.h"

namespace pointbased {
namespace {

using detail::number;

std::string plural(std::size_t count, const char *one, const char *many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

// "material 0: yield 0.05", for the first material that has the property, and how many have it.
template <class Has, class Say>
std::string ofMaterials(const Constitution &constitution, const Has &has, const Say &say) {
  std::string text;
  for (std::size_t m = 0; m < constitution.materials.size(); ++m)
    if (has(constitution.materials[m]))
      text += (text.empty() ? "" : ", ") + ("material " + std::to_string(m) + ": ") + say(constitution.materials[m]);
  return text;
}

class Composer {
 public:
  Composer(const Body &body, const Environment &env, const CompositionNotes &notes)
      : body_(body), env_(env), notes_(notes), stages_(stagesOf(body, env)), names_(stageNames()) {
    out_.body = body.name();
  }

  StepComposition compose() {
    const bool isExplicit = notes_.integrator == Integrator::explicitVerlet;
    if (isExplicit) add("integrate", true, "velocity Verlet", kIntegrate);
    addContact(isExplicit ? kContact : kSolve);
    addSupports(isExplicit ? kSupports : kSolve);
    if (!isExplicit)
      add("solve", true, body_.quasiStatic ? "Newton, static equilibrium" : "Newton, implicit step", kSolve);
    addForces();
    addDamping(isExplicit ? kIntegrate : kSolve);
    add("guard", true, "every step is checked", kGuard);
    add("sleep", notes_.maySleep, notes_.maySleep ? "solver.sleep" : "bodies do not sleep", kStages);
    std::string probes;
    for (const std::string &probe : notes_.probes) probes += (probes.empty() ? "probe '" : ", '") + probe + "'";
    add("probes", !probes.empty(), probes.empty() ? "no probe" : probes + ": read when somebody asks", kStages);
    add("surfels", body_.rest().surfels.count() > 0, "the skin follows when somebody looks", kSurfels);
    if (!notes_.idle.empty())
      for (ComposedStage &stage : out_.stages) {
        const bool atRest = stage.name == "probes" || stage.name == "surfels";
        if (!atRest) stage = {stage.name, false, notes_.idle, stage.clock};
      }
    return std::move(out_);
  }

 private:
  void add(const char *name, bool runs, std::string why, Stage clock) {
    out_.stages.push_back({name, runs, std::move(why), clock < kStages ? names_[clock] : std::string()});
  }

  void addContact(Stage clock) {
    std::string what;
    for (const Obstacle &obstacle : env_.obstacles)
      if (obstacle.closest) what += (what.empty() ? "obstacle '" : ", '") + obstacle.name + "'";
    if (env_.box.enabled) what += what.empty() ? "walls of the world" : ", walls of the world";
    for (const std::string &name : notes_.touches) what += (what.empty() ? "body '" : ", body '") + name + "'";
    if (notes_.touchesItself) what += what.empty() ? "itself" : ", itself";
    const bool feels = body_.rest().contact.count() > 0;
    add("contact", stages_.contact || !notes_.touches.empty() || notes_.touchesItself,
        what.empty() ? "no obstacle, no walls, no other body"
        : feels      ? what
                     : "the body has no points that feel contact",
        clock);
  }

  void addSupports(Stage clock) {
    const std::size_t fixes = body_.rest().conditions.fixes.size();
    add("supports", stages_.supports, stages_.supports ? plural(fixes, "fix", "fixes") : "nothing holds it", clock);
  }

  void addForces() {
    const Constitution &c = body_.constitution();
    const std::string fused = "in one go with the forces, by vector kernels";
    const Stage flowClock = stages_.fused ? kForces : kFlow;
    add("deformation_gradients", !stages_.fused, stages_.fused ? fused : "stage by stage", kGradients);
    const std::string yields = ofMaterials(
        c, [](const Material &m) { return m.plastic.enabled(); },
        [](const Material &m) { return "yield " + number(m.plastic.yield); });
    add("plastic_flow", stages_.flow, yields.empty() ? "no material flows" : yields, flowClock);
    add("stresses", !stages_.fused, stages_.fused ? fused : "stage by stage", kStresses);
    add("internal_forces", !body_.rigid(), body_.rigid() ? "rigid: it moves as one and does not deform" : "elastic",
        kForces);
    addRates();
    const std::size_t loads = body_.rest().conditions.loads.size();
    add("loads", stages_.loads, loads == 0 ? "no load" : plural(loads, "load", "loads"), kForces);
    const Foundation &f = body_.foundation().settings();
    add("surroundings", stages_.surroundings,
        stages_.surroundings ? number(f.stiffness, 4) + " and " + number(f.tangential, 4) + " Pa/m"
                             : "nothing around it",
        kForces);
    add("outside_forces", stages_.outside,
        stages_.outside ? "another plugin, or a load of the run" : "nobody adds forces", kForces);
    add("hands", stages_.grabs,
        body_.grabs.empty() ? "nobody holds it"
        : stages_.grabs     ? plural(body_.grabs.size(), "hand", "hands")
                            : "hands do not act on a static solution",
        kStages);
  }

  void addRates() {
    const Constitution &c = body_.constitution();
    const std::string isStatic = "static: nothing has a rate";
    const std::string viscosities = ofMaterials(
        c, [](const Material &m) { return m.viscosity > 0.0; },
        [](const Material &m) { return "viscosity " + number(m.viscosity) + " Pa s"; });
    add("viscosity", stages_.viscous,
        viscosities.empty() ? "no viscosity"
        : stages_.viscous   ? viscosities
                            : isStatic,
        kForces);
    const std::string terms = ofMaterials(
        c, [](const Material &m) { return m.relaxes(); },
        [](const Material &m) {
          return plural(std::size_t{m.prony[0].share > 0.0} + std::size_t{m.prony[1].share > 0.0}, "Prony term",
                        "Prony terms");
        });
    add("relaxation", stages_.relaxing, terms.empty() ? "no Prony term" : stages_.relaxing ? terms : isStatic, kForces);
  }

  void addDamping(Stage clock) {
    add("damping", stages_.damping,
        stages_.damping      ? number(env_.damping) + " 1/s"
        : env_.damping > 0.0 ? "static: nothing has a rate"
                             : "no damping of the mass",
        clock);
  }

  const Body &body_;
  const Environment &env_;
  const CompositionNotes &notes_;
  const StepStages stages_;
  const std::vector<std::string> names_;
  StepComposition out_;
};

}  // namespace

StepStages stagesOf(const Body &body, const Environment &env) {
  const Constitution &constitution = body.constitution();
  const bool hasRates = !body.quasiStatic;
  StepStages out;
  out.fused = hasRates && (body.vectorised() || body.isFreeRigid());
  out.flow = !body.rigid() && !body.state().history.plasticInverse.empty();
  out.viscous = hasRates && !body.rigid() && constitution.viscous();
  out.relaxing = hasRates && !body.rigid() && constitution.relaxing();
  out.loads = !body.rest().conditions.loads.empty();
  out.surroundings = body.foundation().acts();
  out.outside = !body.externalForces().empty();
  out.grabs = hasRates && !body.grabs.empty();
  out.supports = body.held();
  out.patches = body.patches().rows() > 0;
  out.contact = env.contact() && body.rest().contact.count() > 0;
  out.damping = hasRates && env.damping > 0.0;
  return out;
}

StepComposition compose(const Body &body, const Environment &environment, const CompositionNotes &notes) {
  return Composer(body, environment, notes).compose();
}

}  // namespace pointbased
