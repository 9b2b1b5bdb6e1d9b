// SPDX-License-Identifier: Apache-2.0
// Organs through the program: their response must not depend on the number of their phyxels.
#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "c3de/core/platform.h"
#include "support/catch.h"
#include "validation_table.h"

namespace {

using Point = std::array<double, 3>;

struct Organ {
  const char *name;
  std::filesystem::path mesh;
  double scale;        // of the file's unit, m
  int axis;            // its lowest eighth along it is held
  std::size_t stride;  // stride of the checked vertices
};

/// v lines of an OBJ file, m.
std::vector<Point> verticesOf(const std::filesystem::path &file, double scale) {
  std::ifstream in(file, std::ios::binary);
  std::vector<Point> out;
  for (std::string line, key; std::getline(in, line);) {
    std::istringstream words(line);
    Point x{};
    if (words >> key && key == "v" && words >> x[0] >> x[1] >> x[2])
      out.push_back({scale * x[0], scale * x[1], scale * x[2]});
  }
  return out;
}

struct Response {
  double mean = 0.0;  // displacement over the probes, m
  double phyxels = 0.0, milliseconds = 0.0;
  std::string failure;
};

/// A closed surface with two hemispheres, a fissure between them and furrows, as a height over directions from its
/// centre; 0.17 m long. Subdivided from an icosahedron.
std::filesystem::path writeBrain() {
  using Triangle = std::array<std::size_t, 3>;
  const double g = 0.5 * (1.0 + std::sqrt(5.0));
  std::vector<Point> points{{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                            {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  std::vector<Triangle> triangles{{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                                  {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                                  {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  const auto unit = [](const Point &x) {
    const double length = std::hypot(x[0], x[1], x[2]);
    return Point{x[0] / length, x[1] / length, x[2] / length};
  };
  for (Point &x : points) x = unit(x);
  for (int level = 0; level < 5; ++level) {
    std::map<std::pair<std::size_t, std::size_t>, std::size_t> middles;
    const auto middle = [&](std::size_t a, std::size_t b) {
      const auto [place, isNew] = middles.try_emplace({std::min(a, b), std::max(a, b)}, points.size());
      if (isNew) {
        const Point x = points[a], y = points[b];
        points.push_back(unit({x[0] + y[0], x[1] + y[1], x[2] + y[2]}));
      }
      return place->second;
    };
    std::vector<Triangle> finer;
    for (const auto &[a, b, c] : triangles) {
      const std::size_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      for (const Triangle &t : {Triangle{a, ab, ca}, Triangle{b, bc, ab}, Triangle{c, ca, bc}, Triangle{ab, bc, ca}})
        finer.push_back(t);
    }
    triangles = std::move(finer);
  }
  auto file = testOutputFolder() / "brain.obj";
  std::ofstream out(file, std::ios::binary);
  out.precision(12);
  for (const auto &[x, y, z] : points) {
    const double ellipsoid = 1.0 / std::hypot(x / 0.085, y / 0.065, z / 0.06);
    const double fissure = 1.0 - 0.35 * std::exp(-std::pow(y / 0.12, 2)) / (1.0 + std::exp(-8.0 * (z - 0.1)));
    const double furrows = 1.0 + 0.04 * std::sin(9 * x + 3 * std::sin(4 * y)) * std::sin(8 * z + 2 * std::sin(5 * x));
    const double r = ellipsoid * fissure * furrows;
    out << "v " << r * x << ' ' << r * y << ' ' << r * z << '\n';
  }
  for (const auto &[a, b, c] : triangles) out << "f " << a + 1 << ' ' << b + 1 << ' ' << c + 1 << '\n';
  return file;
}

/// The lowest eighth along the axis is held; the rest sags, or is pulled by 1 N at its other end.
Response respond(const Organ &organ, const std::string &load, std::size_t count) {
  const std::vector<Point> vertices = verticesOf(organ.mesh, organ.scale);
  const auto along = static_cast<std::size_t>(organ.axis);
  double low = 1e9, high = -1e9;
  for (const Point &x : vertices) {
    low = std::min(low, x[along]);
    high = std::max(high, x[along]);
  }
  const auto slab = [&](double from, double to) {
    Point min{-10, -10, -10}, max{10, 10, 10};
    min[along] = from;
    max[along] = to;
    std::ostringstream text;
    text.precision(12);
    text << "{ box = { min = [" << min[0] << ", " << min[1] << ", " << min[2] << "], max = [" << max[0] << ", "
         << max[1] << ", " << max[2] << "] } }";
    return text.str();
  };
  const double held = low + 0.125 * (high - low), pulled = high - 0.125 * (high - low);
  std::ostringstream scene;
  scene.precision(12);
  scene << "format = 1\n[world]\ngravity = [0.0, " << (load == "gravity" ? -9.81 : 0.0) << ", 0.0]\n"
        << "[solver]\nintegrator = \"quasistatic\"\n[[body]]\nname = \"organ\"\nmesh = '" << organ.mesh.generic_string()
        << "'\nmesh_unit = \"m\"\nscale = " << organ.scale
        << "\nmaterial = { law = \"neo_hookean\", youngs_modulus = 2e4, poisson_ratio = 0.45, density = 1060.0 }\n"
        << "sampling = { count = " << count << " }\n[[fix]]\nbody = \"organ\"\nregion = " << slab(-10.0, held) << "\n";
  if (load != "gravity")
    scene << "[[load]]\nbody = \"organ\"\nregion = " << slab(pulled, 10.0) << "\nforce = [0, -1, 0]\n";
  std::size_t probes = 0;
  for (std::size_t i = 0; i < vertices.size(); i += organ.stride)
    if (const Point &x = vertices[i]; x[along] > held)
      scene << "[[probe]]\nname = \"p" << probes++ << "\"\nbody = \"organ\"\nat = [" << x[0] << ", " << x[1] << ", "
            << x[2] << "]\n";
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
  for (const std::string load : {"gravity", "1 N"}) {
    std::vector<Response> responses;
    for (const std::size_t count : counts) {
      responses.push_back(respond(organ, load, count));
      if (responses.back().failure.empty()) continue;
      validation::noSolution(std::string(organ.name) + ", " + load + ", " + std::to_string(count) + " phyxels",
                             responses.back().failure.substr(0, 300));
      return;
    }
    const double finest = responses.back().mean;
    double before = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < counts.size(); ++i) {
      const bool thousand = counts[i] == 1000;
      validation::judge(std::string(organ.name) + ", " + load + ", " +
                            std::to_string(static_cast<int>(responses[i].phyxels)) + " phyxels",
                        "mean displacement, m",
                        {.truth = finest,
                         .ours = responses[i].mean,
                         .limit = thousand ? std::optional(0.03) : std::nullopt,
                         .milliseconds = responses[i].milliseconds});
      const double error = std::abs(responses[i].mean - finest);
      CHECK_NOFAIL(error <= before);
      if (error > before)
        validation::remark(std::string(organ.name) + ", " + load, "note: convergence is not monotone here");
      before = error;
    }
  }
}

}  // namespace

TEST_CASE("a liver responds the same with 500, 1 000 and 5 000 phyxels", "[truth]") {
  C3DE_DATA_OR_SKIP(mesh, "mesh/sofa/liver.obj");
  // The file has no unit and is 6.5 units wide: scaled to the width of a liver.
  compareSamplings({"liver (SOFA)", mesh, 0.03, 0, 1}, {500, 1000, 5000});
}

TEST_CASE("a brain responds the same with 500, 1 000 and 5 000 phyxels", "[truth][slow]") {
  compareSamplings({"brain (own shape)", writeBrain(), 1.0, 2, 40}, {500, 1000, 5000});
}

// Ten minutes: build/release/bin/test_truths "[long]"
TEST_CASE("a brain and a liver respond the same with 500 to 20 000 phyxels", "[.][long]") {
  compareSamplings({"brain (own shape)", writeBrain(), 1.0, 2, 40}, {500, 1000, 2000, 5000, 10000, 20000});
  C3DE_DATA_OR_SKIP(mesh, "mesh/sofa/liver.obj");
  compareSamplings({"liver (SOFA)", mesh, 0.03, 0, 1}, {500, 1000, 2000, 5000, 10000, 20000});
}
