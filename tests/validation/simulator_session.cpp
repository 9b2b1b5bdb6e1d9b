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
    auto created = host->createObject("draft/c3de.pointbased.WorldSimulator/0");
    if (!created) throw std::runtime_error(created.error().message);
    simulator = *created;
    const char *id = C3DE_IFACE_SIMULATOR_ID;
    const void *found = nullptr;
    if (simulator->vt->query(simulator, {id, std::strlen(id)}, 1, &found) != C3DE_OK)
      throw std::runtime_error("no simulator");
    table = static_cast<const c3de_simulator_v0 *>(found);
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
  const c3de_simulator_v0 *table = nullptr;
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
  for (std::size_t i = 0; i < 3; ++i) body.position_m[i] = placement.position_m[i];
  body.scale = placement.scale;
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
  for (std::size_t i = 0; i < 3; ++i) obstacle.position_m[i] = placement.position_m[i];
  obstacle.scale = placement.scale;
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

c3de_object *SimulatorSession::phyxelSet(c3de_handle body) {
  c3de_object *set = nullptr;
  check(impl_->table->phyxels(impl_->simulator, body, &set), "phyxels");
  return set;
}

void SimulatorSession::remove(c3de_handle handle) { check(impl_->table->remove(impl_->simulator, handle), "remove"); }

std::vector<Vec3> SimulatorSession::phyxels(c3de_handle body, std::uint32_t field) {
  c3de_object *set = phyxelSet(body);
  const void *found = nullptr;
  const char *id = C3DE_IFACE_PHYXEL_SET_ID;
  check(set->vt->query(set, {id, std::strlen(id)}, 1, &found), "query");
  const auto *table = static_cast<const c3de_phyxel_set_v0 *>(found);
  std::vector<Vec3> out(static_cast<std::size_t>(table->count(set)));
  const c3de_status status = table->read(set, field, {out.data(), out.size(), 3, C3DE_F64, sizeof(Vec3)});
  set->vt->release(set);
  check(status, "read");
  return out;
}

std::vector<double> SimulatorSession::phyxelMasses(c3de_handle body) {
  c3de_object *set = phyxelSet(body);
  const void *found = nullptr;
  const char *id = C3DE_IFACE_PHYXEL_SET_ID;
  check(set->vt->query(set, {id, std::strlen(id)}, 1, &found), "query");
  const auto *table = static_cast<const c3de_phyxel_set_v0 *>(found);
  std::vector<double> out(static_cast<std::size_t>(table->count(set)));
  const c3de_status status = table->read(set, C3DE_FIELD_MASS, {out.data(), out.size(), 1, C3DE_F64, sizeof(double)});
  set->vt->release(set);
  check(status, "read");
  return out;
}

std::vector<Vec3> SimulatorSession::surfels(c3de_handle body, std::uint32_t field) {
  c3de_object *set = nullptr;
  check(impl_->table->surfels(impl_->simulator, body, &set), "surfels");
  const void *found = nullptr;
  const char *id = C3DE_IFACE_SURFEL_SET_ID;
  check(set->vt->query(set, {id, std::strlen(id)}, 1, &found), "query");
  const auto *table = static_cast<const c3de_surfel_set_v0 *>(found);
  std::vector<Vec3> out(static_cast<std::size_t>(table->count(set)));
  const c3de_status status = table->read(set, field, {out.data(), out.size(), 3, C3DE_F64, sizeof(Vec3)});
  set->vt->release(set);
  check(status, "read");
  return out;
}

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
