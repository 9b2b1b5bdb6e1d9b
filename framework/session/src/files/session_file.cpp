// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/session_file.h"

#include <fmt/format.h>

#include <algorithm>

#include "c3de/core/input_file.h"
#include "c3de/core/output_file.h"
#include "c3de/core/path_text.h"
#include "c3de/core/text.h"
#include "files/session_json.h"
#include "files/zip_archive.h"

namespace c3de::session {
namespace {

constexpr const char *kState = "state.bin";
constexpr std::size_t kLongestJson = std::size_t{1} << 24;

bool isEmbedded(const ReferencedFile &file, const std::map<std::string, std::string> &members) {
  const std::string name = embeddedName(file);
  const auto below = members.lower_bound(name + "/");
  return members.contains(name) || (below != members.end() && below->first.starts_with(name + "/"));
}

/// The first file that lacks its content; empty: none.
std::string lackingContent(const SessionFile &session) {
  for (const ReferencedFile &file : session.files)
    if (file.isEmbedded && !isEmbedded(file, session.members))
      return fmt::format("the file {} is embedded, but there is no member {}", displayMessage(file.path),
                         displayMessage(embeddedName(file)));
  return {};
}

}  // namespace

bool isSessionPath(const std::filesystem::path &path) { return path.extension() == ".c3de"; }

std::string embeddedName(const ReferencedFile &file) {
  std::string_view path = file.path;
  while (path.ends_with('/')) path.remove_suffix(1);
  return fmt::format("files/{}/{}", file.sha256, path.substr(path.rfind('/') + 1));
}

Expected<std::string> sessionBytes(const SessionFile &session) {
  MemberNames names;
  std::map<std::string, std::string_view> sorted(session.members.begin(), session.members.end());
  std::string twice = sorted.contains(kSessionJson) ? kSessionJson : "";
  const auto add = [&](const std::string &name, std::string_view bytes) {
    if (!sorted.emplace(name, bytes).second) twice = name;
  };
  for (std::size_t i = 0; i < session.scenes.size(); ++i)
    add(names.scenes.emplace_back(fmt::format("scenes/{}.toml", i + 1)), session.scenes[i]);
  for (std::size_t i = 0; i < session.changes.size(); ++i)
    add(names.changes.emplace_back(fmt::format("changes/{}.bin", i + 1)), session.changes[i].bytes);
  if (!session.state.empty()) add(names.state = kState, session.state);
  if (!twice.empty())
    return fail(ErrorCode::usage, fmt::format("the name {} is that of a member which the program writes", twice));
  if (const std::string lacking = lackingContent(session); !lacking.empty()) return fail(ErrorCode::usage, lacking);
  for (const auto &[name, bytes] : sorted) names.all.insert(name);

  const auto json = sessionJson(session, names);
  if (!json) return tl::unexpected(json.error());
  if (json->size() > kLongestJson)
    return fail(ErrorCode::usage,
                fmt::format("{} would have {} bytes; accepted: up to {}", kSessionJson, json->size(), kLongestJson));
  std::vector<ZipMember> members{{kSessionJson, *json}};
  for (const auto &[name, bytes] : sorted) members.push_back({name, bytes});
  return zipBytes(members);
}

Expected<void> writeSession(const SessionFile &session, const std::filesystem::path &path) {
  const auto bytes = sessionBytes(session);
  if (!bytes)
    return fail(bytes.error().code, fmt::format("{}: could not be saved: {}", pathText(path), bytes.error().message));
  return writeWholeFile(path, *bytes, Durability::strict);
}

Expected<SessionFile> readSession(const std::filesystem::path &path) {
  auto in = openInputFile(path);
  if (!in) return tl::unexpected(in.error());
  return readSession(*in, pathText(path));
}

Expected<SessionFile> readSession(std::istream &in, const std::string &file) {
  auto members = readZip(in, file);
  if (!members) return tl::unexpected(members.error());
  const auto json = members->find(kSessionJson);
  if (json == members->end())
    return fail(ErrorCode::input, fmt::format("{}: is no session: it has no member {}", file, kSessionJson));
  if (json->second.size() > kLongestJson)
    return fail(ErrorCode::input, fmt::format("{}: {} has {} bytes; accepted: up to {}", file, kSessionJson,
                                              json->second.size(), kLongestJson));
  auto parsed = parseSessionJson(json->second);
  if (!parsed) return fail(parsed.error().code, fmt::format("{}: {}: {}", file, kSessionJson, parsed.error().message));
  auto &[session, names] = *parsed;
  members->erase(json);
  for (const std::string &name : names.all)
    if (!members->contains(name))
      return fail(ErrorCode::input,
                  fmt::format("{}: is damaged: the member '{}' is missing", file, displayMessage(name)));
  for (const std::string &name : names.scenes) session.scenes.push_back(members->at(name));
  for (std::size_t i = 0; i < names.changes.size(); ++i) session.changes[i].bytes = members->at(names.changes[i]);
  if (!names.state.empty()) session.state = std::move(members->at(names.state));
  for (const std::string &name : names.scenes) members->erase(name);
  for (const std::string &name : names.changes) members->erase(name);
  if (!names.state.empty()) members->erase(names.state);
  session.members = std::move(*members);
  if (const std::string lacking = lackingContent(session); !lacking.empty())
    return fail(ErrorCode::input, fmt::format("{}: is damaged: {}", file, lacking));
  return std::move(session);
}

}  // namespace c3de::session
