// SPDX-License-Identifier: Apache-2.0
#include "c3de/segmentation/body_request.h"

#include <utility>

namespace c3de::segmentation {

Expected<imaging::Mask> maskOf(const BodyRequest &request, const ProgressFn &progress) {
  if (!request.mask && !request.labels) return fail(ErrorCode::usage, request.name + ": nothing is picked");
  Expected<imaging::Mask> mask =
      request.mask ? Expected<imaging::Mask>(*request.mask) : imaging::maskOf(request.labels->map, request.label);
  if (mask && imaging::voxelCount(*mask) == 0)
    return fail(ErrorCode::usage,
                request.mask ? std::string("the mask is empty; accepted: one with voxels")
                             : "no voxel of " + request.labels->name + " has label " + std::to_string(request.label));
  if (!mask || request.mask) return mask;
  return imaging::mended(std::move(*mask), request.mend, progress);
}

}  // namespace c3de::segmentation
