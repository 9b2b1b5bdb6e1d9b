// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <mutex>

#include "c3de/core/handle.h"
#include "c3de/geometry/mesh_io.h"
#include "c3de/geometry/winding_number.h"

namespace c3de::scene {

/// A mesh with its report; the winding-number tree is built on first use.
struct StoredMesh {
  geometry::LoadedMesh loaded;
  [[nodiscard]] const geometry::WindingNumber &windingNumber() const;  ///< any thread

 private:
  mutable std::once_flag once_;
  mutable std::unique_ptr<geometry::WindingNumber> winding_;
};

/// Meshes by handle, shared by the scene and plugins. Any thread; a stored mesh is immutable.
class MeshStore {
 public:
  Handle add(geometry::LoadedMesh mesh);
  bool remove(Handle mesh);
  [[nodiscard]] std::shared_ptr<const StoredMesh> find(Handle mesh) const;

 private:
  mutable std::mutex mutex_;
  HandleTable<std::shared_ptr<const StoredMesh>, HandleKind::mesh> meshes_;
};

}  // namespace c3de::scene
