// SPDX-License-Identifier: Apache-2.0
// Measures the cost of a frame of four views of an image: slices, warped slices, volume rendering at its interactive
// resolution and at rest. Only the drawing, into a framebuffer of the size of a window's views at 1280 x 800.
//
//   bench_images                 phantoms of two sizes
//   bench_images --scene FILE    a scene with an [image] while it plays; "head": brain_shift.toml
//   bench_images --scene living  a torso of many tissues, generated here, that plays on its own thread
#include <epoxy/gl.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <random>
#include <vector>

#include "bench/command_line.h"
#include "bench/report.h"
#include "bench/timing.h"
#include "c3de/render/image_renderer.h"
#include "c3de/render/renderer.h"
#include "c3de/render_gl/gl_renderer.h"
#include "c3de/session/resources.h"
#include "images_scene.h"

namespace {

using namespace c3de;
using namespace c3de::render;

using bench::kPaneHeight, bench::kPaneWidth;

/// A head-like shape with noise, -1000 … 1500 as in computed tomography.
std::vector<std::int16_t> voxelsOf(const std::array<std::size_t, 3> &size) {
  std::vector<std::int16_t> voxels;
  voxels.reserve(size[0] * size[1] * size[2]);
  std::uint32_t seed = 1;
  for (std::size_t k = 0; k < size[2]; ++k)
    for (std::size_t j = 0; j < size[1]; ++j)
      for (std::size_t i = 0; i < size[0]; ++i) {
        const auto c = [&](std::size_t a, std::size_t n) {
          return 2.2 * (static_cast<double>(n) / static_cast<double>(size[a]) - 0.5);
        };
        const double r = std::sqrt(c(0, i) * c(0, i) + c(1, j) * c(1, j) + c(2, k) * c(2, k));
        seed = seed * 1664525u + 1013904223u;
        const int noise = static_cast<int>(seed >> 26);
        voxels.push_back(static_cast<std::int16_t>((r > 1.0    ? -1000
                                                    : r > 0.92 ? 1100
                                                    : r > 0.86 ? 10
                                                               : 30 + static_cast<int>(20 * std::sin(9 * r))) +
                                                   noise));
      }
  return voxels;
}

class Target {
 public:
  Target() {
    glGenFramebuffers(1, &buffer_);
    glGenRenderbuffers(2, parts_);
    glBindFramebuffer(GL_FRAMEBUFFER, buffer_);
    const GLenum formats[] = {GL_RGBA8, GL_DEPTH_COMPONENT24}, points[] = {GL_COLOR_ATTACHMENT0, GL_DEPTH_ATTACHMENT};
    for (int i = 0; i < 2; ++i) {
      glBindRenderbuffer(GL_RENDERBUFFER, parts_[i]);
      glRenderbufferStorage(GL_RENDERBUFFER, formats[i], 2 * kPaneWidth, 2 * kPaneHeight);
      glFramebufferRenderbuffer(GL_FRAMEBUFFER, points[i], GL_RENDERBUFFER, parts_[i]);
    }
  }

 private:
  GLuint buffer_ = 0, parts_[2] = {0, 0};
};

struct Cost {
  double wall_ms, processor_ms;
};

}  // namespace

int main(int argc, char **argv) {
  bench::CommandLine line("bench_images");
  line.defaults.seconds = 2.0;
  std::string scenePath;
  line.add("--scene", "FILE|head|living", [&](const std::string &text) { scenePath = text; });
  if (const auto code = line.parse(argc, argv)) return *code;
  auto context = OffscreenContext::create();
  if (!context) {
    std::fprintf(stderr, "bench_images: %s\n", context.error().message.c_str());
    return 6;
  }
  auto made = createGlRenderer();
  if (!made) {
    std::fprintf(stderr, "bench_images: %s\n", made.error().message.c_str());
    return 6;
  }
  Renderer &renderer = **made;
  ImageRenderer &images = *renderer.images();
  const Target target;
  bench::Report report(line.name(), line.options());
  report.fact("graphics", renderer.description());
  if (scenePath == "living") {
    const std::filesystem::path folder =
        std::filesystem::temp_directory_path() / ("bench_images-" + std::to_string(std::random_device{}()));
    const auto done = bench::measureLiving(renderer, folder, line.options(), report);
    std::error_code ignored;
    std::filesystem::remove_all(folder, ignored);
    if (!done) {
      std::fprintf(stderr, "bench_images: %s\n", done.error().message.c_str());
      return 1;
    }
    return report.write();
  }
  if (!scenePath.empty()) {
    auto file = scenePath == "head" ? session::findResource("scenes/brain_shift.toml")
                                    : Expected<std::filesystem::path>(scenePath);
    const Expected<void> done =
        file ? bench::measureScene(renderer, *file, line.options(), report) : tl::unexpected(file.error());
    if (!done) {
      std::fprintf(stderr, "bench_images: %s\n", done.error().message.c_str());
      return 1;
    }
    return report.write();
  }
  report.table(
      "frames",
      {{"image", "image", 0}, {"what", "what is drawn", 0}, {"wall_ms", "ms", 2}, {"processor_ms", "CPU ms", 2}});

  for (const std::array<std::size_t, 3> &size : {std::array<std::size_t, 3>{181, 217, 181}, {512, 512, 200}}) {
    const std::string name =
        std::to_string(size[0]) + " x " + std::to_string(size[1]) + " x " + std::to_string(size[2]);
    const double in = size[0] > 300 ? 0.8 : 1.0, through = size[0] > 300 ? 1.5 : 1.0;
    const Vec3 extent{in * static_cast<double>(size[0]), in * static_cast<double>(size[1]),
                      through * static_cast<double>(size[2])};
    const Mat4 place{in, 0, 0, 0, 0, in, 0, 0, 0, 0, through, 0, -0.5 * extent[0], -0.5 * extent[1], -0.5 * extent[2],
                     1};
    const std::vector<std::int16_t> voxels = voxelsOf(size);
    const double before_ms = bench::wall_ms();
    auto image = images.addImage({{size, place}, VoxelType::int16, voxels.data(), 1.0, 0.0});
    glFinish();
    report.row({name, "upload", bench::wall_ms() - before_ms, nullptr});
    if (!image) return 6;
    // 4 mm nodes over the middle half: a brain.
    const auto nodes = static_cast<std::size_t>(0.15 * extent[0]);
    const double edge = 0.6 * extent[0] / static_cast<double>(nodes - 1);
    const GridGeometry grid{
        {nodes, nodes, nodes},
        {edge, 0, 0, 0, 0, edge, 0, 0, 0, 0, edge, 0, -0.3 * extent[0], -0.3 * extent[0], -0.3 * extent[0], 1}};
    std::vector<float> u(3 * nodes * nodes * nodes, 2.0f);
    auto displacement = images.addDisplacement(grid, u);
    if (!displacement) return 6;

    ImageScene scene;
    scene.look.image = *image;
    scene.look.window = 400;
    scene.look.level = 40;
    scene.volume.points = {
        {150.0, {0.55f, 0.25f, 0.15f, 0.0f}}, {400.0, {0.92f, 0.80f, 0.62f, 0.45f}}, {1200.0, {1, 1, 1, 0.9f}}};
    Camera camera;
    camera.upAxis = UpAxis::z;
    camera.fit(-0.5 * extent, 0.5 * extent, static_cast<double>(kPaneWidth) / kPaneHeight);
    const double scale = 1.04 * std::max(extent[1] / kPaneHeight, extent[0] / kPaneWidth);
    double offset = 0.0;
    const auto frame = [&] {
      offset = offset > 20.0 ? -20.0 : offset + 1.0;
      const Vec3 rights[] = {{scale, 0, 0}, {0, scale, 0}, {scale, 0, 0}},
                 downs[] = {{0, scale, 0}, {0, 0, -scale}, {0, 0, -scale}};
      scene.slices.clear();
      for (std::size_t v = 0; v < 3; ++v) {
        const Vec3 normal = (1.0 / (scale * scale)) * cross(rights[v], downs[v]);
        const Vec3 centre = offset * normal;
        images.drawSlice(
            scene.look, {centre - 0.5 * kPaneWidth * rights[v] - 0.5 * kPaneHeight * downs[v], rights[v], downs[v]},
            {static_cast<int>(v % 2) * kPaneWidth, static_cast<int>(v / 2) * kPaneHeight, kPaneWidth, kPaneHeight});
        scene.slices.push_back({centre, normal, {}});
      }
      images.setScene(scene);
      renderer.draw(camera, {kPaneWidth, kPaneHeight, kPaneWidth, kPaneHeight});
      glFinish();
    };
    const auto row = [&](const char *what, const std::function<void()> &f) {
      f();
      const double processor = bench::processor_ms();
      std::size_t runs = 0;
      const bench::Timing timing = bench::measure(line.options().seconds, [&] {
        f();
        ++runs;
      });
      report.row({name, what, timing.median_ms,
                  (bench::processor_ms() - processor) / static_cast<double>(std::max<std::size_t>(runs, 1))});
    };
    row("slices in four views", frame);
    scene.look.displacement = *displacement;
    row("slices, warped", frame);
    row("new displacement uploaded", [&] {
      images.setDisplacement(*displacement, u);
      frame();
    });
    scene.look.displacement = {};
    scene.showsVolume = true;
    row("slices + volume, moving", frame);
    scene.look.displacement = *displacement;
    row("slices + volume, warped, moving", frame);
    scene.volume.isMaximum = true;
    row("slices + MIP, warped, moving", frame);
    scene.volume.isMaximum = false;
    for (const bool isWarped : {false, true}) {
      scene.look.displacement = isWarped ? *displacement : Handle{};
      frame();
      const double start = bench::wall_ms(), processor = bench::processor_ms();
      double longest = 0.0;
      while (images.wantsRefinement()) {
        const double one = bench::wall_ms();
        renderer.draw(camera, {kPaneWidth, kPaneHeight, kPaneWidth, kPaneHeight});
        glFinish();
        longest = std::max(longest, bench::wall_ms() - one);
      }
      report.row({name, isWarped ? "until refined, warped" : "until refined", bench::wall_ms() - start,
                  bench::processor_ms() - processor});
      report.row({name, "  longest frame of it", longest, nullptr});
    }
    images.remove(*image);
    images.remove(*displacement);
  }
  return report.write();
}
