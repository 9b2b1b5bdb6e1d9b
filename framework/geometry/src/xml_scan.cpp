// SPDX-License-Identifier: Apache-2.0
#include "xml_scan.h"

namespace c3de::geometry {
namespace {

bool isSpace(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

std::string withoutEntities(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    bool isEntity = false;
    for (const auto &[name, c] : {std::pair<std::string_view, char>{"&amp;", '&'},
                                  {"&lt;", '<'},
                                  {"&gt;", '>'},
                                  {"&quot;", '"'},
                                  {"&apos;", '\''}})
      if (text.starts_with(name)) {
        out.push_back(c);
        text.remove_prefix(name.size());
        isEntity = true;
        break;
      }
    if (isEntity) continue;
    out.push_back(text.front());
    text.remove_prefix(1);
  }
  return out;
}

}  // namespace

XmlScan::Tag XmlScan::next() {
  Tag tag;
  const auto broken = [&tag] {
    tag.kind = Kind::broken;
    return tag;
  };
  while (true) {
    const std::size_t begin = text_.find('<', at_);
    if (begin == std::string_view::npos) {
      at_ = text_.size();
      return tag;
    }
    std::string_view terminator;
    if (text_.substr(begin).starts_with("<!--"))
      terminator = "-->";
    else if (text_.substr(begin).starts_with("<?"))
      terminator = "?>";
    else if (text_.substr(begin).starts_with("<!"))
      terminator = ">";
    if (terminator.empty()) {
      at_ = begin + 1;
      break;
    }
    const std::size_t end = text_.find(terminator, begin + 2);
    if (end == std::string_view::npos) return broken();
    at_ = end + terminator.size();
  }
  const auto skipSpace = [this] {
    while (at_ < text_.size() && isSpace(text_[at_])) ++at_;
  };
  const auto word = [this] {
    const std::size_t begin = at_;
    while (at_ < text_.size() && !isSpace(text_[at_]) && text_[at_] != '>' && text_[at_] != '/' && text_[at_] != '=')
      ++at_;
    return std::string(text_.substr(begin, at_ - begin));
  };
  tag.kind = Kind::open;
  if (at_ < text_.size() && text_[at_] == '/') {
    tag.kind = Kind::close;
    ++at_;
  }
  tag.name = word();
  if (tag.name.empty()) return broken();
  while (true) {
    skipSpace();
    if (at_ >= text_.size()) return broken();
    if (text_[at_] == '>') {
      ++at_;
      return tag;
    }
    if (text_.substr(at_).starts_with("/>")) {
      at_ += 2;
      tag.kind = Kind::selfClosed;
      return tag;
    }
    const std::string key = word();
    skipSpace();
    if (key.empty() || at_ >= text_.size() || text_[at_] != '=') return broken();
    ++at_;
    skipSpace();
    if (at_ >= text_.size() || (text_[at_] != '"' && text_[at_] != '\'')) return broken();
    const std::size_t end = text_.find(text_[at_], at_ + 1);
    if (end == std::string_view::npos) return broken();
    tag.attributes[key] = withoutEntities(text_.substr(at_ + 1, end - at_ - 1));
    at_ = end + 1;
  }
}

}  // namespace c3de::geometry
