// SPDX-License-Identifier: Apache-2.0
// Treats denormal numbers as zero while a guard exists. Private to the core.
#pragma once

#include <cstdint>

#if defined(__SSE2__) || defined(_M_X64)
#include <xmmintrin.h>
#define POINTBASED_FLUSH_X86
#elif defined(__aarch64__) && (defined(__GNUC__) || defined(__clang__))
#define POINTBASED_FLUSH_ARM
#endif

namespace pointbased::detail {

/// Sets the floating-point unit of the calling thread to flush denormal results and to read denormal operands as zero.
/// The destructor restores the previous mode. Not copyable; nested guards only cost a read. No effect on other
/// processors.
///
/// A denormal number times 0.95 rounds to itself: decay would never end, and each operation would cost a hundred
/// cycles. Normal results have the same bits in both modes.
class FlushDenormals {
 public:
  FlushDenormals() : before_(read()) {
    if ((before_ & kMode) != kMode) write(before_ | kMode);
  }
  ~FlushDenormals() {
    // Restores the mode only; accumulated exception flags are preserved.
    if ((before_ & kMode) != kMode) write((read() & ~kMode) | (before_ & kMode));
  }
  FlushDenormals(const FlushDenormals &) = delete;
  FlushDenormals &operator=(const FlushDenormals &) = delete;

  /// False on processors that are not supported.
  [[nodiscard]] static constexpr bool works() { return kMode != 0; }

 private:
#if defined(POINTBASED_FLUSH_X86)
  static constexpr std::uint64_t kMode = 0x8040;  // FTZ, DAZ
  static std::uint64_t read() { return _mm_getcsr(); }
  static void write(std::uint64_t mode) { _mm_setcsr(static_cast<unsigned>(mode)); }
#elif defined(POINTBASED_FLUSH_ARM)
  static constexpr std::uint64_t kMode = 1u << 24;  // FZ: operands and results
  static std::uint64_t read() {
    std::uint64_t mode;
    asm volatile("mrs %0, fpcr" : "=r"(mode));
    return mode;
  }
  static void write(std::uint64_t mode) { asm volatile("msr fpcr, %0" : : "r"(mode)); }
#else
  static constexpr std::uint64_t kMode = 0;
  static std::uint64_t read() { return 0; }
  static void write(std::uint64_t) {}
#endif

  std::uint64_t before_;
};

}  // namespace pointbased::detail
