// SPDX-License-Identifier: Apache-2.0
// Lifetime of force fields in the SDK, against a host of a few lines.
#include <memory>

#include "c3de/sdk/sdk.hpp"
#include "support/catch.h"

using namespace c3de;

namespace {

/// Provides one table and records, when a field is removed, whether its function still exists.
struct SmallHost {
  SmallHost() {
    forces.size = sizeof forces;
    forces.rev = 1;
    forces.ctx = this;
    forces.add = [](void *ctx, c3de_handle, const c3de_force_field *, c3de_handle *out) -> c3de_status {
      out->v = ++static_cast<SmallHost *>(ctx)->added;
      return C3DE_OK;
    };
    forces.remove = [](void *ctx, c3de_handle) -> c3de_status {
      auto &host = *static_cast<SmallHost *>(ctx);
      ++host.removed;
      if (host.function.expired()) host.removedTooLate = true;
      return C3DE_OK;
    };
    abi.size = sizeof abi;
    abi.ctx = this;
    abi.get_service = [](void *ctx, c3de_str, std::uint32_t, const void **table) -> c3de_status {
      *table = &static_cast<SmallHost *>(ctx)->forces;
      return C3DE_OK;
    };
  }
  sdk::ForceField add(std::weak_ptr<int> *watch = nullptr) {
    auto part = std::make_shared<int>(0);
    if (watch) *watch = part;
    auto field =
        sdk::Forces(sdk::Host(&abi)).add("field", [part](const c3de_force_call &) -> sdk::Result<void> { return {}; });
    REQUIRE(field);
    return std::move(*field);
  }

  c3de_host abi{};
  c3de_forces_v1 forces{};
  std::uint64_t added = 0, removed = 0;
  std::weak_ptr<int> function;  // of the removed field
  bool removedTooLate = false;
};

}  // namespace

TEST_CASE("a force field is removed before its function goes, also where another takes its place") {
  SmallHost host;
  {
    sdk::ForceField field = host.add(&host.function);
    CHECK_FALSE(host.function.expired());
    field = host.add();
    CHECK(host.removed == 1);
    CHECK_FALSE(host.removedTooLate);
    CHECK(host.function.expired());

    field = host.add(&host.function);
    CHECK(host.removed == 2);
    host.removedTooLate = false;
  }
  CHECK(host.removed == 3);
  CHECK_FALSE(host.removedTooLate);
}
