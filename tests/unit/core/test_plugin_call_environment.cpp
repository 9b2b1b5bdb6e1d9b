// SPDX-License-Identifier: Apache-2.0
// Rounding and formatting of numbers after a call into external code.
#include <cfenv>
#include <clocale>
#include <cstdio>
#include <locale>
#include <sstream>
#include <string>
#include <vector>

#if defined(__SSE2__) || defined(_M_X64)
#include <xmmintrin.h>
#endif

#include "c3de/core/environment_faults.h"
#include "c3de/core/plugin_call.h"
#include "support/catch.h"

using namespace c3de;

namespace {

bool isReported(const std::string &owner, const std::string &says) {
  for (const std::string &line : environmentFaults())
    if (line.find("plugin " + owner + ":") == 0 && line.find(says) != std::string::npos) return true;
  return false;
}

/// A number as the program writes it.
std::string written() {
  char text[32];
  (void)std::snprintf(text, sizeof text, "%.1f", 1234.5);
  std::ostringstream stream;
  stream << 1234.5;
  return text + (" " + stream.str());
}

}  // namespace

TEST_CASE("A call that changes the rounding is named, and the program rounds as before") {
  for (const auto &[mode, says] :
       {std::pair(FE_UPWARD, "it rounds upward"), std::pair(FE_DOWNWARD, "it rounds downward"),
        std::pair(FE_TOWARDZERO, "it rounds towards zero")}) {
    const char *owner = internedName(std::string("org.rounding") + std::to_string(mode));
    (void)callPluginFunction(owner, "step", CallKind::step,
                             [mode = mode]() -> c3de_status { return std::fesetround(mode); });
    CHECK(std::fegetround() == FE_TONEAREST);
    CHECK(isReported(owner, std::string("step has changed the floating-point or locale settings: ") + says));
  }
}

TEST_CASE("A call within another one gives back the rounding of the outer one") {
  const PluginCall outer("org.outer", "step", CallKind::step);
  std::fesetround(FE_UPWARD);
  { const PluginCall inner("org.inner", "apply", CallKind::step); }
  CHECK(std::fegetround() == FE_UPWARD);
  CHECK_FALSE(isReported("org.inner", ""));
  {
    const PluginCall inner("org.inner", "apply", CallKind::part);
    std::fesetround(FE_TONEAREST);
  }
  CHECK(std::fegetround() == FE_UPWARD);
  CHECK(isReported("org.inner", "rounds to nearest"));
  std::fesetround(FE_TONEAREST);
}

TEST_CASE("What was changed outside of a recorded call is restored before the next one") {
  { const PluginCall before("org.earlier", "status", CallKind::prompt); }
  std::fesetround(FE_DOWNWARD);
  int within = -1;
  (void)callPluginFunction("org.later", "step", CallKind::step, [&within]() -> c3de_status {
    within = std::fegetround();
    return C3DE_OK;
  });
  CHECK(within == FE_TONEAREST);
  CHECK(std::fegetround() == FE_TONEAREST);
  CHECK(isReported("org.earlier", "rounds downward"));
  CHECK_FALSE(isReported("org.later", ""));
}

#if defined(__SSE2__) || defined(_M_X64)
TEST_CASE("A call that flushes denormal numbers or traps is named, and its flags stay") {
  (void)callPluginFunction("org.flush", "create", CallKind::prompt, []() -> c3de_status {
    _mm_setcsr(_mm_getcsr() | 0x8040u);
    return C3DE_OK;
  });
  CHECK((_mm_getcsr() & 0x8040u) == 0u);
  CHECK(isReported("org.flush", "denormal"));
  (void)callPluginFunction("org.trap", "create", CallKind::prompt, []() -> c3de_status {
    _mm_setcsr(_mm_getcsr() & ~0x0080u);
    return C3DE_OK;
  });
  CHECK((_mm_getcsr() & 0x0080u) != 0u);
  CHECK(isReported("org.trap", "traps"));
  (void)callPluginFunction("org.flags", "create", CallKind::prompt, []() -> c3de_status {
    (void)std::feraiseexcept(FE_INEXACT);
    return C3DE_OK;
  });
  CHECK_FALSE(isReported("org.flags", ""));
}
#endif

TEST_CASE("A call that changes the locale is named, and numbers are written as before") {
  struct Comma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
  };
  const std::string before = written();
  (void)callPluginFunction("org.cpp", "create", CallKind::prompt, []() -> c3de_status {
    std::locale::global(std::locale(std::locale(), new Comma));
    return C3DE_OK;
  });
  CHECK(written() == before);
  CHECK(isReported("org.cpp", "it writes numbers as in the locale"));
  // The available locales depend on the machine; this one is in every C library of Linux.
  bool isThere = false;
  (void)callPluginFunction("org.c", "create", CallKind::prompt, [&isThere]() -> c3de_status {
    isThere = std::setlocale(LC_ALL, "C.UTF-8") != nullptr;
    return C3DE_OK;
  });
  CHECK(std::setlocale(LC_ALL, nullptr) == std::string("C"));
  CHECK(isReported("org.c", "C.UTF-8") == isThere);
}
