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

bool XmlScan::toTag() {
  while (true) {
    const std::size_t begin = text_.find('<', at_);
    if (begin == std::string_view::npos) {
      at_ = text_.size();
      return true;
    }
    std::string_view terminator;
    if (text_.substr(begin).starts_with("<!--"))
      terminator = "-->";
    else if (text_.substr(begin).starts_with("<?"))
      terminator = "?>";
    else if (text_.substr(begin).starts_with("<!"))
      terminator = ">";
    if (terminator.empty()) {
      at_ = begin;
      return true;
    }
    const std::size_t end = text_.find(terminator, begin + 2);
    if (end == std::string_view::npos) return false;
    at_ = end + terminator.size();
  }
}

void XmlScan::skipSpace() {
  while (at_ < text_.size() && isSpace(text_[at_])) ++at_;
}

std::string XmlScan::word() {
  const std::size_t begin = at_;
  while (at_ < text_.size() && !isSpace(text_[at_]) && text_[at_] != '>' && text_[at_] != '/' && text_[at_] != '=')
    ++at_;
  return std::string(text_.substr(begin, at_ - begin));
}

bool XmlScan::attribute(Tag &tag) {
  const std::string key = word();
  skipSpace();
  if (key.empty() || at_ >= text_.size() || text_[at_] != '=') return false;
  ++at_;
  skipSpace();
  if (at_ >= text_.size() || (text_[at_] != '"' && text_[at_] != '\'')) return false;
  const std::size_t end = text_.find(text_[at_], at_ + 1);
  if (end == std::string_view::npos) return false;
  tag.attributes[key] = withoutEntities(text_.substr(at_ + 1, end - at_ - 1));
  at_ = end + 1;
  return true;
}

XmlScan::Tag XmlScan::next() {
  Tag tag;
  const auto broken = [&tag] {
    tag.kind = Kind::broken;
    return tag;
  };
  if (!toTag()) return broken();
  if (at_ >= text_.size()) return tag;
  ++at_;
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
    if (!attribute(tag)) return broken();
  }
}

}  // namespace c3de::geometry
