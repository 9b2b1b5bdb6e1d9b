// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "c3de/sdk/params.hpp"

namespace c3de::sdk {

/// What a saved state belongs to: what the scene says of the physics, field by field, so that a state of another scene
/// is refused with the fields that differ. A field is "owner: what" ("body 'liver': material.youngs_modulus"), or
/// without an owner "what" of the world. One thread at a time.
class SceneRecord {
 public:
  void add(const std::string &field, std::string_view value) { fields_[field] = std::string(value); }
  void add(const std::string &field, double value) { fields_[field] = textOf(value); }
  /// As its declaration shows it; the numbers beside a text do not count.
  void add(const std::string &field, const c3de_param_value &value) {
    switch (value.type) {
      case C3DE_PARAM_TEXT:
      case C3DE_PARAM_CHOICE: return add(field, text(value.text));
      case C3DE_PARAM_VEC3: return add(field, std::span<const double>(value.vec, 3));
      case C3DE_PARAM_BOOL: return add(field, value.num != 0.0 ? "true" : "false");
      default: return add(field, value.num);
    }
  }
  void add(const std::string &field, std::span<const double> numbers) {
    std::string all;
    for (const double number : numbers) all += (all.empty() ? "" : " ") + textOf(number);
    fields_[field] = std::move(all);
  }
  /// Of many numbers: their bits, of which only "differ" is shown.
  template <class T>
  void addDigest(const std::string &field, std::span<const T> numbers) {
    std::uint64_t hash = 0xcbf29ce484222325ull;  // FNV-1a
    const auto *bytes = reinterpret_cast<const unsigned char *>(numbers.data());
    for (std::size_t i = 0; i < numbers.size_bytes(); ++i) hash = (hash ^ bytes[i]) * 0x100000001b3ull;
    char text[24];
    std::snprintf(text, sizeof text, "#%016llx", static_cast<unsigned long long>(hash));
    fields_[field] = text;
  }

  [[nodiscard]] std::string bytes() const {
    std::string out(kMagic);
    put(out, fields_.size());
    for (const auto &[field, value] : fields_)
      for (const std::string_view part : {std::string_view(field), std::string_view(value)}) {
        put(out, part.size());
        out += part;
      }
    return out;
  }
  /// Takes bytes() off the front of a state. Nothing: it begins with something else, or ends too early.
  [[nodiscard]] static std::optional<SceneRecord> take(std::string_view &state) {
    if (state.substr(0, kMagic.size()) != kMagic) return std::nullopt;
    std::string_view rest = state.substr(kMagic.size());
    const auto count = number(rest);
    SceneRecord out;
    for (std::uint64_t i = 0; count && i < *count; ++i) {
      std::array<std::string_view, 2> parts;
      for (std::string_view &part : parts) {
        const auto size = number(rest);
        if (!size || *size > rest.size()) return std::nullopt;
        part = rest.substr(0, static_cast<std::size_t>(*size));
        rest.remove_prefix(part.size());
      }
      out.fields_[std::string(parts[0])] = std::string(parts[1]);
    }
    if (!count) return std::nullopt;
    state = rest;
    return out;
  }

  /// For a person: what is otherwise in the scene of a saved state; empty: nothing is.
  [[nodiscard]] std::string differencesFrom(const SceneRecord &saved) const {
    std::vector<std::string> lines;
    const auto lineOf = [&](std::string line) {
      if (std::find(lines.begin(), lines.end(), line) == lines.end()) lines.push_back(std::move(line));
    };
    const auto absent = [&](const SceneRecord &here, const SceneRecord &there, const char *where) {
      for (const auto &[field, value] : here.fields_)
        if (const std::string owner = ownerOf(field); !owner.empty() && !there.has(owner)) lineOf(owner + where);
    };
    absent(*this, saved, " is not in the state");
    absent(saved, *this, " is only in the state");
    std::vector<std::pair<std::string, std::string>> digests;  // owner and line
    for (const auto &[field, value] : fields_) {
      const auto other = saved.fields_.find(field);
      const std::string owner = ownerOf(field);
      if ((other != saved.fields_.end() && other->second == value) || (!owner.empty() && !saved.has(owner))) continue;
      if (isDigest(value) || (other != saved.fields_.end() && isDigest(other->second)))
        digests.emplace_back(owner, field + " differ");
      else
        lineOf(field + " is " + value + ", in the state " +
               (other == saved.fields_.end() ? "not given" : other->second));
    }
    for (const auto &[field, value] : saved.fields_)
      if (!fields_.contains(field) && !isDigest(value) && (ownerOf(field).empty() || has(ownerOf(field))))
        lineOf(field + " is not given, in the state " + value);
    // What follows from a difference that has been named already.
    for (const auto &[owner, line] : digests)
      if (std::none_of(lines.begin(), lines.end(), [&, of = owner](const std::string &one) {
            return !of.empty() && one.compare(0, of.size(), of) == 0;
          }))
        lineOf(line);
    constexpr std::size_t kMost = 6;
    std::string all;
    for (std::size_t i = 0; i < std::min(lines.size(), kMost); ++i) all += (i == 0 ? "" : "; ") + shortened(lines[i]);
    if (lines.size() > kMost) all += " and " + std::to_string(lines.size() - kMost) + " more";
    // A damaged state may hold any bytes.
    std::replace_if(
        all.begin(), all.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }, '?');
    return all;
  }

 private:
  static constexpr std::string_view kMagic = "scene record 1\n";

  static bool isDigest(std::string_view value) { return !value.empty() && value.front() == '#'; }
  /// The shortest text that is this number again.
  static std::string textOf(double value) {
    char text[40];
    for (int digits = 6; digits <= 17; ++digits) {
      std::snprintf(text, sizeof text, "%.*g", digits, value);
      double again = 0.0;
      if (std::sscanf(text, "%lf", &again) == 1 && again == value) break;
    }
    return text;
  }
  static void put(std::string &out, std::uint64_t number) {
    for (int shift = 0; shift < 64; shift += 8) out += static_cast<char>(number >> shift & 0xffu);
  }
  static std::optional<std::uint64_t> number(std::string_view &bytes) {
    if (bytes.size() < 8) return std::nullopt;
    std::uint64_t out = 0;
    for (std::size_t i = 0; i < 8; ++i) out |= std::uint64_t{static_cast<unsigned char>(bytes[i])} << (8 * i);
    bytes.remove_prefix(8);
    return out;
  }
  static std::string shortened(std::string line) {
    constexpr std::size_t kLongest = 300;
    if (line.size() <= kLongest) return line;
    std::size_t end = kLongest;
    while (end > 0 && (static_cast<unsigned char>(line[end]) & 0xc0u) == 0x80u) --end;  // not within a character
    return line.substr(0, end) + "…";
  }
  static std::string ownerOf(const std::string &field) {
    const std::size_t colon = field.find(": ");
    return colon == std::string::npos ? std::string() : field.substr(0, colon);
  }
  [[nodiscard]] bool has(const std::string &owner) const {
    const auto found = fields_.lower_bound(owner + ": ");
    return found != fields_.end() && found->first.compare(0, owner.size() + 2, owner + ": ") == 0;
  }

  std::map<std::string, std::string> fields_;
};

}  // namespace c3de::sdk
