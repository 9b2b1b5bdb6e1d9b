// SPDX-License-Identifier: Apache-2.0
#include "workstation/screenshot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "c3de/render/renderer.h"
#include "c3de/session/displacement_sampler.h"
#include "c3de/session/export_image.h"
#include "c3de/session/session.h"
#include "c3de/ui/views_picture.h"
#include "workstation/displacement_presenter.h"

namespace c3de::app {
namespace {

constexpr double kLeastShift_mm = 0.1;  // below it colours would show noise

// 1, 2 or 5 times a power of ten.
double roundUp(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double step : {1.0, 2.0, 5.0})
    if (value <= step * power) return step * power;
  return 10.0 * power;
}

double longestShift(const imaging::DisplacementGrid &u) {
  double most = 0.0;
  for (std::size_t i = 0; i + 2 < u.xyz_mm.size(); i += 3) {
    double squared = 0.0;
    for (std::size_t a = 0; a < 3; ++a) squared += std::pow(static_cast<double>(u.xyz_mm[i + a]), 2);
    most = std::max(most, squared);
  }
  return std::sqrt(most);
}

Expected<void> showWarp(Session &session, const PictureSources &sources, ui::ImageViews &views,
                        DisplacementPresenter &shown) {
  scene::Simulation *simulation = session.simulation();
  if (!sources.warp || !simulation) return {};
  Expected<imaging::DisplacementGrid> u;
  simulation->call(
      [&] { u = presentDisplacement(simulation->table(), simulation->object(), sources.image->volume, sources.how); });
  if (!u) return {};  // not every simulator can say it; its bodies are drawn at any rate
  ui::ImageOptions options = views.options();
  if (const double most = longestShift(*u); most > kLeastShift_mm) {
    options.showsShift = true;
    options.shiftHigh = roundUp(most);
    views.setOptions(options);
  }
  return shown.show(std::make_shared<const imaging::DisplacementGrid>(std::move(*u)));
}

}  // namespace

Expected<void> writeScreenshot(Session &session, render::Renderer &renderer, const std::filesystem::path &file,
                               int width, int height, const PictureSources &sources,
                               const std::vector<Coverage> &coverage) {
  scene::Simulation *simulation = session.simulation();
  std::string title;
  if (simulation) {
    simulation->call([simulation] { simulation->table()->publish(simulation->object()); });
    if (const scene::Node *node = session.sceneGraph().find(session.simulationNode())) title = node->name;
  }
  // Plugins hand the snapshot to the renderer at the start of a frame.
  session.mainQueue().runFrame();
  session.plugins().syncScene();

  ui::ImageViews views;
  DisplacementPresenter displacement(renderer.images(), views);
  if (sources.image && renderer.images()) {
    render::ImageRenderer &drawer = *renderer.images();
    drawer.setShiftColours(ui::shiftColours());
    views.setImage(sources.image);
    auto image = drawer.addImage(voxelsOf(sources.image->volume));
    if (!image) return tl::unexpected(image.error());
    views.setHandles({*image, {}, {}, {}, {}, {}});
    if (sources.labels) {
      auto labels = drawer.addLabels(placeOf(sources.labels->map.geometry), sources.labels->map.voxels);
      if (!labels) return tl::unexpected(labels.error());
      views.setLabels(sources.labels);
      ui::ImageHandles handles = views.handles();
      handles.labels = *labels;
      views.setHandles(handles);
    }
    if (sources.view != PictureView::four)
      views.setMaximised(static_cast<ui::Pane>(static_cast<int>(sources.view) - 1));
    if (simulation) {
      imaging::WorldBox box = presentBodies(simulation->table(), simulation->object()).box;
      if (!box.isEmpty()) views.setCrossHair(0.5 * (box.low + box.high));
    }
    if (auto warped = showWarp(session, sources, views, displacement); !warped) return warped;
    if (auto marked = showMissing(drawer, views, coverage); !marked) return marked;
  }
  const auto picture = ui::pictureOfViews(renderer, views, session.sceneGraph(), title, width, height);
  if (!picture) return tl::unexpected(picture.error());
  return render::writePng(file.string(), *picture);
}

}  // namespace c3de::app
