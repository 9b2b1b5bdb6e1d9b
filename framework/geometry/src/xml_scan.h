// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <string_view>

namespace c3de::geometry {

/// Scans XML tag by tag, as far as VTK's files require: attributes, text between tags; comments, declarations and
/// similar are skipped.
class XmlScan {
 public:
  explicit XmlScan(std::string_view text) : text_(text) {}

  enum class Kind { open, close, selfClosed, end, broken };
  struct Tag {
    Kind kind = Kind::end;
    std::string name;
    std::map<std::string, std::string> attributes;
    [[nodiscard]] std::string get(const std::string &key, const std::string &fallback = {}) const {
      const auto it = attributes.find(key);
      return it == attributes.end() ? fallback : it->second;
    }
  };
  Tag next();
  /// Text from the current position to the next '<'.
  [[nodiscard]] std::string_view textHere() const { return text_.substr(at_, text_.find('<', at_) - at_); }
  /// Everything from the current position.
  [[nodiscard]] std::string_view rest() const { return text_.substr(at_); }
  [[nodiscard]] std::size_t position() const { return at_; }

 private:
  /// Advances to the next '<' of a tag, or the end. False: a skipped construct does not end.
  bool toTag();
  void skipSpace();
  std::string word();
  bool attribute(Tag &tag);  ///< false: malformed

  std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace c3de::geometry
