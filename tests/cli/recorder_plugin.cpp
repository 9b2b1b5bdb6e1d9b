// SPDX-License-Identifier: Apache-2.0
// A simulator without physics that reports its input, so that tests of the program can compare it with the scene. The
// voxels that a body is filled from are reported by their sum and their centre in the frame of the mesh. It diverges at
// step 4 when a body starts with a velocity of 13 m/s along x, and finds nothing in a sphere of radius 666.
#include <array>
#include <cstdlib>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "c3de/sdk/sdk.hpp"
#include "c3de/sdk/simulator.hpp"

namespace {

namespace sdk = c3de::sdk;
using Json = nlohmann::json;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::array<c3de_str, 2> kIntegrators{sdk::str("explicit"), sdk::str("quasistatic")};
constexpr std::array kWorld{
    sdk::choiceParam({.id = "solver.integrator"}, kIntegrators, "explicit"),
    sdk::integerParam({.id = "solver.load_steps"}, {1.0, 1000.0, 1.0, 10.0}, 4.0),
};
constexpr std::array kBody{
    sdk::numberParam({.id = "material.density"}, {0.0, 1e6, 0.0, 1e4}, 1000.0),
    sdk::numberParam({.id = "material.plastic.yield"}, {0.0, kInfinity, 0.0, 1.0}, kInfinity),
    sdk::numberParam({.id = "material.prony1.share"}, {0.0, 1.0, 0.0, 1.0}, 0.0),
    sdk::numberParam({.id = "material.prony1.time"}, {0.0, 1e6, 0.0, 1.0}, 1.0),
};

Json vector(const double (&v)[3]) { return Json{v[0], v[1], v[2]}; }

Json json(const c3de_sim_region &r) {
  return {{"kind", r.kind}, {"a", vector(r.a)}, {"b", vector(r.b)}, {"radius", r.radius}};
}

Json json(const c3de_sim_motion &m) {
  return {{"has_centre", (m.flags & C3DE_SIM_HAS_CENTRE) != 0},
          {"displacement_m", vector(m.displacement_m)},
          {"rotation_deg", vector(m.rotation_deg)},
          {"centre_m", vector(m.centre_m)},
          {"ramp_s", m.ramp_s}};
}

Json json(const c3de_param_value *values, std::uint64_t n, std::uint64_t stride) {
  Json out = Json::object();
  for (std::uint64_t i = 0; i < n; ++i) {
    const c3de_param_value &value = sdk::strided(values, i, stride);
    out[std::string(sdk::text(value.id))] = value.num == kInfinity ? Json("inf") : Json(value.num);
  }
  return out;
}

Json json(const c3de_sim_fill *fill) {
  if (!fill) return nullptr;
  const c3de_sim_grid &grid = *fill->grid;
  double sum = 0.0, middle[3]{};
  const float *value = fill->values;
  for (std::uint64_t k = 0; k < grid.points[2]; ++k)
    for (std::uint64_t j = 0; j < grid.points[1]; ++j)
      for (std::uint64_t i = 0; i < grid.points[0]; ++i, ++value) {
        sum += *value;
        for (std::size_t a = 0; a < 3; ++a)
          middle[a] += *value * (grid.origin_m[a] + static_cast<double>(i) * grid.step_i_m[a] +
                                 static_cast<double>(j) * grid.step_j_m[a] + static_cast<double>(k) * grid.step_k_m[a]);
      }
  for (double &m : middle) m /= sum;
  return {{"points", {grid.points[0], grid.points[1], grid.points[2]}},
          {"sum", sum},
          {"middle_m", vector(middle)},
          {"step_i_m", vector(grid.step_i_m)},
          {"step_j_m", vector(grid.step_j_m)},
          {"step_k_m", vector(grid.step_k_m)}};
}

void findSomething(const c3de_sim_region &region, const char *table, std::uint32_t index) {
  if (region.radius == 666.0) throw sdk::Error(C3DE_E_ARG, "the region meets no part of the body", {table, index, {}});
}

class Recorder : public sdk::Object<Recorder> {
 public:
  template <class Factory>
  explicit Recorder(Factory &) {}
  static std::array<sdk::Interface, 1> interfaces();

  void attach(c3de_handle) {}
  void declarations(std::uint32_t scope, const c3de_param_decl **decls, std::uint64_t *n, std::uint64_t *stride) {
    *decls = scope == C3DE_SIM_SCOPE_WORLD ? kWorld.data() : kBody.data();
    *n = scope == C3DE_SIM_SCOPE_WORLD ? kWorld.size() : scope == C3DE_SIM_SCOPE_BODY ? kBody.size() : 0;
    *stride = sizeof(c3de_param_decl);
  }
  void setWorld(const c3de_param_value *values, std::uint64_t n, std::uint64_t stride) {
    for (std::uint64_t i = 0; i < n; ++i) {
      const c3de_param_value &value = sdk::strided(values, i, stride);
      if (sdk::text(value.id) == "solver.integrator") quasistatic_ = sdk::text(value.text) == "quasistatic";
      if (sdk::text(value.id) == "solver.load_steps") loadSteps_ = static_cast<std::uint64_t>(value.num);
    }
  }
  void addBody(const c3de_sim_body *in, c3de_handle *out) {
    if (const char *dies = std::getenv("C3DE_TEST_DIES"); dies && std::string_view(dies) == "add_body") std::abort();
    Json body{{"name", std::string(sdk::text(in->name))},
              {"velocity", vector(in->velocity_m_s)},
              {"angular_velocity", vector(in->angular_velocity_rad_s)},
              {"params", json(in->params, in->params_n, in->params_stride)},
              {"fixes", Json::array()},
              {"loads", Json::array()},
              {"parts", Json::array()},
              {"refinements", Json::array()},
              {"fill", json(in->fill)},
              {"colour", in->colour ? Json{in->colour[0], in->colour[1], in->colour[2]} : Json()}};
    for (std::uint64_t i = 0; i < in->fixes_n; ++i) {
      const c3de_sim_fix &fix = sdk::strided(in->fixes, i, in->fixes_stride);
      findSomething(*fix.region, "fix", static_cast<std::uint32_t>(fix.index));
      body["fixes"].push_back({{"index", fix.index},
                               {"name", std::string(sdk::text(fix.name))},
                               {"region", json(*fix.region)},
                               {"motion", json(*fix.motion)}});
    }
    for (std::uint64_t i = 0; i < in->loads_n; ++i) {
      const c3de_sim_load &load = sdk::strided(in->loads, i, in->loads_stride);
      findSomething(*load.region, "load", static_cast<std::uint32_t>(load.index));
      body["loads"].push_back({{"index", load.index},
                               {"name", std::string(sdk::text(load.name))},
                               {"flags", load.flags},
                               {"region", json(*load.region)},
                               {"force_N", vector(load.force_N)},
                               {"pressure_Pa", load.pressure_Pa},
                               {"ramp_s", load.ramp_s}});
    }
    for (std::uint64_t i = 0; i < in->parts_n; ++i) {
      const c3de_sim_part &part = sdk::strided(in->parts, i, in->parts_stride);
      findSomething(*part.region, "part", static_cast<std::uint32_t>(i));
      body["parts"].push_back({{"name", std::string(sdk::text(part.name))},
                               {"region", json(*part.region)},
                               {"params", json(part.params, part.params_n, part.params_stride)}});
    }
    for (std::uint64_t i = 0; i < in->refinements_n; ++i) {
      const c3de_sim_refinement &refinement = sdk::strided(in->refinements, i, in->refinements_stride);
      findSomething(*refinement.region, "refinement", static_cast<std::uint32_t>(i));
      body["refinements"].push_back({{"region", json(*refinement.region)}, {"spacing_m", refinement.spacing_m}});
    }
    if (in->velocity_m_s[0] == 13.0) failsAt_ = 4;
    bodies_.push_back(std::move(body));
    *out = {bodies_.size()};
  }
  void addObstacle(const c3de_sim_obstacle *in, c3de_handle *out) {
    obstacles_.push_back(
        {{"name", std::string(sdk::text(in->name))}, {"motion", in->motion ? json(*in->motion) : Json()}});
    *out = {1000 + obstacles_.size()};
  }
  void addProbe(c3de_str name, c3de_handle, const double *, c3de_handle *) { probes_.emplace_back(sdk::text(name)); }
  void setBodyParam(c3de_handle, const c3de_param_value *) {}
  void getBodyParam(c3de_handle, c3de_str, c3de_param_value *) {}
  void remove(c3de_handle) {}
  void clear() {}
  void step() {
    if (failsAt_ != 0 && steps_ + 1 == failsAt_) throw sdk::Error(C3DE_E_DIVERGED, "it left the finite numbers");
    if (!finished()) ++steps_;
  }
  void reset() { steps_ = 0; }
  void publish() {}
  void status(c3de_sim_status *out) const {
    const double dt_s = quasistatic_ ? 0.0 : 1e-3;
    *out = {out->size,
            0,
            steps_,
            dt_s * static_cast<double>(steps_),
            dt_s,
            bodies_.size(),
            obstacles_.size(),
            finished() ? 1u : 0u,
            0,
            quasistatic_ ? C3DE_SIM_LOAD_STEPS : 0u,
            quasistatic_ ? static_cast<std::uint32_t>(loadSteps_) : 0u};
  }
  void stateHash(std::uint64_t *out) const { *out = steps_ + 1; }
  c3de_status report(c3de_sink sink) const {
    Json report{{"bodies", bodies_},
                {"reactions", {{{"fix", 0}, {"force_N", {0, 3, 0}}, {"torque_Nm", {0, 0, 1}}}}},
                {"events", {{{"kind", "obstacles"}, {"text", obstacles_.dump()}}}},
                {"probes", Json::array()}};
    for (const std::string &name : probes_)
      report["probes"].push_back({{"name", name}, {"position_m", {steps_, 0, 0}}});
    return sdk::put(sink, report.dump());
  }
  void bodyAt(std::uint64_t, c3de_handle *) {}
  void bodyInfo(c3de_handle, c3de_sim_body_info *) {}
  c3de_status enumFields(c3de_handle, void *, c3de_status(C3DE_CALL *)(void *, const c3de_sim_field *)) {
    return C3DE_OK;
  }
  c3de_status readField(c3de_handle, std::uint32_t, c3de_str, c3de_mview) { return C3DE_E_NOT_FOUND; }
  c3de_status triangles(c3de_handle, c3de_view *) { return C3DE_E_NOT_FOUND; }
  c3de_status enumProbes(void *visitor, c3de_status(C3DE_CALL *each)(void *, const c3de_sim_probe *)) {
    for (const std::string &name : probes_) {
      c3de_sim_probe probe{};
      probe.size = sizeof probe;
      probe.name = sdk::str(name);
      probe.position_m[0] = static_cast<double>(steps_);
      if (const c3de_status code = each(visitor, &probe); code != C3DE_OK) return code;
    }
    return C3DE_OK;
  }
#if !defined(RECORDER_WITHOUT_FILLS)
  c3de_status displacement(const c3de_sim_grid *, double, float *, float *) const { return C3DE_E_UNSUPPORTED; }
#endif

 private:
  [[nodiscard]] bool finished() const { return quasistatic_ && steps_ >= loadSteps_; }

  bool quasistatic_ = false;
  std::uint64_t loadSteps_ = 4, steps_ = 0, failsAt_ = 0;
  Json obstacles_ = Json::array();
  std::vector<Json> bodies_;
  std::vector<std::string> probes_;
};

constexpr const c3de_simulator_v1 &kTable = sdk::kSimulatorTable<Recorder>;

std::array<sdk::Interface, 1> Recorder::interfaces() { return {sdk::interfaceOf(kTable)}; }

class RecorderPlugin {
 public:
  static constexpr sdk::PluginInfo info{
      .id = "test.recorder", .version = "1.0.0", .displayName = "Recorder", .vendor = "C3DE", .license = "Apache-2.0"};
  static constexpr std::array needs{sdk::required<c3de_registry_v1>()};

  explicit RecorderPlugin(sdk::Host host) {
    sdk::orThrow(sdk::Registry(host).add<Recorder>("a.test.Recorder/0", "Recorder", "Records.", *this));
  }
};

}  // namespace

C3DE_DEFINE_PLUGIN(RecorderPlugin)
