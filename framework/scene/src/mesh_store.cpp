// SPDX-License-Identifier: Apache-2.0
#include "c3de/scene/mesh_store.h"

#include <utility>

namespace c3de::scene {

const geometry::WindingNumber &StoredMesh::windingNumber() const {
  std::call_once(once_, [this] { winding_ = std::make_unique<geometry::WindingNumber>(loaded.mesh); });
  return *winding_;
}

Handle MeshStore::add(geometry::LoadedMesh mesh) {
  auto stored = std::make_shared<StoredMesh>();
  stored->loaded = std::move(mesh);
  const std::lock_guard lock(mutex_);
  return meshes_.add(std::move(stored));
}

bool MeshStore::remove(Handle mesh) {
  const std::lock_guard lock(mutex_);
  return meshes_.remove(mesh);
}

std::shared_ptr<const StoredMesh> MeshStore::find(Handle mesh) const {
  const std::lock_guard lock(mutex_);
  const auto *found = meshes_.find(mesh);
  return found != nullptr ? *found : nullptr;
}

}  // namespace c3de::scene
