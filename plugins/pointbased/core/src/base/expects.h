// SPDX-License-Identifier: Apache-2.0
// Preconditions of public functions, checked in every build: a few comparisons per call, never per point. Private to
// the core.
#pragma once

namespace pointbased::detail {

[[noreturn]] void breakPrecondition(const char *condition, const char *text, const char *function);

}  // namespace pointbased::detail

#define POINTBASED_EXPECTS(condition, text) \
  ((condition) ? (void)0 : ::pointbased::detail::breakPrecondition(#condition, text, __func__))
