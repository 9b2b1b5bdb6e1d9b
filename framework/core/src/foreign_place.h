// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace c3de::detail {

/// Where the present thread is, or has been, outside of the program.
struct ForeignPlace {
  const char *owner = nullptr, *what = nullptr;  ///< null: in no such call so far
  bool isInside = false;                         ///< else the last call has returned
};
/// Also for handlers of signals and of exit().
[[nodiscard]] ForeignPlace foreignPlaceOfThread() noexcept;
/// The last call of the present thread that has returned, of another owner than this one; none: null.
[[nodiscard]] ForeignPlace earlierPlaceOfThread(const char *owner) noexcept;

}  // namespace c3de::detail
