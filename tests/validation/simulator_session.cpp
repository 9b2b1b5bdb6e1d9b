// SPDX-License-Identifier: Apache-2.0
#include "simulator_session.h"

#include <cstring>
#include <stdexcept>

#include "c3de/core/background_jobs.h"
#include "c3de/core/main_queue.h"
#include "c3de/core/platform.h"
#include "c3de/core/thread_pool.h"
#include "c3de/plugin_host/plugin_host.h"
#include "c3de/scene/force_fields.h"
#include "c3de/scene/mesh_store.h"
#include "c3de/scene/scene_graph.h"
#include "c3de/scene/simulation_directory.h"
#include "support/catch.h"

namespace c3de::test {

namespace {

c3de_sim_placement toAbi(const SimulatorSession::Placement &placement) {
  c3de_sim_placement out{};
  out.size = sizeof out;
  for (std::size_t i = 0; i < 3; ++i) {
    out.position_m[i] = placement.position_m[i];
    out.rotation_deg[i] = placement.rotation_deg[i];
  }
  out.scale = placement.scale;
  if (placement.matrix) {
    out.flags = C3DE_SIM_PLACED_BY_MATRIX;
    std::copy(placement.matrix->begin(), placement.matrix->end(), out.matrix);
  }
  return out;
}

}  // namespace

struct SimulatorSession::Impl {
  explicit Impl(unsigned threads) : pool(threads) {
    services.pool = &pool;
    services.mainQueue = &mainQueue;
    services.jobs = &jobs;
    services.sceneGraph = &graph;
    services.meshes = &meshes;
    services.simulations = &simulations;
    services.forces = &forces;
    host = std::make_unique<plugin_host::PluginHost>(services);
    const auto file = std::filesystem::path(testPluginFolder()) / (std::string("pointbased") + pluginExtension());
    if (const auto loaded = host->load(file); !loaded) throw std::runtime_error(loaded.error().message);
    host->start();
    auto created = host->createObject("c3de.pointbased.WorldSimulator/1");
    if (!created) throw std::runtime_error(created.error().message);
    simulator = *created;
    const char *id = C3DE_IFACE_SIMULATOR_ID;
    const void *found = nullptr;
    if (simulator->vt->query(simulator, {id, std::strlen(id)}, 1, &found) != C3DE_OK)
      throw std::runtime_error("no simulator");
    table = static_cast<const c3de_simulator_v1 *>(found);
  }
  ~Impl() {
    if (simulator) simulator->vt->release(simulator);
  }

  ThreadPool pool;
  MainQueue mainQueue;
  BackgroundJobs jobs{mainQueue};
  scene::SceneGraph graph;
  scene::MeshStore meshes;
  scene::SimulationDirectory simulations;
  scene::ForceFields forces;
  plugin_host::Services services;
  std::unique_ptr<plugin_host::PluginHost> host;
  c3de_object *simulator = nullptr;
  const c3de_simulator_v1 *table = nullptr;
};

SimulatorSession::SimulatorSession(unsigned threads) : impl_(std::make_unique<Impl>(threads)) {}
SimulatorSession::~SimulatorSession() = default;

void SimulatorSession::check(c3de_status status, const char *what) {
  if (status < 0) throw std::runtime_error(std::string(what) + ": " + impl_->host->takeError());
}

void SimulatorSession::setWorld(const std::vector<c3de_param_value> &values) {
  check(impl_->table->set_world(impl_->simulator, values.data(), values.size(), sizeof(c3de_param_value)), "set_world");
}

c3de_handle SimulatorSession::addBody(geometry::LoadedMesh mesh, const Placement &placement,
                                      const std::vector<c3de_param_value> &values) {
  c3de_sim_body body{};
  body.size = sizeof body;
  body.params_stride = sizeof(c3de_param_value);
  body.name = {"body", 4};
  body.mesh = {impl_->meshes.add(std::move(mesh)).bits()};
  const c3de_sim_placement where = toAbi(placement);
  body.placement = &where;
  body.params = values.data();
  body.params_n = values.size();
  c3de_handle out{};
  check(impl_->table->add_body(impl_->simulator, &body, &out), "add_body");
  return out;
}

c3de_handle SimulatorSession::addObstacle(geometry::LoadedMesh mesh, const Placement &placement, double friction) {
  const c3de_param_value value = number("friction", friction);
  c3de_sim_obstacle obstacle{};
  obstacle.size = sizeof obstacle;
  obstacle.params_stride = sizeof(c3de_param_value);
  obstacle.name = {"obstacle", 8};
  obstacle.mesh = {impl_->meshes.add(std::move(mesh)).bits()};
  const c3de_sim_placement where = toAbi(placement);
  obstacle.placement = &where;
  obstacle.params = &value;
  obstacle.params_n = 1;
  c3de_handle out{};
  check(impl_->table->add_obstacle(impl_->simulator, &obstacle, &out), "add_obstacle");
  return out;
}

void SimulatorSession::step() {
  if (const auto ready = impl_->forces.apply({}, impl_->simulator, impl_->table); !ready)
    throw std::runtime_error(ready.error().message);
  check(impl_->table->step(impl_->simulator), "step");
}
void SimulatorSession::addForce(std::function<void(const c3de_force_call &)> apply) {
  impl_->forces.add({"test",
                     "test",
                     {},
                     [apply = std::move(apply)](const c3de_force_call &call) -> c3de_status {
                       apply(call);
                       return C3DE_OK;
                     },
                     {}});
}
void SimulatorSession::reset() { check(impl_->table->reset(impl_->simulator), "reset"); }

c3de_sim_status SimulatorSession::status() {
  c3de_sim_status out{};
  out.size = sizeof out;
  check(impl_->table->status(impl_->simulator, &out), "status");
  return out;
}

std::uint64_t SimulatorSession::stateHash() {
  std::uint64_t hash = 0;
  check(impl_->table->state_hash(impl_->simulator, &hash), "state_hash");
  return hash;
}

std::string SimulatorSession::report() {
  std::string text;
  const auto put = [](void *self, const void *bytes, std::uint64_t n) -> c3de_status {
    static_cast<std::string *>(self)->append(static_cast<const char *>(bytes), static_cast<std::size_t>(n));
    return C3DE_OK;
  };
  check(impl_->table->report(impl_->simulator, {&text, put}), "report");
  return text;
}

c3de_sim_body_info SimulatorSession::info(c3de_handle body) {
  c3de_sim_body_info out{};
  out.size = sizeof out;
  check(impl_->table->body_info(impl_->simulator, body, &out), "body_info");
  return out;
}

c3de_object *SimulatorSession::create(const std::string &classId) {
  auto created = impl_->host->createObject(classId);
  if (!created) throw std::runtime_error(created.error().message);
  return *created;
}

void SimulatorSession::remove(c3de_handle handle) { check(impl_->table->remove(impl_->simulator, handle), "remove"); }

c3de_object *SimulatorSession::phyxelSet(c3de_handle body) {
  const void *found = nullptr;
  const char *id = C3DE_POINTBASED_BODIES_ID;
  check(impl_->simulator->vt->query(impl_->simulator, {id, std::strlen(id)}, 1, &found), "query");
  c3de_object *set = nullptr;
  check(static_cast<const c3de_pointbased_bodies_v1 *>(found)->phyxels(impl_->simulator, body, &set), "phyxels");
  return set;
}

std::vector<double> SimulatorSession::read(c3de_handle body, std::uint32_t on, const char *field,
                                           std::uint32_t components) {
  const c3de_sim_body_info about = info(body);
  const std::uint64_t count = on == C3DE_SIM_ON_POINTS ? about.points : about.surface_points;
  std::vector<double> out(static_cast<std::size_t>(count) * components);
  check(impl_->table->read_field(impl_->simulator, body, on, {field, std::strlen(field)},
                                 {out.data(), count, components, C3DE_F64, 0}),
        "read_field");
  return out;
}

std::vector<Vec3> SimulatorSession::vectors(c3de_handle body, std::uint32_t on, const char *field) {
  const std::vector<double> numbers = read(body, on, field, 3);
  std::vector<Vec3> out(numbers.size() / 3);
  for (std::size_t i = 0; i < numbers.size(); ++i) out[i / 3][i % 3] = numbers[i];
  return out;
}

std::vector<Vec3> SimulatorSession::phyxels(c3de_handle body, const char *field) {
  return vectors(body, C3DE_SIM_ON_POINTS, field);
}

std::vector<Vec3> SimulatorSession::surfels(c3de_handle body, const char *field) {
  return vectors(body, C3DE_SIM_ON_SURFACE, field);
}

std::vector<double> SimulatorSession::phyxelMasses(c3de_handle body) {
  return read(body, C3DE_SIM_ON_POINTS, C3DE_SIM_FIELD_MASS, 1);
}

c3de_object *SimulatorSession::object() { return impl_->simulator; }
const c3de_simulator_v1 *SimulatorSession::table() { return impl_->table; }
std::string SimulatorSession::takeError() { return impl_->host->takeError(); }

c3de_param_value SimulatorSession::number(const char *id, double value) {
  c3de_param_value v{};
  v.size = sizeof v;
  v.type = C3DE_PARAM_F64;
  v.id = {id, std::strlen(id)};
  v.num = value;
  return v;
}

c3de_param_value SimulatorSession::vector(const char *id, const Vec3 &value) {
  c3de_param_value v = number(id, 0.0);
  v.type = C3DE_PARAM_VEC3;
  for (std::size_t i = 0; i < 3; ++i) v.vec[i] = value[i];
  return v;
}

}  // namespace c3de::test
