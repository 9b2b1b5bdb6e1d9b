// SPDX-License-Identifier: Apache-2.0
#include "window/glfw_window.h"

#include <epoxy/gl.h>
// epoxy first: it replaces the system's OpenGL header.
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>
#include <string_view>

#include "c3de/abi/tools.h"
#include "c3de/ui/commands.h"
#include "c3de/ui/file_browser.h"
#include "logic/window_size.h"

namespace c3de::ui {
namespace {

constexpr const char *kNeeded = "OpenGL 4.3 (core profile) is needed";
constexpr const char *kHelp = "; update the graphics driver, or use `c3de run SCENE.toml`, which needs no window";

std::string lastGlfwError() {
  const char *text = nullptr;
  glfwGetError(&text);
  return text ? text : "no reason given";
}

GLFWwindow *tryCreate(int major, int minor, int samples, const std::string &title, int width, int height) {
  glfwDefaultWindowHints();
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, major);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, minor);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
  glfwWindowHint(GLFW_SAMPLES, samples);
  glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
  return glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
}

/// OpenGL version of a context without requirements: for the message when the required one is refused.
std::string versionFound() {
  glfwDefaultWindowHints();
  glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);
  GLFWwindow *window = glfwCreateWindow(64, 64, "", nullptr, nullptr);
  if (!window) return "found no OpenGL at all (" + lastGlfwError() + ")";
  glfwMakeContextCurrent(window);
  const auto text = [](GLenum name) {
    const auto *found = reinterpret_cast<const char *>(glGetString(name));
    return std::string(found ? found : "?");
  };
  const std::string found = "found OpenGL " + text(GL_VERSION) + " (" + text(GL_RENDERER) + ")";
  glfwMakeContextCurrent(nullptr);
  glfwDestroyWindow(window);
  return found;
}

/// For a software renderer, anti-aliasing is too expensive for its benefit.
bool isSoftwareRenderer() {
  const auto *name = reinterpret_cast<const char *>(glGetString(GL_RENDERER));
  const std::string_view renderer(name ? name : "");
  for (const char *software : {"llvmpipe", "softpipe", "SwiftShader", "Software", "GDI Generic"})
    if (renderer.find(software) != std::string_view::npos) return true;
  return false;
}

/// Work area of the first screen, without bars and docks, in window units.
std::array<int, 2> workArea() {
  std::array<int, 2> size{};
  int x = 0, y = 0;
  if (GLFWmonitor *monitor = glfwGetPrimaryMonitor()) glfwGetMonitorWorkarea(monitor, &x, &y, &size[0], &size[1]);
  return size;
}

/// Factor by which GLFW_SCALE_TO_MONITOR enlarges a size: 1 where window units differ from pixels.
std::array<float, 2> enlargement() {
  std::array<float, 2> scale{1.0f, 1.0f};
#if !defined(__APPLE__)
  if (GLFWmonitor *monitor = glfwGetPrimaryMonitor()) glfwGetMonitorContentScale(monitor, &scale[0], &scale[1]);
#endif
  return scale;
}

/// Reduces the size by title bar and borders.
void fitIntoScreen(GLFWwindow *window) {
  std::array<int, 2> size{}, room = workArea();
  int left = 0, top = 0, right = 0, bottom = 0;
  glfwGetWindowSize(window, &size[0], &size[1]);
  glfwGetWindowFrameSize(window, &left, &top, &right, &bottom);
  if (room[0] <= 0 || room[1] <= 0) return;
  room = {std::max(room[0] - left - right, 1), std::max(room[1] - top - bottom, 1)};
  const std::array<int, 2> fitting = sizeThatFits(size, room, {1.0f, 1.0f});
  if (fitting != size) glfwSetWindowSize(window, fitting[0], fitting[1]);
}

std::uint32_t buttonOf(int button) {
  switch (button) {
    case GLFW_MOUSE_BUTTON_LEFT: return C3DE_BUTTON_LEFT;
    case GLFW_MOUSE_BUTTON_RIGHT: return C3DE_BUTTON_RIGHT;
    case GLFW_MOUSE_BUTTON_MIDDLE: return C3DE_BUTTON_MIDDLE;
    default: return 0;
  }
}

std::uint32_t modifiersOf(int mods) {
  return ((mods & GLFW_MOD_SHIFT) ? C3DE_MOD_SHIFT : 0u) | ((mods & GLFW_MOD_CONTROL) ? C3DE_MOD_CTRL : 0u) |
         ((mods & GLFW_MOD_ALT) ? C3DE_MOD_ALT : 0u);
}

/// Modifiers after a key event. X11 reports those before it, so the state of a modifier's own key is queried.
std::uint32_t modifiersAfter(GLFWwindow *window, int key, int mods) {
  struct Keys {
    int left, right;
    std::uint32_t modifier;
  };
  static constexpr Keys kKeys[] = {{GLFW_KEY_LEFT_SHIFT, GLFW_KEY_RIGHT_SHIFT, C3DE_MOD_SHIFT},
                                   {GLFW_KEY_LEFT_CONTROL, GLFW_KEY_RIGHT_CONTROL, C3DE_MOD_CTRL},
                                   {GLFW_KEY_LEFT_ALT, GLFW_KEY_RIGHT_ALT, C3DE_MOD_ALT}};
  std::uint32_t modifiers = modifiersOf(mods);
  for (const Keys &keys : kKeys) {
    if (key != keys.left && key != keys.right) continue;
    const bool isDown = glfwGetKey(window, keys.left) == GLFW_PRESS || glfwGetKey(window, keys.right) == GLFW_PRESS;
    modifiers = isDown ? modifiers | keys.modifier : modifiers & ~keys.modifier;
  }
  return modifiers;
}

OsEvent::Role roleOf(int key) {
  if (key == GLFW_KEY_LEFT_SHIFT || key == GLFW_KEY_RIGHT_SHIFT) return OsEvent::Role::shift;
  const bool isModifier = key >= GLFW_KEY_LEFT_SHIFT && key <= GLFW_KEY_RIGHT_SUPER;
  return isModifier ? OsEvent::Role::modifier : OsEvent::Role::other;
}

/// Key by its printed character, so that Ctrl+Q is Q on every keyboard.
std::uint32_t keyOf(int key, int scancode) {
  switch (key) {
    case GLFW_KEY_ESCAPE: return keyEscape;
    case GLFW_KEY_DELETE: return keyDelete;
    case GLFW_KEY_RIGHT: return keyRight;
    case GLFW_KEY_LEFT: return keyLeft;
    case GLFW_KEY_UP: return keyUp;
    case GLFW_KEY_DOWN: return keyDown;
    case GLFW_KEY_F1: return keyF1;
    case GLFW_KEY_F5: return keyF5;
    case GLFW_KEY_F12: return keyF12;
    case GLFW_KEY_SPACE: return ' ';
    default: break;
  }
  if (key >= GLFW_KEY_KP_0 && key <= GLFW_KEY_KP_9) return static_cast<std::uint32_t>('0' + key - GLFW_KEY_KP_0);
  const char *name = glfwGetKeyName(key, scancode);
  if (name && name[0] >= 'a' && name[0] <= 'z' && name[1] == '\0')
    return static_cast<std::uint32_t>(name[0] - 'a' + 'A');
  if (name && (name[0] == '[' || name[0] == ']' || name[0] == ',') && name[1] == '\0')
    return static_cast<std::uint32_t>(name[0]);
  // Digits by position: on some layouts the printed character of their keys is different.
  if ((key >= 'A' && key <= 'Z' && !name) || (key >= '0' && key <= '9')) return static_cast<std::uint32_t>(key);
  return 0;
}

}  // namespace

Expected<std::unique_ptr<GlfwWindow>> GlfwWindow::create(const std::string &title, int width, int height) {
  if (!glfwInit())
    return fail(ErrorCode::graphics,
                "no window can be opened: " + lastGlfwError() + ". " + kNeeded + " and a display" + kHelp);
  const std::array<int, 2> size = sizeThatFits({width, height}, workArea(), enlargement());
  width = size[0];
  height = size[1];
  std::unique_ptr<GlfwWindow> window(new GlfwWindow);
  for (const auto &[major, minor] : {std::array{4, 5}, std::array{4, 3}}) {
    window->window_ = tryCreate(major, minor, 4, title, width, height);
    if (!window->window_) window->window_ = tryCreate(major, minor, 0, title, width, height);
    if (window->window_) {
      glfwMakeContextCurrent(window->window_);
      if (isSoftwareRenderer()) {
        glfwMakeContextCurrent(nullptr);
        glfwDestroyWindow(window->window_);
        window->window_ = tryCreate(major, minor, 0, title, width, height);
        if (window->window_) glfwMakeContextCurrent(window->window_);
      }
      break;
    }
  }
  if (!window->window_) {
    const std::string reason = lastGlfwError();
    return fail(ErrorCode::graphics, std::string(kNeeded) + ", " + versionFound() + ": " + reason + kHelp);
  }
  fitIntoScreen(window->window_);
  // The loop limits its rate itself; waiting for the display as well would halve the rate of a slow renderer.
  glfwSwapInterval(isSoftwareRenderer() ? 0 : 1);
  window->installCallbacks();
  window->add(OsEvent::Kind::move);  // initial mouse position
  return window;
}

GlfwWindow::~GlfwWindow() {
  if (window_) {
    glfwMakeContextCurrent(nullptr);
    glfwDestroyWindow(window_);
  }
  glfwTerminate();
}

GlfwWindow &GlfwWindow::of(GLFWwindow *window) { return *static_cast<GlfwWindow *>(glfwGetWindowUserPointer(window)); }

OsEvent &GlfwWindow::add(OsEvent::Kind kind) {
  OsEvent event;
  event.kind = kind;
  event.modifiers = modifiers_;
  event.time_s = glfwGetTime();
  glfwGetCursorPos(window_, &event.x, &event.y);
  events_.push_back(std::move(event));
  return events_.back();
}

void GlfwWindow::installCallbacks() {
  using Kind = OsEvent::Kind;
  glfwSetWindowUserPointer(window_, this);
  glfwSetMouseButtonCallback(window_, [](GLFWwindow *w, int button, int action, int mods) {
    GlfwWindow &self = of(w);
    self.modifiers_ = modifiersOf(mods);
    if (buttonOf(button) != 0) self.add(action == GLFW_PRESS ? Kind::press : Kind::release).button = buttonOf(button);
  });
  glfwSetCursorPosCallback(window_, [](GLFWwindow *w, double x, double y) {
    OsEvent &event = of(w).add(Kind::move);
    event.x = x;
    event.y = y;
  });
  glfwSetScrollCallback(window_, [](GLFWwindow *w, double dx, double dy) {
    OsEvent &event = of(w).add(Kind::wheel);
    event.wheelX = dx;
    event.wheel = dy;
  });
  glfwSetKeyCallback(window_, [](GLFWwindow *w, int key, int scancode, int action, int mods) {
    GlfwWindow &self = of(w);
    self.modifiers_ = modifiersAfter(w, key, mods);
    OsEvent &event = self.add(action == GLFW_RELEASE ? Kind::keyUp : Kind::keyDown);
    event.key = keyOf(key, scancode);
    event.isRepeat = action == GLFW_REPEAT;
    event.role = roleOf(key);
    event.isAlt = key == GLFW_KEY_LEFT_ALT;
    event.rawKey = key;
    event.scanCode = scancode;
    event.rawModifiers = mods;
  });
  glfwSetCharCallback(window_,
                      [](GLFWwindow *w, unsigned character) { of(w).add(Kind::character).character = character; });
  glfwSetWindowFocusCallback(
      window_, [](GLFWwindow *w, int focused) { of(w).add(focused ? Kind::focusGained : Kind::focusLost); });
  glfwSetDropCallback(window_, [](GLFWwindow *w, int count, const char **paths) {
    OsEvent &event = of(w).add(Kind::drop);
    for (int i = 0; i < count; ++i) event.files.push_back(pathFromText(paths[i]));
  });
  glfwSetFramebufferSizeCallback(window_, [](GLFWwindow *w, int, int) { of(w).add(Kind::other); });
  glfwSetWindowRefreshCallback(window_, [](GLFWwindow *w) { of(w).add(Kind::other); });
  // The window decides, because it may ask first.
  glfwSetWindowCloseCallback(window_, [](GLFWwindow *w) {
    glfwSetWindowShouldClose(w, GLFW_FALSE);
    of(w).add(Kind::close);
  });
  glfwSetCursorEnterCallback(window_,
                             [](GLFWwindow *w, int entered) { of(w).add(entered ? Kind::move : Kind::leave); });
}

void GlfwWindow::wait(double timeout_s) {
  if (timeout_s > 0.0 && !isWoken_.load())
    glfwWaitEventsTimeout(timeout_s);
  else
    glfwPollEvents();
}

void GlfwWindow::wake() {
  // One empty event per frame is sufficient, however often a simulation publishes.
  if (!isWoken_.exchange(true)) glfwPostEmptyEvent();
}

bool GlfwWindow::closeRequested() const { return glfwWindowShouldClose(window_) != 0; }
void GlfwWindow::requestClose() { glfwSetWindowShouldClose(window_, GLFW_TRUE); }
void GlfwWindow::setTitle(const std::string &title) {
  if (title == title_) return;
  title_ = title;
  glfwSetWindowTitle(window_, title.c_str());
}

void GlfwWindow::swap() { glfwSwapBuffers(window_); }

std::array<int, 2> GlfwWindow::windowSize() const {
  std::array<int, 2> size{};
  glfwGetWindowSize(window_, &size[0], &size[1]);
  return size;
}

std::array<int, 2> GlfwWindow::framebufferSize() const {
  std::array<int, 2> size{};
  glfwGetFramebufferSize(window_, &size[0], &size[1]);
  return size;
}

float GlfwWindow::contentScale() const {
  float x = 1.0f, y = 1.0f;
  glfwGetWindowContentScale(window_, &x, &y);
  return std::max(x, y);
}

bool GlfwWindow::isFocused() const { return glfwGetWindowAttrib(window_, GLFW_FOCUSED) != 0; }
double GlfwWindow::now_s() { return glfwGetTime(); }

}  // namespace c3de::ui
