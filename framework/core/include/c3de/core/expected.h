// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace c3de {

/// The category of an error; determines exit codes and ABI status codes.
enum class ErrorCode {
  usage,      ///< the caller requested something that does not exist or is out of range
  input,      ///< a file is unreadable, malformed or refused
  plugin,     ///< a plugin is missing or refused
  diverged,   ///< the simulation produced non-finite values
  graphics,   ///< no usable OpenGL
  output,     ///< a file cannot be written
  cancelled,  ///< a user or the time limit stopped it
  state,      ///< not possible now
  internal    ///< a bug in the program
};

/// States the object, the value and what is accepted; addressed to the person who can correct it.
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
