// SPDX-License-Identifier: Apache-2.0
#include "c3de/scene/toml_document.h"

#include <toml++/toml.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "c3de/core/input_file.h"
#include "c3de/core/text.h"

namespace c3de::scene {
namespace {

/// Far above the size of any scene; a larger file is not a scene.
constexpr std::uintmax_t kMaxFileBytes = 4u << 20;
/// Limits nesting, which is at most the number of dots in a line: tables are destroyed recursively.
constexpr std::size_t kMaxLineBytes = 4096;

TomlValue convert(const toml::node &node) {
  TomlValue out;
  out.line = static_cast<int>(node.source().begin.line);
  switch (node.type()) {
    case toml::node_type::boolean:
      out.kind = TomlValue::Kind::boolean;
      out.num = node.as_boolean()->get() ? 1.0 : 0.0;
      break;
    case toml::node_type::integer:
      out.kind = TomlValue::Kind::integer;
      out.num = static_cast<double>(node.as_integer()->get());
      break;
    case toml::node_type::floating_point:
      out.kind = TomlValue::Kind::number;
      out.num = node.as_floating_point()->get();
      break;
    case toml::node_type::string:
      out.kind = TomlValue::Kind::text;
      out.text = node.as_string()->get();
      break;
    case toml::node_type::array:
      out.kind = TomlValue::Kind::array;
      for (const toml::node &item : *node.as_array()) out.items.push_back(convert(item));
      break;
    case toml::node_type::table: {
      out.kind = TomlValue::Kind::table;
      struct Placed {
        toml::source_position at;
        TomlValue::Entry entry;
      };
      std::vector<Placed> placed;
      for (const auto &[key, value] : *node.as_table()) {
        TomlValue converted = convert(value);
        // Messages use the line of the key; a table made by a dotted key has no line of its own.
        if (key.source().begin.line != 0) converted.line = static_cast<int>(key.source().begin.line);
        placed.push_back({key.source().begin, {std::string(key.str()), std::move(converted)}});
      }
      std::stable_sort(placed.begin(), placed.end(), [](const Placed &a, const Placed &b) { return a.at < b.at; });
      for (Placed &p : placed) out.entries.push_back(std::move(p.entry));
      break;
    }
    default: out.kind = TomlValue::Kind::date;
  }
  return out;
}

}  // namespace

bool TomlValue::isNumbers(std::size_t count) const {
  return kind == Kind::array && items.size() == count &&
         std::all_of(items.begin(), items.end(), [](const TomlValue &item) { return item.isNumber(); });
}

const TomlValue *TomlValue::find(std::string_view key) const {
  for (const Entry &entry : entries)
    if (entry.key == key) return &entry.value;
  return nullptr;
}

std::string TomlValue::shown() const {
  constexpr std::size_t kMaxBytes = 60;
  switch (kind) {
    case Kind::integer:
    case Kind::number: return formatNumber(num);
    case Kind::text: return "\"" + text + "\"";
    case Kind::array: break;
    case Kind::table: return "{ … }";
    default: return kindName();
  }
  std::string list;
  for (const TomlValue &item : items) {
    if (list.size() > kMaxBytes) return "[" + list + ", …], a list of " + std::to_string(items.size());
    list += (list.empty() ? "" : ", ") + item.shown();
  }
  return "[" + list + "]";
}

std::string TomlValue::kindName() const {
  switch (kind) {
    case Kind::boolean: return num != 0.0 ? "true" : "false";
    case Kind::integer: return "a whole number";
    case Kind::number: return "a number";
    case Kind::text: return "the text \"" + text + "\"";
    case Kind::array: return shown();
    case Kind::table: return "a table";
    case Kind::date: return "a date or time";
  }
  return "a value";
}

Expected<TomlValue> parseToml(std::string_view text, const std::string &source) {
  int line = 1;
  for (std::size_t at = 0; at <= text.size(); ++line) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    if (end - at > kMaxLineBytes)
      return fail(ErrorCode::input, source + ":" + std::to_string(line) + ": the line has " + std::to_string(end - at) +
                                        " bytes; accepted: up to " + std::to_string(kMaxLineBytes));
    at = end + 1;
  }
  try {
    const toml::table root = toml::parse(text, source);
    return convert(root);
  } catch (const toml::parse_error &error) {
    return fail(ErrorCode::input, source + ":" + std::to_string(error.source().begin.line) +
                                      ": not valid TOML: " + displayMessage(error.description()));
  } catch (const std::exception &error) {
    return fail(ErrorCode::input, source + ": not valid TOML: " + displayMessage(error.what()));
  }
}

Expected<std::string> readTextFile(const std::filesystem::path &path) {
  std::error_code code;
  auto file = openInputFile(path);
  if (!file) return tl::unexpected(file.error());
  const std::uintmax_t bytes = std::filesystem::file_size(path, code);
  if (!code && bytes > kMaxFileBytes)
    return fail(ErrorCode::input, path.string() + ": has " + std::to_string(bytes) + " bytes; accepted: up to " +
                                      std::to_string(kMaxFileBytes));
  std::ostringstream content;
  content << file->rdbuf();
  if (!*file) return fail(ErrorCode::input, path.string() + ": cannot be read");
  return std::move(content).str();
}

bool toParameter(const TomlValue &toml, const std::string &id, ParameterValue &out) {
  out = {};
  out.id = id;
  switch (toml.kind) {
    case TomlValue::Kind::boolean:
      out.type = C3DE_PARAM_BOOL;
      out.num = toml.num;
      return true;
    case TomlValue::Kind::integer:
      out.type = C3DE_PARAM_I64;
      out.num = toml.num;
      return true;
    case TomlValue::Kind::number:
      out.type = C3DE_PARAM_F64;
      out.num = toml.num;
      return true;
    case TomlValue::Kind::text:
      out.type = C3DE_PARAM_TEXT;
      out.text = toml.text;
      return true;
    case TomlValue::Kind::array:
      if (!toml.isNumbers(3)) return false;
      out.type = C3DE_PARAM_VEC3;
      out.vec = {toml.items[0].num, toml.items[1].num, toml.items[2].num};
      return true;
    default: return false;
  }
}

}  // namespace c3de::scene
