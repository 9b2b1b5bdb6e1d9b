// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace c3de {

/// From here on the calling thread gives way to those of its program that answer a person, where there are fewer
/// processors than threads that want one; where there are enough it loses nothing. There is no way back. Without effect
/// where the system knows no priorities of threads.
void giveWay();

}  // namespace c3de
