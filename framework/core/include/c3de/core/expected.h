// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace c3de {

/// What kind of thing went wrong; decides exit codes and ABI status codes.
enum class ErrorCode {
  usage,      ///< the caller asked for something that does not exist or is out of range
  input,      ///< a file is unreadable, malformed or refused
  plugin,     ///< a plugin is missing or refused
  diverged,   ///< the simulation left the finite numbers
  graphics,   ///< no usable OpenGL
  output,     ///< a file cannot be written
  cancelled,  ///< a person or the time limit stopped it
  state,      ///< not possible now
  internal    ///< a mistake of ours
};

/// Names the object, the value and what is accepted; written for the person who can mend it.
struct Error {
  ErrorCode code = ErrorCode::internal;
  std::string message;
};

template <class T>
using Expected = tl::expected<T, Error>;

[[nodiscard]] inline tl::unexpected<Error> fail(ErrorCode code, std::string message) {
  return tl::unexpected<Error>(Error{code, std::move(message)});
}

}  // namespace c3de
