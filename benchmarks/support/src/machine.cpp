// SPDX-License-Identifier: Apache-2.0
#include "bench/machine.h"

#include <thread>

#include "c3de/core/platform.h"

namespace bench {

Machine machine() { return {c3de::cpuName(), std::thread::hardware_concurrency()}; }

Build build() {
#ifdef NDEBUG
  constexpr bool assertions = false;
#else
  constexpr bool assertions = true;
#endif
  return {C3DE_BENCH_VERSION, C3DE_BENCH_COMPILER, C3DE_BENCH_BUILD, C3DE_BENCH_SANITIZERS, assertions};
}

}  // namespace bench
