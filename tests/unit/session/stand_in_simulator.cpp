// SPDX-License-Identifier: Apache-2.0
#include "stand_in_simulator.h"

#include <algorithm>
#include <cstring>

#include "c3de/core/text.h"

namespace c3de::session::test {
namespace {

std::vector<double> rowsOf(const std::vector<Vec3> &points) {
  std::vector<double> rows;
  for (const Vec3 &p : points) rows.insert(rows.end(), p.begin(), p.end());
  return rows;
}

}  // namespace

StandInBody cubeBody(double edge_m, const Vec3 &low_m, const Vec3 &moved_m) {
  StandInBody body;
  std::vector<Vec3> reference, now;
  for (unsigned corner = 0; corner < 8; ++corner) {
    Vec3 x = low_m;
    for (std::size_t a = 0; a < 3; ++a)
      if ((corner >> a & 1u) != 0) x[a] += edge_m;
    reference.push_back(x);
    now.push_back(x + moved_m);
  }
  body.surfacePoints = 8;
  body.skin = {{C3DE_SIM_FIELD_REFERENCE_POSITION, "m", rowsOf(reference)},
               {C3DE_SIM_FIELD_POSITION, "m", rowsOf(now)}};
  body.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return body;
}

std::vector<double> &numbersOf(Fields &fields, const std::string &name) {
  return std::find_if(fields.begin(), fields.end(), [&](const StandInField &f) { return f.name == name; })->numbers;
}

void eraseField(Fields &fields, const std::string &name) {
  std::erase_if(fields, [&](const StandInField &field) { return field.name == name; });
}

StandInSimulator::StandInSimulator() {
  shared_.object.vt = &vt_;
  shared_.owner = this;
}

const c3de_simulator_v1 *StandInSimulator::table() {
  // Written only where a test has changed it: the simulation's thread reads.
  if (table_.size != tableSize) table_.size = tableSize;
  if (!hasDisplacement && table_.displacement != nullptr) table_.displacement = nullptr;
  if (lacksStateHash && table_.state_hash != nullptr) table_.state_hash = nullptr;
  if (!hasInterrupt && table_.interrupt != nullptr) table_.interrupt = nullptr;
  return &table_;
}

c3de_status StandInSimulator::answer(const char *function) const {
  const std::lock_guard lock(failingMutex_);
  const auto refused = failing_.find(function);
  return refused == failing_.end() ? C3DE_OK : refused->second;
}

void StandInSimulator::fail(const std::string &function, c3de_status with) {
  const std::lock_guard lock(failingMutex_);
  failing_[function] = with;
}

void StandInSimulator::failNowhere() {
  const std::lock_guard lock(failingMutex_);
  failing_.clear();
}

void StandInSimulator::declare() {
  const auto fill = [](const std::vector<std::string> &ids, std::vector<c3de_param_decl> &decls) {
    decls.clear();
    for (const std::string &id : ids) {
      c3de_param_decl decl{};
      decl.size = sizeof decl;
      const bool isVector = id.ends_with(".min") || id.ends_with(".max") || id.ends_with(".gravity"),
                 isSwitch = id.ends_with(".enabled") || id == "rigid", isCount = id.ends_with(".count");
      decl.type = isVector ? C3DE_PARAM_VEC3 : isSwitch ? C3DE_PARAM_BOOL : isCount ? C3DE_PARAM_I64 : C3DE_PARAM_F64;
      decl.id = decl.label = c3de::toAbi(id);
      decl.min = isVector ? -10.0 : isSwitch ? 0.0 : -1.0;
      decl.max = isVector ? 10.0 : isSwitch ? 1.0 : 1e9;
      decls.push_back(decl);
    }
  };
  fill(worldIds, worldDecls_);
  fill(bodyIds, bodyDecls_);
}

c3de_object_vt StandInSimulator::makeVt() {
  c3de_object_vt vt{};
  vt.size = sizeof vt;
  vt.retain = [](c3de_object *self) -> std::uint32_t { return static_cast<std::uint32_t>(++of(self).references_); };
  vt.release = [](c3de_object *self) -> std::uint32_t { return static_cast<std::uint32_t>(--of(self).references_); };
  vt.query = [](c3de_object *self, c3de_str id, std::uint32_t, const void **table) -> c3de_status {
    if (of(self).contact && fromAbi(id) == std::string_view(C3DE_IFACE_CONTACT_ID)) {
      *table = of(self).contact;
      return C3DE_OK;
    }
    if (!of(self).answersInterface || fromAbi(id) != std::string_view(C3DE_IFACE_SIMULATOR_ID)) return C3DE_E_NOT_FOUND;
    *table = of(self).table();
    return C3DE_OK;
  };
  return vt;
}

c3de_simulator_v1 StandInSimulator::makeTable() {
  c3de_simulator_v1 table{};
  table.attach = [](c3de_object *self, c3de_handle node) -> c3de_status {
    of(self).attached = node.v;
    return node.v != 0 ? of(self).answer("attach") : C3DE_OK;
  };
  table.declarations = [](c3de_object *self, std::uint32_t scope, const c3de_param_decl **decls, std::uint64_t *n,
                          std::uint64_t *stride) -> c3de_status {
    StandInSimulator &it = of(self);
    it.declare();
    const auto &chosen = scope == C3DE_SIM_SCOPE_WORLD ? it.worldDecls_ : it.bodyDecls_;
    *decls = chosen.data();
    *n = chosen.size();
    *stride = sizeof(c3de_param_decl);
    return it.answer("declarations");
  };
  table.set_world = [](c3de_object *self, const c3de_param_value *values, std::uint64_t n,
                       std::uint64_t) -> c3de_status {
    if (const c3de_status code = of(self).answer("set_world"); code < 0) return code;
    for (std::uint64_t i = 0; i < n; ++i) of(self).world.push_back(ParameterValue::from(values[i]));
    return C3DE_OK;
  };
  table.add_body = [](c3de_object *self, const c3de_sim_body *in, c3de_handle *out) -> c3de_status {
    if (const c3de_status code = of(self).answer("add_body"); code < 0) return code;
    if (of(self).cancelsFrom != 0 && of(self).added.size() + 1 >= of(self).cancelsFrom) return C3DE_E_CANCELLED;
    AddedBody body;
    body.name = std::string(fromAbi(in->name));
    for (std::uint64_t i = 0; i < in->params_n; ++i)
      body.params[std::string(fromAbi(in->params[i].id))] = in->params[i].num;
    body.fixes = in->fixes_n;
    body.hasFill = in->fill != nullptr;
    body.hasColour = in->colour != nullptr;
    body.mesh = in->mesh.v;
    of(self).added.push_back(std::move(body));
    *out = {of(self).added.size()};
    return C3DE_OK;
  };
  table.add_obstacle = [](c3de_object *self, const c3de_sim_obstacle *in, c3de_handle *out) -> c3de_status {
    if (const c3de_status code = of(self).answer("add_obstacle"); code < 0) return code;
    of(self).obstacles.emplace_back(fromAbi(in->name));
    *out = {1000};
    return C3DE_OK;
  };
  table.add_probe = [](c3de_object *self, c3de_str, c3de_handle, const double *, c3de_handle *) -> c3de_status {
    return of(self).answer("add_probe");
  };
  table.set_body_param = [](c3de_object *, c3de_handle, const c3de_param_value *) -> c3de_status { return C3DE_OK; };
  table.get_body_param = [](c3de_object *, c3de_handle, c3de_str, c3de_param_value *) -> c3de_status {
    return C3DE_E_NOT_FOUND;
  };
  table.remove = [](c3de_object *, c3de_handle) -> c3de_status { return C3DE_E_NOT_FOUND; };
  table.clear = [](c3de_object *) -> c3de_status { return C3DE_OK; };
  table.step = [](c3de_object *self) -> c3de_status {
    if (const c3de_status code = of(self).answer("step"); code < 0) return code;
    if (!of(self).standsStill) ++of(self).steps;
    return C3DE_OK;
  };
  table.reset = [](c3de_object *self) -> c3de_status {
    of(self).steps = 0;
    return C3DE_OK;
  };
  table.publish = [](c3de_object *) -> c3de_status { return C3DE_OK; };
  table.status = [](c3de_object *self, c3de_sim_status *out) -> c3de_status {
    const StandInSimulator &it = of(self);
    out->steps = it.steps;
    out->dt_s = it.finishesAtStep != 0 ? 0.0 : it.dt_s;
    out->time_s = static_cast<double>(it.steps) * out->dt_s;
    out->bodies = it.bodies.size();
    out->finished = it.finishesAtStep != 0 && it.steps >= it.finishesAtStep ? 1u : 0u;
    out->stopped = it.stopped;
    if (it.finishesAtStep != 0) out->flags = C3DE_SIM_LOAD_STEPS;
    out->planned_steps = it.plannedSteps;
    return it.answer("status");
  };
  table.state_hash = [](c3de_object *self, std::uint64_t *out) -> c3de_status {
    *out = 0xabcdu;
    return of(self).answer("state_hash");
  };
  table.report = [](c3de_object *self, c3de_sink json) -> c3de_status {
    if (const c3de_status code = of(self).answer("report"); code < 0) return code;
    return json.put(json.self, of(self).report.data(), of(self).report.size());
  };
  table.body_at = [](c3de_object *self, std::uint64_t index, c3de_handle *out) -> c3de_status {
    if (const c3de_status code = of(self).answer("body_at"); code < 0) return code;
    if (index >= of(self).bodies.size()) return C3DE_E_NOT_FOUND;
    *out = {index + 1};
    return C3DE_OK;
  };
  table.body_info = [](c3de_object *self, c3de_handle body, c3de_sim_body_info *out) -> c3de_status {
    if (body.v == 0 || body.v > of(self).bodies.size()) return C3DE_E_STALE;
    const StandInBody &from = of(self).bodies[body.v - 1];
    out->name = c3de::toAbi(from.name);
    out->spacing_m = from.spacing_m;
    out->points = from.points;
    out->surface_points = from.surfacePoints;
    return of(self).answer("body_info");
  };
  table.enum_fields = [](c3de_object *self, c3de_handle body, void *visitor,
                         c3de_status(C3DE_CALL * each)(void *, const c3de_sim_field *)) -> c3de_status {
    const StandInBody &from = of(self).bodies[body.v - 1];
    for (const std::uint32_t on : {C3DE_SIM_ON_POINTS, C3DE_SIM_ON_SURFACE}) {
      const std::uint64_t count = on == C3DE_SIM_ON_POINTS ? from.points : from.surfacePoints;
      for (const StandInField &one : on == C3DE_SIM_ON_POINTS ? from.inside : from.skin) {
        c3de_sim_field field{};
        field.size = sizeof field;
        field.on = on;
        field.name = c3de::toAbi(one.name);
        field.unit = c3de::toAbi(one.unit);
        field.comps = static_cast<std::uint32_t>(count == 0 ? 1 : one.numbers.size() / count);
        if (const c3de_status code = each(visitor, &field); code != C3DE_OK) return code;
      }
    }
    return of(self).answer("enum_fields");
  };
  table.read_field = [](c3de_object *self, c3de_handle body, std::uint32_t on, c3de_str name,
                        c3de_mview out) -> c3de_status {
    if (const c3de_status code = of(self).answer(on == C3DE_SIM_ON_POINTS ? "points" : "surface"); code < 0)
      return code;
    const StandInBody &from = of(self).bodies[body.v - 1];
    const std::uint64_t count = on == C3DE_SIM_ON_POINTS ? from.points : from.surfacePoints;
    for (const StandInField &one : on == C3DE_SIM_ON_POINTS ? from.inside : from.skin) {
      if (one.name != fromAbi(name)) continue;
      if (out.dtype != C3DE_F64 || out.count != count || out.count * out.comps != one.numbers.size()) return C3DE_E_ARG;
      const std::size_t row = sizeof(double) * out.comps;
      const std::size_t stride = out.stride != 0 ? static_cast<std::size_t>(out.stride) : row;
      for (std::size_t i = 0; i < out.count; ++i)
        std::memcpy(static_cast<char *>(out.data) + i * stride, one.numbers.data() + i * out.comps, row);
      return C3DE_OK;
    }
    return C3DE_E_NOT_FOUND;
  };
  table.triangles = [](c3de_object *self, c3de_handle body, c3de_view *out) -> c3de_status {
    if (const c3de_status code = of(self).answer("triangles"); code < 0) return code;
    const std::vector<Triangle> &triangles = of(self).bodies[body.v - 1].triangles;
    *out = {triangles.data(), triangles.size(), of(self).triangleComponents, C3DE_U32, 0};
    return C3DE_OK;
  };
  table.enum_probes = [](c3de_object *self, void *visitor,
                         c3de_status(C3DE_CALL * each)(void *, const c3de_sim_probe *)) -> c3de_status {
    if (const c3de_status code = of(self).answer("enum_probes"); code < 0) return code;
    for (const auto &[name, at] : of(self).probes) {
      c3de_sim_probe probe{};
      probe.size = sizeof probe;
      probe.name = c3de::toAbi(name);
      for (std::size_t a = 0; a < 3; ++a) probe.position_m[a] = at[a];
      if (const c3de_status code = each(visitor, &probe); code != C3DE_OK) return code;
    }
    return C3DE_OK;
  };
  table.displacement = [](c3de_object *self, const c3de_sim_grid *grid, double rim_m, float *xyz_m,
                          float *gaps_m) -> c3de_status {
    StandInSimulator &it = of(self);
    if (const c3de_status code = it.answer("displacement"); code < 0) return code;
    it.rims_m.push_back(rim_m);
    it.grids.push_back(*grid);
    const std::uint64_t n = grid->points[0] * grid->points[1] * grid->points[2];
    for (std::uint64_t i = 0; i < n; ++i) {
      for (std::size_t a = 0; a < 3; ++a) xyz_m[3 * i + a] = static_cast<float>(it.displacement_m[a]);
      if (gaps_m != nullptr) gaps_m[i] = static_cast<float>(it.gap_m);
    }
    return C3DE_OK;
  };
  table.interrupt = [](c3de_object *self, std::uint32_t raised) -> c3de_status {
    of(self).interrupts.push_back(raised);
    ++of(self).interruptCalls;
    return C3DE_OK;
  };
  table.activity = [](c3de_object *, c3de_sink) -> c3de_status { return C3DE_OK; };
  return table;
}

}  // namespace c3de::session::test
