// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <mutex>

#include "c3de/sdk/simulator.hpp"
#include "parameters.h"
#include "point_body.h"

namespace mass_spring {

class Simulator;

/// What makes a simulator out of points, lattice, supports and loads.
struct Method {
  std::string_view name;  ///< "mass springs", as messages begin
  std::span<const c3de_param_decl> world, body;
  std::function<Elasticity(const ParameterValues &ofBody)> material;
  /// @param materials  one per cell
  std::function<std::unique_ptr<PointBody>(Lattice, Surface, std::vector<Elasticity> materials,
                                           const ParameterValues &ofBody)>
      make;
  /// Brings a body to rest under a load, for a method that has "solver.integrator"; else empty.
  /// @throws sdk::Error  (C3DE_E_DIVERGED) it comes to none
  std::function<void(PointBody &, const Loading &, const ParameterValues &ofWorld)> relax;
  /// Obstacles that bodies touch on their way to rest; empty: none.
  std::function<Obstacle(sdk::Host, const c3de_sim_obstacle &)> obstacle;
  std::span<const c3de_param_decl> ofObstacle;
};

/// What objects of a class share.
struct Context {
  Context(sdk::Host h, Method m) : host(h), log(h), mesh(h), method(std::move(m)) {}
  sdk::Host host;
  sdk::Log log;
  sdk::Mesh mesh;
  Method method;
  std::function<void(Simulator &, c3de_handle node)> attached;  ///< empty without a window; node 0: detached [main]
};

/// The bodies' skins at one moment, for the window.
struct Snapshot {
  struct Body {
    std::uint64_t id = 0;
    std::string name;
    std::optional<std::array<float, 3>> colour;  ///< sRGB
    std::shared_ptr<const std::vector<std::array<std::uint32_t, 3>>> triangles;
    std::vector<Vec3> skin;  ///< m
    double spacing_m = 0.0;
    std::size_t masses = 0;
    std::optional<Vec3> handForce_N;
  };
  std::vector<Body> bodies;
};

/// A region of a body with parameters of its own.
struct Part {
  c3de_sim_region region{};
  ParameterValues values;
  std::vector<std::string> own;  ///< ids of the parameters that differ from those of the body
};

/// A message about what the method does not support: its name and `text`.
[[nodiscard]] inline std::string methodText(const Context &context, const std::string &text) {
  return std::string(context.method.name) + " " + text;
}

/// The registered class: iface.simulator over bodies of points. A mutex stands between the step and what
/// others add or read; the window reads snapshots.
class Simulator : public sdk::Object<Simulator> {
 public:
  static constexpr std::string_view kClass = "org.c3de.mass_spring.Simulator/0";

  explicit Simulator(Context &context) : context_(context), world_(context.method.world) {}
  ~Simulator();

  // iface.simulator
  void attach(c3de_handle node);
  void declarations(std::uint32_t scope, const c3de_param_decl **decls, std::uint64_t *n, std::uint64_t *stride);
  void setWorld(const c3de_param_value *values, std::uint64_t n, std::uint64_t stride);
  void addBody(const c3de_sim_body *body, c3de_handle *out);
  void addObstacle(const c3de_sim_obstacle *obstacle, c3de_handle *out);
  void addProbe(c3de_str name, c3de_handle body, const double *at_m3, c3de_handle *out);
  void setBodyParam(c3de_handle body, const c3de_param_value *value);
  void getBodyParam(c3de_handle body, c3de_str id, c3de_param_value *out);
  void remove(c3de_handle what);
  void clear();
  void step();
  void reset();
  void publish();
  void status(c3de_sim_status *out);
  void stateHash(std::uint64_t *out);
  c3de_status report(c3de_sink json);
  void bodyAt(std::uint64_t index, c3de_handle *out);
  void bodyInfo(c3de_handle body, c3de_sim_body_info *out);
  c3de_status enumFields(c3de_handle body, void *visitor,
                         c3de_status(C3DE_CALL *each)(void *visitor, const c3de_sim_field *field));
  void readField(c3de_handle body, std::uint32_t on, c3de_str name, c3de_mview out);
  void triangles(c3de_handle body, c3de_view *out);
  c3de_status enumProbes(void *visitor, c3de_status(C3DE_CALL *each)(void *visitor, const c3de_sim_probe *probe));
  void points(c3de_handle body, c3de_sim_points *out);
  void addLoad(c3de_handle body, const c3de_sim_load *load, c3de_handle *out);
  void hold(c3de_handle body, const c3de_sim_hold *hold, c3de_handle *out);
  void pull(c3de_handle hold, const double *target_m3, const double *quaternion4);
  void holdState(c3de_handle hold, c3de_sim_hold_state *out);
  c3de_status saveState(c3de_sink bytes);
  void loadState(const void *bytes, std::uint64_t n);

  // For the view and the pinch of this plugin.
  [[nodiscard]] std::shared_ptr<const Snapshot> snapshot() const;
  [[nodiscard]] c3de_handle node() const { return node_; }

  static std::array<sdk::Interface, 1> interfaces();

 private:
  struct Body {
    std::string name;
    ParameterValues values;
    std::vector<Part> parts;
    std::optional<std::array<float, 3>> colour;
    std::shared_ptr<const std::vector<std::array<std::uint32_t, 3>>> triangles;
    double meshVolume_m3 = 0.0;
    std::unique_ptr<PointBody> physics;
    std::vector<Vec3> lentPositions, lentVelocities, lentForces;  // for points()
    std::vector<double> lentMasses;
    bool hasForces = false;  // lentForces act in the next step
    std::map<std::uint64_t, SurfaceLoad> liveLoads;
  };
  struct Probe {
    std::uint64_t id = 0, body = 0;
    std::string name;
    Vec3 reference{};
    Bound bound;
  };

  [[nodiscard]] Body &bodyOrThrow(c3de_handle body);
  /// With the body that it holds.
  [[nodiscard]] std::pair<std::uint64_t, Hold *> holdOrThrow(c3de_handle hold);
  [[nodiscard]] double stepSize() const;
  [[nodiscard]] bool isQuasiStatic() const;
  /// Of the load of a quasi-static solution.
  [[nodiscard]] std::uint64_t loadSteps() const;
  /// What acts on a body in the next step. @param moment  where loads and motions are then
  [[nodiscard]] Loading loadingOf(const Body &body, const Moment &moment) const;
  [[nodiscard]] std::uint64_t fingerprint() const;
  void resetAll();
  [[nodiscard]] std::vector<Elasticity> materials(const Lattice &lattice, const ParameterValues &values,
                                                  const std::vector<Part> &parts) const;

  Context &context_;
  mutable std::mutex mutex_;
  ParameterValues world_;
  std::map<std::uint64_t, Body> bodies_;  // in the order they were added
  std::map<std::uint64_t, Obstacle> obstacles_;
  std::vector<Probe> probes_;
  std::uint64_t nextId_ = 1, steps_ = 0;
  double time_s_ = 0.0;
  bool failed_ = false;
  c3de_handle node_{};

  mutable std::mutex snapshotMutex_;
  std::shared_ptr<const Snapshot> snapshot_;
};

}  // namespace mass_spring
