// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace c3de {

/// Called when a precondition is violated; the default prints and aborts. Tests replace it to count calls.
using AssertHandler = void (*)(const char *condition, const char *text, const char *file, int line);
AssertHandler setAssertHandler(AssertHandler handler);
void reportAssertion(const char *condition, const char *text, const char *file, int line);

}  // namespace c3de

#if defined(NDEBUG) && !defined(C3DE_KEEP_ASSERTIONS)
#define C3DE_ASSERT(condition, text) ((void)0)
#else
#define C3DE_ASSERT(condition, text) \
  ((condition) ? (void)0 : ::c3de::reportAssertion(#condition, text, __FILE__, __LINE__))
#endif
