// SPDX-License-Identifier: Apache-2.0
#include <epoxy/gl.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>

#include "bench/timing.h"
#include "c3de/abi/simulation.h"
#include "c3de/imaging/statistics.h"
#include "c3de/render/image_renderer.h"
#include "c3de/session/body_displacement.h"
#include "c3de/session/displacement_sampler.h"
#include "c3de/session/fixed_region_rule.h"
#include "c3de/session/resources.h"
#include "c3de/session/tissue_tracker.h"
#include "c3de/ui/image_presets.h"
#include "c3de/ui/image_views.h"
#include "window/scene.h"
#include "workstation/displacement_presenter.h"
#include "workstation/tissue_presenter.h"

namespace bench {
namespace {

using namespace c3de;
using namespace std::chrono_literals;

/// Size of one of four views in a window of 1280 x 800.
constexpr int kPaneWidth = 457, kPaneHeight = 357;

struct Part {
  const char *name;
  bool isWarped, hasVolume, isMaximum;
};
constexpr Part kParts[] = {{"slices", false, false, false},
                           {"slices + warp", true, false, false},
                           {"slices + volume, moving", false, true, false},
                           {"slices + warp + volume, moving", true, true, false},
                           {"slices + warp + MIP, moving", true, true, true}};

/// The image of a scene in three slices and the 3D view, in graphics memory.
class ImagePanes {
 public:
  ImagePanes(Canvas &canvas, PlayedScene &played)
      : renderer_(canvas.renderer()), images_(*renderer_.images()), played_(played) {
    if (!played.scene.image) throw std::invalid_argument("the scene has no [image]");
    image_->volume = *valueOf(played.sources.volume(played.scene.image->file, {}));
    image_->range = imaging::robustRange(image_->volume);
    views_.setImage(image_);
    for (const ui::Pane pane : ui::kSlicePanes) views_.view(pane).setSize(kPaneWidth, kPaneHeight);
    views_.resetViews();
    images_.setOverlayColours(ui::overlayColours());
    const double begin_ms = wall_ms();
    views_.setHandles({valueOf(images_.addImage(app::voxelsOf(image_->volume))), {}, {}});
    glFinish();
    upload_ms_ = wall_ms() - begin_ms;
    const imaging::WorldBox box = imaging::boxOf(image_->volume.geometry);
    camera_.upAxis = render::UpAxis::z;
    camera_.yaw = 0.6;
    camera_.pitch = 0.3;
    camera_.fit(box.low, box.high, static_cast<double>(kPaneWidth) / kPaneHeight);
  }

  [[nodiscard]] double upload_ms() const { return upload_ms_; }

 protected:
  void draw(std::size_t pane) {
    const int x = static_cast<int>(pane) % 2 * kPaneWidth, y = static_cast<int>(pane) / 2 * kPaneHeight;
    if (const auto view = static_cast<ui::Pane>(pane); view == ui::Pane::space)
      renderer_.draw(camera_, {x, y, kPaneWidth, kPaneHeight});
    else
      images_.drawSlice(views_.look(), views_.view(view).plane(), {x, y, kPaneWidth, kPaneHeight});
  }

  render::Renderer &renderer_;
  render::ImageRenderer &images_;
  PlayedScene &played_;
  const std::shared_ptr<scene::StoredImage> image_ = std::make_shared<scene::StoredImage>();
  ui::ImageViews views_;
  app::DisplacementPresenter displacement_{&images_, views_};
  render::Camera camera_;
  double upload_ms_ = 0.0;
};

class SteppedImages : public ImagePanes {
 public:
  using ImagePanes::ImagePanes;

  void measure(const Part &part, std::size_t frames, Report &report) {
    c3de_object *simulator = played_.simulator();
    if (played_.table->reset(simulator) < 0)
      throw std::runtime_error("the simulation does not return to its beginning");
    ui::ImageOptions options = views_.options();
    options.showsVolume = part.hasVolume;
    options.volumePreset = part.isMaximum ? ui::VolumePreset::maximum : ui::VolumePreset::ctBone;
    views_.setOptions(options);
    valueOf(displacement_.show(nullptr));
    grid_.forget();
    std::vector<double> step_ms, field_ms, draw_ms;
    for (std::size_t i = 0; i < frames; ++i) {
      double from = wall_ms();
      if (played_.table->step(simulator) < 0) throw std::runtime_error("the simulation diverged");
      played_.table->publish(simulator);
      step_ms.push_back(wall_ms() - from);
      std::shared_ptr<imaging::DisplacementGrid> u;
      if (part.isWarped) {
        from = wall_ms();
        const double rim_mm = played_.scene.image->rim_mm;
        const session::PresentBodies bodies = session::presentBodies(played_.table, simulator);
        grid_.follow(bodies.box, bodies.spacing_mm, rim_mm);
        u = std::make_shared<imaging::DisplacementGrid>();
        u->geometry = grid_.geometry();
        u->bodies = bodies_;
        if (!session::readDisplacement(played_.table, simulator, rim_mm, *u))
          throw std::runtime_error("no displacement");
        field_ms.push_back(wall_ms() - from);
      }
      from = wall_ms();
      played_.sync();
      if (u) valueOf(displacement_.show(std::move(u)));
      images_.setScene(views_.scene());
      for (std::size_t pane = 0; pane < 4; ++pane) draw(pane);
      glFinish();
      draw_ms.push_back(wall_ms() - from);
    }
    const Timing drawing = summaryOf(draw_ms);
    report.row({part.name, drawing.median_ms, drawing.p01_ms, summaryOf(step_ms).median_ms,
                part.isWarped ? Report::Cell(summaryOf(field_ms).median_ms) : Report::Cell()});
    if (!part.hasVolume) return;
    std::vector<double> refining_ms;
    while (images_.wantsRefinement()) {
      const double from = wall_ms();
      draw(static_cast<std::size_t>(ui::Pane::space));
      glFinish();
      refining_ms.push_back(wall_ms() - from);
    }
    double sum_ms = 0.0;
    for (const double ms : refining_ms) sum_ms += ms;
    report.row(
        {"  until refined, in " + std::to_string(refining_ms.size()) + " frames", sum_ms, nullptr, nullptr, nullptr});
  }

 private:
  std::shared_ptr<const imaging::Mask> bodies_ = session::referenceBodies(played_.simulator(), image_->volume.geometry);
  imaging::FollowingGrid grid_;
};

class LivingImages : public ImagePanes {
 public:
  LivingImages(Canvas &canvas, PlayedScene &played) : ImagePanes(canvas, played) {
    const scene::SceneImage &image = *played.scene.image;
    auto labels = std::make_shared<scene::StoredLabels>();
    labels->map = valueOf(played.sources.labels(image.labels.front(), {}))->front();
    auto rule =
        valueOf(session::fixedRegionRuleOf(image.still, image_->volume, &labels->map, played.session->materials()));
    sampler_.begin();
    sampler_.want(true, image.rim_mm, image_->volume.geometry,
                  {image_, labels, std::move(rule),
                   std::make_shared<const std::vector<session::TissueVoxels>>(played.prepared.tissues)});
  }

  /// The surfaces of the tissues in the 3D view.
  void showTissues() {
    tissues_.begin(played_.prepared.tissues);
    surfaces_.show(std::make_shared<const std::vector<session::TissueSurface>>(
                       valueOf(session::tissueSurfaces(played_.prepared.tissues, {}))),
                   played_.session->simulationNode());
    tissues_.follow(surfaces_.seen());
  }

  /// On the simulation's thread.
  void onPublished(const scene::Simulation &simulation) {
    tissues_.onPublished(simulation, sampler_.onPublished(simulation), true);
    c3de_sim_status status{};
    status.size = sizeof status;
    ++snapshots_;
    if (simulation.table()->status(simulation.object(), &status) >= 0) time_s_ = status.time_s;
  }

  void measure(const char *what, ui::Overlay overlay, double seconds, Report &report) {
    scene::Simulation *simulation = played_.session->simulation();
    simulation->transport(C3DE_TRANSPORT_RESET);
    simulation->transport(C3DE_TRANSPORT_PLAY);
    ui::ImageOptions options = views_.options();
    options.overlay = overlay;
    for (const session::PointField &field : sampler_.offered())
      if (field.name == "stress_vm" && overlay == ui::Overlay::field) options.overlayField = field.name;
    views_.setOptions(options);
    sampler_.requestFields({overlay != ui::Overlay::none, overlay == ui::Overlay::field ? options.overlayField : ""});
    run(0.5);  // programs are linked, and the first displacement arrives
    for (int i = 0; i < 100 && overlay != ui::Overlay::none && views_.shownField() == nullptr; ++i) run(0.1);
    if (overlay != ui::Overlay::none && views_.shownField() == nullptr)
      throw std::runtime_error(std::string("the field of '") + what + "' has not come");
    counts_ = {};
    const double simulated = time_s_, from = wall_ms();
    run(seconds);
    const double took_s = 1e-3 * (wall_ms() - from), rate = (time_s_ - simulated) / took_s;
    if (simulation->state().mode != C3DE_SIM_PLAYING)
      throw std::runtime_error("it does not play any more: " + simulation->failure());
    for (std::size_t v = 0; v < 4; ++v)
      report.row({what, ui::paneName(static_cast<ui::Pane>(v)), summaryOf(counts_.draw_ms[v]).median_ms,
                  static_cast<double>(counts_.draw_ms[v].size()) / took_s,
                  static_cast<double>(counts_.deformed[v]) / took_s, nullptr, nullptr, nullptr, nullptr});
    report.row({what, "all", summaryOf(counts_.frame_ms).median_ms,
                static_cast<double>(counts_.frame_ms.size()) / took_s,
                static_cast<double>(*std::min_element(counts_.deformed.begin(), counts_.deformed.end())) / took_s,
                summaryOf(counts_.displacement_ms).median_ms, static_cast<double>(counts_.surfaces_ms.size()) / took_s,
                summaryOf(counts_.surfaces_ms).median_ms, rate});
  }

 private:
  void run(double seconds) {
    const double end = wall_ms() + 1e3 * seconds;
    while (wall_ms() < end) {
      const auto next = std::chrono::steady_clock::now() + 16667us;
      const double from = wall_ms();
      frame();
      counts_.frame_ms.push_back(wall_ms() - from);
      std::this_thread::sleep_until(next);
    }
  }

  void frame() {
    played_.sync();
    auto newest = sampler_.take();
    const bool isNew = newest != nullptr;
    if (newest)
      if (const auto shown = displacement_.show(std::move(newest)); !shown) return;
    displacement_.followOverlay();
    if (auto places = tissues_.places(); places != places_) {
      counts_.surfaces_ms.push_back(tissues_.following_ms());
      places_ = std::move(places);
      surfaces_.place(places_);
    }
    images_.setScene(views_.scene());
    const std::uint64_t snapshots = snapshots_;
    const bool hasMoved = std::exchange(drawnSnapshots_, snapshots) != snapshots;
    for (std::size_t v = 0; v < 4; ++v) {
      // As in the window: unchanged views are retained.
      if (!isNew && (static_cast<ui::Pane>(v) != ui::Pane::space || !hasMoved)) continue;
      const double from = wall_ms();
      draw(v);
      glFinish();
      counts_.draw_ms[v].push_back(wall_ms() - from);
      counts_.deformed[v] += isNew ? 1 : 0;
    }
    if (isNew) counts_.displacement_ms.push_back(sampler_.milliseconds());
  }

  struct Counts {
    std::array<std::vector<double>, 4> draw_ms;
    std::array<std::size_t, 4> deformed{};
    std::vector<double> frame_ms, displacement_ms, surfaces_ms;
  };

  std::atomic<double> time_s_ = 0.0;
  std::atomic<std::uint64_t> snapshots_ = 0;
  std::uint64_t drawnSnapshots_ = 0;
  session::DisplacementSampler sampler_;
  app::TissuePresenter surfaces_{renderer_, played_.session->sceneGraph()};
  std::shared_ptr<const session::SurfacePositions> places_;
  session::TissueTracker tissues_;
  Counts counts_;
};

}  // namespace

void measureImages(const Options &options, Report &report) {
  const TemporaryFolder folder;
  const std::string name = options.text("--scene", "head");
  const std::filesystem::path file = name == "torso"  ? writeTorso(folder.path(), options.number("--voxel", 2.0))
                                     : name == "head" ? valueOf(session::findResource("scenes/brain_shift.toml"))
                                                      : std::filesystem::path(name);
  Canvas canvas(2 * kPaneWidth, 2 * kPaneHeight);
  PlayedScene played(canvas.renderer(), file, options.threads, {"solver.dt=" + std::to_string(1.0 / 60.0)});
  played.adopt();
  SteppedImages images(canvas, played);
  report.fact("graphics", canvas.renderer().description());
  report.fact("upload_ms", images.upload_ms());
  report.table("images, " + file.filename().string(),
               "what; draw_ms=drawing ms:2; draw_1_ms=fastest 1 %:2; step_ms=step ms:2; "
               "field_ms=displacement ms:2");
  const auto frames = static_cast<std::size_t>(std::max(1.0, 60.0 * options.number("--seconds", 2.0)));
  // The first frames link programs and allocate.
  for (const Part &part : kParts) images.measure(part, frames, report);
}

void measureLiving(const Options &options, Report &report) {
  const TemporaryFolder folder;
  Canvas canvas(2 * kPaneWidth, 2 * kPaneHeight);
  PlayedScene played(canvas.renderer(), writeTorso(folder.path(), 2.0), options.threads);
  LivingImages images(canvas, played);
  played.session->setPublishedHook([&images](const scene::Simulation &simulation) { images.onPublished(simulation); });
  played.adopt();
  // The simulation's thread calls the images, which are destroyed first.
  struct Silence {
    ~Silence() { simulation.setPublishedListener({}); }
    scene::Simulation &simulation;
  } const silence{*played.session->simulation()};
  images.showTissues();
  report.fact("graphics", canvas.renderer().description());
  report.table("living",
               "overlay; view; draw_ms=ms a frame:2; drawn_hz=drawn /s:1; deformed_hz=deformed /s:1; "
               "displacement_ms=displacement ms:2; surfaces_hz=surfaces /s:1; surfaces_ms=surfaces ms:1; "
               "rate=rate of real time:2");
  const double seconds = options.number("--seconds", 2.0);
  images.measure("none", ui::Overlay::none, seconds, report);
  images.measure("det F", ui::Overlay::volumeChange, seconds, report);
  images.measure("stress", ui::Overlay::field, seconds, report);
}

}  // namespace bench
