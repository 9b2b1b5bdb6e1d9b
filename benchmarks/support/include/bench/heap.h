// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace bench {

/// Bytes that operator new has given out and not got back, with the library c3de_benchmark_heap; without what the
/// allocator adds, and without what calls malloc itself (matrices of Eigen with a size found at run time).
[[nodiscard]] std::size_t heapBytes();

}  // namespace bench
