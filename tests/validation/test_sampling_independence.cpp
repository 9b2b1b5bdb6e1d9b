// SPDX-License-Identifier: Apache-2.0
// Organs of the data through the program: what they do may not depend on how many phyxels they are made of.
#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "c3de/core/platform.h"
#include "support/catch.h"
#include "validation_table.h"

namespace {

using Point = std::array<double, 3>;

struct Organ {
  const char *name, *file;
  double scale;  // of the file's unit, m
};
// The file carries no unit and is 6.5 units wide: made as wide as a liver.
constexpr Organ kLiver{"liver (SOFA)", "mesh/sofa/liver.obj", 0.03};

/// v lines of an OBJ file, m.
std::vector<Point> verticesOf(const std::filesystem::path &file, double scale) {
  std::ifstream in(file, std::ios::binary);
  std::vector<Point> out;
  for (std::string line, key; std::getline(in, line);) {
    std::istringstream words(line);
    Point x{};
    if (words >> key && key == "v" && words >> x[0] >> x[1] >> x[2]) out.push_back({scale * x[0], scale * x[1], scale * x[2]});
  }
  return out;
}

struct Response {
  double mean = 0.0;  // displacement over the probes, m
  double phyxels = 0.0, milliseconds = 0.0;
  std::string failure;
};

/// The lowest eighth (along x) is held; the rest sags, or is pulled by 1 N at its other end.
Response respond(const Organ &organ, const std::filesystem::path &mesh, const std::string &load, std::size_t count) {
  const std::vector<Point> vertices = verticesOf(mesh, organ.scale);
  double low = 1e9, high = -1e9;
  for (const Point &x : vertices) {
    low = std::min(low, x[0]);
    high = std::max(high, x[0]);
  }
  const double held = low + 0.125 * (high - low), pulled = high - 0.125 * (high - low);
  std::ostringstream scene;
  scene.precision(12);
  scene << "format = 1\n[world]\ngravity = [0.0, " << (load == "gravity" ? -9.81 : 0.0) << ", 0.0]\n"
        << "[solver]\nintegrator = \"quasistatic\"\n[[body]]\nname = \"organ\"\nmesh = '" << mesh.generic_string()
        << "'\nmesh_unit = \"m\"\nscale = " << organ.scale
        << "\nmaterial = { law = \"neo_hookean\", youngs_modulus = 2e4, poisson_ratio = 0.45, density = 1060.0 }\n"
        << "sampling = { count = " << count << " }\n[[fix]]\nbody = \"organ\"\nregion = { box = { min = [-10, -10, -10], max = ["
        << held << ", 10, 10] } }\n";
  if (load != "gravity")
    scene << "[[load]]\nbody = \"organ\"\nregion = { box = { min = [" << pulled
          << ", -10, -10], max = [10, 10, 10] } }\nforce = [0, -1, 0]\n";
  std::size_t probes = 0;
  for (const Point &x : vertices)
    if (x[0] > held)
      scene << "[[probe]]\nname = \"p" << probes++ << "\"\nbody = \"organ\"\nat = [" << x[0] << ", " << x[1] << ", " << x[2] << "]\n";
  const auto folder = testOutputFolder();
  const auto file = folder / "scene.toml", report = folder / "report.json";
  std::ofstream(file, std::ios::binary) << scene.str();
  std::filesystem::remove(report);

  Response response;
  const validation::Stopwatch watch;
  const auto result = c3de::runProcess({C3DE_PROGRAM, "run", file.string(), "--report", report.string(), "-q"}, 500.0);
  response.milliseconds = watch.milliseconds();
  if (!result || result->exitCode != 0) {
    response.failure = result ? result->errorOutput : result.error().message;
    return response;
  }
  std::ifstream in(report, std::ios::binary);
  const auto json = nlohmann::json::parse(in, nullptr, false);
  for (const auto &probe : json.at("probes")) {
    const auto x = probe.at("position_m").get<Point>(), X = probe.at("reference_m").get<Point>();
    response.mean += std::hypot(x[0] - X[0], x[1] - X[1], x[2] - X[2]) / static_cast<double>(probes);
  }
  response.phyxels = json.at("bodies").at(0).at("phyxels").get<double>();
  return response;
}

void compareSamplings(const Organ &organ, const std::vector<std::size_t> &counts) {
  C3DE_DATA_OR_SKIP(mesh, organ.file);
  for (const std::string load : {"gravity", "1 N"}) {
    std::vector<Response> responses;
    for (const std::size_t count : counts) {
      responses.push_back(respond(organ, mesh, load, count));
      if (responses.back().failure.empty()) continue;
      validation::noSolution(std::string(organ.name) + ", " + load + ", " + std::to_string(count) + " phyxels",
                             responses.back().failure.substr(0, 300));
      return;
    }
    const double finest = responses.back().mean;
    double before = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < counts.size(); ++i) {
      const bool thousand = counts[i] == 1000;
      validation::judge({.body = std::string(organ.name) + ", " + load + ", " + std::to_string(static_cast<int>(responses[i].phyxels)) + " phyxels",
                         .quantity = "mean displacement, m",
                         .truth = finest,
                         .ours = responses[i].mean,
                         .limit = thousand ? std::optional(0.03) : std::nullopt,
                         .milliseconds = responses[i].milliseconds});
      const double error = std::abs(responses[i].mean - finest);
      CHECK_NOFAIL(error <= before);
      if (error > before) validation::remark(std::string(organ.name) + ", " + load, "note: convergence is not monotone here");
      before = error;
    }
  }
}

}  // namespace

// 5 000 differ from 20 000 by less than 0.1 %.
TEST_CASE("a liver responds the same with 500, 1 000 and 5 000 phyxels", "[truth]") { compareSamplings(kLiver, {500, 1000, 5000}); }

// Four minutes: build/release/bin/test_truths "[long]"
TEST_CASE("a liver responds the same with 500 to 20 000 phyxels", "[.][long]") {
  compareSamplings(kLiver, {500, 1000, 2000, 5000, 10000, 20000});
}
