// SPDX-License-Identifier: Apache-2.0
#ifndef NOMINMAX
#define NOMINMAX
#endif
#include <windows.h>

#include <exception>

#include "c3de/core/per_thread.h"

namespace c3de::detail {

ThreadKey::ThreadKey(void (*destroy)(void *)) noexcept : index_(FlsAlloc(destroy)) {
  if (index_ == FLS_OUT_OF_INDEXES) std::terminate();
  // Threads that end later call the function: its module stays.
  HMODULE module = nullptr;
  (void)GetModuleHandleExW(GET_MODULE_HANDLE_EX_FLAG_PIN | GET_MODULE_HANDLE_EX_FLAG_FROM_ADDRESS,
                           reinterpret_cast<LPCWSTR>(destroy), &module);
}
void *ThreadKey::get() const noexcept { return FlsGetValue(index_); }
void ThreadKey::set(void *value) const noexcept { FlsSetValue(index_, value); }

}  // namespace c3de::detail
