// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/body_states.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <optional>

#include "c3de/abi/draft/iface/point_sets.h"
#include "c3de/core/text.h"
#include "c3de/scene/simulation.h"
#include "c3de/session/simulator_access.h"

namespace c3de::session {
namespace {

using geometry::PointArray;

/// Reads fields of a phyxel or surfel set.
template <class Table>
class SetReader {
 public:
  static Expected<SetReader> open(c3de_object *set, const char *id) {
    const void *table = nullptr;
    if (set == nullptr || set->vt->query(set, toAbi(id), 1, &table) < 0 || table == nullptr)
      return fail(ErrorCode::plugin, std::string("the simulator's set does not answer ") + id);
    return SetReader(set, static_cast<const Table *>(table));
  }
  [[nodiscard]] std::size_t count() const { return static_cast<std::size_t>(table_->count(set_)); }
  /// None: the set does not have the field.
  [[nodiscard]] std::optional<std::vector<double>> field(std::uint32_t field, std::size_t components) const {
    const std::size_t n = count();
    std::vector<double> out(n * components);
    if (n == 0) return out;
    const c3de_mview view{out.data(), n, static_cast<std::uint32_t>(components), C3DE_F64, 0};
    if (table_->read(set_, field, view) < 0) return std::nullopt;
    return out;
  }
  [[nodiscard]] const Table *table() const { return table_; }
  [[nodiscard]] c3de_object *set() const { return set_; }

 private:
  SetReader(c3de_object *set, const Table *table) : set_(set), table_(table) {}
  c3de_object *set_;
  const Table *table_;
};

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

/// VTK has matrices row by row, the fields are column-major.
std::vector<double> rowByRow(const std::vector<double> &matrices) {
  std::vector<double> out(matrices.size());
  for (std::size_t m = 0; m + 9 <= matrices.size(); m += 9)
    for (std::size_t r = 0; r < 3; ++r)
      for (std::size_t c = 0; c < 3; ++c) out[m + 3 * r + c] = matrices[m + 3 * c + r];
  return out;
}

/// Von Mises stress of the Cauchy stress F S Fᵀ / det F; 0 where the point is inverted.
double vonMises(const double *F, const double *S) {
  const auto at = [](const double *m, std::size_t r, std::size_t c) { return m[3 * c + r]; };
  const Vec3 x{F[0], F[1], F[2]}, y{F[3], F[4], F[5]}, z{F[6], F[7], F[8]};
  const double J = dot(x, cross(y, z));
  if (!(J > 0.0)) return 0.0;
  double s[3][3] = {};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t b = 0; b < 3; ++b) s[i][j] += at(F, i, a) * at(S, a, b) * at(F, j, b);
      s[i][j] /= J;
    }
  const auto square = [](double v) { return v * v; };
  return std::sqrt(0.5 * (square(s[0][0] - s[1][1]) + square(s[1][1] - s[2][2]) + square(s[2][2] - s[0][0])) +
                   3.0 * (square(s[0][1]) + square(s[1][2]) + square(s[0][2])));
}

Expected<void> readPhyxels(c3de_object *set, BodyState &body) {
  const auto reader = SetReader<c3de_phyxel_set_v0>::open(set, C3DE_IFACE_PHYXEL_SET_ID);
  if (!reader) return tl::unexpected(reader.error());
  const auto now = reader->field(C3DE_FIELD_POSITION, 3), reference = reader->field(C3DE_FIELD_REFERENCE_POSITION, 3);
  if (!now || !reference)
    return fail(ErrorCode::plugin, "the simulator gives no positions of the phyxels of '" + body.name + "'");
  body.phyxels.points = pointsInMillimetres(*now);
  std::vector<PointArray> &arrays = body.phyxels.arrays;
  arrays.push_back(displacements(*now, *reference));
  const auto add = [&](std::uint32_t field, std::size_t components, const char *name) {
    auto values = reader->field(field, components);
    if (values) arrays.push_back({name, components, components == 9 ? rowByRow(*values) : *values});
    return values;
  };
  (void)add(C3DE_FIELD_VELOCITY, 3, "velocity [m/s]");
  (void)add(C3DE_FIELD_MASS, 1, "mass [kg]");
  (void)add(C3DE_FIELD_VOLUME, 1, "volume [m^3]");
  const auto gradients = add(C3DE_FIELD_GRADIENT, 9, "deformation_gradient [1]");
  (void)add(C3DE_FIELD_STRAIN, 9, "strain_green [1]");
  const auto stresses = add(C3DE_FIELD_STRESS, 9, "stress_pk2 [Pa]");
  if (gradients && stresses) {
    PointArray mises{"stress_vm [Pa]", 1, {}};
    for (std::size_t m = 0; m + 9 <= stresses->size(); m += 9)
      mises.values.push_back(vonMises(gradients->data() + m, stresses->data() + m));
    arrays.push_back(std::move(mises));
  }
  return {};
}

Expected<void> readSkin(c3de_object *set, BodyState &body) {
  const auto reader = SetReader<c3de_surfel_set_v0>::open(set, C3DE_IFACE_SURFEL_SET_ID);
  if (!reader) return tl::unexpected(reader.error());
  const auto now = reader->field(C3DE_FIELD_POSITION, 3), reference = reader->field(C3DE_FIELD_REFERENCE_POSITION, 3);
  if (!now || !reference)
    return fail(ErrorCode::plugin, "the simulator gives no positions of the surface of '" + body.name + "'");
  body.skin.vertices = pointsInMillimetres(*now);
  body.skinArrays.push_back(displacements(*now, *reference));
  const c3de_surfel_set_v0 *table = reader->table();
  if (table->rev < 2 || !C3DE_HAS(c3de_surfel_set_v0, table, triangles)) return {};
  c3de_view view{};
  if (table->triangles(reader->set(), &view) < 0) return {};
  if (view.count > 0 && (view.comps != 3 || view.dtype != C3DE_U32 || view.data == nullptr))
    return fail(ErrorCode::plugin, "the triangles of '" + body.name + "' are not three u32 each");
  const std::size_t stride = view.stride ? static_cast<std::size_t>(view.stride) : sizeof(Triangle);
  body.skin.triangles.resize(static_cast<std::size_t>(view.count));
  for (std::size_t t = 0; t < body.skin.triangles.size(); ++t)
    std::memcpy(body.skin.triangles[t].data(), static_cast<const char *>(view.data) + t * stride, sizeof(Triangle));
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
    body.name = std::string(fromAbi(info.name));
    c3de_object *set = nullptr;
    if (const c3de_status code = (*table)->surfels(simulator, handle, &set); code < 0)
      return refused("the surface of '" + body.name + "'", code);
    const ObjectRef surfels(set);
    if (auto ok = readSkin(surfels.get(), body); !ok) return tl::unexpected(ok.error());
    if (parts == BodyParts::skinAndPhyxels) {
      set = nullptr;
      if (const c3de_status code = (*table)->phyxels(simulator, handle, &set); code < 0)
        return refused("the phyxels of '" + body.name + "'", code);
      const ObjectRef phyxels(set);
      if (auto ok = readPhyxels(phyxels.get(), body); !ok) return tl::unexpected(ok.error());
    }
    bodies.push_back(std::move(body));
  }
  return bodies;
}

}  // namespace c3de::session
