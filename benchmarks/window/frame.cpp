// SPDX-License-Identifier: Apache-2.0
#include <epoxy/gl.h>

#include <algorithm>
#include <fstream>

#include "bench/timing.h"
#include "c3de/session/resources.h"
#include "window/scene.h"

namespace bench {
namespace {

using namespace c3de;

constexpr int kSquares = 91;         // 50 000 surfels
constexpr std::size_t kFrames = 90;  // the fall, the impact and the motion after it

std::filesystem::path writeLargeScene(const std::filesystem::path &folder) {
  writeOrgan(folder / "organ.obj", kSquares);
  const std::filesystem::path block = valueOf(session::findResource("meshes/obstacle_block.obj"));
  std::filesystem::copy_file(block, folder / "block.obj", std::filesystem::copy_options::overwrite_existing);
  const std::filesystem::path file = folder / "lattice_10000.toml";
  std::ofstream out(file);
  out << "format = 1\ntitle = \"10 000 phyxels, 50 000 surfels\"\n"
         "[world]\ngravity = [0.0, -9.81, 0.0]\n"
         "box = { min = [-0.3, -0.0375, -0.2], max = [0.3, 0.4, 0.2] }\n"
         "[solver]\nintegrator = \"explicit\"\ndamping = 1.0\n"
         "[[body]]\nname = \"organ\"\nmesh = \"organ.obj\"\nmesh_unit = \"mm\"\nposition = [0.03, 0.11, 0.0]\n"
         "material = { law = \"neo_hookean\", youngs_modulus = 6e3, poisson_ratio = 0.45, density = 1060.0, "
         "viscosity = 5.0 }\nsampling = { count = 10000 }\n"
         "[[obstacle]]\nname = \"block\"\nmesh = \"block.obj\"\nmesh_unit = \"mm\"\nscale = 1.25\n"
         "rotation_deg = [0.0, 90.0, 0.0]\nposition = [0.0, 0.0, 0.0]\nfriction = 0.8\n";
  if (!out) throw std::runtime_error("cannot write " + file.string());
  return file;
}

// ms of a stage in each frame.
struct Samples {
  std::vector<double> ms;

  void time(const std::function<void()> &f) {
    const double begin_ms = wall_ms();
    f();
    ms.push_back(wall_ms() - begin_ms);
  }
};

nlohmann::json reportOf(const c3de_simulator_v1 &table, c3de_object *simulator) {
  std::string text;
  c3de_sink sink{};
  sink.self = &text;
  sink.put = [](void *self, const void *bytes, std::uint64_t n) -> c3de_status {
    static_cast<std::string *>(self)->append(static_cast<const char *>(bytes), static_cast<std::size_t>(n));
    return C3DE_OK;
  };
  if (table.report(simulator, sink) < 0) throw std::runtime_error("no report");
  return nlohmann::json::parse(text);
}

void measure(const std::string &name, const std::filesystem::path &file, const Options &options, Report &report) {
  int width = 1280, height = 800;
  if (options.has("--size") &&
      (std::sscanf(options.text("--size").c_str(), "%dx%d", &width, &height) != 2 || width <= 0 || height <= 0))
    throw std::invalid_argument("--size: WIDTHxHEIGHT");
  Canvas canvas(width, height);
  render::Renderer &renderer = canvas.renderer();
  PlayedScene played(renderer, file, 1,
                     {"solver.dt=" + std::to_string(1.0 / 60.0),
                      options.has("--colours") ? "view.colour=von_mises" : "view.colour=material"});
  played.adopt();
  render::Camera camera;
  played.sync();
  if (const auto bounds = played.session->sceneGraph().bounds())
    camera.fit(bounds->min, bounds->max, static_cast<double>(width) / height);

  const std::size_t frames = options.count("--frames", kFrames);
  Samples step, publish, view, draw, upload, bare;
  for (std::size_t frame = 0; frame < frames; ++frame) {
    step.time([&] {
      if (played.table->step(played.simulator()) < 0) throw std::runtime_error("the simulation diverged");
    });
    publish.time([&] { played.table->publish(played.simulator()); });
    view.time([&] { played.sync(); });
    draw.time([&] {
      renderer.draw(camera, {0, 0, width, height});
      glFinish();
    });
    upload.ms.push_back(renderer.statistics().upload_ms);
    bare.ms.push_back(draw.ms.back() - upload.ms.back());
  }

  const nlohmann::json results = reportOf(*played.table, played.simulator());
  const nlohmann::json &body = results["bodies"][0];
  report.note("\n" + name + ": " + body["phyxels"].dump() + " phyxels, " + body["points"].dump() +
              " evaluation points, " + body["surfels"].dump() + " surfels, " + std::to_string(frames) +
              " frames of 1/60 s, " + std::to_string(width) + " x " + std::to_string(height) + ", " +
              renderer.description());
  for (const char *key : {"phyxels", "points", "surfels"}) report.fact(name + ", " + key, body[key]);
  const Timing steps = summaryOf(step.ms), publishing = summaryOf(publish.ms), handing = summaryOf(view.ms),
               draws = summaryOf(draw.ms), uploads = summaryOf(upload.ms), drawing = summaryOf(bare.ms);
  const double solver = steps.median_ms + publishing.median_ms, screen = handing.median_ms + draws.median_ms;
  report.table("frame, " + name, "stage; median_ms=median ms; p99_ms=p99 ms; share_percent=share %:1");
  const auto row = [&](const std::string &stage, double median_ms, double p99_ms) {
    report.row({stage, median_ms, p99_ms, 100.0 * median_ms / (solver + screen)});
  };
  double known = 0.0, surfels = 0.0, surfelsLate = 0.0;
  for (const auto &[stage, times] : results["stages"].items()) {
    const double median = times["median_ms"].get<double>(), late = times["p99_ms"].get<double>();
    row(stage, median, late);
    if (stage == "surfels") {
      surfels = median;
      surfelsLate = late;
    } else {
      known += median;
    }
  }
  row("step, other", std::max(0.0, steps.median_ms - known), 0.0);
  row("publish, without surfels", publishing.median_ms - surfels, std::max(0.0, publishing.p99_ms - surfelsLate));
  row("handing over", handing.median_ms, handing.p99_ms);
  row("upload", uploads.median_ms, uploads.p99_ms);
  row("drawing", drawing.median_ms, drawing.p99_ms);
  row("= solver", solver, steps.p99_ms + publishing.p99_ms);
  row("= screen", screen, handing.p99_ms + draws.p99_ms);
  row("frame", solver + screen, 0.0);
}

}  // namespace

void measureFrame(const Options &options, Report &report) {
  const std::string only = options.text("--only");
  if (only.empty() || only == "first_light")
    measure("first_light", valueOf(session::findResource("scenes/first_light.toml")), options, report);
  if (only.empty() || only == "lattice_10000") {
    const TemporaryFolder folder;
    measure("lattice_10000", writeLargeScene(folder.path()), options, report);
  }
}

}  // namespace bench
