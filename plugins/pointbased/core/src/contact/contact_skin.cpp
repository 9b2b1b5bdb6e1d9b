// SPDX-License-Identifier: Apache-2.0
#include "contact/contact_skin.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>

#include "discretisation/interpolation_at.h"

namespace pointbased::detail {
namespace {

using Triangle = std::array<Index, 3>;

constexpr Index kPatch = 6;        // triangles in one
constexpr int kMostRounds = 8;     // halvings of an edge
constexpr double kCrushed = 0.02;  // of a volume

std::pair<Index, Index> ordered(Index a, Index b) { return a < b ? std::pair(a, b) : std::pair(b, a); }

// Halves the edges that are too long, in both triangles that share one, so that no gap opens.
void divideLongEdges(std::vector<Vec3> &points, std::vector<Triangle> &triangles, double longest) {
  for (int round = 0; round < kMostRounds; ++round) {
    std::map<std::pair<Index, Index>, Index> middles;
    const auto isLong = [&](Index a, Index b) { return (points[a] - points[b]).norm() > longest * (1.0 + 1e-9); };
    for (const Triangle &t : triangles)
      for (std::size_t k = 0; k < 3; ++k)
        if (isLong(t[k], t[(k + 1) % 3])) middles.try_emplace(ordered(t[k], t[(k + 1) % 3]), kNoTriangle);
    if (middles.empty()) return;
    for (auto &[edge, middle] : middles) {
      middle = static_cast<Index>(points.size());
      points.emplace_back(0.5 * (points[edge.first] + points[edge.second]));
    }
    std::vector<Triangle> divided;
    for (const Triangle &t : triangles) {
      std::array<Index, 3> m{};  // in the middle of the edge from corner k on
      int halved = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto found = middles.find(ordered(t[k], t[(k + 1) % 3]));
        m[k] = found == middles.end() ? kNoTriangle : found->second;
        halved += m[k] != kNoTriangle ? 1 : 0;
      }
      if (halved == 3) {
        divided.push_back({m[0], m[1], m[2]});
        for (std::size_t k = 0; k < 3; ++k) divided.push_back({t[k], m[k], m[(k + 2) % 3]});
        continue;
      }
      if (halved == 0) {
        divided.push_back(t);
        continue;
      }
      // Turned so that the first edge is halved, and the last one is not.
      std::size_t k = 0;
      while (m[k] == kNoTriangle || m[(k + 2) % 3] != kNoTriangle) ++k;
      const Index a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3], ab = m[k], bc = m[(k + 1) % 3];
      if (halved == 1) {
        divided.push_back({a, ab, c});
        divided.push_back({ab, b, c});
        continue;
      }
      divided.push_back({ab, b, bc});
      // The quadrangle that is left, along its shorter diagonal.
      if ((points[a] - points[bc]).squaredNorm() <= (points[ab] - points[c]).squaredNorm()) {
        divided.push_back({a, ab, bc});
        divided.push_back({a, bc, c});
      } else {
        divided.push_back({a, ab, c});
        divided.push_back({ab, bc, c});
      }
    }
    triangles.swap(divided);
  }
}

// Where a surface has an edge it has a vertex for each normal; those that move alike become one, or the faces beside an
// edge would not know each other.
void weld(const Interpolation &vertices, double size, std::vector<Triangle> &triangles) {
  using Key = std::vector<long long>;
  constexpr double kSame = 1e-6;
  std::map<Key, Index> first;
  std::vector<Index> one(vertices.count());
  for (std::size_t v = 0; v < vertices.count(); ++v) {
    Key key;
    for (int a = 0; a < 3; ++a) key.push_back(std::llround(vertices.positions[v][a] / (kSame * size)));
    std::vector<std::pair<Index, long long>> row;
    for (Index e = vertices.phyxels.offsets[v]; e < vertices.phyxels.offsets[v + 1]; ++e)
      if (const long long weight = std::llround(vertices.weights[e] / kSame); weight != 0)
        row.emplace_back(vertices.phyxels.indices[e], weight);
    std::sort(row.begin(), row.end());
    for (const auto &[phyxel, weight] : row) {
      key.push_back(phyxel);
      key.push_back(weight);
    }
    one[v] = first.try_emplace(std::move(key), static_cast<Index>(v)).first->second;
  }
  for (Triangle &t : triangles)
    for (Index &v : t) v = one[v];
}

std::vector<Vec3> normalsOf(std::span<const Vec3> points, std::span<const Triangle> triangles) {
  std::vector<Vec3> normals(points.size(), Vec3::Zero());
  for (const auto &[a, b, c] : triangles) {
    const Vec3 normal = (points[b] - points[a]).cross(points[c] - points[a]);
    for (const Index v : {a, b, c}) normals[v] += normal;
  }
  for (Vec3 &n : normals) n = n.squaredNorm() > 0.0 ? Vec3(n.normalized()) : Vec3(Vec3::UnitZ());
  return normals;
}

void append(const Interpolation &more, Interpolation &to) {
  const std::size_t had = to.count(), ranked = to.frames.size();
  const bool ranks = !to.rank.empty() || !more.rank.empty();
  const auto shift = static_cast<Index>(to.phyxels.indices.size());
  to.positions.insert(to.positions.end(), more.positions.begin(), more.positions.end());
  to.phyxels.indices.insert(to.phyxels.indices.end(), more.phyxels.indices.begin(), more.phyxels.indices.end());
  for (std::size_t p = 0; p < more.count(); ++p) to.phyxels.offsets.push_back(shift + more.phyxels.offsets[p + 1]);
  to.weights.insert(to.weights.end(), more.weights.begin(), more.weights.end());
  to.gradients.insert(to.gradients.end(), more.gradients.begin(), more.gradients.end());
  if (!ranks) return;
  to.rank.resize(had, 3);
  to.frameOf.resize(had, StencilSet::kNoFrame);
  for (std::size_t p = 0; p < more.count(); ++p) {
    const int rank = rankOf(more, p);
    to.rank.push_back(static_cast<std::uint8_t>(rank));
    to.frameOf.push_back(rank < 3 ? static_cast<Index>(ranked + more.frameOf[p]) : StencilSet::kNoFrame);
  }
  to.frames.insert(to.frames.end(), more.frames.begin(), more.frames.end());
  to.offsets.insert(to.offsets.end(), more.offsets.begin(), more.offsets.end());
}

void findEdges(ContactSkin &skin) {
  std::map<std::pair<Index, Index>, Index> numbers;
  skin.edgesOf.resize(skin.triangles.size());
  for (std::size_t t = 0; t < skin.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const Index a = skin.triangles[t][k], b = skin.triangles[t][(k + 1) % 3];
      const auto [found, isNew] = numbers.try_emplace(ordered(a, b), static_cast<Index>(skin.edges.size()));
      if (isNew) skin.edges.push_back({{a, b}, {static_cast<Index>(t), kNoTriangle}});
      SkinEdge &edge = skin.edges[found->second];
      if (!isNew && edge.triangles[1] == kNoTriangle) edge.triangles[1] = static_cast<Index>(t);
      skin.edgesOf[t][k] = found->second;
    }
}

}  // namespace

std::shared_ptr<const ContactSkin> makeContactSkin(Interpolation vertices, std::vector<Triangle> triangles,
                                                   double longestEdge, const Binder &bind,
                                                   std::span<const float> maxInfluence) {
  auto skin = std::make_shared<ContactSkin>();
  std::vector<Vec3> points = vertices.positions;
  weld(vertices, longestEdge, triangles);
  std::erase_if(triangles, [](const Triangle &t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
  divideLongEdges(points, triangles, longestEdge);
  const std::size_t had = vertices.count();
  skin->vertices = std::move(vertices);
  if (points.size() > had) {
    const std::vector<Vec3> normals = normalsOf(points, triangles);
    append(bind(std::span<const Vec3>(points).subspan(had), std::span<const Vec3>(normals).subspan(had)),
           skin->vertices);
  }
  skin->triangles = std::move(triangles);
  findEdges(*skin);

  std::vector<Index> counts(skin->count(), 0);
  for (const Triangle &t : skin->triangles)
    for (const Index v : t) ++counts[v];
  skin->trianglesOf.offsets.assign(1, 0);
  for (const Index count : counts) skin->trianglesOf.offsets.push_back(skin->trianglesOf.offsets.back() + count);
  skin->trianglesOf.indices.resize(skin->trianglesOf.offsets.back());
  std::vector<Index> next(skin->trianglesOf.offsets.begin(), skin->trianglesOf.offsets.end() - 1);
  for (std::size_t t = 0; t < skin->triangles.size(); ++t) {
    for (const Index v : skin->triangles[t]) skin->trianglesOf.indices[next[v]++] = static_cast<Index>(t);
  }
  const Interpolation &carried = skin->vertices;
  skin->areas.assign(skin->count(), 0.0);
  for (const auto &[a, b, c] : skin->triangles) {
    const std::vector<Vec3> &x = carried.positions;
    const double third = (x[b] - x[a]).cross(x[c] - x[a]).norm() / 6.0;
    for (const Index v : {a, b, c}) skin->areas[v] += third;
  }
  std::vector<std::uint8_t> carries;
  for (std::size_t v = 0; v < carried.count(); ++v) {
    double sum = 0.0, plain = 0.0;
    for (Index e = carried.phyxels.offsets[v]; e < carried.phyxels.offsets[v + 1]; ++e)
      if (const double weight = std::abs(carried.weights[e]); weight != 0.0) {
        if (carried.phyxels.indices[e] >= carries.size()) carries.resize(carried.phyxels.indices[e] + 1, 0);
        carries[carried.phyxels.indices[e]] = 1;
        plain += weight;
        sum += weight / (maxInfluence.empty() ? 1.0 : static_cast<double>(maxInfluence[carried.phyxels.indices[e]]));
      }
    skin->gain = std::max(skin->gain, sum);
    skin->sum = std::max(skin->sum, plain);
  }
  for (std::size_t j = 0; j < carries.size(); ++j)
    if (carries[j] != 0) skin->carriers.push_back(static_cast<Index>(j));
  return skin;
}

PatchTree::PatchTree(const ContactSkin &skin) {
  const std::size_t count = skin.triangles.size();
  std::vector<Vec3> centres(count, Vec3::Zero());
  for (std::size_t t = 0; t < count; ++t)
    for (const Index v : skin.triangles[t]) centres[t] += skin.vertices.positions[v];
  std::vector<Index> order(count);
  std::iota(order.begin(), order.end(), Index{0});
  std::vector<std::uint8_t> hasVertex(skin.count(), 0), hasEdge(skin.edges.size(), 0);
  struct Range {
    Index node, begin, end;
  };
  nodes_.emplace_back();
  std::vector<Range> open{{0, 0, static_cast<Index>(count)}};
  while (!open.empty()) {
    const auto [node, begin, end] = open.back();
    open.pop_back();
    nodes_[node].size = end - begin;
    if (end - begin <= kPatch) {
      nodes_[node].patch = static_cast<Index>(patches_.size());
      Patch &patch = patches_.emplace_back();
      patch.triangles.assign(order.begin() + begin, order.begin() + end);
      for (const Index t : patch.triangles) {
        for (const Index v : skin.triangles[t]) {
          patch.corners.push_back(v);
          if (std::exchange(hasVertex[v], 1) == 0) patch.vertices.push_back(v);
        }
        for (const Index e : skin.edgesOf[t])
          if (std::exchange(hasEdge[e], 1) == 0) patch.edges.push_back(e);
      }
      std::sort(patch.corners.begin(), patch.corners.end());
      patch.corners.erase(std::unique(patch.corners.begin(), patch.corners.end()), patch.corners.end());
      continue;
    }
    SkinBox box;
    for (Index k = begin; k < end; ++k) box.add(centres[order[k]]);
    int axis = 0;
    (box.high - box.low).maxCoeff(&axis);
    const Index middle = begin + (end - begin) / 2;
    std::nth_element(order.begin() + begin, order.begin() + middle, order.begin() + end, [&](Index a, Index b) {
      return centres[a][axis] != centres[b][axis] ? centres[a][axis] < centres[b][axis] : a < b;
    });
    const auto child = static_cast<Index>(nodes_.size());
    nodes_[node].child = child;
    nodes_.emplace_back();
    nodes_.emplace_back();
    open.push_back({child, begin, middle});
    open.push_back({child + 1, middle, end});
  }
  refit(skin.vertices.positions);
  for (Node &node : nodes_) node.rest = node.box;
}

void PatchTree::refit(std::span<const Vec3> positions) {
  for (std::size_t k = nodes_.size(); k-- > 0;) {
    Node &node = nodes_[k];
    node.box = SkinBox();
    if (node.patch != kNone) {
      for (const Index v : patches_[node.patch].corners) node.box.add(positions[v]);
    } else {
      node.box.add(nodes_[node.child].box);
      node.box.add(nodes_[node.child + 1].box);
    }
  }
}

MovingSkin::MovingSkin(std::shared_ptr<const ContactSkin> skin, const Vec3 &origin, double spacing,
                       std::vector<double> spacings)
    : skin_(std::move(skin)), tree_(*skin_), origin_(origin), spacing_(spacing), spacings_(std::move(spacings)),
      positions_(skin_->count()), vertexVelocities_(skin_->count()), seen_(skin_->count(), 0),
      velocitiesSeen_(skin_->count(), 0), motions_(tree_.patches().size()), parts_(motions_.size()),
      slabs_(motions_.size()) {}

void MovingSkin::move(std::span<const Vec3> displacements, std::span<const Vec3> velocities,
                      std::span<const float> maxInfluence, double dt) {
  displacements_ = displacements;
  velocities_ = velocities;
  maxInfluence_ = maxInfluence;
  dt_ = dt;
  goesExactly_ = -1.0;
  ++now_;
  Vec3 mean = Vec3::Zero();
  const std::vector<Index> &carriers = skin_->carriers;
  for (const Index j : carriers) mean += velocities[j];
  mean /= static_cast<double>(std::max<std::size_t>(1, carriers.size()));
  FarthestWay way(maxInfluence_);
  for (const Index j : carriers) way.add(j, velocities[j] - mean);
  goes_ = dt * way.ofVertices(*skin_);
  meanGoes_ = dt * mean;
}

double MovingSkin::goesExactly() {
  if (goesExactly_ >= 0.0) return goesExactly_;
  double squared = 0.0;
  for (Index v = 0; v < skin_->count(); ++v) squared = std::max(squared, (dt_ * velocity(v) - meanGoes_).squaredNorm());
  return goesExactly_ = std::sqrt(squared);
}

double MovingSkin::wentSince(std::span<const Vec3> then, Vec3 &mean) const {
  mean.setZero();
  const std::vector<Index> &carriers = skin_->carriers;
  for (const Index j : carriers) mean += displacements_[j] - then[j];
  mean /= static_cast<double>(std::max<std::size_t>(1, carriers.size()));
  FarthestWay way(maxInfluence_);
  for (const Index j : carriers) way.add(j, displacements_[j] - then[j] - mean);
  return way.ofVertices(*skin_);
}

void MovingSkin::place(Index v) {
  const Interpolation &carried = skin_->vertices;
  const Mat3 F = rankOf(carried, v) < 3 ? gradientAt(carried, v, displacements_) : Mat3(Mat3::Identity());
  positions_[v] = origin_ + carried.positions[v] + displacementAt(carried, v, displacements_, F);
  seen_[v] = now_;
}

void MovingSkin::takeVelocity(Index v) {
  vertexVelocities_[v] = fieldAt(skin_->vertices, v, velocities_);
  velocitiesSeen_[v] = now_;
}

bool MovingSkin::isInverted(Index v) {
  if (invertedSeen_.empty()) invertedSeen_.assign(skin_->count(), 0);
  if (invertedSeen_[v] / 2 != now_) {
    const bool is = !(gradientAt(skin_->vertices, v, displacements_).determinant() > kCrushed);
    invertedSeen_[v] = 2 * now_ + (is ? 1 : 0);
  }
  return invertedSeen_[v] % 2 != 0;
}

const MovingSkin::PatchMotion &MovingSkin::motionOf(Index patch) {
  PatchMotion &motion = motions_[patch];
  if (motion.seen == now_) return motion;
  motion = PatchMotion();
  motion.seen = now_;
  for (const Index v : tree_.patches()[patch].corners) {
    motion.places.add(position(v));
    motion.velocities.add(velocity(v));
  }
  return motion;
}

void MovingSkin::placeVertices() {
  for (Index v = 0; v < skin_->count(); ++v) (void)position(v);
}

void MovingSkin::placeAll() {
  placeVertices();
  if (treeOf_ == now_) return;
  tree_.refit(positions_);
  treeOf_ = now_;
}

Vec3 MovingSkin::faceNormal(Index triangle) {
  const auto &[a, b, c] = skin_->triangles[triangle];
  const Vec3 at = position(a);
  return (position(b) - at).cross(position(c) - at);
}

Vec3 MovingSkin::edgeNormal(Index edge) {
  Vec3 sum = Vec3::Zero();
  for (const Index t : skin_->edges[edge].triangles)
    if (t != kNoTriangle) sum += faceNormal(t).normalized();
  return sum;
}

Vec3 MovingSkin::facing(Index vertex) {
  Vec3 sum = Vec3::Zero();
  for (const Index t : skin_->trianglesOf.row(vertex)) sum += faceNormal(t);
  return sum.normalized();
}

// Weighted by angles: the side on which a point lies whose nearest point is the vertex.
// @source  Baerentzen and Aanaes, Signed distance computation using the angle weighted pseudonormal, 2005
Vec3 MovingSkin::vertexNormal(Index vertex) {
  Vec3 sum = Vec3::Zero();
  for (const Index t : skin_->trianglesOf.row(vertex)) {
    const auto &corners = skin_->triangles[t];
    const auto k = static_cast<std::size_t>(std::find(corners.begin(), corners.end(), vertex) - corners.begin());
    const Vec3 at = position(vertex), ab = position(corners[(k + 1) % 3]) - at,
               ac = position(corners[(k + 2) % 3]) - at;
    const Vec3 normal = ab.cross(ac);
    sum += std::atan2(normal.norm(), ab.dot(ac)) * normal.normalized();
  }
  return sum;
}

bool MovingSkin::isSharp(Index edge, double sine, double rise) {
  const SkinEdge &e = skin_->edges[edge];
  if (e.triangles[1] == kNoTriangle) return true;
  const Vec3 n = faceNormal(e.triangles[0]), m = faceNormal(e.triangles[1]);
  const auto &corners = skin_->triangles[e.triangles[1]];
  const Index opposite = corners[0] + corners[1] + corners[2] - e.ends[0] - e.ends[1];
  const Vec3 &end = position(e.ends[0]);
  if (n.dot(position(opposite) - end) > 0.0) return false;
  const double length = (end - position(e.ends[1])).norm();
  const double least = std::min(sine, rise / std::max(length, 1e-12 * rise));
  return n.cross(m).squaredNorm() > least * least * n.squaredNorm() * m.squaredNorm() || n.dot(m) < 0.0;
}

std::pair<double, double> MovingSkin::extentOf(Index patch, const Vec3 &direction) {
  std::pair<double, double> extent{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const Index v : tree_.patches()[patch].corners) {
    const double along = direction.dot(position(v));
    extent.first = std::min(extent.first, along);
    extent.second = std::max(extent.second, along);
  }
  return extent;
}

const MovingSkin::Slab &MovingSkin::slabOf(Index patch) {
  Slab &slab = slabs_[patch];
  if (slab.seen == now_) return slab;
  slab.seen = now_;
  slab.normal.setZero();
  for (const Index t : tree_.patches()[patch].triangles) slab.normal += faceNormal(t);
  slab.normal.normalize();
  std::tie(slab.low, slab.high) = extentOf(patch, slab.normal);
  return slab;
}

double MovingSkin::distance(Index patch, const Slab &slab) {
  const auto [low, high] = extentOf(patch, slab.normal);
  return std::max(low - slab.high, slab.low - high);
}

const MovingSkin::PatchParts &MovingSkin::partsOf(Index patch, double sine, double rise) {
  PatchParts &parts = parts_[patch];
  if (parts.seen == now_ && parts.rise == rise) return parts;
  parts.seen = now_;
  parts.rise = rise;
  parts.triangles.clear();
  parts.edges.clear();
  for (const Index t : tree_.patches()[patch].triangles) {
    SkinBox &box = parts.triangles.emplace_back();
    for (const Index v : skin_->triangles[t]) box.add(position(v));
  }
  for (const Index e : tree_.patches()[patch].edges) {
    if (!isSharp(e, sine, rise)) continue;
    SkinBox &box = parts.edges.emplace_back(e, SkinBox()).second;
    for (const Index v : skin_->edges[e].ends) box.add(position(v));
  }
  return parts;
}

NearestOnTriangle MovingSkin::nearestOn(Index triangle, const Vec3 &x) {
  const auto &[a, b, c] = skin_->triangles[triangle];
  return nearestOnTriangle(x, position(a), position(b), position(c));
}

Vec3 MovingSkin::placeOn(Index triangle, const Vec3 &weights) {
  const auto &[a, b, c] = skin_->triangles[triangle];
  return weights[0] * position(a) + weights[1] * position(b) + weights[2] * position(c);
}

Vec3 MovingSkin::outwardAt(Index triangle, int feature) {
  if (feature == 0) return faceNormal(triangle);
  const auto k = static_cast<std::size_t>(feature);
  return k < 4 ? edgeNormal(skin_->edgesOf[triangle][k - 1]) : vertexNormal(skin_->triangles[triangle][k - 4]);
}

NearestOnTriangle nearestOnTriangle(const Vec3 &p, const Vec3 &a, const Vec3 &b, const Vec3 &c) {
  NearestOnTriangle out;
  const auto end = [&](double u, double v, double w, int feature) {
    out.weights = {u, v, w};
    out.squared = (p - (u * a + v * b + w * c)).squaredNorm();
    out.feature = feature;
    return out;
  };
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0.0 && d2 <= 0.0) return end(1.0, 0.0, 0.0, 4);
  const Vec3 bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0.0 && d4 <= d3) return end(0.0, 1.0, 0.0, 5);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) {
    const double v = d1 / (d1 - d3);
    return end(1.0 - v, v, 0.0, 1);
  }
  const Vec3 cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0.0 && d5 <= d6) return end(0.0, 0.0, 1.0, 6);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) {
    const double w = d2 / (d2 - d6);
    return end(1.0 - w, 0.0, w, 3);
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return end(0.0, 1.0 - w, w, 2);
  }
  const double sum = va + vb + vc;
  if (!(sum > 0.0)) return end(1.0, 0.0, 0.0, 4);  // no area
  return end(va / sum, vb / sum, vc / sum, 0);
}

NearestOfSegments nearestOfSegments(const Vec3 &a0, const Vec3 &a1, const Vec3 &b0, const Vec3 &b1) {
  const Vec3 along = a1 - a0, other = b1 - b0, between = a0 - b0;
  const double a = along.squaredNorm(), e = other.squaredNorm(), f = other.dot(between);
  const auto clamped = [](double x) { return std::clamp(x, 0.0, 1.0); };
  if (!(a > 0.0)) return {0.0, e > 0.0 ? clamped(f / e) : 0.0};
  const double c = along.dot(between);
  if (!(e > 0.0)) return {clamped(-c / a), 0.0};
  const double b = along.dot(other), denominator = a * e - b * b;
  NearestOfSegments out;
  out.onFirst = denominator > 1e-12 * a * e ? clamped((b * f - c * e) / denominator) : 0.5;
  out.onSecond = (b * out.onFirst + f) / e;
  if (out.onSecond < 0.0 || out.onSecond > 1.0) {
    out.onSecond = clamped(out.onSecond);
    out.onFirst = clamped((b * out.onSecond - c) / a);
  }
  return out;
}

}  // namespace pointbased::detail
