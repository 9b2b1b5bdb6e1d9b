// SPDX-License-Identifier: Apache-2.0
#include "images_scene.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "bench/timing.h"
#include "c3de/imaging/reading.h"
#include "c3de/render/image_renderer.h"
#include "c3de/session/body_displacement.h"
#include "c3de/session/session.h"
#include "c3de/session/simulator_access.h"
#include "c3de/ui/image_views.h"
#include "workstation/displacement_presenter.h"

namespace bench {
namespace {

using namespace c3de;

struct Part {
  const char *name;
  bool isWarped, hasVolume;
};
constexpr Part kParts[] = {
    {"slices", false, false}, {"slices + warp", true, false}, {"slices + warp + volume, moving", true, true}};

render::VoxelType typeOf(const imaging::Voxels &voxels) {
  // In the order of the variant's alternatives.
  constexpr render::VoxelType kTypes[] = {
      render::VoxelType::int8,  render::VoxelType::uint8,  render::VoxelType::int16,   render::VoxelType::uint16,
      render::VoxelType::int32, render::VoxelType::uint32, render::VoxelType::float32, render::VoxelType::float64};
  return kTypes[voxels.index()];
}

class SceneBench {
 public:
  SceneBench(render::Renderer &renderer, session::Session &session, const c3de_simulator_v1 &table,
             c3de_object *simulator, std::shared_ptr<scene::StoredImage> image, double rim_mm)
      : renderer_(renderer), images_(*renderer.images()), session_(session), table_(table), simulator_(simulator),
        rim_mm_(rim_mm) {
    views_.setImage(std::move(image));
    for (const ui::Pane pane : ui::kSlicePanes) views_.view(pane).setSize(kPaneWidth, kPaneHeight);
    views_.resetViews();
  }

  Expected<void> upload() {
    const imaging::Volume &volume = views_.image()->volume;
    const void *voxels =
        std::visit([](const auto &all) { return static_cast<const void *>(all.data()); }, volume.voxels);
    auto handle = images_.addImage({{volume.geometry.size, volume.geometry.indexToWorld},
                                    typeOf(volume.voxels),
                                    voxels,
                                    volume.slope,
                                    volume.intercept});
    if (!handle) return tl::unexpected(handle.error());
    ui::ImageHandles handles{*handle, {}, {}};
    views_.setHandles(handles);
    bodies_ = session::referenceBodies(simulator_, volume.geometry);
    const imaging::WorldBox box = imaging::boxOf(volume.geometry);
    camera_.upAxis = render::UpAxis::z;
    camera_.yaw = 0.6;
    camera_.pitch = 0.3;
    camera_.fit(box.low, box.high, static_cast<double>(kPaneWidth) / kPaneHeight);
    return {};
  }

  Expected<void> measure(const Part &part, std::size_t frames, Report &report) {
    if (table_.reset(simulator_) < 0)
      return fail(ErrorCode::plugin, "the simulation does not go back to its beginning");
    ui::ImageOptions options = views_.options();
    options.showsVolume = part.hasVolume;
    views_.setOptions(options);
    if (const auto shown = displacement_.show(nullptr); !shown) return shown;
    grid_.forget();
    std::vector<double> step_ms, field_ms, draw_ms;
    for (std::size_t i = 0; i < frames; ++i) {
      double from = wall_ms();
      if (table_.step(simulator_) < 0) return fail(ErrorCode::plugin, "the simulation diverged");
      table_.publish(simulator_);
      step_ms.push_back(wall_ms() - from);
      std::shared_ptr<imaging::DisplacementGrid> u;
      if (part.isWarped) {
        from = wall_ms();
        const session::PresentBodies bodies = session::presentBodies(&table_, simulator_);
        grid_.follow(bodies.box, bodies.spacing_mm, rim_mm_);
        u = std::make_shared<imaging::DisplacementGrid>();
        u->geometry = grid_.geometry();
        u->bodies = bodies_;
        if (!session::readDisplacement(&table_, simulator_, rim_mm_, *u))
          return fail(ErrorCode::plugin, "no displacement");
        field_ms.push_back(wall_ms() - from);
      }
      from = wall_ms();
      session_.mainQueue().runFrame();
      session_.plugins().syncScene();
      if (u)
        if (const auto shown = displacement_.show(std::move(u)); !shown) return shown;
      draw();
      draw_ms.push_back(wall_ms() - from);
    }
    report.row({part.name, at(draw_ms, 0.5), at(draw_ms, 0.01), at(step_ms, 0.5), at(field_ms, 0.5)});
    return {};
  }

 private:
  static double at(std::vector<double> ms, double part) {
    if (ms.empty()) return 0.0;
    std::sort(ms.begin(), ms.end());
    return ms[std::min(ms.size() - 1, static_cast<std::size_t>(part * static_cast<double>(ms.size())))];
  }

  void draw() {
    images_.setScene(views_.scene());
    const render::ImageDisplay look = views_.look();
    for (const ui::Pane pane : ui::kSlicePanes) {
      const int v = static_cast<int>(pane);
      images_.drawSlice(look, views_.view(pane).plane(),
                        {v % 2 * kPaneWidth, v / 2 * kPaneHeight, kPaneWidth, kPaneHeight});
    }
    renderer_.draw(camera_, {kPaneWidth, kPaneHeight, kPaneWidth, kPaneHeight});
    glFinish();
  }

  render::Renderer &renderer_;
  render::ImageRenderer &images_;
  session::Session &session_;
  const c3de_simulator_v1 &table_;
  c3de_object *simulator_;
  double rim_mm_;
  ui::ImageViews views_;
  app::DisplacementPresenter displacement_{&images_, views_};
  std::shared_ptr<const imaging::Mask> bodies_;
  render::Camera camera_;
  imaging::FollowingGrid grid_;
};

}  // namespace

Expected<void> measureScene(render::Renderer &renderer, const std::filesystem::path &file, const Options &options,
                            Report &report) {
  session::SessionOptions sessionOptions;
  sessionOptions.threads = options.threads;
  sessionOptions.renderer = &renderer;
  auto session = session::Session::create(sessionOptions);
  if (!session) return tl::unexpected(session.error());
  auto made = (*session)->createSimulator();
  if (!made) return tl::unexpected(made.error());
  const session::ObjectRef simulator(*made);
  auto table = session::simulatorTable(simulator.get());
  if (!table) return tl::unexpected(table.error());
  auto scene = scene::loadScene(file, &(*session)->materials());
  if (!scene) return tl::unexpected(scene.error());
  if (!scene->image) return fail(ErrorCode::usage, file.string() + " has no [image]");
  if (auto set = scene::applyOverride(*scene, "solver.dt=" + std::to_string(1.0 / 60.0), &(*session)->materials());
      !set)
    return set;
  if (auto done = (*session)->populate(simulator.get(), *scene, {}); !done) return tl::unexpected(done.error());
  simulator.get()->vt->retain(simulator.get());
  if (auto done = (*session)->adopt(simulator.get(), "scene"); !done) return tl::unexpected(done.error());
  auto volume = imaging::readVolume(scene->image->file);
  if (!volume) return tl::unexpected(volume.error());
  auto image = std::make_shared<scene::StoredImage>();
  image->volume = std::move(volume->volume);
  image->range = imaging::robustRange(image->volume);

  report.table("scene", {{"what", "what is drawn, " + file.filename().string(), 0},
                         {"draw_ms", "drawing ms", 2},
                         {"draw_1_ms", "fastest 1 %", 2},
                         {"step_ms", "step ms", 2},
                         {"field_ms", "displacement ms", 2}});
  SceneBench bench(renderer, **session, **table, simulator.get(), std::move(image), scene->image->rim_mm);
  if (auto done = bench.upload(); !done) return done;
  const auto frames = static_cast<std::size_t>(std::max(1.0, 60.0 * options.seconds));
  // The first frames link programs and allocate.
  for (const Part &part : kParts)
    if (auto done = bench.measure(part, frames, report); !done) return done;
  return {};
}

}  // namespace bench
