// SPDX-License-Identifier: Apache-2.0
// Character sets of DICOM texts: examples of PS3.5 annexes H to K, and invalid bytes.
#include "dicom_made.h"

using namespace made;

namespace {

struct Texts {
  std::string description, patient;
};

/// A description and a patient's name as returned by a reader.
Texts textsOf(const std::string &characterSet, const std::string &bytes) {
  Picture picture(2, 2);
  picture.text(0x0008103e, "LO", bytes).text(0x00100010, "PN", bytes).pixels(std::vector<std::uint16_t>{1, 2, 3, 4});
  if (!characterSet.empty()) picture.text(0x00080005, "CS", characterSet);
  const auto list = listSeries(write(emptyFolder("text") / "one.dcm", picture.file()));
  REQUIRE(list);
  REQUIRE(list->size() == 1);
  return {list->front().description, list->front().patientName};
}

}  // namespace

TEST_CASE("Texts of DICOM come as UTF-8, whatever their character set", "[imaging]") {
  struct Case {
    const char *set, *bytes, *text;
  };
  for (const Case &one : {
           Case{"ISO_IR 100", "Buc^J\xe9r\xf4me", "Buc^Jérôme"},
           Case{"ISO_IR 101", "Wa\xb3\xeasa", "Wałęsa"},
           Case{"ISO_IR 109", "\xa6 \xf8", "Ĥ ĝ"},
           Case{"ISO_IR 110", "\xa9 \xf2", "Š ō"},
           Case{"ISO_IR 144",
                "\xbb\xee\xda"
                "ce\xdc"
                "b\xdfyp\xd3",
                "Люкceмbпypг"},
           Case{"ISO_IR 127", "\xe2\xc8\xc7\xe6\xea^\xe4\xe6\xd2\xc7\xd1", "قباني^لنزار"},
           Case{"ISO_IR 126", "\xc4\xe9\xef\xed\xf5\xf3\xe9\xef\xf2", "Διονυσιος"},
           Case{"ISO_IR 138", "\xf9\xf8\xe5\xef^\xe3\xe1\xe5\xf8\xe4", "שרון^דבורה"},
           Case{"ISO_IR 148",
                "\xc7"
                "avu\xfeo\xf0lu",
                "Çavuşoğlu"},
           Case{"ISO_IR 13", "\xd4\xcf\xc0\xde^\xc0\xdb\xb3", "ﾔﾏﾀﾞ^ﾀﾛｳ"},
           Case{"ISO_IR 192", "Wang^XiaoDong=\xe7\x8e\x8b^\xe5\xb0\x8f\xe4\xb8\x9c", "Wang^XiaoDong=王^小东"},
           Case{"GB18030", "Wang^XiaoDong=\xcd\xf5^\xd0\xa1\xb6\xab", "Wang^XiaoDong=王^小东"},
           Case{"GBK", "Wang^XiaoDong=\xcd\xf5^\xd0\xa1\xb6\xab", "Wang^XiaoDong=王^小东"},
           Case{"\\ISO 2022 IR 87",
                "Yamada^Tarou=\x1b$B;3ED\x1b(B^\x1b$BB@O:\x1b(B=\x1b$B$d$^$@\x1b(B^\x1b$B$?$m$&\x1b(B",
                "Yamada^Tarou=山田^太郎=やまだ^たろう"},
           Case{"ISO 2022 IR 13\\ISO 2022 IR 87", "\xd4\xcf\xc0\xde^\xc0\xdb\xb3=\x1b$B;3ED\x1b(J^\x1b$BB@O:\x1b(J",
                "ﾔﾏﾀﾞ^ﾀﾛｳ=山田^太郎"},
           Case{"ISO 2022 IR 6\\ISO 2022 IR 149",
                "Hong^Gildong=\x1b$)C\xfb\xf3^\x1b$)C\xd1\xce\xd4\xd7=\x1b$)C\xc8\xab^\x1b$)C\xb1\xe6\xb5\xbf",
                "Hong^Gildong=洪^吉洞=홍^길동"},
           Case{"ISO 2022 IR 100\\ISO 2022 IR 144", "J\xe9r\xf4me \x1b-L\xbb\xee\xda", "Jérôme Люк"},
           Case{"", "plain ASCII", "plain ASCII"},
           Case{"", "J\xc3\xa9r\xc3\xb4me", "Jérôme"},  // UTF-8 that is not declared
       }) {
    CAPTURE(one.set);
    const Texts texts = textsOf(one.set, one.bytes);
    CHECK(texts.description == one.text);
    CHECK(texts.patient == one.text);
  }
}

TEST_CASE("What is no text of its character set becomes the replacement character", "[imaging]") {
  CHECK(textsOf("", "a\xe9z").description == "a\xef\xbf\xbdz");
  CHECK(textsOf("ISO_IR 192", "a\xe9z").description == "a\xef\xbf\xbdz");
  CHECK(textsOf("ISO_IR 999", "a\xe9z").description == "a\xef\xbf\xbdz");
  CHECK(textsOf("ISO 2022 IR 6\\ISO 2022 IR 149", "a\x1b%%z").description == "a\xef\xbf\xbd%%z");
  CHECK(textsOf("GB18030", "a\xff").description == "a\xef\xbf\xbd");
  CHECK(textsOf("ISO_IR 100",
                "a\x07"
                "b")
            .description == "a b");
}
