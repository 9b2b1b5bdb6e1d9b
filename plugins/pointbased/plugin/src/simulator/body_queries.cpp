// SPDX-License-Identifier: Apache-2.0
#include "simulator/body_queries.h"

#include <array>
#include <cmath>

#include "c3de/sdk/structs.hpp"
#include "simulator/body_fields.h"

namespace pointbased {

using sdk::Error;

void BodyQueries::bodyAt(std::uint64_t index, c3de_handle *out) {
  const std::lock_guard lock(world_.mutex);
  const std::vector<std::uint64_t> ids = table_.bodiesInOrder();
  if (index >= ids.size()) throw Error(noSuch("body"));
  sdk::notNull(out, "out") = {ids[static_cast<std::size_t>(index)]};
}

void BodyQueries::bodyInfo(c3de_handle handle, c3de_sim_body_info *out) {
  const std::lock_guard lock(world_.mutex);
  const BodyRecord &record = table_.bodyOrThrow(handle.v);
  sdk::writeStruct(out, record.info(*simulator_.body(handle.v)), "out");
}

c3de_status BodyQueries::enumFields(c3de_handle body, void *visitor, EachField each) {
  if (!each) throw Error(C3DE_E_ARG, "each is null");
  {
    const std::lock_guard lock(world_.mutex);
    (void)table_.bodyOrThrow(body.v);
  }
  for (const std::span<const c3de_sim_field> fields : {bodyFields(), contactFields()})
    for (const c3de_sim_field &field : fields)
      if (const c3de_status status = each(visitor, &field); status != C3DE_OK) return status;
  return C3DE_OK;
}

void BodyQueries::readField(c3de_handle body, std::uint32_t on, c3de_str name, c3de_mview out) {
  const std::lock_guard lock(world_.mutex);
  (void)table_.bodyOrThrow(body.v);
  const Body &of = *simulator_.body(body.v);
  if (!isContactField(on, sdk::text(name))) return readBodyField(of, on, sdk::text(name), out);
  std::vector<double> pressures;
  simulator_.diagnostics().contactPressures(body.v, pressures);
  writeContactPressures(of, on, pressures, world_.context.services.parallelFor(), out);
}

void BodyQueries::triangles(c3de_handle body, c3de_view *out) {
  const std::lock_guard lock(world_.mutex);
  (void)table_.bodyOrThrow(body.v);
  const auto &skin = simulator_.body(body.v)->rest().skin;
  static_assert(sizeof(skin[0]) == 3 * sizeof(std::uint32_t));
  sdk::notNull(out, "out") = {skin.data(), skin.size(), 3, C3DE_U32, 0};
}

void BodyQueries::displacement(const c3de_sim_grid *grid, double rim, float *out, float *gaps) {
  if (!grid || !out) throw Error(C3DE_E_ARG, "displacement: grid or xyz_m is null");
  if (!(rim >= 0.0) || !std::isfinite(rim)) throw Error(C3DE_E_ARG, "displacement: rim_m is not finite and >= 0");
  DisplacementField field(readGrid(*grid, "grid"), gaps != nullptr);
  const std::size_t points = grid->points[0] * grid->points[1] * grid->points[2];
  const std::lock_guard lock(world_.mutex);
  for (const auto &[id, record] : table_.bodies()) {
    const Body &body = *simulator_.body(id);
    field.add(body, world_.points.of(id, body.sharedRest()));
  }
  field.write(rim, {out, 3 * points});
  if (gaps) field.writeGaps({out, 3 * points}, {gaps, points});
}

Vec3 BodyQueries::displacementAt(const Vec3 &position) const {
  DisplacementField field({{1, 1, 1}, position, Mat3::Identity()});
  std::array<float, 3> u{};
  const std::lock_guard lock(world_.mutex);
  for (const auto &[id, record] : table_.bodies()) {
    const Body &body = *simulator_.body(id);
    field.add(body, world_.points.of(id, body.sharedRest()));
  }
  field.write(0.0, u);
  return vectorOf(u);
}

bool BodyQueries::readBody(std::uint64_t body, const std::function<void(const Body &)> &read) const {
  const std::lock_guard lock(world_.mutex);
  const Body *found = simulator_.body(body);
  if (!found) return false;
  read(*found);
  return true;
}

ObjectName BodyQueries::nameOfBody(std::uint64_t body) const {
  const std::lock_guard lock(world_.mutex);
  return table_.bodyOrThrow(body).identity();
}

ObjectName BodyQueries::nameOfObstacle(std::uint64_t obstacle) const {
  const std::lock_guard lock(world_.mutex);
  const ObstacleRecord *found = table_.obstacle(obstacle);
  if (!found) throw Error(noSuch("obstacle"));
  return found->identity();
}

}  // namespace pointbased
