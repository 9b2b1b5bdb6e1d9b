// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <string_view>

#include "c3de/core/expected.h"

namespace c3de::session {

/// Writes a zip from its first byte to its last, in pieces: sizes and checksums follow their members. minizip would go
/// back to enter them, which a file that appears complete (OutputFile) does not permit. The same members give the same
/// bytes. One thread at a time.
class ZipWriter {
 public:
  using Sink = std::function<void(std::string_view)>;
  explicit ZipWriter(Sink sink);
  ~ZipWriter();
  ZipWriter(const ZipWriter &) = delete;
  ZipWriter &operator=(const ZipWriter &) = delete;

  /// Begins a member. Errors (usage): a refused name, a name twice, more than kMostZipMembers.
  /// @param expectedBytes  its size, as far as known: members of 4 GiB and more have another header
  [[nodiscard]] Expected<void> begin(std::string_view name, std::uint64_t expectedBytes);
  /// Errors: output, if there is no memory.
  [[nodiscard]] Expected<void> add(std::string_view bytes);
  /// Ends the member. Errors: as add(); usage, if it has become larger than its header permits.
  [[nodiscard]] Expected<void> end();
  /// Writes the list of members.
  void finish();

 private:
  struct Deflater;
  [[nodiscard]] Expected<void> deflate(bool isLast);

  Sink sink_;
  std::unique_ptr<Deflater> deflater_;
  std::set<std::string, std::less<>> names_;
  std::string list_;  ///< of members, written at the end
  std::string name_;  ///< of the present member
  std::uint64_t written_ = 0, begin_ = 0, unpacked_ = 0, packed_ = 0;
  std::uint32_t checksum_ = 0;
  bool isLarge_ = false;
};

struct ZipMember {
  std::string_view name;  ///< UTF-8, forward slashes
  std::string_view bytes;
};
/// A zip of these members in memory, in this order. Errors: as ZipWriter.
[[nodiscard]] Expected<std::string> zipBytes(std::span<const ZipMember> members);

}  // namespace c3de::session
