// SPDX-License-Identifier: Apache-2.0
// Compares the errors of organs at the default sampling with the predicted errors.
//
//   bench_organs [--mesh FILE]... [--only TEXT] [--phyxels N] [--csv FILE] [--json FILE]
//
// A ventricle, a hip bone, a gut and a vessel by formulas, and the named meshes (scaled to a length of 12 cm if their
// file has no unit that fits an organ), of 6 kPa and Poisson's ratio 0.45. Each
//   hangs    from its upper quarter
//   gripped  the ends of its longest axis are held, and one is moved across it by a tenth of its length
//   pinched  a region of the skin, a quarter of the length wide, is pulled out by as much, with one end held
// For each: the sampling that is chosen without an accuracy target (--phyxels: that one instead), its predicted error,
// and the difference to a solution of half the spacing by verify(), which is within a factor of 1.5 of the true error.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>

#include "bench/report.h"
#include "bench/timing.h"
#include "c3de/geometry/mesh_report.h"
#include "mesh_body.h"
#include "pointbased/accuracy.h"
#include "pointbased/simulator.h"
#include "pointbased/verification.h"
#include "thin_shapes.h"

namespace {

using namespace pointbased;

constexpr double kPi = 3.14159265358979323846;
constexpr std::size_t kMaxOfFineReference = 60'000;  // phyxels: half a minute

/// Half an ellipsoid with a cavity: 9 cm from base to apex, 7 cm wide, walls of 11 mm.
Surface ventricle() {
  constexpr int n = 20;
  constexpr double wall = 0.011, length = 0.09, radius = 0.035;
  // Along the outside from the apex to the base, and back along the inside.
  return validation::latheSurface(2 * n + 1, 48, [=](int ring, double phi) {
    const bool isOutside = ring <= n;
    const double t = 0.5 * kPi * (isOutside ? ring : 2 * n + 1 - ring) / n, thinner = isOutside ? 0.0 : wall;
    const double r = (radius - thinner) * std::sin(t);
    return Vec3(r * std::cos(phi), r * std::sin(phi), -(length - thinner) * std::cos(t));
  });
}

/// A ring with two plates: 24 cm wide; its plates are 12 mm thick.
Surface hipBone() {
  constexpr int around = 96, section = 24;
  Surface out;
  for (int i = 0; i < around; ++i)
    for (int k = 0; k < section; ++k) {
      const double phi = 2.0 * kPi * i / around, theta = 2.0 * kPi * k / section;
      const double wing = std::pow(std::abs(std::cos(phi)), 4);
      const double width = 0.010 + 0.045 * wing, thick = 0.010 - 0.004 * wing;  // m: half of those of the section
      const double across = thick * std::cos(theta), along = width * std::sin(theta);
      const double r = 0.07 + across + 0.6 * std::max(0.0, along) * wing;
      out.positions.emplace_back(1.2 * r * std::cos(phi), r * std::sin(phi), along + 0.03 * std::sin(2.0 * phi));
    }
  const auto vertex = [&](int i, int k) { return static_cast<Index>((i % around) * section + k % section); };
  for (int i = 0; i < around; ++i)
    for (int k = 0; k < section; ++k) {
      const Index a = vertex(i, k), b = vertex(i + 1, k), c = vertex(i + 1, k + 1), d = vertex(i, k + 1);
      out.triangles.push_back({a, b, c});
      out.triangles.push_back({a, c, d});
    }
  return out;
}

/// Bends a body along x into an S.
Surface wound(Surface surface, double height, double length) {
  for (Vec3 &x : surface.positions) x[1] += height * std::sin(2.0 * kPi * x[0] / length);
  return surface;
}

struct Organ {
  std::string name;
  Surface surface;
};

std::vector<Organ> madeOrgans() {
  return {{"ventricle", ventricle()},
          {"hip bone", hipBone()},
          {"gut", wound(validation::tubeSurface(0.015, 0.004, 0.2), 0.03, 0.2)},
          {"vessel", wound(validation::tubeSurface(0.004, 0.0012, 0.08), 0.008, 0.08)}};
}

Organ organOf(const std::filesystem::path &file) {
  const auto loaded = c3de::geometry::loadMesh(file, c3de::geometry::LengthUnit::millimetre);
  if (!loaded) throw std::runtime_error(loaded.error().message);
  const c3de::geometry::Box box = loaded->report.box;
  const double mm = std::max({box.max[0] - box.min[0], box.max[1] - box.min[1], box.max[2] - box.min[2]});
  const double scale = mm > 5.0 && mm < 600.0 ? 1e-3 : 0.12 / mm;
  Organ out{file.stem().string(), {}};
  for (const c3de::Vec3 &v : loaded->mesh.vertices) out.surface.positions.emplace_back(scale * Vec3(v[0], v[1], v[2]));
  for (const c3de::Triangle &t : loaded->mesh.triangles) out.surface.triangles.push_back({t[0], t[1], t[2]});
  return out;
}

struct Loading {
  std::string name;
  std::vector<Fix> fixes;
  Vec3 gravity = Vec3::Zero();
};

std::vector<Loading> loadings(const BodyShape &shape) {
  const Vec3 extent = shape.max - shape.min;
  Eigen::Index along = 0;
  extent.maxCoeff(&along);
  const Eigen::Index across = (along + 1) % 3;
  const auto beyond = [&](Eigen::Index axis, double part, double sign) {
    Fix fix;
    const Vec3 normal = -sign * Vec3::Unit(axis);
    Vec3 at = shape.min;
    at[axis] += part * extent[axis];
    fix.region = HalfSpaceRegion{at, normal};
    fix.ramp = 1.0;
    return fix;
  };
  Loading hangs{"hangs", {beyond(along, 0.75, 1.0)}, {}};
  hangs.gravity = -9.81 * Vec3::Unit(along);
  Loading gripped{"gripped", {beyond(along, 0.1, -1.0), beyond(along, 0.9, 1.0)}, {}};
  gripped.fixes[1].displacement = 0.1 * extent[along] * Vec3::Unit(across);
  // Where the skin is farthest from the axis.
  const Vec3 *out = &shape.surface.positions.front();
  for (const Vec3 &x : shape.surface.positions)
    if (x[across] > (*out)[across]) out = &x;
  Loading pinched{"pinched", {beyond(along, 0.2, -1.0), beyond(along, 0.2, -1.0)}, {}};
  pinched.fixes[1].region = SphereRegion{*out, 0.12 * extent[along]};
  pinched.fixes[1].displacement = 0.1 * extent[along] * Vec3::Unit(across);
  return {hangs, gripped, pinched};
}

Constitution tissue() {
  Material material;
  material.law = MaterialLaw::neoHookean;
  material.youngsModulus = 6000.0;
  material.poissonRatio = 0.45;
  material.restDensity = 1060.0;
  return {{material}, kLatticeStabilisation};
}

class Judge {
 public:
  Judge(bench::Report &report, double phyxels) : report_(report), phyxels_(phyxels) {}

  void judge(const Organ &organ) {
    const BodyShape shape = validation::meshShape(organ.surface);
    for (const Loading &loading : loadings(shape)) judge(organ.name + ", " + loading.name, shape, loading);
  }
  void sum() {
    report_.note("errors within their band: " + std::to_string(inBand_) + " of " + std::to_string(judged_) +
                 "; above 10 % without a word: " + std::to_string(silent_));
    report_.fact("in_band", inBand_);
    report_.fact("judged", judged_);
    report_.fact("silent_above_10_percent", silent_);
  }

 private:
  void judge(const std::string &name, const BodyShape &shape, const Loading &loading) {
    const Constitution constitution = tissue();
    BodyRecipe recipe;
    recipe.fixes = loading.fixes;
    const auto survey = surveyAccuracy({shape, recipe, constitution, {}, loading.gravity}, serialFor());
    if (!survey) return report_.note(name + ": could not be predicted: " + survey.error());
    CostSetting setting;
    setting.speed = nominalSpeed();
    setting.surfels = shape.surface.positions.size();
    setting.world.integrator = Integrator::automatic;
    SamplingChoice choice = chooseSampling(*survey, constitution, setting, {AccuracyTarget::Kind::standard, 1.0});
    recipe.sampling.spacing = phyxels_ > 0.0 ? survey->spacingFor(phyxels_) : choice.spacing;
    const auto rest = buildRestState(shape, recipe, {}, serialFor());
    if (!rest) return report_.note(name + ": " + rest.error());
    const ErrorPrediction promised = predictError(*survey, (*rest)->spacing);

    Simulator simulator;
    WorldSettings world;
    world.gravity = loading.gravity;
    world.integrator = Integrator::quasiStatic;
    world.loadSteps = 3;
    simulator.setWorld(world);
    const double begin = bench::processor_ms();
    const std::size_t id = simulator.addBody(std::make_unique<Body>(name, *rest, constitution, serialFor()));
    while (!simulator.finished())
      if (!simulator.step()) break;
    const double solve_ms = bench::processor_ms() - begin;
    if (simulator.body(id)->stopped) return report_.note(name + ": no rest was found");
    VerifySettings settings;
    settings.mostPhyxels = kMaxOfFineReference;
    const auto verified = verify(verificationTarget(simulator, id), shape, recipe, serialFor(), {}, nullptr, settings);
    if (!verified) return report_.note(name + ": not verified: " + verified.error());
    const double error = verified->percent(verified->error95);
    const bool isIn = error >= 100.0 * promised.low && error <= 100.0 * promised.high;
    ++judged_;
    inBand_ += isIn ? 1 : 0;
    silent_ += error > 10.0 && promised.likely < 0.1 ? 1 : 0;
    report_.row({name, (*rest)->phyxelCount(), 1e3 * (*rest)->spacing, 100.0 * promised.share, 100.0 * promised.low,
                 100.0 * promised.high, error, isIn ? "yes" : "NO", 1e3 * verified->largestDisplacement, solve_ms,
                 1e3 * verified->seconds});
  }

  bench::Report &report_;
  double phyxels_ = 0.0;
  int judged_ = 0, inBand_ = 0, silent_ = 0;
};

}  // namespace

int main(int argc, char **argv) {
  std::vector<std::filesystem::path> files;
  std::string only;
  double phyxels = 0.0;
  bench::CommandLine line("bench_organs");
  line.add("--mesh", "FILE", [&](const std::string &text) { files.emplace_back(text); });
  line.add("--only", "TEXT", [&](const std::string &text) { only = text; });
  line.add("--phyxels", "N", [&](const std::string &text) { phyxels = std::atof(text.c_str()); });
  if (const auto exit = line.parse(argc, argv)) return *exit;
  bench::Report report(line.name(), line.options());
  report.table("organs", {{"organ", "organ                    "},
                          {"phyxels", "phyxels"},
                          {"spacing_mm", "spacing mm", 2},
                          {"promised_percent", "promised %", 2},
                          {"low_percent", "from", 2},
                          {"high_percent", "to", 2},
                          {"verified_percent", "verified %", 2},
                          {"in_band", "in"},
                          {"largest_mm", "largest mm", 2},
                          {"solve_ms", "solve ms", 0},
                          {"verify_ms", "verify ms", 0}});
  Judge judge(report, phyxels);
  std::vector<Organ> organs = madeOrgans();
  for (const std::filesystem::path &file : files) {
    try {
      organs.push_back(organOf(file));
    } catch (const std::exception &error) {
      report.note(file.string() + ": " + error.what());
    }
  }
  for (const Organ &organ : organs) {
    if (organ.name.find(only) == std::string::npos) continue;
    try {
      judge.judge(organ);
    } catch (const std::exception &error) {
      report.note(organ.name + ": " + error.what());
    }
  }
  judge.sum();
  return report.write();
}
