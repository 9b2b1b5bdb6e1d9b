// SPDX-License-Identifier: Apache-2.0
// What the functions of c3de/embed.h share: handles, arguments, errors. No exception leaves them.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <mutex>
#include <new>
#include <string>
#include <unordered_map>
#include <utility>

#include "c3de/core/path_text.h"
#include "c3de/core/plugin_call.h"
#include "simulation.h"
#include "warped_image.h"

namespace c3de::embed {

/// Of the calling thread.
[[nodiscard]] std::string &lastError();

/// Everything that is open. Never destroyed: the process may end while threads run.
struct OpenObjects {
  std::mutex mutex;
  std::unordered_map<c3de_sim, std::shared_ptr<EmbeddedSimulation>> simulations;
  std::unordered_map<c3de_image, std::shared_ptr<const WarpedImage>> images;
  std::uint64_t last = 0;  ///< number that was assigned
};
/// The first call makes this code embedded: the process belongs to its program. In a process that was forked since they
/// are others, and empty: the threads of the earlier ones do not exist there.
[[nodiscard]] OpenObjects &openObjects();

[[nodiscard]] Result<std::shared_ptr<EmbeddedSimulation>> findSimulation(c3de_sim sim);
[[nodiscard]] Result<std::shared_ptr<const WarpedImage>> findImage(c3de_image image);

/// Runs a function that returns Result<void>; its failure becomes status and text.
template <class F>
c3de_status guarded(const F &f) noexcept {
  try {
    lastError().clear();
    const Result<void> done = f();
    if (done) return C3DE_OK;
    lastError() = done.error().text;
    return done.error().code;
  } catch (const std::bad_alloc &) {
    lastError().clear();
    return C3DE_E_NOMEM;
  } catch (...) {
    try {
      lastError() = textOfException();
    } catch (...) {  // no memory for the text
    }
    return C3DE_E_EXCEPTION;
  }
}

[[nodiscard]] inline Result<void> notNull(const void *argument, const char *name) {
  if (argument != nullptr) return {};
  return refuse(C3DE_E_ARG, fmt::format("{} is null", name));
}

/// Writes the result of f(), a struct with `size`, as far as the caller knows it.
template <class T, class F>
Result<void> writeStruct(T *out, const F &f) {
  if (auto good = notNull(out, "out"); !good) return good;
  const std::uint32_t size = out->size;
  if (size < sizeof size || size > 4096)
    return refuse(C3DE_E_ARG, fmt::format("out->size is {}; accepted: sizeof, {}", size, sizeof(T)));
  auto result = f();
  if (!result) return tl::unexpected(result.error());
  result->size = size;
  std::memcpy(out, &*result, std::min<std::size_t>(size, sizeof(T)));
  return {};
}

/// f(simulation) for one that is open; writes the result to `out`.
template <class T, class F>
c3de_status callWithResult(c3de_sim sim, T *out, const char *name, const F &f) noexcept {
  return guarded([&]() -> Result<void> {
    if (auto good = notNull(out, name); !good) return good;
    const auto found = findSimulation(sim);
    if (!found) return tl::unexpected(found.error());
    const auto result = f(**found);
    if (!result) return tl::unexpected(result.error());
    *out = *result;
    return {};
  });
}

/// Same for a struct with `size`.
template <class T, class F>
c3de_status callWithStruct(c3de_sim sim, T *out, const F &f) noexcept {
  return guarded([&]() -> Result<void> {
    return writeStruct(out, [&]() -> Result<T> {
      const auto found = findSimulation(sim);
      if (!found) return tl::unexpected(found.error());
      return f(**found);
    });
  });
}

template <class F>
c3de_status callWithoutResult(c3de_sim sim, const F &f) noexcept {
  return guarded([&]() -> Result<void> {
    const auto found = findSimulation(sim);
    return found ? f(**found) : tl::unexpected(found.error());
  });
}

/// f(simulation, path)
template <class F>
c3de_status callWithFile(c3de_sim sim, const char *file, const F &f) noexcept {
  return callWithoutResult(sim, [&](EmbeddedSimulation &of) -> Result<void> {
    if (auto good = notNull(file, "file"); !good) return good;
    return f(of, pathFromText(file));
  });
}

/// Members that the caller does not know are 0.
template <class T>
Result<T> readStruct(const T *in, const char *name) {
  T known{};
  if (in == nullptr) return refuse(C3DE_E_ARG, fmt::format("{} is null", name));
  if (in->size < sizeof in->size || in->size > 4096)
    return refuse(C3DE_E_ARG, fmt::format("{}->size is {}; accepted: sizeof, {}", name, in->size, sizeof(T)));
  std::memcpy(&known, in, std::min<std::size_t>(in->size, sizeof(T)));
  return known;
}

[[nodiscard]] ProgressFn progressOf(c3de_embed_progress call, void *self);
/// Of the caller's options; null: all 0.
[[nodiscard]] Result<EmbeddedSimulation::Run> runOf(const c3de_embed_run_options *options);

}  // namespace c3de::embed
