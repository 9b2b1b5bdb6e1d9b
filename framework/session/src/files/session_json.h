// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <string>
#include <vector>

#include "c3de/session/session_file.h"

namespace c3de::session {

inline constexpr const char *kSessionJson = "session.json";

/// Names of the members that session.json lists.
struct MemberNames {
  std::vector<std::string> scenes;   ///< in the order of SessionFile::scenes
  std::vector<std::string> changes;  ///< in the order of SessionFile::changes
  std::string state;                 ///< empty: the initial state
  std::set<std::string> all;         ///< except session.json; without one of them a session is damaged
};

/// The text of session.json. Errors (usage): a text that is not UTF-8, a number that is not finite, a path twice, an
/// unknown key that is no JSON or has the name of a known one.
[[nodiscard]] Expected<std::string> sessionJson(const SessionFile &session, const MemberNames &names);

struct ParsedSession {
  SessionFile session;  ///< without the content of members
  MemberNames names;
};
/// Errors (input) without the name of the file: no JSON, a newer format, a key of the wrong type.
[[nodiscard]] Expected<ParsedSession> parseSessionJson(const std::string &text);

}  // namespace c3de::session
