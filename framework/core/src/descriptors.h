// SPDX-License-Identifier: Apache-2.0
// File descriptors, in platform_posix.cpp and platform_win32.cpp.
#pragma once

#include <cstdio>

namespace c3de {

[[nodiscard]] int duplicateDescriptor(int descriptor);  ///< < 0: not possible
/// Redirects output written to a descriptor to another one.
void redirectDescriptor(int descriptor, int to);
void closeDescriptor(int descriptor);
[[nodiscard]] int descriptorOf(std::FILE *file);

}  // namespace c3de
