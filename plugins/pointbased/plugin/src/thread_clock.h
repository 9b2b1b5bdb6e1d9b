// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>

namespace pointbased {

/// Processor time of one thread. Any thread may read it while that one runs.
class ThreadClock {
 public:
  ThreadClock() = default;  ///< of no thread: 0 at all times
  [[nodiscard]] static ThreadClock ofThisThread();
  /// ns that the thread has computed. Windows counts in steps of about 16 ms.
  [[nodiscard]] std::int64_t now() const noexcept;

 private:
  std::shared_ptr<void> thread_;  // what the system calls it; null: none
};

}  // namespace pointbased
