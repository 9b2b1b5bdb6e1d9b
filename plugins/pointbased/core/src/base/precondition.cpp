// SPDX-License-Identifier: Apache-2.0
#include "pointbased/precondition.h"

#include <atomic>
#include <cstdio>
#include <cstdlib>

#include "base/expects.h"

namespace pointbased {
namespace {

std::atomic<PreconditionHandler> chosenHandler{nullptr};

}  // namespace

PreconditionHandler setPreconditionHandler(PreconditionHandler handler) { return chosenHandler.exchange(handler); }

void detail::breakPrecondition(const char *condition, const char *text, const char *function) {
  if (const PreconditionHandler handler = chosenHandler.load()) {
    handler(condition, text, function);
  } else {
    std::fprintf(stderr, "pointbased: %s(): %s (%s does not hold)\n", function, text, condition);
  }
  std::abort();
}

}  // namespace pointbased
