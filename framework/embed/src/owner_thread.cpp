// SPDX-License-Identifier: Apache-2.0
#include "owner_thread.h"

#include "c3de/core/embedding.h"

namespace c3de::embed {

OwnerThread::OwnerThread() : thread_([this] { loop(); }) {}

OwnerThread::~OwnerThread() {
  {
    const std::lock_guard lock(mutex_);
    isOver_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void OwnerThread::run(const std::function<void()> &work) {
  std::unique_lock lock(mutex_);
  work_ = &work;
  changed_.notify_all();
  changed_.wait(lock, [this] { return work_ == nullptr; });
}

void OwnerThread::loop() {
  // Threads inherit the floating-point environment of the caller, and those of the pool that of this one.
  const OwnEnvironment environment;
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return work_ != nullptr || isOver_; });
    if (work_ == nullptr) return;
    const std::function<void()> &work = *work_;
    lock.unlock();
    work();
    lock.lock();
    work_ = nullptr;
    changed_.notify_all();
  }
}

}  // namespace c3de::embed
