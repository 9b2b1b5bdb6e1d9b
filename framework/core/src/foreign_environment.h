// SPDX-License-Identifier: Apache-2.0
// What code from outside may change of the thread and process it is called in, unseen: how numbers are rounded, and how
// they are written.
#pragma once

#include <cstdint>
#include <string>

namespace c3de::detail {

/// How this thread computes: rounding, denormal numbers, traps, on x86 also the precision of the x87 unit. Without the
/// flags that operations leave. A few nanoseconds.
[[nodiscard]] std::uint64_t floatControl() noexcept;
void setFloatControl(std::uint64_t control) noexcept;
/// In what the first differs from the second, for people: "rounds upward".
[[nodiscard]] std::string floatDifference(std::uint64_t is, std::uint64_t was);

/// Keeps the locale of the program, when it is called first; later calls give it back where it is another: that of the
/// C library, of this thread, and of C++. Returns what it was instead, empty: the same. Some ten nanoseconds.
[[nodiscard]] std::string restoreLocale();
/// Of this thread alone, where the system has such. True: it was not that of the process.
bool resetThreadLocale() noexcept;  // platform_*.cpp

}  // namespace c3de::detail
