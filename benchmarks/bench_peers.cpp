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
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "c3de/core/platform.h"
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

#if defined(__clang__)
constexpr const char *kCompiler = "Clang " __clang_version__;
#elif defined(__GNUC__)
constexpr const char *kCompiler = "GCC " __VERSION__;
#elif defined(_MSC_VER)
constexpr const char *kCompiler = "MSVC";
#else
constexpr const char *kCompiler = "unknown";
#endif

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

struct Options {
  bool quick = false;
  std::string organ, only, json, deck;
  std::size_t nodes = 8000;
};

constexpr double kBudgetMs = 1500.0;  // of processor time for one run

Bounds boundsOf(const Scene &scene) {
  return {scene.size, scene.soft.density * scene.shape.volume * kGravity.norm() * scene.size};
}

class Comparison {
 public:
  explicit Comparison(const Scene &scene) : scene_(scene) {}

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

  void engine(std::size_t size) {
    const auto rest = buildEngineRest(scene_, size);
    if (!rest) {
      std::printf("C3DE, %zu: %s\n", size, rest.error().c_str());
      return;
    }
    const auto u = engineAtRest(scene_, *rest, scene_.stiff);
    if (!u) std::printf("C3DE, %zu: %s\n", size, u.error().c_str());
    const std::pair<Integrator, const char *> ways[] = {{Integrator::explicitVerlet, "explicit"},
                                                        {Integrator::implicitSdirk, "implicit, second order"},
                                                        {Integrator::backwardEuler, "implicit, backward Euler"}};
    for (const auto &[integrator, name] : ways) {
      const auto make = [&, way = integrator](double dt) {
        return makeEngineBody(scene_, *rest, scene_.soft, way, dt);
      };
      Row row;
      row.model = name;
      row.nodes = (*rest)->phyxelCount();
      row.cost = run(make, integrator == Integrator::explicitVerlet ? 0.0 : kFrame, boundsOf(scene_), kBudgetMs);
      row.settled = u ? (*u)[2] : NAN;
      finish(row, size);
    }
  }

  [[nodiscard]] const std::vector<Row> &rows() const { return rows_; }
  /// At rest on the first mesh with setYoungsModulus() and setPoissonRatio() of the neo-Hookean force, m.
  [[nodiscard]] double asAsked() const { return asAsked_; }

 private:
  void finish(Row &row, std::size_t size) {
    row.scene = scene_.name;
    row.wanted = size;
    row.error = scene_.truth != 0.0 ? row.settled / scene_.truth - 1.0 : NAN;
    printRow(row);
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
  std::vector<Row> rows_;
  std::map<std::string, int> hints_;
  double lastSpacing_ = 0.0, asAsked_ = NAN;
  std::vector<Vec3> rest_, restNodes_;
};

int usage() {
  std::fprintf(
      stderr,
      "usage: bench_peers [--quick] [--organ FILE] [--only TEXT] [--json FILE] [--deck DECK.inp [--nodes N]]\n");
  return 2;
}

}  // namespace

int main(int argc, char **argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string option = argv[i];
    if (option == "--quick") {
      options.quick = true;
    } else if (i + 1 >= argc) {
      return usage();
    } else if (option == "--organ") {
      options.organ = argv[++i];
    } else if (option == "--only") {
      options.only = argv[++i];
    } else if (option == "--json") {
      options.json = argv[++i];
    } else if (option == "--deck") {
      options.deck = argv[++i];
    } else if (option == "--nodes") {
      options.nodes = std::strtoul(argv[++i], nullptr, 10);
    } else {
      return usage();
    }
  }
  const std::filesystem::path organFile = options.organ.empty()
                                              ? std::filesystem::path(C3DE_TEST_DATA) / "mesh/openhelp/Liver.stl"
                                              : std::filesystem::path(options.organ);
  auto organ = hangingOrgan(organFile);
  if (!options.deck.empty()) {
    if (!organ) {
      std::fprintf(stderr, "bench_peers: %s\n", organ.error().c_str());
      return 7;
    }
    std::ofstream file(options.deck);
    writeDeck(organ->mesh(options.nodes), organ->stiff, file);
    return file ? 0 : 7;
  }

  std::printf("CPU: %s, 1 thread\nbuild: %s, %s\npeer: Bullet %s\n\n%s", c3de::cpuName().c_str(), kCompiler,
              C3DE_BENCH_BUILD, bulletVersion().c_str(), kSettings);
  std::vector<Scene> scenes{cantilever()};
  if (organ) {
    for (const OrganTruth &known : kOrganTruths)
      if (known.file == organFile.filename().string()) {
        organ->truth = known.displacement;
        organ->origin = known.origin;
      }
    scenes.push_back(std::move(*organ));
  } else {
    std::printf("\nSKIPPED: the organ. %s\n", organ.error().c_str());
  }
  const std::vector<std::size_t> sizes =
      options.quick ? std::vector<std::size_t>{500} : std::vector<std::size_t>{500, 3000, 10000};
  nlohmann::ordered_json rows = nlohmann::ordered_json::array(), ratios = nlohmann::ordered_json::object(),
                         asAsked = nlohmann::ordered_json::object();
  for (const Scene &scene : scenes) {
    if (scene.name.find(options.only) == std::string::npos) continue;
    char what[256];
    std::snprintf(what, sizeof what, "cost: E %g kPa; at rest: E %g kPa; nu %g, %g kg/m3; ",
                  1e-3 * scene.soft.youngsModulus, 1e-3 * scene.stiff.youngsModulus, scene.soft.poissonRatio,
                  scene.soft.density);
    printHead(scene.name, what + (scene.truth != 0.0 ? "truth " + std::to_string(1e3 * scene.truth) + " mm"
                                                     : std::string("truth UNKNOWN, so no errors")));
    Comparison comparison(scene);
    // Coarser bodies of this engine may already reach the error of the peer engine.
    for (const std::size_t size : {24, 100, 250}) comparison.engine(size);
    for (const std::size_t size : sizes) {
      comparison.bullet(size);
      comparison.engine(size);
    }
    std::printf("truth: %s\n", scene.origin.empty() ? "none" : scene.origin.c_str());
    std::printf(
        "Bullet's neo-Hookean force with setYoungsModulus() and setPoissonRatio() as they are, %zu nodes: at rest %.4f "
        "mm\n",
        sizes.front(), 1e3 * comparison.asAsked());
    nlohmann::ordered_json found = nlohmann::ordered_json::array();
    printRatios(comparison.rows(), found);
    ratios[scene.name] = found;
    asAsked[scene.name] = comparison.asAsked();
    for (const Row &row : comparison.rows()) rows.push_back(toJson(row));
  }
  if (!options.json.empty()) {
    const nlohmann::ordered_json json = {{"benchmark", "bench_peers"},
                                         {"cpu", c3de::cpuName()},
                                         {"threads", 1},
                                         {"compiler", kCompiler},
                                         {"build", C3DE_BENCH_BUILD},
                                         {"bullet", bulletVersion()},
                                         {"settings", kSettings},
                                         {"results", rows},
                                         {"ratios", ratios},
                                         {"neo_hookean_unmatched_at_rest_m", asAsked}};
    std::ofstream file(options.json);
    file << json.dump(2) << '\n';
    if (!file) {
      std::fprintf(stderr, "bench_peers: cannot write %s\n", options.json.c_str());
      return 7;
    }
  }
  return 0;
}
