// SPDX-License-Identifier: Apache-2.0
// Measures the cost of a whole frame of 1/60 s and of each of its stages.
//
//   bench_frame [--frames N] [--size WIDTHxHEIGHT] [--colours] [--only first_light|lattice_10000] [--json FILE]
//
// Two scenes pass through the program as they do in its window, without the window: read, built by the plugin, stepped,
// published, handed to the renderer, drawn by OpenGL into an offscreen buffer.
//   first_light     the default scene of the program
//   lattice_10000   an organ of 10 000 phyxels and 50 000 surfels that falls on a block in a box
// A step is a whole frame, in the substeps that stability needs, on one thread. The simulator's own stages are those of
// its report; "step, other" is the remainder of the step. In the program the step has its own thread: "solver" is that
// thread's share of the frame, "screen" the window's.
//
// A share is the median of a stage relative to the sum of step, publishing, handing over and drawing.
#include <epoxy/gl.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "c3de/core/platform.h"
#include "c3de/render/renderer.h"
#include "c3de/render_gl/gl_renderer.h"
#include "c3de/session/resources.h"
#include "c3de/session/session.h"
#include "c3de/session/simulator_access.h"

namespace {

using namespace c3de;
using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;

constexpr std::size_t kSurfels = 50'000;
constexpr std::size_t kUsualFrames = 90;  // the fall, the impact and the motion after it

struct Options {
  std::size_t frames = kUsualFrames;
  int width = 1280, height = 800;
  bool colours = false;
  std::string only, json;
};

[[noreturn]] void stop(const std::string &why) {
  std::fprintf(stderr, "bench_frame: %s\n", why.c_str());
  std::exit(1);
}

template <class T>
T orStop(Expected<T> value) {
  if (!value) stop(value.error().message);
  return std::move(*value);
}

Options optionsOf(int argc, char **argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string key = argv[i];
    if (key == "--colours") {
      options.colours = true;
      continue;
    }
    const char *value = i + 1 < argc ? argv[++i] : nullptr;
    bool good = value != nullptr;
    if (good && key == "--frames") {
      options.frames = static_cast<std::size_t>(std::strtoul(value, nullptr, 10));
      good = options.frames > 0;
    } else if (good && key == "--size") {
      good =
          std::sscanf(value, "%dx%d", &options.width, &options.height) == 2 && options.width > 0 && options.height > 0;
    } else if (good && key == "--only") {
      options.only = value;
    } else if (good && key == "--json") {
      options.json = value;
    } else {
      good = false;
    }
    if (good) continue;
    std::fprintf(stderr,
                 "usage: bench_frame [--frames N] [--size WIDTHxHEIGHT] [--colours] "
                 "[--only first_light|lattice_10000] [--json FILE]\n");
    std::exit(2);
  }
  return options;
}

/// A lobed ellipsoid, mm, as an OBJ file: the faces of a subdivided cube, projected outwards.
void writeOrgan(const std::filesystem::path &file, std::size_t vertices) {
  const int n = static_cast<int>(std::lround(std::sqrt((static_cast<double>(vertices) - 2.0) / 6.0)));
  std::map<std::array<int, 3>, std::size_t> numbers;
  std::ofstream out(file);
  const auto vertex = [&](const std::array<int, 3> &at) {
    const auto [found, isNew] = numbers.try_emplace(at, numbers.size() + 1);
    if (isNew) {
      // Equal angles, so that the triangles have about equal size.
      double d[3], length = 0.0;
      for (int a = 0; a < 3; ++a) {
        d[a] = std::tan((2.0 * at[static_cast<std::size_t>(a)] / n - 1.0) * std::atan(1.0));
        length += d[a] * d[a];
      }
      for (double &x : d) x /= std::sqrt(length);
      const double r = 1.0 + 0.12 * std::sin(3.0 * d[0] + 1.0) * std::cos(4.0 * d[2]) + 0.06 * d[1];
      out << "v " << 105.0 * r * d[0] << ' ' << 50.0 * r * d[1] << ' ' << 65.0 * r * d[2] << '\n';
    }
    return found->second;
  };
  std::vector<std::array<std::size_t, 3>> triangles;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const int side : {0, n})
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          const auto corner = [&](int di, int dj) {
            std::array<int, 3> at{};
            at[axis] = side;
            at[(axis + 1) % 3] = i + di;
            at[(axis + 2) % 3] = j + dj;
            return vertex(at);
          };
          const std::size_t a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
          const bool outwards = side == n;
          triangles.push_back(outwards ? std::array{a, b, c} : std::array{a, c, b});
          triangles.push_back(outwards ? std::array{a, c, d} : std::array{a, d, c});
        }
  for (const auto &t : triangles) out << "f " << t[0] << ' ' << t[1] << ' ' << t[2] << '\n';
  if (!out) stop("cannot write " + file.string());
}

std::filesystem::path writeLargeScene(const std::filesystem::path &folder) {
  writeOrgan(folder / "organ.obj", kSurfels);
  const std::filesystem::path block = orStop(session::findResource("meshes/obstacle_block.obj"));
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
  if (!out) stop("cannot write " + file.string());
  return file;
}

struct Samples {
  std::vector<double> ms;

  void time(const std::function<void()> &f) {
    const auto begin = Clock::now();
    f();
    ms.push_back(std::chrono::duration<double, std::milli>(Clock::now() - begin).count());
  }
  [[nodiscard]] double at(double part) const {
    std::vector<double> sorted = ms;
    std::sort(sorted.begin(), sorted.end());
    return sorted[std::min(sorted.size() - 1, static_cast<std::size_t>(part * static_cast<double>(sorted.size())))];
  }
};

/// An offscreen framebuffer.
class Target {
 public:
  Target(int width, int height) {
    glGenRenderbuffers(2, buffers_);
    glBindRenderbuffer(GL_RENDERBUFFER, buffers_[0]);
    glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, width, height);
    glBindRenderbuffer(GL_RENDERBUFFER, buffers_[1]);
    glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT24, width, height);
    glGenFramebuffers(1, &frame_);
    glBindFramebuffer(GL_FRAMEBUFFER, frame_);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, buffers_[0]);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, buffers_[1]);
    if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) stop("no framebuffer to draw into");
  }
  Target(const Target &) = delete;
  Target &operator=(const Target &) = delete;
  ~Target() {
    glDeleteFramebuffers(1, &frame_);
    glDeleteRenderbuffers(2, buffers_);
  }

 private:
  GLuint buffers_[2]{}, frame_ = 0;
};

Json reportOf(const c3de_simulator_v1 &table, c3de_object *simulator) {
  std::string text;
  c3de_sink sink{};
  sink.self = &text;
  sink.put = [](void *self, const void *bytes, std::uint64_t n) -> c3de_status {
    static_cast<std::string *>(self)->append(static_cast<const char *>(bytes), static_cast<std::size_t>(n));
    return C3DE_OK;
  };
  if (table.report(simulator, sink) < 0) stop("no report");
  return Json::parse(text);
}

struct Row {
  std::string name;
  double median_ms, p99_ms;
};

Json measure(const std::string &name, const std::filesystem::path &file, const Options &options) {
  auto context = orStop(render::OffscreenContext::create());
  auto renderer = orStop(render::createGlRenderer());
  session::SessionOptions sessionOptions;
  sessionOptions.threads = 1;
  sessionOptions.renderer = renderer.get();
  auto session = orStop(session::Session::create(sessionOptions));
  const session::ObjectRef simulator(orStop(session->createSimulator()));
  const c3de_simulator_v1 &table = *orStop(session::simulatorTable(simulator.get()));
  auto scene = orStop(scene::loadScene(file, &session->materials()));
  const std::string dt = "solver.dt=" + std::to_string(1.0 / 60.0);
  for (const std::string &assignment :
       {dt, std::string(options.colours ? "view.colour=von_mises" : "view.colour=material")})
    if (auto set = scene::applyOverride(scene, assignment, &session->materials()); !set) stop(set.error().message);
  if (auto done = session->populate(simulator.get(), scene, {}); !done) stop(done.error().message);
  // One reference for the program's simulation, which stays paused; the steps are requested below.
  simulator.get()->vt->retain(simulator.get());
  if (auto done = session->adopt(simulator.get(), name); !done) stop(done.error().message);

  const Target target(options.width, options.height);
  render::Camera camera;
  session->mainQueue().runFrame();
  session->plugins().syncScene();
  if (const auto bounds = session->sceneGraph().bounds())
    camera.fit(bounds->min, bounds->max, static_cast<double>(options.width) / options.height);

  Samples step, publish, view, draw, upload, bare;
  for (std::size_t frame = 0; frame < options.frames; ++frame) {
    step.time([&] {
      if (table.step(simulator.get()) < 0) stop("the simulation diverged");
    });
    publish.time([&] { table.publish(simulator.get()); });
    view.time([&] {
      session->mainQueue().runFrame();
      session->plugins().syncScene();
    });
    draw.time([&] {
      renderer->draw(camera, {0, 0, options.width, options.height});
      glFinish();
    });
    upload.ms.push_back(renderer->statistics().upload_ms);
    bare.ms.push_back(draw.ms.back() - upload.ms.back());
  }

  const Json report = reportOf(table, simulator.get());
  const Json &body = report["bodies"][0];
  std::printf("%s: %zu phyxels, %zu evaluation points, %zu surfels, %zu frames of 1/60 s, %d x %d, %s\n", name.c_str(),
              body["phyxels"].get<std::size_t>(), body["points"].get<std::size_t>(), body["surfels"].get<std::size_t>(),
              options.frames, options.width, options.height, renderer->description().c_str());
  const double solver = step.at(0.5) + publish.at(0.5), screen = view.at(0.5) + draw.at(0.5), whole = solver + screen;
  std::vector<Row> rows;
  double known = 0.0, surfels = 0.0, surfelsLate = 0.0;
  for (const auto &[stage, times] : report["stages"].items()) {
    const double median = times["median_ms"].get<double>(), late = times["p99_ms"].get<double>();
    rows.push_back({stage, median, late});
    if (stage == "surfels") {
      surfels = median;
      surfelsLate = late;
    } else {
      known += median;
    }
  }
  rows.push_back({"step, other", std::max(0.0, step.at(0.5) - known), 0.0});
  rows.push_back(
      {"publish, without surfels", publish.at(0.5) - surfels, std::max(0.0, publish.at(0.99) - surfelsLate)});
  rows.push_back({"handing over", view.at(0.5), view.at(0.99)});
  rows.push_back({"upload", upload.at(0.5), upload.at(0.99)});
  rows.push_back({"drawing", bare.at(0.5), bare.at(0.99)});
  rows.push_back({"= solver", solver, step.at(0.99) + publish.at(0.99)});
  rows.push_back({"= screen", screen, view.at(0.99) + draw.at(0.99)});
  Json stages = Json::object();
  std::printf("  %-26s %10s %10s %8s\n", "stage", "median ms", "p99 ms", "share");
  for (const Row &row : rows) {
    std::printf("  %-26s %10.3f %10.3f %7.1f%%\n", row.name.c_str(), row.median_ms, row.p99_ms,
                100.0 * row.median_ms / whole);
    stages[row.name] = {{"median_ms", row.median_ms}, {"p99_ms", row.p99_ms}, {"share", row.median_ms / whole}};
  }
  std::printf("  %-26s %10.3f\n\n", "frame", whole);
  return {{"scene", name},
          {"phyxels", body["phyxels"]},
          {"points", body["points"]},
          {"surfels", body["surfels"]},
          {"frames", options.frames},
          {"frame_ms", whole},
          {"stages", stages}};
}

}  // namespace

int main(int argc, char **argv) {
  const Options options = optionsOf(argc, argv);
  Json out = {{"machine", cpuName()}, {"physics_threads", 1}, {"scenes", Json::array()}};
  std::printf("%s\n", cpuName().c_str());
  if (options.only.empty() || options.only == "first_light")
    out["scenes"].push_back(measure("first_light", orStop(session::findResource("scenes/first_light.toml")), options));
  if (options.only.empty() || options.only == "lattice_10000") {
    const std::filesystem::path folder = std::filesystem::temp_directory_path() / "c3de_bench_frame";
    std::filesystem::create_directories(folder);
    const std::filesystem::path file = writeLargeScene(folder);
    out["scenes"].push_back(measure("lattice_10000", file, options));
    std::filesystem::remove_all(folder);
  }
  if (!options.json.empty()) {
    std::ofstream file(options.json);
    file << out.dump(2) << '\n';
    if (!file) stop("cannot write " + options.json);
  }
  return 0;
}
