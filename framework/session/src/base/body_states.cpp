// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/body_states.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>

#include "base/field_reader.h"
#include "c3de/core/text.h"
#include "c3de/scene/simulation.h"
#include "c3de/session/simulator_access.h"

namespace c3de::session {
namespace {

using geometry::PointArray;

std::vector<Vec3> pointsInMillimetres(const std::vector<double> &metres) {
  std::vector<Vec3> out(metres.size() / 3);
  for (std::size_t i = 0; i < out.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) out[i][k] = scene::kMillimetresPerMetre * metres[3 * i + k];
  return out;
}

PointArray displacements(const std::vector<double> &now, const std::vector<double> &reference) {
  PointArray out{"displacement [mm]", 3, std::vector<double>(now.size())};
  for (std::size_t i = 0; i < now.size(); ++i) out.values[i] = scene::kMillimetresPerMetre * (now[i] - reference[i]);
  return out;
}

/// VTK stores matrices row by row, the fields are column-major.
std::vector<double> rowByRow(const std::vector<double> &matrices) {
  std::vector<double> out(matrices.size());
  for (std::size_t m = 0; m + 9 <= matrices.size(); m += 9)
    for (std::size_t r = 0; r < 3; ++r)
      for (std::size_t c = 0; c < 3; ++c) out[m + 3 * r + c] = matrices[m + 3 * c + r];
  return out;
}

/// Present positions, and arrays of every other field, displacements first.
Expected<void> readPoints(const FieldReader &reader, const std::string &what, std::vector<Vec3> &points,
                          std::vector<PointArray> &arrays) {
  const auto now = reader.read(C3DE_SIM_FIELD_POSITION, 3),
             reference = reader.read(C3DE_SIM_FIELD_REFERENCE_POSITION, 3);
  if (!now || !reference) return fail(ErrorCode::plugin, "the simulator gives no positions of " + what);
  points = pointsInMillimetres(*now);
  arrays.push_back(displacements(*now, *reference));
  return {};
}

Expected<void> readInside(const FieldReader &reader, BodyState &body) {
  auto read = readPoints(reader, "the points of '" + body.name + "'", body.inside.points, body.inside.arrays);
  if (!read) return read;
  for (const FieldReader::Field &field : reader.fields()) {
    if (field.name == C3DE_SIM_FIELD_POSITION || field.name == C3DE_SIM_FIELD_REFERENCE_POSITION) continue;
    auto values = reader.read(field.name, field.components);
    if (!values) continue;
    body.inside.arrays.push_back({field.name + " [" + field.unit + "]", field.components,
                                  field.components == 9 ? rowByRow(*values) : std::move(*values)});
  }
  return {};
}

Expected<void> readSkin(const FieldReader &reader, const c3de_simulator_v1 *table, c3de_object *simulator,
                        c3de_handle handle, BodyState &body) {
  auto read = readPoints(reader, "the surface of '" + body.name + "'", body.skin.vertices, body.skinArrays);
  if (!read) return read;
  c3de_view view{};
  if (table->triangles(simulator, handle, &view) < 0) return {};
  if (view.count > 0 && (view.comps != 3 || view.dtype != C3DE_U32 || view.data == nullptr))
    return fail(ErrorCode::plugin, "the triangles of '" + body.name + "' are not three u32 each");
  constexpr auto kTight = static_cast<std::int64_t>(sizeof(Triangle));
  if (view.count > kMaxPoints || (view.stride != 0 && view.stride < kTight))
    return fail(ErrorCode::plugin, "the triangles of '" + body.name + "': " + std::to_string(view.count) +
                                       " rows of stride " + std::to_string(view.stride) + "; accepted: up to " +
                                       std::to_string(kMaxPoints) + " rows, stride 0 (tight) or at least " +
                                       std::to_string(kTight));
  const std::size_t stride = view.stride ? static_cast<std::size_t>(view.stride) : sizeof(Triangle);
  body.skin.triangles.resize(static_cast<std::size_t>(view.count));
  for (std::size_t t = 0; t < body.skin.triangles.size(); ++t)
    std::memcpy(body.skin.triangles[t].data(), static_cast<const char *>(view.data) + t * stride, sizeof(Triangle));
  for (const Triangle &triangle : body.skin.triangles)
    for (const std::uint32_t vertex : triangle)
      if (vertex >= body.skin.vertices.size())
        return fail(ErrorCode::plugin, "a triangle of '" + body.name + "' refers to vertex " + std::to_string(vertex) +
                                           "; there are " + std::to_string(body.skin.vertices.size()));
  return {};
}

}  // namespace

Expected<std::vector<BodyState>> readBodyStates(c3de_object *simulator, BodyParts parts,
                                                const std::function<std::string()> &takeError) {
  const auto table = simulatorTable(simulator);
  if (!table) return tl::unexpected(table.error());
  const auto refused = [&](const std::string &what, c3de_status code) {
    const std::string reason = takeError ? takeError() : "";
    return fail(ErrorCode::plugin, "the simulator does not give " + what + ": " +
                                       (reason.empty() ? "status " + std::to_string(code) : reason));
  };
  c3de_sim_status status{};
  status.size = sizeof status;
  if (const c3de_status code = (*table)->status(simulator, &status); code < 0) return refused("its status", code);
  std::vector<BodyState> bodies;
  for (std::uint64_t i = 0; i < status.bodies; ++i) {
    c3de_handle handle{};
    if (const c3de_status code = (*table)->body_at(simulator, i, &handle); code < 0)
      return refused("body " + std::to_string(i), code);
    c3de_sim_body_info info{};
    info.size = sizeof info;
    if (const c3de_status code = (*table)->body_info(simulator, handle, &info); code < 0)
      return refused("the name of a body", code);
    BodyState body;
    body.name = displayText(fromAbi(info.name));
    for (const std::uint64_t points : {info.surface_points, info.points})
      if (points > kMaxPoints)
        return fail(ErrorCode::plugin, "the simulator says that body '" + body.name + "' has " +
                                           std::to_string(points) + " points; at most " + std::to_string(kMaxPoints) +
                                           " are possible");
    const FieldReader skin(*table, simulator, handle, C3DE_SIM_ON_SURFACE, info.surface_points);
    if (auto ok = readSkin(skin, *table, simulator, handle, body); !ok) return tl::unexpected(ok.error());
    if (parts == BodyParts::skinAndInside) {
      const FieldReader inside(*table, simulator, handle, C3DE_SIM_ON_POINTS, info.points);
      if (auto ok = readInside(inside, body); !ok) return tl::unexpected(ok.error());
    }
    bodies.push_back(std::move(body));
  }
  return bodies;
}

}  // namespace c3de::session
