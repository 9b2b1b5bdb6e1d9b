// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <filesystem>
#include <optional>

#include "arguments.h"
#include "c3de/geometry/mesh_formats.h"
#include "c3de/scene/mesh_store.h"
#include "services/length_unit.h"
#include "services/progress_adapter.h"
#include "services/services.h"

namespace c3de::plugin_host {
namespace {

using geometry::LengthUnit;

std::uint32_t abiUnit(LengthUnit unit) {
  switch (unit) {
    case LengthUnit::metre: return C3DE_UNIT_M;
    case LengthUnit::millimetre: return C3DE_UNIT_MM;
    case LengthUnit::centimetre: return C3DE_UNIT_CM;
  }
  return C3DE_UNIT_UNKNOWN;
}

void store(PluginContext &plugin, geometry::LoadedMesh mesh, c3de_handle *out) {
  const Handle handle = plugin.services().meshes->add(std::move(mesh));
  {
    const std::lock_guard lock(plugin.meshMutex);
    plugin.meshes.insert(handle.bits());
  }
  writeHandle(out, handle);
}

std::shared_ptr<const scene::StoredMesh> find(PluginContext &plugin, c3de_handle mesh) {
  auto found = plugin.services().meshes->find(handleOf(mesh));
  if (!found) throw Refusal(C3DE_E_STALE, fmt::format("there is no mesh of handle {}", textOf(mesh)));
  return found;
}

c3de_status C3DE_CALL load(void *ctx, c3de_str path, std::uint32_t unit, const c3de_progress *progress,
                           c3de_handle *out) noexcept {
  return serve(ctx, "mesh.load", [&](PluginContext &plugin) {
    requireNonNull(out, "out")->v = 0;
    const std::string name = textOf(path, "path");
    if (name.empty()) throw Refusal(C3DE_E_ARG, "path is empty");
    const ProgressFn told = progressOf(progress);
    const std::optional<LengthUnit> lengthUnit = unitOf(unit);
    const std::filesystem::path file(std::u8string(name.begin(), name.end()));
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error)) throw Refusal(C3DE_E_IO, name + ": there is no such file");
    const geometry::MeshFormats *formats = plugin.services().meshFormats;
    store(plugin,
          orRefuse(formats ? formats->load(file, lengthUnit, told) : geometry::loadMesh(file, lengthUnit, told)), out);
  });
}

c3de_status C3DE_CALL create(void *ctx, c3de_view positions, c3de_view triangles, c3de_handle *out) noexcept {
  return serve(ctx, "mesh.create", [&](PluginContext &plugin) {
    requireNonNull(out, "out")->v = 0;
    geometry::TriangleMesh mesh;
    mesh.vertices = positionsOf(positions, "positions");
    mesh.triangles = trianglesOf(triangles, "triangles", mesh.vertices.size());
    store(plugin, orRefuse(geometry::buildMesh(std::move(mesh), LengthUnit::millimetre)), out);
  });
}

c3de_status C3DE_CALL release(void *ctx, c3de_handle mesh) noexcept {
  return serve(ctx, "mesh.release", [&](PluginContext &plugin) {
    (void)find(plugin, mesh);
    {
      const std::lock_guard lock(plugin.meshMutex);
      if (plugin.meshes.erase(mesh.v) == 0)
        throw Refusal(C3DE_E_STATE,
                      fmt::format("the mesh of handle {} was not made by plugin {}", textOf(mesh), plugin.id()));
    }
    plugin.services().meshes->remove(handleOf(mesh));
  });
}

c3de_status C3DE_CALL info(void *ctx, c3de_handle mesh, c3de_mesh_info *out) noexcept {
  return serve(ctx, "mesh.info", [&](PluginContext &plugin) {
    const auto stored = find(plugin, mesh);
    const geometry::MeshReport &report = stored->loaded.report;
    c3de_mesh_info info{};
    info.unit = abiUnit(report.unit);
    info.vertices = report.vertices;
    info.triangles = report.triangles;
    info.components = report.components;
    info.closed = report.closed ? 1u : 0u;
    info.manifold = report.manifold ? 1u : 0u;
    info.oriented = report.oriented ? 1u : 0u;
    info.repaired = report.repairs.empty() ? 0u : 1u;
    info.volume_mm3 = report.volume_mm3;
    for (std::size_t k = 0; k < 3; ++k) {
      info.min_mm[k] = report.box.min[k];
      info.max_mm[k] = report.box.max[k];
    }
    writeStruct(out, info, "out");
  });
}

c3de_status C3DE_CALL report(void *ctx, c3de_handle mesh, c3de_sink text) noexcept {
  return serve(ctx, "mesh.report", [&](PluginContext &plugin) {
    requireNonNull(text.put, "sink");
    const std::string lines = find(plugin, mesh)->loaded.report.text();
    return text.put(text.self, lines.data(), lines.size());
  });
}

c3de_status C3DE_CALL positions(void *ctx, c3de_handle mesh, c3de_view *out) noexcept {
  return serve(ctx, "mesh.positions", [&](PluginContext &plugin) {
    requireNonNull(out, "out");
    const auto &vertices = find(plugin, mesh)->loaded.mesh.vertices;
    *out = {vertices.data(), vertices.size(), 3, C3DE_F64, sizeof(Vec3)};
  });
}

c3de_status C3DE_CALL triangles(void *ctx, c3de_handle mesh, c3de_view *out) noexcept {
  static_assert(sizeof(Triangle) == 3 * sizeof(std::uint32_t));
  return serve(ctx, "mesh.triangles", [&](PluginContext &plugin) {
    requireNonNull(out, "out");
    const auto &rows = find(plugin, mesh)->loaded.mesh.triangles;
    *out = {rows.data(), rows.size(), 3, C3DE_U32, sizeof(Triangle)};
  });
}

c3de_status C3DE_CALL windingNumbers(void *ctx, c3de_handle mesh, c3de_view points, c3de_mview out) noexcept {
  return serve(ctx, "mesh.winding_numbers", [&](PluginContext &plugin) {
    const auto stored = find(plugin, mesh);
    const PointRows in(points, "points_mm");
    const RowLayout rows = outputLayoutOf(out, "out", points);
    const geometry::WindingNumber &winding = stored->windingNumber();
    auto *bytes = static_cast<unsigned char *>(out.data);
    for (std::size_t i = 0; i < in.rows().size(); ++i) {
      const double value = winding.at(in.rows()[i]);
      std::memcpy(bytes + i * rows.stride, &value, sizeof value);
    }
  });
}

c3de_status C3DE_CALL checkFillable(void *ctx, c3de_handle mesh) noexcept {
  return serve(ctx, "mesh.check_fillable", [&](PluginContext &plugin) {
    const auto stored = find(plugin, mesh);
    const auto checked = geometry::checkFillable(stored->loaded.mesh, stored->loaded.report);
    if (!checked) throw Refusal(C3DE_E_FORMAT, checked.error().message);
  });
}

}  // namespace

c3de_mesh_v1 makeMeshTable(PluginContext *plugin) {
  return {sizeof(c3de_mesh_v1), kServiceRevision, plugin,          &load,         &create, &release, &info, &report,
          &positions,           &triangles,       &windingNumbers, &checkFillable};
}

}  // namespace c3de::plugin_host
