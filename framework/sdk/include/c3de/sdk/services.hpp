// SPDX-License-Identifier: Apache-2.0
// Typed wrappers of the host's services. Each is a value over a table that may be absent: test it with `if (service)`.
// Calls on an absent service answer C3DE_E_UNSUPPORTED. Threads are those of the table's functions.
#pragma once

#include <array>
#include <exception>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "c3de/sdk/guard.hpp"
#include "c3de/sdk/object.hpp"
#include "c3de/sdk/owned.hpp"
#include "c3de/sdk/view.hpp"

namespace c3de::sdk {

/// Base of the wrappers.
template <class Table>
class Service {
 public:
  Service() noexcept = default;
  explicit Service(Host host, std::uint32_t minRev = 1) noexcept : host_(host), table_(host.service<Table>(minRev)) {}
  explicit operator bool() const noexcept { return table_ != nullptr; }
  [[nodiscard]] const Table *table() const noexcept { return table_; }
  [[nodiscard]] Host host() const noexcept { return host_; }

 protected:
  /// Calls a slot; the failure carries the host's text.
  template <auto Slot, class... Args>
  [[nodiscard]] Result<void> call(Args... args) const {
    if (!table_) return absent();
    return host_.check((table_->*Slot)(table_->ctx, args...));
  }
  /// The same for a slot whose last argument is a handle to be owned.
  template <auto Slot, class Owner, class... Args>
  [[nodiscard]] Result<Owner> own(Args... args) const {
    c3de_handle handle{0};
    if (auto done = call<Slot>(args..., &handle); !done) return done.failure();
    return Owner(table_, handle);
  }
  [[nodiscard]] Failure absent() const {
    return {C3DE_E_UNSUPPORTED, std::string(kTableId<Table>) + " is not served in this run"};
  }

  Host host_;
  const Table *table_ = nullptr;
};

class Log : public Service<c3de_log_v1> {
 public:
  using Service::Service;
  void debug(std::string_view message) const noexcept { write(C3DE_LOG_DEBUG, message); }
  void info(std::string_view message) const noexcept { write(C3DE_LOG_INFO, message); }
  void warn(std::string_view message) const noexcept { write(C3DE_LOG_WARN, message); }
  void error(std::string_view message) const noexcept { write(C3DE_LOG_ERROR, message); }
  void write(std::uint32_t severity, std::string_view message) const noexcept {
    if (table_) table_->write(table_->ctx, severity, str(message));
  }
};

/// A class to offer; everything is copied by the host. `make` returns an object with a count of one.
struct ClassOffer {
  std::string_view id{}, label{}, doc{};
  std::vector<std::string_view> interfaces{};
  c3de_status(C3DE_CALL *create)(void *factory, c3de_object **out) = nullptr;
  void *factory = nullptr;
};

class Registry : public Service<c3de_registry_v1> {
 public:
  using Service::Service;

  Result<void> add(const ClassOffer &offer) const {
    std::vector<c3de_str> interfaces;
    for (const std::string_view id : offer.interfaces) interfaces.push_back(str(id));
    const c3de_class cls{sizeof(c3de_class), 1,
                         str(offer.id),      str(offer.label),
                         str(offer.doc),     interfaces.data(),
                         interfaces.size(),  offer.factory,
                         offer.create};
    return call<&c3de_registry_v1::add_class>(&cls);
  }
  /// Offers Derived, whose constructor takes Factory& (the plugin, or what its objects need); Factory must outlive it.
  template <class Derived, class Factory>
  Result<void> add(std::string_view id, std::string_view label, std::string_view doc, Factory &factory) const {
    ClassOffer offer{id, label, doc, {}, nullptr, &factory};
    for (const Interface &entry : Derived::interfaces()) offer.interfaces.push_back(entry.id);
    offer.create = [](void *self, c3de_object **out) noexcept -> c3de_status {
      return guard([&] { *out = make<Derived>(*static_cast<Factory *>(self)).detach()->abi(); });
    };
    return add(offer);
  }
  Result<void> remove(std::string_view id) const { return call<&c3de_registry_v1::remove_class>(str(id)); }

  /// A new object of a class, also of another plugin.
  Result<Ref<>> create(std::string_view classId) const {
    c3de_object *object = nullptr;
    if (auto done = call<&c3de_registry_v1::create>(str(classId), &object); !done) return done.failure();
    return Ref<>::adopt(object);
  }
  /// Ids of the classes that list an interface, all classes when it is empty; sorted.
  Result<std::vector<std::string>> classesWith(std::string_view interfaceId) const {
    std::vector<std::string> ids;
    const auto each = [](void *self, const c3de_class_info *info) noexcept -> c3de_status {
      return guard([&] { static_cast<std::vector<std::string> *>(self)->emplace_back(text(info->id)); });
    };
    if (auto done = call<&c3de_registry_v1::enum_classes>(str(interfaceId), &ids, +each); !done) return done.failure();
    return ids;
  }
};

using MeshHandle = Owned<c3de_mesh_v1, &c3de_mesh_v1::release>;

class Mesh : public Service<c3de_mesh_v1> {
 public:
  using Service::Service;
  /// @param unit  C3DE_UNIT_M, _MM or _CM, of the numbers in the file; _UNKNOWN: what it says, else mm
  Result<MeshHandle> load(std::string_view path, std::uint32_t unit, const c3de_progress *progress = nullptr) const {
    return own<&c3de_mesh_v1::load, MeshHandle>(str(path), unit, progress);
  }
  Result<MeshHandle> create(c3de_view positions_mm, c3de_view triangles) const {
    return own<&c3de_mesh_v1::create, MeshHandle>(positions_mm, triangles);
  }
  Result<c3de_mesh_info> info(c3de_handle mesh) const {
    c3de_mesh_info out{};
    out.size = sizeof out;
    if (auto done = call<&c3de_mesh_v1::info>(mesh, &out); !done) return done.failure();
    return out;
  }
  Result<std::string> report(c3de_handle mesh) const {
    TextSink sink;
    if (auto done = call<&c3de_mesh_v1::report>(mesh, sink.sink()); !done) return done.failure();
    return sink.take();
  }
  /// Borrowed until the mesh is released; mm.
  Result<Rows<const double, 3>> positions(c3de_handle mesh) const {
    c3de_view view{};
    if (auto done = call<&c3de_mesh_v1::positions>(mesh, &view); !done) return done.failure();
    return asRows<double, 3>(view, "mesh positions");
  }
  Result<Rows<const std::uint32_t, 3>> triangles(c3de_handle mesh) const {
    c3de_view view{};
    if (auto done = call<&c3de_mesh_v1::triangles>(mesh, &view); !done) return done.failure();
    return asRows<std::uint32_t, 3>(view, "mesh triangles");
  }
  Result<void> windingNumbers(c3de_handle mesh, c3de_view points_mm, std::span<double> out) const {
    return call<&c3de_mesh_v1::winding_numbers>(mesh, points_mm, mutableRows<double, 1>(out));
  }
};

using SceneNode = Owned<c3de_scene_v1, &c3de_scene_v1::remove_node>;

class Scene : public Service<c3de_scene_v1> {
 public:
  using Service::Service;
  Result<SceneNode> addNode(c3de_handle parent, std::string_view name) const {
    return own<&c3de_scene_v1::add_node, SceneNode>(parent, str(name));
  }
  /// Column-major, mm.
  Result<std::array<double, 16>> worldFromNode(c3de_handle node) const {
    std::array<double, 16> out{};
    if (auto done = call<&c3de_scene_v1::world_from_node>(node, out.data()); !done) return done.failure();
    return out;
  }
  Result<void> setVisible(c3de_handle node, bool visible) const {
    return call<&c3de_scene_v1::set_visible>(node, visible ? 1u : 0u);
  }
  Result<bool> isVisible(c3de_handle node) const {
    std::uint32_t visible = 0;
    if (auto done = call<&c3de_scene_v1::is_visible>(node, &visible); !done) return done.failure();
    return visible != 0;
  }
  Result<void> setBounds(c3de_handle node, const Vec3 &min, const Vec3 &max) const {
    return call<&c3de_scene_v1::set_bounds>(node, min.data(), max.data());
  }
};

struct Material {
  std::array<float, 4> colour{0.8f, 0.8f, 0.8f, 1.0f};  ///< sRGB and opacity
  bool twoSided = false;
  bool inSlices = false;  ///< lines, labels and spheres are drawn over the slices of an image, too
  [[nodiscard]] c3de_material abi() const noexcept {
    return {
        sizeof(c3de_material), twoSided ? 1u : 0u, {colour[0], colour[1], colour[2], colour[3]}, inSlices ? 1u : 0u};
  }
};

using Proxy = Owned<c3de_render_v1, &c3de_render_v1::destroy>;

/// What colours mean; the colours are borrowed.
struct Legend {
  std::string title, unit, note;
  double low = 0.0, high = 1.0;
  c3de_view colours{};  ///< comps 3 or 4, 2 rows at least, the one of `low` first
  [[nodiscard]] c3de_legend abi() const {
    return {sizeof(c3de_legend), 0, str(title), str(unit), str(note), low, high, colours};
  }
};

class Render : public Service<c3de_render_v1> {
 public:
  using Service::Service;
  Result<Proxy> createMesh(c3de_handle node, c3de_view positions, c3de_view triangles, const Material &material) const {
    const c3de_material m = material.abi();
    return own<&c3de_render_v1::create_mesh, Proxy>(node, positions, triangles, &m);
  }
  Result<Proxy> createSpheres(c3de_handle node, c3de_view centres, double radius, const Material &material) const {
    const c3de_material m = material.abi();
    return own<&c3de_render_v1::create_spheres, Proxy>(node, centres, radius, &m);
  }
  Result<Proxy> createLines(c3de_handle node, c3de_view points, float width_px, const Material &material) const {
    const c3de_material m = material.abi();
    return own<&c3de_render_v1::create_lines, Proxy>(node, points, width_px, &m);
  }
  Result<Proxy> createLabel(c3de_handle node, const Vec3 &at, std::string_view label, const Material &material) const {
    const c3de_material m = material.abi();
    return own<&c3de_render_v1::create_label, Proxy>(node, at.data(), str(label), &m);
  }
  /// @param attribute  C3DE_ATTR_*
  Result<void> update(c3de_handle proxy, std::uint32_t attribute, c3de_view values) const {
    return call<&c3de_render_v1::update>(proxy, attribute, values);
  }
  Result<void> setLabel(c3de_handle proxy, const Vec3 &at, std::string_view label) const {
    return call<&c3de_render_v1::set_label>(proxy, at.data(), str(label));
  }
  Result<void> setMaterial(c3de_handle proxy, const Material &material) const {
    const c3de_material m = material.abi();
    return call<&c3de_render_v1::set_material>(proxy, &m);
  }
  Result<void> setVisible(c3de_handle proxy, bool visible) const {
    return call<&c3de_render_v1::set_visible>(proxy, visible ? 1u : 0u);
  }
  /// False with a host of revision 1: nothing below is called then.
  [[nodiscard]] bool hasLegends() const noexcept { return table_ && table_->rev >= 2; }
  Result<Proxy> createLegend(c3de_handle node, const Legend &legend) const {
    if (!hasLegends()) return noLegends();
    const c3de_legend l = legend.abi();
    return own<&c3de_render_v1::create_legend, Proxy>(node, &l);
  }
  Result<void> setLegend(c3de_handle proxy, const Legend &legend) const {
    if (!hasLegends()) return noLegends();
    const c3de_legend l = legend.abi();
    return call<&c3de_render_v1::set_legend>(proxy, &l);
  }

 private:
  static Failure noLegends() { return {C3DE_E_UNSUPPORTED, "this host has no legends"}; }
};

using CollisionTree = Owned<c3de_collision_v1, &c3de_collision_v1::destroy>;

class Collision : public Service<c3de_collision_v1> {
 public:
  using Service::Service;
  Result<CollisionTree> create(c3de_view positions, c3de_view triangles) const {
    return own<&c3de_collision_v1::create, CollisionTree>(positions, triangles);
  }
  Result<void> refit(c3de_handle tree, c3de_view positions) const {
    return call<&c3de_collision_v1::refit>(tree, positions);
  }
  Result<void> rebuild(c3de_handle tree) const { return call<&c3de_collision_v1::rebuild>(tree); }
  /// First hit of each ray with t in [0, tMax]; out has one entry per ray.
  Result<void> rays(c3de_handle tree, std::span<const Vec3> origins, std::span<const Vec3> directions, double tMax,
                    std::span<c3de_ray_hit> out) const {
    if (out.size() != origins.size()) return sizes("rays", origins.size(), out.size());
    return call<&c3de_collision_v1::rays>(tree, rows<double, 3>(origins), rows<double, 3>(directions), tMax,
                                          out.data());
  }
  Result<c3de_ray_hit> ray(c3de_handle tree, const Vec3 &origin, const Vec3 &direction,
                           double tMax = std::numeric_limits<double>::infinity()) const {
    c3de_ray_hit hit{};
    if (auto done = rays(tree, {&origin, 1}, {&direction, 1}, tMax, {&hit, 1}); !done) return done.failure();
    return hit;
  }
  Result<void> segments(c3de_handle tree, std::span<const Vec3> from, std::span<const Vec3> to,
                        std::span<c3de_ray_hit> out) const {
    if (out.size() != from.size()) return sizes("segments", from.size(), out.size());
    return call<&c3de_collision_v1::segments>(tree, rows<double, 3>(from), rows<double, 3>(to), out.data());
  }
  /// @param maxDistances  one per point, or one for all
  Result<void> closest(c3de_handle tree, std::span<const Vec3> points, std::span<const double> maxDistances,
                       std::span<c3de_closest> out) const {
    if (out.size() != points.size()) return sizes("closest", points.size(), out.size());
    return call<&c3de_collision_v1::closest>(tree, rows<double, 3>(points), scalars(maxDistances), out.data());
  }
  /// Triangles that meet the sphere, ascending.
  Result<void> sphere(c3de_handle tree, const Vec3 &centre, double radius, std::vector<std::uint32_t> &out) const {
    if (!table_) return absent();
    if (out.size() < 32) out.resize(32);
    std::uint64_t needed = 0;
    c3de_status status = table_->sphere(table_->ctx, tree, centre.data(), radius, out.data(), out.size(), &needed);
    if (status == C3DE_S_TRUNCATED) {
      out.resize(static_cast<std::size_t>(needed));
      status = table_->sphere(table_->ctx, tree, centre.data(), radius, out.data(), out.size(), &needed);
    }
    if (status < 0) return host_.failure(status);
    out.resize(static_cast<std::size_t>(needed));
    return {};
  }
  /// Triangles of two trees, or of one, that are no farther apart (0: that meet), ascending; of revision 2.
  Result<void> pairs(c3de_handle first, c3de_handle second, double maxDistance,
                     std::vector<std::array<std::uint32_t, 2>> &out) const {
    if (!table_) return absent();
    if (table_->rev < 2) return Failure{C3DE_E_VERSION, "the host finds no pairs (c3de.collision/1 of revision 1)"};
    if (out.size() < 32) out.resize(32);
    std::uint64_t needed = 0;
    const auto ask = [&] {
      return table_->pairs(table_->ctx, first, second, maxDistance, out.front().data(), out.size(), &needed);
    };
    c3de_status status = ask();
    if (status == C3DE_S_TRUNCATED) {
      out.resize(static_cast<std::size_t>(needed));
      status = ask();
    }
    if (status < 0) return host_.failure(status);
    out.resize(static_cast<std::size_t>(needed));
    return {};
  }

 private:
  static Failure sizes(const char *what, std::size_t in, std::size_t out) {
    return {C3DE_E_ARG,
            std::string(what) + ": " + std::to_string(in) + " queries, room for " + std::to_string(out) + " results"};
  }
};

/// What a running job tells about itself.
class Progress {
 public:
  explicit Progress(const c3de_progress *progress) noexcept : progress_(progress) {}
  /// False: stop soon, somebody cancelled. fraction in 0 … 1, negative: unknown.
  [[nodiscard]] bool update(double fraction, std::string_view what) const noexcept {
    return !progress_ || progress_->update(progress_->self, fraction, str(what)) >= 0;
  }
  [[nodiscard]] const c3de_progress *abi() const noexcept { return progress_; }

 private:
  const c3de_progress *progress_;
};

class Jobs : public Service<c3de_jobs_v1> {
 public:
  using Service::Service;

  /// Calls body(begin, end) for disjoint ranges that cover [0, n). Serial when the service is absent. An exception of
  /// the body is thrown here when every range is done.
  template <class Body>
  void parallelFor(std::size_t n, std::size_t grain, Body &&body) const {
    if (!table_) {
      if (n > 0) body(std::size_t{0}, n);
      return;
    }
    struct Call {
      std::remove_reference_t<Body> &body;
      std::mutex mutex;
      std::exception_ptr thrown;
    } callState{body, {}, {}};
    const auto run = [](void *self, std::uint64_t begin, std::uint64_t end) noexcept {
      auto &state = *static_cast<Call *>(self);
      try {
        state.body(static_cast<std::size_t>(begin), static_cast<std::size_t>(end));
      } catch (...) {
        const std::lock_guard lock(state.mutex);
        if (!state.thrown) state.thrown = std::current_exception();
      }
    };
    table_->parallel_for(table_->ctx, n, grain, &callState, +run);
    if (callState.thrown) std::rethrow_exception(callState.thrown);
  }
  [[nodiscard]] unsigned threadCount() const noexcept { return table_ ? table_->thread_count(table_->ctx) : 1u; }

  using Run = std::function<Result<void>(Progress)>;       ///< on a worker
  using Done = std::function<void(const Result<void> &)>;  ///< on the main thread, once, also when cancelled
  /// Runs in the background with a progress bar. Main thread.
  Result<c3de_handle> submit(std::string_view title, Run run, Done done) const {
    auto box = std::make_unique<Box>(Box{std::move(run), std::move(done)});
    const c3de_job job{sizeof(c3de_job), 0, str(title), box.get(), &Box::runThunk, &Box::doneThunk};
    c3de_handle handle{0};
    if (auto submitted = call<&c3de_jobs_v1::submit>(&job, &handle); !submitted) return submitted.failure();
    (void)box.release();  // done() deletes it
    return handle;
  }
  Result<void> cancel(c3de_handle job) const { return call<&c3de_jobs_v1::cancel>(job); }

  struct State {
    double fraction = -1.0;
    std::string what;
  };
  /// A failure with C3DE_E_STALE once the job is finished.
  Result<State> progress(c3de_handle job) const {
    State state;
    TextSink what;
    if (auto done = call<&c3de_jobs_v1::progress>(job, &state.fraction, what.sink()); !done) return done.failure();
    state.what = what.take();
    return state;
  }

 private:
  struct Box {
    Run run;
    Done done;
    static c3de_status C3DE_CALL runThunk(void *self, const c3de_progress *progress) noexcept {
      return guard([&] { return static_cast<Box *>(self)->run(Progress(progress)); });
    }
    static void C3DE_CALL doneThunk(void *self, c3de_status status, c3de_str error) noexcept {
      const std::unique_ptr<Box> box(static_cast<Box *>(self));
      guardQuietly("job", [&] {
        if (!box->done) return;
        if (status < 0)
          box->done(Failure{status, std::string(text(error))});
        else
          box->done({});
      });
    }
  };
};

/// A function that the host calls at the start of every frame, until this goes.
class FrameCallback {
 public:
  FrameCallback() noexcept = default;

 private:
  friend class Time;
  // The function is declared first, so that the registration goes before it.
  std::unique_ptr<std::function<void()>> fn_;
  Owned<c3de_time_v1, &c3de_time_v1::remove_frame_callback> registration_;
};

class Time : public Service<c3de_time_v1> {
 public:
  using Service::Service;
  [[nodiscard]] std::uint64_t nowNs() const noexcept { return table_ ? table_->now_ns(table_->ctx) : 0; }
  [[nodiscard]] std::uint64_t frameIndex() const noexcept { return table_ ? table_->frame_index(table_->ctx) : 0; }
  void requestRedraw() const noexcept {
    if (table_) table_->request_redraw(table_->ctx);
  }
  /// Runs on the main thread before the next frame. Any thread.
  Result<void> postToMain(std::function<void()> fn) const {
    auto box = std::make_unique<std::function<void()>>(std::move(fn));
    if (auto posted = call<&c3de_time_v1::post_to_main>(static_cast<void *>(box.get()), &runOnce); !posted)
      return posted.failure();
    (void)box.release();  // runOnce deletes it
    return {};
  }
  Result<FrameCallback> addFrameCallback(std::function<void()> fn) const {
    FrameCallback callback;
    callback.fn_ = std::make_unique<std::function<void()>>(std::move(fn));
    c3de_handle handle{0};
    if (auto added = call<&c3de_time_v1::add_frame_callback>(static_cast<void *>(callback.fn_.get()), &run, &handle);
        !added)
      return added.failure();
    callback.registration_ = {table_, handle};
    return callback;
  }

 private:
  static void C3DE_CALL run(void *self) noexcept {
    guardQuietly("frame callback", [&] { (*static_cast<std::function<void()> *>(self))(); });
  }
  static void C3DE_CALL runOnce(void *self) noexcept {
    const std::unique_ptr<std::function<void()>> fn(static_cast<std::function<void()> *>(self));
    guardQuietly("posted function", [&] { (*fn)(); });
  }
};

class SimulationWatch {
 public:
  SimulationWatch() noexcept = default;
  SimulationWatch(SimulationWatch &&) noexcept = default;
  SimulationWatch &operator=(SimulationWatch &&other) noexcept {
    if (this == &other) return *this;
    owned_.reset();  // before its functions go, which the simulation's thread may be calling
    functions_ = std::move(other.functions_);
    owned_ = std::move(other.owned_);
    return *this;
  }
  ~SimulationWatch() = default;
  explicit operator bool() const noexcept { return static_cast<bool>(owned_); }

 private:
  friend class Simulation;
  struct Functions {
    std::function<void(c3de_handle)> added, removed;
    std::function<void(c3de_handle, std::uint64_t, double)> stepped;
  };
  std::unique_ptr<Functions> functions_;
  Owned<c3de_simulation_v1, &c3de_simulation_v1::unwatch> owned_;  // goes first
};

/// Simulations that run. From revision 2 of the service they can be found and watched.
class Simulation : public Service<c3de_simulation_v1> {
 public:
  using Service::Service;
  struct Running {
    c3de_handle node{};
    std::string title;
    Ref<> object;  ///< answers iface.simulator
  };
  /// Those that there are. Any thread.
  [[nodiscard]] Result<std::vector<Running>> all() const {
    if (!isOfRevision2()) return Failure{C3DE_E_VERSION, "the host does not list simulations (revision 1)"};
    std::vector<Running> found;
    const auto each = [](void *visitor, const c3de_simulation_info *info) noexcept -> c3de_status {
      return guard([&] {
        static_cast<std::vector<Running> *>(visitor)->push_back(
            {info->node, std::string(text(info->title)), Ref<>::share(info->object)});
      });
    };
    if (auto done = call<&c3de_simulation_v1::enum_simulations>(static_cast<void *>(&found), +each); !done)
      return done.failure();
    return found;
  }
  /// That of a node: RunningSimulator(*simulations.find(node)). C3DE_E_NOT_FOUND: there is none. Any thread.
  [[nodiscard]] Result<Ref<>> find(c3de_handle node) const {
    auto running = all();
    if (!running) return running.failure();
    for (Running &one : *running)
      if (one.node.v == node.v) return std::move(one.object);
    return Failure{C3DE_E_NOT_FOUND, "there is no simulation of this node"};
  }
  /// Empty functions are not called. added() is called for those that there are, too. Main thread.
  /// @param stepped  after every step, on the simulation's thread: node, steps, time in s
  [[nodiscard]] Result<SimulationWatch> watch(std::function<void(c3de_handle)> added,
                                              std::function<void(c3de_handle)> removed,
                                              std::function<void(c3de_handle, std::uint64_t, double)> stepped) const {
    if (!isOfRevision2()) return Failure{C3DE_E_VERSION, "the host does not tell of simulations (revision 1)"};
    using Functions = SimulationWatch::Functions;
    SimulationWatch out;
    out.functions_ = std::make_unique<Functions>(Functions{std::move(added), std::move(removed), std::move(stepped)});
    const c3de_simulation_watch abi{
        sizeof(c3de_simulation_watch), 0, out.functions_.get(),
        [](void *self, c3de_handle node) noexcept {
          guardQuietly("added", [&] {
            if (const auto &f = static_cast<Functions *>(self)->added) f(node);
          });
        },
        [](void *self, c3de_handle node) noexcept {
          guardQuietly("removed", [&] {
            if (const auto &f = static_cast<Functions *>(self)->removed) f(node);
          });
        },
        out.functions_->stepped ? +[](void *self, c3de_handle node, std::uint64_t steps, double time_s) noexcept {
          guardQuietly("stepped", [&] { static_cast<Functions *>(self)->stepped(node, steps, time_s); });
        } : nullptr};
    auto owned = own<&c3de_simulation_v1::watch, Owned<c3de_simulation_v1, &c3de_simulation_v1::unwatch>>(&abi);
    if (!owned) return owned.failure();
    out.owned_ = std::move(*owned);
    return out;
  }
  /// @param action  C3DE_TRANSPORT_*
  Result<void> transport(c3de_handle node, std::uint32_t action) const {
    return call<&c3de_simulation_v1::transport>(node, action);
  }
  Result<void> setTargetRate(c3de_handle node, double rate) const {
    return call<&c3de_simulation_v1::set_target_rate>(node, rate);
  }
  Result<c3de_sim_transport> state(c3de_handle node) const {
    c3de_sim_transport out{};
    out.size = sizeof out;
    if (auto done = call<&c3de_simulation_v1::state>(node, &out); !done) return done.failure();
    return out;
  }
  /// Runs on the simulation's thread between two steps, soon, also while paused. Any thread.
  Result<void> post(c3de_handle node, std::function<void()> fn) const {
    auto box = std::make_unique<std::function<void()>>(std::move(fn));
    const auto run = [](void *self) noexcept {
      const std::unique_ptr<std::function<void()>> owned(static_cast<std::function<void()> *>(self));
      guardQuietly("command to the simulation", [&] { (*owned)(); });
    };
    if (auto posted = call<&c3de_simulation_v1::post>(node, static_cast<void *>(box.get()), +run); !posted)
      return posted.failure();
    (void)box.release();
    return {};
  }

 private:
  [[nodiscard]] bool isOfRevision2() const noexcept { return table() != nullptr && table()->rev >= 2; }
};

/// A field that acts until it is destroyed or removed.
class ForceField {
 public:
  ForceField() noexcept = default;
  ForceField(ForceField &&) noexcept = default;
  ForceField &operator=(ForceField &&other) noexcept {
    if (this == &other) return *this;
    remove();  // before its function goes, which the simulation's thread may be calling
    apply_ = std::move(other.apply_);
    owned_ = std::move(other.owned_);
    return *this;
  }
  ~ForceField() = default;
  [[nodiscard]] c3de_handle handle() const noexcept { return owned_.handle(); }
  explicit operator bool() const noexcept { return static_cast<bool>(owned_); }
  /// When this returns, the function is not running and will not be called again. Not from the function itself.
  void remove() noexcept {
    owned_.reset();
    apply_.reset();
  }

 private:
  friend class Forces;
  using Apply = std::function<Result<void>(const c3de_force_call &)>;
  std::unique_ptr<Apply> apply_;
  Owned<c3de_forces_v1, &c3de_forces_v1::remove> owned_;  // goes first
};

/// Forces on the bodies of running simulations. Any thread.
class Forces : public Service<c3de_forces_v1> {
 public:
  using Service::Service;
  /// @param apply       adds forces to the points of a body before each step, on the simulation's thread; may throw
  /// @param simulation  its scene node, or 0: all
  Result<ForceField> add(std::string_view name, std::function<Result<void>(const c3de_force_call &)> apply,
                         c3de_handle simulation = {}) const {
    ForceField out;
    out.apply_ = std::make_unique<ForceField::Apply>(std::move(apply));
    const auto run = [](void *self, const c3de_force_call *call) noexcept -> c3de_status {
      return guard([&] { return (*static_cast<ForceField::Apply *>(self))(*call); });
    };
    const c3de_force_field field{sizeof(c3de_force_field), 0, str(name), out.apply_.get(), +run};
    auto owned = own<&c3de_forces_v1::add, Owned<c3de_forces_v1, &c3de_forces_v1::remove>>(simulation, &field);
    if (!owned) return owned.failure();
    out.owned_ = std::move(*owned);
    return out;
  }
};

/// Undo and Redo of the window. Main thread.
class History : public Service<c3de_history_v1> {
 public:
  using Service::Service;
  /// A step that has been done just now, for the menu as "Undo LABEL". The functions may fail or throw: the step is
  /// forgotten then. They are destroyed when the host forgets the step.
  Result<c3de_handle> add(std::string_view label, std::function<Result<void>()> undo,
                          std::function<Result<void>()> redo) const {
    auto box = std::make_unique<Step>(Step{std::move(undo), std::move(redo)});
    const c3de_edit edit{sizeof(c3de_edit), 1, str(label), box.get(), &undoThunk, &redoThunk, &releaseThunk};
    c3de_handle handle{0};
    if (auto done = call<&c3de_history_v1::add>(&edit, &handle); !done) return done.failure();
    (void)box.release();
    return handle;
  }
  /// Forgets a step; nothing when it is forgotten already.
  void remove(c3de_handle step) const { (void)call<&c3de_history_v1::remove>(step); }

 private:
  struct Step {
    std::function<Result<void>()> undo, redo;
  };
  static c3de_status C3DE_CALL undoThunk(void *self) noexcept {
    return guard([&] { return static_cast<Step *>(self)->undo(); });
  }
  static c3de_status C3DE_CALL redoThunk(void *self) noexcept {
    return guard([&] { return static_cast<Step *>(self)->redo(); });
  }
  static void C3DE_CALL releaseThunk(void *self) noexcept {
    guardQuietly("release of a step", [&] { delete static_cast<Step *>(self); });
  }
};

/// Images and label maps of the workstation, to be read. Any thread.
class Imaging : public Service<c3de_imaging_v1> {
 public:
  using Service::Service;

  struct Label {
    std::uint32_t value = 0;
    std::string name;
    std::array<float, 3> colour{};  ///< linear RGB
  };

  Result<std::vector<c3de_handle>> images() const { return handles<&c3de_imaging_v1::images>(); }
  Result<c3de_image_info> imageInfo(c3de_handle image) const {
    c3de_image_info out{};
    out.size = sizeof out;
    if (auto done = call<&c3de_imaging_v1::image_info>(image, &out); !done) return done.failure();
    return out;
  }
  /// Values at points of the world, mm; `outside` where there are no voxels.
  Result<void> sample(c3de_handle image, std::span<const Vec3> points_mm, std::span<double> out,
                      double outside = std::numeric_limits<double>::quiet_NaN()) const {
    return call<&c3de_imaging_v1::sample>(image, rows<double, 3>(points_mm), outside, mutableRows<double, 1>(out));
  }

  Result<std::vector<c3de_handle>> labelMaps() const { return handles<&c3de_imaging_v1::label_maps>(); }
  Result<c3de_label_map_info> labelMapInfo(c3de_handle map) const {
    c3de_label_map_info out{};
    out.size = sizeof out;
    if (auto done = call<&c3de_imaging_v1::label_map_info>(map, &out); !done) return done.failure();
    return out;
  }
  Result<void> labelsAt(c3de_handle map, std::span<const Vec3> points_mm, std::span<std::uint32_t> out) const {
    return call<&c3de_imaging_v1::labels_at>(map, rows<double, 3>(points_mm), mutableRows<std::uint32_t, 1>(out));
  }
  Result<std::vector<Label>> labels(c3de_handle map) const {
    std::vector<Label> out;
    const auto each = [](void *self, const c3de_label *label) noexcept -> c3de_status {
      return guard([&] {
        static_cast<std::vector<Label> *>(self)->push_back(
            {label->value, std::string(text(label->name)), {label->colour[0], label->colour[1], label->colour[2]}});
      });
    };
    if (auto done = call<&c3de_imaging_v1::enum_labels>(map, static_cast<void *>(&out), +each); !done)
      return done.failure();
    return out;
  }

 private:
  template <auto Slot>
  Result<std::vector<c3de_handle>> handles() const {
    // Again while others add some between the question and the answer.
    std::vector<c3de_handle> out;
    std::uint64_t needed = 0;
    do {
      out.resize(static_cast<std::size_t>(needed));
      if (auto done = call<Slot>(out.data(), static_cast<std::uint64_t>(out.size()), &needed); !done)
        return done.failure();
    } while (needed > out.size());
    out.resize(static_cast<std::size_t>(needed));
    return out;
  }
};

}  // namespace c3de::sdk
