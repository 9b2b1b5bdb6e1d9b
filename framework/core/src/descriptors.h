// SPDX-License-Identifier: Apache-2.0
// Numbers of open files, in platform_posix.cpp and platform_win32.cpp.
#pragma once

#include <cstdio>

namespace c3de {

[[nodiscard]] int duplicateDescriptor(int descriptor);  ///< < 0: not possible
/// What is written to a descriptor goes where another one leads.
void redirectDescriptor(int descriptor, int to);
void closeDescriptor(int descriptor);
[[nodiscard]] int descriptorOf(std::FILE *file);

}  // namespace c3de
