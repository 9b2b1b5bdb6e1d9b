// SPDX-License-Identifier: Apache-2.0
// A torso of many tissues that plays while its scan is drawn.
#include <epoxy/gl.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <fstream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "bench/timing.h"
#include "c3de/abi/simulation.h"
#include "c3de/imaging/statistics.h"
#include "c3de/imaging/writing.h"
#include "c3de/render/image_renderer.h"
#include "c3de/session/body_sources.h"
#include "c3de/session/build_scene.h"
#include "c3de/session/displacement_sampler.h"
#include "c3de/session/fixed_region_rule.h"
#include "c3de/session/session.h"
#include "c3de/session/simulator_access.h"
#include "c3de/session/tissue_tracker.h"
#include "c3de/ui/image_presets.h"
#include "c3de/ui/image_views.h"
#include "images_scene.h"
#include "workstation/displacement_presenter.h"
#include "workstation/tissue_presenter.h"

namespace bench {
namespace {

using namespace c3de;
using namespace std::chrono_literals;

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

/// An image of 2 mm, labels of 4 mm, and a scene of 3000 points that is tilted by 30° from the gravity of its scan.
Expected<std::filesystem::path> writeTorso(const std::filesystem::path &folder) {
  std::error_code code;
  std::filesystem::create_directories(folder, code);
  imaging::Volume image;
  image.geometry = gridOf(2.0);
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
  if (auto written = imaging::writeVolume(folder / "ct.nrrd", image); !written) return tl::unexpected(written.error());
  imaging::LabelMap labels;
  labels.geometry = gridOf(4.0);
  forVoxels(labels.geometry,
            [&](const Vec3 &x) { labels.voxels.push_back(static_cast<std::uint16_t>(organAt(x).value_or(0))); });
  for (std::size_t i = 0; i < kOrganCount; ++i)
    labels.labels.push_back({static_cast<std::uint16_t>(i + 1), kOrgans[i].label, {0.5F, 0.5F, 0.5F}});
  if (auto written = imaging::writeLabelMap(folder / "labels.nrrd", labels); !written)
    return tl::unexpected(written.error());
  const std::filesystem::path scene = folder / "torso.toml";
  std::ofstream(scene) << "format = 1\n[world]\ngravity = [4.9, 8.5, 0]\nscan_gravity = [0, 9.81, 0]\n"
                          "[image]\nfile = \"ct.nrrd\"\nlabels = \"labels.nrrd\"\n"
                          "[[body]]\nname = \"torso\"\nvolume = \"labels.nrrd\"\ntissues = \"known\"\n"
                          "background = { material = \"fat\", image = \"ct.nrrd\", from = -150, to = 250 }\n"
                          "sampling = { count = 3000 }\n";
  return scene;
}

double median(std::vector<double> ms) {
  if (ms.empty()) return 0.0;
  std::nth_element(ms.begin(), ms.begin() + static_cast<std::ptrdiff_t>(ms.size() / 2), ms.end());
  return ms[ms.size() / 2];
}

class LivingBench {
 public:
  LivingBench(render::Renderer &renderer, session::Session &session, std::shared_ptr<scene::StoredImage> image,
              double rim_mm)
      : images_(*renderer.images()), renderer_(renderer), session_(session), rim_mm_(rim_mm) {
    views_.setImage(std::move(image));
    for (const ui::Pane pane : ui::kSlicePanes) views_.view(pane).setSize(kPaneWidth, kPaneHeight);
    views_.resetViews();
    images_.setOverlayColours(ui::overlayColours());
  }

  Expected<void> upload(const session::FixedRegions &still) {
    const imaging::Volume &volume = views_.image()->volume;
    auto handle = images_.addImage(app::voxelsOf(volume));
    if (!handle) return tl::unexpected(handle.error());
    views_.setHandles({*handle, {}, {}});
    const imaging::WorldBox box = imaging::boxOf(volume.geometry);
    camera_.upAxis = render::UpAxis::z;
    camera_.yaw = 0.6;
    camera_.pitch = 0.3;
    camera_.fit(box.low, box.high, static_cast<double>(kPaneWidth) / kPaneHeight);
    sampler_.begin();
    sampler_.want(true, rim_mm_, volume.geometry, still);
    return {};
  }

  /// The surfaces of the tissues in the 3D view.
  Expected<void> showTissues(const std::vector<session::TissueVoxels> &bodies) {
    auto made = session::tissueSurfaces(bodies, {});
    if (!made) return tl::unexpected(made.error());
    tissues_.begin(bodies);
    surfaces_.show(std::make_shared<const std::vector<session::TissueSurface>>(std::move(*made)),
                   session_.simulationNode());
    tissues_.follow(surfaces_.seen());
    return {};
  }

  /// On the simulation's thread.
  void onPublished(const scene::Simulation &simulation) {
    tissues_.onPublished(simulation, sampler_.onPublished(simulation), true);
    c3de_sim_status status{};
    status.size = sizeof status;
    ++snapshots_;
    if (simulation.table()->status(simulation.object(), &status) >= 0) time_s_ = status.time_s;
  }

  Expected<void> measure(const char *what, ui::Overlay overlay, double seconds, Report &report) {
    scene::Simulation *simulation = session_.simulation();
    if (simulation == nullptr) return fail(ErrorCode::internal, "nothing plays");
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
      return fail(ErrorCode::plugin, std::string("the field of '") + what + "' has not come");
    counts_ = {};
    const double simulated = time_s_, from = wall_ms();
    run(seconds);
    const double took_s = 1e-3 * (wall_ms() - from), rate = (time_s_ - simulated) / took_s;
    if (simulation->state().mode != C3DE_SIM_PLAYING)
      return fail(ErrorCode::plugin, "it does not play any more: " + simulation->failure());
    for (std::size_t v = 0; v < 4; ++v)
      report.row({what, ui::paneName(static_cast<ui::Pane>(v)), median(counts_.draw_ms[v]),
                  static_cast<double>(counts_.draw_ms[v].size()) / took_s,
                  static_cast<double>(counts_.deformed[v]) / took_s, nullptr, nullptr, nullptr, nullptr});
    report.row({what, "all", median(counts_.frame_ms), static_cast<double>(counts_.frame_ms.size()) / took_s,
                static_cast<double>(*std::min_element(counts_.deformed.begin(), counts_.deformed.end())) / took_s,
                median(counts_.displacement_ms), static_cast<double>(counts_.surfaces_ms.size()) / took_s,
                median(counts_.surfaces_ms), rate});
    return {};
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
    session_.mainQueue().runFrame();
    session_.plugins().syncScene();
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
    const render::ImageDisplay look = views_.look();
    const std::uint64_t snapshots = snapshots_;
    const bool hasMoved = std::exchange(drawnSnapshots_, snapshots) != snapshots;
    for (std::size_t v = 0; v < 4; ++v) {
      // As in the window: unchanged views are retained.
      if (!isNew && (static_cast<ui::Pane>(v) != ui::Pane::space || !hasMoved)) continue;
      const double from = wall_ms();
      const int x = static_cast<int>(v) % 2 * kPaneWidth, y = static_cast<int>(v) / 2 * kPaneHeight;
      if (const auto pane = static_cast<ui::Pane>(v); pane == ui::Pane::space)
        renderer_.draw(camera_, {x, y, kPaneWidth, kPaneHeight});
      else
        images_.drawSlice(look, views_.view(pane).plane(), {x, y, kPaneWidth, kPaneHeight});
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

  render::ImageRenderer &images_;
  render::Renderer &renderer_;
  session::Session &session_;
  double rim_mm_;
  std::atomic<double> time_s_ = 0.0;
  std::atomic<std::uint64_t> snapshots_ = 0;
  std::uint64_t drawnSnapshots_ = 0;
  ui::ImageViews views_;
  app::DisplacementPresenter displacement_{&images_, views_};
  session::DisplacementSampler sampler_;
  app::TissuePresenter surfaces_{renderer_, session_.sceneGraph()};
  std::shared_ptr<const session::SurfacePositions> places_;
  session::TissueTracker tissues_;
  render::Camera camera_;
  Counts counts_;
};

}  // namespace

Expected<void> measureLiving(render::Renderer &renderer, const std::filesystem::path &folder, const Options &options,
                             Report &report) {
  const auto file = writeTorso(folder);
  if (!file) return tl::unexpected(file.error());
  session::SessionOptions sessionOptions;
  sessionOptions.threads = options.threads;
  sessionOptions.renderer = &renderer;
  auto session = session::Session::create(sessionOptions);
  if (!session) return tl::unexpected(session.error());
  auto made = (*session)->createSimulator();
  if (!made) return tl::unexpected(made.error());
  const session::ObjectRef simulator(*made);
  auto scene = scene::loadScene(*file, &(*session)->materials());
  if (!scene) return tl::unexpected(scene.error());
  session::BodySources sources;
  session::Prepared prepared;
  const double from = wall_ms();
  if (auto done = session::buildScene(**session, simulator.get(), *scene, sources, {}, &prepared); !done)
    return tl::unexpected(done.error());
  report.fact("prepared_ms", wall_ms() - from);
  auto volume = sources.volume(scene->image->file, {});
  if (!volume) return tl::unexpected(volume.error());
  auto image = std::make_shared<scene::StoredImage>();
  image->volume = **volume;
  image->range = imaging::robustRange(image->volume);
  auto labels = sources.labels(scene->image->labels.front(), {});
  if (!labels) return tl::unexpected(labels.error());
  auto stored = std::make_shared<scene::StoredLabels>();
  stored->map = (*labels)->front();
  auto rule = session::fixedRegionRuleOf(scene->image->still, image->volume, &stored->map, (*session)->materials());
  if (!rule) return tl::unexpected(rule.error());

  LivingBench bench(renderer, **session, image, scene->image->rim_mm);
  if (auto done = bench.upload({image, stored, std::move(*rule),
                                std::make_shared<const std::vector<session::TissueVoxels>>(prepared.tissues)});
      !done)
    return done;
  (*session)->setPublishedHook([&bench](const scene::Simulation &simulation) { bench.onPublished(simulation); });
  simulator.get()->vt->retain(simulator.get());
  if (auto done = (*session)->adopt(simulator.get(), "torso"); !done) return done;
  if (auto done = bench.showTissues(prepared.tissues); !done) return done;
  report.table("living", {{"overlay", "overlay", 0},
                          {"view", "view", 0},
                          {"draw_ms", "ms a frame", 2},
                          {"drawn_hz", "drawn /s", 1},
                          {"deformed_hz", "deformed /s", 1},
                          {"displacement_ms", "displacement ms", 2},
                          {"surfaces_hz", "surfaces /s", 1},
                          {"surfaces_ms", "surfaces ms", 1},
                          {"rate", "rate of real time", 2}});
  const std::pair<const char *, ui::Overlay> parts[] = {
      {"none", ui::Overlay::none}, {"det F", ui::Overlay::volumeChange}, {"stress", ui::Overlay::field}};
  Expected<void> done;
  for (const auto &[what, overlay] : parts)
    if (done) done = bench.measure(what, overlay, options.seconds, report);
  // Its thread calls the bench, which is destroyed first.
  if (scene::Simulation *simulation = (*session)->simulation()) simulation->setPublishedListener({});
  return done;
}

}  // namespace bench
