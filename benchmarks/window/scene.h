// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "bench/report.h"
#include "c3de/render/renderer.h"
#include "c3de/render_gl/gl_renderer.h"
#include "c3de/session/build_scene.h"
#include "c3de/session/session.h"
#include "c3de/session/simulator_access.h"

namespace bench {

/// OpenGL without a window; its framebuffer is bound.
class Canvas {
 public:
  Canvas(int width, int height);
  Canvas(const Canvas &) = delete;
  Canvas &operator=(const Canvas &) = delete;
  ~Canvas();
  [[nodiscard]] c3de::render::Renderer &renderer() { return *renderer_; }

 private:
  std::unique_ptr<c3de::render::OffscreenContext> context_;
  std::unique_ptr<c3de::render::Renderer> renderer_;
  unsigned buffers_[2]{}, frame_ = 0;
};

/// A scene as the window builds it. Throws with the reason where that fails.
class PlayedScene {
 public:
  PlayedScene(c3de::render::Renderer &renderer, const std::filesystem::path &file, unsigned threads,
              const std::vector<std::string> &overrides = {});
  /// Makes it the simulation of the session, which is paused.
  void adopt();

  [[nodiscard]] c3de_object *simulator() const { return simulator_.get(); }
  /// Messages and snapshots reach the renderer.
  void sync();

  std::unique_ptr<c3de::session::Session> session;
  c3de::scene::SceneFile scene;
  c3de::session::BodySources sources;
  c3de::session::Prepared prepared;
  const c3de_simulator_v1 *table = nullptr;

 private:
  c3de::session::ObjectRef simulator_;
};

/// A lobed ellipsoid of 21 x 10 x 13 cm, mm, as an OBJ file: the faces of a cube of `squares` squares along an edge,
/// projected outwards. 6 squares² + 2 vertices.
void writeOrgan(const std::filesystem::path &file, int squares);

/// A torso of some ten tissues: an image of voxels of that size, labels of 4 mm, and a scene of 3000 points that is
/// tilted by 30° from the gravity of its scan. @return the scene
[[nodiscard]] std::filesystem::path writeTorso(const std::filesystem::path &folder, double voxel_mm);

/// An empty folder for temporary files, which is removed at the end.
class TemporaryFolder {
 public:
  TemporaryFolder();
  TemporaryFolder(const TemporaryFolder &) = delete;
  TemporaryFolder &operator=(const TemporaryFolder &) = delete;
  ~TemporaryFolder();
  [[nodiscard]] const std::filesystem::path &path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// A frame of 1/60 s and each of its stages.
///
/// Two scenes pass through the program as they do in its window, without the window: read, built by the plugin,
/// stepped, published, handed to the renderer, drawn by OpenGL into an offscreen buffer.
///   first_light     the default scene of the program
///   lattice_10000   an organ of 10 000 phyxels and 50 000 surfels that falls on a block in a box
/// A step is a whole frame, in the substeps that stability needs, on one thread. The simulator's own stages are those
/// of its report; "step, other" is the remainder of the step. In the program the step has its own thread: "solver" is that
/// thread's share of the frame, "screen" the window's. A share is the median of a stage relative to the sum of step,
/// publishing, handing over and drawing.
void measureFrame(const Options &options, Report &report);

/// A scene with an image, as the window shows it while it plays: each frame performs a step of 1/60 s, requests the
/// displacement, uploads it and draws three slices and the 3D view. "head": brain_shift.toml; "torso": writeTorso().
void measureImages(const Options &options, Report &report);

/// The torso as in the window: the simulation plays on its own thread, slices and the 3D view are drawn concurrently at
/// no more than 60 frames a second, without and with a colour-mapped field.
void measureLiving(const Options &options, Report &report);

}  // namespace bench
