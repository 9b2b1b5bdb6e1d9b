// SPDX-License-Identifier: Apache-2.0
// Measures the time from the start of the program to a responsive window, and from an organ's file to its first step.
//
//   xvfb-run -a -s "-screen 0 1280x800x24" bench_start [--program c3de] [--runs N] [--csv FILE] [--json FILE]
//
// window  c3de on its default scene: first frame, frame with the simulation ready to play, first step after --play
// organ   a scene with an organ of 30 000 triangles generated here and 3 000 phyxels on a lattice: the same frames, and
//         `c3de run` to the end of its first step, without a window
//
// Wall time is from the start of the process to the moment this program sees the frame in the file of
// --automation-state (polled every 2 ms; the program writes it at most 20 times a second). Processor time is the
// program's own, of all its threads, drawing included (there may be no graphics processor), so that other load has
// little effect. The first run is reported separately: files may have to be read from the disk.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <optional>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "bench/report.h"
#include "bench/timing.h"
#include "c3de/core/platform.h"

namespace {

using Json = nlohmann::json;

constexpr double kTimeout_s = 120.0;
constexpr int kRings = 101, kSegments = 150;  // 2 · 150 · 100 = 30 000 triangles

/// A closed, bumpy organ, mm.
void writeOrgan(const std::filesystem::path &file) {
  std::ofstream out(file);
  const auto point = [&](double t, double phi) {
    const double r = 60.0 * (1.0 + 0.12 * std::sin(2.0 * phi) * std::pow(std::sin(t), 2) + 0.1 * std::cos(3.0 * t));
    out << "v " << r * std::sin(t) * std::cos(phi) << ' ' << 0.7 * r * std::cos(t) << ' '
        << 0.8 * r * std::sin(t) * std::sin(phi) << '\n';
  };
  using std::numbers::pi;
  point(0.0, 0.0);
  for (int i = 1; i < kRings; ++i)
    for (int j = 0; j < kSegments; ++j) point(pi * i / kRings, 2.0 * pi * j / kSegments);
  point(pi, 0.0);
  const auto index = [](int i, int j) { return 2 + (i - 1) * kSegments + j % kSegments; };
  const int last = index(kRings, 0);
  const auto triangle = [&](int a, int b, int c) { out << "f " << a << ' ' << b << ' ' << c << '\n'; };
  for (int j = 0; j < kSegments; ++j) {
    triangle(1, index(1, j + 1), index(1, j));
    triangle(last, index(kRings - 1, j), index(kRings - 1, j + 1));
  }
  for (int i = 1; i < kRings - 1; ++i)
    for (int j = 0; j < kSegments; ++j) {
      triangle(index(i, j), index(i, j + 1), index(i + 1, j + 1));
      triangle(index(i, j), index(i + 1, j + 1), index(i + 1, j));
    }
}

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

c3de::Expected<Start> openWindow(const std::string &program, const std::filesystem::path &folder,
                                 const std::vector<std::string> &files) {
  const std::filesystem::path stateFile = folder / "state.json";
  std::error_code ignored;
  std::filesystem::remove(stateFile, ignored);
  std::vector<std::string> arguments{program, "--automation-state", stateFile.string(), "--play"};
  arguments.insert(arguments.end(), files.begin(), files.end());
  const double begin_ms = bench::wall_ms();
  auto child = c3de::ChildProcess::start(arguments, folder / "log.txt");
  if (!child) return tl::unexpected(child.error());
  Start start;
  while (bench::wall_ms() - begin_ms < 1e3 * kTimeout_s && child->isRunning()) {
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
  return tl::unexpected(
      c3de::Error{c3de::ErrorCode::internal, "no step was seen; see " + (folder / "log.txt").string()});
}

std::vector<bench::Column> columns() {
  return {{"what", "what                          "},
          {"first_wall_ms", "first run ms", 0},
          {"wall_ms", "median ms", 0},
          {"least_wall_ms", "least ms", 0},
          {"first_processor_ms", "first, proc. ms", 0},
          {"processor_ms", "proc. ms", 0},
          {"limit_ms", "wanted ms", 0}};
}

void row(bench::Report &report, const std::string &what, const std::vector<Moment> &all, bench::Report::Cell limit_ms) {
  std::vector<double> wall, processor;
  for (const Moment &m : all) {
    wall.push_back(m.wall_ms);
    processor.push_back(m.processor_ms);
  }
  const bench::Timing walls = bench::summaryOf(wall), processors = bench::summaryOf(processor);
  const bool known = processors.median_ms > 0.0;
  report.row({what, all.front().wall_ms, walls.median_ms, walls.least_ms,
              known ? bench::Report::Cell(all.front().processor_ms) : bench::Report::Cell(),
              known ? bench::Report::Cell(processors.median_ms) : bench::Report::Cell(), std::move(limit_ms)});
}

}  // namespace

int main(int argc, char **argv) {
  bench::CommandLine line("bench_start");
  std::string program = (c3de::executablePath().parent_path() / "c3de").string();
  int runs = 7;
  line.add("--program", "FILE", [&](const std::string &text) { program = text; });
  line.add("--runs", "N", [&](const std::string &text) { runs = std::max(1, std::atoi(text.c_str())); });
  if (const auto exit = line.parse(argc, argv)) return *exit;
  bench::Report report(line.name(), line.options());
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / "c3de_bench_start";
  std::filesystem::create_directories(folder);
  writeOrgan(folder / "organ.obj");
  writeScene(folder / "organ.toml");
  const std::string organ = (folder / "organ.toml").string();

  report.table("window", columns());
#ifndef _WIN32
  const bool display =
      !c3de::environmentVariable("DISPLAY").empty() || !c3de::environmentVariable("WAYLAND_DISPLAY").empty();
#else
  const bool display = true;
#endif
  if (!display) report.note("no display: start this with xvfb-run to measure windows");
  struct Case {
    const char *name;
    std::vector<std::string> files;
    double readyLimit_ms, stepLimit_ms;  // requested limits; 0: none
  };
  const Case cases[] = {{"default scene", {}, 1000.0, 0.0}, {"organ", {organ}, 0.0, 2000.0}};
  for (const Case &c : cases) {
    if (!display) break;
    std::vector<Moment> frames, ready, steps;
    for (int run = 0; run < runs; ++run) {
      const auto start = openWindow(program, folder, c.files);
      if (!start) {
        std::fprintf(stderr, "bench_start: %s\n", start.error().message.c_str());
        return 1;
      }
      frames.push_back(*start->frame);
      ready.push_back(start->ready.value_or(*start->step));
      steps.push_back(*start->step);
    }
    const auto limit = [](double ms) { return ms > 0.0 ? bench::Report::Cell(ms) : bench::Report::Cell(); };
    row(report, std::string(c.name) + ": first frame", frames, nullptr);
    row(report, std::string(c.name) + ": ready to play", ready, limit(c.readyLimit_ms));
    row(report, std::string(c.name) + ": first step", steps, limit(c.stepLimit_ms));
  }
  report.table("without a window", columns());
  std::vector<Moment> whole;
  for (int run = 0; run < runs; ++run) {
    const double begin_ms = bench::wall_ms();
    const auto done = c3de::runProcess({program, "run", organ, "--steps", "1", "-q"}, kTimeout_s);
    if (!done || done->exitCode != 0) {
      std::fprintf(stderr, "bench_start: %s\n", done ? done->errorOutput.c_str() : done.error().message.c_str());
      return 1;
    }
    whole.push_back({bench::wall_ms() - begin_ms, 0.0});
  }
  row(report, "organ: run --steps 1", whole, 2000.0);
  return report.write();
}
