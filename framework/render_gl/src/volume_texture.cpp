// SPDX-License-Identifier: Apache-2.0
#include "volume_texture.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

namespace c3de::render {
namespace {

constexpr GLsizei kTableSide = 256;  // 65 536 labels

/// How a voxel type is stored in a texture. `scale`: voxel = scale * texel.
struct TexelFormat {
  GLenum internal, type;
  std::size_t bytes;
  double scale;
};

TexelFormat formatOf(VoxelType type) {
  switch (type) {
    case VoxelType::int8: return {GL_R8_SNORM, GL_BYTE, 1, 127.0};
    case VoxelType::uint8: return {GL_R8, GL_UNSIGNED_BYTE, 1, 255.0};
    case VoxelType::int16: return {GL_R16_SNORM, GL_SHORT, 2, 32767.0};
    case VoxelType::uint16: return {GL_R16, GL_UNSIGNED_SHORT, 2, 65535.0};
    default: return {GL_R32F, GL_FLOAT, 4, 1.0};
  }
}

std::size_t bytesOf(VoxelType type) {
  switch (type) {
    case VoxelType::int8:
    case VoxelType::uint8: return 1;
    case VoxelType::int16:
    case VoxelType::uint16: return 2;
    case VoxelType::float64: return 8;
    default: return 4;
  }
}

template <class From>
void toFloats(const From *from, std::span<float> to, std::size_t stride) {
  for (std::size_t i = 0; i < to.size(); ++i) to[i] = static_cast<float>(from[i * stride]);
}

/// A row of voxels, every `stride`-th, in the format of the texture.
void copyRow(const unsigned char *row, VoxelType type, std::size_t stride, std::size_t count, unsigned char *to) {
  const auto floats = [&] { return std::span<float>(reinterpret_cast<float *>(to), count); };
  switch (type) {
    case VoxelType::int32: return toFloats(reinterpret_cast<const std::int32_t *>(row), floats(), stride);
    case VoxelType::uint32: return toFloats(reinterpret_cast<const std::uint32_t *>(row), floats(), stride);
    case VoxelType::float64: return toFloats(reinterpret_cast<const double *>(row), floats(), stride);
    default: {
      const std::size_t bytes = bytesOf(type);
      for (std::size_t i = 0; i < count; ++i) std::copy_n(row + i * stride * bytes, bytes, to + i * bytes);
    }
  }
}

GLint longestSide() {
  GLint longest = 0;
  glGetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &longest);
  return longest;
}

void useTight() {
  glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  for (const GLenum zero : {GL_UNPACK_ROW_LENGTH, GL_UNPACK_IMAGE_HEIGHT, GL_UNPACK_SKIP_PIXELS, GL_UNPACK_SKIP_ROWS,
                            GL_UNPACK_SKIP_IMAGES})
    glPixelStorei(zero, 0);
}

/// Storage for a grid; the texture is bound afterwards.
Expected<void> makeStorage(const Texture &texture, const std::array<std::size_t, 3> &size, GLenum internal,
                           GLint filter, std::size_t bytes, const char *what) {
  while (glGetError() != GL_NO_ERROR) {
  }
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_3D, texture.name());
  for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
    glTexParameteri(GL_TEXTURE_3D, wrap, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MIN_FILTER, filter);
  glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MAG_FILTER, filter);
  glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MAX_LEVEL, 0);
  const auto side = [&](std::size_t a) { return static_cast<GLsizei>(size[a]); };
  glTexImage3D(GL_TEXTURE_3D, 0, static_cast<GLint>(internal), side(0), side(1), side(2), 0,
               internal == GL_R16UI    ? GL_RED_INTEGER
               : internal == GL_RGB32F ? GL_RGB
               : internal == GL_RGBA8  ? GL_RGBA
                                       : GL_RED,
               internal == GL_R16UI ? GL_UNSIGNED_SHORT : GL_FLOAT, nullptr);
  if (const GLenum error = glGetError(); error != GL_NO_ERROR)
    return fail(ErrorCode::graphics,
                fmt::format("insufficient graphics memory for {} of {} x {} x {} points ({} MB): OpenGL error 0x{:04x}",
                            what, size[0], size[1], size[2], bytes * size[0] * size[1] * size[2] / 1000000, error));
  return {};
}

Expected<void> checkSides(const std::array<std::size_t, 3> &size, const char *what) {
  const auto longest = static_cast<std::size_t>(longestSide());
  if (*std::max_element(size.begin(), size.end()) <= longest) return {};
  return fail(ErrorCode::graphics,
              fmt::format("{} of {} x {} x {} points; the graphics card takes up to {} along a side", what, size[0],
                          size[1], size[2], longest));
}

/// Every stride-th of the colours, on the grid of the grey values.
Expected<void> uploadColours(const Texture &texture, const ImageVoxels &image, const std::array<std::size_t, 3> &kept,
                             const std::array<std::size_t, 3> &stride) {
  if (auto storage = makeStorage(texture, kept, GL_RGBA8, GL_LINEAR, 4, "a colour image"); !storage) return storage;
  useTight();
  const std::array<std::size_t, 3> &full = image.place.size;
  std::vector<std::array<std::uint8_t, 4>> slice(kept[0] * kept[1]);
  for (std::size_t k = 0; k < kept[2]; ++k) {
    auto *to = slice.data();
    for (std::size_t j = 0; j < kept[1]; ++j) {
      const auto *row = image.colours + full[0] * (j * stride[1] + full[1] * k * stride[2]);
      for (std::size_t i = 0; i < kept[0]; ++i) *to++ = row[i * stride[0]];
    }
    glTexSubImage3D(GL_TEXTURE_3D, 0, 0, 0, static_cast<GLint>(k), static_cast<GLsizei>(kept[0]),
                    static_cast<GLsizei>(kept[1]), 1, GL_RGBA, GL_UNSIGNED_BYTE, slice.data());
  }
  glBindTexture(GL_TEXTURE_3D, 0);
  return {};
}

}  // namespace

Expected<void> uploadGreyValues(ImageSlot &slot, const ImageVoxels &image, std::string *notice) {
  const TexelFormat format = formatOf(image.type);
  const auto longest = static_cast<std::size_t>(longestSide());
  const std::array<std::size_t, 3> full = image.place.size;
  std::array<std::size_t, 3> stride{}, kept{};
  for (std::size_t a = 0; a < 3; ++a) {
    stride[a] = (full[a] + longest - 1) / longest;
    kept[a] = (full[a] + stride[a] - 1) / stride[a];
    for (std::size_t r = 0; r < 3; ++r) slot.place.worldFromIndex[4 * a + r] *= static_cast<double>(stride[a]);
  }
  slot.place.size = kept;
  slot.scale = format.scale * image.slope;
  slot.offset = image.intercept;

  auto made = std::make_unique<GridTexture>();
  if (auto storage = makeStorage(made->grid, kept, format.internal, GL_LINEAR, format.bytes, "an image"); !storage)
    return storage;
  useTight();
  const auto *bytes = static_cast<const unsigned char *>(image.voxels);
  const std::size_t voxelBytes = bytesOf(image.type), rowBytes = voxelBytes * full[0];
  const auto width = static_cast<GLsizei>(kept[0]), height = static_cast<GLsizei>(kept[1]);
  const bool isDirect =
      kept == full && voxelBytes == format.bytes && image.type != VoxelType::int32 && image.type != VoxelType::uint32;
  std::vector<unsigned char> slice(isDirect ? 0 : kept[0] * kept[1] * format.bytes);
  for (std::size_t k = 0; k < kept[2]; ++k) {
    const unsigned char *from = bytes + k * stride[2] * full[1] * rowBytes;
    for (std::size_t j = 0; j < kept[1] && !isDirect; ++j)
      copyRow(from + j * stride[1] * rowBytes, image.type, stride[0], kept[0],
              slice.data() + j * kept[0] * format.bytes);
    glTexSubImage3D(GL_TEXTURE_3D, 0, 0, 0, static_cast<GLint>(k), width, height, 1, GL_RED, format.type,
                    isDirect ? from : slice.data());
  }
  glBindTexture(GL_TEXTURE_3D, 0);
  if (image.colours) {
    made->colours = Texture::create();
    if (auto coloured = uploadColours(made->colours, image, kept, stride); !coloured) return coloured;
  }
  if (notice && kept != full)
    *notice = fmt::format(
        "The image has {} x {} x {} voxels; the graphics card takes up to {} along a side, so {} x {} x {} are shown.",
        full[0], full[1], full[2], longest, kept[0], kept[1], kept[2]);
  slot.backEnd = std::move(made);
  return {};
}

Expected<void> uploadLabelValues(ImageSlot &slot, std::span<const std::uint16_t> voxels) {
  if (auto sides = checkSides(slot.place.size, "a label map"); !sides) return sides;
  auto made = std::make_unique<GridTexture>();
  const auto &size = slot.place.size;
  if (auto storage = makeStorage(made->grid, size, GL_R16UI, GL_NEAREST, 2, "a label map"); !storage) return storage;
  useTight();
  for (std::size_t k = 0; k < size[2]; ++k)
    glTexSubImage3D(GL_TEXTURE_3D, 0, 0, 0, static_cast<GLint>(k), static_cast<GLsizei>(size[0]),
                    static_cast<GLsizei>(size[1]), 1, GL_RED_INTEGER, GL_UNSIGNED_SHORT,
                    voxels.data() + k * size[0] * size[1]);
  glBindTexture(GL_TEXTURE_3D, 0);
  slot.backEnd = std::move(made);
  uploadLabelTable(slot);
  return {};
}

void uploadLabelTable(ImageSlot &slot) {
  std::vector<Rgba8> table(std::size_t{kTableSide} * kTableSide, Rgba8{0, 0, 0, 0});
  for (const auto &[value, colour] : slot.colours) table[value] = toRgba8(colour);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, static_cast<GridTexture &>(*slot.backEnd).table.name());
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
  useTight();
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, kTableSide, kTableSide, 0, GL_RGBA, GL_UNSIGNED_BYTE, table.data());
  glBindTexture(GL_TEXTURE_2D, 0);
}

Expected<void> uploadDisplacementValues(ImageSlot &slot, std::span<const float> xyz_mm, std::span<const float> gap_mm) {
  const auto &size = slot.place.size;
  if (!slot.backEnd) {
    if (auto sides = checkSides(size, "a displacement grid"); !sides) return sides;
    auto made = std::make_unique<GridTexture>();
    if (auto storage = makeStorage(made->grid, size, slot.hasGaps ? GL_RGBA32F : GL_RGB32F, GL_LINEAR,
                                   slot.hasGaps ? 16 : 12, "a displacement grid");
        !storage)
      return storage;
    slot.backEnd = std::move(made);
  }
  std::vector<float> both(slot.hasGaps ? 4 * gap_mm.size() : 0);
  for (std::size_t p = 0; p < both.size() / 4; ++p) {
    std::copy_n(&xyz_mm[3 * p], 3, &both[4 * p]);
    both[4 * p + 3] = gap_mm[p];
  }
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_3D, static_cast<GridTexture &>(*slot.backEnd).grid.name());
  useTight();
  glTexSubImage3D(GL_TEXTURE_3D, 0, 0, 0, 0, static_cast<GLsizei>(size[0]), static_cast<GLsizei>(size[1]),
                  static_cast<GLsizei>(size[2]), slot.hasGaps ? GL_RGBA : GL_RGB, GL_FLOAT,
                  slot.hasGaps ? both.data() : xyz_mm.data());
  glBindTexture(GL_TEXTURE_3D, 0);
  return {};
}

bool uploadFieldValues(ImageSlot &slot, std::span<const float> pairs) {
  auto &textures = static_cast<GridTexture &>(*slot.backEnd);
  if (pairs.empty()) {
    textures.field = {};
    return true;
  }
  const auto &size = slot.place.size;
  if (textures.field.name() == 0) {
    textures.field = Texture::create();
    if (!makeStorage(textures.field, size, GL_RG32F, GL_LINEAR, 8, "a field")) {
      textures.field = {};
      return false;
    }
  }
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_3D, textures.field.name());
  useTight();
  glTexSubImage3D(GL_TEXTURE_3D, 0, 0, 0, 0, static_cast<GLsizei>(size[0]), static_cast<GLsizei>(size[1]),
                  static_cast<GLsizei>(size[2]), GL_RG, GL_FLOAT, pairs.data());
  glBindTexture(GL_TEXTURE_3D, 0);
  return true;
}

void uploadColourRow(const Texture &texture, std::span<const std::array<float, 4>> colours) {
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, texture.name());
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
  useTight();
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, static_cast<GLsizei>(colours.size()), 1, 0, GL_RGBA, GL_FLOAT,
               colours.data());
  glBindTexture(GL_TEXTURE_2D, 0);
}

}  // namespace c3de::render
