// SPDX-License-Identifier: Apache-2.0
// Bodies, their fields and triangles, and what holds them.
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "c3de/core/first_size.h"
#include "c3de/core/text.h"
#include "use.h"

namespace c3de::embed {
namespace {

constexpr const char *kDisplacement = "displacement";

template <class Field>
bool hasName(const std::vector<Field> &fields, std::string_view name) {
  return std::any_of(fields.begin(), fields.end(), [&](const Field &one) { return one.name == name; });
}

c3de_embed_array arrayOf(const void *data, std::uint32_t dtype, std::uint64_t rows, std::uint32_t comps,
                         std::int64_t rowBytes) {
  c3de_embed_array out{};
  out.size = sizeof out;
  out.dtype = dtype;
  out.data = data;
  out.rank = comps == 1 ? 1 : 2;
  out.shape[0] = rows;
  out.shape[1] = comps;
  out.strides[0] = rowBytes;
  out.strides[1] = rowBytes / comps;
  return out;
}

}  // namespace

Result<void> EmbeddedSimulation::readBodies() {
  if (bodiesGeneration_ == generation_) return {};
  std::vector<BodyEntry> all(status_.bodies);
  for (std::uint64_t i = 0; i < all.size(); ++i) {
    BodyEntry &body = all[i];
    c3de_sim_body_info info{};
    info.size = sizeof info;
    c3de_status code = table_->body_at(simulator_->get(), i, &body.handle);
    if (code >= 0) code = table_->body_info(simulator_->get(), body.handle, &info);
    if (code < 0) return tl::unexpected(reason(fmt::format("body {}", i), code));
    if (info.points > session::kMaxPoints || info.surface_points > session::kMaxPoints)
      return refuse(C3DE_E_UNSUPPORTED, fmt::format("body {}: the simulator states an impossible number of points", i));
    c3de_view triangles{};
    (void)table_->triangles(simulator_->get(), body.handle, &triangles);
    body.info = {sizeof(c3de_embed_body),
                 0,
                 intern(fromAbi(info.name)),
                 info.points,
                 info.surface_points,
                 triangles.count,
                 info.mass_kg,
                 info.volume_m3,
                 info.spacing_m,
                 info.stable_dt_s};
    struct Visit {
      BodyEntry *to;
    } visit{&body};
    (void)table_->enum_fields(
        simulator_->get(), body.handle, &visit, [](void *visitor, const c3de_sim_field *field) -> c3de_status {
          try {
            if (!sizeProblem(field).empty()) return C3DE_E_ARG;
            if (field->on != C3DE_SIM_ON_POINTS && field->on != C3DE_SIM_ON_SURFACE) return C3DE_OK;
            if (field->comps != 1 && field->comps != 3 && field->comps != 9) return C3DE_OK;
            static_cast<Visit *>(visitor)->to->fields[field->on - 1].push_back(
                {std::string(fromAbi(field->name)), std::string(fromAbi(field->unit)), field->comps});
            return C3DE_OK;
          } catch (...) {
            return C3DE_E_NOMEM;
          }
        });
    for (auto &fields : body.fields)
      if (!hasName(fields, kDisplacement) && hasName(fields, C3DE_SIM_FIELD_REFERENCE_POSITION))
        fields.push_back({kDisplacement, "m", 3});
  }
  bodies_ = std::move(all);
  bodiesGeneration_ = generation_;
  return {};
}

Result<const EmbeddedSimulation::BodyEntry *> EmbeddedSimulation::entryOf(std::uint64_t body) {
  if (auto read = readBodies(); !read) return tl::unexpected(read.error());
  if (body >= bodies_.size())
    return refuse(C3DE_E_NOT_FOUND, fmt::format("body {}: accepted: below {}", body, bodies_.size()));
  return &bodies_[body];
}

Result<c3de_embed_body> EmbeddedSimulation::bodyAt(std::uint64_t index) {
  const Use use(*this, Use::Access::read);
  if (use.isRefused()) return use.refusal();
  const auto body = entryOf(index);
  if (!body) return tl::unexpected(body.error());
  return (*body)->info;
}

Result<std::uint64_t> EmbeddedSimulation::findBody(std::string_view name) {
  const Use use(*this, Use::Access::read);
  if (use.isRefused()) return use.refusal();
  if (auto read = readBodies(); !read) return tl::unexpected(read.error());
  std::string known;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (bodies_[i].info.name == name) return i;
    known += (known.empty() ? "" : ", ") + std::string(bodies_[i].info.name);
  }
  return refuse(C3DE_E_NOT_FOUND,
                fmt::format("there is no body '{}'; there are: {}", displayText(name), known.empty() ? "none" : known));
}

Result<const EmbeddedSimulation::Described *> EmbeddedSimulation::describe(const BodyEntry &body, std::uint32_t on,
                                                                           std::string_view name) {
  if (on != C3DE_EMBED_ON_POINTS && on != C3DE_EMBED_ON_SURFACE)
    return refuse(C3DE_E_ARG, fmt::format("on {}: accepted: {} (points), {} (surface)", on, C3DE_EMBED_ON_POINTS,
                                          C3DE_EMBED_ON_SURFACE));
  std::string known;
  for (const Described &field : body.fields[on - 1]) {
    if (field.name == name) return &field;
    known += (known.empty() ? "" : ", ") + field.name;
  }
  return refuse(C3DE_E_NOT_FOUND,
                fmt::format("body '{}' has no field '{}' {}; there are: {}", body.info.name, displayText(name),
                            on == C3DE_EMBED_ON_POINTS ? "at its points" : "on its surface", known));
}

Result<c3de_embed_field> EmbeddedSimulation::fieldAt(std::uint64_t index, std::uint32_t on, std::uint64_t field) {
  const Use use(*this, Use::Access::read);
  if (use.isRefused()) return use.refusal();
  const auto body = entryOf(index);
  if (!body) return tl::unexpected(body.error());
  if (on != C3DE_EMBED_ON_POINTS && on != C3DE_EMBED_ON_SURFACE)
    return tl::unexpected(describe(**body, on, "").error());
  const std::vector<Described> &fields = (*body)->fields[on - 1];
  if (field >= fields.size())
    return refuse(C3DE_E_NOT_FOUND, fmt::format("field {}: accepted: below {}", field, fields.size()));
  const Described &found = fields[field];
  return c3de_embed_field{sizeof(c3de_embed_field), found.comps, intern(found.name), intern(found.unit)};
}

Result<void> EmbeddedSimulation::fill(const BodyEntry &body, std::uint32_t on, const Described &field, double *data,
                                      std::uint64_t rows) {
  if (rows == 0) return {};
  const auto read = [&](std::string_view name, double *to) {
    return table_->read_field(simulator_->get(), body.handle, on, toAbi(name), {to, rows, field.comps, C3DE_F64, 0});
  };
  c3de_status code = read(field.name, data);
  if (code == C3DE_E_NOT_FOUND && field.name == kDisplacement) {
    (void)session_->plugins().takeError();
    std::vector<double> reference(3 * rows);
    code = read(C3DE_SIM_FIELD_POSITION, data);
    if (code >= 0) code = read(C3DE_SIM_FIELD_REFERENCE_POSITION, reference.data());
    for (std::size_t i = 0; code >= 0 && i < reference.size(); ++i) data[i] -= reference[i];
  }
  if (code < 0) return tl::unexpected(reason(fmt::format("field '{}' of body '{}'", field.name, body.info.name), code));
  return {};
}

Result<c3de_embed_array> EmbeddedSimulation::viewField(std::uint64_t index, std::uint32_t on, std::string_view name) {
  const Use use(*this, Use::Access::cached);
  if (use.isRefused()) return use.refusal();
  auto memory = fields_.find(FieldKey<std::string_view>{index, on, name});
  if (memory == fields_.end() || memory->second.generation != generation_) {
    const OwnEnvironment environment;
    const auto body = entryOf(index);
    if (!body) return tl::unexpected(body.error());
    const auto field = describe(**body, on, name);
    if (!field) return tl::unexpected(field.error());
    const std::uint64_t rows = on == C3DE_EMBED_ON_POINTS ? (*body)->info.points : (*body)->info.surface_points;
    if (memory == fields_.end())
      memory = fields_.try_emplace(FieldKey<std::string>{index, on, std::string(name)}).first;
    FieldMemory &to = memory->second;
    to.generation = 0;
    to.comps = (*field)->comps;
    to.unit = intern((*field)->unit);
    to.values.resize(rows * to.comps);
    if (auto filled = fill(**body, on, **field, to.values.data(), rows); !filled) return tl::unexpected(filled.error());
    to.generation = generation_;
  }
  const FieldMemory &from = memory->second;
  c3de_embed_array out = arrayOf(from.values.data(), C3DE_F64, from.values.size() / from.comps, from.comps,
                                 static_cast<std::int64_t>(sizeof(double) * from.comps));
  out.unit = from.unit;
  out.generation = generation_;
  return out;
}

Result<void> EmbeddedSimulation::readField(std::uint64_t index, std::uint32_t on, std::string_view name, double *data,
                                           std::uint64_t bytes) {
  const Use use(*this, Use::Access::read);
  if (use.isRefused()) return use.refusal();
  const auto body = entryOf(index);
  if (!body) return tl::unexpected(body.error());
  const auto field = describe(**body, on, name);
  if (!field) return tl::unexpected(field.error());
  const std::uint64_t rows = on == C3DE_EMBED_ON_POINTS ? (*body)->info.points : (*body)->info.surface_points;
  if (const std::uint64_t needed = rows * (*field)->comps * sizeof(double); bytes != needed)
    return refuse(C3DE_E_ARG, fmt::format("field '{}' of body '{}': memory of {} bytes; accepted: {} ({} rows of {})",
                                          (*field)->name, (*body)->info.name, bytes, needed, rows, (*field)->comps));
  return fill(**body, on, **field, data, rows);
}

Result<c3de_embed_array> EmbeddedSimulation::viewTriangles(std::uint64_t index) {
  const Use use(*this, Use::Access::read);
  if (use.isRefused()) return use.refusal();
  const auto body = entryOf(index);
  if (!body) return tl::unexpected(body.error());
  return trianglesOf(**body);
}

Result<c3de_embed_array> EmbeddedSimulation::trianglesOf(const BodyEntry &body) {
  c3de_view view{};
  if (const c3de_status code = table_->triangles(simulator_->get(), body.handle, &view); code < 0)
    return tl::unexpected(reason(fmt::format("triangles of body '{}'", body.info.name), code));
  if (view.count != 0 && (view.comps != 3 || view.dtype != C3DE_U32 || view.data == nullptr))
    return refuse(C3DE_E_UNSUPPORTED,
                  fmt::format("triangles of body '{}': the simulator's are not rows of 3 u32", body.info.name));
  constexpr std::int64_t kTight = 3 * sizeof(std::uint32_t);
  c3de_embed_array out = arrayOf(view.data, C3DE_U32, view.count, 3, view.stride == 0 ? kTight : view.stride);
  out.strides[1] = sizeof(std::uint32_t);
  out.unit = "1";
  out.generation = generation_;
  return out;
}

Result<std::uint64_t> EmbeddedSimulation::hold(std::uint64_t index, const c3de_embed_hold &hold) {
  const Use use(*this, Use::Access::write);
  if (use.isRefused()) return use.refusal();
  const auto body = entryOf(index);
  if (!body) return tl::unexpected(body.error());
  if (table_->hold == nullptr || table_->pull == nullptr || table_->hold_state == nullptr)
    return refuse(C3DE_E_UNSUPPORTED, fmt::format("simulator {} cannot hold bodies", identity_.classId));
  c3de_sim_hold request{};
  request.size = sizeof request;
  request.flags = (hold.flags & C3DE_EMBED_HOLD_SHAPE) != 0 ? C3DE_SIM_HOLD_SHAPE : 0u;
  std::copy_n(hold.at_m, 3, request.at_m);
  request.radius_m = hold.radius_m;
  request.frequency_hz = hold.frequency_hz;
  request.damping_ratio = hold.damping_ratio;
  request.max_force_N = hold.max_force_N;
  c3de_handle made{};
  const c3de_status code = table_->hold(simulator_->get(), (*body)->handle, &request, &made);
  if (code < 0) return tl::unexpected(reason(fmt::format("holding body '{}'", (*body)->info.name), code));
  stateChanged();
  return made.v;
}

Result<void> EmbeddedSimulation::pull(std::uint64_t hold, const double *target_m) {
  const Use use(*this, Use::Access::write);
  if (use.isRefused()) return use.refusal();
  if (table_->pull == nullptr) return refuse(C3DE_E_UNSUPPORTED, "the simulator cannot hold bodies");
  if (const c3de_status code = table_->pull(simulator_->get(), {hold}, target_m, nullptr); code < 0)
    return tl::unexpected(reason("pulling", code));
  stateChanged();
  return {};
}

Result<c3de_embed_hold_state> EmbeddedSimulation::holdState(std::uint64_t hold) {
  const Use use(*this, Use::Access::read);
  if (use.isRefused()) return use.refusal();
  if (table_->hold_state == nullptr) return refuse(C3DE_E_UNSUPPORTED, "the simulator cannot hold bodies");
  c3de_sim_hold_state state{};
  state.size = sizeof state;
  if (const c3de_status code = table_->hold_state(simulator_->get(), {hold}, &state); code < 0)
    return tl::unexpected(reason("reading a hold", code));
  c3de_embed_hold_state out{};
  out.size = sizeof out;
  std::copy_n(state.point_m, 3, out.point_m);
  std::copy_n(state.target_m, 3, out.target_m);
  std::copy_n(state.force_N, 3, out.force_N);
  out.mass_kg = state.mass_kg;
  return out;
}

Result<void> EmbeddedSimulation::release(std::uint64_t hold) {
  const Use use(*this, Use::Access::write);
  if (use.isRefused()) return use.refusal();
  // remove() takes bodies as well: only holds are accepted here.
  if (auto known = holdState(hold); !known) return tl::unexpected(known.error());
  if (const c3de_status code = table_->remove(simulator_->get(), {hold}); code < 0)
    return tl::unexpected(reason("releasing a hold", code));
  stateChanged();
  return {};
}

}  // namespace c3de::embed
