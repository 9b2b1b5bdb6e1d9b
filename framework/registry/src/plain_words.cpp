// SPDX-License-Identifier: Apache-2.0
#include "c3de/registry/plain_words.h"

#include <algorithm>
#include <cctype>

namespace c3de::registry {
namespace {

bool isLetter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }
bool isOfWord(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }
bool isOfToken(char c) { return isOfWord(c) || c == '.' || c == '/' || c == '-' || c == '\\'; }

/// "solver.dt": words separated by dots, each beginning with a letter.
bool isDotted(std::string_view token) {
  bool hasDot = false;
  for (std::size_t i = 0; i < token.size(); ++i) {
    if (!isOfWord(token[i]) && token[i] != '.') return false;
    if (token[i] != '.') continue;
    hasDot = true;
    if (i == 0 || i + 1 == token.size() || !isLetter(token[i + 1])) return false;
  }
  return hasDot && isLetter(token.front());
}

/// "c3de.iface.simulator/1": a dotted name followed by a slash and a number.
bool isInterfaceId(std::string_view token) {
  const std::size_t stroke = token.rfind('/');
  if (stroke == std::string_view::npos || stroke + 1 == token.size()) return false;
  const std::string_view number = token.substr(stroke + 1), name = token.substr(0, stroke);
  const bool isNumber = std::all_of(number.begin(), number.end(),
                                    [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; });
  constexpr std::string_view kDraft = "draft/";
  return isNumber && isDotted(name.substr(0, kDraft.size()) == kDraft ? name.substr(kDraft.size()) : name);
}

std::string inMarks(std::string_view label) { return "“" + std::string(label) + "”"; }

/// The words for a token; the token itself if it is no id.
std::string wordsFor(std::string_view token, const ParameterRegistry &parameters) {
  if (isInterfaceId(token)) return "an interface of the program";
  if (!isDotted(token)) return std::string(token);
  const std::string_view table = token.substr(0, token.find('.'));
  bool isOfATable = false;
  std::string label;
  parameters.forEach([&](const ParameterSet &set) {
    for (const ParameterDecl &decl : set.decls) {
      if (decl.id == token && !decl.label.empty()) label = decl.label;
      isOfATable = isOfATable || (decl.id.size() > table.size() && decl.id[table.size()] == '.' &&
                                  std::string_view(decl.id).substr(0, table.size()) == table);
    }
  });
  if (!label.empty()) return inMarks(label);
  if (!isOfATable) return std::string(token);
  std::string key(token.substr(token.rfind('.') + 1));
  std::replace(key.begin(), key.end(), '_', ' ');
  return inMarks(key);
}

/// "scene.toml:3: unknown key 'world.gravty'": keys as they are written in the file.
bool quotesSceneFile(std::string_view text) {
  constexpr std::string_view kEnding = ".toml:";
  const std::size_t at = text.find(kEnding), line = at + kEnding.size();
  return at != std::string_view::npos && line < text.size() &&
         std::isdigit(static_cast<unsigned char>(text[line])) != 0;
}

}  // namespace

std::string plainWords(std::string_view text, const ParameterRegistry &parameters) {
  if (quotesSceneFile(text)) return std::string(text);
  std::string out;
  for (std::size_t i = 0; i < text.size();) {
    if (!isOfToken(text[i])) {
      out += text[i++];
      continue;
    }
    std::size_t end = i;
    while (end < text.size() && isOfToken(text[end])) ++end;
    // The full stop of a sentence is not part of the word before it.
    std::size_t last = end;
    while (last > i && (text[last - 1] == '.' || text[last - 1] == '/')) --last;
    out += wordsFor(text.substr(i, last - i), parameters);
    out += text.substr(last, end - last);
    i = end;
  }
  return out;
}

}  // namespace c3de::registry
