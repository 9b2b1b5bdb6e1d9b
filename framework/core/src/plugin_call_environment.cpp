// SPDX-License-Identifier: Apache-2.0
#include "plugin_call_environment.h"

#include <array>
#include <cfenv>
#include <clocale>
#include <cstring>
#include <locale>

#if defined(__SSE2__) || defined(_M_X64)
#include <xmmintrin.h>
#endif

namespace c3de::detail {
namespace {

#if defined(__SSE2__) || defined(_M_X64)

constexpr std::uint64_t kSseControl = 0xffc0;  // without the six flags
constexpr std::uint64_t kRounding = 0x6000, kDenormals = 0x8040, kTraps = 0x1f80;
constexpr unsigned kRoundingShift = 13;
constexpr std::array kRoundings{"it rounds to nearest", "it rounds downward", "it rounds upward",
                                "it rounds towards zero"};

#elif defined(__aarch64__) && defined(__GNUC__)

constexpr std::uint64_t kRounding = 3u << 22, kDenormals = 1u << 24, kTraps = 0x9f00;
constexpr unsigned kRoundingShift = 22;
constexpr std::array kRoundings{"it rounds to nearest", "it rounds upward", "it rounds downward",
                                "it rounds towards zero"};

#endif

}  // namespace

std::uint64_t floatControl() noexcept {
#if defined(__SSE2__) || defined(_M_X64)
  std::uint64_t control = _mm_getcsr() & kSseControl;
#if defined(__GNUC__)
  std::uint16_t x87 = 0;
  asm volatile("fnstcw %0" : "=m"(x87));
  control |= std::uint64_t{x87} << 32;
#endif
  return control;
#elif defined(__aarch64__) && defined(__GNUC__)
  std::uint64_t control = 0;
  asm volatile("mrs %0, fpcr" : "=r"(control));
  return control;
#else
  return static_cast<std::uint64_t>(std::fegetround());
#endif
}

void setFloatControl(std::uint64_t control) noexcept {
#if defined(__SSE2__) || defined(_M_X64)
  _mm_setcsr(static_cast<unsigned>((_mm_getcsr() & ~kSseControl & 0xffffu) | (control & kSseControl)));
#if defined(__GNUC__)
  const auto x87 = static_cast<std::uint16_t>(control >> 32);
  asm volatile("fldcw %0" : : "m"(x87));
#endif
#elif defined(__aarch64__) && defined(__GNUC__)
  asm volatile("msr fpcr, %0" : : "r"(control));
#else
  (void)std::fesetround(static_cast<int>(control));
#endif
}

std::string floatDifference(std::uint64_t is, std::uint64_t was) {
  std::string text;
  const auto add = [&](const char *what) { text += (text.empty() ? "" : ", ") + std::string(what); };
#if defined(__SSE2__) || defined(_M_X64) || (defined(__aarch64__) && defined(__GNUC__))
  const std::uint64_t differs = is ^ was;
  if ((differs & kRounding) != 0) add(kRoundings[(is & kRounding) >> kRoundingShift]);
  if ((differs & kDenormals) != 0)
    add((is & kDenormals) != 0 ? "denormal numbers are flushed to zero" : "it computes with denormal numbers");
  if ((differs & kTraps) != 0) add("it traps at other floating-point exceptions");
  if (differs >> 32 != 0 && (differs & kRounding) == 0) add("it has another x87 control word");
#else
  (void)is;
  (void)was;
#endif
  if (text.empty()) add("it rounds in another direction");
  return text;
}

std::string restoreLocale() {
  // Never destroyed: handlers of exit() may use it.
  static const auto *const ofC = new std::string(std::setlocale(LC_ALL, nullptr));
  static const auto *const ofCpp = new std::locale();
  std::string was;
  if (resetThreadLocale()) was = "a per-thread locale";
  if (std::locale() != *ofCpp) {
    was = "C++ " + std::locale().name();
    std::locale::global(*ofCpp);  // also sets that of C
  }
  if (const char *now = std::setlocale(LC_ALL, nullptr); std::strcmp(now, ofC->c_str()) != 0) {
    was = now;
    (void)std::setlocale(LC_ALL, ofC->c_str());
  }
  return was;
}

}  // namespace c3de::detail
