// SPDX-License-Identifier: Apache-2.0
#include "loading/body_loader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "c3de/abi/iface/parameter_ids.h"
#include "c3de/core/log.h"
#include "c3de/core/text.h"
#include "c3de/render/renderer.h"
#include "c3de/scene/simulation.h"
#include "c3de/session/scene_to_abi.h"

namespace c3de::session {
namespace {

// Reading is a small share of the time to build a body.
constexpr double kReadingShare = 0.1;

/// Keeps a mesh in the store for the duration of a call.
class MeshLease {
 public:
  MeshLease(scene::MeshStore &store, geometry::LoadedMesh mesh) : store_(store), handle_(store.add(std::move(mesh))) {}
  ~MeshLease() { store_.remove(handle_); }
  MeshLease(const MeshLease &) = delete;
  MeshLease &operator=(const MeshLease &) = delete;
  [[nodiscard]] c3de_handle abi() const { return {handle_.bits()}; }

 private:
  scene::MeshStore &store_;
  Handle handle_;
};

/// The common part of bodies and obstacles; it points into its arguments.
template <class Described>
Described describedAs(const std::string &name, const MeshLease &mesh, const c3de_sim_placement &placement,
                      const std::vector<c3de_param_value> &params) {
  Described abi{};
  abi.size = sizeof abi;
  abi.params_stride = sizeof(c3de_param_value);
  abi.name = c3de::toAbi(name);
  abi.mesh = mesh.abi();
  abi.placement = &placement;
  abi.params = params.data();
  abi.params_n = params.size();
  return abi;
}

/// A body with the voxels of its tissues, and the values of its parts.
struct PlacedBody {
  scene::SceneBody body;
  std::vector<std::vector<ParameterValue>> parts;
};

/// Parts without a voxel are omitted.
PlacedBody placed(const scene::SceneBody &body, const FittedBody &fitted, const BodyGeometry &geometry) {
  PlacedBody out{body, fitted.parts};
  for (std::size_t k = geometry.tissues.size(); k-- > 0;) {
    out.body.parts[k].region.voxels = geometry.tissues[k];
    if (geometry.tissues[k]) continue;
    out.body.parts.erase(out.body.parts.begin() + static_cast<std::ptrdiff_t>(k));
    out.parts.erase(out.parts.begin() + static_cast<std::ptrdiff_t>(k));
  }
  // Where the whole body is rigid, its rigid tissue needs no separate entry.
  if (!scene::trueOf(body.params, C3DE_PARAM_ID_RIGID)) out.body.rigidTissue = geometry.rigid;
  return out;
}

/// Whether its point count is a share of that of the body that it was cut from.
bool sharesCount(const scene::SceneBody &body) {
  return body.volume.piece != 0 && std::none_of(body.params.begin(), body.params.end(), [](const auto &value) {
           return value.isPieceOverride && value.value.id == C3DE_PARAM_ID_COUNT;
         });
}

/// Records and logs the notices about a body to be built.
void note(const scene::SceneBody &body, BodyGeometry &geometry, Prepared &prepared) {
  prepared.took += geometry.took;
  if (body.mesh.empty()) {
    prepared.coverage.push_back(geometry.coverage);
    prepared.coverage.back().body = body.name;
    if (const std::string text = sentenceOf(prepared.coverage.back()); !text.empty()) log(LogLevel::warn, text);
  }
  if (geometry.tissueVoxels) prepared.tissues.push_back(std::move(*geometry.tissueVoxels));
}

}  // namespace

Expected<NamedHandles> BodyLoader::add(Prepared &prepared) {
  const scene::SceneFile &scene = scene_.scene();
  const std::size_t count = scene.obstacles.size() + scene.bodies.size();
  NamedHandles handles;
  for (std::size_t i = 0; i < scene.obstacles.size(); ++i) {
    const std::string &name = scene.obstacles[i].name;
    PartProgress progress(progress_, name, i, count);
    const auto added = addObstacle(i, progress);
    if (!added) return tl::unexpected(added.error());
    handles[name] = *added;
  }
  const double before =
      static_cast<double>(scene.obstacles.size()) / static_cast<double>(std::max<std::size_t>(count, 1));
  const auto ready =
      geometries_.prepare([&](double, const std::string &what) { return !progress_ || progress_(before, what); });
  if (!ready) return tl::unexpected(ready.error());
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const scene::SceneBody &body = scene.bodies[i];
    PartProgress progress(progress_, body.name, scene.obstacles.size() + i, count);
    auto geometry = geometries_.build(i, [&](double fraction, const std::string &what) {
      return progress.update(kReadingShare * std::max(fraction, 0.0), what);
    });
    if (!geometry) return tl::unexpected(geometry.error());
    sources_.reportNotices(body.volume.file);
    note(body, *geometry, prepared);
    const ScopedTimer building(prepared.took.bodies_s);
    const c3de_handle rest =
        body.volume.piece != 0 ? handles.at(scene.bodies[i - body.volume.piece].name) : c3de_handle{};
    const auto added = addBody(i, std::move(*geometry), rest, progress);
    if (!added) return tl::unexpected(added.error());
    handles[body.name] = *added;
  }
  return handles;
}

Expected<c3de_handle> BodyLoader::addObstacle(std::size_t index, PartProgress &progress) const {
  const scene::SceneObstacle &obstacle = scene_.scene().obstacles[index];
  const auto unit = formats_.unitOf(obstacle.mesh, obstacle.meshUnit);
  if (!unit) return failInScene(unit.error(), scene_.scene(), obstacle.line);
  auto mesh = formats_.load(obstacle.mesh, *unit,
                            [&](double fraction, const std::string &what) { return progress.update(fraction, what); });
  if (!mesh) return failInScene(mesh.error(), scene_.scene(), obstacle.line);
  const MeshLease lease(lent_, std::move(*mesh));
  const std::vector<c3de_param_value> params = toAbi(scene_.fitted().obstacles[index]);
  const c3de_sim_placement placement = toAbi(obstacle.placement);
  auto abi = describedAs<c3de_sim_obstacle>(obstacle.name, lease, placement, params);
  c3de_sim_motion motion{};
  if (obstacle.motion) {
    motion = toAbi(*obstacle.motion);
    abi.motion = &motion;
  }
  c3de_handle added{};
  const auto add = [&] { return scene_.table()->add_obstacle(scene_.simulator(), &abi, &added); };
  if (const c3de_status code = progress.call(scene_.owner(), "adding an obstacle", add); code < 0)
    return tl::unexpected(scene_.failure(code, "adding obstacle '" + obstacle.name + "'", obstacle.line));
  return added;
}

Expected<c3de_handle> BodyLoader::addBody(std::size_t index, BodyGeometry geometry, c3de_handle rest,
                                          PartProgress &progress) const {
  const scene::SceneBody &body = scene_.scene().bodies[index];
  const FittedBody &fitted = scene_.fitted().bodies[index];
  const MeshLease lease(lent_, std::move(geometry.skin));
  std::vector<ParameterValue> values = fitted.values;
  if (sharesCount(body)) sampleAsRest(rest, geometry.volume_mm3, values);
  const std::vector<c3de_param_value> params = toAbi(values);
  const c3de_sim_grid grid = toAbi(geometry.fill.geometry);
  const c3de_sim_fill fill{sizeof(c3de_sim_fill), 0, &grid, geometry.fill.values.data()};
  const c3de_sim_placement placement = toAbi(body.placement);
  auto abi = describedAs<c3de_sim_body>(body.name, lease, placement, params);
  if (body.mesh.empty()) abi.fill = &fill;
  const render::Colour colour = render::displayColour(geometry.colour.value_or(std::array<float, 3>{}));
  if (geometry.colour) abi.colour = colour.data();
  abi.progress = progress.abi();
  const PlacedBody whole = placed(body, fitted, geometry);
  const BodyTables tables(scene_.scene(), whole.body, whole.parts);
  tables.fill(abi);
  c3de_handle added{};
  const auto add = [&] { return scene_.table()->add_body(scene_.simulator(), &abi, &added); };
  if (const c3de_status code = progress.call(scene_.owner(), "building a body", add); code < 0)
    return tl::unexpected(scene_.failure(code, "building body '" + body.name + "'", body.line, &whole.body));
  reportThinTissue(added, body, geometry.thickness_mm);
  return added;
}

/// Piece whose count is a share of its body's count: uses the spacing of the rest. A share by volume is right only for
/// large pieces, because points at skins represent little tissue. Small pieces have four spacings along the edge of a
/// cube of their volume.
void BodyLoader::sampleAsRest(c3de_handle rest, double volume_mm3, std::vector<ParameterValue> &values) const {
  const auto count = std::find_if(values.begin(), values.end(), [](const ParameterValue &value) {
    return value.id == C3DE_PARAM_ID_COUNT && value.num > 0.0;
  });
  c3de_sim_body_info info{};
  info.size = sizeof info;
  if (count == values.end() || scene_.table()->body_info(scene_.simulator(), rest, &info) < 0 ||
      !(info.spacing_m > 0.0))
    return;
  count->id = C3DE_PARAM_ID_SPACING;
  count->type = C3DE_PARAM_F64;
  count->num = std::min(info.spacing_m, std::cbrt(volume_mm3) / (4.0 * scene::kMillimetresPerMetre));
}

/// Logs the tissues that are finer than the cells of their body.
void BodyLoader::reportThinTissue(c3de_handle added, const scene::SceneBody &body,
                                  const std::vector<double> &thickness_mm) const {
  c3de_sim_body_info info{};
  info.size = sizeof info;
  if (thickness_mm.empty() || scene_.table()->body_info(scene_.simulator(), added, &info) < 0) return;
  const double spacing_mm = info.spacing_m * scene::kMillimetresPerMetre;
  constexpr std::size_t kMost = 6;
  std::string names;
  std::size_t count = 0;
  for (std::size_t i = 0; i < thickness_mm.size(); ++i) {
    const scene::SceneTissue &tissue = body.volume.tissues[i];
    const double thickness = body.placement.scale * thickness_mm[i];
    if (tissue.isRigid || tissue.isEmpty || !(thickness > 0.0 && thickness < spacing_mm)) continue;
    if (++count > kMost) continue;
    names += (names.empty() ? "" : ", ") + tissue.label;
  }
  if (count == 0) return;
  if (count > kMost) names += " and " + std::to_string(count - kMost) + " more";
  log(LogLevel::info, "body '" + body.name + "': thinner than the spacing of " +
                          formatNumber(std::round(10.0 * spacing_mm) / 10.0) + " mm: " + names +
                          "; their cells mix such tissue with its surroundings by volume, and both move together");
}

}  // namespace c3de::session
