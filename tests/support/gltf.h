// SPDX-License-Identifier: Apache-2.0
// A mesh as glTF, in one file and in two.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>

namespace c3de::test {

/// A tetrahedron with edges of 0.1, as stored in glTF: 48 bytes of points, 24 of indices.
inline std::string gltfBuffer() {
  const float points[12] = {0, 0, 0, 0.1F, 0, 0, 0, 0.1F, 0, 0, 0, 0.1F};
  const std::uint16_t corners[12] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
  std::string out(72, '\0');
  std::memcpy(out.data(), points, 48);
  std::memcpy(out.data() + 48, corners, 24);
  return out;
}

/// Its description. @param uri  of the buffer; empty: it is in the same file
inline std::string gltf(const std::string &uri) {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
         R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],"buffers":[{)" +
         (uri.empty() ? "" : "\"uri\":\"" + uri + "\",") +
         R"("byteLength":72}],)"
         R"("bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":24}],)"
         R"("accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3",)"
         R"("min":[0,0,0],"max":[0.1,0.1,0.1]},)"
         R"({"bufferView":1,"componentType":5123,"count":12,"type":"SCALAR"}]})";
}

/// The same in one file.
inline std::string glb() {
  std::string json = gltf("");
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const std::string buffer = gltfBuffer();
  const auto word = [](std::size_t value) {
    std::string out;
    for (unsigned shift = 0; shift < 32; shift += 8) out += static_cast<char>(value >> shift & 255u);
    return out;
  };
  return "glTF" + word(2) + word(28 + json.size() + buffer.size()) + word(json.size()) + "JSON" + json +
         word(buffer.size()) + std::string("BIN\0", 4) + buffer;
}

}  // namespace c3de::test
