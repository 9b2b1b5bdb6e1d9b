// SPDX-License-Identifier: Apache-2.0
#include "screenshot.h"

#include "c3de/render/renderer.h"
#include "session.h"

namespace c3de::app {

Expected<void> writeScreenshot(Session &session, render::Renderer &renderer, const std::filesystem::path &file, int width,
                               int height) {
  if (scene::Simulation *simulation = session.simulation())
    simulation->call([simulation] { simulation->table()->publish(simulation->object()); });
  // Plugins hand the snapshot to the renderer at the start of a frame.
  session.mainQueue().runFrame();
  session.plugins().syncScene();
  render::Camera camera;
  const double aspect = static_cast<double>(width) / height;
  if (const auto bounds = session.sceneGraph().bounds()) camera.fit(bounds->min, bounds->max, aspect);
  const auto image = renderer.drawToImage(camera, width, height);
  if (!image) return tl::unexpected(image.error());
  return render::writePng(file.string(), *image);
}

}  // namespace c3de::app
