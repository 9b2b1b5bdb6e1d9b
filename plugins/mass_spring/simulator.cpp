// SPDX-License-Identifier: Apache-2.0
#include "simulator.h"

#include <cstdio>
#include <cstring>
#include <limits>

#include "c3de/abi/draft/iface/parameter_ids.h"
#include "c3de/sdk/structs.hpp"

namespace mass_spring {
namespace {

using sdk::Error;

constexpr double kMetresPerMillimetre = 1e-3;
constexpr double kDegree = 3.14159265358979323846 / 180.0;
constexpr std::uint32_t kStateVersion = 1;

std::string shown(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

struct Placement {
  Mat3 linear{{{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}}};
  Mat3 inverse = linear;
  Vec3 position{};
};

Placement readPlacement(const c3de_sim_placement *in) {
  Placement out;
  if (in == nullptr) return out;
  const auto p = sdk::readStruct(in, "placement");
  double scale = p.scale == 0.0 ? 1.0 : p.scale;
  if ((p.flags & C3DE_SIM_PLACED_BY_MATRIX) != 0) {
    for (std::size_t r = 0; r < 3; ++r) {
      out.linear[r] = {p.matrix[r], p.matrix[4 + r], p.matrix[8 + r]};
      out.position[r] = p.matrix[12 + r];
    }
    scale = length(out.linear[0]);
    const Vec3 third = cross(out.linear[0], out.linear[1]) - scale * out.linear[2];
    if (!(scale > 0.0) || !(length(third) < 1e-4 * scale * scale) ||
        !(std::abs(dot(out.linear[0], out.linear[1])) < 1e-4 * scale * scale))
      throw Error(C3DE_E_ARG, "matrix: accepted: a rotation times one scale above 0, and a displacement");
  } else {
    out.position = vectorOf(p.position_m);
    out.linear = rotationOf(kDegree * vectorOf(p.rotation_deg));
    for (Vec3 &row : out.linear) row = scale * row;
  }
  if (!(scale > 0.0) || !std::isfinite(scale) || !isFinite(out.position) || !isFinite(out.linear[0]))
    throw Error(C3DE_E_ARG, "position, rotation and scale must be finite, scale above 0");
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c) out.inverse[r][c] = out.linear[c][r] / (scale * scale);
  return out;
}

bool contains(const c3de_sim_region &region, const Vec3 &x) {
  const Vec3 a = vectorOf(region.a), b = vectorOf(region.b);
  switch (region.kind) {
    case C3DE_SIM_REGION_EVERYWHERE: return true;
    case C3DE_SIM_REGION_BOX:
      return x[0] >= a[0] && x[1] >= a[1] && x[2] >= a[2] && x[0] <= b[0] && x[1] <= b[1] && x[2] <= b[2];
    case C3DE_SIM_REGION_SPHERE: return length(x - a) <= region.radius;
    case C3DE_SIM_REGION_HALF_SPACE: return dot(x - a, b) <= 0.0;
    default:
      throw Error(C3DE_E_ARG, "region: kind " + std::to_string(region.kind) + " is not known; accepted: 0 ... 3");
  }
}

Motion readMotion(const c3de_sim_motion *in, const Vec3 &middle, std::uint32_t index) {
  const auto m = sdk::readStruct(in, "motion");
  if ((m.flags & C3DE_SIM_HAS_QUATERNION) != 0)
    throw Error(C3DE_E_UNSUPPORTED, "quaternion: mass springs turn by angles; accepted: rotation_deg",
                {"fix", index, {}});
  Motion out{vectorOf(m.displacement_m), kDegree * vectorOf(m.rotation_deg),
             (m.flags & C3DE_SIM_HAS_CENTRE) != 0 ? vectorOf(m.centre_m) : middle, m.ramp_s};
  if (!isFinite(out.displacement_m) || !isFinite(out.rotation_rad) || !isFinite(out.centre_m) || !(out.ramp_s >= 0.0))
    throw Error(C3DE_E_ARG, "displacement, rotation and centre must be finite, the ramp at least 0 s",
                {"fix", index, {}});
  return out;
}

SurfaceLoad readLoad(const c3de_sim_load &in, const SpringBody &body) {
  SurfaceLoad out;
  const auto region = sdk::readStruct(in.region, "region");
  const Surface &skin = body.skin();
  for (std::uint32_t t = 0; t < skin.triangles.size(); ++t) {
    const auto &[a, b, c] = skin.triangles[t];
    if (!contains(region, (1.0 / 3.0) * (skin.vertices[a] + skin.vertices[b] + skin.vertices[c]))) continue;
    out.triangles.push_back(t);
    out.area_m2 += 0.5 * length(cross(skin.vertices[b] - skin.vertices[a], skin.vertices[c] - skin.vertices[a]));
  }
  if (!(out.area_m2 > 0.0))
    throw Error(C3DE_E_ARG, "the region meets no middle of a triangle of the surface", {"load", in.index, {}});
  if ((in.flags & C3DE_SIM_LOAD_PRESSURE) != 0)
    out.pressure_Pa = in.pressure_Pa;
  else
    out.force_N = vectorOf(in.force_N);
  out.isDead = (in.flags & C3DE_SIM_LOAD_DEAD) != 0;
  out.ramp_s = in.ramp_s;
  if (!isFinite(out.force_N) || !std::isfinite(out.pressure_Pa) || !(out.ramp_s >= 0.0))
    throw Error(C3DE_E_ARG, "force and pressure must be finite, the ramp at least 0 s", {"load", in.index, {}});
  return out;
}

/// FNV-1a.
class Hash {
 public:
  void add(const void *bytes, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i)
      value_ = (value_ ^ static_cast<const unsigned char *>(bytes)[i]) * 0x100000001b3ull;
  }
  template <class T>
  void add(const T &number) {
    static_assert(std::is_arithmetic_v<T>);
    add(&number, sizeof number);
  }
  void add(const Vec3 &v) { add(v.data(), sizeof v); }
  void add(const std::string &text) {
    add(text.size());
    add(text.data(), text.size());
  }
  template <class T>
  void add(const std::vector<T> &values) {
    add(values.size());
    for (const T &value : values) add(value);
  }
  [[nodiscard]] std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325ull;
};

/// Numbers as they lie in memory.
template <class T>
void append(std::string &bytes, const T *values, std::size_t n) {
  static_assert(std::is_trivially_copyable_v<T>);
  bytes.append(reinterpret_cast<const char *>(values), n * sizeof(T));
}

class Reader {
 public:
  Reader(const void *bytes, std::uint64_t n) : at_(static_cast<const unsigned char *>(bytes)), left_(n) {}
  template <class T>
  T number() {
    T out{};
    take(&out, 1);
    return out;
  }
  template <class T>
  void take(T *out, std::size_t n) {
    if (n > left_ / sizeof(T)) throw Error(C3DE_E_FORMAT, "the state ends too early");
    std::memcpy(out, at_, n * sizeof(T));
    at_ += n * sizeof(T);
    left_ -= n * sizeof(T);
  }
  [[nodiscard]] std::uint64_t left() const { return left_; }

 private:
  const unsigned char *at_;
  std::uint64_t left_;
};

std::string quoted(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    char escaped[8];
    if (c == '"' || c == '\\')
      (out += '\\') += c;
    else if (static_cast<unsigned char>(c) < 0x20) {
      std::snprintf(escaped, sizeof escaped, "\\u%04x", static_cast<unsigned>(c));
      out += escaped;
    } else
      out += c;
  }
  return out + '"';
}

std::string json(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}
std::string json(const Vec3 &v) { return "[" + json(v[0]) + "," + json(v[1]) + "," + json(v[2]) + "]"; }

struct Field {
  std::uint32_t on;
  std::string_view name, unit;
  std::uint32_t comps;
};
constexpr std::uint32_t kPoints = C3DE_SIM_ON_POINTS, kSurface = C3DE_SIM_ON_SURFACE;
constexpr std::array kFields{
    Field{kPoints, C3DE_SIM_FIELD_REFERENCE_POSITION, "m", 3},
    Field{kPoints, C3DE_SIM_FIELD_POSITION, "m", 3},
    Field{kPoints, C3DE_SIM_FIELD_VELOCITY, "m/s", 3},
    Field{kPoints, C3DE_SIM_FIELD_MASS, "kg", 1},
    Field{kPoints, C3DE_SIM_FIELD_VOLUME, "m^3", 1},
    Field{kPoints, "displacement", "m", 3},
    Field{kPoints, "force", "N", 3},
    Field{kPoints, "stretch", "1", 1},
    Field{kSurface, C3DE_SIM_FIELD_REFERENCE_POSITION, "m", 3},
    Field{kSurface, C3DE_SIM_FIELD_POSITION, "m", 3},
    Field{kSurface, C3DE_SIM_FIELD_VELOCITY, "m/s", 3},
    Field{kSurface, "displacement", "m", 3},
};

}  // namespace

Simulator::~Simulator() {
  if (node_.v != 0 && context_.attached) context_.attached(*this, {});
}

std::array<sdk::Interface, 1> Simulator::interfaces() { return {sdk::interfaceOf(sdk::kSimulatorTable<Simulator>)}; }

void Simulator::attach(c3de_handle node) {
  if (node.v == node_.v) return;
  if (node_.v != 0 && context_.attached) context_.attached(*this, {});
  node_ = node;
  if (node_.v != 0 && context_.attached) context_.attached(*this, node_);
}

void Simulator::declarations(std::uint32_t scope, const c3de_param_decl **decls, std::uint64_t *n,
                             std::uint64_t *stride) {
  if (scope < C3DE_SIM_SCOPE_WORLD || scope > C3DE_SIM_SCOPE_OBSTACLE)
    throw Error(C3DE_E_ARG, "scope " + std::to_string(scope) + " is not known; accepted: 1 ... 3");
  const auto found = scope == C3DE_SIM_SCOPE_WORLD  ? worldDeclarations()
                     : scope == C3DE_SIM_SCOPE_BODY ? bodyDeclarations()
                                                    : std::span<const c3de_param_decl>();
  sdk::notNull(decls, "decls") = found.data();
  sdk::notNull(n, "n") = found.size();
  sdk::notNull(stride, "stride") = sizeof(c3de_param_decl);
}

void Simulator::setWorld(const c3de_param_value *values, std::uint64_t n, std::uint64_t stride) {
  const std::lock_guard lock(mutex_);
  ParameterValues changed = world_;
  changed.set(values, n, stride);
  const Vec3 low = changed.vector(C3DE_PARAM_ID_BOX_MIN), high = changed.vector(C3DE_PARAM_ID_BOX_MAX);
  for (std::size_t a = 0; a < 3; ++a)
    if (!(high[a] > low[a])) throw Error(C3DE_E_ARG, "world.box.max must be above world.box.min on every axis");
  const ParameterValues before = std::exchange(world_, std::move(changed));
  try {
    (void)stepSize();
  } catch (...) {
    world_ = before;
    throw;
  }
}

std::vector<Elasticity> Simulator::materials(const Lattice &lattice, const ParameterValues &values,
                                             const std::vector<Part> &parts) {
  std::vector<Elasticity> out;
  for (const Lattice::Cell &cell : lattice.cells()) {
    const ParameterValues *of = &values;
    for (const Part &part : parts)
      if (contains(part.region, lattice.centre(cell))) of = &part.values;
    out.push_back({of->number(C3DE_PARAM_ID_YOUNGS_MODULUS), of->number(C3DE_PARAM_ID_DENSITY),
                   of->number("material.retardation_time")});
  }
  return out;
}

void Simulator::addBody(const c3de_sim_body *body, c3de_handle *out) {
  const auto in = sdk::readStruct(body, "body");
  const std::string name(sdk::text(in.name));
  ParameterValues values(bodyDeclarations());
  values.set(in.params, in.params_n, in.params_stride);
  if (in.fill != nullptr) throw Error(C3DE_E_UNSUPPORTED, "mass springs fill meshes, not voxels");
  if (in.refinements_n > 0)
    throw Error(C3DE_E_UNSUPPORTED, "the lattice has one spacing; accepted: no refinement", {"refinement", 0, {}});

  const Placement placement = readPlacement(in.placement);
  const auto positions = sdk::orThrow(context_.mesh.positions(in.mesh));
  const auto corners = sdk::orThrow(context_.mesh.triangles(in.mesh));
  const auto *meshes = context_.mesh.table();
  sdk::orThrow(context_.host.check(meshes->check_fillable(meshes->ctx, in.mesh)));
  Surface surface;
  constexpr double kFar = std::numeric_limits<double>::infinity();
  surface.min = {kFar, kFar, kFar};
  surface.max = {-kFar, -kFar, -kFar};
  for (std::size_t i = 0; i < positions.size(); ++i) {
    surface.vertices.push_back(placement.linear * (kMetresPerMillimetre * vectorOf(positions[i])) + placement.position);
    for (std::size_t a = 0; a < 3; ++a) {
      surface.min[a] = std::min(surface.min[a], surface.vertices.back()[a]);
      surface.max[a] = std::max(surface.max[a], surface.vertices.back()[a]);
    }
  }
  for (std::size_t t = 0; t < corners.size(); ++t) {
    surface.triangles.push_back({corners[t][0], corners[t][1], corners[t][2]});
    const auto &[a, b, c] = surface.triangles.back();
    surface.volume_m3 += dot(surface.vertices[a], cross(surface.vertices[b], surface.vertices[c])) / 6.0;
  }
  const double volume_m3 = surface.volume_m3;
  const double spacing = values.isAuto(C3DE_PARAM_ID_SPACING)
                             ? std::cbrt(std::abs(volume_m3) / values.number(C3DE_PARAM_ID_COUNT))
                             : values.number(C3DE_PARAM_ID_SPACING);
  const Inside inside = [&](const std::vector<Vec3> &points) {
    std::vector<Vec3> inMesh;
    inMesh.reserve(points.size());
    for (const Vec3 &x : points)
      inMesh.push_back((1.0 / kMetresPerMillimetre) * (placement.inverse * (x - placement.position)));
    std::vector<double> winding(points.size());
    sdk::orThrow(context_.mesh.windingNumbers(in.mesh, sdk::rows<double, 3>(inMesh), winding));
    return winding;
  };
  Lattice lattice(surface, spacing, inside, sdk::Progress(in.progress));

  std::vector<Part> parts;
  for (std::uint64_t i = 0; i < in.parts_n; ++i) {
    const auto part = sdk::readStruct(&sdk::strided(in.parts, i, in.parts_stride), "part");
    Part made{sdk::readStruct(part.region, "region"), values, {}};
    made.values.set(part.params, part.params_n, part.params_stride);
    for (std::uint64_t k = 0; k < part.params_n; ++k)
      made.own.emplace_back(sdk::text(sdk::strided(part.params, k, part.params_stride).id));
    if (std::none_of(lattice.cells().begin(), lattice.cells().end(),
                     [&](const Lattice::Cell &cell) { return contains(made.region, lattice.centre(cell)); }))
      throw Error(C3DE_E_ARG, "the region meets no middle of a cell; the spacing is " + shown(1e3 * spacing) + " mm",
                  {"part", static_cast<std::uint32_t>(i), {}});
    parts.push_back(std::move(made));
  }
  auto ofCells = materials(lattice, values, parts);
  SpringBody physics(std::move(lattice), std::move(surface), std::move(ofCells));
  for (std::uint64_t i = 0; i < in.fixes_n; ++i) {
    const auto fix = sdk::readStruct(&sdk::strided(in.fixes, i, in.fixes_stride), "fix");
    const auto region = sdk::readStruct(fix.region, "region");
    Support support;
    support.number = fix.index;
    Vec3 sum{};
    const auto &nodes = physics.lattice().nodes();
    for (std::uint32_t n = 0; n < nodes.size(); ++n) {
      if (!contains(region, nodes[n])) continue;
      if (physics.held()[n] != 0)
        throw Error(C3DE_E_ARG, "a mass of the region is held by another support already", {"fix", fix.index, {}});
      support.nodes.push_back(n);
      sum += nodes[n];
    }
    if (support.nodes.empty())
      throw Error(C3DE_E_ARG,
                  "the region meets no mass of the lattice, whose spacing is " + shown(1e3 * spacing) + " mm",
                  {"fix", fix.index, {}});
    if (fix.motion != nullptr)
      support.motion = readMotion(fix.motion, (1.0 / static_cast<double>(support.nodes.size())) * sum, fix.index);
    physics.addSupport(std::move(support));
  }
  for (std::uint64_t i = 0; i < in.loads_n; ++i)
    physics.loads.push_back(readLoad(sdk::readStruct(&sdk::strided(in.loads, i, in.loads_stride), "load"), physics));
  const Vec3 velocity = vectorOf(in.velocity_m_s), angular = vectorOf(in.angular_velocity_rad_s);
  if (!isFinite(velocity) || !isFinite(angular)) throw Error(C3DE_E_ARG, "velocities must be finite");
  physics.setInitialVelocity(velocity, angular);

  std::optional<std::array<float, 3>> colour;
  if (in.colour != nullptr) colour = {in.colour[0], in.colour[1], in.colour[2]};
  auto triangles = std::make_shared<const std::vector<std::array<std::uint32_t, 3>>>(physics.skin().triangles);
  const std::lock_guard lock(mutex_);
  const std::uint64_t id = nextId_++;
  bodies_.emplace(id, Body{name,
                           std::move(values),
                           std::move(parts),
                           colour,
                           std::move(triangles),
                           volume_m3,
                           std::move(physics),
                           {},
                           {},
                           {},
                           {},
                           false,
                           {}});
  try {
    (void)stepSize();
  } catch (...) {
    bodies_.erase(id);
    throw;
  }
  resetAll();
  if (out != nullptr) *out = {id};
}

void Simulator::addObstacle(const c3de_sim_obstacle *, c3de_handle *) {
  throw Error(C3DE_E_UNSUPPORTED, "mass springs touch nothing but the walls of the world; accepted: no obstacle");
}

Simulator::Body &Simulator::bodyOrThrow(c3de_handle body) {
  const auto found = bodies_.find(body.v);
  if (found == bodies_.end()) throw Error(C3DE_E_STALE, "there is no such body in this simulation");
  return found->second;
}

void Simulator::addProbe(c3de_str name, c3de_handle body, const double *at_m3, c3de_handle *out) {
  const std::lock_guard lock(mutex_);
  const Lattice &lattice = bodyOrThrow(body).physics.lattice();
  Probe probe{nextId_, body.v, std::string(sdk::text(name)), vectorOf(&sdk::notNull(at_m3, "at_m3")), {}};
  const std::string which = "probe '" + probe.name + "': ";
  if (!isFinite(probe.reference)) throw Error(C3DE_E_ARG, which + "the point is not finite");
  for (const Probe &other : probes_)
    if (other.name == probe.name) throw Error(C3DE_E_EXISTS, which + "there is one of this name already");
  double off = 0.0;
  probe.bound = lattice.bind(probe.reference, &off);
  if (!(off <= 0.5 * lattice.spacing()))
    throw Error(C3DE_E_ARG, which + "the point lies " + shown(1e3 * off) +
                                " mm off the lattice of the body; accepted: up to half a spacing (" +
                                shown(500.0 * lattice.spacing()) + " mm)");
  probes_.push_back(std::move(probe));
  if (out != nullptr) *out = {nextId_};
  ++nextId_;
}

void Simulator::setBodyParam(c3de_handle body, const c3de_param_value *value) {
  const auto in = sdk::readStruct(value, "value");
  const std::lock_guard lock(mutex_);
  Body &of = bodyOrThrow(body);
  ParameterValues changed = of.values;
  changed.set(in);
  const std::string id(sdk::text(in.id));
  if ((changed.declaration(id).flags & C3DE_PARAM_NEEDS_RESET) != 0)
    throw Error(C3DE_E_STATE, id + " takes effect when the body is built again");
  std::vector<Part> parts = of.parts;
  for (Part &part : parts)
    if (std::find(part.own.begin(), part.own.end(), id) == part.own.end()) part.values.set(in);
  const std::vector<Elasticity> before = of.physics.materials();
  of.physics.setMaterials(materials(of.physics.lattice(), changed, parts));
  try {
    (void)stepSize();
  } catch (...) {
    of.physics.setMaterials(before);
    throw;
  }
  of.values = std::move(changed);
  of.parts = std::move(parts);
}

void Simulator::getBodyParam(c3de_handle body, c3de_str id, c3de_param_value *out) {
  const std::lock_guard lock(mutex_);
  sdk::writeStruct(out, bodyOrThrow(body).values.value(sdk::text(id)), "out");
}

void Simulator::remove(c3de_handle what) {
  const std::lock_guard lock(mutex_);
  std::size_t gone = bodies_.erase(what.v);
  gone += std::erase_if(probes_, [&](const Probe &p) { return p.id == what.v || p.body == what.v; });
  for (auto &[id, body] : bodies_) gone += body.liveLoads.erase(what.v);
  if (gone == 0) throw Error(C3DE_E_STALE, "there is no such body, probe or load in this simulation");
}

void Simulator::clear() {
  const std::lock_guard lock(mutex_);
  bodies_.clear();
  probes_.clear();
  resetAll();
}

/// The stable step of the stiffest body, or what was asked for.
double Simulator::stepSize() const {
  double stable = std::numeric_limits<double>::infinity();
  const std::string *stiffest = nullptr;
  for (const auto &[id, body] : bodies_)
    if (body.physics.stableStep_s() < stable) {
      stable = body.physics.stableStep_s();
      stiffest = &body.name;
    }
  if (world_.isAuto("solver.dt")) return stiffest != nullptr ? stable : 1e-3;
  const double wanted = world_.number("solver.dt");
  if (wanted > stable)
    throw Error(C3DE_E_ARG, "solver.dt = " + shown(wanted) + " s is above the stable step of body '" + *stiffest +
                                "'; accepted: up to " + shown(stable) + " s, or \"auto\"");
  return wanted;
}

void Simulator::step() {
  const std::lock_guard lock(mutex_);
  const double dt = stepSize();
  const Vec3 gravity = world_.vector(C3DE_PARAM_ID_GRAVITY);
  const double damping = world_.number(C3DE_PARAM_ID_DAMPING);
  const bool hasWalls = world_.number(C3DE_PARAM_ID_BOX_ENABLED) != 0.0;
  std::vector<SpringBody::State> before;
  for (const auto &[id, body] : bodies_) before.push_back(body.physics.state());
  std::string failure;
  for (auto &[id, body] : bodies_) {
    std::vector<SurfaceLoad> live;
    for (const auto &[number, load] : body.liveLoads) live.push_back(load);
    body.physics.step(time_s_, dt, gravity, damping, body.hasForces ? body.lentForces : std::vector<Vec3>(), live);
    body.hasForces = false;
    if (hasWalls) body.physics.keepWithin(world_.vector(C3DE_PARAM_ID_BOX_MIN), world_.vector(C3DE_PARAM_ID_BOX_MAX));
    if (!body.physics.isFinite() && failure.empty()) failure = body.name;
  }
  failed_ = !failure.empty();
  if (failed_) {
    std::size_t i = 0;
    for (auto &[id, body] : bodies_) body.physics.setState(std::move(before[i++]));
    throw Error(C3DE_E_DIVERGED, "body '" + failure + "' left the finite numbers; help: a smaller load, more damping");
  }
  ++steps_;
  time_s_ += dt;
}

void Simulator::resetAll() {
  for (auto &[id, body] : bodies_) {
    body.physics.reset();
    body.liveLoads.clear();
    body.hasForces = false;
  }
  steps_ = 0;
  time_s_ = 0.0;
  failed_ = false;
}

void Simulator::reset() {
  const std::lock_guard lock(mutex_);
  resetAll();
}

void Simulator::publish() {
  auto next = std::make_shared<Snapshot>();
  {
    const std::lock_guard lock(mutex_);
    for (const auto &[id, body] : bodies_) {
      std::optional<Vec3> force;
      if (body.physics.hold) force = body.physics.hold->force_N;
      next->bodies.push_back({id, body.name, body.colour, body.triangles,
                              body.physics.onSkin(body.physics.state().positions), body.physics.lattice().spacing(),
                              body.physics.masses().size(), force});
    }
  }
  const std::lock_guard lock(snapshotMutex_);
  snapshot_ = std::move(next);
}

std::shared_ptr<const Snapshot> Simulator::snapshot() const {
  const std::lock_guard lock(snapshotMutex_);
  return snapshot_;
}

void Simulator::status(c3de_sim_status *out) {
  const std::lock_guard lock(mutex_);
  c3de_sim_status s{};
  s.failed = failed_ ? 1u : 0u;
  s.steps = steps_;
  s.time_s = time_s_;
  s.dt_s = stepSize();
  s.bodies = bodies_.size();
  sdk::writeStruct(out, s, "out");
}

/// What a state belongs to: everything that a scene says of the physics.
std::uint64_t Simulator::fingerprint() const {
  Hash hash;
  for (const c3de_param_decl &d : worldDeclarations()) {
    const c3de_param_value v = world_.value(sdk::text(d.id));
    hash.add(v.type);
    hash.add(v.num);
    hash.add(vectorOf(v.vec));
  }
  for (const auto &[id, body] : bodies_) {
    const SpringBody &p = body.physics;
    hash.add(body.name);
    hash.add(p.lattice().nodes());
    hash.add(p.masses());
    hash.add(p.held());
    for (const Elasticity &m : p.materials()) {
      hash.add(m.youngsModulus_Pa);
      hash.add(m.density_kg_m3);
      hash.add(m.retardationTime_s);
    }
    for (const Support &s : p.supports()) {
      hash.add(s.nodes);
      const Motion motion = s.motion.value_or(Motion{});
      for (const Vec3 &v : {motion.displacement_m, motion.rotation_rad, motion.centre_m}) hash.add(v);
      hash.add(motion.ramp_s);
    }
    for (const SurfaceLoad &load : p.loads) {
      hash.add(load.triangles);
      hash.add(load.force_N);
      hash.add(load.pressure_Pa);
      hash.add(load.isDead);
      hash.add(load.ramp_s);
    }
  }
  return hash.value();
}

void Simulator::stateHash(std::uint64_t *out) {
  const std::lock_guard lock(mutex_);
  Hash hash;
  hash.add(fingerprint());
  hash.add(steps_);
  hash.add(time_s_);
  for (const auto &[id, body] : bodies_) {
    hash.add(body.physics.state().positions);
    hash.add(body.physics.state().velocities);
    for (const auto &[number, load] : body.liveLoads) {
      hash.add(load.triangles);
      hash.add(load.force_N);
      hash.add(load.pressure_Pa);
      hash.add(load.began_s);
    }
    if (!body.physics.hold) continue;
    hash.add(body.physics.hold->nodes);
    hash.add(body.physics.hold->target_m);
    hash.add(body.physics.hold->offset_m);
  }
  sdk::notNull(out, "out") = hash.value();
}

c3de_status Simulator::saveState(c3de_sink sink) {
  const std::lock_guard lock(mutex_);
  std::string bytes;
  const std::uint64_t of = fingerprint(), count = bodies_.size();
  append(bytes, &kStateVersion, 1);
  append(bytes, &of, 1);
  append(bytes, &steps_, 1);
  append(bytes, &time_s_, 1);
  append(bytes, &count, 1);
  for (const auto &[id, body] : bodies_) {
    if (body.physics.hold) throw Error(C3DE_E_STATE, "somebody holds body '" + body.name + "'; let go of it first");
    if (!body.liveLoads.empty())
      throw Error(C3DE_E_STATE, "a load that came while it ran acts on body '" + body.name + "'; remove it first");
    const SpringBody::State &state = body.physics.state();
    const std::uint64_t n = state.positions.size();
    append(bytes, &n, 1);
    append(bytes, state.positions.data(), n);
    append(bytes, state.velocities.data(), n);
  }
  return sdk::put(sink, bytes);
}

void Simulator::loadState(const void *bytes, std::uint64_t n) {
  if (bytes == nullptr && n > 0) throw Error(C3DE_E_ARG, "bytes is null");
  const std::lock_guard lock(mutex_);
  Reader in(bytes, n);
  if (const auto version = in.number<std::uint32_t>(); version != kStateVersion)
    throw Error(C3DE_E_VERSION, "the state is of version " + std::to_string(version) +
                                    " of the mass springs' format; accepted: " + std::to_string(kStateVersion));
  if (in.number<std::uint64_t>() != fingerprint())
    throw Error(C3DE_E_ARG, "the state belongs to another scene: bodies, materials, supports, loads or world differ");
  const auto steps = in.number<std::uint64_t>();
  const auto time_s = in.number<double>();
  if (!std::isfinite(time_s) || time_s < 0.0 || in.number<std::uint64_t>() != bodies_.size())
    throw Error(C3DE_E_FORMAT, "the state's time or number of bodies is not possible");
  std::vector<SpringBody::State> states;
  for (const auto &[id, body] : bodies_) {
    const std::size_t count = body.physics.masses().size();
    if (in.number<std::uint64_t>() != count)
      throw Error(C3DE_E_FORMAT, "the state has another number of masses for body '" + body.name + "'");
    SpringBody::State state{std::vector<Vec3>(count), std::vector<Vec3>(count)};
    in.take(state.positions.data(), count);
    in.take(state.velocities.data(), count);
    for (std::size_t i = 0; i < count; ++i)
      if (!isFinite(state.positions[i]) || !isFinite(state.velocities[i]))
        throw Error(C3DE_E_FORMAT, "the state of body '" + body.name + "' is not finite");
    states.push_back(std::move(state));
  }
  if (in.left() != 0)
    throw Error(C3DE_E_FORMAT, std::to_string(in.left()) + " bytes stand behind the end of the state");
  resetAll();
  std::size_t i = 0;
  for (auto &[id, body] : bodies_) body.physics.setState(std::move(states[i++]));
  steps_ = steps;
  time_s_ = time_s;
}

c3de_status Simulator::report(c3de_sink sink) {
  const std::lock_guard lock(mutex_);
  std::string bodies, probes, reactions;
  const auto separate = [](std::string &list) { list += list.empty() ? "" : ","; };
  for (const auto &[id, body] : bodies_) {
    const SpringBody &p = body.physics;
    separate(bodies);
    bodies += "{\"name\":" + quoted(body.name) + ",\"masses\":" + std::to_string(p.masses().size()) +
              ",\"springs\":" + std::to_string(p.springCount()) +
              ",\"surface_points\":" + std::to_string(p.skin().vertices.size()) +
              ",\"spacing_m\":" + json(p.lattice().spacing()) + ",\"mass_kg\":" + json(p.mass_kg()) +
              ",\"volume_m3\":" + json(p.volume_m3()) + ",\"mesh_volume_m3\":" + json(body.meshVolume_m3) +
              ",\"stable_dt_s\":" + json(p.stableStep_s()) + ",\"energy_J\":{\"kinetic\":" + json(p.kineticEnergy_J()) +
              ",\"elastic\":" + json(p.elasticEnergy_J()) + "},\"momentum\":" + json(p.momentum()) +
              ",\"angular_momentum\":" + json(p.angularMomentum()) + ",\"centre_of_mass_m\":" + json(p.centre()) + "}";
    for (const Support &support : p.supports()) {
      separate(reactions);
      reactions += "{\"body\":" + quoted(body.name) + ",\"fix\":" + std::to_string(support.number) +
                   ",\"force_N\":" + json(p.reaction(support)) + "}";
    }
  }
  for (const Probe &probe : probes_) {
    separate(probes);
    probes += "{\"name\":" + quoted(probe.name) + ",\"reference_m\":" + json(probe.reference) +
              ",\"position_m\":" + json(probe.bound.of(bodies_.at(probe.body).physics.state().positions)) + "}";
  }
  return sdk::put(sink, "{\"bodies\":[" + bodies + "],\"probes\":[" + probes + "],\"reactions\":[" + reactions +
                            "],\"stages\":[],\"events\":[]}");
}

void Simulator::bodyAt(std::uint64_t index, c3de_handle *out) {
  const std::lock_guard lock(mutex_);
  if (index >= bodies_.size())
    throw Error(C3DE_E_NOT_FOUND, "body " + std::to_string(index) + ": there are " + std::to_string(bodies_.size()));
  sdk::notNull(out, "out") = {std::next(bodies_.begin(), static_cast<std::ptrdiff_t>(index))->first};
}

void Simulator::bodyInfo(c3de_handle body, c3de_sim_body_info *out) {
  const std::lock_guard lock(mutex_);
  const Body &of = bodyOrThrow(body);
  const SpringBody &p = of.physics;
  c3de_sim_body_info info{};
  info.name = sdk::str(of.name);
  info.points = p.masses().size();
  info.surface_points = p.skin().vertices.size();
  info.mass_kg = p.mass_kg();
  info.volume_m3 = p.volume_m3();
  info.mesh_volume_m3 = of.meshVolume_m3;
  info.spacing_m = p.lattice().spacing();
  info.stable_dt_s = p.stableStep_s();
  sdk::writeStruct(out, info, "out");
}

c3de_status Simulator::enumFields(c3de_handle body, void *visitor,
                                  c3de_status(C3DE_CALL *each)(void *visitor, const c3de_sim_field *field)) {
  if (each == nullptr) throw Error(C3DE_E_ARG, "each is null");
  {
    const std::lock_guard lock(mutex_);
    (void)bodyOrThrow(body);
  }
  for (const Field &f : kFields) {
    const c3de_sim_field field{sizeof field, f.on, sdk::str(f.name), sdk::str(f.unit), f.comps, 0};
    if (const c3de_status status = each(visitor, &field); status != C3DE_OK) return status;
  }
  return C3DE_OK;
}

void Simulator::readField(c3de_handle body, std::uint32_t on, c3de_str name, c3de_mview out) {
  const std::lock_guard lock(mutex_);
  const SpringBody &p = bodyOrThrow(body).physics;
  const std::string_view which = sdk::text(name);
  const auto field =
      std::find_if(kFields.begin(), kFields.end(), [&](const Field &f) { return f.on == on && f.name == which; });
  if (field == kFields.end())
    throw Error(C3DE_E_NOT_FOUND, "mass springs have no field '" + std::string(which) + "' there");
  const auto write = [&](const auto &values, const auto &copyRow) {
    if (out.count < values.size())
      throw Error(C3DE_E_ARG, "field '" + std::string(which) + "' has " + std::to_string(values.size()) +
                                  " rows; there is room for " + std::to_string(out.count));
    for (std::size_t i = 0; i < values.size(); ++i) copyRow(i, values[i]);
  };
  if (field->comps == 1) {
    const auto rows = sdk::orThrow(sdk::asMutableRows<double, 1>(out, which));
    write(which == C3DE_SIM_FIELD_MASS     ? p.masses()
          : which == C3DE_SIM_FIELD_VOLUME ? p.volumes()
                                           : p.stretches(),
          [&](std::size_t i, double value) { *rows[i] = value; });
    return;
  }
  std::vector<Vec3> values = which == C3DE_SIM_FIELD_VELOCITY             ? p.state().velocities
                             : which == C3DE_SIM_FIELD_REFERENCE_POSITION ? p.lattice().nodes()
                             : which == "force"                           ? p.forces()
                                                                          : p.state().positions;
  if (which == "displacement")
    for (std::size_t i = 0; i < values.size(); ++i) values[i] -= p.lattice().nodes()[i];
  const auto rows = sdk::orThrow(sdk::asMutableRows<double, 3>(out, which));
  write(on == kSurface ? p.onSkin(values) : values,
        [&](std::size_t i, const Vec3 &value) { std::copy(value.begin(), value.end(), rows[i]); });
}

void Simulator::triangles(c3de_handle body, c3de_view *out) {
  const std::lock_guard lock(mutex_);
  const auto &found = *bodyOrThrow(body).triangles;
  sdk::notNull(out, "out") = {found.data(), found.size(), 3, C3DE_U32, 0};
}

c3de_status Simulator::enumProbes(void *visitor,
                                  c3de_status(C3DE_CALL *each)(void *visitor, const c3de_sim_probe *probe)) {
  if (each == nullptr) throw Error(C3DE_E_ARG, "each is null");
  const std::lock_guard lock(mutex_);
  for (const Probe &probe : probes_) {
    const SpringBody::State &state = bodies_.at(probe.body).physics.state();
    c3de_sim_probe out{};
    out.size = sizeof out;
    out.name = sdk::str(probe.name);
    out.body = {probe.body};
    const Vec3 x = probe.bound.of(state.positions), v = probe.bound.of(state.velocities);
    std::copy(probe.reference.begin(), probe.reference.end(), out.reference_m);
    std::copy(x.begin(), x.end(), out.position_m);
    std::copy(v.begin(), v.end(), out.velocity_m_s);
    if (const c3de_status status = each(visitor, &out); status != C3DE_OK) return status;
  }
  return C3DE_OK;
}

void Simulator::points(c3de_handle handle, c3de_sim_points *out) {
  const std::lock_guard lock(mutex_);
  Body &body = bodyOrThrow(handle);
  const SpringBody &p = body.physics;
  const std::size_t n = p.masses().size();
  body.lentPositions = p.state().positions;
  body.lentVelocities = p.state().velocities;
  body.lentForces.assign(n, Vec3{});
  body.lentMasses = p.masses();
  for (std::size_t i = 0; i < n; ++i)
    if (p.held()[i] != 0) body.lentMasses[i] = 0.0;
  body.hasForces = true;
  c3de_sim_points points{};
  points.name = sdk::str(body.name);
  points.count = n;
  points.positions_m = body.lentPositions.front().data();
  points.velocities_m_s = body.lentVelocities.front().data();
  points.masses_kg = body.lentMasses.data();
  points.forces_N = body.lentForces.front().data();
  sdk::writeStruct(out, points, "out");
}

void Simulator::addLoad(c3de_handle handle, const c3de_sim_load *load, c3de_handle *out) {
  const std::lock_guard lock(mutex_);
  Body &body = bodyOrThrow(handle);
  SurfaceLoad made = readLoad(sdk::readStruct(load, "load"), body.physics);
  made.began_s = time_s_;
  body.liveLoads.emplace(nextId_, std::move(made));
  if (out != nullptr) *out = {nextId_};
  ++nextId_;
}

void Simulator::hold(c3de_handle body, const double *at_m3, double radius_m) {
  if (at_m3 == nullptr || !isFinite(vectorOf(at_m3)) || !(radius_m > 0.0) || !std::isfinite(radius_m))
    throw Error(C3DE_E_ARG, "hold: accepted: a finite point and a radius above 0 m");
  const std::lock_guard lock(mutex_);
  SpringBody &p = bodyOrThrow(body).physics;
  p.hold = p.holdAround(vectorOf(at_m3), radius_m);
}

void Simulator::pull(c3de_handle body, const double *target_m3) {
  if (target_m3 == nullptr || !isFinite(vectorOf(target_m3))) throw Error(C3DE_E_ARG, "pull: the target is not finite");
  const std::lock_guard lock(mutex_);
  auto &hand = bodyOrThrow(body).physics.hold;
  if (!hand) throw Error(C3DE_E_STATE, "pull: nobody holds this body; hold() first");
  hand->target_m = vectorOf(target_m3);
}

void Simulator::letGo(c3de_handle body) {
  const std::lock_guard lock(mutex_);
  bodyOrThrow(body).physics.hold.reset();
}

void Simulator::holdForce(c3de_handle body, double *force_N3) {
  if (force_N3 == nullptr) throw Error(C3DE_E_ARG, "hold_force: force_N3 is null");
  const std::lock_guard lock(mutex_);
  const auto &hand = bodyOrThrow(body).physics.hold;
  const Vec3 force = hand ? hand->force_N : Vec3{};
  std::copy(force.begin(), force.end(), force_N3);
}

}  // namespace mass_spring
