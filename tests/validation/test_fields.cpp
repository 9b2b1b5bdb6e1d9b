// SPDX-License-Identifier: Apache-2.0
// Tissue fields in slices against known states: det F and stress of bodies of the point-based plugin.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>

#include "c3de/core/platform.h"
#include "c3de/imaging/reading.h"
#include "c3de/session/body_displacement.h"
#include "c3de/session/point_fields.h"
#include "c3de/session/session.h"
#include "c3de/session/simulator_access.h"
#include "c3de/session/tissue_motion.h"
#include "support/catch.h"
#include "support/folders.h"

using namespace c3de;
using namespace c3de::session;

namespace {

constexpr double kLength_mm = 60.0, kWidth_mm = 40.0, kSpacing_mm = 5.0;

/// A block from 0 to 60, 40 and 40 mm in its own scene, solved completely.
class Block {
 public:
  explicit Block(const std::string &more) {
    const auto folder = std::filesystem::path(testOutputRoot()) / "validation";
    std::filesystem::create_directories(folder);
    std::ofstream mesh(folder / "fields_block.obj");
    for (const double x : {0.0, kLength_mm})
      for (const double y : {0.0, kWidth_mm})
        for (const double z : {0.0, kWidth_mm}) mesh << "v " << x << ' ' << y << ' ' << z << '\n';
    mesh << "f 1 2 4\nf 1 4 3\nf 5 7 8\nf 5 8 6\nf 1 5 6\nf 1 6 2\nf 3 4 8\nf 3 8 7\nf 1 3 7\nf 1 7 5\nf 2 6 8\nf 2 8 "
            "4\n";
    mesh.close();
    SessionOptions options;
    options.searchPlugins = false;
    options.pluginFiles = {std::filesystem::path(testPluginFolder()) / (std::string("pointbased") + pluginExtension())};
    session_ = std::move(*Session::create(options));
    const auto scene = scene::parseScene(
        "format = 1\n[solver]\nintegrator = \"quasistatic\"\n[[body]]\nname = \"block\"\nmesh = \"fields_block.obj\"\n"
        "mesh_unit = \"mm\"\nsampling = { spacing = 0.005 }\n" +
            more,
        folder / "fields.toml", &session_->materials());
    if (!scene) FAIL(scene.error().message);
    simulator_ = std::make_unique<ObjectRef>(*session_->createSimulator());
    if (const auto built = session_->populate(simulator_->get(), *scene, {}); !built) FAIL(built.error().message);
    for (c3de_sim_status status = statusNow(); status.finished == 0; status = statusNow())
      REQUIRE(table()->step(simulator_->get()) >= 0);
  }

  /// As in the window: half a spacing, with a rim of 10 mm, on an image of 1 mm.
  [[nodiscard]] imaging::DisplacementGrid grid(const RequestedFields &wanted) {
    imaging::DisplacementGrid u;
    imaging::FollowingGrid following;
    const PresentBodies present = presentBodies(table(), simulator_->get());
    following.follow(present.box, present.spacing_mm, 10.0);
    u.geometry = following.geometry();
    u.bodies = referenceBodies(simulator_->get(),
                               {{100, 80, 80}, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -19.5, -19.5, -19.5, 1}});
    REQUIRE(readDisplacement(table(), simulator_->get(), 10.0, u));
    addFields(table(), simulator_->get(), wanted, u);
    return u;
  }
  [[nodiscard]] const c3de_simulator_v1 *table() const { return *simulatorTable(simulator_->get()); }
  [[nodiscard]] c3de_object *object() const { return simulator_->get(); }

 private:
  [[nodiscard]] c3de_sim_status statusNow() const {
    c3de_sim_status status{};
    status.size = sizeof status;
    REQUIRE(table()->status(simulator_->get(), &status) >= 0);
    return status;
  }
  std::unique_ptr<Session> session_;
  std::unique_ptr<ObjectRef> simulator_;
};

struct Miss {
  double most = 0.0, squares = 0.0;
  std::size_t places = 0, unknown = 0;
  void add(std::optional<double> value, double truth) {
    if (!value) return void(++unknown);
    most = std::max(most, std::abs(*value - truth));
    squares += (*value - truth) * (*value - truth);
    ++places;
  }
  [[nodiscard]] double rms() const { return std::sqrt(squares / static_cast<double>(places)); }
};

/// Over current positions of the body, every 1.7 mm of the reference, from half a millimetre below its faces on.
template <class Now, class See>
void forPlaces(const Now &now, const See &see) {
  for (double X = 0.5; X < kLength_mm; X += 1.7)
    for (double Y = 0.5; Y < kWidth_mm; Y += 1.7)
      for (double Z = 0.5; Z < kWidth_mm; Z += 1.7) see(Vec3{X, Y, Z}, now(Vec3{X, Y, Z}));
}

/// The same from the gradients at the simulator's points.
imaging::TissueField ratiosOfPoints(const Block &block, const imaging::VolumeGeometry &grid) {
  c3de_handle body{};
  REQUIRE(block.table()->body_at(block.object(), 0, &body) >= 0);
  c3de_sim_body_info info{};
  info.size = sizeof info;
  REQUIRE(block.table()->body_info(block.object(), body, &info) >= 0);
  std::vector<double> F(9 * info.points), x(3 * info.points), J;
  const auto read = [&](const char *name, std::vector<double> &out, std::uint32_t components) {
    const c3de_mview view{out.data(), info.points, components, C3DE_F64, 0};
    REQUIRE(block.table()->read_field(block.object(), body, C3DE_SIM_ON_POINTS, {name, std::strlen(name)}, view) >= 0);
  };
  read("deformation_gradient", F, 9);
  read(C3DE_SIM_FIELD_POSITION, x, 3);
  imaging::MaterialPoints points;
  for (std::size_t i = 0; i < info.points; ++i) {
    const double *f = &F[9 * i];
    J.push_back(dot(Vec3{f[0], f[1], f[2]}, cross(Vec3{f[3], f[4], f[5]}, Vec3{f[6], f[7], f[8]})));
    points.at_mm.push_back({1e3 * x[3 * i], 1e3 * x[3 * i + 1], 1e3 * x[3 * i + 2]});
    points.reach_mm.push_back(1.5 * kSpacing_mm);
  }
  return {"of points", "1", imaging::scatterToGrid(grid, points, J)};
}

void print(const char *state, const char *how, const Miss &miss) {
  std::printf("%-22s %-24s largest error %.2e, rms %.2e, %zu places, %zu without\n", state, how, miss.most, miss.rms(),
              miss.places, miss.unknown);
}

}  // namespace

TEST_CASE("A block that is compressed by a tenth has det F 0.9 and the stress of it everywhere", "[fields]") {
  // Without lateral strain and corotated, so that stress is Young's modulus times strain, 1 kPa: uniaxial, and so is
  // stress_vm.
  Block block(
      "material = { law = \"corotated\", youngs_modulus = 1e4, poisson_ratio = 0.0 }\n"
      "[[fix]]\nregion = { box = { min = [-1, -1, -1], max = [0.0001, 1, 1] } }\n"
      "[[fix]]\nregion = { box = { min = [0.0599, -1, -1], max = [1, 1, 1] } }\ndisplacement = [-0.006, 0, 0]\n");
  const imaging::DisplacementGrid u = block.grid({true, "stress_vm"});
  REQUIRE(u.fields.size() == 2);
  const imaging::TissueField ofPoints = ratiosOfPoints(block, u.geometry);
  Miss ratio, points, stress;
  forPlaces(
      [](const Vec3 &X) {
        return Vec3{0.9 * X[0], X[1], X[2]};
      },
      [&](const Vec3 &, const Vec3 &x) {
        ratio.add(u.valueOf(u.fields[0], x), 0.9);
        points.add(u.valueOf(ofPoints, x), 0.9);
        stress.add(u.valueOf(u.fields[1], x), 1e3);
      });
  print("uniform, det F", "grid", ratio);
  print("uniform, det F", "points", points);
  print("uniform, stress / Pa", "points", stress);
  CHECK(ratio.unknown == 0);
  CHECK(stress.unknown == 0);
  // Displacements of single precision, and solved to 1e-6 of the spacing.
  CHECK(ratio.most < 1e-5);
  CHECK(stress.most < 0.1);
  for (const Vec3 &beside : {Vec3{57, 20, 20}, Vec3{-2, 20, 20}, Vec3{20, 42, 20}}) {
    CHECK_FALSE(u.valueOf(u.fields[0], beside));
    CHECK_FALSE(u.valueOf(u.fields[1], beside));
  }
}

TEST_CASE("A block that hangs is stretched in proportion to what hangs below", "[fields]") {
  // Without lateral strain: F = 1 + 0.2 (1 - X / L) by weight over stiffness, 1000 * 9.81 * 0.06 / 2943.
  constexpr double kMost = 0.2;
  Block block(
      "material = { law = \"corotated\", youngs_modulus = 2943, poisson_ratio = 0.0, density = 1000 }\n"
      "[world]\ngravity = [9.81, 0, 0]\n"
      "[[fix]]\nregion = { box = { min = [-1, -1, -1], max = [0.0001, 1, 1] } }\n");
  const imaging::DisplacementGrid u = block.grid({true, "stress_vm"});
  const imaging::TissueField ofPoints = ratiosOfPoints(block, u.geometry);
  Miss ratio, points, stress;
  forPlaces(
      [](const Vec3 &X) {
        return Vec3{X[0] + kMost * (X[0] - X[0] * X[0] / (2.0 * kLength_mm)), X[1], X[2]};
      },
      [&](const Vec3 &X, const Vec3 &x) {
        const double F = 1.0 + kMost * (1.0 - X[0] / kLength_mm);
        ratio.add(u.valueOf(u.fields[0], x), F);
        points.add(u.valueOf(ofPoints, x), F);
        stress.add(u.valueOf(u.fields[1], x), 2943.0 * (F - 1.0));
      });
  print("hanging, det F", "grid", ratio);
  print("hanging, det F", "points", points);
  print("hanging, stress / Pa", "points", stress);
  // Half a spacing is a 24th of the length, along which det F falls by 0.2. One-sided differences at the ends have an
  // error of that size, and the mean of points about a surface that of the half spacing by which they are below it.
  CHECK(ratio.most < 0.2 / 24.0);
  CHECK(stress.most < 2943.0 * 0.2 / 24.0);
  // The reason why det F is not computed from the points.
  CHECK(ratio.rms() < points.rms());
}

TEST_CASE("What fields and the table of a body of 61 labels cost", "[.cost]") {
  C3DE_DATA_OR_SKIP(image, "volume/totalseg/example_ct.nii.gz");
  C3DE_DATA_OR_SKIP(labels, "volume/totalseg/example_seg_fast_force_split.nii.gz");
  for (const char *count : {"3000", "12000"}) {
    SessionOptions options;
    options.searchPlugins = false;
    options.pluginFiles = {std::filesystem::path(testPluginFolder()) / (std::string("pointbased") + pluginExtension())};
    options.threads = 1;
    const auto session = std::move(*Session::create(options));
    const auto scene = scene::parseScene(
        "format = 1\n[world]\ngravity = [0, -9.81, 0]\nscan_gravity = [0, 9.81, 0]\n[[body]]\nname = \"scan\"\nvolume "
        "= \"" +
            labels.generic_string() + "\"\ntissues = \"known\"\nbackground = { material = \"fat\", image = \"" +
            image.generic_string() +
            "\", from = -150, to = 250 }\nmend = { largest = true }\nsampling = { count = " + count + " }\n",
        "cost.toml", &session->materials());
    if (!scene) FAIL(scene.error().message);
    const ObjectRef simulator(*session->createSimulator());
    Prepared prepared;
    if (const auto built = session->populate(simulator.get(), *scene, {}, &prepared); !built)
      FAIL(built.error().message);
    const c3de_simulator_v1 *table = *simulatorTable(simulator.get());
    for (int i = 0; i < 400; ++i) REQUIRE(table->step(simulator.get()) >= 0);
    const auto timed = [&](const char *what, const auto &act) {
      double least = 1e9;
      for (int i = 0; i < 3; ++i) {
        const auto from = std::chrono::steady_clock::now();
        act();
        least =
            std::min(least, std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - from).count());
      }
      std::printf("%6s points, %-46s %8.1f ms\n", count, what, least);
    };
    const auto shared = std::make_shared<imaging::DisplacementGrid>();
    imaging::DisplacementGrid &u = *shared;
    imaging::FollowingGrid following;
    const PresentBodies present = presentBodies(table, simulator.get());
    following.follow(present.box, present.spacing_mm, 10.0);
    u.geometry = following.geometry();
    const auto volume = imaging::readVolume(image, {});
    REQUIRE(volume);
    u.bodies = referenceBodies(simulator.get(), volume->volume.geometry);
    timed("displacement of the window", [&] { REQUIRE(readDisplacement(table, simulator.get(), 10.0, u)); });
    timed("det F on its grid", [&] { (void)imaging::volumeRatios(u); });
    timed("det F and stress", [&] {
      u.fields.clear();
      addFields(table, simulator.get(), {true, "stress_vm"}, u);
    });
    std::printf("%6s points, grid of %zu x %zu x %zu\n", count, u.geometry.size[0], u.geometry.size[1],
                u.geometry.size[2]);
    TissueSnapshot snapshot;
    timed("reading for the table", [&] { snapshot = std::move(*readTissues(table, simulator.get())); });
    std::vector<TissueMotion> full;
    timed("following the labels", [&] { full = std::move(*followTissues(snapshot, prepared.tissues)); });
    const auto compare = [&](const char *how) {
      std::vector<TissueMotion> live;
      timed("following the labels of it", [&] { live = std::move(*followTissues(snapshot, prepared.tissues)); });
      double mean_mm = 0.0, largest_mm = 0.0, ratio = 0.0, change = 0.0, most_mm = 0.0;
      std::size_t lost = 0;
      for (std::size_t i = 0; i < full[0].labels.size(); ++i) {
        const LabelMotion &a = full[0].labels[i], &b = live[0].labels[i];
        if (a.isKnown() && !b.isKnown()) ++lost;
        if (!a.isKnown() || !b.isKnown()) continue;
        most_mm = std::max(most_mm, 1e3 * a.largestDisplacement_m);
        mean_mm = std::max(mean_mm, 1e3 * std::abs(a.meanDisplacement_m() - b.meanDisplacement_m()));
        largest_mm = std::max(largest_mm, 1e3 * std::abs(a.largestDisplacement_m - b.largestDisplacement_m));
        ratio = std::max(ratio, std::abs(a.minJ - b.minJ));
        change = std::max(change, 100.0 * std::abs(a.end_m3 - b.end_m3) / a.reference_m3);
      }
      std::printf(
          "%6s points, %s against full: mean %.3f mm, largest %.2f of %.1f mm, volume %.2f %%, det F %.3f, %zu labels "
          "lost\n",
          count, how, mean_mm, largest_mm, most_mm, change, ratio, lost);
      std::printf("%6s points, grid of %zu x %zu x %zu\n", count, snapshot.u->geometry.size[0],
                  snapshot.u->geometry.size[1], snapshot.u->geometry.size[2]);
    };
    timed("reading for the live table, without image",
          [&] { snapshot = std::move(*readTissues(table, simulator.get(), TissueDetail::live)); });
    compare("live, without image,");
    timed("reading for the live table, beside an image",
          [&] { snapshot = std::move(*readTissues(simulator.get(), shared)); });
    compare("live, beside an image,");
  }
}
