// SPDX-License-Identifier: Apache-2.0
// Changes as bytes: little-endian numbers in the order of each change's walk(), which writes and reads them.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "c3de/sdk/result.hpp"
#include "pointbased/types.h"

namespace pointbased {

namespace sdk = c3de::sdk;

class ByteWriter {
 public:
  static constexpr bool kReads = false;
  template <class Unsigned>
  void number(Unsigned &value) {
    for (std::size_t i = 0; i < sizeof value; ++i)
      bytes_.push_back(static_cast<char>((static_cast<std::uint64_t>(value) >> (8 * i)) & 0xffu));
  }
  void text(std::string &value) {
    auto size = static_cast<std::uint64_t>(value.size());
    number(size);
    bytes_ += value;
  }
  [[nodiscard]] const std::string &bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

/// Throws sdk::Error C3DE_E_FORMAT where the bytes end too early.
class ByteReader {
 public:
  static constexpr bool kReads = true;
  explicit ByteReader(std::string_view bytes) : left_(bytes) {}
  template <class Unsigned>
  void number(Unsigned &value) {
    std::uint64_t read = 0;
    const std::string_view bytes = take(sizeof value);
    for (std::size_t i = 0; i < sizeof value; ++i)
      read |= static_cast<std::uint64_t>(static_cast<unsigned char>(bytes[i])) << (8 * i);
    value = static_cast<Unsigned>(read);
  }
  void text(std::string &value) {
    std::uint64_t size = 0;
    number(size);
    value = std::string(take(size));
  }
  [[nodiscard]] std::size_t left() const { return left_.size(); }
  void expectEnd() const {
    if (!left_.empty()) throw sdk::Error(C3DE_E_FORMAT, "bytes follow the end of the change");
  }

 private:
  std::string_view take(std::uint64_t n) {
    if (n > left_.size()) throw sdk::Error(C3DE_E_FORMAT, "the bytes of the change end too early");
    const std::string_view taken = left_.substr(0, static_cast<std::size_t>(n));
    left_.remove_prefix(taken.size());
    return taken;
  }
  std::string_view left_;
};

/// Passed to walk(): coder(a, b, c) writes or reads members in this order. Types of others have a free walk().
template <class Bytes>
class Coder {
 public:
  static constexpr bool kReads = Bytes::kReads;
  explicit Coder(Bytes &bytes) : bytes_(bytes) {}

  template <class... T>
  void operator()(T &...values) {
    (one(values), ...);
  }
  /// Of a reader: nothing is left.
  [[nodiscard]] bool isAtEnd() const {
    if constexpr (kReads) return bytes_.left() == 0;
    return false;
  }

 private:
  template <class T>
  void one(T &value) {
    if constexpr (std::is_same_v<T, bool>) {
      std::uint8_t byte = value ? 1 : 0;
      bytes_.number(byte);
      if (byte > 1) throw sdk::Error(C3DE_E_FORMAT, "a truth value of the change is neither 0 nor 1");
      value = byte != 0;
    } else if constexpr (std::is_floating_point_v<T>) {
      auto bits = std::bit_cast<std::conditional_t<sizeof(T) == 8, std::uint64_t, std::uint32_t>>(value);
      bytes_.number(bits);
      value = std::bit_cast<T>(bits);
    } else if constexpr (std::is_unsigned_v<T>) {
      bytes_.number(value);
    } else if constexpr (requires { value.walk(*this); }) {
      value.walk(*this);
    } else {
      walk(*this, value);
    }
  }
  void one(std::string &value) { bytes_.text(value); }
  template <int kRows, int kColumns>
  void one(Eigen::Matrix<double, kRows, kColumns> &matrix) {
    for (Eigen::Index i = 0; i < matrix.size(); ++i) one(matrix.data()[i]);
  }
  template <class T, std::size_t n>
  void one(std::array<T, n> &values) {
    for (T &value : values) one(value);
  }
  template <class T>
  void one(std::optional<T> &value) {
    bool has = value.has_value();
    one(has);
    if constexpr (kReads) value = has ? std::optional<T>(T()) : std::nullopt;
    if (value) one(*value);
  }
  template <class T>
  void one(std::vector<T> &values) {
    auto size = static_cast<std::uint64_t>(values.size());
    bytes_.number(size);
    if constexpr (kReads) {
      values.clear();
      // A damaged size is not allocated: elements are added while there are bytes.
      if (size <= bytes_.left() / sizeof(T)) values.reserve(static_cast<std::size_t>(size));
      for (std::uint64_t i = 0; i < size; ++i) one(values.emplace_back());
    } else {
      for (T &value : values) one(value);
    }
  }

  Bytes &bytes_;
};

template <class Change>
[[nodiscard]] std::string bytesOf(Change &change) {
  ByteWriter writer;
  Coder coder(writer);
  change.walk(coder);
  return writer.bytes();
}

/// Throws sdk::Error C3DE_E_FORMAT.
template <class Change>
[[nodiscard]] Change changeOf(std::string_view bytes) {
  ByteReader reader(bytes);
  Coder coder(reader);
  Change change;
  change.walk(coder);
  reader.expectEnd();
  return change;
}

}  // namespace pointbased
