// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <utility>

#include "c3de/abi/base.h"
#include "c3de/core/error_status.h"
#include "c3de/core/expected.h"

namespace c3de::embed {

/// A status for the caller and its text.
struct Failure {
  c3de_status code = C3DE_E_INTERNAL;
  std::string text;
};

template <class T>
using Result = tl::expected<T, Failure>;

[[nodiscard]] inline tl::unexpected<Failure> refuse(c3de_status code, std::string text) {
  return tl::unexpected(Failure{code, std::move(text)});
}
[[nodiscard]] inline tl::unexpected<Failure> refuse(const Error &error) {
  // The caller wrote no option.
  const std::string_view option = "--set ";
  const std::size_t from = error.message.starts_with(option) ? option.size() : 0;
  return tl::unexpected(Failure{statusOf(error.code), error.message.substr(from)});
}

}  // namespace c3de::embed
