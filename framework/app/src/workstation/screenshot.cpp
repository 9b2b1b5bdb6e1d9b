// SPDX-License-Identifier: Apache-2.0
#include "workstation/screenshot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "c3de/render/picture_file.h"
#include "c3de/render/renderer.h"
#include "c3de/session/body_displacement.h"
#include "c3de/session/export_image.h"
#include "c3de/session/point_fields.h"
#include "c3de/session/session.h"
#include "c3de/ui/views_picture.h"
#include "workstation/displacement_presenter.h"
#include "workstation/tissue_presenter.h"

namespace c3de::app {
namespace {

constexpr double kMinShift_mm = 0.1;  // below it colours would show noise

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
  ui::ImageOptions options = views.options();
  const PictureOverlay &overlay = sources.overlay;
  options.overlay = overlay.kind == PictureOverlay::Kind::none           ? ui::Overlay::none
                    : overlay.kind == PictureOverlay::Kind::volumeChange ? ui::Overlay::volumeChange
                    : overlay.kind == PictureOverlay::Kind::field        ? ui::Overlay::field
                                                                         : ui::Overlay::shift;
  options.overlayField = overlay.field;
  Expected<imaging::DisplacementGrid> u;
  std::vector<std::pair<std::string, std::string>> offered;
  simulation->call([&] {
    u = presentDisplacement(simulation->table(), simulation->object(), sources.image->volume, sources.how);
    const bool needsField = options.overlay == ui::Overlay::volumeChange || options.overlay == ui::Overlay::field;
    if (u) addFields(simulation->table(), simulation->object(), {needsField, overlay.field}, *u);
    for (const PointField &field : pointFields(simulation->table(), simulation->object()))
      offered.emplace_back(field.name, field.unit);
  });
  if (!u) return {};  // not every simulator provides it; its bodies are drawn anyway
  if (options.overlay == ui::Overlay::shift && longestShift(*u) <= kMinShift_mm) options.overlay = ui::Overlay::none;
  views.setOfferedFields(std::move(offered));
  views.setOptions(options);
  return shown.show(std::make_shared<const imaging::DisplacementGrid>(std::move(*u)));
}

/// Present positions of the tissues.
void showTissues(Session &session, const Prepared &prepared, TissuePresenter &shown) {
  scene::Simulation *simulation = session.simulation();
  if (!simulation || prepared.tissues.empty()) return;
  auto made = tissueSurfaces(prepared.tissues, {});
  if (!made) return;
  const auto surfaces = std::make_shared<const std::vector<TissueSurface>>(std::move(*made));
  shown.show(surfaces, session.simulationNode());
  Expected<TissueSnapshot> now;
  simulation->call([&] { now = readTissues(simulation->table(), simulation->object()); });
  if (!now) return;  // not every simulator provides it
  if (auto places = followSurfaces(*now, surfaces, nullptr))
    shown.place(std::make_shared<const SurfacePositions>(std::move(*places)));
}

ui::SpaceDirection directionOf(const PictureCamera &camera) {
  constexpr double kRadians = std::numbers::pi / 180.0;
  ui::SpaceDirection direction;
  if (camera.azimuth_deg) direction.yaw = *camera.azimuth_deg * kRadians;
  if (camera.elevation_deg) direction.pitch = *camera.elevation_deg * kRadians;
  if (camera.isZUp) direction.upAxis = *camera.isZUp ? render::UpAxis::z : render::UpAxis::y;
  return direction;
}

}  // namespace

Expected<void> writeScreenshot(Session &session, render::Renderer &renderer, const std::filesystem::path &file,
                               int width, int height, const PictureSources &sources, const Prepared &prepared) {
  scene::Simulation *simulation = session.simulation();
  std::string title;
  if (simulation) {
    simulation->call([simulation] { simulation->table()->publish(simulation->object()); });
    if (const scene::Node *node = session.sceneGraph().find(session.simulationNode())) title = node->name;
  }
  // Plugins pass the snapshot to the renderer at the start of a frame.
  session.mainQueue().runFrame();
  session.plugins().syncScene();

  ui::ImageViews views;
  DisplacementPresenter displacement(renderer.images(), views);
  if (sources.image && renderer.images()) {
    render::ImageRenderer &drawer = *renderer.images();
    drawer.setOverlayColours(ui::overlayColours());
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
    if (auto marked = showMissing(drawer, views, prepared.coverage); !marked) return marked;
  }
  TissuePresenter tissues(renderer, session.sceneGraph());
  if (sources.view == PictureView::four || sources.view == PictureView::space) showTissues(session, prepared, tissues);
  const auto picture =
      ui::pictureOfViews(renderer, views, session.sceneGraph(), title, width, height, directionOf(sources.camera));
  if (!picture) return tl::unexpected(picture.error());
  return render::writePicture(file, *picture);
}

}  // namespace c3de::app
