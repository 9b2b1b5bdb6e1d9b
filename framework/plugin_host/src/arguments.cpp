// SPDX-License-Identifier: Apache-2.0
#include "arguments.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <string_view>

namespace c3de::plugin_host {
namespace {

constexpr std::size_t kLongestId = 200;
// Vertex indices are 32 bits wide, and 0xffffffff means none.
constexpr std::uint64_t kMaxRows = 0xfffffffeu;

std::size_t dtypeSize(std::uint32_t dtype) {
  switch (dtype) {
    case C3DE_U8: return 1;
    case C3DE_F32:
    case C3DE_I32:
    case C3DE_U32: return 4;
    case C3DE_F64:
    case C3DE_U64: return 8;
    default: return 0;
  }
}

const char *dtypeName(std::uint32_t dtype) {
  switch (dtype) {
    case C3DE_F32: return "f32";
    case C3DE_F64: return "f64";
    case C3DE_U8: return "u8";
    case C3DE_I32: return "i32";
    case C3DE_U32: return "u32";
    case C3DE_U64: return "u64";
    default: return "unknown";
  }
}

template <class To, class From>
void readRow(const unsigned char *row, std::array<To, 3> &out) {
  // memcpy, because rows need not be aligned.
  std::array<From, 3> in;
  std::memcpy(in.data(), row, sizeof in);
  for (std::size_t k = 0; k < 3; ++k) out[k] = static_cast<To>(in[k]);
}

template <class To>
std::vector<std::array<To, 3>> readPositions(const c3de_view &view, const char *name) {
  const RowLayout rows = layoutOf(view, name, 3, {C3DE_F64, C3DE_F32});
  std::vector<std::array<To, 3>> out(rows.count);
  for (std::size_t i = 0; i < rows.count; ++i) {
    const unsigned char *row = rows.data + i * rows.stride;
    if (view.dtype == C3DE_F64)
      readRow<To, double>(row, out[i]);
    else
      readRow<To, float>(row, out[i]);
    if (!std::isfinite(out[i][0]) || !std::isfinite(out[i][1]) || !std::isfinite(out[i][2]))
      throw Refusal(C3DE_E_ARG,
                    fmt::format("{}: row {} is not finite: ({}, {}, {})", name, i, out[i][0], out[i][1], out[i][2]));
  }
  return out;
}

/// Whether a row of one overlaps a row of the other. Interleaved rows, such as members of one struct, do not.
bool shareBytes(const RowLayout &a, std::size_t aBytes, const RowLayout &b, std::size_t bBytes) {
  if (a.count == 0 || b.count == 0) return false;
  const auto aBegin = reinterpret_cast<std::uintptr_t>(a.data), bBegin = reinterpret_cast<std::uintptr_t>(b.data);
  const std::uintptr_t aEnd = aBegin + (a.count - 1) * a.stride + aBytes;
  const std::uintptr_t bEnd = bBegin + (b.count - 1) * b.stride + bBytes;
  if (aEnd <= bBegin || bEnd <= aBegin) return false;
  if (a.stride != b.stride) return true;
  const std::uintptr_t after = (bBegin % a.stride + a.stride - aBegin % a.stride) % a.stride;
  return after < aBytes || after + bBytes > a.stride;
}

}  // namespace

std::string textOf(c3de_str text, const char *name) {
  if (text.len == 0) return {};
  if (!text.ptr) throw Refusal(C3DE_E_ARG, fmt::format("{}: null pointer with length {}", name, text.len));
  if (text.len > kLongestText)
    throw Refusal(C3DE_E_ARG, fmt::format("{}: {} bytes, accepted are at most {}", name, text.len, kLongestText));
  const std::string_view view(text.ptr, static_cast<std::size_t>(text.len));
  if (!isUtf8(view)) throw Refusal(C3DE_E_ARG, fmt::format("{}: is not UTF-8", name));
  return std::string(view);
}

std::string labelOf(c3de_str text, const char *name, Lines lines) { return displayText(textOf(text, name), lines); }

std::string idOf(c3de_str text, const char *name) {
  const std::string id = textOf(text, name);
  if (id.empty()) throw Refusal(C3DE_E_ARG, fmt::format("{}: is empty", name));
  if (id.size() > kLongestId)
    throw Refusal(C3DE_E_ARG, fmt::format("{}: {} bytes, accepted are at most {}", name, id.size(), kLongestId));
  for (const char c : id) {
    const bool accepted = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' ||
                          c == '_' || c == '-' || c == '/';
    if (!accepted)
      throw Refusal(C3DE_E_ARG,
                    fmt::format("{}: '{}' has characters other than letters, digits and . _ - /", name, id));
  }
  return id;
}

std::string textOf(c3de_handle handle) {
  const std::string kind = nameOf(handleOf(handle).kind());
  if (kind.empty()) return fmt::format("{:#x}", handle.v);
  const bool hasVowel = std::string_view("aeiou").find(kind.front()) != std::string_view::npos;
  return fmt::format("{:#x} (that of {} {})", handle.v, hasVowel ? "an" : "a", kind);
}

void refuseStride(const char *name, std::uint64_t stride, std::uint64_t least, std::uint64_t alignment) {
  throw Refusal(C3DE_E_ARG, fmt::format("{}: stride is {}, accepted: 0 (contiguous) or a multiple of {} from {} to {}",
                                        name, stride, alignment, least, kLargestStride));
}

double finiteOf(double value, const char *name) {
  if (!std::isfinite(value)) throw Refusal(C3DE_E_ARG, fmt::format("{} is {}, which is not finite", name, value));
  return value;
}

Vec3 pointOf(const double *three, const char *name) {
  requireNonNull(three, name);
  return {finiteOf(three[0], name), finiteOf(three[1], name), finiteOf(three[2], name)};
}

RowLayout layoutOf(const c3de_view &view, const char *name, std::uint32_t comps,
                   std::initializer_list<std::uint32_t> dtypes) {
  if (std::find(dtypes.begin(), dtypes.end(), view.dtype) == dtypes.end()) {
    std::string accepted;
    for (const std::uint32_t dtype : dtypes)
      accepted += (accepted.empty() ? "" : " or ") + std::string(dtypeName(dtype));
    throw Refusal(C3DE_E_ARG,
                  fmt::format("{}: dtype {} ({}), accepted: {}", name, view.dtype, dtypeName(view.dtype), accepted));
  }
  if (view.comps != comps)
    throw Refusal(C3DE_E_ARG, fmt::format("{}: comps {}, accepted: {}", name, view.comps, comps));
  const std::size_t rowBytes = comps * dtypeSize(view.dtype);
  if (view.stride != 0 && view.stride < static_cast<std::int64_t>(rowBytes))
    throw Refusal(C3DE_E_ARG,
                  fmt::format("{}: stride {}, accepted: 0 (tight) or at least {}", name, view.stride, rowBytes));
  const auto stride = view.stride == 0 ? rowBytes : static_cast<std::size_t>(view.stride);
  if (view.count > kMaxRows ||
      view.count > static_cast<std::uint64_t>(std::numeric_limits<std::ptrdiff_t>::max()) / stride)
    throw Refusal(C3DE_E_ARG, fmt::format("{}: {} rows are more than memory can hold", name, view.count));
  if (view.count > 0) requireNonNull(view.data, name);
  return {static_cast<const unsigned char *>(view.data), static_cast<std::size_t>(view.count), stride};
}

std::vector<Vec3> positionsOf(const c3de_view &view, const char *name) { return readPositions<double>(view, name); }

std::vector<Vec3f> floatPositionsOf(const c3de_view &view, const char *name) {
  return readPositions<float>(view, name);
}

std::vector<Triangle> trianglesOf(const c3de_view &view, const char *name, std::size_t vertexCount) {
  const RowLayout rows = layoutOf(view, name, 3, {C3DE_U32});
  if (rows.count == 0) throw Refusal(C3DE_E_ARG, fmt::format("{}: no rows", name));
  std::vector<Triangle> out(rows.count);
  for (std::size_t i = 0; i < rows.count; ++i) {
    readRow<unsigned, std::uint32_t>(rows.data + i * rows.stride, out[i]);
    for (const unsigned index : out[i])
      if (index >= vertexCount)
        throw Refusal(C3DE_E_ARG,
                      fmt::format("{}: row {} refers to vertex {}, there are {}", name, i, index, vertexCount));
  }
  return out;
}

std::vector<double> numbersOf(const c3de_view &view, const char *name) {
  const RowLayout rows = layoutOf(view, name, 1, {C3DE_F64, C3DE_F32});
  std::vector<double> out(rows.count);
  for (std::size_t i = 0; i < rows.count; ++i) {
    const unsigned char *row = rows.data + i * rows.stride;
    if (view.dtype == C3DE_F64) {
      std::memcpy(&out[i], row, sizeof(double));
    } else {
      float value = 0.0f;
      std::memcpy(&value, row, sizeof value);
      out[i] = static_cast<double>(value);
    }
    if (std::isnan(out[i])) throw Refusal(C3DE_E_ARG, fmt::format("{}: row {} is not a number", name, i));
  }
  return out;
}

PointRows::PointRows(const c3de_view &view, const char *name) {
  const RowLayout layout = layoutOf(view, name, 3, {C3DE_F64});
  const bool inPlace =
      layout.stride == sizeof(Vec3) && reinterpret_cast<std::uintptr_t>(layout.data) % alignof(Vec3) == 0;
  if (!inPlace) {
    copy_ = positionsOf(view, name);
    rows_ = copy_;
    return;
  }
  rows_ = {reinterpret_cast<const Vec3 *>(layout.data), layout.count};
  for (std::size_t i = 0; i < rows_.size(); ++i)
    for (const double x : rows_[i])
      if (!std::isfinite(x)) throw Refusal(C3DE_E_ARG, fmt::format("{}: row {} is not finite", name, i));
}

RowLayout outputLayoutOf(const c3de_mview &view, const char *name, const c3de_view &input, std::uint32_t dtype) {
  const RowLayout rows =
      layoutOf(c3de_view{view.data, view.count, view.comps, view.dtype, view.stride}, name, 1, {dtype});
  if (rows.count != input.count)
    throw Refusal(C3DE_E_ARG, fmt::format("{}: room for {} rows, there are {}", name, rows.count, input.count));
  const std::size_t inputRow = input.comps * dtypeSize(input.dtype);
  const RowLayout read{static_cast<const unsigned char *>(input.data), static_cast<std::size_t>(input.count),
                       input.stride == 0 ? inputRow : static_cast<std::size_t>(input.stride)};
  if (shareBytes(rows, dtypeSize(dtype), read, inputRow))
    throw Refusal(C3DE_E_ARG, fmt::format("{}: its rows overlap the input rows; accepted: separate rows", name));
  return rows;
}

}  // namespace c3de::plugin_host
