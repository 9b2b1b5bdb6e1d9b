// SPDX-License-Identifier: Apache-2.0
#include "c3de/plugin_host/plugin_host.h"

#include <fmt/format.h>

#include <algorithm>

#include "c3de/core/assert.h"
#include "c3de/core/foreign_call.h"
#include "c3de/core/log.h"
#include "c3de/core/main_queue.h"
#include "host_state.h"
#include "last_error.h"
#include "library_file.h"
#include "negotiation.h"
#include "plugin_context.h"
#include "refusal.h"

namespace c3de::plugin_host {
namespace {

// No plugin has an id with a space, so nothing of a plugin goes with it.
constexpr const char *kHostOwner = "plugin host";

/// What a program answers whose plugin has ended it: as for a plugin that cannot be used.
constexpr int kExitCodeOfPlugins = 4;

struct Loaded {
  Candidate candidate;
  std::unique_ptr<PluginContext> context;
  std::size_t info;  ///< index in plugins()
  void *self = nullptr;
  bool started = false;
};

/// What the plugin said, or the name of the status; one line.
std::string reasonOf(c3de_status status) {
  std::string text = takeLastError();
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text.empty() ? statusName(status) : fmt::format("{} ({})", text, statusName(status));
}

/// Calls one of the plugin's entry functions and gives the reason when it failed.
template <class F>
Expected<void> call(const PluginContext &context, const char *what, F &&f) {
  setLastError(std::string_view());
  c3de_status status = C3DE_E_EXCEPTION;
  try {
    const ForeignCall guarded(context.callName(), what, CallKind::prompt);
    status = f();
  } catch (...) {
    return fail(ErrorCode::plugin, fmt::format("an exception left {}: {}", what, textOfException()));
  }
  if (status < 0) return fail(ErrorCode::plugin, fmt::format("{} failed: {}", what, reasonOf(status)));
  return {};
}

}  // namespace

struct PluginHost::Impl {
  explicit Impl(const Services &services) : state(services) {
    nameWhoExits(kExitCodeOfPlugins);
    if (services.mainQueue) frame = services.mainQueue->addFrameCallback(kHostOwner, [this] { state.proxies.sync(); });
  }

  Expected<Loaded> tryLoad(const std::filesystem::path &file, PluginInfo &info);
  void destroy(Loaded &plugin);

  HostState state;
  Handle frame;
  mutable std::vector<PluginInfo> infos;
  std::vector<Loaded> loaded;
  std::vector<std::unique_ptr<PluginContext>> closed;  ///< stay, so that late calls are answered
};

PluginHost::PluginHost(const Services &services) : impl_(std::make_unique<Impl>(services)) {}

PluginHost::~PluginHost() {
  for (auto plugin = impl_->loaded.rbegin(); plugin != impl_->loaded.rend(); ++plugin) {
    if (!plugin->started) continue;
    const auto stopped = call(*plugin->context, "stop", [&] { return plugin->candidate.plugin.stop(plugin->self); });
    if (!stopped) log(LogLevel::warn, fmt::format("plugin {}: {}", plugin->candidate.id, stopped.error().message));
  }
  for (auto plugin = impl_->loaded.rbegin(); plugin != impl_->loaded.rend(); ++plugin) impl_->destroy(*plugin);
  if (impl_->state.services.mainQueue) impl_->state.services.mainQueue->removeFrameCallback(impl_->frame);
}

void PluginHost::Impl::destroy(Loaded &plugin) {
  plugin.context->drainPending();
  callPlugin(*plugin.context, "destroy", [&] { plugin.candidate.plugin.destroy(plugin.self); });
  plugin.context->revokeAll();
  closed.push_back(std::move(plugin.context));
}

Expected<Loaded> PluginHost::Impl::tryLoad(const std::filesystem::path &file, PluginInfo &info) {
  if (const auto checked = checkLibraryFile(file); !checked) return tl::unexpected(checked.error());
  const char *name = keptName(file.filename().string());  // it has not said its id yet
  const auto library = [&] {
    const ForeignCall loading(name, "loading of its library", CallKind::prompt);
    return DynamicLibrary::open(file);
  }();
  if (!library) return fail(ErrorCode::plugin, "cannot be loaded: " + library.error().message);
  auto candidate = [&] {
    const ForeignCall asking(name, C3DE_PLUGIN_QUERY_SYMBOL, CallKind::prompt);
    return negotiate(*library, state.services);
  }();
  if (!candidate) return tl::unexpected(candidate.error());
  info.id = candidate->id;
  info.version = candidate->version;
  info.displayName = candidate->displayName;
  info.vendor = candidate->vendor;
  info.license = candidate->license;
  for (const Loaded &other : loaded)
    if (other.candidate.id == candidate->id)
      return fail(ErrorCode::plugin, fmt::format("shadowed: {} is loaded already from {}", candidate->id,
                                                 infos[other.info].path.string()));

  Loaded plugin{std::move(*candidate), nullptr, 0};
  plugin.context = std::make_unique<PluginContext>(state, plugin.candidate.id);
  const auto created = call(*plugin.context, "create",
                            [&] { return plugin.candidate.plugin.create(plugin.context->abi(), &plugin.self); });
  if (!created) {
    plugin.context->revokeAll();
    closed.push_back(std::move(plugin.context));
    return tl::unexpected(created.error());
  }
  return plugin;
}

Expected<void> PluginHost::load(const std::filesystem::path &file) {
  C3DE_ASSERT(std::this_thread::get_id() == impl_->state.mainThread, "plugins are loaded on the main thread");
  PluginInfo info;
  info.path = std::filesystem::absolute(file).lexically_normal();
  auto plugin = impl_->tryLoad(info.path, info);
  if (!plugin) {
    info.state = PluginState::refused;
    info.reason = plugin.error().message;
    std::replace(info.reason.begin(), info.reason.end(), '\n', ' ');
    const std::string line = fmt::format("plugin {} refused: {}", info.path.string(), info.reason);
    log(LogLevel::warn, line);
    impl_->infos.push_back(std::move(info));
    return fail(ErrorCode::plugin, line);
  }
  info.state = PluginState::loaded;
  log(LogLevel::debug, fmt::format("plugin {} {} loaded from {}", info.id, info.version, info.path.string()));
  plugin->info = impl_->infos.size();
  impl_->infos.push_back(std::move(info));
  impl_->loaded.push_back(std::move(*plugin));
  return {};
}

void PluginHost::loadFolder(const std::filesystem::path &folder) {
  std::error_code error;
  std::vector<std::filesystem::path> files;
  for (std::filesystem::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    if (it->path().extension() == pluginExtension()) files.push_back(it->path());
  std::sort(files.begin(), files.end());
  for (const auto &file : files) (void)load(file);  // the log and plugins() say what was refused
}

void PluginHost::start() {
  for (std::size_t i = 0; i < impl_->loaded.size();) {
    Loaded &plugin = impl_->loaded[i];
    if (plugin.started) {
      ++i;
      continue;
    }
    const auto started = call(*plugin.context, "start", [&] { return plugin.candidate.plugin.start(plugin.self); });
    if (started) {
      plugin.started = true;
      ++i;
      continue;
    }
    PluginInfo &info = impl_->infos[plugin.info];
    info.state = PluginState::refused;
    info.reason = started.error().message;
    log(LogLevel::warn, fmt::format("plugin {} refused: {}", info.path.string(), info.reason));
    impl_->destroy(plugin);
    impl_->loaded.erase(impl_->loaded.begin() + static_cast<std::ptrdiff_t>(i));
  }
}

void PluginHost::syncScene() { impl_->state.proxies.sync(); }

const std::vector<PluginInfo> &PluginHost::plugins() const {
  for (PluginInfo &info : impl_->infos) info.classes.clear();
  for (const ClassInfo &cls : impl_->state.classes.list({}))
    for (const Loaded &plugin : impl_->loaded)
      if (plugin.candidate.id == cls.plugin) impl_->infos[plugin.info].classes.push_back(cls.id);
  return impl_->infos;
}

bool PluginHost::isUsed(const std::string &serviceId) const {
  return std::any_of(impl_->loaded.begin(), impl_->loaded.end(),
                     [&](const Loaded &plugin) { return plugin.context->hasAskedFor(serviceId); });
}

std::vector<ClassInfo> PluginHost::classes() const { return impl_->state.classes.list({}); }

std::vector<std::string> PluginHost::classesWith(const std::string &interfaceId) const {
  std::vector<std::string> ids;
  for (const ClassInfo &cls : impl_->state.classes.list(interfaceId)) ids.push_back(cls.id);
  return ids;
}

Expected<c3de_object *> PluginHost::createObject(const std::string &classId) {
  try {
    return impl_->state.classes.create(classId);
  } catch (const std::exception &e) {
    return fail(ErrorCode::plugin, e.what());
  } catch (...) {
    return fail(ErrorCode::plugin, "an exception left the class " + classId);
  }
}

const char *PluginHost::ownerOf(const c3de_object *object) const { return impl_->state.classes.ownerOf(object); }

std::string PluginHost::takeError() { return takeLastError(); }
PluginError PluginHost::takeErrorAt() { return takeLastErrorAt(); }

}  // namespace c3de::plugin_host
