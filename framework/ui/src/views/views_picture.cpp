// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/views_picture.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "c3de/render_gl/picture.h"
#include "c3de/scene/scene_graph.h"
#include "frame/file_dialog.h"
#include "frame/frame_without_window.h"
#include "views/four_views.h"
#include "views/plot_drawing.h"
#include "views/view_decorations.h"

namespace c3de::ui {
namespace {

constexpr render::Renderer::Background kPaper{{1, 1, 1, 1}, {1, 1, 1, 1}};
/// Legends of the renderer have larger text than slices in the window; in a figure all text has one size.
constexpr double kFigureLegends = kSmallText_px / render::Renderer::kLegendText_px;

struct Part {
  Pane pane;
  PixelRect rect;  ///< logical pixels
  int x, y, w, h;  ///< pixels of the picture, y down
};

/// All views of one picture: the texts of all are laid out at once, then the views are drawn one by one.
class ViewsPainter {
 public:
  struct Look {
    int width = 0, height = 0;  ///< pixels
    double scale = 1.0;         ///< pixels per logical pixel
    std::optional<FigureLook> figure{};
    std::string title{};
  };
  /// @param services  its images, if there are any, get the sizes of this picture
  ViewsPainter(render::Renderer &renderer, const WindowServices &services, const render::Camera &camera, Look look)
      : renderer_(renderer), services_(services), camera_(camera),
        look_(std::move(look)), size_{logical(look_.width), logical(look_.height)},
        frame_(size_[0], size_[1], static_cast<float>(look_.scale)) {
    image_.width = look_.width;
    image_.height = look_.height;
    const std::uint8_t background = look_.figure && look_.figure->isLight ? 255 : 0;
    image_.rgb.assign(std::size_t{3} * static_cast<std::size_t>(look_.width) * static_cast<std::size_t>(look_.height),
                      background);
    const PixelRect area{0, 0, static_cast<float>(size_[0]), static_cast<float>(size_[1])};
    panes_ = layOutViews(area, images());
    addParts();
  }

  [[nodiscard]] const PixelRect &space() const { return panes_[static_cast<std::size_t>(Pane::space)]; }
  render::Camera &camera() { return camera_; }

  [[nodiscard]] Expected<void> drawTexts() {
    if (!frame_.isReady())
      return fail(ErrorCode::graphics, "texts cannot be drawn: Dear ImGui does not start with this OpenGL");
    const FrameWithoutWindow::Use use(frame_);
    const WindowActions actions;
    SimulationView simulation;
    simulation.exists = true;
    simulation.title = look_.title;
    AutomationState automation{std::filesystem::path()};
    WindowState state;
    Modes modes(camera_);
    FileDialog dialog;
    FrameContext frame{services_, actions, simulation, frame_.theme(), automation, state, modes, dialog, camera_};
    frame.area = {0, 0, static_cast<float>(size_[0]), static_cast<float>(size_[1])};
    frame.view = space();
    frame.panes = panes_;
    frame.windowSize = size_;
    frame.mouseX = frame.mouseY = -1e9;  // read-outs are those of the cross-hair
    frame.figure = look_.figure ? &*look_.figure : nullptr;
    drawViewDecorations(frame);
    drawSliceDecorations(frame, renderer_);
    drawMeasurementsInSpace(frame);
    ImGui::Render();
    return {};
  }

  [[nodiscard]] std::size_t partCount() const { return parts_.size(); }
  [[nodiscard]] std::size_t drawnCount() const { return drawn_; }

  [[nodiscard]] Expected<void> drawNext() {
    const Part &part = parts_[drawn_];
    render::Renderer::PictureStyle style;
    style.scale = static_cast<float>(look_.figure ? kFigureLegends * look_.scale : look_.scale);
    style.isFinal = true;
    style.isLight = look_.figure && look_.figure->isLight;
    if (style.isLight) style.background = kPaper;
    renderer_.setPictureStyle(style);
    const auto picture = render::paintPicture(part.w, part.h, [&] { paint(part); });
    renderer_.setPictureStyle({});
    if (!picture) return tl::unexpected(picture.error());
    copyTo(part, *picture);
    ++drawn_;
    return {};
  }
  [[nodiscard]] render::Image take() { return std::move(image_); }

 private:
  [[nodiscard]] int logical(int pixels) const {
    return std::max(1, static_cast<int>(std::lround(pixels / look_.scale)));
  }
  [[nodiscard]] ImageViews *images() const {
    return services_.images && services_.images->image() ? services_.images : nullptr;
  }

  void addParts() {
    const auto pixel = [](float at, int logical, int pixels) {
      return static_cast<int>(std::lround(at * static_cast<float>(pixels) / static_cast<float>(logical)));
    };
    for (const Pane pane : {Pane::axial, Pane::sagittal, Pane::coronal, Pane::space}) {
      const PixelRect &r = panes_[static_cast<std::size_t>(pane)];
      if (r.isEmpty()) continue;
      Part part{pane, r, pixel(r.x, size_[0], look_.width), pixel(r.y, size_[1], look_.height), 0, 0};
      part.w = std::max(1, pixel(r.x + r.w, size_[0], look_.width) - part.x);
      part.h = std::max(1, pixel(r.y + r.h, size_[1], look_.height) - part.y);
      parts_.push_back(part);
    }
  }

  void paint(const Part &part) {
    showInSpace(renderer_, images());
    const render::Viewport port{0, 0, part.w, part.h};
    if (part.pane == Pane::space)
      renderer_.draw(camera_, port);
    else if (renderer_.images())
      drawSlice(renderer_, *images(), part.pane, port);
    frame_.draw(ImVec2(part.rect.x, part.rect.y), ImVec2(part.rect.w, part.rect.h), part.w, part.h);
  }

  void copyTo(const Part &part, const render::Image &picture) {
    const auto width = static_cast<std::size_t>(std::min(part.w, look_.width - part.x));
    const int height = std::min(part.h, look_.height - part.y);
    for (int row = 0; row < height; ++row) {
      const auto from = std::size_t{3} * static_cast<std::size_t>(row) * static_cast<std::size_t>(picture.width);
      const auto to = std::size_t{3} * (static_cast<std::size_t>(part.y + row) * static_cast<std::size_t>(look_.width) +
                                        static_cast<std::size_t>(part.x));
      std::copy_n(picture.rgb.begin() + static_cast<std::ptrdiff_t>(from), 3 * width,
                  image_.rgb.begin() + static_cast<std::ptrdiff_t>(to));
    }
  }

  render::Renderer &renderer_;
  WindowServices services_;
  render::Camera camera_;
  Look look_;
  std::array<int, 2> size_;  ///< logical pixels
  FrameWithoutWindow frame_;
  std::array<PixelRect, 4> panes_{};
  std::vector<Part> parts_;
  std::size_t drawn_ = 0;
  render::Image image_;
};

/// Slices that do not show the whole image show the same part of it in another size.
void keepSliceParts(const ImageViews &window, ImageViews &figure) {
  for (const Pane pane : kSlicePanes) {
    const SliceView &from = window.view(pane);
    SliceView &to = figure.view(pane);
    if (from.isFitted() || to.width() <= 1 || to.height() <= 1) continue;
    const double factor =
        std::max(static_cast<double>(from.width()) / to.width(), static_cast<double>(from.height()) / to.height());
    to.magnify(1.0 / factor);
  }
}

void chooseViews(ImageViews &images, FigureViews wanted) {
  switch (wanted) {
    case FigureViews::shown: break;
    case FigureViews::four: images.setMaximised({}); break;
    case FigureViews::space: images.setMaximised(Pane::space); break;
    case FigureViews::axial: images.setMaximised(Pane::axial); break;
    case FigureViews::sagittal: images.setMaximised(Pane::sagittal); break;
    case FigureViews::coronal: images.setMaximised(Pane::coronal); break;
  }
}

}  // namespace

Expected<render::Image> pictureOfViews(render::Renderer &renderer, ImageViews &images, scene::SceneGraph &scene,
                                       const std::string &title, int width, int height,
                                       const SpaceDirection &direction) {
  if (width < 1 || height < 1) return render::paintPicture(width, height, [] {});  // its error
  WindowServices services;
  services.scene = &scene;
  services.images = images.image() != nullptr ? &images : nullptr;
  render::Camera camera;
  if (services.images) viewOfImages(camera);
  camera.yaw = direction.yaw.value_or(camera.yaw);
  camera.pitch = direction.pitch.value_or(camera.pitch);
  camera.upAxis = direction.upAxis.value_or(camera.upAxis);
  ViewsPainter::Look look;
  look.width = width;
  look.height = height;
  look.title = title;
  ViewsPainter painter(renderer, services, camera, std::move(look));
  const PixelRect &space = painter.space();
  if (const auto bounds = scene.bounds(); bounds && !space.isEmpty())
    painter.camera().fit(bounds->min, bounds->max, space.w / space.h);
  if (auto laidOut = painter.drawTexts(); !laidOut) return tl::unexpected(laidOut.error());
  while (painter.drawnCount() < painter.partCount())
    if (auto drawn = painter.drawNext(); !drawn) return tl::unexpected(drawn.error());
  return painter.take();
}

struct FigurePainter::Impl {
  std::optional<ImageViews> images;  ///< as they were when the figure was requested
  std::optional<ViewsPainter> views;
};

Expected<std::unique_ptr<FigurePainter>> FigurePainter::create(render::Renderer &renderer,
                                                               const WindowServices &services, const Request &request) {
  const FigureSettings &settings = request.settings;
  if (const std::string problem = problemOf(settings, request.shownAspect, 0); !problem.empty())
    return fail(ErrorCode::usage, problem);
  auto impl = std::make_unique<Impl>();
  WindowServices used;
  used.scene = services.scene;
  used.measurements = services.measurements;
  used.measurementTools = services.measurementTools;
  if (services.images && services.images->image()) {
    impl->images.emplace(*services.images);
    used.images = &*impl->images;
    chooseViews(*impl->images, settings.views);
  }
  const FigureSize size = figureSize(settings, request.shownAspect);
  ViewsPainter::Look look;
  look.width = size.width;
  look.height = size.height;
  look.scale = size.scale;
  look.title = request.title;
  look.figure =
      FigureLook{settings.isLight, settings.hasAnnotations, settings.hasCaption ? request.caption : std::string()};
  impl->views.emplace(renderer, used, request.camera, std::move(look));
  if (impl->images) keepSliceParts(*services.images, *impl->images);
  if (auto laidOut = impl->views->drawTexts(); !laidOut) return tl::unexpected(laidOut.error());
  return std::unique_ptr<FigurePainter>(new FigurePainter(std::move(impl)));
}

FigurePainter::FigurePainter(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
FigurePainter::~FigurePainter() = default;
std::size_t FigurePainter::viewCount() const { return impl_->views->partCount(); }
std::size_t FigurePainter::drawnCount() const { return impl_->views->drawnCount(); }
Expected<void> FigurePainter::drawNext() { return impl_->views->drawNext(); }
render::Image FigurePainter::take() { return impl_->views->take(); }

Expected<render::Image> pictureOfPlots(const PlotList &plots, const FigureSettings &settings,
                                       std::optional<double> now_s) {
  constexpr double kAspect = 2.0;
  if (const std::string problem = problemOf(settings, kAspect, render::largestPictureSide()); !problem.empty())
    return fail(ErrorCode::usage, problem);
  const FigureSize size = figureSize(settings, kAspect);
  const int width = std::max(1, static_cast<int>(std::lround(size.width / size.scale))),
            height = std::max(1, static_cast<int>(std::lround(size.height / size.scale)));
  const FrameWithoutWindow frame(width, height, static_cast<float>(size.scale));
  if (!frame.isReady())
    return fail(ErrorCode::graphics, "texts cannot be drawn: Dear ImGui does not start with this OpenGL");
  const ImVec2 all(static_cast<float>(width), static_cast<float>(height));
  {
    const FrameWithoutWindow::Use use(frame);
    ImDrawList *list = ImGui::GetBackgroundDrawList();
    list->AddRectFilled(ImVec2(0, 0), all,
                        settings.isLight ? IM_COL32_WHITE : ImGui::GetColorU32(paletteOf(ThemeKind::dark).panel));
    ImGui::PushFont(frame.theme().small);
    (void)drawPlots(list, {6.0f, 4.0f, all.x - 12.0f, all.y - 8.0f}, plots, {now_s, std::nullopt, settings.isLight});
    ImGui::PopFont();
    ImGui::Render();
  }
  return render::paintPicture(size.width, size.height, [&] { frame.draw(ImVec2(0, 0), all, size.width, size.height); });
}

int largestFigureSide(bool hasFourViews) { return (hasFourViews ? 2 : 1) * render::largestPictureSide(); }

}  // namespace c3de::ui
