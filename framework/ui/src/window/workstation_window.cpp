// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/workstation_window.h"
#include "c3de/registry/command_registry.h"

#include <epoxy/gl.h>
#include <imgui.h>
#include <imgui_internal.h>  // ClosePopupToLevel

#include <algorithm>
#include <cmath>
#include <optional>

#include "c3de/abi/tools.h"
#include "c3de/core/background_jobs.h"
#include "c3de/core/log.h"
#include "c3de/registry/panel_registry.h"
#include "c3de/registry/parameter_registry.h"
#include "c3de/registry/tool_registry.h"
#include "c3de/render/image_renderer.h"
#include "c3de/render_gl/gl_renderer.h"
#include "c3de/scene/scene_graph.h"
#include "c3de/segmentation/scan_body.h"
#include "c3de/ui/slice_controller.h"
#include "c3de/ui/view_controller.h"
#include "logic/seen_inside.h"
#include "panels/imgui_panel.h"
#include "views/four_views.h"
#include "views/kept_views.h"
#include "window/chrome.h"
#include "window/dock.h"
#include "window/file_dialog.h"
#include "window/glfw_window.h"
#include "window/imgui_session.h"

namespace c3de::ui {
namespace {

constexpr double kFrameTime_s = 1.0 / 60.0;
constexpr double kIdleWait_s = 1.0, kCursorBlink_s = 0.25;
/// Frames after an event until everything that follows from it stands: popups and layout take one more frame each.
constexpr int kFramesToSettle = 3;
constexpr const char *kFrameExtensions = "pvd", *kStateExtensions = "c3dstate";
constexpr const char *kImageExtensions = "nrrd;nii;gz;mha";

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
  std::optional<KeptViews> views;
  registry::ToolRegistry noTools;
  std::optional<ViewController> viewController;
  std::optional<SliceController> sliceController;

  PixelRect area, view;  ///< as in FrameContext
  std::array<PixelRect, 4> panes{};
  std::uint32_t buttons = 0;
  std::optional<Pane> pressedPane;  ///< where the buttons that are down were pressed
  DoubleClick doubleClick;
  bool isRefining = false;  ///< the 3D view gets better by being drawn again
  std::uint64_t frame = 0;
  double lastFrame_s = 0.0, framesPerSecond = 0.0;
  int framesToSettle = kFramesToSettle;
  int framesToFit = 0;
  bool isMoving = false;  ///< something changes by itself: playing, jobs
  bool takesNews = true;  ///< the frame shows what is new, else what is there and what the input has made of it
  double frameBegan_s = 0.0;
  double newsFrame_s = 0.0;  ///< that the last frame took that showed what was new

  std::vector<OsEvent> takeEvents();
  void layOutAndCarryOut(FrameContext &context, const render::Renderer &renderer);
  void paint(render::Renderer &renderer);
  void takeInput(FrameContext &context, const std::vector<OsEvent> &events, const render::Renderer &renderer);
  void takeMouse(const OsEvent &event);
  void closeMenus();
  void takeKey(FrameContext &frame, const OsEvent &event);
  void layOut(FrameContext &frame, const render::Renderer &renderer);
  void carryOut(FrameContext &frame);
  void carryOut(FrameContext &frame, Command command);
  void quitOrAsk();
  /// The dialog of the scan's body is what is answered.
  [[nodiscard]] bool isScanAsked() const;
  void undo();
  void cancelTool();
  void resetLayout();
  void transport(const SimulationView &simulation, std::uint32_t action);
  void openDialog(bool isMesh);
  void openImageDialog(bool areLabels);
  void openExportDialog(Command command);
  void openStateDialog();
  void lookFrom(const Vec3 &meshDirection, const Vec3 &patientDirection);
  /// None: all of them.
  void resetView(std::optional<Pane> pane);
  void fitIfWanted();
  void measureRate(double now_s);
  void layOutPanes();
  bool handle(Pane pane, ViewInput input, const OsEvent &event);
  [[nodiscard]] ImageViews *shownImages() const {
    return services.images && services.images->image() ? services.images : nullptr;
  }
  /// Null over the side panel, an overlay or a menu.
  [[nodiscard]] std::optional<Pane> paneAt(double x, double y) const;
  [[nodiscard]] render::Viewport viewportOf(const PixelRect &rect) const;
};

std::optional<Pane> WorkstationWindow::Impl::paneAt(double x, double y) const {
  if (ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopupId | ImGuiPopupFlags_AnyPopupLevel)) return {};
  if (std::any_of(state.overlays.begin(), state.overlays.end(),
                  [&](const PixelRect &overlay) { return overlay.contains(x, y); }))
    return {};
  for (const Pane pane : {Pane::axial, Pane::sagittal, Pane::coronal, Pane::space})
    if (panes[static_cast<std::size_t>(pane)].contains(x, y)) return pane;
  return {};
}

/// With the position from the pane's upper left corner.
bool WorkstationWindow::Impl::handle(Pane pane, ViewInput input, const OsEvent &event) {
  const PixelRect &rect = panes[static_cast<std::size_t>(pane)];
  input.x = event.x - rect.x;
  input.y = event.y - rect.y;
  if (pane == Pane::space) return viewController->handle(input);
  if (state.region && state.region->handle(pane, input)) return true;
  ImageViews *images = shownImages();
  return images && sliceController->handle(*images, pane, input);
}

void WorkstationWindow::Impl::takeMouse(const OsEvent &event) {
  using Kind = OsEvent::Kind;
  ViewInput input;
  input.button = event.button;
  input.modifiers = event.modifiers;
  input.wheel = event.wheel;
  input.time_s = event.time_s;
  switch (event.kind) {
    case Kind::press: {
      // Events are told by where they happened, not by where the mouse is when the frame begins.
      const bool isFirst = buttons == 0;
      if (isFirst) pressedPane = paneAt(event.x, event.y);
      buttons |= event.button;
      input.kind = ViewInput::Kind::press;
      if (!pressedPane) break;
      ViewInput click = input;
      click.x = event.x;
      click.y = event.y;
      if (ImageViews *images = shownImages(); images && isFirst && doubleClick.press(*pressedPane, click)) {
        images->takeBackClick();
        images->setMaximised(images->maximised() ? std::nullopt : pressedPane);
        pressedPane.reset();  // the views have moved: the release belongs to none of them
        break;
      }
      if (ImageViews *images = shownImages(); images && isFirst) images->forgetClick();
      handle(*pressedPane, input, event);
      break;
    }
    case Kind::release:
      buttons &= ~event.button;
      input.kind = ViewInput::Kind::release;
      if (pressedPane) handle(*pressedPane, input, event);
      break;
    case Kind::move:
      input.kind = ViewInput::Kind::move;
      if (const auto pane = buttons != 0 ? pressedPane : paneAt(event.x, event.y)) handle(*pane, input, event);
      break;
    case Kind::wheel:
      input.kind = ViewInput::Kind::wheel;
      if (const auto pane = paneAt(event.x, event.y)) handle(*pane, input, event);
      break;
    default: break;
  }
}

/// And lists, those above a dialog as well; ImGui does it only with its own keyboard navigation.
void WorkstationWindow::Impl::closeMenus() {
  const ImVector<ImGuiPopupData> &open = ImGui::GetCurrentContext()->OpenPopupStack;
  int level = open.Size;
  while (level > 0 && !(open[level - 1].Window && (open[level - 1].Window->Flags & ImGuiWindowFlags_Modal))) --level;
  if (level == open.Size) return;
  ImGui::ClosePopupToLevel(level, true);
  state.isEscapeTaken = true;
}

void WorkstationWindow::Impl::takeKey(FrameContext &context, const OsEvent &event) {
  if (event.key == 0) return;
  const Command command = commandOfKey(event.key, event.modifiers);
  if (command == Command::quit && !event.isRepeat) return context.request(command);
  const ImGuiIO &io = ImGui::GetIO();
  const bool isPopupOpen = ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopupId | ImGuiPopupFlags_AnyPopupLevel);
  // A button of the mouse that is held over a slider counts as well, but one that drags in the view does not.
  if (event.key == keyEscape && !event.isRepeat && isPopupOpen && !io.WantTextInput && !fileDialog.isOpen())
    return closeMenus();
  // The dialog of the scan's body has steps of its own.
  if (command == Command::undo && isPopupOpen && !io.WantTextInput && isScanAsked()) return context.request(command);
  if (io.WantTextInput || isPopupOpen || (io.WantCaptureKeyboard && !pressedPane)) return;
  // Over a slice, its keys are the slice's: they are the same everywhere, but 1 is another thing for an image.
  if (const auto pane = paneAt(event.x, event.y);
      pane && *pane != Pane::space && shownImages() && ImageViews::isSliceKey(event.key, event.modifiers)) {
    ViewInput input;
    input.kind = ViewInput::Kind::key;
    input.key = event.key;
    input.modifiers = event.modifiers;
    handle(*pane, input, event);
    return;
  }
  if (event.isRepeat) return;
  if (event.key == keyEscape && state.region) {
    const bool isDragged = state.region->cancelDrag();
    // What a hand does in the 3D view, and a click that is awaited, end before it.
    const bool isEnded = !isDragged && buttons == 0 && !(shownImages() && shownImages()->isPicking());
    if (isEnded) endRegion(context, false);
    if (isDragged || isEnded) {
      state.isEscapeTaken = true;  // the dialog comes back in this frame
      return;
    }
  }
  if (event.key == keyEscape) {
    if (context.simulation.isLongStep() && actions.transport) actions.transport(C3DE_TRANSPORT_PAUSE);
    if (services.images) {
      services.images->cancel();
      services.images->cancelPick();
    }
    return cancelTool();
  }
  if (command != Command::none) return context.request(command);
  if (services.commands)
    if (const Handle found = services.commands->ofKey(event.key, event.modifiers); !found.isNull())
      return runPluginCommand(services, found);
  if (event.modifiers == 0 && services.tools && isFreeForTools(event.key))
    for (const registry::ToolRegistry::Entry &entry : services.tools->tools())
      if (entry.tool->shortcut == event.key) {
        services.tools->activate(entry.handle);
        return;
      }
  ViewInput input;
  input.kind = ViewInput::Kind::key;
  input.key = event.key;
  input.modifiers = event.modifiers;
  input.time_s = event.time_s;
  if (event.key >= 0x80) return;
  const auto pane = buttons != 0 ? pressedPane : paneAt(event.x, event.y);
  const bool isOfSlice = pane && *pane != Pane::space && services.tools && services.tools->worksInSlices();
  handle(isOfSlice ? *pane : Pane::space, input, event);
}

void WorkstationWindow::Impl::takeInput(FrameContext &context, const std::vector<OsEvent> &events,
                                        const render::Renderer &renderer) {
  viewController->setViewSize(static_cast<int>(view.w), static_cast<int>(view.h));
  const ImageViews *images = shownImages();
  const render::ImageScene scene = images ? images->scene() : render::ImageScene();
  state.isEscapeTaken = false;
  viewController->setCuts(scene.cutsProxies ? scene.cuts : std::vector<render::CutPlane>());
  viewController->setInsideFinder([&](const render::Ray &ray) -> std::optional<double> {
    std::optional<render::GridPlace> place;
    if (images && images->image()) {
      const imaging::VolumeGeometry &grid = images->image()->volume.geometry;
      place = {grid.size, grid.indexToWorld};
    }
    return seenInside(renderer, scene, place ? &*place : nullptr, ray);
  });
  for (const OsEvent &event : events) {
    switch (event.kind) {
      case OsEvent::Kind::focusLost:
        cancelTool();
        if (services.images) services.images->cancel();
        if (state.region) (void)state.region->cancelDrag();
        buttons = 0;
        break;
      case OsEvent::Kind::drop:
        if (actions.open && !event.files.empty()) actions.open({event.files, "mm", false});
        break;
      case OsEvent::Kind::keyDown: takeKey(context, event); break;
      case OsEvent::Kind::close: context.request(Command::quit); break;
      default: takeMouse(event);
    }
  }
  viewController->setInsideFinder(nullptr);
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
  area = {sideWidth + grip, top + barHeight, std::max(width - sideWidth - grip, 1.0f), middle - barHeight};
  layOutPanes();
  context.area = area;
  context.view = view;
  context.panes = panes;

  drawToolbar(context, {0, menuHeight, width, toolbarHeight});
  // Its first frame measures it: a window without height would not lay out what is in it.
  const float dockNeeds = isDockNeeded(context) ? std::max(state.dock.height, theme.px(60.0f)) : 0.0f;
  const float dockHeight = std::min(std::ceil(dockNeeds), std::floor(0.5f * middle));
  drawSidePanel(context, panels, {0, top, sideWidth, middle - dockHeight});
  drawDock(context, {0, top + middle - dockHeight, sideWidth, dockHeight});
  drawSplitter(context, {sideWidth, top, grip, middle});
  drawRegionBar(context, {area.x, top, area.w, barHeight});
  drawStatusBar(context, {0, height - statusHeight, width, statusHeight});
  drawViewDecorations(context);
  drawSliceDecorations(context, renderer);
  state.overlays.clear();
  drawViewPanels(context, panels);
  fileDialog.draw(context);
  drawShortcuts(context);
  drawMessages(context);
  drawAbout(context);
  drawPluginManager(context);
  drawScanBody(context);
  drawQuestion(context);
}

void WorkstationWindow::Impl::openDialog(bool isMesh) {
  FileDialog::Request request;
  request.title = isMesh ? "Open mesh" : "Open scene";
  request.extensions = !isMesh ? "toml" : services.meshExtensions ? services.meshExtensions() : std::string();
  request.asksMeshUnit = isMesh;
  request.chosen = [this](const std::filesystem::path &file, const std::string &unit) {
    if (actions.open) actions.open({{file}, unit, false});
  };
  fileDialog.open(std::move(request));
}

void WorkstationWindow::Impl::openImageDialog(bool areLabels) {
  FileDialog::Request request;
  request.title = areLabels ? "Open label map" : "Open image: a file, or any file of a DICOM series";
  request.chosen = [this, areLabels](const std::filesystem::path &file, const std::string &) {
    if (actions.open) actions.open({{file}, "mm", areLabels});
  };
  fileDialog.open(std::move(request));
}

void WorkstationWindow::Impl::openStateDialog() {
  FileDialog::Request request;
  request.title = "Load state";
  request.extensions = kStateExtensions;
  request.chosen = [this](const std::filesystem::path &file, const std::string &) {
    if (actions.loadState) actions.loadState(file);
  };
  fileDialog.open(std::move(request));
}

void WorkstationWindow::Impl::openExportDialog(Command command) {
  FileDialog::Request request;
  request.isSaving = true;
  std::function<void(const std::filesystem::path &)> action;
  const auto set = [&](const char *title, const std::string &extensions, const auto &wanted) {
    request.title = title;
    request.extensions = extensions;
    const std::string name = actions.proposeName ? actions.proposeName(command) : std::string();
    if (!name.empty()) request.proposed = name + "." + extensions.substr(0, extensions.find(';'));
    action = wanted;
  };
  switch (command) {
    case Command::exportFrame: set("Export simulation frame", kFrameExtensions, actions.exportFrame); break;
    case Command::exportImage: set("Export deformed image", kImageExtensions, actions.exportImage); break;
    case Command::exportDisplacement: set("Export displacement", kImageExtensions, actions.exportDisplacement); break;
    case Command::exportTissues: set("Export tissue table", "csv", actions.exportTissues); break;
    case Command::saveState: set("Save state", kStateExtensions, actions.saveState); break;
    default:
      set("Export surface", actions.surfaceExtensions ? actions.surfaceExtensions() : "obj", actions.exportSurface);
      break;
  }
  request.chosen = [action](const std::filesystem::path &file, const std::string &) {
    if (action) action(file);
  };
  fileDialog.open(std::move(request));
}

void WorkstationWindow::Impl::lookFrom(const Vec3 &meshDirection, const Vec3 &patientDirection) {
  lookAlong(camera, camera.upAxis == render::UpAxis::z ? patientDirection : meshDirection);
}

void WorkstationWindow::Impl::resetView(std::optional<Pane> pane) {
  ImageViews *images = shownImages();
  for (const Pane slice : kSlicePanes)
    if (images && pane.value_or(slice) == slice) images->view(slice).reset();
  if (pane.value_or(Pane::space) != Pane::space) return;
  lookFromStart(camera);
  framesToFit = 1;
}

void WorkstationWindow::Impl::quitOrAsk() {
  const std::string toLose = actions.unsaved ? actions.unsaved() : std::string();
  if (toLose.empty()) return window->requestClose();
  state.question = {"quit", "Quit C3DE?", toLose, {{"quit", "Quit"}, {"stay", "Stay"}}};
}

void WorkstationWindow::Impl::cancelTool() {
  viewController->cancel();
  sliceController->cancel();
}

bool WorkstationWindow::Impl::isScanAsked() const {
  return services.scanBody && services.scanBody->isShown() && !state.region && !state.question && !fileDialog.isOpen();
}

void WorkstationWindow::Impl::undo() {
  if (state.region) return state.region->undo();
  if (isScanAsked()) return services.scanBody->undo();
  // What a tool holds is let go, and is the first to be undone.
  if (services.tools) services.tools->cancelActive();
  state.history.follow(services.parameters, services.workflow, services.edits);
  state.history.undo();
}

void WorkstationWindow::Impl::resetLayout() {
  state.layout = {};
  state.layout.resetSections = true;
  if (ImageViews *images = shownImages()) images->setMaximised({});
}

void WorkstationWindow::Impl::transport(const SimulationView &simulation, std::uint32_t action) {
  // What a tool holds is gone with the state.
  if (action == C3DE_TRANSPORT_RESET || action == C3DE_TRANSPORT_STOP) cancelTool();
  if (actions.transport && simulation.exists) actions.transport(action);
}

void WorkstationWindow::Impl::carryOut(FrameContext &context, Command command) {
  const SimulationView &simulation = context.simulation;
  const auto call = [](const std::function<void()> &action) {
    if (action) action();
  };
  const auto onImage = [&](const auto &act) {
    if (ImageViews *images = shownImages()) act(*images);
  };
  const auto toggle = [&](bool ImageOptions::*flag) {
    onImage([flag](ImageViews &images) {
      ImageOptions options = images.options();
      options.*flag = !(options.*flag);
      images.setOptions(options);
    });
  };
  switch (command) {
    case Command::none: break;
    case Command::openMesh: openDialog(true); break;
    case Command::openScene: openDialog(false); break;
    case Command::openImage: openImageDialog(false); break;
    case Command::openLabels: onImage([&](ImageViews &) { openImageDialog(true); }); break;
    case Command::makeScanAlive:
      if (services.scanBody) services.scanBody->show(true);
      break;
    case Command::closeImage: onImage([&](ImageViews &) { call(actions.closeImage); }); break;
    case Command::reload: call(actions.reload); break;
    case Command::exportSurface:
    case Command::exportFrame:
    case Command::saveState:
      if (simulation.exists) openExportDialog(command);
      break;
    case Command::exportImage:
    case Command::exportDisplacement:
      if (simulation.exists && shownImages()) openExportDialog(command);
      break;
    case Command::exportTissues:
      if (simulation.exists && services.tissues && !services.tissues->rows.empty()) openExportDialog(command);
      break;
    case Command::screenshot: call(actions.screenshot); break;
    case Command::quit: quitOrAsk(); break;
    case Command::undo: undo(); break;
    case Command::redo: state.region ? state.region->redo() : state.history.redo(); break;
    case Command::fitView: framesToFit = 1; break;
    case Command::resetView: resetView(paneAt(context.mouseX, context.mouseY)); break;
    case Command::viewFront: lookFrom({0, 0, -1}, {0, 1, 0}); break;
    case Command::viewBack: lookFrom({0, 0, 1}, {0, -1, 0}); break;
    case Command::viewLeft: lookFrom({1, 0, 0}, {-1, 0, 0}); break;
    case Command::viewRight: lookFrom({-1, 0, 0}, {1, 0, 0}); break;
    case Command::viewTop: lookFrom({0, -1, 0}, {0, 0, -1}); break;
    case Command::viewBottom: lookFrom({0, 1, 0}, {0, 0, 1}); break;
    case Command::fourViews: onImage([](ImageViews &images) { images.setMaximised({}); }); break;
    case Command::onlySpace: onImage([](ImageViews &images) { images.setMaximised(Pane::space); }); break;
    case Command::resetSlices: onImage([](ImageViews &images) { images.resetViews(); }); break;
    case Command::crossHair: toggle(&ImageOptions::showsCrossHair); break;
    case Command::windowLevelMode: toggle(&ImageOptions::isWindowLevelMode); break;
    case Command::cutAxial: onImage([](ImageViews &images) { images.turnCut(Pane::axial); }); break;
    case Command::cutSagittal: onImage([](ImageViews &images) { images.turnCut(Pane::sagittal); }); break;
    case Command::cutCoronal: onImage([](ImageViews &images) { images.turnCut(Pane::coronal); }); break;
    case Command::resetLayout: resetLayout(); break;
    case Command::playPause:
      transport(simulation, simulation.transport.mode == C3DE_SIM_PLAYING ? C3DE_TRANSPORT_PAUSE : C3DE_TRANSPORT_PLAY);
      break;
    case Command::step: transport(simulation, C3DE_TRANSPORT_STEP); break;
    case Command::reset: transport(simulation, C3DE_TRANSPORT_RESET); break;
    case Command::stop: transport(simulation, C3DE_TRANSPORT_STOP); break;
    case Command::loadState:
      if (simulation.exists) openStateDialog();
      break;
    case Command::orbitTool:
      if (services.tools) services.tools->activate({});
      break;
    case Command::showShortcuts: state.showShortcuts = true; break;
    case Command::showMessages: state.showMessages = true; break;
    case Command::managePlugins: state.showPlugins = true; break;
    case Command::showAbout: state.showAbout = true; break;
  }
}

void WorkstationWindow::Impl::carryOut(FrameContext &context) {
  for (const Command command : std::exchange(context.commands, {})) carryOut(context, command);
}

void WorkstationWindow::Impl::fitIfWanted() {
  if (framesToFit <= 0 || !services.scene) return;
  const auto bounds = services.scene->bounds();
  if (!bounds) return;
  camera.fit(bounds->min, bounds->max, view.isEmpty() ? 1.0 : view.w / view.h);
  --framesToFit;
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
  // After a pause the rate starts anew.
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
  impl->viewController.emplace(impl->noTools, impl->camera);
  impl->sliceController.emplace(impl->noTools);
  return std::unique_ptr<WorkstationWindow>(new WorkstationWindow(std::move(impl)));
}

WorkstationWindow::WorkstationWindow(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

WorkstationWindow::~WorkstationWindow() {
  impl_->views.reset();
  impl_->imgui.reset();
  impl_->window.reset();
}

void WorkstationWindow::connect(const WindowServices &services, WindowActions actions) {
  impl_->services = services;
  impl_->actions = std::move(actions);
  registry::ToolRegistry &tools = services.tools ? *services.tools : impl_->noTools;
  impl_->viewController.emplace(tools, impl_->camera);
  impl_->sliceController.emplace(tools);
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
    const bool isDue = impl.window->hasEvents() || impl.framesToSettle > 0 || impl.isMoving || impl.isRefining ||
                       impl.window->closeRequested();
    const double sinceFrame_s = now_s - impl.lastFrame_s;
    if (isDue && sinceFrame_s >= kFrameTime_s) {
      impl.window->wait(0.0);
      break;
    }
    double wait_s = isDue ? kFrameTime_s - sinceFrame_s : kIdleWait_s;
    // The text cursor blinks, and a tooltip comes late.
    const bool isTimed = !isDue && (ImGui::GetIO().WantTextInput || impl.state.tooltip.isWaiting);
    if (isTimed) wait_s = std::min(wait_s, impl.state.tooltip.isWaiting ? kTooltipDelay_s : kCursorBlink_s);
    const double timedEnd_s = now_s + wait_s;
    // A message goes by itself.
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
  // Before anybody looks for what is new: what comes from here on asks for a frame of its own.
  (void)impl.window->takeWake();
  // Where frames are slow, input that came during one is answered by a quick one.
  const bool isSlow = impl.newsFrame_s > kFrameTime_s;
  impl.takesNews = !(impl.isMoving && isSlow && impl.takesNews && impl.window->hasEvents());
  impl.frameBegan_s = GlfwWindow::now_s();
  return impl.takesNews;
}

std::vector<OsEvent> WorkstationWindow::Impl::takeEvents() {
  window->wait(0.0);  // what has come since the frame was due
  std::vector<OsEvent> events = window->takeEvents(fileDialog.awaitsTyping());
  for (const OsEvent &event : events) imgui->take(*window, event);
  if (!events.empty())
    framesToSettle = kFramesToSettle;
  else if (framesToSettle > 0)
    --framesToSettle;
  if (!takesNews) framesToSettle = std::max(framesToSettle, 1);  // what is new waits
  return events;
}

void WorkstationWindow::Impl::layOutAndCarryOut(FrameContext &context, const render::Renderer &renderer) {
  carryOut(context);
  state.tooltip.isSeen = false;
  const float dockHeight = state.dock.height;
  const ImVector<ImGuiPopupData> &popups = ImGui::GetCurrentContext()->OpenPopupStack;
  const int popupCount = popups.Size;
  layOut(context, renderer);
  if (state.dock.height != dockHeight || state.sideRows.isSettling()) framesToSettle = std::max(framesToSettle, 2);
  // A dialog that comes by itself, with the end of a job: its first frame does not show it.
  if (popups.Size != popupCount) framesToSettle = kFramesToSettle;
  if (state.answer == std::pair<std::string, std::string>("quit", "quit")) window->requestClose();
  if (!state.tooltip.isSeen) state.tooltip = {};
  carryOut(context);
  fitIfWanted();
}

void WorkstationWindow::Impl::paint(render::Renderer &renderer) {
  const auto pixels = window->framebufferSize();
  if (pixels[0] <= 0 || pixels[1] <= 0) return;
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glViewport(0, 0, pixels[0], pixels[1]);
  glDisable(GL_SCISSOR_TEST);
  glClearColor(colour::kChrome.x, colour::kChrome.y, colour::kChrome.z, 1.0f);
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

  FrameContext context{impl.services,   impl.actions, simulation,      impl.imgui->theme(),
                       impl.automation, impl.state,   impl.fileDialog, impl.camera};
  impl.state.history.follow(impl.services.parameters, impl.services.workflow, impl.services.edits);
  context.windowSize = impl.window->windowSize();
  context.frame = ++impl.frame;
  context.framesPerSecond = impl.framesPerSecond;
  context.isFocused = impl.window->isFocused();
  context.area = impl.area;
  context.view = impl.view;
  context.panes = impl.panes;

  const std::vector<OsEvent> events = impl.takeEvents();
  impl.imgui->beginFrame();
  impl.automation.beginFrame();
  context.mouseX = ImGui::GetIO().MousePos.x;
  context.mouseY = ImGui::GetIO().MousePos.y;
  impl.takeInput(context, events, renderer);
  if (ImageViews *images = impl.shownImages()) {
    const std::optional<Pane> pane = impl.paneAt(context.mouseX, context.mouseY);
    images->setPointedAt(pane && *pane != Pane::space);
  }
  impl.layOutAndCarryOut(context, renderer);
  context.mouseButtons = impl.buttons;
  impl.automation.endFrame(context, GlfwWindow::now_s());
  impl.imgui->endFrame();

  impl.paint(renderer);
  impl.window->swap();
  if (impl.takesNews) impl.newsFrame_s = GlfwWindow::now_s() - impl.frameBegan_s;
  if (!events.empty())
    impl.automation.shown(
        context, static_cast<std::size_t>(std::count_if(events.begin(), events.end(), [](const OsEvent &event) {
          return event.kind == OsEvent::Kind::character;
        })));
}

void WorkstationWindow::wake() { impl_->window->wake(); }
bool WorkstationWindow::closeRequested() const { return impl_->window->closeRequested(); }
void WorkstationWindow::requestClose() { impl_->window->requestClose(); }
render::Camera &WorkstationWindow::camera() { return impl_->camera; }
int WorkstationWindow::viewWidth() const {
  return impl_->viewportOf(impl_->view.isEmpty() ? impl_->area : impl_->view).width;
}
int WorkstationWindow::viewHeight() const {
  return impl_->viewportOf(impl_->view.isEmpty() ? impl_->area : impl_->view).height;
}

void WorkstationWindow::requestFit() {
  // The first bounds may be those of a part of what is loaded.
  impl_->framesToFit = 3;
  impl_->window->wake();
}

void WorkstationWindow::writeAutomationState() { impl_->automation.writeNow(true); }

}  // namespace c3de::ui
