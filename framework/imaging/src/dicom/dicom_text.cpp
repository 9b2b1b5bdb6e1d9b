// SPDX-License-Identifier: Apache-2.0
#include "dicom/dicom_text.h"

#include <array>
#include <cctype>
#include <optional>

#include "c3de/core/character_set.h"
#include "formats/image_header.h"

namespace c3de::imaging {
namespace {

constexpr const char *kReplacement = "\xef\xbf\xbd";
constexpr CharacterSet kUtf8{"UTF-8", 65001}, kEucJp{"EUC-JP", 20932};

/// How to convert the bytes of a designated set to a character set that platforms support.
enum class TextPacking {
  ascii,     ///< 0x20 … 0x7e unchanged; JIS X 0201 differs in two characters that Japanese texts use either way
  plain,     ///< bytes above 127 unchanged
  doubled,   ///< two bytes below 128: with their highest bits set
  prefixed,  ///< the same after 0x8f (EUC-JP, JIS X 0212)
};

struct Designation {
  const char *term;    ///< of (0008,0005) after "IR "
  const char *escape;  ///< after ESC
  TextPacking packing;
  CharacterSet set;
};

/// PS3.3 tables C.12-2 to C.12-4. The second half of JIS X 0201 is that of Shift-JIS.
constexpr std::array kDesignations{
    Designation{"6", "(B", TextPacking::ascii, {"", 0}},
    Designation{"13", "(J", TextPacking::ascii, {"", 0}},
    Designation{"13", ")I", TextPacking::plain, {"SHIFT_JIS", 932}},
    Designation{"100", "-A", TextPacking::plain, {"ISO-8859-1", 28591}},
    Designation{"101", "-B", TextPacking::plain, {"ISO-8859-2", 28592}},
    Designation{"109", "-C", TextPacking::plain, {"ISO-8859-3", 28593}},
    Designation{"110", "-D", TextPacking::plain, {"ISO-8859-4", 28594}},
    Designation{"144", "-L", TextPacking::plain, {"ISO-8859-5", 28595}},
    Designation{"127", "-G", TextPacking::plain, {"ISO-8859-6", 28596}},
    Designation{"126", "-F", TextPacking::plain, {"ISO-8859-7", 28597}},
    Designation{"138", "-H", TextPacking::plain, {"ISO-8859-8", 28598}},
    Designation{"148", "-M", TextPacking::plain, {"ISO-8859-9", 28599}},
    Designation{"203", "-b", TextPacking::plain, {"ISO-8859-15", 28605}},
    Designation{"166", "-T", TextPacking::plain, {"TIS-620", 874}},
    Designation{"87", "$B", TextPacking::doubled, kEucJp},
    Designation{"87", "$@", TextPacking::doubled, kEucJp},
    Designation{"159", "$(D", TextPacking::prefixed, kEucJp},
    Designation{"149", "$)C", TextPacking::plain, {"EUC-KR", 949}},
    Designation{"58", "$)A", TextPacking::plain, {"GB2312", 936}},
};

bool isForUpperHalf(const Designation &one) { return one.packing == TextPacking::plain; }

bool isUtf8(std::string_view bytes) {
  for (std::size_t i = 0; i < bytes.size();) {
    const auto at = [&](std::size_t n) { return i + n < bytes.size() ? static_cast<unsigned char>(bytes[i + n]) : 0u; };
    const unsigned c = at(0);
    const std::size_t more = c < 0x80                ? 0
                             : c >= 0xc2 && c < 0xe0 ? 1
                             : c >= 0xe0 && c < 0xf0 ? 2
                             : c >= 0xf0 && c < 0xf5 ? 3
                                                     : 4;
    if (more == 4) return false;
    for (std::size_t n = 1; n <= more; ++n)
      if ((at(n) & 0xc0u) != 0x80u) return false;
    const unsigned second = at(1);
    if ((c == 0xe0 && second < 0xa0) || (c == 0xed && second > 0x9f) || (c == 0xf0 && second < 0x90) ||
        (c == 0xf4 && second > 0x8f))
      return false;
    i += more + 1;
  }
  return true;
}

/// State of ISO 2022: the sets designated to the lower and the upper half of the bytes.
class Escapes {
 public:
  explicit Escapes(const Designation *upper) : firstUpper_(upper), upper_(upper) {}

  std::string decoded(std::string_view bytes) {
    for (std::size_t i = 0; i < bytes.size();) {
      if (bytes[i] == '\x1b') {
        i += switched(bytes.substr(i + 1)) + 1;
        continue;
      }
      const bool isUpper = static_cast<unsigned char>(bytes[i]) >= 0x80;
      std::size_t end = i;
      while (end < bytes.size() && bytes[end] != '\x1b' &&
             (static_cast<unsigned char>(bytes[end]) >= 0x80) == isUpper && (end == i || !isDelimiter(bytes[end - 1])))
        ++end;
      take(bytes.substr(i, end - i), isUpper);
      i = end;
    }
    return std::move(out_);
  }

 private:
  /// Delimiters of values, names and lines restore the initial sets (PS3.5 6.1.2.5.3), except within a character.
  [[nodiscard]] bool isDelimiter(char c) const {
    return lower_ == nullptr && (c == '\\' || c == '^' || c == '=' || c == '\n' || c == '\r' || c == '\f' || c == '\t');
  }
  std::size_t switched(std::string_view behind) {
    for (const Designation &one : kDesignations) {
      if (!behind.starts_with(one.escape)) continue;
      if (isForUpperHalf(one))
        upper_ = &one;
      else
        lower_ = one.packing == TextPacking::ascii ? nullptr : &one;
      return std::string_view(one.escape).size();
    }
    out_ += kReplacement;
    return 0;
  }
  void take(std::string_view run, bool isUpper) {
    if (!isUpper && lower_ == nullptr) {
      out_ += run;
      if (isDelimiter(run.back())) upper_ = firstUpper_;
      return;
    }
    const Designation *designation = isUpper ? upper_ : lower_;
    if (designation == nullptr) {
      for (std::size_t n = 0; n < run.size(); ++n) out_ += kReplacement;
      return;
    }
    if (isUpper) {
      out_ += utf8From(run, designation->set);
      return;
    }
    std::string packed;
    for (std::size_t n = 0; n < run.size(); ++n) {
      if (designation->packing == TextPacking::prefixed && n % 2 == 0) packed += '\x8f';
      packed += static_cast<char>(static_cast<unsigned char>(run[n]) | 0x80u);
    }
    out_ += utf8From(packed, designation->set);
  }

  const Designation *firstUpper_, *upper_, *lower_ = nullptr;
  std::string out_;
};

std::string withoutControls(std::string text) {
  for (char &c : text)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  return text;
}

/// The first set of (0008,0005); "ISO_IR 100", "ISO 2022 IR 100" and sloppy spellings are equivalent.
std::string termOf(const std::string &characterSet) {
  std::string first = trimmed(characterSet.substr(0, characterSet.find('\\')));
  const std::size_t ir = first.find("IR");
  if (ir == std::string::npos) return first;
  first.erase(0, ir + 2);
  const std::size_t digit = first.find_first_of("0123456789");
  return digit == std::string::npos ? "" : first.substr(digit);
}

}  // namespace

std::string dicomText(std::string_view bytes, const std::string &characterSet) {
  const std::string term = termOf(characterSet);
  if (term == "192" || (trimmed(characterSet).empty() && isUtf8(bytes)))
    return trimmed(withoutControls(utf8From(bytes, kUtf8)));
  if (term == "GB18030") return trimmed(withoutControls(utf8From(bytes, {"GB18030", 54936})));
  if (term == "GBK") return trimmed(withoutControls(utf8From(bytes, {"GBK", 936})));
  const Designation *upper = nullptr;
  for (const Designation &one : kDesignations)
    if (isForUpperHalf(one) && term == one.term) upper = &one;
  return trimmed(withoutControls(Escapes(upper).decoded(bytes)));
}

}  // namespace c3de::imaging
