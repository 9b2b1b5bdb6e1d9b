// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/session_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

#include "c3de/core/input_file.h"
#include "c3de/core/output_file.h"
#include "c3de/core/path_text.h"
#include "c3de/core/text.h"
#include "files/embedded_names.h"
#include "files/file_hash.h"
#include "files/session_json.h"
#include "files/zip_archive.h"
#include "files/zip_writer.h"

namespace c3de::session {
namespace {

constexpr const char *kState = "state.bin";
constexpr std::size_t kLongestJson = std::size_t{1} << 24;

template <class Members>
bool hasContent(const std::string &name, const Members &members) {
  const auto below = members.lower_bound(name + "/");
  return members.contains(name) || (below != members.end() && below->first.starts_with(name + "/"));
}

/// The first file that lacks its content; empty: none.
std::string lackingContent(const SessionFile &session) {
  for (const ReferencedFile &file : session.files)
    if (const std::string name = embeddedName(file);
        file.isEmbedded && !hasContent(name, session.members) && !hasContent(name, session.embedded))
      return fmt::format("the file {} is embedded, but there is no member {}", displayMessage(file.path),
                         displayMessage(name));
  return {};
}

/// Members in memory and session.json, of which the names are those of all.
struct PackedMembers {
  std::string json;
  std::map<std::string, std::string_view> sorted;  ///< without session.json
};

Expected<PackedMembers> membersOf(const SessionFile &session) {
  MemberNames names;
  PackedMembers packed;
  packed.sorted.insert(session.members.begin(), session.members.end());
  std::string twice = packed.sorted.contains(kSessionJson) ? kSessionJson : "";
  const auto add = [&](const std::string &name, std::string_view bytes) {
    if (!packed.sorted.emplace(name, bytes).second) twice = name;
  };
  for (std::size_t i = 0; i < session.scenes.size(); ++i)
    add(names.scenes.emplace_back(fmt::format("scenes/{}.toml", i + 1)), session.scenes[i]);
  for (std::size_t i = 0; i < session.changes.size(); ++i)
    add(names.changes.emplace_back(fmt::format("changes/{}.bin", i + 1)), session.changes[i].bytes);
  if (!session.state.empty()) add(names.state = kState, session.state);
  for (const auto &[name, file] : session.embedded)
    if (packed.sorted.contains(name) || name == kSessionJson) twice = name;
  if (!twice.empty())
    return fail(ErrorCode::usage, fmt::format("the name {} is that of a member which the program writes", twice));
  if (const std::string lacking = lackingContent(session); !lacking.empty()) return fail(ErrorCode::usage, lacking);
  for (const auto &[name, bytes] : packed.sorted) names.all.insert(name);
  for (const auto &[name, file] : session.embedded) names.all.insert(name);

  auto json = sessionJson(session, names);
  if (!json) return tl::unexpected(json.error());
  if (json->size() > kLongestJson)
    return fail(ErrorCode::usage,
                fmt::format("{} would have {} bytes; accepted: up to {}", kSessionJson, json->size(), kLongestJson));
  packed.json = std::move(*json);
  return packed;
}

/// Writes the members of a session to a zip, those of files on disk in pieces.
class SessionPacker {
 public:
  SessionPacker(const SessionFile &session, ZipWriter &zip, const ProgressFn &progress)
      : session_(session), zip_(zip), bytes_(progress, totalOf(session), "Writing") {}

  Expected<void> pack() {
    const auto members = membersOf(session_);
    if (!members) return tl::unexpected(members.error());
    if (auto added = add(kSessionJson, members->json); !added) return added;
    auto file = session_.embedded.begin();
    const auto addFilesBefore = [&](const std::string *name) -> Expected<void> {
      for (; file != session_.embedded.end() && (name == nullptr || file->first < *name); ++file)
        if (auto added = addFile(file->first, file->second); !added) return added;
      return {};
    };
    for (const auto &[name, bytes] : members->sorted) {
      if (auto added = addFilesBefore(&name); !added) return added;
      if (auto added = add(name, bytes); !added) return added;
    }
    if (auto added = addFilesBefore(nullptr); !added) return added;
    if (auto same = checkHashes(); !same) return same;
    zip_.finish();
    return {};
  }

 private:
  static std::uint64_t totalOf(const SessionFile &session) {
    std::uint64_t total = 0;
    std::error_code code;
    for (const auto &[name, file] : session.embedded)
      if (const std::uintmax_t size = std::filesystem::file_size(file, code); !code) total += size;
    return total;
  }
  Expected<void> add(const std::string &name, std::string_view bytes) {
    if (auto begun = zip_.begin(name, bytes.size()); !begun) return begun;
    if (auto added = zip_.add(bytes); !added) return added;
    return zip_.end();
  }
  Expected<void> addFile(const std::string &name, const std::filesystem::path &path) {
    constexpr std::size_t kPiece = std::size_t{1} << 20;
    auto in = openInputFile(path);
    if (!in) return tl::unexpected(in.error());
    std::error_code code;
    if (auto begun = zip_.begin(name, std::filesystem::file_size(path, code)); !begun) return begun;
    Sha256 hash;
    std::string piece(kPiece, '\0');
    do {
      in->read(piece.data(), static_cast<std::streamsize>(piece.size()));
      const std::string_view read = std::string_view(piece).substr(0, static_cast<std::size_t>(in->gcount()));
      hash.add(read);
      if (auto added = zip_.add(read); !added) return added;
      if (auto goesOn = bytes_.add(read.size(), pathText(path.filename())); !goesOn) return goesOn;
    } while (*in);
    if (in->bad()) return fail(ErrorCode::input, pathText(path) + ": cannot be read");
    auto digits = hash.digits();
    if (!digits) return tl::unexpected(digits.error());
    hashes_.emplace(name, std::move(*digits));
    return zip_.end();
  }
  /// Files may have changed since they were referred to.
  Expected<void> checkHashes() const {
    for (const ReferencedFile &file : session_.files) {
      const std::string name = embeddedName(file);
      if (!file.isEmbedded || !hasContent(name, session_.embedded)) continue;
      const auto hash = embeddedHash(name, hashes_);
      if (!hash) return tl::unexpected(hash.error());
      if (*hash != file.sha256)
        return fail(ErrorCode::input, displayMessage(file.path) + ": has changed while it was saved");
    }
    return {};
  }

  const SessionFile &session_;
  ZipWriter &zip_;
  ByteProgress bytes_;
  std::map<std::string, std::string> hashes_;
};

}  // namespace

bool isSessionPath(const std::filesystem::path &path) { return path.extension() == ".c3de"; }

std::string embeddedName(const ReferencedFile &file) {
  if (isEmbeddedPath(file.path)) return file.path;
  std::string_view path = file.path;
  while (path.ends_with('/')) path.remove_suffix(1);
  return fmt::format("files/{}/{}", file.sha256, path.substr(path.rfind('/') + 1));
}

Expected<std::string> embeddedHash(const std::string &name, const std::map<std::string, std::string> &hashes) {
  if (const auto file = hashes.find(name); file != hashes.end()) return file->second;
  Sha256 hash;
  const std::string folder = name + "/";
  for (auto file = hashes.lower_bound(folder); file != hashes.end() && file->first.starts_with(folder); ++file)
    hash.add(lineOfFolder(file->second, file->first.substr(folder.size())));
  return hash.digits();
}

Expected<void> packSession(const SessionFile &session, const std::function<void(std::string_view)> &sink,
                           const ProgressFn &progress) {
  ZipWriter zip(sink);
  return SessionPacker(session, zip, progress).pack();
}

Expected<std::string> sessionBytes(const SessionFile &session) {
  std::string bytes;
  if (auto packed = packSession(session, [&bytes](std::string_view piece) { bytes += piece; }); !packed)
    return tl::unexpected(packed.error());
  return bytes;
}

Expected<void> writeSession(const SessionFile &session, const std::filesystem::path &path, const ProgressFn &progress) {
  auto out = OutputFile::open(path, Durability::strict);
  if (!out) return tl::unexpected(out.error());
  const auto packed = packSession(
      session, [&out](std::string_view bytes) { out->write(bytes); }, progress);
  if (packed) return out->commit();
  if (packed.error().code == ErrorCode::cancelled) return packed;
  return fail(packed.error().code, fmt::format("{}: could not be saved: {}", pathText(path), packed.error().message));
}

Expected<SessionFile> readSession(const std::filesystem::path &path, EmbeddedContent content) {
  auto in = openInputFile(path);
  if (!in) return tl::unexpected(in.error());
  return readSession(*in, pathText(path), content);
}

namespace {

/// session.json and all members that are not left in the archive.
struct ReadMembers {
  ParsedSession parsed;
  std::map<std::string, std::string> members;
};

Expected<ReadMembers> readMembers(std::istream &in, const std::string &file, EmbeddedContent content) {
  ZipLimits onlyJson;
  onlyJson.skips = [](const std::string &name) { return name != kSessionJson; };
  const auto first = readZip(in, file, onlyJson);
  if (!first) return tl::unexpected(first.error());
  const auto json = first->find(kSessionJson);
  if (json == first->end())
    return fail(ErrorCode::input, fmt::format("{}: is no session: it has no member {}", file, kSessionJson));
  if (json->second.size() > kLongestJson)
    return fail(ErrorCode::input, fmt::format("{}: {} has {} bytes; accepted: up to {}", file, kSessionJson,
                                              json->second.size(), kLongestJson));
  auto parsed = parseSessionJson(json->second);
  if (!parsed) return fail(parsed.error().code, fmt::format("{}: {}: {}", file, kSessionJson, parsed.error().message));
  std::set<std::string> embedded;
  for (const ReferencedFile &one : parsed->session.files)
    if (one.isEmbedded && content == EmbeddedContent::stays) embedded.insert(embeddedName(one));
  ZipLimits rest;
  rest.skips = [&embedded](const std::string &name) {
    if (name == kSessionJson) return true;
    // The name itself, or that of a folder above it.
    for (std::size_t end = name.size(); end != std::string::npos && end > 0; end = name.rfind('/', end - 1))
      if (embedded.contains(name.substr(0, end))) return true;
    return false;
  };
  auto members = readZip(in, file, rest);
  if (!members) return tl::unexpected(members.error());
  if (!embedded.empty()) {
    const auto names = listZip(in, file);
    if (!names) return tl::unexpected(names.error());
    for (const auto &[name, bytes] : *names)
      if (name != kSessionJson && rest.skips(name)) parsed->session.embedded.emplace(name, std::filesystem::path());
  }
  return ReadMembers{std::move(*parsed), std::move(*members)};
}

}  // namespace

Expected<SessionFile> readSession(std::istream &in, const std::string &file, EmbeddedContent content) {
  auto read = readMembers(in, file, content);
  if (!read) return tl::unexpected(read.error());
  auto &[session, names] = read->parsed;
  auto &members = read->members;
  for (const std::string &name : names.all)
    if (!members.contains(name) && !session.embedded.contains(name))
      return fail(ErrorCode::input,
                  fmt::format("{}: is damaged: the member '{}' is missing", file, displayMessage(name)));
  const auto lacksInMemory = [&](const std::string &name) { return !members.contains(name); };
  for (const auto *list : {&names.scenes, &names.changes})
    if (const auto embedded = std::find_if(list->begin(), list->end(), lacksInMemory); embedded != list->end())
      return fail(ErrorCode::input, fmt::format("{}: is damaged: the member '{}' is that of an embedded file", file,
                                                displayMessage(*embedded)));
  if (!names.state.empty() && lacksInMemory(names.state))
    return fail(ErrorCode::input, fmt::format("{}: is damaged: the member '{}' is that of an embedded file", file,
                                              displayMessage(names.state)));
  for (const std::string &name : names.scenes) session.scenes.push_back(members.at(name));
  for (std::size_t i = 0; i < names.changes.size(); ++i) session.changes[i].bytes = members.at(names.changes[i]);
  if (!names.state.empty()) session.state = std::move(members.at(names.state));
  for (const std::string &name : names.scenes) members.erase(name);
  for (const std::string &name : names.changes) members.erase(name);
  if (!names.state.empty()) members.erase(names.state);
  session.members = std::move(members);
  if (const std::string lacking = lackingContent(session); !lacking.empty())
    return fail(ErrorCode::input, fmt::format("{}: is damaged: {}", file, lacking));
  return std::move(session);
}

}  // namespace c3de::session
