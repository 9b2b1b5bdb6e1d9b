// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "accuracy/questions.h"
#include "bench/bodies.h"
#include "bench/timing.h"
#include "c3de/geometry/mesh_io.h"
#include "mesh_body.h"
#include "pointbased/accuracy.h"
#include "pointbased/verification.h"
#include "thin_shapes.h"

namespace {

using namespace pointbased;
using bench::Report;

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
  const auto loaded = bench::valueOf(c3de::geometry::loadMesh(file, c3de::geometry::LengthUnit::millimetre));
  const c3de::geometry::Box box = loaded.report.box;
  const double mm = std::max({box.max[0] - box.min[0], box.max[1] - box.min[1], box.max[2] - box.min[2]});
  const double scale = mm > 5.0 && mm < 600.0 ? 1e-3 : 0.12 / mm;
  Organ out{file.stem().string(), {}};
  for (const c3de::Vec3 &v : loaded.mesh.vertices) out.surface.positions.emplace_back(scale * Vec3(v[0], v[1], v[2]));
  for (const c3de::Triangle &t : loaded.mesh.triangles) out.surface.triangles.push_back({t[0], t[1], t[2]});
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

class Judge {
 public:
  Judge(Report &report, double phyxels) : report_(report), phyxels_(phyxels) {}

  void judge(const Organ &organ) {
    const BodyShape shape = validation::meshShape(organ.surface);
    for (const Loading &loading : loadings(shape)) {
      const std::string name = organ.name + ", " + loading.name;
      try {
        judge(name, shape, loading);
      } catch (const std::runtime_error &error) {
        report_.note(name + ": " + error.what());
      }
    }
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
    const Constitution constitution = bench::elastic(6000.0, 0.45);
    BodyRecipe recipe;
    recipe.fixes = loading.fixes;
    const auto survey = bench::valueOf(surveyAccuracy({shape, recipe, constitution, {}, loading.gravity}, serialFor()));
    CostSetting setting;
    setting.speed = nominalSpeed();
    setting.surfels = shape.surface.positions.size();
    setting.world.integrator = Integrator::automatic;
    const SamplingChoice choice = chooseSampling(survey, constitution, setting, {AccuracyTarget::Kind::standard, 1.0});
    recipe.sampling.spacing = phyxels_ > 0.0 ? survey.spacingFor(phyxels_) : choice.spacing;
    const auto rest = bench::valueOf(buildRestState(shape, recipe, {}, serialFor()));
    const ErrorPrediction promised = predictError(survey, rest->spacing);

    WorldSettings worldSettings;
    worldSettings.gravity = loading.gravity;
    worldSettings.integrator = Integrator::quasiStatic;
    worldSettings.loadSteps = 3;
    const double begin = bench::processor_ms();
    bench::World world(std::make_unique<Body>(name, rest, constitution, serialFor()), worldSettings);
    world.solve();
    const double solve_ms = bench::processor_ms() - begin;
    VerifySettings settings;
    settings.maxPhyxels = kMaxOfFineReference;
    const auto verified = bench::valueOf(
        verify(verificationTarget(world.simulator, world.id), shape, recipe, serialFor(), {}, nullptr, settings));
    const double error = verified.percent(verified.error95);
    const bool isIn = error >= 100.0 * promised.low && error <= 100.0 * promised.high;
    ++judged_;
    inBand_ += isIn ? 1 : 0;
    silent_ += error > 10.0 && promised.likely < 0.1 ? 1 : 0;
    report_.row({name, rest->phyxelCount(), 1e3 * rest->spacing, 100.0 * promised.share, 100.0 * promised.low,
                 100.0 * promised.high, error, isIn ? "yes" : "NO", 1e3 * verified.largestDisplacement, solve_ms,
                 1e3 * verified.seconds});
  }

  Report &report_;
  double phyxels_ = 0.0;
  int judged_ = 0, inBand_ = 0, silent_ = 0;
};

}  // namespace

void bench::checkOrgans(const Options &options, Report &report) {
  const std::string only = options.text("--only");
  report.table("organs",
               "organ; phyxels; spacing_mm=spacing mm:2; promised_percent=promised %:2; low_percent=from:2; "
               "high_percent=to:2; verified_percent=verified %:2; in_band=in; largest_mm=largest mm:2; "
               "solve_ms=solve ms:0; verify_ms=verify ms:0");
  Judge judge(report, options.number("--phyxels", 0.0));
  for (const Organ &organ : madeOrgans())
    if (organ.name.find(only) != std::string::npos) judge.judge(organ);
  for (const std::filesystem::path file : options.texts("--mesh")) {
    if (file.stem().string().find(only) == std::string::npos) continue;
    try {
      judge.judge(organOf(file));
    } catch (const std::runtime_error &error) {
      report.note(file.string() + ": " + error.what());
    }
  }
  judge.sum();
}
