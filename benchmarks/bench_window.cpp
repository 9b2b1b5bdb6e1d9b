// SPDX-License-Identifier: Apache-2.0
// Measures what a user of the window waits for.
//
//   bench_window frame                  a frame of 1/60 s and each of its stages
//   bench_window images                 four views of an image while its scene is stepped
//   bench_window living                 the same while a torso of many tissues plays on its own thread
//   xvfb-run -a -s "-screen 0 1280x800x24" bench_window start
//                                       the start of the program, and an organ's file up to its first step
//
// start: c3de on its default scene: first frame, frame with the simulation ready to play, first step after --play; on a
// scene with an organ of 30 000 triangles generated here and 3 000 phyxels on a lattice: the same frames, and `c3de run`
// to the end of its first step, without a window.
//
// Wall time is from the start of the process to the moment this program sees the frame in the file of
// --automation-state (polled every 2 ms; the program writes it at most 20 times a second). Processor time is the
// program's own, of all its threads, drawing included (there may be no graphics processor), so that other load has
// little effect. The first run is reported separately: files may have to be read from the disk.
#include <algorithm>
#include <chrono>
#include <fstream>
#include <optional>
#include <sstream>
#include <thread>

#include "bench/timing.h"
#include "c3de/core/platform.h"
#include "window/scene.h"

namespace {

using bench::Options;
using bench::Report;
using Json = nlohmann::json;

constexpr double kTimeout_s = 120.0;
void writeScene(const std::filesystem::path &file) {
  std::ofstream out(file);
  out << "format = 1\ntitle = \"organ\"\n[world]\ngravity = [0.0, -9.81, 0.0]\n[[body]]\nname = \"organ\"\n"
         "mesh = \"organ.obj\"\nmesh_unit = \"mm\"\nsampling = { count = 3000 }\n"
         "material = { law = \"neo_hookean\", youngs_modulus = 6e3, poisson_ratio = 0.45, density = 1060.0 }\n";
}

struct Moment {
  double wall_ms = 0.0, processor_ms = 0.0;
};
struct Start {
  std::optional<Moment> frame, ready, step;
};

Json readState(const std::filesystem::path &file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  // The file is replaced atomically, but may not exist yet.
  Json state = Json::parse(text.str(), nullptr, false);
  return state.is_object() ? state : Json::object();
}

Start openWindow(const std::string &program, const std::filesystem::path &folder,
                 const std::vector<std::string> &files) {
  const std::filesystem::path stateFile = folder / "state.json";
  std::error_code ignored;
  std::filesystem::remove(stateFile, ignored);
  std::vector<std::string> arguments{program, "--automation-state", stateFile.string(), "--play"};
  arguments.insert(arguments.end(), files.begin(), files.end());
  const double begin_ms = bench::wall_ms();
  auto child = bench::valueOf(c3de::ChildProcess::start(arguments, folder / "log.txt"));
  Start start;
  while (bench::wall_ms() - begin_ms < 1e3 * kTimeout_s && child.isRunning()) {
    const Json state = readState(stateFile);
    if (state.value("frame", 0) > 0) {
      const Moment now{bench::wall_ms() - begin_ms, 1e3 * state.value("processor_s", 0.0)};
      if (!start.frame) start.frame = now;
      const Json transport = state.value("transport", Json::object());
      if (!start.ready && transport.value("exists", false)) start.ready = now;
      if (transport.value("steps", 0) > 0) {
        start.step = now;
        return start;
      }
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  throw std::runtime_error("no step was seen; see " + (folder / "log.txt").string());
}

constexpr const char *kColumns =
    "what; first_wall_ms=first run ms:0; wall_ms=median ms:0; least_wall_ms=least ms:0; "
    "first_processor_ms=first, proc. ms:0; processor_ms=proc. ms:0; limit_ms=wanted ms:0";

void row(Report &report, const std::string &what, const std::vector<Moment> &all, Report::Cell limit_ms) {
  std::vector<double> wall, processor;
  for (const Moment &m : all) {
    wall.push_back(m.wall_ms);
    processor.push_back(m.processor_ms);
  }
  const bench::Timing walls = bench::summaryOf(wall), processors = bench::summaryOf(processor);
  const bool known = processors.median_ms > 0.0;
  report.row({what, all.front().wall_ms, walls.median_ms, walls.least_ms,
              known ? Report::Cell(all.front().processor_ms) : Report::Cell(),
              known ? Report::Cell(processors.median_ms) : Report::Cell(), std::move(limit_ms)});
}

void measureStart(const Options &options, Report &report) {
  const std::string program = options.text("--program", (c3de::executablePath().parent_path() / "c3de").string());
  const std::size_t runs = std::max<std::size_t>(1, options.count("--runs", 7));
  const bench::TemporaryFolder folder;
  bench::writeOrgan(folder.path() / "organ.obj", 50);
  writeScene(folder.path() / "organ.toml");
  const std::string organ = (folder.path() / "organ.toml").string();

#ifndef _WIN32
  const bool display =
      !c3de::environmentVariable("DISPLAY").empty() || !c3de::environmentVariable("WAYLAND_DISPLAY").empty();
#else
  const bool display = true;
#endif
  if (!display) report.note("no display: start this with xvfb-run to measure windows");
  report.table("window", kColumns);
  struct Case {
    const char *name;
    std::vector<std::string> files;
    double readyLimit_ms, stepLimit_ms;  // requested limits; 0: none
  };
  const Case cases[] = {{"default scene", {}, 1000.0, 0.0}, {"organ", {organ}, 0.0, 2000.0}};
  for (const Case &c : cases) {
    if (!display) break;
    std::vector<Moment> frames, ready, steps;
    for (std::size_t run = 0; run < runs; ++run) {
      const Start start = openWindow(program, folder.path(), c.files);
      frames.push_back(*start.frame);
      ready.push_back(start.ready.value_or(*start.step));
      steps.push_back(*start.step);
    }
    const auto limit = [](double ms) { return ms > 0.0 ? Report::Cell(ms) : Report::Cell(); };
    row(report, std::string(c.name) + ": first frame", frames, nullptr);
    row(report, std::string(c.name) + ": ready to play", ready, limit(c.readyLimit_ms));
    row(report, std::string(c.name) + ": first step", steps, limit(c.stepLimit_ms));
  }
  report.table("without a window", kColumns);
  std::vector<Moment> whole;
  for (std::size_t run = 0; run < runs; ++run) {
    const double begin_ms = bench::wall_ms();
    const auto done = bench::valueOf(c3de::runProcess({program, "run", organ, "--steps", "1", "-q"}, kTimeout_s));
    if (done.exitCode != 0) throw std::runtime_error(done.errorOutput);
    whole.push_back({bench::wall_ms() - begin_ms, 0.0});
  }
  row(report, "organ: run --steps 1", whole, 2000.0);
}

}  // namespace

int main(int argc, char **argv) {
  return bench::run("bench_window",
                    {{"frame", "[--frames N] [--size WIDTHxHEIGHT] [--colours] [--only first_light|lattice_10000]",
                      bench::measureFrame},
                     {"images", "[--scene FILE|head|torso] [--voxel MM]", bench::measureImages},
                     {"living", "", bench::measureLiving},
                     {"start", "[--program FILE] [--runs N]", measureStart}},
                    argc, argv);
}
