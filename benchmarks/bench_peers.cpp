// SPDX-License-Identifier: Apache-2.0
// Compares this engine with Bullet: the cost of a simulated second, and the error of the body at rest.
//
//   bench_peers [--quick] [--organ FILE] [--only TEXT] [--json FILE]
//   bench_peers --organ FILE --deck DECK.inp [--nodes N]      writes the static problem for CalculiX and ends
//
// Bodies fall from rest, held at one end, at about 500, 3 000 and 10 000 nodes. Cost: processor time of one thread per
// simulated second at the largest stable step. The steps tried are a frame of 1/60 s divided by powers of 2^(1/4). A
// run is unstable if its state is not finite, leaves the bounds or has more kinetic energy than gravity has supplied.
// Each run covers half a second or 1.5 s of processor time. This engine chooses its explicit steps itself. Error: of
// the body at rest against one reference value for all, at a higher modulus, where strains are small and the laws
// agree. --quick: only 500 nodes.
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>

#include "peers/bullet_body.h"
#include "peers/deck.h"
#include "peers/engine_body.h"
#include "peers/organ_truths.h"
#include "peers/report.h"
#include "peers/scenes.h"
#include "pointbased/interpolation.h"

namespace {

using namespace peers;
using pointbased::Integrator;

constexpr const char *kSettings =
    "Bullet: its defaults (single precision as packaged, one Newton step, at most 300 iterations of conjugate\n"
    "  gradients, damping 0.01/0.01 of the linear and 0.05 of the neo-Hookean force), without collisions and sleep;\n"
    "  implicit steps with setUseProjection(true), without which they do not move; \"undamped\": damping set to 0.\n"
    "  Neo-Hookean with the Lame constants that give E and nu at small strain. Mass-spring: links along the edges in\n"
    "  random order, kLST 1, one iteration; it has no E, so its error says what such links do at that step. At rest:\n"
    "  implicit steps with motion stopped whenever it slows (the neo-Hookean force undamped: the same end, sooner).\n"
    "This engine: neo-Hookean, its own stabilisation, double precision; explicit at its own step (0.8 of its bound of\n"
    "  the largest stable one), implicit at 1/60 s, without contact of the body with itself; at rest by its\n"
    "  quasi-static solution.\n";

constexpr double kBudgetMs = 1500.0;  // of processor time for one run

Bounds boundsOf(const Scene &scene) {
  return {scene.size, scene.soft.density * scene.shape.volume * kGravity.norm() * scene.size};
}

class Comparison {
 public:
  Comparison(const Scene &scene, bench::Report &report) : scene_(scene), report_(report) {}

  void bullet(std::size_t size) {
    const TetraMesh mesh = scene_.mesh(size);
    const double spacing = std::cbrt(scene_.shape.volume / static_cast<double>(mesh.nodes.size()));
    const double atRest[2] = {settled(mesh, BulletModel::linearElasticity, true),
                              settled(mesh, BulletModel::neoHookean, true)};
    if (std::isnan(asAsked_)) asAsked_ = settled(mesh, BulletModel::neoHookean, false);
    const auto add = [&](BulletModel model, bool implicit, bool damped) {
      const BulletSettings settings{model, implicit, damped, true};
      Row row;
      row.kind = model == BulletModel::massSpring ? Kind::massSpring : Kind::fem;
      row.model = nameOf(settings);
      row.nodes = mesh.nodes.size();
      const auto make = [&](double dt) { return makeBulletBody(mesh, scene_.soft, settings, dt); };
      // Explicit steps scale with the spacing; implicit ones begin with a frame.
      int &known = hints_.try_emplace(row.model, implicit || row.kind == Kind::massSpring ? 0 : 16).first->second;
      row.cost = costAtLargestStep(make, boundsOf(scene_), known, kBudgetMs);
      if (row.cost.stable) known = row.cost.index;
      if (row.kind == Kind::massSpring) {
        const auto body = makeBulletBody(mesh, scene_.stiff, settings, row.cost.stable ? row.cost.dt : kFrame);
        row.settled = relaxToRest(*body, 600);
      } else {
        row.settled = atRest[model == BulletModel::neoHookean ? 1 : 0];
      }
      finish(row, size);
    };
    // Explicit steps of a finer mesh: shorter by the ratio of the spacings.
    if (lastSpacing_ > 0.0)
      for (auto &[model, hint] : hints_)
        if (hint > 0) hint += static_cast<int>(std::lround(4.0 * std::log2(lastSpacing_ / spacing)));
    lastSpacing_ = spacing;
    add(BulletModel::massSpring, false, true);
    for (const BulletModel model : {BulletModel::linearElasticity, BulletModel::neoHookean}) {
      add(model, true, true);
      add(model, false, true);
      add(model, false, false);
    }
  }

  void engine(std::size_t size) try {
    const auto rest = bench::valueOf(buildEngineRest(scene_, size));
    const Vec3 u = engineAtRest(scene_, rest, scene_.stiff);
    const std::pair<Integrator, const char *> integrators[] = {{Integrator::explicitVerlet, "explicit"},
                                                               {Integrator::implicitSdirk, "implicit, second order"},
                                                               {Integrator::backwardEuler, "implicit, backward Euler"}};
    for (const auto &[integrator, name] : integrators) {
      const auto make = [&, by = integrator](double dt) { return makeEngineBody(scene_, rest, scene_.soft, by, dt); };
      Row row;
      row.model = name;
      row.nodes = rest->phyxelCount();
      row.cost = run(make, integrator == Integrator::explicitVerlet ? 0.0 : kFrame, boundsOf(scene_), kBudgetMs);
      row.settled = u[2];
      finish(row, size);
    }
  } catch (const std::runtime_error &error) {
    report_.note("C3DE, " + std::to_string(size) + ": " + error.what());
  }

  [[nodiscard]] const std::vector<Row> &rows() const { return rows_; }
  /// At rest on the first mesh with setYoungsModulus() and setPoissonRatio() of the neo-Hookean force, m.
  [[nodiscard]] double asAsked() const { return asAsked_; }

 private:
  void finish(Row &row, std::size_t size) {
    row.wanted = size;
    row.error = scene_.truth != 0.0 ? row.settled / scene_.truth - 1.0 : NAN;
    addRow(report_, row);
    rows_.push_back(row);
  }

  /// Begins at the known shape: the same mesh with the other law, else the coarser mesh. The damping of the neo-Hookean
  /// force slows the approach and does not change its end, so it is off.
  double settled(const TetraMesh &mesh, BulletModel model, bool matched) {
    const auto body = makeBulletBody(
        mesh, scene_.stiff, BulletSettings{model, true, model == BulletModel::linearElasticity, matched}, kFrame);
    if (model != BulletModel::linearElasticity) {
      setBulletDisplacements(*body, rest_);
    } else if (!rest_.empty()) {
      const auto bound = pointbased::bindToCloud(mesh.nodes, restNodes_, pointbased::serialFor());
      std::vector<Vec3> u(mesh.nodes.size());
      pointbased::interpolateDisplacements(bound, restNodes_, rest_, u, pointbased::serialFor());
      setBulletDisplacements(*body, u);
    }
    const double displacement = relaxToRest(*body, 240);
    if (model == BulletModel::linearElasticity) {
      rest_ = bulletDisplacements(*body);
      restNodes_ = mesh.nodes;
    }
    return displacement;
  }

  const Scene &scene_;
  bench::Report &report_;
  std::vector<Row> rows_;
  std::map<std::string, int> hints_;
  double lastSpacing_ = 0.0, asAsked_ = NAN;
  std::vector<Vec3> rest_, restNodes_;
};

void compare(const bench::Options &options, bench::Report &report) {
  const std::filesystem::path organFile =
      options.text("--organ", (std::filesystem::path(C3DE_TEST_DATA) / "mesh/openhelp/Liver.stl").string());
  auto organ = hangingOrgan(organFile);
  if (options.has("--deck")) {
    const Scene scene = bench::valueOf(std::move(organ));
    std::ofstream file(options.text("--deck"));
    writeDeck(scene.mesh(options.count("--nodes", 8000)), scene.stiff, file);
    if (!file) throw std::runtime_error("cannot write " + options.text("--deck"));
    return;
  }
  report.fact("bullet", bulletVersion());
  report.note("peer: Bullet " + bulletVersion() + "\n\n" + kSettings);
  std::vector<Scene> scenes{cantilever()};
  if (organ) {
    for (const OrganTruth &known : kOrganTruths)
      if (known.file == organFile.filename().string()) {
        organ->truth = known.displacement;
        organ->origin = known.origin;
      }
    scenes.push_back(std::move(*organ));
  } else {
    report.note("SKIPPED: the organ. " + organ.error());
  }
  for (const Scene &scene : scenes) {
    if (scene.name.find(options.text("--only")) == std::string::npos) continue;
    char what[256];
    std::snprintf(what, sizeof what, "\ncost: E %g kPa; at rest: E %g kPa; nu %g, %g kg/m3; truth %.4f mm: %s",
                  1e-3 * scene.soft.youngsModulus, 1e-3 * scene.stiff.youngsModulus, scene.soft.poissonRatio,
                  scene.soft.density, 1e3 * scene.truth, scene.origin.empty() ? "UNKNOWN, so no errors" : "");
    report.note(what + scene.origin);
    beginRows(report, scene.name);
    Comparison comparison(scene, report);
    // Coarser bodies of this engine may already reach the error of the peer engine.
    for (const std::size_t size : {24, 100, 250}) comparison.engine(size);
    for (const std::size_t size : {500, 3000, 10000}) {
      if (size > 500 && options.has("--quick")) continue;
      comparison.bullet(size);
      comparison.engine(size);
    }
    report.note(
        "Bullet's neo-Hookean force with setYoungsModulus() and setPoissonRatio() as they are, 500 nodes: at "
        "rest " +
        std::to_string(1e3 * comparison.asAsked()) + " mm");
    report.fact("neo_hookean_unmatched_at_rest_m, " + scene.name, comparison.asAsked());
    addRatios(report, scene.name, comparison.rows());
  }
}

}  // namespace

int main(int argc, char **argv) {
  return bench::run("bench_peers",
                    {{"compare", "[--quick] [--organ FILE] [--only TEXT] [--deck DECK.inp] [--nodes N]", compare}},
                    argc, argv);
}
