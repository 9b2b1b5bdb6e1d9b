// SPDX-License-Identifier: Apache-2.0
// Makes the project's own organ and obstacles: make_organ organ|obstacle|cap OUTPUT.obj [SPACING_MM]
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

#include "c3de/geometry/mesh_io.h"
#include "c3de/geometry/mesh_writer.h"
#include "implicit_surface.h"
#include "shapes.h"

namespace {

using namespace c3de;

/// A block of 160 x 60 x 120 mm with edges rounded by 22 mm, for an organ to fall on along y.
double obstacle(const Vec3 &p) {
  constexpr double kRounding = 22.0;
  const Vec3 half{80, 30, 60};
  Vec3 outside{};
  double inside = -1e300;
  for (std::size_t k = 0; k < 3; ++k) {
    const double d = std::abs(p[k]) - (half[k] - kRounding);
    outside[k] = std::max(d, 0.0);
    inside = std::max(inside, d);
  }
  return norm(outside) + std::min(inside, 0.0) - kRounding;
}

/// Triangles between a lowest vertex, rings of vertices around z, and a highest one.
void closeRings(geometry::TriangleMesh &out, std::uint32_t sides, std::uint32_t rings) {
  const auto last = static_cast<std::uint32_t>(out.vertices.size() - 1);
  const std::uint32_t top = 1 + (rings - 1) * sides;
  for (std::uint32_t k = 0; k < sides; ++k) {
    const std::uint32_t l = (k + 1) % sides;
    out.triangles.push_back({0, 1 + l, 1 + k});
    for (std::uint32_t a = 1; a < top; a += sides) {
      out.triangles.push_back({a + k, a + l, a + sides + l});
      out.triangles.push_back({a + k, a + sides + l, a + sides + k});
    }
    out.triangles.push_back({last, top + k, top + l});
  }
}

/// The lower end of a ball, whose lowest point is the origin, as rings of corners on the ball; above it a cylinder that
/// is thicker than anything gets into it.
geometry::TriangleMesh cap(double radius, double width, double spacing) {
  constexpr std::uint32_t kSides = 48;
  const auto rings = static_cast<std::uint32_t>(std::ceil(width / spacing));
  geometry::TriangleMesh out;
  const auto heightAt = [&](double r) { return radius - std::sqrt(radius * radius - r * r); };
  out.vertices.push_back({0.0, 0.0, 0.0});
  for (std::uint32_t ring = 1; ring <= rings; ++ring)
    for (std::uint32_t k = 0; k < kSides; ++k) {
      const double r = width * ring / rings, angle = 6.283185307179586 * k / kSides;
      out.vertices.push_back({r * std::cos(angle), r * std::sin(angle), heightAt(r)});
    }
  for (std::uint32_t k = 0; k < kSides; ++k) {
    const Vec3 &rim = out.vertices[1 + (rings - 1) * kSides + k];
    out.vertices.push_back({rim[0], rim[1], width});
  }
  out.vertices.push_back({0.0, 0.0, width});
  closeRings(out, kSides, rings + 1);
  return out;
}

/// About the origin; triangles grow from its lowest point, where they are `finest` wide, to eight times that.
geometry::TriangleMesh ball(double radius, double finest) {
  constexpr std::uint32_t kSides = 48;
  constexpr double kPi = 3.141592653589793, kGrows = 0.3, kMost = 8.0;
  std::vector<double> angles{0.0};
  while (angles.back() < kPi)
    angles.push_back(angles.back() + finest / radius * std::clamp(angles.back() / kGrows, 1.0, kMost));
  const auto rings = static_cast<std::uint32_t>(angles.size() - 2);  // without the poles
  geometry::TriangleMesh out;
  out.vertices.push_back({0.0, 0.0, -radius});
  for (std::uint32_t ring = 1; ring <= rings; ++ring)
    for (std::uint32_t k = 0; k < kSides; ++k) {
      const double polar = kPi * angles[ring] / angles.back(), angle = 2.0 * kPi * k / kSides;
      out.vertices.push_back({radius * std::sin(polar) * std::cos(angle), radius * std::sin(polar) * std::sin(angle),
                              -radius * std::cos(polar)});
    }
  out.vertices.push_back({0.0, 0.0, radius});
  closeRings(out, kSides, rings);
  return out;
}

int fail(const std::string &why) {
  fmt::print(stderr, "make_organ: {}\nusage: make_organ organ|obstacle|cap|ball OUTPUT.obj [SPACING_MM]\n", why);
  return 2;
}

}  // namespace

int main(int argc, char **argv) {
  if (argc < 3 || argc > 4) return fail("a shape and an output file are expected");
  const std::string_view shape = argv[1];
  const bool isOrgan = shape == "organ", isCap = shape == "cap", isBall = shape == "ball";
  if (!isOrgan && !isCap && !isBall && shape != "obstacle")
    return fail(fmt::format("there is no shape '{}'; organ, obstacle, cap and ball are accepted", shape));
  double spacing = isOrgan ? 12.0 : isCap ? 0.75 : isBall ? 1.1 : 14.0;
  if (argc == 4) {
    const std::string_view text = argv[3];
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), spacing);
    if (error != std::errc() || end != text.data() + text.size() || !(spacing >= 0.5 && spacing <= 40.0))
      return fail(fmt::format("spacing '{}'; 0.5 to 40 mm are accepted", text));
  }
  const Vec3 half = isOrgan ? Vec3{140, 100, 120} : Vec3{115, 65, 95};
  auto raw = isCap    ? cap(60.0, 15.0, spacing)
             : isBall ? ball(50.0, spacing)
                      : tools::polygonise(isOrgan ? tools::liver : obstacle, {-1.0 * half, half}, spacing, 30);
  for (Vec3 &v : raw.vertices)
    for (double &x : v) x = std::round(x * 1e4) / 1e4;  // a tenth of a micrometre is enough, and the file stays small
  const auto built = geometry::buildMesh(std::move(raw), geometry::LengthUnit::millimetre);
  if (!built) return fail(built.error().message);
  const std::string comment =
      isOrgan
          ? fmt::format(
                "A liver-shaped organ of our own: blended ellipsoids, polygonised at {} mm by tools/make_organ.cpp.",
                spacing)
      : isBall ? fmt::format("A ball of 50 mm; triangles grow from {} mm at its lowest point, by tools/make_organ.cpp.",
                             spacing)
      : isCap
          ? fmt::format("The end of a ball of 60 mm, 30 mm wide, in rings of {} mm by tools/make_organ.cpp.", spacing)
          : fmt::format("A rounded block, 160 x 60 x 120 mm, polygonised at {} mm by tools/make_organ.cpp.", spacing);
  if (const auto saved = geometry::writeMesh(argv[2], built->mesh, {{}, comment}); !saved)
    return fail(saved.error().message);
  fmt::print("{}quality      {:.3f} (worst triangle, 1 is equilateral)\n", built->report.text(),
             tools::worstTriangleQuality(built->mesh));
  return 0;
}
