// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "base/placed_mesh.h"
#include "pointbased/probe_tool.h"

namespace pointbased {

/// Display mesh of a probe tool at the first position of its path: a sphere or capsule of triangles. Throws errors of
/// the services as sdk::Error.
[[nodiscard]] std::shared_ptr<PlacedMesh> meshOf(const Services &services, const ProbeTool &tool);

}  // namespace pointbased
