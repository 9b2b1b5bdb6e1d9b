// SPDX-License-Identifier: Apache-2.0
#include "support/recording_simulator.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <sstream>
#include <thread>

#include "c3de/core/text.h"

namespace c3de::test {
namespace {

std::vector<double> rowsOf(const std::vector<Vec3> &points) {
  std::vector<double> rows;
  for (const Vec3 &p : points) rows.insert(rows.end(), p.begin(), p.end());
  return rows;
}

c3de_param_decl declared(const std::string &id) {
  c3de_param_decl decl{};
  decl.size = sizeof decl;
  const bool isVector = id.ends_with(".min") || id.ends_with(".max") || id.ends_with(".gravity"),
             isSwitch = id.ends_with(".enabled") || id == "rigid", isCount = id.ends_with(".count");
  decl.type = isVector ? C3DE_PARAM_VEC3 : isSwitch ? C3DE_PARAM_BOOL : isCount ? C3DE_PARAM_I64 : C3DE_PARAM_F64;
  decl.id = decl.label = c3de::toAbi(id);
  decl.min = isVector ? -10.0 : isSwitch ? 0.0 : -1.0;
  decl.max = isVector ? 10.0 : isSwitch ? 1.0 : 1e9;
  return decl;
}

const Fields &fieldsOn(std::uint32_t on, const ReportedBody &body) {
  return on == C3DE_SIM_ON_POINTS ? body.inside : body.skin;
}
std::uint64_t countOn(std::uint32_t on, const ReportedBody &body) {
  return on == C3DE_SIM_ON_POINTS ? body.points : body.surfacePoints;
}

}  // namespace

ReportedBody cubeBody(double edge_m, const Vec3 &low_m, const Vec3 &moved_m) {
  ReportedBody body;
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

ReportedBody pointBody(const std::string &name, std::size_t points) {
  ReportedBody body;
  body.name = name;
  body.forces_N.resize(3 * points);
  return body;
}

std::vector<double> &numbersOf(Fields &fields, const std::string &name) {
  return std::find_if(fields.begin(), fields.end(), [&](const RecordedField &f) { return f.name == name; })->numbers;
}

void eraseField(Fields &fields, const std::string &name) {
  std::erase_if(fields, [&](const RecordedField &field) { return field.name == name; });
}

RecordingSimulator::RecordingSimulator() : vt_(*abi()->vt), table_(sdk::kSimulatorTable<RecordingSimulator>) {
  vt_.query = [](c3de_object *self, c3de_str id, std::uint32_t, const void **table) -> c3de_status {
    RecordingSimulator &it = *from(self);
    if (it.contact && fromAbi(id) == std::string_view(C3DE_IFACE_CONTACT_ID)) {
      *table = it.contact;
      return C3DE_OK;
    }
    if (it.hasChanges && fromAbi(id) == std::string_view(C3DE_IFACE_CHANGES_ID)) {
      *table = &it.changesTable_;
      return C3DE_OK;
    }
    if (!it.answersInterface || fromAbi(id) != std::string_view(C3DE_IFACE_SIMULATOR_ID)) return C3DE_E_NOT_FOUND;
    *table = it.table();
    return C3DE_OK;
  };
  abi()->vt = &vt_;
}

const c3de_simulator_v1 *RecordingSimulator::table() {
  // Written only where a test has changed it: the simulation's thread reads.
  if (table_.size != tableSize) table_.size = tableSize;
  if (!hasDisplacement && table_.displacement != nullptr) table_.displacement = nullptr;
  if (lacksStateHash && table_.state_hash != nullptr) table_.state_hash = nullptr;
  if (!hasInterrupt && table_.interrupt != nullptr) table_.interrupt = nullptr;
  if (!hasPoints && table_.points != nullptr) table_.points = nullptr;
  if (!hasStates && table_.save_state != nullptr) table_.save_state = nullptr;
  if (!hasStates && table_.load_state != nullptr) table_.load_state = nullptr;
  return &table_;
}

// Not inline: GCC takes the end of the last reference for certain, also of a simulator on the stack.
std::uint32_t RecordingSimulator::references() {
  retain();
  return release();
}

c3de_status RecordingSimulator::answer(const char *function) const {
  const std::lock_guard lock(mutex_);
  const auto refused = failing_.find(function);
  return refused == failing_.end() ? C3DE_OK : refused->second;
}

void RecordingSimulator::check(const char *function) const {
  if (const c3de_status code = answer(function); code < 0) throw sdk::Error(code, function);
}

void RecordingSimulator::fail(const std::string &function, c3de_status with) {
  const std::lock_guard lock(mutex_);
  failing_[function] = with;
}

void RecordingSimulator::failNowhere() {
  const std::lock_guard lock(mutex_);
  failing_.clear();
}

void RecordingSimulator::attach(c3de_handle node) {
  attached = node.v;
  if (node.v != 0) check("attach");
}

c3de_status RecordingSimulator::declarations(std::uint32_t scope, const c3de_param_decl **decls, std::uint64_t *n,
                                             std::uint64_t *stride) {
  auto &chosen = decls_[scope == C3DE_SIM_SCOPE_WORLD ? 0 : 1];
  chosen.clear();
  for (const std::string &id : scope == C3DE_SIM_SCOPE_WORLD ? worldIds : bodyIds) chosen.push_back(declared(id));
  *decls = chosen.data();
  *n = chosen.size();
  *stride = sizeof(c3de_param_decl);
  return answer("declarations");
}

void RecordingSimulator::setWorld(const c3de_param_value *values, std::uint64_t n, std::uint64_t) {
  check("set_world");
  for (std::uint64_t i = 0; i < n; ++i) world.push_back(ParameterValue::from(values[i]));
}

void RecordingSimulator::addBody(const c3de_sim_body *in, c3de_handle *out) {
  check("add_body");
  if (cancelsFrom != 0 && added.size() + 1 >= cancelsFrom) throw sdk::Error(C3DE_E_CANCELLED, "add_body");
  AddedBody body;
  body.name = std::string(fromAbi(in->name));
  for (std::uint64_t i = 0; i < in->params_n; ++i)
    body.params[std::string(fromAbi(in->params[i].id))] = in->params[i].num;
  body.fixes = in->fixes_n;
  body.hasFill = in->fill != nullptr;
  body.hasColour = in->colour != nullptr;
  body.mesh = in->mesh.v;
  added.push_back(std::move(body));
  *out = {added.size()};
}

void RecordingSimulator::addObstacle(const c3de_sim_obstacle *in, c3de_handle *out) {
  check("add_obstacle");
  obstacles.emplace_back(fromAbi(in->name));
  *out = {1000};
}

void RecordingSimulator::step() {
  check("step");
  const auto end = std::chrono::steady_clock::now() + std::chrono::microseconds(stepCost_us);
  for (;;) {
    if (interrupted) {
      ++endedSteps;
      throw sdk::Error(C3DE_E_CANCELLED, "step");
    }
    const auto left = end - std::chrono::steady_clock::now();
    if (left <= left.zero()) break;
    std::this_thread::sleep_for(std::min<std::chrono::nanoseconds>(left, std::chrono::milliseconds(5)));
  }
  if (steps + 1 == failAtStep) throw sdk::Error(failStatus, "step");
  ++totalSteps;
  const bool finished = finishesAtStep > 0 && steps >= finishesAtStep;
  if (standsStill || finished) return;
  ++steps;
  path_ = 31 * path_ + steps + warm_++;
}

void RecordingSimulator::reset() {
  check("reset");
  ++resets;
  steps = 0;
  warm_ = path_ = 0;
  changed.resize(lasting_);
}

void RecordingSimulator::publish() {
  ++publishes;
  publishedStep = steps.load();
}

c3de_status RecordingSimulator::status(c3de_sim_status *out) const {
  out->steps = steps;
  out->dt_s = finishesAtStep != 0 ? 0.0 : dt_s.load();
  out->time_s = static_cast<double>(out->steps) * out->dt_s;
  out->bodies = bodies.size();
  out->finished = finishesAtStep != 0 && out->steps >= finishesAtStep ? 1u : 0u;
  out->stopped = stopped;
  if (finishesAtStep != 0) out->flags = C3DE_SIM_LOAD_STEPS;
  out->planned_steps = plannedSteps;
  return answer("status");
}

c3de_status RecordingSimulator::stateHash(std::uint64_t *out) const {
  *out = 0xabcdu;
  if (hashesState) {
    std::string state = std::to_string(steps);
    for (const std::string &text : changed) state += "\n" + text;
    if (hasWarmStart) state += "\n" + std::to_string(path_);
    for (const char c : state) *out = (*out ^ static_cast<unsigned char>(c)) * 0x100000001b3ull;
  }
  return answer("state_hash");
}

c3de_status RecordingSimulator::observe(c3de_object *self, void *observer,
                                        void(C3DE_CALL *call)(void *, const c3de_sim_change *)) {
  RecordingSimulator &it = *from(self);
  it.observer_ = observer;
  it.observed_ = call;
  return it.answer("observe");
}

c3de_status RecordingSimulator::applyChange(c3de_object *self, const c3de_sim_change *change) {
  RecordingSimulator &it = *from(self);
  if (fromAbi(change->id) == "state.store")
    return it.saveState({nullptr, [](void *, const void *, std::uint64_t) noexcept { return C3DE_OK; }});
  if (fromAbi(change->id) != "test.add") return C3DE_E_FORMAT;
  if (const c3de_status code = it.answer("apply"); code < 0) return code;
  it.change(std::string(static_cast<const char *>(change->bytes), change->n), change->flags);
  return C3DE_OK;
}

void RecordingSimulator::change(const std::string &text, std::uint32_t flags, const std::string &key) {
  const std::uint64_t before = steps;
  changed.push_back(text);
  if ((flags & C3DE_SIM_CHANGE_TRANSIENT) == 0) lasting_ = changed.size();
  if ((flags & C3DE_SIM_CHANGE_RESETS) != 0) steps = 0;
  notify("test.add", "add " + text, text, flags, key, before);
}

void RecordingSimulator::notify(const char *id, const std::string &text, const std::string &bytes, std::uint32_t flags,
                                const std::string &key, std::uint64_t before) {
  const std::string name = id;
  c3de_sim_change change{};
  change.size = sizeof change;
  change.flags = flags;
  change.id = c3de::toAbi(name);
  change.key = c3de::toAbi(key);
  change.text = c3de::toAbi(text);
  change.steps = before;
  change.bytes = bytes.data();
  change.n = bytes.size();
  if (observed_ != nullptr) observed_(observer_, &change);
}

c3de_status RecordingSimulator::saveState(c3de_sink state) {
  if (!changed.empty() && changed.back() == holding) return C3DE_E_STATE;
  if (hasWarmStart) {
    warm_ = 0;
    notify("state.store", "store state", {}, C3DE_SIM_CHANGE_TRANSIENT, {}, steps);
  }
  std::string text = std::to_string(steps);
  if (hasWarmStart) text += "\npath " + std::to_string(path_);
  for (const std::string &one : changed) text += "\n" + one;
  return sdk::put(state, text);
}

void RecordingSimulator::loadState(const void *bytes, std::uint64_t n) {
  check("load_state");
  std::istringstream in(std::string(static_cast<const char *>(bytes), n));
  std::string line;
  std::getline(in, line);
  steps = std::stoull(line);
  changed.clear();
  while (std::getline(in, line)) {
    if (hasWarmStart && line.starts_with("path "))
      path_ = std::stoull(line.substr(5));
    else
      changed.push_back(line);
  }
  warm_ = 0;
  lasting_ = changed.size();
}

c3de_status RecordingSimulator::report(c3de_sink json) const {
  check("report");
  return sdk::put(json, reportText);
}

void RecordingSimulator::bodyAt(std::uint64_t index, c3de_handle *out) const {
  check("body_at");
  if (index >= bodies.size()) throw sdk::Error(C3DE_E_NOT_FOUND, "body_at");
  *out = {index + 1};
}

c3de_status RecordingSimulator::bodyInfo(c3de_handle body, c3de_sim_body_info *out) const {
  if (body.v == 0 || body.v > bodies.size()) return C3DE_E_STALE;
  const ReportedBody &from = bodies[body.v - 1];
  out->name = c3de::toAbi(from.name);
  out->spacing_m = from.spacing_m;
  out->points = from.points;
  out->surface_points = from.surfacePoints;
  return answer("body_info");
}

c3de_status RecordingSimulator::enumFields(c3de_handle body, void *visitor,
                                           c3de_status(C3DE_CALL *each)(void *, const c3de_sim_field *)) const {
  const ReportedBody &from = bodies[body.v - 1];
  for (const std::uint32_t on : {C3DE_SIM_ON_POINTS, C3DE_SIM_ON_SURFACE}) {
    const std::uint64_t count = countOn(on, from);
    for (const RecordedField &one : fieldsOn(on, from)) {
      c3de_sim_field field{};
      field.size = sizeof field;
      field.on = on;
      field.name = c3de::toAbi(one.name);
      field.unit = c3de::toAbi(one.unit);
      field.comps = static_cast<std::uint32_t>(count == 0 ? 1 : one.numbers.size() / count);
      if (const c3de_status code = each(visitor, &field); code != C3DE_OK) return code;
    }
  }
  return answer("enum_fields");
}

c3de_status RecordingSimulator::readField(c3de_handle body, std::uint32_t on, c3de_str name, c3de_mview out) const {
  check(on == C3DE_SIM_ON_POINTS ? "points" : "surface");
  const ReportedBody &from = bodies[body.v - 1];
  for (const RecordedField &one : fieldsOn(on, from)) {
    if (one.name != fromAbi(name)) continue;
    if (out.dtype != C3DE_F64 || out.count != countOn(on, from) || out.count * out.comps != one.numbers.size())
      return C3DE_E_ARG;
    const std::size_t row = sizeof(double) * out.comps;
    const std::size_t stride = out.stride != 0 ? static_cast<std::size_t>(out.stride) : row;
    for (std::size_t i = 0; i < out.count; ++i)
      std::memcpy(static_cast<char *>(out.data) + i * stride, one.numbers.data() + i * out.comps, row);
    return C3DE_OK;
  }
  return C3DE_E_NOT_FOUND;
}

void RecordingSimulator::triangles(c3de_handle body, c3de_view *out) const {
  check("triangles");
  const std::vector<Triangle> &triangles = bodies[body.v - 1].triangles;
  *out = {triangles.data(), triangles.size(), triangleComponents, C3DE_U32, 0};
}

c3de_status RecordingSimulator::enumProbes(void *visitor,
                                           c3de_status(C3DE_CALL *each)(void *, const c3de_sim_probe *)) const {
  check("enum_probes");
  for (const auto &[name, at] : probes) {
    c3de_sim_probe probe{};
    probe.size = sizeof probe;
    probe.name = c3de::toAbi(name);
    std::copy(at.begin(), at.end(), probe.position_m);
    if (const c3de_status code = each(visitor, &probe); code != C3DE_OK) return code;
  }
  return C3DE_OK;
}

void RecordingSimulator::displacement(const c3de_sim_grid *grid, double rim_m, float *xyz_m, float *gaps_m) {
  check("displacement");
  rims_m.push_back(rim_m);
  grids.push_back(*grid);
  const std::uint64_t n = grid->points[0] * grid->points[1] * grid->points[2];
  for (std::uint64_t i = 0; i < n; ++i) {
    for (std::size_t a = 0; a < 3; ++a) xyz_m[3 * i + a] = static_cast<float>(displacement_m[a]);
    if (gaps_m != nullptr) gaps_m[i] = static_cast<float>(gap_m);
  }
}

void RecordingSimulator::interrupt(std::uint32_t raised) {
  const std::lock_guard lock(mutex_);  // the caller of a command and the simulation's thread
  interrupted = raised != 0;
  interrupts.push_back(raised);
  ++interruptCalls;
}

void RecordingSimulator::points(c3de_handle body, c3de_sim_points *out) {
  static const std::vector<double> kNumbers(12, 2.0);
  ReportedBody &from = bodies.at(body.v - 1);
  std::fill(from.forces_N.begin(), from.forces_N.end(), 0.0);
  out->name = c3de::toAbi(from.name);
  out->count = from.forces_N.size() / 3;
  out->positions_m = out->velocities_m_s = out->masses_kg = kNumbers.data();
  out->forces_N = from.forces_N.data();
}

}  // namespace c3de::test
