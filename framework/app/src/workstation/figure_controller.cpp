// SPDX-License-Identifier: Apache-2.0
#include "workstation/figure_controller.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <condition_variable>
#include <utility>

#include "c3de/abi/log.h"
#include "c3de/core/log.h"
#include "c3de/core/output_file.h"
#include "c3de/core/path_text.h"
#include "c3de/render/png_file.h"
#include "workstation/figure_clipboard.h"
#include "workstation/workstation_screenshot.h"

namespace c3de::app {
namespace {

constexpr const char *kStoreId = "c3de.figure", *kSettingsKey = "settings", *kScreenshotKey = "screenshot";
constexpr const char *kFigureFailed = "The figure was not written", *kCopyFailed = "The figure was not copied",
                     *kScreenshotFailed = "The screenshot could not be saved";
constexpr double kDrawingFraction = 0.7;  // of the progress; the rest is encoding and writing
constexpr std::chrono::milliseconds kBetweenReports{50};
/// Height of a picture whose texts have the size that they have in a window.
constexpr double kUsualHeight_px = 1080.0;

std::array<int, 2> sizeOf(ui::ScreenshotSize size, const ui::WorkstationWindow &window) {
  switch (size) {
    case ui::ScreenshotSize::fullHd: return {1920, 1080};
    case ui::ScreenshotSize::ultraHd: return {3840, 2160};
    default: return {window.viewWidth(), window.viewHeight()};
  }
}

auto writerOf(const std::filesystem::path &file) {
  return [file](const std::vector<char> &bytes) -> Expected<std::filesystem::path> {
    if (auto written = writeWholeFile(file, {bytes.data(), bytes.size()}); !written)
      return tl::unexpected(written.error());
    return file;
  };
}

std::vector<std::pair<Handle, bool>> visibilityOf(const scene::SceneGraph &scene) {
  std::vector<std::pair<Handle, bool>> nodes;
  for (const scene::SceneGraph::Row &row : scene.rows()) nodes.emplace_back(row.node, scene.isVisible(row.node));
  return nodes;
}

}  // namespace

struct FigureController::Picture {
  std::mutex mutex;
  std::condition_variable changed;
  std::size_t drawn = 0, count = 0;               ///< views
  std::optional<Expected<render::Image>> result;  ///< set once
  bool isCancelled = false;

  /// Reports the progress until there is a result. [job]
  [[nodiscard]] Expected<render::Image> wait(const ProgressFn &progress) {
    std::unique_lock lock(mutex);
    for (;;) {
      if (result) return std::move(*result);
      const std::string what = fmt::format("drawing view {} of {}", std::min(drawn + 1, count), count);
      const double fraction =
          count > 0 ? kDrawingFraction * static_cast<double>(drawn) / static_cast<double>(count) : 0.0;
      lock.unlock();
      const bool shouldContinue = progress(fraction, what);
      lock.lock();
      isCancelled = !shouldContinue;
      if (isCancelled) return fail(ErrorCode::cancelled, "cancelled; nothing was written");
      changed.wait_for(lock, kBetweenReports);
    }
  }
  void set(Expected<render::Image> image) {
    const std::lock_guard lock(mutex);
    result.emplace(std::move(image));
    changed.notify_all();
  }
};

struct FigureController::Drawing {
  std::unique_ptr<ui::FigurePainter> painter;
  std::shared_ptr<Picture> picture;
  std::vector<std::pair<Handle, bool>> nodes;  ///< with their visibility, when the figure was begun
  const char *interruption = nullptr;          ///< why its views would differ
};

FigureController::FigureController(Parts parts) : parts_(std::move(parts)), store_(registry::defaultSettingsFolder()) {
  settings_ = ui::figureSettingsOf(store_.get(kStoreId, kSettingsKey).value_or(std::string()));
  screenshotSize_ = ui::screenshotSizeOf(store_.get(kStoreId, kScreenshotKey).value_or(std::string()))
                        .value_or(ui::ScreenshotSize::view);
}

FigureController::~FigureController() = default;

void FigureController::connect(ui::WindowActions &actions) {
  actions.screenshot = [this] { saveScreenshot(); };
  actions.figures.settings = [this] { return settings_; };
  actions.figures.save = [this](const ui::FigureSettings &settings, const std::filesystem::path &file) {
    save(settings, file);
  };
  actions.figures.copy = [this] { copy(); };
  actions.figures.whyNoCopy = [] { return findClipboardProgram() ? std::string() : whyNoClipboard(); };
  actions.figures.screenshotSize = [this] { return screenshotSize_; };
  actions.figures.setScreenshotSize = [this](ui::ScreenshotSize size) {
    screenshotSize_ = size;
    remember(kScreenshotKey, ui::idOf(size));
  };
}

void FigureController::remember(const std::string &key, const std::string &value) {
  if (const auto stored = store_.set(kStoreId, key, value); !stored)
    log(LogLevel::warn, "the settings of figures were not saved: " + stored.error().message);
}

void FigureController::save(const ui::FigureSettings &settings, const std::filesystem::path &file) {
  settings_ = settings;
  remember(kSettingsKey, ui::textOf(settings));
  if (drawing_ || wanted_) return parts_.failed(kFigureFailed, {ErrorCode::state, "another figure is being drawn"});
  wanted_ = Wanted{settings, pathText(file.filename()), writerOf(file), "Figure saved", kFigureFailed};
  parts_.window.wake();
}

void FigureController::copy() {
  const auto program = findClipboardProgram();
  if (!program) return parts_.failed(kCopyFailed, {ErrorCode::state, whyNoClipboard()});
  if (drawing_ || wanted_) return parts_.failed(kCopyFailed, {ErrorCode::state, "another figure is being drawn"});
  const auto copyIt = [program = *program](const std::vector<char> &bytes) -> Expected<std::filesystem::path> {
    if (auto copied = copyPng(program, bytes); !copied) return tl::unexpected(copied.error());
    return std::filesystem::path("Clipboard");
  };
  wanted_ = Wanted{settings_, "the figure to the clipboard", copyIt, "Figure copied", kCopyFailed};
  parts_.window.wake();
}

void FigureController::savePlots(const ui::PlotList &plots, const ui::SimulationView &simulation,
                                 const std::filesystem::path &file) {
  const auto picture = std::make_shared<Picture>();
  picture->set(ui::pictureOfPlots(plots, settings_,
                                  simulation.exists ? std::optional(simulation.transport.time_s) : std::nullopt));
  submit(picture, pathText(file.filename()), settings_.dpi, writerOf(file), "Plots saved", "The plots were not saved");
}

void FigureController::saveScreenshot() {
  if (screenshotSize_ == ui::ScreenshotSize::figure) {
    if (drawing_ || wanted_) return parts_.failed(kScreenshotFailed, {ErrorCode::state, "a figure is being drawn"});
    wanted_ = Wanted{settings_, "screenshot", &writeScreenshotFile, "Screenshot saved", kScreenshotFailed};
    return parts_.window.wake();
  }
  const std::array<int, 2> size = sizeOf(screenshotSize_, parts_.window);
  if (screenshotSize_ != ui::ScreenshotSize::view) {
    render::Renderer::PictureStyle style;
    style.scale = static_cast<float>(size[1] / kUsualHeight_px);
    parts_.renderer.setPictureStyle(style);
  }
  auto image = parts_.renderer.drawToImage(parts_.window.camera(), size[0], size[1]);
  parts_.renderer.setPictureStyle({});
  const auto picture = std::make_shared<Picture>();
  picture->set(std::move(image));
  submit(picture, "screenshot", 0.0, &writeScreenshotFile, "Screenshot saved", kScreenshotFailed);
}

void FigureController::onPublished(const scene::Simulation &simulation) {
  Snapshot now;
  now.time_s = simulation.state().time_s;
  if (const auto status = simulatorStatus(simulation.table(), simulation.object())) now.time_s = status->time_s;
  if (auto tools = readProbeTools(simulation.object())) now.tools = std::move(*tools);
  const std::lock_guard lock(mutex_);
  latest_ = std::move(now);
}

void FigureController::onRemoved() {
  interrupt("the simulation was closed or replaced while the figure was drawn");
  const std::lock_guard lock(mutex_);
  latest_.reset();
}

void FigureController::onImageChanged() { interrupt("the image was closed or replaced while the figure was drawn"); }

void FigureController::interrupt(const char *why) {
  if (drawing_) drawing_->interruption = why;
}

std::string figureCaption(double time_s, const std::vector<ProbeToolSample> &tools, const ui::DisplayUnits &units) {
  std::string text = fmt::format("t = {:.3f} s", time_s);
  for (const ProbeToolSample &tool : tools) {
    const double force_N = norm(tool.force_N);
    text += fmt::format("   {}: {}", tool.name,
                        ui::shownText(units, fmt::format("{:.3g} N", force_N < 1e-6 ? 0.0 : force_N)));
  }
  return text;
}

std::string FigureController::captionOf(const ui::SimulationView &simulation) {
  if (!simulation.exists) return {};
  const std::lock_guard lock(mutex_);
  return latest_ ? figureCaption(latest_->time_s, latest_->tools, units_)
                 : figureCaption(simulation.transport.time_s, {}, units_);
}

void FigureController::draw(const ui::SimulationView &simulation) {
  if (wanted_ && !drawing_) {
    const Wanted wanted = std::move(*wanted_);
    wanted_.reset();
    return begin(wanted, simulation);
  }
  if (!drawing_) return;
  Picture &picture = *drawing_->picture;
  {
    const std::lock_guard lock(picture.mutex);
    if (picture.isCancelled) return drawing_.reset();
  }
  if (!drawing_->interruption && visibilityOf(parts_.session.sceneGraph()) != drawing_->nodes)
    interrupt("objects were shown, hidden, added or removed while the figure was drawn");
  if (drawing_->interruption) return endDrawing(fail(ErrorCode::state, drawing_->interruption));
  if (auto drawn = drawing_->painter->drawNext(); !drawn) return endDrawing(tl::unexpected(drawn.error()));
  {
    const std::lock_guard lock(picture.mutex);
    picture.drawn = drawing_->painter->drawnCount();
  }
  if (drawing_->painter->drawnCount() == drawing_->painter->viewCount()) endDrawing(drawing_->painter->take());
  parts_.window.wake();
}

void FigureController::begin(const Wanted &wanted, const ui::SimulationView &simulation) {
  ui::WindowServices services;
  services.scene = &parts_.session.sceneGraph();
  services.images = &parts_.images.views();
  services.measurements = &parts_.measurements.list();
  services.measurementTools = &parts_.measurements.tools();
  parts_.session.plugins().syncScene();
  parts_.images.followNode();
  auto painter = ui::FigurePainter::create(
      parts_.renderer, services,
      {wanted.settings, parts_.window.viewsAspect(), parts_.window.camera(), simulation.title, captionOf(simulation)});
  if (!painter) return parts_.failed(wanted.failed, painter.error());
  drawing_ = std::make_unique<Drawing>();
  drawing_->painter = std::move(*painter);
  drawing_->picture = std::make_shared<Picture>();
  drawing_->nodes = visibilityOf(parts_.session.sceneGraph());
  drawing_->picture->count = drawing_->painter->viewCount();
  submit(drawing_->picture, wanted.name, wanted.settings.dpi, wanted.write, wanted.saved, wanted.failed);
  parts_.window.wake();
}

void FigureController::endDrawing(Expected<render::Image> result) {
  drawing_->picture->set(std::move(result));
  drawing_.reset();
}

void FigureController::submit(const std::shared_ptr<Picture> &picture, const std::string &name, double dpi, Write write,
                              const char *saved, const char *failed) {
  struct Written {
    std::filesystem::path file;
    int width = 0, height = 0;
  };
  const auto written = std::make_shared<Written>();
  (void)parts_.session.jobs().submit(
      kJobOwner, "Writing " + name,
      [picture, dpi, write = std::move(write), written](const ProgressFn &progress) -> Expected<void> {
        const auto image = picture->wait(progress);
        if (!image) return tl::unexpected(image.error());
        (void)progress(kDrawingFraction, "encoding PNG");
        const auto bytes = render::encodePng(*image, dpi);
        if (!bytes) return tl::unexpected(bytes.error());
        if (!progress(1.0, "writing")) return fail(ErrorCode::cancelled, "cancelled; nothing was written");
        const auto file = write(*bytes);
        if (!file) return tl::unexpected(file.error());
        *written = {*file, image->width, image->height};
        return {};
      },
      [this, written, saved, failed, dpi](const Expected<void> &result) {
        if (!result) return parts_.failed(failed, result.error());
        std::string text = pathText(written->file);
        if (dpi > 0.0) text += fmt::format("\n{} × {} pixels, {} dpi", written->width, written->height, dpi);
        parts_.panels.notify(C3DE_LOG_INFO, saved, text);
      });
}

}  // namespace c3de::app
