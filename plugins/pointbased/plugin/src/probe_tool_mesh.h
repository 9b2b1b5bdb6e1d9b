// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "placed_mesh.h"
#include "pointbased/probe_tool.h"

namespace pointbased {

/// What is seen of a probe tool, at the first place of its path: a sphere or capsule of triangles. Errors of the
/// services as sdk::Error.
[[nodiscard]] std::shared_ptr<PlacedMesh> meshOf(const Services &services, const ProbeTool &tool);

}  // namespace pointbased
