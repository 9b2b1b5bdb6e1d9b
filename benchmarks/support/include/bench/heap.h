// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace bench {

/// Bytes allocated by operator new and not yet freed, with the library c3de_benchmark_heap. Without the overhead of the
/// allocator, and without direct calls of malloc (matrices of Eigen whose size is set at run time).
[[nodiscard]] std::size_t heapBytes();

}  // namespace bench
