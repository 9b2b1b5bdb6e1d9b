// SPDX-License-Identifier: Apache-2.0
#include "json_schema.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <regex>

namespace {

using nlohmann::json;

bool hasType(const json &value, const std::string &type) {
  if (type == "integer")
    return value.is_number_integer() || (value.is_number() && std::floor(value.get<double>()) == value.get<double>());
  if (type == "number") return value.is_number();
  if (type == "string") return value.is_string();
  if (type == "boolean") return value.is_boolean();
  if (type == "null") return value.is_null();
  if (type == "array") return value.is_array();
  return type == "object" && value.is_object();
}

class Checker {
 public:
  explicit Checker(const json &root) : root_(root) {}

  void check(const json &schema, const json &value, const std::string &path) {
    for (const auto &[keyword, argument] : schema.items()) {
      if (keyword == "$ref")
        check(root_.at(json::json_pointer(argument.get<std::string>().substr(1))), value, path);
      else if (keyword == "anyOf")
        checkAny(argument, value, path);
      else
        checkKeyword(keyword, schema, value, path);
    }
  }
  std::vector<std::string> found;

 private:
  void add(const std::string &path, const std::string &what) {
    found.push_back((path.empty() ? "/" : path) + ": " + what);
  }

  void checkAny(const json &schemas, const json &value, const std::string &path) {
    std::string all;
    for (const json &one : schemas) {
      Checker branch(root_);
      branch.check(one, value, path);
      if (branch.found.empty()) return;
      all += (all.empty() ? "" : " | ") + branch.found.front();
    }
    add(path, "fits none of: " + all);
  }

  void checkKeyword(const std::string &keyword, const json &schema, const json &value, const std::string &path) {
    const json &argument = schema.at(keyword);
    if (keyword == "type") {
      const json types = argument.is_array() ? argument : json::array({argument});
      if (std::none_of(types.begin(), types.end(), [&](const json &type) { return hasType(value, type); }))
        add(path, value.dump().substr(0, 60) + " is not of type " + argument.dump());
    } else if (keyword == "enum") {
      if (std::find(argument.begin(), argument.end(), value) == argument.end())
        add(path, value.dump() + " is not in " + argument.dump());
    } else if (keyword == "const") {
      if (value != argument) add(path, value.dump() + " is not " + argument.dump());
    } else if (keyword == "minimum" || keyword == "maximum") {
      if (value.is_number() && (keyword == "minimum" ? value < argument : value > argument))
        add(path, value.dump() + " is beyond the " + keyword + " of " + argument.dump());
    } else if (keyword == "minItems" || keyword == "maxItems") {
      if (value.is_array() && (keyword == "minItems" ? value.size() < argument : value.size() > argument))
        add(path, std::to_string(value.size()) + " items, " + keyword + " is " + argument.dump());
    } else if (keyword == "pattern") {
      if (value.is_string() && !std::regex_search(value.get<std::string>(), std::regex(argument.get<std::string>())))
        add(path, value.dump() + " does not match " + argument.dump());
    } else {
      checkParts(keyword, schema, value, path);
    }
  }

  void checkParts(const std::string &keyword, const json &schema, const json &value, const std::string &path) {
    static constexpr std::array<const char *, 5> kRemarks{"$schema", "$defs", "title", "description", "$id"};
    const json &argument = schema.at(keyword);
    if (keyword == "items") {
      for (std::size_t i = 0; value.is_array() && i < value.size(); ++i)
        check(argument, value[i], path + "/" + std::to_string(i));
    } else if (keyword == "required") {
      for (const json &key : argument)
        if (value.is_object() && !value.contains(key.get<std::string>())) add(path, "has no " + key.dump());
    } else if (keyword == "properties") {
      for (const auto &[key, one] : argument.items())
        if (value.is_object() && value.contains(key)) check(one, value.at(key), path + "/" + key);
    } else if (keyword == "additionalProperties") {
      if (!value.is_object()) return;
      for (const auto &[key, one] : value.items()) {
        if (schema.contains("properties") && schema["properties"].contains(key)) continue;
        if (argument == false)
          add(path, "\"" + key + "\" is not in the schema");
        else
          check(argument, one, path + "/" + key);
      }
    } else if (std::find(kRemarks.begin(), kRemarks.end(), keyword) == kRemarks.end()) {
      add(path, "the schema has the unknown keyword " + keyword);
    }
  }

  const json &root_;
};

}  // namespace

std::vector<std::string> departuresFrom(const nlohmann::json &schema, const nlohmann::json &document) {
  Checker checker(schema);
  checker.check(schema, document, {});
  return checker.found;
}
