// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

namespace c3de::embed {

/// The thread that loads and unloads the plugins of one simulation: they require that it is always the same.
class OwnerThread {
 public:
  OwnerThread();
  ~OwnerThread();  ///< waits for its end
  OwnerThread(const OwnerThread &) = delete;
  OwnerThread &operator=(const OwnerThread &) = delete;

  /// Runs the work there and waits for it. The work must not throw. One at a time.
  void run(const std::function<void()> &work);

 private:
  void loop();

  std::mutex mutex_;
  std::condition_variable changed_;
  const std::function<void()> *work_ = nullptr;
  bool isOver_ = false;
  std::thread thread_;
};

}  // namespace c3de::embed
