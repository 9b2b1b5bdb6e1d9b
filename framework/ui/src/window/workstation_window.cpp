// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/workstation_window.h"

#include <epoxy/gl.h>
#include <imgui.h>
#include <imgui_internal.h>  // ClosePopupToLevel

#include <algorithm>
#include <cmath>
#include <optional>

#include "c3de/abi/tools.h"
#include "c3de/core/background_jobs.h"
#include "c3de/core/log.h"
#include "c3de/core/path_text.h"
#include "c3de/registry/command_registry.h"
#include "c3de/render/image_renderer.h"
#include "c3de/render_gl/gl_renderer.h"
#include "c3de/scene/scene_graph.h"
#include "frame/dock.h"
#include "frame/file_dialog.h"
#include "logic/seen_inside.h"
#include "panels/imgui_panel.h"
#include "views/four_views.h"
#include "views/view_cache.h"
#include "views/view_decorations.h"
#include "window/chrome.h"
#include "window/execute_command.h"
#include "window/glfw_window.h"
#include "window/imgui_session.h"
#include "window/picture_textures.h"

namespace c3de::ui {
namespace {

constexpr double kFrameTime_s = 1.0 / 60.0;
constexpr double kIdleWait_s = 1.0, kCursorBlink_s = 0.25;
/// Frames after an event until all its effects are visible: popups and layout take one more frame each.
constexpr int kFramesToSettle = 3;

/// Closes the menus above a dialog; ImGui does this only with its own keyboard navigation. True if there were any.
bool closeMenus() {
  const ImVector<ImGuiPopupData> &open = ImGui::GetCurrentContext()->OpenPopupStack;
  int level = open.Size;
  while (level > 0 && !(open[level - 1].Window && (open[level - 1].Window->Flags & ImGuiWindowFlags_Modal))) --level;
  if (level == open.Size) return false;
  ImGui::ClosePopupToLevel(level, true);
  return true;
}

}  // namespace

struct WorkstationWindow::Impl {
  explicit Impl(const WindowOptions &options) : automation(options.automationState) {}

  std::unique_ptr<GlfwWindow> window;
  std::unique_ptr<ImGuiSession> imgui;
  AutomationState automation;
  WindowServices services;
  WindowActions actions;
  WindowState state;
  FileDialog fileDialog;
  ImGuiPanels panels;
  render::Camera camera;
  Modes modes{camera};
  std::optional<ViewCache> views;
  PictureTextures textures;

  PixelRect area, view;  ///< as in FrameContext
  std::array<PixelRect, 4> panes{};
  bool isRefining = false;  ///< the 3D view improves when it is drawn again
  std::function<bool()> isAskedToEnd;
  std::uint64_t frame = 0;
  double lastFrame_s = 0.0, framesPerSecond = 0.0;
  int framesToSettle = kFramesToSettle;
  bool isMoving = false;     ///< something changes without input: playing, jobs
  bool showsNewData = true;  ///< the frame shows new data; otherwise the existing data and the effect of the input
  std::vector<Command> requested;  ///< by the program
  double frameBegan_s = 0.0;
  double newDataFrame_s = 0.0;  ///< time of the last frame that showed new data

  std::vector<OsEvent> takeEvents();
  void layOutAndCarryOut(FrameContext &context, const render::Renderer &renderer);
  void paint(render::Renderer &renderer);
  void takeInput(FrameContext &context, const std::vector<OsEvent> &events, const render::Renderer &renderer);
  void handleKey(FrameContext &context, const OsEvent &event);
  [[nodiscard]] bool opensMenu(const FrameContext &context, const OsEvent &event);
  void layOut(FrameContext &frame, const render::Renderer &renderer);
  void executeCommands(FrameContext &frame);
  void fitIfWanted();
  void measureRate(double now_s);
  void layOutPanes();
  [[nodiscard]] ImageViews *shownImages() const {
    return services.images && services.images->image() ? services.images : nullptr;
  }
  [[nodiscard]] render::Viewport viewportOf(const PixelRect &rect) const;
};

void WorkstationWindow::Impl::handleKey(FrameContext &context, const OsEvent &event) {
  const Modes::Answer answer = modes.handleKey(event, context.above());
  if (answer.command != Command::none) context.request(answer.command);
  if (!answer.pluginCommand.isNull()) runPluginCommand(services, answer.pluginCommand);
  if (answer.closesMenus && closeMenus()) modes.consumeEscape();
  if (answer.endsLongStep && context.simulation.isLongStep() && actions.transport)
    actions.transport(C3DE_TRANSPORT_PAUSE);
}

/// Alt alone, or Alt and the first letter of a menu. What is open above the views keeps its keys.
bool WorkstationWindow::Impl::opensMenu(const FrameContext &context, const OsEvent &event) {
  const Modes::Above above = context.above();
  state.isMenuWanted = event.isAlt && !event.isRepeat && !above.isPopup && modes.buttons() == 0;
  if (event.modifiers != C3DE_MOD_ALT || event.key == 0 || above.isPopup) return false;
  if (services.commands && !services.commands->ofKey(event.key, event.modifiers).isNull()) return false;
  for (const char *id : {"file", "edit", "view", "simulation", "tools", "plugins", "help"})
    if (static_cast<std::uint32_t>(id[0] - 'a' + 'A') == event.key) {
      state.menuToOpen = id;
      return true;
    }
  return false;
}

void WorkstationWindow::Impl::takeInput(FrameContext &context, const std::vector<OsEvent> &events,
                                        const render::Renderer &renderer) {
  modes.beginFrame(panes, state.overlays);
  modes.lockChanges(context.simulation.replay != nullptr);
  ViewController &space = modes.space();
  space.setViewSize(static_cast<int>(view.w), static_cast<int>(view.h));
  const ImageViews *images = shownImages();
  const render::ImageScene scene = images ? images->scene() : render::ImageScene();
  space.setCuts(scene.cutsProxies ? scene.cuts : std::vector<render::CutPlane>());
  space.setInsideFinder([&](const render::Ray &ray) -> std::optional<double> {
    std::optional<render::GridGeometry> place;
    if (images && images->image()) {
      const imaging::VolumeGeometry &grid = images->image()->volume.geometry;
      place = {grid.size, grid.indexToWorld};
    }
    return seenInside(renderer, scene, place ? &*place : nullptr, ray);
  });
  for (const OsEvent &event : events) {
    switch (event.kind) {
      case OsEvent::Kind::focusLost:
        state.isMenuWanted = false;
        modes.loseFocus();
        break;
      case OsEvent::Kind::drop:
        if (actions.open && !event.files.empty()) actions.open({event.files, "mm", false});
        break;
      case OsEvent::Kind::keyDown:
        if (!opensMenu(context, event)) handleKey(context, event);
        break;
      case OsEvent::Kind::keyUp:
        if (std::exchange(state.isMenuWanted, false) && event.isAlt) state.menuToOpen = "file";
        break;
      case OsEvent::Kind::character:
        if (event.character == '?' && !context.above().isPopup && !context.above().isTyping)
          context.request(Command::showShortcuts);
        break;
      case OsEvent::Kind::close: context.request(Command::quit); break;
      default:
        if (event.kind == OsEvent::Kind::press) state.isMenuWanted = false;
        modes.handleMouse(event, context.above());
    }
  }
  space.setInsideFinder(nullptr);
}

void WorkstationWindow::Impl::layOutPanes() {
  panes = layOutViews(area, shownImages());
  view = panes[static_cast<std::size_t>(Pane::space)];
}

void WorkstationWindow::Impl::layOut(FrameContext &context, const render::Renderer &renderer) {
  const auto width = static_cast<float>(context.windowSize[0]), height = static_cast<float>(context.windowSize[1]);
  const Theme &theme = context.theme;
  const float menuHeight = drawMenuBar(context);
  const float toolbarHeight = std::round(ImGui::GetFrameHeight() * 1.15f + theme.px(11.0f));
  const float statusHeight = std::round(theme.small->FontSize + theme.px(12.0f));
  const float sideWidth =
      std::min(std::round(theme.px(state.layout.sideWidth)), std::max(width - theme.px(160.0f), 0.0f));
  const float grip = std::round(theme.px(5.0f));
  const float top = menuHeight + toolbarHeight, middle = std::max(height - top - statusHeight, 1.0f);
  const float barHeight = std::min(regionBarHeight(context), middle - 1.0f);
  const float timelineHeight = std::min(timelineBarHeight(context), middle - barHeight - 1.0f);
  const float plotsHeight =
      std::min(plotStripHeight(context), std::max(std::floor(0.7f * (middle - barHeight - timelineHeight)), 0.0f));
  area = {sideWidth + grip, top + barHeight, std::max(width - sideWidth - grip, 1.0f),
          middle - barHeight - timelineHeight - plotsHeight};
  layOutPanes();
  context.area = area;
  context.view = view;
  context.panes = panes;

  drawToolbar(context, {0, menuHeight, width, toolbarHeight});
  // Its first frame measures it: a window without height would not lay out its contents.
  const float dockNeeds = isDockNeeded(context) ? std::max(state.dock.height, theme.px(60.0f)) : 0.0f;
  const float dockHeight = std::min(std::ceil(dockNeeds), std::floor(0.5f * middle));
  drawSidePanel(context, panels, {0, top, sideWidth, middle - dockHeight});
  drawDock(context, {0, top + middle - dockHeight, sideWidth, dockHeight});
  drawSplitter(context, {sideWidth, top, grip, middle});
  drawRegionBar(context, {area.x, top, area.w, barHeight});
  drawPlotStrip(context, {area.x, area.y + area.h, area.w, plotsHeight});
  drawTimelineBar(context, {area.x, area.y + area.h + plotsHeight, area.w, timelineHeight});
  drawStatusBar(context, {0, height - statusHeight, width, statusHeight});
  drawViewDecorations(context);
  drawSliceDecorations(context, renderer);
  drawMeasurementsInSpace(context);
  state.overlays.clear();
  drawStartPage(context, textures);
  drawViewPanels(context, panels);
  fileDialog.draw(context);
  drawCommandPalette(context);
  drawShortcuts(context);
  drawMessages(context);
  drawAbout(context);
  drawPluginManager(context);
  drawScanBody(context);
  drawMissingFiles(context);
  drawStretchDialog(context);
  drawReportDialog(context);
  drawFigureDialog(context);
  drawPreferences(context);
  drawQuestion(context);
}

void WorkstationWindow::Impl::executeCommands(FrameContext &context) {
  for (const Command command : std::exchange(requested, {})) context.request(command);
  for (const Command command : std::exchange(context.commands, {})) ui::executeCommand(context, command);
}

void WorkstationWindow::Impl::fitIfWanted() {
  if (state.framesToFit <= 0 || !services.scene) return;
  const auto bounds = services.scene->bounds();
  if (!bounds) return;
  camera.fit(bounds->min, bounds->max, view.isEmpty() ? 1.0 : view.w / view.h);
  if (state.pose) {
    camera.focus = state.pose->focus;
    camera.yaw = state.pose->yaw;
    camera.pitch = state.pose->pitch;
    camera.distance = state.pose->distance;
  }
  if (--state.framesToFit == 0) state.pose.reset();
  framesToSettle = std::max(framesToSettle, 1);
}

render::Viewport WorkstationWindow::Impl::viewportOf(const PixelRect &rect) const {
  const auto size = window->windowSize(), pixels = window->framebufferSize();
  const double sx = size[0] > 0 ? static_cast<double>(pixels[0]) / size[0] : 1.0;
  const double sy = size[1] > 0 ? static_cast<double>(pixels[1]) / size[1] : 1.0;
  render::Viewport port;
  port.x = static_cast<int>(std::lround(rect.x * sx));
  port.width = std::max(1, static_cast<int>(std::lround(rect.w * sx)));
  port.height = std::max(1, static_cast<int>(std::lround(rect.h * sy)));
  port.y = pixels[1] - static_cast<int>(std::lround((rect.y + rect.h) * sy));
  return port;
}

void WorkstationWindow::Impl::measureRate(double now_s) {
  const double dt = now_s - lastFrame_s;
  lastFrame_s = now_s;
  // After a pause the rate is measured again from the start.
  const bool isContinuous = isMoving && dt > 0.0 && dt < 1.0;
  if (!isContinuous)
    framesPerSecond = 0.0;
  else
    framesPerSecond = framesPerSecond <= 0.0 ? 1.0 / dt : 0.9 * framesPerSecond + 0.1 / dt;
}

Expected<std::unique_ptr<WorkstationWindow>> WorkstationWindow::create(const WindowOptions &options) {
  auto impl = std::make_unique<Impl>(options);
  auto window = GlfwWindow::create(options.title, options.width, options.height);
  if (!window) return tl::unexpected(window.error());
  impl->window = std::move(*window);
  if (auto version = render::checkGlVersion(); !version) return tl::unexpected(version.error());
  impl->imgui = std::make_unique<ImGuiSession>(*impl->window);
  if (!impl->imgui->theme().note.empty()) log(LogLevel::info, impl->imgui->theme().note);
  return std::unique_ptr<WorkstationWindow>(new WorkstationWindow(std::move(impl)));
}

WorkstationWindow::WorkstationWindow(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

WorkstationWindow::~WorkstationWindow() {
  impl_->views.reset();
  impl_->textures.clear();
  impl_->imgui.reset();
  impl_->window.reset();
}

void WorkstationWindow::connect(const WindowServices &services, WindowActions actions) {
  impl_->services = services;
  impl_->actions = std::move(actions);
  impl_->modes.connect(services);
}

void WorkstationWindow::setPreferences(const Preferences &preferences) {
  impl_->state.preferences = preferences;
  impl_->fileDialog.setFirstFolder(pathFromText(preferences.folder));
  impl_->window->wake();
}

void WorkstationWindow::setAbout(AboutText about) { impl_->state.about = std::move(about); }

std::string WorkstationWindow::ask(const Question &question, render::Renderer &renderer) {
  Impl &impl = *impl_;
  impl.state.question = question;
  impl.framesToSettle = kFramesToSettle;
  while (impl.state.question && !closeRequested()) {
    (void)waitForFrame();
    drawFrame(renderer, {});
  }
  return impl.state.question ? question.answers.back().id : impl.state.answer.second;
}

bool WorkstationWindow::waitForFrame() {
  Impl &impl = *impl_;
  for (;;) {
    const double now_s = GlfwWindow::now_s();
    impl.automation.writeIfDue(now_s);
    if (impl.isAskedToEnd && impl.isAskedToEnd()) impl.window->requestClose();
    const bool isDue = impl.window->hasEvents() || impl.framesToSettle > 0 || impl.isMoving || impl.isRefining ||
                       impl.window->closeRequested();
    const double sinceFrame_s = now_s - impl.lastFrame_s;
    if (isDue && sinceFrame_s >= kFrameTime_s) {
      impl.window->wait(0.0);
      break;
    }
    double wait_s = isDue ? kFrameTime_s - sinceFrame_s : kIdleWait_s;
    // The text cursor blinks, and a tooltip appears with a delay.
    const bool isTimed = !isDue && (ImGui::GetIO().WantTextInput || impl.state.tooltip.isWaiting);
    if (isTimed) wait_s = std::min(wait_s, impl.state.tooltip.isWaiting ? kTooltipDelay_s : kCursorBlink_s);
    const double timedEnd_s = now_s + wait_s;
    // A message disappears automatically.
    const double end_s = impl.lastFrame_s + impl.state.dock.ends_s;
    const bool isEnding = !isDue && impl.state.dock.ends_s > 0.0;
    if (isEnding) wait_s = std::min(wait_s, std::max(end_s - now_s, 0.0));
    if (const double write_s = impl.automation.secondsUntilWrite(now_s); write_s >= 0.0)
      wait_s = std::min(wait_s, write_s);
    impl.window->wait(std::max(wait_s, 1e-4));
    if (impl.window->takeWake()) impl.framesToSettle = std::max(impl.framesToSettle, 1);
    if (isEnding && GlfwWindow::now_s() >= end_s - 1e-3) impl.framesToSettle = std::max(impl.framesToSettle, 1);
    if (isTimed && GlfwWindow::now_s() >= timedEnd_s - 1e-3) impl.framesToSettle = std::max(impl.framesToSettle, 1);
  }
  // Before new data is read: data that arrives later requests a separate frame.
  (void)impl.window->takeWake();
  // If frames are slow, input that arrived during one is answered by a fast one.
  const bool isSlow = impl.newDataFrame_s > kFrameTime_s;
  impl.showsNewData = !(impl.isMoving && isSlow && impl.showsNewData && impl.window->hasEvents());
  impl.frameBegan_s = GlfwWindow::now_s();
  return impl.showsNewData;
}

std::vector<OsEvent> WorkstationWindow::Impl::takeEvents() {
  window->wait(0.0);  // events since the frame was due
  std::vector<OsEvent> events = window->takeEvents(fileDialog.awaitsTyping());
  for (const OsEvent &event : events) imgui->take(*window, event);
  if (!events.empty())
    framesToSettle = kFramesToSettle;
  else if (framesToSettle > 0)
    --framesToSettle;
  if (!showsNewData) framesToSettle = std::max(framesToSettle, 1);  // new data is waiting
  return events;
}

void WorkstationWindow::Impl::layOutAndCarryOut(FrameContext &context, const render::Renderer &renderer) {
  executeCommands(context);
  state.tooltip.isSeen = false;
  const float dockHeight = state.dock.height;
  const ImVector<ImGuiPopupData> &popups = ImGui::GetCurrentContext()->OpenPopupStack;
  const int popupCount = popups.Size;
  layOut(context, renderer);
  if (state.dock.height != dockHeight || state.sideRows.isSettling()) framesToSettle = std::max(framesToSettle, 2);
  // A dialog that opens automatically when a job ends: its first frame does not show it.
  if (popups.Size != popupCount) framesToSettle = kFramesToSettle;
  if (!state.tooltip.isSeen) state.tooltip = {};
  executeCommands(context);
  if (state.answer == kQuit) window->requestClose();
  if (state.answer == kSaveAndQuit) {
    state.answer = {};
    saveSession(context, false, [this] {
      window->requestClose();
      window->wake();
    });
  }
  if (actions.title) window->setTitle(state.title = actions.title());
  fitIfWanted();
}

void WorkstationWindow::Impl::paint(render::Renderer &renderer) {
  const auto pixels = window->framebufferSize();
  if (pixels[0] <= 0 || pixels[1] <= 0) return;
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glViewport(0, 0, pixels[0], pixels[1]);
  glDisable(GL_SCISSOR_TEST);
  const ImVec4 chrome = colour::kChrome;
  glClearColor(chrome.x, chrome.y, chrome.z, 1.0f);
  glClear(GL_COLOR_BUFFER_BIT);
  if (actions.beforeDraw) actions.beforeDraw();
  if (!views) views.emplace();
  views->draw(renderer, shownImages(), camera,
              {area, panes, [&](const PixelRect &rect) { return viewportOf(rect); }, pixels});
  isRefining = !view.isEmpty() && shownImages() && renderer.images() && renderer.images()->wantsRefinement();
  glViewport(0, 0, pixels[0], pixels[1]);
  imgui->draw();
}

void WorkstationWindow::drawFrame(render::Renderer &renderer, const SimulationView &simulation) {
  Impl &impl = *impl_;
  impl.isMoving = (simulation.exists &&
                   (simulation.transport.mode == C3DE_SIM_PLAYING || simulation.transport.step_running_s > 0.0)) ||
                  (impl.services.jobs && !impl.services.jobs->running().empty());
  impl.measureRate(GlfwWindow::now_s());

  const Preferences &preferences = impl.state.preferences;
  impl.imgui->setLook(*impl.window, preferences.theme, preferences.fontSize_px);
  FrameContext context{impl.services, impl.actions, simulation,      impl.imgui->theme(), impl.automation,
                       impl.state,    impl.modes,   impl.fileDialog, impl.camera};
  context.windowSize = impl.window->windowSize();
  context.frame = ++impl.frame;
  context.framesPerSecond = impl.framesPerSecond;
  context.isFocused = impl.window->isFocused();
  context.area = impl.area;
  context.view = impl.view;
  context.panes = impl.panes;

  const std::vector<OsEvent> events = impl.takeEvents();
  // Arrows and the focus ring are for menus and dialogs. In the views, arrows and Space have other meanings.
  const ImVector<ImGuiPopupData> &popups = ImGui::GetCurrentContext()->OpenPopupStack;
  ImGuiConfigFlags &flags = ImGui::GetIO().ConfigFlags;
  flags = popups.Size > 0 ? flags | ImGuiConfigFlags_NavEnableKeyboard : flags & ~ImGuiConfigFlags_NavEnableKeyboard;
  const int popupCount = popups.Size;
  impl.imgui->beginFrame();
  const bool isPopupClosed = popups.Size < popupCount;
  impl.automation.beginFrame();
  context.mouseX = ImGui::GetIO().MousePos.x;
  context.mouseY = ImGui::GetIO().MousePos.y;
  impl.takeInput(context, events, renderer);
  if (isPopupClosed && ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape))) impl.modes.consumeEscape();
  if (ImageViews *images = impl.shownImages()) {
    const std::optional<Pane> pane = impl.modes.paneAt(context.mouseX, context.mouseY, context.above());
    images->setPointedAt(pane && *pane != Pane::space);
  }
  impl.layOutAndCarryOut(context, renderer);
  context.mouseButtons = impl.modes.buttons();
  impl.automation.endFrame(context, GlfwWindow::now_s());
  impl.imgui->endFrame();

  impl.paint(renderer);
  impl.window->swap();
  if (impl.showsNewData) impl.newDataFrame_s = GlfwWindow::now_s() - impl.frameBegan_s;
  if (!events.empty())
    impl.automation.shown(
        context, static_cast<std::size_t>(std::count_if(events.begin(), events.end(), [](const OsEvent &event) {
          return event.kind == OsEvent::Kind::character;
        })));
}

void WorkstationWindow::wake() { impl_->window->wake(); }
bool WorkstationWindow::closeRequested() const { return impl_->window->closeRequested(); }
void WorkstationWindow::closeWhen(std::function<bool()> isAskedToEnd) { impl_->isAskedToEnd = std::move(isAskedToEnd); }
void WorkstationWindow::openReport() {
  impl_->state.report.isShown = true;
  impl_->state.report.isMeasured = false;
  wake();
}
void WorkstationWindow::requestClose() { impl_->window->requestClose(); }
render::Camera &WorkstationWindow::camera() { return impl_->camera; }
int WorkstationWindow::viewWidth() const {
  return impl_->viewportOf(impl_->view.isEmpty() ? impl_->area : impl_->view).width;
}
int WorkstationWindow::viewHeight() const {
  return impl_->viewportOf(impl_->view.isEmpty() ? impl_->area : impl_->view).height;
}

double WorkstationWindow::viewsAspect() const {
  return impl_->area.isEmpty() ? 1.0 : static_cast<double>(impl_->area.w / impl_->area.h);
}

std::optional<render::Image> WorkstationWindow::viewPicture() const {
  return impl_->views ? impl_->views->picture() : std::nullopt;
}

void WorkstationWindow::requestFit() {
  // The first bounds may be those of only a part of the loaded scene.
  impl_->state.framesToFit = 3;
  impl_->window->wake();
}

void WorkstationWindow::request(Command command) {
  impl_->requested.push_back(command);
  impl_->window->wake();
}

void WorkstationWindow::requestPose(const render::Camera &pose) {
  impl_->state.pose = pose;
  requestFit();
}

void WorkstationWindow::writeAutomationState() { impl_->automation.writeNow(true); }

}  // namespace c3de::ui
