// SPDX-License-Identifier: Apache-2.0
#include "window/scene.h"

#include <epoxy/gl.h>

#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <optional>
#include <random>

#include "c3de/imaging/writing.h"

namespace bench {

using namespace c3de;

namespace {

struct Organ {
  const char *label;
  std::int16_t hounsfield;
  Vec3 centre, radii;  // mm, LPS; z of a tube: half its length
  bool isTube = false;
};
// Later organs overwrite earlier ones.
constexpr double kChest = 150.0, kDepth = 105.0, kHeight = 150.0;
const Organ kOrgans[] = {
    {"lung_right", -800, {-70, 0, 75}, {55, 75, 70}},
    {"lung_left", -800, {70, 0, 75}, {55, 75, 70}},
    {"heart", 60, {15, -25, 65}, {45, 38, 48}},
    {"liver", 70, {-60, -10, -45}, {75, 70, 52}},
    {"spleen", 65, {95, 30, -40}, {28, 35, 42}},
    {"stomach", 40, {60, -35, -40}, {38, 40, 42}},
    {"pancreas", 45, {10, -5, -75}, {45, 14, 16}},
    {"kidney_right", 50, {-65, 55, -95}, {26, 24, 45}},
    {"kidney_left", 50, {65, 55, -90}, {26, 24, 45}},
    {"aorta", 120, {12, 38, 0}, {11, 11, 148}, true},
    {"vertebrae_L1", 500, {0, 68, 0}, {22, 24, 148}, true},
    {"rib_left_7", 700, {}, {}},
};
constexpr std::size_t kOrganCount = std::size(kOrgans);

bool isInside(const Organ &organ, const Vec3 &x) {
  const auto r = [&](std::size_t a) { return (x[a] - organ.centre[a]) / organ.radii[a]; };
  if (organ.isTube) return r(0) * r(0) + r(1) * r(1) < 1.0 && std::abs(r(2)) < 1.0;
  return r(0) * r(0) + r(1) * r(1) + r(2) * r(2) < 1.0;
}

/// 1 plus the index of the organ; 0: fat; none: surrounding air.
std::optional<std::size_t> organAt(const Vec3 &x) {
  const double r = std::hypot(x[0] / kChest, x[1] / kDepth);
  if (r > 1.0 || std::abs(x[2]) > kHeight) return std::nullopt;
  // Rings behind the skin.
  if (x[2] > -20.0 && r > 0.88 && r < 0.95 && std::fmod(x[2] + 200.0, 30.0) < 10.0) return kOrganCount;
  for (std::size_t i = kOrganCount - 1; i-- > 0;)
    if (isInside(kOrgans[i], x)) return i + 1;
  return 0;
}

template <class F>
void forVoxels(const imaging::VolumeGeometry &grid, const F &each) {
  for (std::size_t k = 0; k < grid.size[2]; ++k)
    for (std::size_t j = 0; j < grid.size[1]; ++j)
      for (std::size_t i = 0; i < grid.size[0]; ++i)
        each(grid.worldAt({static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)}));
}

imaging::VolumeGeometry gridOf(double edge_mm) {
  imaging::VolumeGeometry grid;
  const Vec3 half{kChest + 12.0, kDepth + 12.0, kHeight + 12.0};
  grid.indexToWorld = {edge_mm, 0, 0, 0, 0, edge_mm, 0, 0, 0, 0, edge_mm, 0, 0, 0, 0, 1};
  for (std::size_t a = 0; a < 3; ++a) {
    grid.size[a] = static_cast<std::size_t>(2.0 * half[a] / edge_mm);
    grid.indexToWorld[12 + a] = -half[a] + 0.5 * edge_mm;
  }
  return grid;
}

}  // namespace

Canvas::Canvas(int width, int height)
    : context_(valueOf(render::OffscreenContext::create())), renderer_(valueOf(render::createGlRenderer())) {
  glGenRenderbuffers(2, buffers_);
  glBindRenderbuffer(GL_RENDERBUFFER, buffers_[0]);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, width, height);
  glBindRenderbuffer(GL_RENDERBUFFER, buffers_[1]);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT24, width, height);
  glGenFramebuffers(1, &frame_);
  glBindFramebuffer(GL_FRAMEBUFFER, frame_);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, buffers_[0]);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, buffers_[1]);
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    throw std::runtime_error("no framebuffer to draw into");
}

Canvas::~Canvas() {
  glDeleteFramebuffers(1, &frame_);
  glDeleteRenderbuffers(2, buffers_);
}

PlayedScene::PlayedScene(render::Renderer &renderer, const std::filesystem::path &file, unsigned threads,
                         const std::vector<std::string> &overrides) {
  session::SessionOptions options;
  options.threads = threads;
  options.renderer = &renderer;
  session = valueOf(session::Session::create(options));
  simulator_ = session::ObjectRef(valueOf(session->createSimulator()));
  table = valueOf(session::simulatorTable(simulator()));
  scene = valueOf(scene::loadScene(file, &session->materials()));
  for (const std::string &assignment : overrides)
    valueOf(scene::applyOverride(scene, assignment, &session->materials()));
  valueOf(session::buildScene(*session, simulator(), scene, sources, {}, &prepared));
}

void PlayedScene::adopt() {
  simulator()->vt->retain(simulator());
  valueOf(session->adopt(simulator(), "scene"));
}

void PlayedScene::sync() {
  session->mainQueue().runFrame();
  session->plugins().syncScene();
}

void writeOrgan(const std::filesystem::path &file, int squares) {
  const int n = squares;
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
  if (!out) throw std::runtime_error("cannot write " + file.string());
}

std::filesystem::path writeTorso(const std::filesystem::path &folder, double voxel_mm) {
  imaging::Volume image;
  image.geometry = gridOf(voxel_mm);
  image.unit = "HU";
  std::vector<std::int16_t> values;
  std::uint32_t seed = 1;
  forVoxels(image.geometry, [&](const Vec3 &x) {
    seed = seed * 1664525U + 1013904223U;
    const auto noise = static_cast<std::int16_t>(seed >> 27);
    const auto organ = organAt(x);
    const std::int16_t value = !organ        ? std::int16_t{-1000}
                               : *organ == 0 ? std::int16_t{-90}
                                             : kOrgans[*organ - 1].hounsfield;
    values.push_back(static_cast<std::int16_t>(value + noise));
  });
  image.voxels = std::move(values);
  valueOf(imaging::writeVolume(folder / "ct.nrrd", image));
  imaging::LabelMap labels;
  labels.geometry = gridOf(4.0);
  forVoxels(labels.geometry,
            [&](const Vec3 &x) { labels.voxels.push_back(static_cast<std::uint16_t>(organAt(x).value_or(0))); });
  for (std::size_t i = 0; i < kOrganCount; ++i)
    labels.labels.push_back({static_cast<std::uint16_t>(i + 1), kOrgans[i].label, {0.5F, 0.5F, 0.5F}});
  valueOf(imaging::writeLabelMap(folder / "labels.nrrd", labels));
  const std::filesystem::path scene = folder / "torso.toml";
  std::ofstream(scene) << "format = 1\n[world]\ngravity = [4.9, 8.5, 0]\nscan_gravity = [0, 9.81, 0]\n"
                          "[image]\nfile = \"ct.nrrd\"\nlabels = \"labels.nrrd\"\n"
                          "[[body]]\nname = \"torso\"\nvolume = \"labels.nrrd\"\ntissues = \"known\"\n"
                          "background = { material = \"fat\", image = \"ct.nrrd\", from = -150, to = 250 }\n"
                          "sampling = { count = 3000 }\n";
  return scene;
}

TemporaryFolder::TemporaryFolder()
    : path_(std::filesystem::temp_directory_path() / ("bench_window-" + std::to_string(std::random_device{}()))) {
  std::filesystem::create_directories(path_);
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace bench
