// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>

namespace pointbased {

/// Processor time of one thread. Any thread may read it while that thread runs.
class ThreadClock {
 public:
  ThreadClock() = default;  ///< of no thread: always 0
  [[nodiscard]] static ThreadClock ofThisThread();
  /// ns of computing time of the thread. The resolution on Windows is about 16 ms.
  [[nodiscard]] std::int64_t now() const noexcept;

 private:
  std::shared_ptr<void> thread_;  // handle of the operating system; null if none
};

}  // namespace pointbased
