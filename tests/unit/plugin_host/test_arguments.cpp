// SPDX-License-Identifier: Apache-2.0
#include "arguments.h"

#include <limits>

#include "support/catch.h"

using namespace c3de;
using namespace c3de::plugin_host;

namespace {

c3de_str str(std::string_view s) { return {s.data(), s.size()}; }

/// A struct in its first revision, and in its current one.
struct First {
  std::uint32_t size;
  std::uint32_t a;
};
struct Now {
  std::uint32_t size;
  std::uint32_t a;
  std::uint64_t b;
};

template <class F>
std::pair<c3de_status, std::string> refusalOf(F &&f) {
  try {
    f();
  } catch (const Refusal &refusal) {
    return {refusal.status(), refusal.what()};
  }
  return {C3DE_OK, ""};
}

}  // namespace

/// Now has a member that First lacks: as in every struct of the boundary that has grown.
template <>
struct c3de::MinimumSize<Now> {
  static constexpr const char *name = "Now";
  static constexpr std::size_t value = sizeof(First);
};

TEST_CASE("UTF-8 is told from what is not") {
  CHECK(isUtf8(""));
  CHECK(isUtf8("plain"));
  CHECK(isUtf8("\xc2\xb3 \xe2\x82\xac \xf0\x9f\x99\x82"));
  CHECK_FALSE(isUtf8("\xff"));
  CHECK_FALSE(isUtf8("\xc3"));              // cut short
  CHECK_FALSE(isUtf8("\xc0\xaf"));          // over-long
  CHECK_FALSE(isUtf8("\xe0\x80\xaf"));      // over-long
  CHECK_FALSE(isUtf8("\xed\xa0\x80"));      // a surrogate
  CHECK_FALSE(isUtf8("\xf4\x90\x80\x80"));  // beyond U+10FFFF
  CHECK_FALSE(isUtf8("\x80"));
}

TEST_CASE("texts and ids are copied or refused with their name") {
  CHECK(textOf(str("mm\xc2\xb3"), "unit") == "mm\xc2\xb3");
  CHECK(textOf({nullptr, 0}, "unit").empty());
  CHECK(refusalOf([] { (void)textOf({nullptr, 3}, "unit"); }).second == "unit: null pointer with length 3");
  CHECK(refusalOf([] { (void)textOf({"x", UINT64_MAX}, "unit"); }).first == C3DE_E_ARG);
  CHECK(idOf(str("c3de.log/1"), "id") == "c3de.log/1");
  CHECK(refusalOf([] { (void)idOf(str(""), "id"); }).second == "id: is empty");
  CHECK_THAT(refusalOf([] { (void)idOf(str("a b"), "id"); }).second, Contains("'a b'"));
  CHECK(refusalOf([] { (void)idOf(str(std::string(300, 'x')), "id"); }).first == C3DE_E_ARG);
}

TEST_CASE("a struct of an older caller is read as far as it goes, the rest is zero") {
  const First first{sizeof(First), 7};
  const Now read = structOf(reinterpret_cast<const Now *>(&first), "thing");
  CHECK(read.a == 7);
  CHECK(read.b == 0);
}

TEST_CASE("a struct of a newer caller is read as far as we know it") {
  struct Newer {
    Now known;
    std::uint64_t more;
  } newer{{sizeof(Newer), 7, 8}, 9};
  const Now read = structOf(&newer.known, "thing");
  CHECK(read.b == 8);
}

TEST_CASE("a struct below its first revision is refused") {
  const Now tooSmall{4, 7, 8};
  CHECK(refusalOf([&] { (void)structOf(&tooSmall, "thing"); }).second ==
        "thing: its member size is 4; at least 8 is required (Now)");
  const Now *volatile nothing = nullptr;  // volatile: hides the null pointer from the compiler
  CHECK(refusalOf([&] { (void)structOf(static_cast<const Now *>(nothing), "thing"); }).second == "thing is null");
}

TEST_CASE("an out struct is written as far as the caller has room, and keeps its size") {
  struct {
    First known;
    std::uint64_t canary;
  } older{{sizeof(First), 0}, 42};
  writeStruct(reinterpret_cast<Now *>(&older), Now{0, 5, 6}, "out");
  CHECK(older.known.a == 5);
  CHECK(older.known.size == sizeof(First));
  CHECK(older.canary == 42);
}

TEST_CASE("positions are read from any layout and kept as they are") {
  struct Row {
    double p[3];
    double other;
  };
  const Row rows[] = {{{1, 2, 3}, 0}, {{4, 5, 6}, 0}};
  const auto read = positionsOf({rows, 2, 3, C3DE_F64, sizeof(Row)}, "positions");
  CHECK(read == std::vector<Vec3>{{1, 2, 3}, {4, 5, 6}});
  // Rows that are not aligned.
  std::vector<unsigned char> bytes(1 + sizeof(float) * 3);
  const float third[] = {7, 8, 9};
  std::memcpy(bytes.data() + 1, third, sizeof third);
  CHECK(positionsOf({bytes.data() + 1, 1, 3, C3DE_F32, 0}, "positions") == std::vector<Vec3>{{7, 8, 9}});
  const PointRows inPlace({rows[0].p, 1, 3, C3DE_F64, 0}, "points");
  CHECK(reinterpret_cast<const double *>(inPlace.rows().data()) == rows[0].p);
}

TEST_CASE("a double that a float cannot hold is refused where floats are wanted") {
  const double huge[] = {1e300, 0, 0};
  CHECK_THAT(refusalOf([&] {
               (void)floatPositionsOf({huge, 1, 3, C3DE_F64, 0}, "centres");
             }).second,
             Contains("centres: row 0 is not finite"));
}

TEST_CASE("no rows need no data") {
  CHECK(positionsOf({nullptr, 0, 3, C3DE_F64, 0}, "positions").empty());
  CHECK(refusalOf([] { (void)positionsOf({nullptr, 1, 3, C3DE_F64, 0}, "positions"); }).second == "positions is null");
}

TEST_CASE("an array of structs of an older caller is read in the caller's steps") {
  const First older[3] = {{sizeof(First), 1}, {sizeof(First), 2}, {sizeof(First), 3}};
  const auto *rows = reinterpret_cast<const Now *>(older);
  const std::uint64_t step = strideOf(rows, 0, "rows");
  CHECK(step == sizeof(First));
  for (std::uint64_t i = 0; i < 3; ++i) {
    const Now read = structOf(reinterpret_cast<const Now *>(reinterpret_cast<const char *>(older) + i * step), "row");
    CHECK(read.a == i + 1);
    CHECK(read.b == 0);
  }
  CHECK(strideOf(rows, 64, "rows") == 64);
  for (const std::uint64_t bad : {std::uint64_t{4}, std::uint64_t{9}, std::uint64_t{1} << 40})
    CHECK(refusalOf([&] { (void)strideOf(rows, bad, "rows"); }).first == C3DE_E_ARG);
}
