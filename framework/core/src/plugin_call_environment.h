// SPDX-License-Identifier: Apache-2.0
// State of the calling thread and process that plugin code may change unnoticed: the floating-point environment, and
// the locale.
#pragma once

#include <cstdint>
#include <string>

namespace c3de::detail {

/// Floating-point control of this thread: rounding, denormal numbers, traps, on x86 also the precision of the x87 unit.
/// Without the status flags of operations. A few nanoseconds.
[[nodiscard]] std::uint64_t floatControl() noexcept;
void setFloatControl(std::uint64_t control) noexcept;
/// How the first differs from the second, for display: "rounds upward".
[[nodiscard]] std::string floatDifference(std::uint64_t is, std::uint64_t was);

/// The first call stores the locale of the program; later calls restore it if it has changed: that of the C library, of
/// this thread, and of C++. Returns the changed locale; empty: unchanged. Some ten nanoseconds.
[[nodiscard]] std::string restoreLocale();
/// For this thread only, if the system supports it. True: it differed from that of the process.
bool resetThreadLocale() noexcept;  // platform_*.cpp

}  // namespace c3de::detail
