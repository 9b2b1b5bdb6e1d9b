// SPDX-License-Identifier: Apache-2.0
#include "files/mask_bytes.h"

#include <bit>
#include <cmath>
#include <cstdint>

namespace c3de::session {
namespace {

constexpr std::string_view kMaskMagic = "C3DE mask 1\n";
constexpr std::size_t kHeader = kMaskMagic.size() + 8 * (3 + 16) + 1 + 3 * 4;
constexpr std::uint64_t kMostVoxels = std::uint64_t{1} << 34;

template <class Word>
void put(std::string &out, Word word) {
  for (std::size_t byte = 0; byte < sizeof word; ++byte) out += static_cast<char>(word >> (8 * byte) & 0xffu);
}

template <class Word>
Word take(std::string_view &bytes) {
  Word word = 0;
  for (std::size_t byte = 0; byte < sizeof word; ++byte)
    word |= static_cast<Word>(static_cast<unsigned char>(bytes[byte])) << (8 * byte);
  bytes.remove_prefix(sizeof word);
  return word;
}

}  // namespace

std::string maskBytes(const imaging::Mask &mask, const std::optional<std::array<float, 3>> &colour) {
  std::string out(kMaskMagic);
  out.reserve(kHeader + mask.voxels.size() / 8 + 1);
  for (const std::size_t size : mask.geometry.size) put<std::uint64_t>(out, size);
  for (const double number : mask.geometry.indexToWorld) put(out, std::bit_cast<std::uint64_t>(number));
  out += colour ? '\1' : '\0';
  for (std::size_t i = 0; i < 3; ++i) put(out, std::bit_cast<std::uint32_t>(colour ? (*colour)[i] : 0.0f));
  for (std::size_t v = 0; v < mask.voxels.size(); v += 8) {
    unsigned packed = 0;
    for (std::size_t bit = 0; bit < 8 && v + bit < mask.voxels.size(); ++bit)
      packed |= (mask.voxels[v + bit] != 0 ? 1u : 0u) << bit;
    out += static_cast<char>(packed);
  }
  return out;
}

Expected<PickedMask> maskOfBytes(std::string_view bytes) {
  if (!bytes.starts_with(kMaskMagic) || bytes.size() < kHeader)
    return fail(ErrorCode::input, "is no mask of a session");
  bytes.remove_prefix(kMaskMagic.size());
  PickedMask out;
  std::uint64_t voxels = 1;
  for (std::size_t &size : out.mask.geometry.size) {
    const auto read = take<std::uint64_t>(bytes);
    if (read == 0 || read > kMostVoxels / voxels) return fail(ErrorCode::input, "has a grid of impossible size");
    voxels *= read;
    size = static_cast<std::size_t>(read);
  }
  for (double &number : out.mask.geometry.indexToWorld) {
    number = std::bit_cast<double>(take<std::uint64_t>(bytes));
    if (!std::isfinite(number)) return fail(ErrorCode::input, "has a grid that is not finite");
  }
  const bool hasColour = bytes.front() != '\0';
  bytes.remove_prefix(1);
  std::array<float, 3> colour{};
  for (float &channel : colour) channel = std::bit_cast<float>(take<std::uint32_t>(bytes));
  if (hasColour) out.colour = colour;
  if (bytes.size() != (voxels + 7) / 8)
    return fail(ErrorCode::input, "has " + std::to_string(bytes.size()) +
                                      " bytes of voxels; accepted: " + std::to_string((voxels + 7) / 8));
  out.mask.voxels.resize(static_cast<std::size_t>(voxels));
  for (std::size_t v = 0; v < out.mask.voxels.size(); ++v)
    out.mask.voxels[v] = static_cast<unsigned char>(bytes[v / 8]) >> (v % 8) & 1u;
  return out;
}

}  // namespace c3de::session
