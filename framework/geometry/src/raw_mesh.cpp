// SPDX-License-Identifier: Apache-2.0
#include "raw_mesh.h"

#include <algorithm>

#include "polygon.h"

namespace c3de::geometry {

bool addFace(RawMesh &raw, std::span<const unsigned> corners) {
  std::vector<unsigned> face(corners.begin(), corners.end());
  face.erase(std::unique(face.begin(), face.end()), face.end());
  while (face.size() > 1 && face.back() == face.front()) face.pop_back();
  // Four corners may still be a path back and forth.
  std::vector<unsigned> different = face;
  std::sort(different.begin(), different.end());
  if (std::unique(different.begin(), different.end()) - different.begin() < 3) {
    ++raw.facesDropped;
    return true;
  }
  if (face.size() > 3) ++raw.polygonsSplit;
  return triangulatePolygon(raw.vertices, face, raw.triangles);
}

}  // namespace c3de::geometry
