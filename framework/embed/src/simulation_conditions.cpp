// SPDX-License-Identifier: Apache-2.0
// Supports and loads on parts of surfaces.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "c3de/core/text.h"
#include "c3de/scene/text_sink.h"
#include "c3de/session/surface_conditions.h"
#include "surface_part.h"
#include "use.h"

namespace c3de::embed {
namespace {

static_assert(C3DE_EMBED_SUPPORT == C3DE_SIM_CONDITION_FIX && C3DE_EMBED_DISPLACEMENT == C3DE_SIM_CONDITION_DISPLACE &&
              C3DE_EMBED_FORCE == C3DE_SIM_CONDITION_FORCE && C3DE_EMBED_PRESSURE == C3DE_SIM_CONDITION_PRESSURE &&
              C3DE_EMBED_AT_REST == C3DE_SIM_CONDITION_AT_REST);

std::string textOf(const double (&v)[3]) {
  return fmt::format("[{}, {}, {}]", formatNumber(v[0]), formatNumber(v[1]), formatNumber(v[2]));
}

Result<void> checkCondition(const c3de_embed_condition &in) {
  if (in.kind < C3DE_EMBED_SUPPORT || in.kind > C3DE_EMBED_PRESSURE)
    return refuse(C3DE_E_ARG,
                  fmt::format("kind is {}; accepted: 1 (support), 2 (displacement), 3 (force), 4 (pressure)", in.kind));
  const auto isFinite = [](const double(&v)[3]) {
    return std::all_of(v, v + 3, [](double one) { return std::isfinite(one); });
  };
  if (!isFinite(in.vector)) return refuse(C3DE_E_ARG, "vector is not finite; accepted: three finite numbers");
  if (!std::isfinite(in.pressure_Pa))
    return refuse(C3DE_E_ARG, fmt::format("pressure_Pa is {}; accepted: finite", in.pressure_Pa));
  if (in.vertices != nullptr) return {};
  if (!isFinite(in.box_min_m) || !isFinite(in.box_max_m))
    return refuse(C3DE_E_ARG, "a corner of the box is not finite; accepted: finite, m");
  for (int axis = 0; axis < 3; ++axis)
    if (in.box_min_m[axis] > in.box_max_m[axis])
      return refuse(C3DE_E_ARG, fmt::format("the box reaches from {} to {} m; accepted: its least corner first",
                                            textOf(in.box_min_m), textOf(in.box_max_m)));
  return {};
}

struct BodySurface {
  std::vector<Vec3> reference;
  Triangles triangles;
};

Result<SurfacePart> partOf(const c3de_embed_condition &in, const BodySurface &surface, const char *body) {
  SurfacePart part;
  if (in.vertices != nullptr) {
    std::vector<bool> chosen(surface.reference.size(), false);
    for (std::uint64_t i = 0; i < in.vertices_n; ++i) {
      if (in.vertices[i] >= chosen.size())
        return refuse(C3DE_E_ARG, fmt::format("vertices[{}] is {}; accepted: below {}, the vertices of the surface of "
                                              "body '{}'",
                                              i, in.vertices[i], chosen.size(), body));
      chosen[in.vertices[i]] = true;
    }
    part = partOfVertices(surface.reference, surface.triangles, chosen);
    if (part.triangles.empty())
      return refuse(C3DE_E_ARG, fmt::format("no triangle of body '{}' has all of its corners among the {} vertices; "
                                            "accepted: the corners of one triangle at least",
                                            body, in.vertices_n));
    return part;
  }
  const Vec3 min{in.box_min_m[0], in.box_min_m[1], in.box_min_m[2]};
  const Vec3 max{in.box_max_m[0], in.box_max_m[1], in.box_max_m[2]};
  part = partInBox(surface.reference, surface.triangles, min, max);
  if (!part.triangles.empty()) return part;
  double low[3], high[3];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    low[axis] = high[axis] = surface.reference.empty() ? 0.0 : surface.reference.front()[axis];
    for (const Vec3 &x : surface.reference) {
      low[axis] = std::min(low[axis], x[axis]);
      high[axis] = std::max(high[axis], x[axis]);
    }
  }
  return refuse(C3DE_E_ARG, fmt::format("the box from {} to {} m has no surface of body '{}', whose surface reaches "
                                        "from {} to {} m",
                                        textOf(in.box_min_m), textOf(in.box_max_m), body, textOf(low), textOf(high)));
}

std::string nameOf(const c3de_embed_condition &in, const char *body) {
  if (in.name != nullptr && *in.name != '\0') return in.name;
  constexpr std::array<const char *, 4> kKinds{"support", "displacement", "force", "pressure"};
  return fmt::format("{} of {}", kKinds[in.kind - C3DE_EMBED_SUPPORT], body);
}

}  // namespace

Result<const c3de_conditions_v0 *> EmbeddedSimulation::conditions() {
  const auto table = session::conditionsTable(simulator_->get());
  if (!table) return refuse(table.error());
  if (*table == nullptr)
    return refuse(
        C3DE_E_UNSUPPORTED,
        fmt::format("simulator {} sets no supports and loads while it runs; accepted: [[fix]] and [[load]] of "
                    "the scene",
                    identity_.classId));
  return *table;
}

Result<std::uint64_t> EmbeddedSimulation::setCondition(std::uint64_t index, const c3de_embed_condition &in,
                                                       std::uint64_t number) {
  const Use use(*this, Use::Access::write);
  if (use.isRefused()) return use.refusal();
  const auto table = conditions();
  if (!table) return tl::unexpected(table.error());
  if (auto good = checkCondition(in); !good) return tl::unexpected(good.error());
  const auto body = entryOf(index);
  if (!body) return tl::unexpected(body.error());
  const auto field = describe(**body, C3DE_EMBED_ON_SURFACE, C3DE_SIM_FIELD_REFERENCE_POSITION);
  if (!field) return tl::unexpected(field.error());
  BodySurface surface;
  surface.reference.resize((*body)->info.surface_points);
  if (!surface.reference.empty())
    if (auto filled =
            fill(**body, C3DE_EMBED_ON_SURFACE, **field, surface.reference.front().data(), surface.reference.size());
        !filled)
      return tl::unexpected(filled.error());
  const auto triangles = trianglesOf(**body);
  if (!triangles) return tl::unexpected(triangles.error());
  surface.triangles.resize(triangles->shape[0]);
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    std::memcpy(surface.triangles[t].data(),
                static_cast<const char *>(triangles->data) + static_cast<std::int64_t>(t) * triangles->strides[0],
                sizeof surface.triangles[t]);
    for (const std::uint32_t corner : surface.triangles[t])
      if (corner >= surface.reference.size())
        return refuse(C3DE_E_INTERNAL, "a triangle of the simulator has a corner that does not exist");
  }
  const auto part = partOf(in, surface, (*body)->info.name);
  if (!part) return tl::unexpected(part.error());
  const std::string name = nameOf(in, (*body)->info.name);
  c3de_sim_condition asked{};
  asked.size = sizeof asked;
  asked.flags = in.flags & C3DE_EMBED_AT_REST;
  asked.kind = in.kind;
  asked.name = {name.data(), name.size()};
  asked.body = (*body)->handle;
  asked.positions_m = part->positions.front().data();
  asked.positions_n = part->positions.size();
  asked.triangles = part->triangles.front().data();
  asked.triangles_n = part->triangles.size();
  std::copy_n(in.vector, 3, asked.vector);
  asked.pressure_Pa = in.pressure_Pa;
  asked.ramp_s = in.ramp_s;
  if (const c3de_status code = (*table)->set(simulator_->get(), &asked, &number); code < 0)
    return tl::unexpected(reason(fmt::format("'{}'", displayText(name)), code));
  stateChanged();
  if (auto read = readStatus(); !read) return tl::unexpected(read.error());
  return number;
}

Result<c3de_embed_condition_state> EmbeddedSimulation::conditionState(std::uint64_t number) {
  const Use use(*this, Use::Access::read);
  if (use.isRefused()) return use.refusal();
  const auto table = conditions();
  if (!table) return tl::unexpected(table.error());
  c3de_sim_condition_state state{};
  state.size = sizeof state;
  std::string warning;
  if (const c3de_status code = (*table)->state(simulator_->get(), number, &state, scene::sinkInto(warning)); code < 0)
    return tl::unexpected(reason("reading a support or load", code));
  c3de_embed_condition_state out{};
  out.size = sizeof out;
  out.area_m2 = state.area_m2;
  std::copy_n(state.force_N, 3, out.force_N);
  out.warning = intern(warning);
  return out;
}

Result<void> EmbeddedSimulation::removeCondition(std::uint64_t number) {
  const Use use(*this, Use::Access::write);
  if (use.isRefused()) return use.refusal();
  const auto table = conditions();
  if (!table) return tl::unexpected(table.error());
  if (const c3de_status code = (*table)->remove(simulator_->get(), number); code < 0)
    return tl::unexpected(reason("removing a support or load", code));
  stateChanged();
  return readStatus();
}

}  // namespace c3de::embed
