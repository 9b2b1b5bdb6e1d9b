// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <map>
#include <string>
#include <string_view>

#include "c3de/core/expected.h"

namespace c3de::session {

inline constexpr std::uint64_t kMostZipMembers = 100'000;

/// Reason why a member may not have this name: empty, absolute, with "..", a backslash, a drive or control characters,
/// not UTF-8, too long. Empty: it may.
[[nodiscard]] std::string refusedMemberName(std::string_view name);

struct ZipLimits {
  std::uint64_t bytes = std::uint64_t{1} << 34;  ///< of all members that are read, unpacked
  std::uint64_t members = kMostZipMembers;
  std::function<bool(const std::string &name)> skips;  ///< members that are not read; empty: none
};

/// All members by name, without folders. Sizes are compared with the limits, the free memory and the size of the file
/// before anything is unpacked. Errors name file and member (input): no zip, truncated, damaged, encrypted, packed by
/// another method than deflate, a refused name, a name twice, too large. Any thread.
[[nodiscard]] Expected<std::map<std::string, std::string>> readZip(const std::filesystem::path &file,
                                                                   const ZipLimits &limits = {});
/// The same from an open file or memory. @param name  for messages
[[nodiscard]] Expected<std::map<std::string, std::string>> readZip(std::istream &in, const std::string &name,
                                                                   const ZipLimits &limits = {});

/// Name and size of every member that is no folder, without reading one. Errors: as readZip(), except those of content
/// and memory.
[[nodiscard]] Expected<std::map<std::string, std::uint64_t>> listZip(std::istream &in, const std::string &name);

/// Receives the content of a member in pieces; an empty piece ends it.
using TakePiece = std::function<Expected<void>(std::string_view)>;
/// Reads members in pieces, in the order of the archive. Errors: as readZip(), and those of the functions.
/// @param takerOf  is asked for every member; an empty function: the member is skipped
[[nodiscard]] Expected<void> streamZip(std::istream &in, const std::string &name,
                                       const std::function<Expected<TakePiece>(const std::string &member)> &takerOf);

}  // namespace c3de::session
