// SPDX-License-Identifier: Apache-2.0
#include <windows.h>

#include "c3de/core/per_thread.h"

namespace c3de::detail {

ThreadKey::ThreadKey(void (*destroy)(void *)) noexcept : index_(FlsAlloc(destroy)) {}
ThreadKey::~ThreadKey() { FlsFree(index_); }
void *ThreadKey::get() const noexcept { return FlsGetValue(index_); }
void ThreadKey::set(void *value) const noexcept { FlsSetValue(index_, value); }

}  // namespace c3de::detail
