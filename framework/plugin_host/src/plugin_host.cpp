// SPDX-License-Identifier: Apache-2.0
#include "c3de/plugin_host/plugin_host.h"
#include "c3de/core/file_path.h"

#include <fmt/format.h>

#include <algorithm>

#include "c3de/core/assert.h"
#include "c3de/core/crash_journal.h"
#include "c3de/core/log.h"
#include "c3de/core/main_queue.h"
#include "c3de/core/plugin_call.h"
#include "host_state.h"
#include "last_error.h"
#include "library_file.h"
#include "load_gate.h"
#include "negotiation.h"
#include "plugin_context.h"
#include "refusal.h"

namespace c3de::plugin_host {
namespace {

// No plugin has an id with a space, so removing a plugin never removes these.
constexpr const char *kHostOwner = "plugin host";

/// Exit code of a program that was ended by its plugin: the same as for a plugin that cannot be used.
constexpr int kExitCodeOfPlugins = 4;

struct Loaded {
  Candidate candidate;
  std::unique_ptr<PluginContext> context;
  std::size_t info;  ///< index in plugins()
  void *self = nullptr;
  bool started = false;
};

/// The plugin's error text, or the name of the status; one line.
std::string reasonOf(c3de_status status) {
  std::string text = takeLastError();
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text.empty() ? statusName(status) : fmt::format("{} ({})", text, statusName(status));
}

/// Calls one of the plugin's entry functions and returns the reason if it failed.
template <class F>
Expected<void> call(const PluginContext &context, const char *what, F &&f) {
  setLastError(std::string_view());
  c3de_status status = C3DE_E_EXCEPTION;
  try {
    const PluginCall guarded(context.callName(), what, CallKind::prompt);
    status = f();
  } catch (...) {
    return fail(ErrorCode::plugin, fmt::format("an exception left {}: {}", what, textOfException()));
  }
  if (status < 0) return fail(ErrorCode::plugin, fmt::format("{} failed: {}", what, reasonOf(status)));
  return {};
}

}  // namespace

struct PluginHost::Impl {
  Impl(const Services &services, const LoadRules &rules) : state(services), gate(rules) {
    reportPluginExits(kExitCodeOfPlugins);
    if (services.mainQueue) frame = services.mainQueue->addFrameCallback(kHostOwner, [this] { state.proxies.sync(); });
  }

  /// Stores in `info` what is learned about the plugin.
  Expected<Loaded> tryLoad(const std::filesystem::path &file, bool isNamed, PluginInfo &info);
  Expected<void> load(const std::filesystem::path &file, bool isNamed);
  void destroy(Loaded &plugin);

  HostState state;
  LoadGate gate;
  Handle frame;
  mutable std::vector<PluginInfo> infos;
  std::vector<Loaded> loaded;
  std::vector<std::unique_ptr<PluginContext>> closed;  ///< kept, so that late calls are refused
};

PluginHost::PluginHost(const Services &services, const LoadRules &rules)
    : impl_(std::make_unique<Impl>(services, rules)) {}

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

Expected<Loaded> PluginHost::Impl::tryLoad(const std::filesystem::path &file, bool isNamed, PluginInfo &info) {
  const auto notLoaded = [&](PluginState as, const std::string &why) {
    info.state = as;
    return fail(ErrorCode::plugin, why);
  };
  if (const std::string why = gate.reasonFileIsOff(file, isNamed); !why.empty())
    return notLoaded(PluginState::off, why);
  if (const auto checked = checkLibraryFile(file); !checked) return tl::unexpected(checked.error());
  if (const auto tried = gate.tryFirstUse(file); !tried) return tl::unexpected(tried.error());
  const char *name = internedName(file.filename().string());  // its id is not known yet
  const auto library = [&] {
    const PluginCall loading(name, "loading of its library", CallKind::prompt);
    return DynamicLibrary::open(file);
  }();
  if (!library) return fail(ErrorCode::plugin, "cannot be loaded: " + library.error().message);
  notePluginCode(name, library->codeRange());
  auto candidate = [&] {
    const PluginCall asking(name, C3DE_PLUGIN_QUERY_SYMBOL, CallKind::prompt);
    return negotiate(*library, state.services);
  }();
  if (!candidate) return tl::unexpected(candidate.error());
  info.id = candidate->id;
  info.version = candidate->version;
  info.displayName = candidate->displayName;
  info.vendor = candidate->vendor;
  info.license = candidate->license;
  notePluginCode(internedName(info.id), library->codeRange());
  if (const std::string why = gate.reasonIdIsOff(info.id, isNamed); !why.empty())
    return notLoaded(PluginState::off, why);
  for (const Loaded &other : loaded)
    if (other.candidate.id == candidate->id)
      return notLoaded(PluginState::shadowed,
                       fmt::format("{} is loaded already from {}", info.id, infos[other.info].path.string()));

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

Expected<void> PluginHost::Impl::load(const std::filesystem::path &file, bool isNamed) {
  C3DE_ASSERT(std::this_thread::get_id() == state.mainThread, "plugins are loaded on the main thread");
  PluginInfo info;
  info.path = normalPath(absolutePath(file));
  auto plugin = tryLoad(info.path, isNamed, info);
  if (!plugin) {
    info.reason = plugin.error().message;
    std::replace(info.reason.begin(), info.reason.end(), '\n', ' ');
    const std::string line = fmt::format("plugin {} {}: {}", info.path.string(), stateName(info.state), info.reason);
    log(info.state == PluginState::off ? LogLevel::debug : LogLevel::warn, line);
    infos.push_back(std::move(info));
    return fail(ErrorCode::plugin, line);
  }
  info.state = PluginState::loaded;
  log(LogLevel::debug, fmt::format("plugin {} {} loaded from {}", info.id, info.version, info.path.string()));
  plugin->info = infos.size();
  infos.push_back(std::move(info));
  loaded.push_back(std::move(*plugin));
  return {};
}

Expected<void> PluginHost::load(const std::filesystem::path &file) { return impl_->load(file, true); }

void PluginHost::loadFolder(const std::filesystem::path &folder) {
  std::error_code error;
  std::vector<std::filesystem::path> files;
  for (std::filesystem::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    if (it->path().extension() == pluginExtension()) files.push_back(it->path());
  std::sort(files.begin(), files.end());
  const auto isKnown = [&](const std::filesystem::path &file) {
    return std::any_of(impl_->infos.begin(), impl_->infos.end(), [&](const PluginInfo &info) {
      std::error_code ignored;
      return std::filesystem::equivalent(info.path, file, ignored);
    });
  };
  for (const auto &file : files)
    if (!isKnown(file)) (void)impl_->load(file, false);  // the log and plugins() report refusals
}

const char *stateName(PluginState state) {
  switch (state) {
    case PluginState::loaded: return "loaded";
    case PluginState::refused: break;
    case PluginState::shadowed: return "shadowed";
    case PluginState::off: return "off";
  }
  return "refused";
}

void PluginHost::start() {
  for (const std::string &name : impl_->gate.unmatched())
    log(LogLevel::warn, fmt::format("--without {}: no plugin has this id or file", name));
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
                     [&](const Loaded &plugin) { return plugin.context->hasRequested(serviceId); });
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
