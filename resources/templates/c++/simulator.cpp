// My plugin: a simulator in which bodies are points that fall. Where other simulators are installed, take this one alone:
//   c3de run SCENE --no-plugins --plugin build/my_plugin.so
#include <cstring>
#include <string>
#include <vector>

#include "c3de/abi/iface/parameter_ids.h"
#include "c3de/sdk/sdk.hpp"
#include "c3de/sdk/simulator.hpp"
#include "c3de/sdk/structs.hpp"

namespace {

namespace sdk = c3de::sdk;

constexpr double kStep_s = 1e-3;
constexpr std::array kWorld{sdk::vec3Param({.id = C3DE_PARAM_ID_GRAVITY, .label = "Gravity", .unit = "m/s²", .doc = "On all bodies."},
                                           {.min = -1000.0, .max = 1000.0, .softMin = -20.0, .softMax = 20.0},
                                           {0.0, -9.81, 0.0})};

class MySimulator : public sdk::Object<MySimulator> {
 public:
  template <class Factory>
  explicit MySimulator(Factory &) {}
  static std::array<sdk::Interface, 1> interfaces();

  void attach(c3de_handle) {}
  void declarations(std::uint32_t scope, const c3de_param_decl **decls, std::uint64_t *n, std::uint64_t *stride) {
    if (scope < C3DE_SIM_SCOPE_WORLD || scope > C3DE_SIM_SCOPE_OBSTACLE)
      throw sdk::Error(C3DE_E_ARG, "there is no such scope");
    sdk::notNull(decls, "decls") = scope == C3DE_SIM_SCOPE_WORLD ? kWorld.data() : nullptr;
    sdk::notNull(n, "n") = scope == C3DE_SIM_SCOPE_WORLD ? kWorld.size() : 0;
    sdk::notNull(stride, "stride") = sizeof(c3de_param_decl);
  }
  void setWorld(const c3de_param_value *values, std::uint64_t n, std::uint64_t stride) {
    for (std::uint64_t i = 0; i < n; ++i) {
      const c3de_param_value &value = sdk::strided(values, i, stride);
      if (sdk::text(value.id) != C3DE_PARAM_ID_GRAVITY)
        throw sdk::Error(C3DE_E_ARG, "unknown key " + std::string(sdk::text(value.id)));
      gravity_ = {value.vec[0], value.vec[1], value.vec[2]};
    }
  }
  // What is not served has to be refused, or the scene would be simulated without it.
  void addBody(const c3de_sim_body *given, c3de_handle *out) {
    const c3de_sim_body in = sdk::readStruct(given, "body");
    if (in.mesh.v == 0) throw sdk::Error(C3DE_E_ARG, "the body has no mesh");
    if (in.fixes_n + in.loads_n + in.parts_n + in.refinements_n > 0)
      throw sdk::Error(C3DE_E_UNSUPPORTED, "fixes, loads, parts and refinements are not served");
    const auto isNone = [](const double *v) { return v[0] == 0.0 && v[1] == 0.0 && v[2] == 0.0; };
    if (in.placement && (in.placement->flags & C3DE_SIM_PLACED_BY_MATRIX || !isNone(in.placement->rotation_deg) ||
                         (in.placement->scale != 0.0 && in.placement->scale != 1.0)))
      throw sdk::Error(C3DE_E_UNSUPPORTED, "of a placement the position alone is served");
    if (!isNone(in.angular_velocity_rad_s)) throw sdk::Error(C3DE_E_UNSUPPORTED, "an angular velocity is not served");
    Body body;
    body.name = sdk::text(in.name);
    for (std::size_t c = 0; c < 3; ++c) {
      if (in.placement) body.start_m[c] = in.placement->position_m[c];
      body.startVelocity_m_s[c] = in.velocity_m_s[c];
    }
    bodies_.push_back(body);
    sdk::notNull(out, "out").v = bodies_.size();
    reset();
  }
  void addObstacle(const c3de_sim_obstacle *, c3de_handle *) {
    throw sdk::Error(C3DE_E_UNSUPPORTED, "obstacles are not served");
  }
  void addProbe(c3de_str, c3de_handle, const double *, c3de_handle *) { throw sdk::Error(C3DE_E_UNSUPPORTED, "probes are not served"); }
  void setBodyParam(c3de_handle, const c3de_param_value *) { throw sdk::Error(C3DE_E_NOT_FOUND, "bodies have none"); }
  void getBodyParam(c3de_handle, c3de_str, c3de_param_value *) {
    throw sdk::Error(C3DE_E_NOT_FOUND, "bodies have no parameters");
  }
  void remove(c3de_handle) { throw sdk::Error(C3DE_E_UNSUPPORTED, "bodies stay"); }
  void clear() {
    bodies_.clear();
    steps_ = 0;
  }
  void step() {
    for (Body &body : bodies_)
      for (std::size_t c = 0; c < 3; ++c) {
        body.velocity_m_s[c] += kStep_s * gravity_[c];
        body.position_m[c] += kStep_s * body.velocity_m_s[c];
      }
    ++steps_;
  }
  void reset() {
    for (Body &body : bodies_) {
      body.position_m = body.start_m;
      body.velocity_m_s = body.startVelocity_m_s;
    }
    steps_ = 0;
  }
  void publish() {}
  void status(c3de_sim_status *out) const {
    c3de_sim_status now{};
    now.steps = steps_;
    now.time_s = kStep_s * static_cast<double>(steps_);
    now.dt_s = kStep_s;
    now.bodies = bodies_.size();
    sdk::writeStruct(out, now, "out");
  }
  void stateHash(std::uint64_t *out) const {
    std::uint64_t hash = 14695981039346656037u;
    for (const Body &body : bodies_)
      for (const sdk::Vec3 *row : {&body.position_m, &body.velocity_m_s})
        for (const double value : *row) {
          unsigned char bytes[sizeof value];
          std::memcpy(bytes, &value, sizeof value);
          for (const unsigned char byte : bytes) hash = (hash ^ byte) * 1099511628211u;
        }
    sdk::notNull(out, "out") = hash;
  }
  c3de_status report(c3de_sink json) const {
    std::string text = "{\"bodies\": [";
    for (const Body &body : bodies_)
      text += (&body == &bodies_.front() ? "{\"height_m\": " : ", {\"height_m\": ") + std::to_string(body.position_m[1]) + "}";
    return sdk::put(json, text + "]}");
  }
  void bodyAt(std::uint64_t index, c3de_handle *out) {
    if (index >= bodies_.size()) throw sdk::Error(C3DE_E_NOT_FOUND, "there is no such body");
    sdk::notNull(out, "out").v = index + 1;
  }
  void bodyInfo(c3de_handle body, c3de_sim_body_info *out) {
    c3de_sim_body_info info{};
    info.name = sdk::str(at(body).name);
    info.points = 1;
    info.mass_kg = 1.0;
    info.stable_dt_s = kStep_s;
    sdk::writeStruct(out, info, "out");
  }
  c3de_status enumFields(c3de_handle body, void *visitor, c3de_status(C3DE_CALL *each)(void *, const c3de_sim_field *)) {
    (void)at(body);
    for (const char *name : {C3DE_SIM_FIELD_REFERENCE_POSITION, C3DE_SIM_FIELD_POSITION}) {
      const c3de_sim_field field{sizeof field, C3DE_SIM_ON_POINTS, sdk::str(name), sdk::str("m"), 3, 0};
      if (const c3de_status status = each(visitor, &field); status != C3DE_OK) return status;
    }
    return C3DE_OK;
  }
  void readField(c3de_handle body, std::uint32_t on, c3de_str name, c3de_mview out) {
    const Body &read = at(body);
    const bool isReference = sdk::text(name) == C3DE_SIM_FIELD_REFERENCE_POSITION;
    if (on != C3DE_SIM_ON_POINTS || (!isReference && sdk::text(name) != C3DE_SIM_FIELD_POSITION))
      throw sdk::Error(C3DE_E_NOT_FOUND, "there is no such field");
    if (out.data == nullptr || out.count < 1 || out.comps != 3 || out.dtype != C3DE_F64)
      throw sdk::Error(C3DE_E_ARG, "a field of positions has 1 row of 3 f64");
    std::memcpy(out.data, (isReference ? read.start_m : read.position_m).data(), sizeof(sdk::Vec3));
  }
  void triangles(c3de_handle, c3de_view *out) { *out = {nullptr, 0, 3, C3DE_U32, 0}; }
  void enumProbes(void *, c3de_status(C3DE_CALL *)(void *, const c3de_sim_probe *)) {}

 private:
  struct Body {
    std::string name;
    sdk::Vec3 start_m{}, startVelocity_m_s{}, position_m{}, velocity_m_s{};
  };
  Body &at(c3de_handle body) {
    if (body.v == 0 || body.v > bodies_.size()) throw sdk::Error(C3DE_E_STALE, "there is no such body");
    return bodies_[static_cast<std::size_t>(body.v - 1)];
  }

  std::vector<Body> bodies_;
  sdk::Vec3 gravity_{0.0, -9.81, 0.0};
  std::uint64_t steps_ = 0;
};

std::array<sdk::Interface, 1> MySimulator::interfaces() {
  return {sdk::interfaceOf(sdk::kSimulatorTable<MySimulator>)};
}

class MyPlugin {
 public:
  static constexpr sdk::PluginInfo info{
      .id = "org.example.my_plugin", .version = "0.1.0", .displayName = "My plugin", .vendor = "Your name", .license = "MIT"};
  static constexpr std::array needs{sdk::required<c3de_registry_v1>()};

  explicit MyPlugin(sdk::Host host) {
    sdk::orThrow(sdk::Registry(host).add<MySimulator>("org.example.my_plugin.Simulator/0", "My plugin", "Points fall.", *this));
  }
};

}  // namespace

C3DE_DEFINE_PLUGIN(MyPlugin)
