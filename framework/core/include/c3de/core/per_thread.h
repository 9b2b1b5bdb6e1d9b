// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace c3de {

#if defined(_WIN32)
namespace detail {

/// A pointer per thread. The function is called for it at the end of each thread that has set it. Never freed: threads
/// may end while the process does.
class ThreadKey {
 public:
  explicit ThreadKey(void (*destroy)(void *)) noexcept;
  ThreadKey(const ThreadKey &) = delete;
  ThreadKey &operator=(const ThreadKey &) = delete;
  [[nodiscard]] void *get() const noexcept;
  void set(void *value) const noexcept;

 private:
  unsigned long index_;
};

}  // namespace detail
#endif

/// An object of each thread, made by its default constructor in the first call in the thread and destroyed at the end
/// of the thread.
///
/// For types with a destructor in place of thread_local: MinGW frees the emulated storage of a thread before it runs
/// the destructors of the objects in it.
/// @tparam Tag  distinguishes objects of the same type
/// @threads any
template <class T, class Tag = T>
[[nodiscard]] T &perThread() {
#if defined(_WIN32)
  static const auto &key = *new detail::ThreadKey([](void *object) { delete static_cast<T *>(object); });
  if (void *known = key.get()) return *static_cast<T *>(known);
  T *made = new T;
  key.set(made);
  return *made;
#else
  thread_local T object;
  return object;
#endif
}

}  // namespace c3de
