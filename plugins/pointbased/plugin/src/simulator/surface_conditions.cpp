// SPDX-License-Identifier: Apache-2.0
#include "simulator/surface_conditions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "base/placed_mesh.h"

namespace pointbased {

using sdk::Error;

namespace {

constexpr double kSupportSampling = 0.25, kLoadSampling = 0.5;  // spacings; loads as those of a scene
constexpr double kOffSurface = 1e-3;  // of the size of a body: a patch farther outside of it is not on its surface
constexpr std::uint64_t kMaxNumber = 1'000'000'000;

Vec3 areaVector(const SurfacePatch &patch, std::size_t triangle) {
  const auto &[a, b, c] = patch.triangles[triangle];
  return 0.5 * (patch.positions[b] - patch.positions[a]).cross(patch.positions[c] - patch.positions[a]);
}

/// Barycentric coordinates of a point in the plane of a triangle.
Vec3 weightsIn(const SurfacePatch &patch, std::size_t triangle, const Vec3 &x) {
  const auto &[a, b, c] = patch.triangles[triangle];
  const Vec3 n = 2.0 * areaVector(patch, triangle);
  const double square = n.squaredNorm();
  if (!(square > 0.0)) return Vec3::Constant(1.0 / 3.0);
  const Vec3 &A = patch.positions[a], &B = patch.positions[b], &C = patch.positions[c];
  const double u = n.dot((C - B).cross(x - B)) / square, v = n.dot((A - C).cross(x - C)) / square;
  return {u, v, 1.0 - u - v};
}

std::vector<Vec3> cornerNormalsOf(const SurfacePatch &patch) {
  std::vector<Vec3> out(patch.positions.size(), Vec3::Zero());
  for (std::size_t t = 0; t < patch.triangles.size(); ++t)
    for (const std::uint32_t corner : patch.triangles[t]) out[corner] += areaVector(patch, t);
  for (Vec3 &n : out) n = n.squaredNorm() > 0.0 ? Vec3(n.normalized()) : Vec3(Vec3::UnitZ());
  return out;
}

std::set<std::array<double, 3>> centroidsOf(const SurfacePatch &patch) {
  std::set<std::array<double, 3>> out;
  for (const auto &[a, b, c] : patch.triangles) {
    const Vec3 sum = patch.positions[a] + patch.positions[b] + patch.positions[c];
    out.insert({sum[0], sum[1], sum[2]});
  }
  return out;
}

}  // namespace

double SurfaceConditions::now() const { return simulator_.quasiStatic() ? simulator_.loadFactor() : simulator_.time(); }

double SurfaceConditions::progressOf(const Live &live) const {
  // A quasi-static solution multiplies external forces by the load factor itself.
  if (simulator_.quasiStatic() && !live.what.isSupport()) return 1.0;
  LiveSupport timed;
  timed.start = live.start.time;
  timed.ramp = live.what.ramp;
  return timed.progressAt(now(), simulator_.quasiStatic());
}

Load SurfaceConditions::presentLoad(const Live &live) const {
  const double s = progressOf(live);
  Load load;
  load.force = live.start.vector + s * (live.what.vector - live.start.vector);
  load.pressure = live.start.pressure + s * (live.what.pressure - live.start.pressure);
  return load;
}

std::vector<Vec3> SurfaceConditions::displacementsOf(const Live &live) const {
  const Body &body = *simulator_.body(live.body);
  std::vector<Vec3> out(live.corners.count());
  interpolateDisplacements(live.corners, body.rest().positions, body.state().displacements, out, serialFor());
  return out;
}

// A renewed reference has the same phyxels, so what was bound before stays bound.
void SurfaceConditions::bind(Live &live) const {
  const Body &body = *simulator_.body(live.body);
  const RestState &rest = body.rest();
  live.rest = body.sharedRest();
  if (!rest.referenceShift.empty()) return;
  const SurfacePatch &patch = live.what.patch;
  Surface surface;
  for (const Vec3 &x : patch.positions) surface.positions.push_back(x - rest.origin);
  for (const auto &t : patch.triangles) surface.triangles.push_back({t[0], t[1], t[2]});
  const double sampling = live.what.isSupport() ? kSupportSampling : kLoadSampling;
  const SurfacePoints samples = sampleSurface(surface, sampling * rest.spacing, EverywhereRegion{});
  live.corners = rest.bind(surface.positions, cornerNormalsOf(patch));
  live.start.displacements.resize(patch.positions.size(), Vec3::Zero());
  live.warning.clear();
  const std::span<const std::uint8_t> held = body.heldMask();
  if (live.what.isSupport()) {
    std::vector<Vec3> displacements(samples.count(), Vec3::Zero());
    for (std::size_t p = 0; p < samples.count(); ++p) {
      const Index t = samples.triangles[p];
      const Vec3 weights = weightsIn(patch, t, samples.positions[p] + rest.origin);
      for (int k = 0; k < 3; ++k)
        displacements[p] += weights[k] * live.start.displacements[patch.triangles[t][static_cast<std::size_t>(k)]];
    }
    live.support = liveSupport(rest, samples.positions, samples.normals, samples.areas, displacements, held);
    if (live.support.part.areas.empty()) live.warning = "no effect: a support of the scene holds all of it";
    return;
  }
  live.part = LoadedPart();
  live.part.points = rest.bind(samples.positions, samples.normals);
  for (const double area : samples.areas) live.part.area += area;
  for (std::size_t p = 0; p < samples.count(); ++p) {
    live.part.areaVectors.push_back(samples.areas[p] * samples.normals[p]);
    live.part.shares.push_back(samples.areas[p] / live.part.area);
  }
  const std::vector<Index> &moved = live.part.points.phyxels.indices;
  if (std::all_of(moved.begin(), moved.end(), [&](Index i) { return held[i] != 0; }))
    live.warning = "no effect: it acts on fixed points only";
}

void SurfaceConditions::checkPlace(const SurfaceCondition &condition) const {
  const BodyRecord &record = *table_.body(table_.bodyNamed(condition.body));
  const PlacedMesh &mesh = *record.surface;
  const Vec3 margin = Vec3::Constant(kOffSurface * (mesh.max - mesh.min).norm());
  for (const Vec3 &x : condition.patch.positions)
    if (((x - mesh.min + margin).array() < 0.0).any() || ((mesh.max + margin - x).array() < 0.0).any())
      throw Error(C3DE_E_ARG, "'" + condition.name + "': the selection is not on body '" + record.name + "'");
}

void SurfaceConditions::checkOverlap(const SurfaceCondition &condition, std::uint64_t number) const {
  if (!condition.isSupport()) return;
  const auto own = centroidsOf(condition.patch);
  for (const auto &[other, live] : all_) {
    const bool moves = condition.kind == ConditionKind::displace || live.what.kind == ConditionKind::displace;
    if (other == number || !live.what.isSupport() || !moves || live.what.body != condition.body) continue;
    const auto others = centroidsOf(live.what.patch);
    const auto common = std::count_if(own.begin(), own.end(), [&](const auto &x) { return others.contains(x); });
    if (common > 0)
      throw Error(C3DE_E_ARG, "'" + condition.name + "' and '" + live.what.name + "' both prescribe where " +
                                  std::to_string(common) + " of " + std::to_string(own.size()) +
                                  " triangles move; accepted: supports without common surface");
  }
}

void SurfaceConditions::set(ChangeAccess, std::uint64_t &number, const std::optional<SurfaceCondition> &condition) {
  update();
  if (number == 0) number = lastNumber_ + 1;
  if (number > kMaxNumber)
    throw Error(C3DE_E_ARG, "the number of a support or load is " + std::to_string(number) + "; accepted: up to " +
                                std::to_string(kMaxNumber));
  const auto before = all_.find(number);
  if (!condition) {
    lastNumber_ = std::max(lastNumber_, number);
    if (before == all_.end()) return;
    const std::uint64_t body = before->second.body;
    all_.erase(before);
    applySupports(body);
    simulator_.stepper().repeatLastIncrement();
    return;
  }
  if (const std::string problem = problemOf(*condition); !problem.empty())
    throw Error(C3DE_E_ARG, "'" + condition->name + "': " + problem);
  checkPlace(*condition);
  checkOverlap(*condition, number);
  Live live{*condition, {}};
  live.body = table_.bodyNamed(condition->body);
  const Body &body = *simulator_.body(live.body);
  if (body.isStatic())
    throw Error(C3DE_E_STATE, "body '" + textOf(condition->body) + "' is rigid and fixed, so nothing can move it");
  if (condition->isSupport() && body.rigid())
    throw Error(C3DE_E_STATE, "body '" + textOf(condition->body) + "' is rigid, so a part of it cannot be held");
  live.start.time = now();
  const bool continues = before != all_.end() && before->second.what.kind == condition->kind &&
                         before->second.body == live.body &&
                         before->second.what.patch.positions == condition->patch.positions;
  if (continues && condition->isSupport()) {
    const Live &old = before->second;
    live.start = old.start;
    live.start.time = now();
    live.start.vector = old.support.displacementAt(progressOf(old));
    if (condition->kind == ConditionKind::fix && condition->atRest == old.what.atRest) live.start = old.start;
  } else if (continues) {
    const Load load = presentLoad(before->second);
    live.start.vector = load.force;
    live.start.pressure = load.pressure;
  } else if (condition->isSupport()) {
    bind(live);
    live.start.displacements = displacementsOf(live);
  }
  bind(live);
  lastNumber_ = std::max(lastNumber_, number);
  const std::uint64_t bodyBefore = before == all_.end() ? 0 : before->second.body;
  const std::uint64_t bodyNow = live.body;
  all_.insert_or_assign(number, std::move(live));
  applySupports(bodyNow);
  if (bodyBefore != 0 && bodyBefore != bodyNow) applySupports(bodyBefore);
  simulator_.stepper().repeatLastIncrement();
}

void SurfaceConditions::applySupports(std::uint64_t id) {
  const Body *body = simulator_.body(id);
  if (!body) return;
  std::vector<LiveSupport> supports;
  for (auto &[number, live] : all_) {
    if (live.body != id || !live.what.isSupport() || body->rigid()) continue;
    live.support.from = live.start.vector;
    live.support.to = live.what.kind == ConditionKind::displace ? live.what.vector : Vec3(Vec3::Zero());
    live.support.returns = live.what.kind == ConditionKind::fix && live.what.atRest;
    live.support.start = live.start.time;
    live.support.ramp = live.what.ramp;
    supports.push_back(live.support);
  }
  if (!supports.empty() || !body->liveSupports().empty()) simulator_.world().setLiveSupports(id, std::move(supports));
}

void SurfaceConditions::update() {
  if (all_.empty()) {
    resets_ = world_.resets;
    return;
  }
  const bool hasReset = resets_ != world_.resets;
  resets_ = world_.resets;
  std::set<std::uint64_t> changed;
  for (auto one = all_.begin(); one != all_.end();) {
    Live &live = one->second;
    std::uint64_t body = 0;
    for (const auto &[id, record] : table_.bodies())
      if (record.identity() == live.what.body) body = id;
    if (body == 0) {
      one = all_.erase(one);
      continue;
    }
    const bool isRebound = live.body != body || live.rest != simulator_.body(body)->sharedRest();
    if (hasReset) live.start = {};
    live.body = body;
    if (hasReset || isRebound) {
      bind(live);
      changed.insert(body);
    }
    ++one;
  }
  for (const std::uint64_t body : changed) applySupports(body);
}

bool SurfaceConditions::loads(std::uint64_t body) const {
  return std::any_of(all_.begin(), all_.end(),
                     [body](const auto &entry) { return entry.second.body == body && !entry.second.what.isSupport(); });
}

void SurfaceConditions::addForces(std::uint64_t id, std::vector<Vec3> &forces) const {
  if (!loads(id)) return;
  const Body &body = *simulator_.body(id);
  if (body.isStatic()) return;
  forces.resize(body.rest().phyxelCount(), Vec3::Zero());
  for (const auto &[number, live] : all_)
    if (live.body == id && !live.what.isSupport())
      addLoadForces(presentLoad(live), live.part, 1.0, body.state().displacements, forces);
}

void SurfaceConditions::clear() { all_.clear(); }

std::vector<ConditionSnapshot> SurfaceConditions::snapshots() const {
  std::vector<ConditionSnapshot> out;
  std::map<std::uint64_t, std::vector<Reaction>> reactions;
  std::map<std::uint64_t, std::size_t> next;  // of the supports of a body
  for (const auto &[number, live] : all_) {
    const Body *body = simulator_.body(live.body);
    if (!body) continue;
    ConditionSnapshot one{number, live.what, live.body, areaOf(live.what.patch), Vec3::Zero(), {}, live.warning};
    if (live.what.isSupport() && !body->rigid()) {
      auto [found, isNew] = reactions.try_emplace(live.body);
      if (isNew) found->second = simulator_.diagnostics().reactions(live.body);
      const std::size_t at = body->rest().conditions.fixes.size() + next[live.body]++;
      if (at < found->second.size()) one.force = found->second[at].force;
    } else if (!live.what.isSupport()) {
      std::vector<Vec3> forces(body->rest().phyxelCount(), Vec3::Zero());
      addLoadForces(presentLoad(live), live.part, simulator_.quasiStatic() ? simulator_.loadFactor() : 1.0,
                    body->state().displacements, forces);
      for (const Vec3 &force : forces) one.force += force;
    }
    one.positions = displacementsOf(live);
    for (std::size_t p = 0; p < one.positions.size(); ++p) one.positions[p] += live.what.patch.positions[p];
    out.push_back(std::move(one));
  }
  return out;
}

std::vector<ReportedCondition> SurfaceConditions::reported() const {
  std::vector<ReportedCondition> out;
  for (const ConditionSnapshot &one : snapshots())
    out.push_back({one.condition.name, std::string(nameOf(one.condition.kind)), textOf(one.condition.body), one.area,
                   one.force, one.condition.vector, one.condition.pressure, one.warning});
  return out;
}

std::vector<SavedCondition> SurfaceConditions::saved() const {
  std::vector<SavedCondition> out;
  for (const auto &[number, live] : all_) out.push_back({number, live.what, live.start});
  return out;
}

void SurfaceConditions::restore(const std::vector<SavedCondition> &saved) {
  for (const SavedCondition &one : saved) {
    (void)table_.bodyNamed(one.condition.body);
    if (const std::string problem = problemOf(one.condition); !problem.empty()) throw Error(C3DE_E_FORMAT, problem);
    checkPlace(one.condition);
    if (one.start.displacements.size() > one.condition.patch.positions.size())
      throw Error(C3DE_E_FORMAT, "a support of the state has more displacements than points");
  }
  std::set<std::uint64_t> bodies;
  for (const auto &[number, live] : all_) bodies.insert(live.body);
  all_.clear();
  for (const SavedCondition &one : saved) {
    Live live{one.condition, one.start};
    live.body = table_.bodyNamed(one.condition.body);
    bind(live);
    bodies.insert(live.body);
    lastNumber_ = std::max(lastNumber_, one.number);
    all_.insert_or_assign(one.number, std::move(live));
  }
  resets_ = world_.resets;
  for (const std::uint64_t body : bodies) applySupports(body);
}

}  // namespace pointbased
