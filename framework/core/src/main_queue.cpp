// SPDX-License-Identifier: Apache-2.0
#include "c3de/core/main_queue.h"

namespace c3de {

void MainQueue::post(std::function<void()> fn) {
  std::function<void()> waker;
  {
    std::lock_guard lock(mutex_);
    posted_.push_back(std::move(fn));
    waker = waker_;
  }
  if (waker) waker();
}

Handle MainQueue::addFrameCallback(std::string owner, std::function<void()> fn) {
  std::lock_guard lock(mutex_);
  return callbacks_.add({std::move(owner), std::move(fn)});
}

bool MainQueue::removeFrameCallback(Handle callback) {
  std::lock_guard lock(mutex_);
  return callbacks_.remove(callback);
}

void MainQueue::removeOwnedBy(const std::string &owner) {
  std::lock_guard lock(mutex_);
  std::vector<Handle> gone;
  callbacks_.forEach([&](Handle h, const Callback &callback) {
    if (callback.owner == owner) gone.push_back(h);
  });
  for (const Handle h : gone) callbacks_.remove(h);
}

void MainQueue::runFrame() {
  std::vector<std::function<void()>> posted;
  std::vector<Handle> callbacks;
  {
    std::lock_guard lock(mutex_);
    posted.swap(posted_);
    callbacks_.forEach([&](Handle h, const Callback &) { callbacks.push_back(h); });
    ++frame_;
  }
  for (const auto &fn : posted) fn();
  // By handle, because a callback may remove itself or others.
  for (const Handle h : callbacks) {
    std::function<void()> fn;
    {
      std::lock_guard lock(mutex_);
      if (const Callback *callback = callbacks_.find(h)) fn = callback->fn;
    }
    if (fn) fn();
  }
}

std::uint64_t MainQueue::frameIndex() const {
  std::lock_guard lock(mutex_);
  return frame_;
}

void MainQueue::setWaker(std::function<void()> waker) {
  std::lock_guard lock(mutex_);
  waker_ = std::move(waker);
}

void MainQueue::requestRedraw() {
  std::function<void()> waker;
  {
    std::lock_guard lock(mutex_);
    waker = waker_;
  }
  if (waker) waker();
}

}  // namespace c3de
