// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/preferences.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <iterator>

#include "c3de/core/input_file.h"
#include "c3de/core/output_file.h"
#include "c3de/core/path_text.h"
#include "c3de/core/platform.h"
#include "c3de/core/text.h"
#include "logic/config_text.h"
#include "logic/row_search.h"

namespace c3de::ui {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kLargestConfig = std::uintmax_t{1} << 20;
constexpr const char *kRules = "window_level";
constexpr const char *kHead =
    "# Preferences of C3DE. The program changes only the values that you change in it.\n"
    "# What is accepted: the page preferences.md of the guide.\n";

/// A key of the file. `read` returns what is accepted if the value is not.
struct ConfigKey {
  const char *block, *name;
  std::function<std::string(std::string_view value, Preferences &into)> read;
  std::function<std::string(const Preferences &from)> written;
};

template <typename Choice>
ConfigKey choiceKey(const char *block, const char *name, std::vector<std::string> names,
                    std::function<Choice &(Preferences &)> at) {
  ConfigKey key{block, name, {}, {}};
  key.read = [names, at](std::string_view value, Preferences &into) {
    const auto text = stringOf(value);
    const auto found = text ? std::find(names.begin(), names.end(), *text) : names.end();
    if (found != names.end()) {
      at(into) = static_cast<Choice>(found - names.begin());
      return std::string();
    }
    std::string accepted;
    for (const std::string &one : names) accepted += (accepted.empty() ? "" : ", ") + quotedValue(one);
    const std::string nearest = text ? nearestName(*text, names) : std::string();
    return accepted + (nearest.empty() ? "" : "; did you mean " + quotedValue(nearest) + "?");
  };
  key.written = [names, at](const Preferences &from) {
    Preferences copy = from;
    return quotedValue(names[static_cast<std::size_t>(at(copy))]);
  };
  return key;
}

ConfigKey numberKey(const char *block, const char *name, double Preferences::*at, double least, double most,
                    const char *unit) {
  ConfigKey key{block, name, {}, {}};
  key.read = [=](std::string_view value, Preferences &into) {
    const auto number = numberOf(value);
    if (!number || *number < least || *number > most) return fmt::format("{:g} to {:g} {}", least, most, unit);
    into.*at = *number;
    return std::string();
  };
  key.written = [at](const Preferences &from) { return formatNumber(from.*at); };
  return key;
}

ConfigKey foldersKey(const char *name, std::vector<std::string> Preferences::*at) {
  ConfigKey key{"files", name, {}, {}};
  key.read = [at](std::string_view value, Preferences &into) {
    auto folders = stringsOf(value);
    if (!folders) return std::string("a list of folders, [\"/first\", \"/second\"]");
    into.*at = std::move(*folders);
    return std::string();
  };
  key.written = [at](const Preferences &from) { return listValue(from.*at); };
  return key;
}

const std::vector<ConfigKey> &keys() {
  using Units = DisplayUnits;
  static const std::vector<ConfigKey> all = [] {
    ConfigKey folder{"files", "folder", {}, {}};
    folder.read = [](std::string_view value, Preferences &into) {
      const auto text = stringOf(value);
      if (!text) return std::string("a folder in quotation marks");
      into.folder = *text;
      return std::string();
    };
    folder.written = [](const Preferences &from) { return quotedValue(from.folder); };
    return std::vector<ConfigKey>{
        choiceKey<ThemeKind>("appearance", "theme", {"dark", "light"},
                             [](Preferences &p) -> ThemeKind & { return p.theme; }),
        numberKey("appearance", "font_size", &Preferences::fontSize_px, Preferences::kSmallestFont,
                  Preferences::kLargestFont, "pixels"),
        choiceKey<Units::Length>("units", "length", {"mm", "cm"},
                                 [](Preferences &p) -> Units::Length & { return p.units.length; }),
        choiceKey<Units::Pressure>("units", "pressure", {"kPa", "mmHg", "Pa"},
                                   [](Preferences &p) -> Units::Pressure & { return p.units.pressure; }),
        choiceKey<Units::Force>("units", "force", {"N", "mN"},
                                [](Preferences &p) -> Units::Force & { return p.units.force; }),
        folder,
        foldersKey("bookmarks", &Preferences::bookmarks),
        foldersKey("recent_folders", &Preferences::recentFolders),
        numberKey("autosave", "interval_s", &Preferences::autosave_s, Preferences::kShortestAutosave_s,
                  Preferences::kLongestAutosave_s, "s"),
    };
  }();
  return all;
}

std::string didYouMean(const std::string &name, const std::vector<std::string> &known) {
  const std::string nearest = nearestName(name, known);
  return nearest.empty() ? std::string() : "; did you mean '" + nearest + "'?";
}

std::string joined(const std::vector<std::string> &names) {
  std::string out;
  for (const std::string &name : names) out += (out.empty() ? "" : ", ") + name;
  return out;
}

/// Reads one block [[window_level]]. None: it is not understood, and `problem` gets each reason.
std::optional<WindowLevelRule> ruleOf(const ConfigText::Block &block,
                                      const std::function<void(std::size_t line, const std::string &)> &problem) {
  static const std::vector<std::string> kKeys{"name_contains", "centre", "width"};
  WindowLevelRule rule;
  bool isGood = true;
  const auto refuse = [&](std::size_t line, const std::string &why) {
    problem(line, why);
    isGood = false;
  };
  for (const ConfigText::Entry &entry : block.entries) {
    const std::string shown = std::string(kRules) + "." + entry.key + " = " + entry.value;
    if (std::find(kKeys.begin(), kKeys.end(), entry.key) == kKeys.end())
      problem(entry.line, shown + ": unknown key" + didYouMean(entry.key, kKeys) + "; accepted: " + joined(kKeys));
  }
  const ConfigText::Entry *words = block.find("name_contains"), *centre = block.find("centre"),
                          *width = block.find("width");
  for (const auto &[key, entry] : {std::pair{"name_contains", words}, {"centre", centre}, {"width", width}})
    if (!entry) refuse(block.line, std::string("[[window_level]]: ") + key + " is missing; accepted: " + joined(kKeys));
  if (!isGood) return std::nullopt;
  const auto text = stringOf(words->value);
  if (text && text->find_first_not_of(' ') != std::string::npos)
    rule.words = *text;
  else
    refuse(words->line, "window_level.name_contains = " + words->value + ": accepted: words in quotation marks");
  if (const auto number = numberOf(centre->value))
    rule.centre = *number;
  else
    refuse(centre->line, "window_level.centre = " + centre->value + ": accepted: a number, for CT in HU");
  if (const auto number = numberOf(width->value); number && *number > 0.0)
    rule.width = *number;
  else
    refuse(width->line, "window_level.width = " + width->value + ": accepted: a number above 0, for CT in HU");
  return isGood ? std::optional(rule) : std::nullopt;
}

std::string ruleText(const WindowLevelRule &rule) {
  return "name_contains = " + quotedValue(rule.words) + "\ncentre = " + formatNumber(rule.centre) +
         "\nwidth = " + formatNumber(rule.width) + "\n";
}

/// The blocks that are rules, by index.
std::vector<std::size_t> ruleBlocks(const ConfigText &config) {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < config.blocks().size(); ++i) {
    const ConfigText::Block &block = config.blocks()[i];
    if (block.isOfList && block.name == kRules && ruleOf(block, [](std::size_t, const std::string &) {}))
      found.push_back(i);
  }
  return found;
}

/// Keeps the blocks of rules that stay, with their comments and unknown keys.
void writeRules(ConfigText &config, const std::vector<WindowLevelRule> &rules) {
  const auto ruleAt = [&](std::size_t block) {
    return *ruleOf(config.blocks()[block], [](std::size_t, const std::string &) {});
  };
  std::vector<std::size_t> blocks = ruleBlocks(config);
  std::size_t same = 0;
  while (same < blocks.size() && same < rules.size() && ruleAt(blocks[same]) == rules[same]) ++same;
  std::size_t sameAtEnd = 0;
  while (sameAtEnd + same < std::min(blocks.size(), rules.size()) &&
         ruleAt(blocks[blocks.size() - 1 - sameAtEnd]) == rules[rules.size() - 1 - sameAtEnd])
    ++sameAtEnd;
  // What is too much is between those that stay.
  while (blocks.size() > rules.size()) {
    config.removeBlock(blocks[blocks.size() - 1 - sameAtEnd]);
    blocks = ruleBlocks(config);
  }
  for (std::size_t i = 0; i < rules.size(); ++i) {
    if (i >= blocks.size()) {
      config.addToList(kRules, ruleText(rules[i]));
    } else if (ruleAt(blocks[i]) != rules[i]) {
      config.setIn(blocks[i], "name_contains", quotedValue(rules[i].words));
      config.setIn(blocks[i], "centre", formatNumber(rules[i].centre));
      config.setIn(blocks[i], "width", formatNumber(rules[i].width));
    }
  }
}

/// Why a key, or its header, is not known.
std::string unknownKey(const std::string &block, const std::string &key) {
  std::vector<std::string> blocks, names;
  for (const ConfigKey &one : keys()) {
    if (std::find(blocks.begin(), blocks.end(), one.block) == blocks.end()) blocks.emplace_back(one.block);
    if (one.block == block) names.emplace_back(one.name);
  }
  if (!names.empty()) return "unknown key" + didYouMean(key, names) + "; accepted: " + joined(names);
  std::vector<std::string> headers;
  for (const std::string &one : blocks) headers.push_back("[" + one + "]");
  headers.emplace_back("[[window_level]]");
  blocks.emplace_back(kRules);
  if (block.empty()) return "a key above all headers; accepted below " + joined(headers);
  return "unknown header [" + block + "]" + didYouMean(block, blocks) + "; accepted: " + joined(headers);
}

/// None: the file does not exist.
Expected<std::optional<std::string>> readConfig(const fs::path &file) {
  std::error_code code;
  if (!fs::exists(file, code)) {
    if (code) return fail(ErrorCode::output, pathText(file) + ": cannot be read: " + code.message());
    return std::optional<std::string>();
  }
  auto in = openInputFile(file);
  if (!in) return fail(ErrorCode::output, in.error().message);
  if (const std::uintmax_t size = fs::file_size(file, code); code || size > kLargestConfig)
    return fail(ErrorCode::output,
                fmt::format("{}: has {} bytes; accepted: at most {}", pathText(file), size, kLargestConfig));
  std::string text{std::istreambuf_iterator<char>(*in), {}};
  if (in->bad()) return fail(ErrorCode::output, pathText(file) + ": cannot be read");
  return std::optional(std::move(text));
}

}  // namespace

std::optional<WindowLevel> windowLevelFor(const std::vector<WindowLevelRule> &rules, const std::string &name) {
  for (const WindowLevelRule &rule : rules)
    if (containsWords(name, rule.words)) return WindowLevel{rule.width, rule.centre};
  return std::nullopt;
}

void Preferences::addRecentFolder(const std::string &used) {
  std::erase(recentFolders, used);
  recentFolders.insert(recentFolders.begin(), used);
  if (recentFolders.size() > kMostFolders) recentFolders.resize(kMostFolders);
}

Preferences usualPreferences(const Preferences &present) {
  Preferences usual;
  usual.bookmarks = present.bookmarks;
  usual.recentFolders = present.recentFolders;
  return usual;
}

fs::path preferencesFile() { return userConfigDirectory() / "config.toml"; }

ReadPreferences readPreferences(const fs::path &file) {
  ReadPreferences out;
  const auto text = readConfig(file);
  if (!text) {
    out.problems.push_back(text.error().message);
    return out;
  }
  if (!*text) return out;
  const ConfigText config(**text);
  const auto problem = [&](std::size_t line, const std::string &what) {
    out.problems.push_back(fmt::format("{}:{}: {}", pathText(file), line, displayMessage(what)));
  };
  for (const ConfigText::Problem &one : config.problems()) problem(one.line, one.text);
  for (const ConfigText::Block &block : config.blocks()) {
    if (block.isOfList && block.name == kRules) {
      if (const auto rule = ruleOf(block, problem)) out.values.windowLevels.push_back(*rule);
      continue;
    }
    for (const ConfigText::Entry &entry : block.entries) {
      const std::string shown = (block.name.empty() ? "" : block.name + ".") + entry.key + " = " + entry.value;
      const auto key = std::find_if(keys().begin(), keys().end(), [&](const ConfigKey &one) {
        return !block.isOfList && one.block == block.name && one.name == entry.key;
      });
      if (key == keys().end())
        problem(entry.line, shown + ": " + unknownKey(block.name, entry.key));
      else if (config.find(block.name, entry.key)->line != entry.line)
        problem(entry.line, shown + ": is given twice; the value in line " +
                                std::to_string(config.find(block.name, entry.key)->line) + " is used");
      else if (const std::string accepted = key->read(entry.value, out.values); !accepted.empty())
        problem(entry.line, shown + ": accepted: " + accepted);
    }
  }
  return out;
}

Expected<void> writePreferences(const fs::path &file, const Preferences &before, const Preferences &after,
                                bool replacesInvalid) {
  const auto present = readConfig(file);
  if (!present) return tl::unexpected(present.error());
  ConfigText config(present->value_or(kHead));
  for (const ConfigKey &key : keys()) {
    const ConfigText::Entry *entry = config.find(key.block, key.name);
    Preferences ignored;
    const bool isInvalid = entry && !key.read(entry->value, ignored).empty();
    if (key.written(before) != key.written(after) || (replacesInvalid && isInvalid))
      config.set(key.block, key.name, key.written(after));
  }
  if (before.windowLevels != after.windowLevels) writeRules(config, after.windowLevels);
  if (*present && config.text() == **present) return {};
  std::error_code code;
  fs::create_directories(file.parent_path(), code);
  if (code) return fail(ErrorCode::output, pathText(file.parent_path()) + ": cannot be created: " + code.message());
  return writeWholeFile(file, config.text());
}

}  // namespace c3de::ui
