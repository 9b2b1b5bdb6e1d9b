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

// Triangles in one patch (leaf), at most. More: fewer boxes to test, more triangles per pair of patches.
constexpr Index kMaxPatchTriangles = 6;
// Of the rest volume (det F): material compressed to less counts as inverted. Larger: more of it does.
constexpr double kInvertedVolumeRatio = 0.02;

std::vector<Vec3> normalsOf(std::span<const Vec3> points, std::span<const Triangle> triangles) {
  std::vector<Vec3> normals(points.size(), Vec3::Zero());
  for (const auto &[a, b, c] : triangles) {
    const Vec3 normal = (points[b] - points[a]).cross(points[c] - points[a]);
    for (const Index v : {a, b, c}) normals[v] += normal;
  }
  for (Vec3 &n : normals) n = n.squaredNorm() > 0.0 ? Vec3(n.normalized()) : Vec3(Vec3::UnitZ());
  return normals;
}

void findEdges(ContactSkin &skin) {
  struct HalfEdge {
    std::array<Index, 2> ends;
    Index number;  // 3 × triangle + corner
  };
  std::vector<HalfEdge> halfEdges;
  for (std::size_t t = 0; t < skin.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const Index a = skin.triangles[t][k], b = skin.triangles[t][(k + 1) % 3];
      halfEdges.push_back({{std::min(a, b), std::max(a, b)}, static_cast<Index>(halfEdges.size())});
    }
  std::sort(halfEdges.begin(), halfEdges.end(), [](const HalfEdge &a, const HalfEdge &b) {
    return a.ends != b.ends ? a.ends < b.ends : a.number < b.number;
  });
  // Edges are numbered in the order of their first triangle.
  std::vector<Index> firstOf(halfEdges.size());
  for (std::size_t k = 0; k < halfEdges.size(); ++k)
    firstOf[halfEdges[k].number] =
        k > 0 && halfEdges[k - 1].ends == halfEdges[k].ends ? firstOf[halfEdges[k - 1].number] : halfEdges[k].number;
  skin.edgesOf.resize(skin.triangles.size());
  std::vector<Index> edgeOf(firstOf.size());
  for (Index s = 0; s < firstOf.size(); ++s) {
    const Index t = s / 3, k = s % 3;
    if (firstOf[s] == s) {
      edgeOf[s] = static_cast<Index>(skin.edges.size());
      skin.edges.push_back({{skin.triangles[t][k], skin.triangles[t][(k + 1) % 3]}, {t, kNoTriangle}});
    } else if (Index &other = skin.edges[edgeOf[firstOf[s]]].triangles[1]; other == kNoTriangle) {
      other = t;
    }
    skin.edgesOf[t][k] = edgeOf[firstOf[s]];
  }
}

}  // namespace

std::shared_ptr<const ContactSkin> makeContactSkin(Interpolation vertices, std::vector<Triangle> triangles,
                                                   const SkinResolution &resolution, const Binder &bind,
                                                   std::span<const float> maxInfluence) {
  auto skin = std::make_shared<ContactSkin>();
  SkinSurface surface = makeSkinSurface(std::move(vertices), std::move(triangles), resolution);
  skin->vertices = std::move(surface.points);
  skin->triangles = std::move(surface.triangles);
  if (!surface.added.empty()) {
    std::vector<Vec3> points = skin->vertices.positions;
    points.insert(points.end(), surface.added.begin(), surface.added.end());
    const std::vector<Vec3> normals = normalsOf(points, skin->triangles);
    append(bind(surface.added, std::span<const Vec3>(normals).subspan(skin->count())), skin->vertices);
  }
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
  std::vector<std::uint8_t> isCarrier;
  for (std::size_t v = 0; v < carried.count(); ++v) {
    double sum = 0.0, plain = 0.0;
    for (Index e = carried.phyxels.offsets[v]; e < carried.phyxels.offsets[v + 1]; ++e)
      if (const double weight = std::abs(carried.weights[e]); weight != 0.0) {
        if (carried.phyxels.indices[e] >= isCarrier.size()) isCarrier.resize(carried.phyxels.indices[e] + 1, 0);
        isCarrier[carried.phyxels.indices[e]] = 1;
        plain += weight;
        sum += weight / (maxInfluence.empty() ? 1.0 : static_cast<double>(maxInfluence[carried.phyxels.indices[e]]));
      }
    skin->weightedGain = std::max(skin->weightedGain, sum);
    skin->plainGain = std::max(skin->plainGain, plain);
  }
  for (std::size_t j = 0; j < isCarrier.size(); ++j)
    if (isCarrier[j] != 0) skin->carriers.push_back(static_cast<Index>(j));
  return skin;
}

PatchTree::PatchTree(const ContactSkin &skin) {
  const std::size_t count = skin.triangles.size();
  std::vector<Vec3> centres(count, Vec3::Zero());
  for (std::size_t t = 0; t < count; ++t)
    for (const Index v : skin.triangles[t]) centres[t] += skin.vertices.positions[v];
  std::vector<Index> triangleOrder(count);
  std::iota(triangleOrder.begin(), triangleOrder.end(), Index{0});
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
    if (end - begin <= kMaxPatchTriangles) {
      nodes_[node].patch = static_cast<Index>(patches_.size());
      Patch &patch = patches_.emplace_back();
      patch.triangles.assign(triangleOrder.begin() + begin, triangleOrder.begin() + end);
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
    for (Index k = begin; k < end; ++k) box.add(centres[triangleOrder[k]]);
    int axis = 0;
    (box.high - box.low).maxCoeff(&axis);
    const Index middle = begin + (end - begin) / 2;
    std::nth_element(triangleOrder.begin() + begin, triangleOrder.begin() + middle, triangleOrder.begin() + end,
                     [&](Index a, Index b) {
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
      positions_(skin_->count()), vertexVelocities_(skin_->count()), positionRevisions_(skin_->count(), 0),
      velocityRevisions_(skin_->count(), 0), motions_(tree_.patches().size()), features_(motions_.size()),
      slabs_(motions_.size()) {}

void MovingSkin::move(std::span<const Vec3> displacements, std::span<const Vec3> velocities,
                      std::span<const float> maxInfluence, double dt) {
  displacements_ = displacements;
  velocities_ = velocities;
  maxInfluence_ = maxInfluence;
  dt_ = dt;
  stepTravelExact_ = -1.0;
  ++revision_;
  Vec3 mean = Vec3::Zero();
  const std::vector<Index> &carriers = skin_->carriers;
  for (const Index j : carriers) mean += velocities[j];
  mean /= static_cast<double>(std::max<std::size_t>(1, carriers.size()));
  TravelBound bound(maxInfluence_);
  for (const Index j : carriers) bound.add(j, velocities[j] - mean);
  stepTravel_ = dt * bound.ofVertices(*skin_);
  meanStepTravel_ = dt * mean;
}

double MovingSkin::stepTravelExact() {
  if (stepTravelExact_ >= 0.0) return stepTravelExact_;
  double squared = 0.0;
  for (Index v = 0; v < skin_->count(); ++v)
    squared = std::max(squared, (dt_ * velocity(v) - meanStepTravel_).squaredNorm());
  return stepTravelExact_ = std::sqrt(squared);
}

double MovingSkin::travelSince(std::span<const Vec3> reference, Vec3 &mean) const {
  mean.setZero();
  const std::vector<Index> &carriers = skin_->carriers;
  for (const Index j : carriers) mean += displacements_[j] - reference[j];
  mean /= static_cast<double>(std::max<std::size_t>(1, carriers.size()));
  TravelBound bound(maxInfluence_);
  for (const Index j : carriers) bound.add(j, displacements_[j] - reference[j] - mean);
  return bound.ofVertices(*skin_);
}

void MovingSkin::computePosition(Index v) {
  const Interpolation &carried = skin_->vertices;
  const Mat3 F = rankOf(carried, v) < 3 ? gradientAt(carried, v, displacements_) : Mat3(Mat3::Identity());
  positions_[v] = origin_ + carried.positions[v] + displacementAt(carried, v, displacements_, F);
  positionRevisions_[v] = revision_;
}

void MovingSkin::updateVelocity(Index v) {
  vertexVelocities_[v] = fieldAt(skin_->vertices, v, velocities_);
  velocityRevisions_[v] = revision_;
}

bool MovingSkin::isInverted(Index v) {
  if (inversionRevisions_.empty()) inversionRevisions_.assign(skin_->count(), 0);
  if (inversionRevisions_[v] / 2 != revision_) {
    const bool inverted = !(gradientAt(skin_->vertices, v, displacements_).determinant() > kInvertedVolumeRatio);
    inversionRevisions_[v] = 2 * revision_ + (inverted ? 1 : 0);
  }
  return inversionRevisions_[v] % 2 != 0;
}

const MovingSkin::PatchMotion &MovingSkin::motionOf(Index patch) {
  PatchMotion &motion = motions_[patch];
  if (motion.revision == revision_) return motion;
  motion = PatchMotion();
  motion.revision = revision_;
  for (const Index v : tree_.patches()[patch].corners) {
    motion.positions.add(position(v));
    motion.velocities.add(velocity(v));
  }
  return motion;
}

void MovingSkin::updatePositions() {
  for (Index v = 0; v < skin_->count(); ++v) (void)position(v);
}

void MovingSkin::refitTree() {
  updatePositions();
  if (treeRevision_ == revision_) return;
  tree_.refit(positions_);
  treeRevision_ = revision_;
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

Vec3 MovingSkin::areaWeightedNormal(Index vertex) {
  Vec3 sum = Vec3::Zero();
  for (const Index t : skin_->trianglesOf.row(vertex)) sum += faceNormal(t);
  return sum.normalized();
}

// Angle-weighted pseudonormal: its sign is right for all points whose nearest point on the surface is the vertex.
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

bool MovingSkin::isSharp(Index edge, double minSine, double minRise) {
  const SkinEdge &e = skin_->edges[edge];
  if (e.triangles[1] == kNoTriangle) return true;
  const Vec3 n = faceNormal(e.triangles[0]), m = faceNormal(e.triangles[1]);
  const auto &corners = skin_->triangles[e.triangles[1]];
  const Index opposite = corners[0] + corners[1] + corners[2] - e.ends[0] - e.ends[1];
  const Vec3 &end = position(e.ends[0]);
  if (n.dot(position(opposite) - end) > 0.0) return false;
  const double length = (end - position(e.ends[1])).norm();
  const double threshold = std::min(minSine, minRise / std::max(length, 1e-12 * minRise));
  return n.cross(m).squaredNorm() > threshold * threshold * n.squaredNorm() * m.squaredNorm() || n.dot(m) < 0.0;
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
  if (slab.revision == revision_) return slab;
  slab.revision = revision_;
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

const MovingSkin::PatchFeatures &MovingSkin::featuresOf(Index patch, double minSine, double minRise) {
  PatchFeatures &features = features_[patch];
  if (features.revision == revision_ && features.minRise == minRise) return features;
  features.revision = revision_;
  features.minRise = minRise;
  features.triangles.clear();
  features.edges.clear();
  for (const Index t : tree_.patches()[patch].triangles) {
    SkinBox &box = features.triangles.emplace_back();
    for (const Index v : skin_->triangles[t]) box.add(position(v));
  }
  for (const Index e : tree_.patches()[patch].edges) {
    if (!isSharp(e, minSine, minRise)) continue;
    SkinBox &box = features.edges.emplace_back(e, SkinBox()).second;
    for (const Index v : skin_->edges[e].ends) box.add(position(v));
  }
  return features;
}

NearestOnTriangle MovingSkin::nearestOn(Index triangle, const Vec3 &x) {
  const auto &[a, b, c] = skin_->triangles[triangle];
  return nearestOnTriangle(x, position(a), position(b), position(c));
}

Vec3 MovingSkin::pointOn(Index triangle, const Vec3 &weights) {
  const auto &[a, b, c] = skin_->triangles[triangle];
  return weights[0] * position(a) + weights[1] * position(b) + weights[2] * position(c);
}

Vec3 MovingSkin::featureNormal(Index triangle, int feature) {
  if (feature == 0) return faceNormal(triangle);
  const auto k = static_cast<std::size_t>(feature);
  return k < 4 ? edgeNormal(skin_->edgesOf[triangle][k - 1]) : vertexNormal(skin_->triangles[triangle][k - 4]);
}

Index MovingSkin::nearestTriangle(const Vec3 &x) {
  Index at = kNoTriangle;
  double best = std::numeric_limits<double>::infinity();
  tree_.nearest(x, [&](Index t) {
    const double squared = nearestOn(t, x).squared;
    if (squared < best || (squared == best && t < at)) {
      best = squared;
      at = t;
    }
    return squared;
  });
  return at;
}

Vec3 MovingSkin::nearestPoint(const Vec3 &x) {
  const Index t = nearestTriangle(x);
  return pointOn(t, nearestOn(t, x).weights);
}

double MovingSkin::signedDistance(const Vec3 &x) {
  const Index t = nearestTriangle(x);
  const NearestOnTriangle found = nearestOn(t, x);
  const bool isInside = (x - pointOn(t, found.weights)).dot(featureNormal(t, found.feature)) < 0.0;
  return (isInside ? -1.0 : 1.0) * std::sqrt(found.squared);
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
  if (!(sum > 0.0)) return end(1.0, 0.0, 0.0, 4);  // degenerate: no area
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
