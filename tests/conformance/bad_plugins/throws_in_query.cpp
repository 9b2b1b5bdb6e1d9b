// SPDX-License-Identifier: Apache-2.0
// Lets an exception escape from the entry function.
#include <stdexcept>

#include "c3de/abi/entry.h"

C3DE_EXPORT c3de_status C3DE_CALL c3de_plugin_query(const c3de_offer *, c3de_answer *) {
  throw std::runtime_error("thrown in query");
}
