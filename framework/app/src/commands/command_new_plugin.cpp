// SPDX-License-Identifier: Apache-2.0
// `c3de new-plugin`
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <iterator>
#include <memory>
#include <span>
#include <utility>

#include "c3de/core/output_file.h"
#include "c3de/core/path_text.h"
#include "c3de/core/platform.h"
#include "c3de/session/resources.h"
#include "commands/command_line.h"
#include "commands/commands.h"
#include "commands/exit_code.h"
#include "commands/standard_output.h"

namespace c3de::app {
namespace {

struct NewPlugin {
  std::string name, language = "c++", kind = "panel";
  std::filesystem::path folder = ".";
};

struct Template {
  const char *language, *kind;
};
// Each has a file resources/templates/LANGUAGE/KIND.c or .cpp.
constexpr std::array kTemplates{Template{"c++", "panel"},        Template{"c++", "tool"},
                                Template{"c++", "force-field"},  Template{"c++", "simulator"},
                                Template{"c++", "material-law"}, Template{"c++", "mesh-format"},
                                Template{"c", "panel"},          Template{"c", "force-field"}};

/// Names in the templates and their replacements in the new plugin. A name that contains another one comes first.
using Names = std::array<std::pair<std::string, std::string>, 4>;

std::string joined(const std::vector<std::string> &words, bool isClass) {
  std::string text;
  for (std::string word : words) {
    if (isClass || text.empty())
      word.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(word.front())));
    text += (isClass || text.empty() ? "" : " ") + word;
  }
  return text;
}

Names namesOf(const std::string &name) {
  std::vector<std::string> words;
  for (std::size_t begin = 0; begin <= name.size();) {
    const std::size_t end = std::min(name.find('_', begin), name.size());
    if (end > begin) words.push_back(name.substr(begin, end - begin));
    begin = end + 1;
  }
  const std::string cls = joined(words, true);
  return {{{"my_plugin", name},
           {"MyPlugin", cls},
           {"My plugin", joined(words, false)},
           {"MySimulator", cls + "Simulator"}}};
}

/// The problem with a name, or empty.
std::string faultOf(const std::string &name) {
  const auto isGood = [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_'; };
  const bool isName = name.size() >= 2 && name.size() <= 64 && name.front() >= 'a' && name.front() <= 'z' &&
                      name.back() != '_' && std::all_of(name.begin(), name.end(), isGood);
  if (!isName)
    return fmt::format(
        "the name '{}' is refused; accepted: 2 to 64 lower-case letters, digits and _, a letter first, no _ "
        "last, for example heart_beat",
        name);
  // Targets already defined by CMake or its generators, and the names used by this program and its plugins.
  for (const char *taken : {"all", "clean", "help", "install", "test", "package", "edit_cache", "rebuild_cache", "c3de",
                            "pointbased", "hello", "magnet"})
    if (name == taken) return fmt::format("the name '{}' is refused: it is taken by CMake or by C3DE", name);
  return {};
}

std::string languagesAndKinds() {
  std::string text;
  for (const Template &one : kTemplates)
    text += fmt::format("{}--language {} --kind {}", text.empty() ? "" : ", ", one.language, one.kind);
  return text;
}

Expected<std::string> textOf(const std::string &resource, const Names &names) {
  const auto file = findResource("templates/" + resource);
  if (!file) return tl::unexpected(file.error());
  std::ifstream in(*file, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(in), {}};
  if (!in.eof() && !in) return fail(ErrorCode::input, pathText(*file) + ": cannot be read");
  for (const auto &[from, to] : names)
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
      text.replace(at, from.size(), to);
  return text;
}

Expected<std::filesystem::path> write(const NewPlugin &wanted) {
  if (const std::string fault = faultOf(wanted.name); !fault.empty()) return fail(ErrorCode::usage, fault);
  const auto known = std::find_if(kTemplates.begin(), kTemplates.end(), [&](const Template &one) {
    return one.language == wanted.language && one.kind == wanted.kind;
  });
  if (known == kTemplates.end())
    return fail(ErrorCode::usage, fmt::format("--language {} --kind {} is not served; accepted: {}", wanted.language,
                                              wanted.kind, languagesAndKinds()));
  const std::filesystem::path folder = wanted.folder / wanted.name;
  std::error_code code;
  if (std::filesystem::exists(folder, code))
    return fail(ErrorCode::output, pathText(folder) + ": already exists; nothing was written");
  const std::string ending = wanted.language == "c" ? ".c" : ".cpp";
  const Names names = namesOf(wanted.name);
  const std::array<std::pair<std::string, std::string>, 3> files{
      {{wanted.language + "/" + wanted.kind + ending, wanted.name + ending},
       {wanted.language + "/CMakeLists.txt", "CMakeLists.txt"},
       {"README.md", "README.md"}}};
  // All texts are generated before the folder is created, so that a failure leaves nothing behind.
  std::array<std::string, 3> texts;
  for (std::size_t i = 0; i < files.size(); ++i) {
    auto text = textOf(files[i].first, names);
    if (!text) return tl::unexpected(text.error());
    texts[i] = std::move(*text);
  }
  if (!std::filesystem::create_directories(folder, code))
    return fail(ErrorCode::output, pathText(folder) + ": cannot be made: " + code.message());
  for (std::size_t i = 0; i < files.size(); ++i)
    if (const auto written = writeWholeFile(folder / files[i].second, texts[i]); !written) {
      std::filesystem::remove_all(folder, code);
      return tl::unexpected(written.error());
    }
  return folder;
}

int newPlugin(const NewPlugin &wanted) {
  const auto folder = write(wanted);
  if (!folder) return reportError(folder.error());
  const std::string here = pathText(*folder);
  printOut(
      fmt::format("{0} is written. With the component sdk installed in PREFIX:\n"
                  "  cmake -S {0} -B {0}/build -DCMAKE_PREFIX_PATH=PREFIX\n"
                  "  cmake --build {0}/build\n"
                  "  c3de --plugin {0}/build/{1}{2}\n",
                  here, wanted.name, pluginExtension()));
  return kDone;
}

Handler declareNewPlugin(CLI::App &app, CommandLine &) {
  const auto wanted = std::make_shared<NewPlugin>();
  app.add_option("NAME", wanted->name, "Of its folder, target and file: lower-case letters, digits and _")->required();
  app.add_option("--language", wanted->language, "c or c++ (default c++)")
      ->type_name("LANGUAGE")
      ->check(listOfChoices("c,c++"));
  app.add_option("--kind", wanted->kind, "panel (default), tool, force-field, simulator, material-law or mesh-format")
      ->type_name("KIND")
      ->check(listOfChoices("panel,tool,force-field,simulator,material-law,mesh-format"));
  app.add_option("--folder", wanted->folder, "Where the folder NAME is made (default: here)")->type_name("DIR");
  return [wanted] { return newPlugin(*wanted); };
}

}  // namespace

const Command kNewPluginCommand{"new-plugin", "Writes a plugin to begin with: source, build file, README",
                                declareNewPlugin};

}  // namespace c3de::app
