// SPDX-License-Identifier: Apache-2.0
#include "workstation/tissue_presenter.h"

#include <algorithm>
#include <string>
#include <utility>

namespace c3de::app {
namespace {

constexpr std::size_t kMaxListed = 6;  // longer lists are folded initially
// In edges: where a scan ends, the surface of a tissue and the skin of the body coincide, each off by a fraction of
// one.
constexpr float kCover = 0.5f;

float meanEdge(const geometry::TriangleMesh &mesh) {
  double sum = 0.0;
  for (const Triangle &t : mesh.triangles) sum += norm(mesh.vertices[t[1]] - mesh.vertices[t[0]]);
  return static_cast<float>(sum / static_cast<double>(std::max<std::size_t>(1, mesh.triangles.size())));
}

}  // namespace

void TissuePresenter::show(std::shared_ptr<const std::vector<TissueSurface>> surfaces, Handle parent) {
  forget();
  if (!surfaces || surfaces->empty()) return;
  surfaces_ = std::move(surfaces);
  group_ = scene_.add(parent, "tissues");
  if (scene::Node *group = scene_.find(group_)) group->isFolded = surfaces_->size() > kMaxListed;
  const bool isOneBody = std::all_of(surfaces_->begin(), surfaces_->end(), [&](const TissueSurface &surface) {
    return surface.body == surfaces_->front().body;
  });
  for (const TissueSurface &surface : *surfaces_) {
    std::vector<render::Vec3f> positions;
    positions.reserve(surface.reference.vertices.size());
    for (const Vec3 &x : surface.reference.vertices)
      positions.push_back({static_cast<float>(x[0]), static_cast<float>(x[1]), static_cast<float>(x[2])});
    render::Material material;
    material.colour = {surface.colour[0], surface.colour[1], surface.colour[2], 1.0f};
    material.isInside = true;
    material.cover = kCover * meanEdge(surface.reference);
    Drawn one;
    one.mesh = renderer_.createMesh(positions, surface.reference.triangles, material);
    one.node = scene_.add(group_, isOneBody ? surface.name : surface.body + ": " + surface.name);
    drawn_.push_back(one);
  }
  followTree();
}

void TissuePresenter::forget() {
  for (const Drawn &one : drawn_) renderer_.destroy(one.mesh);
  drawn_.clear();
  scene_.remove(std::exchange(group_, {}));
  surfaces_.reset();
  places_.reset();
}

void TissuePresenter::place(const std::shared_ptr<const SurfacePositions> &places) {
  if (!places || places == places_ || places->of != surfaces_) return;
  places_ = places;
  for (std::size_t i = 0; i < drawn_.size(); ++i)
    if (!places_->vertices[i].empty()) renderer_.setPositions(drawn_[i].mesh, places_->vertices[i]);
}

void TissuePresenter::followTree() {
  for (Drawn &one : drawn_) {
    const bool isVisible = scene_.isVisible(one.node);
    if (isVisible == one.isVisible) continue;
    one.isVisible = isVisible;
    renderer_.setVisible(one.mesh, isVisible);
  }
}

std::shared_ptr<const std::vector<TissueSurface>> TissuePresenter::seen() const {
  for (std::size_t i = 0; i < drawn_.size(); ++i)
    if (drawn_[i].isVisible && !(*surfaces_)[i].isRigid) return surfaces_;
  return nullptr;
}

}  // namespace c3de::app
