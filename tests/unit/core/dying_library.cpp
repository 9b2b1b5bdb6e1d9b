// SPDX-License-Identifier: Apache-2.0
#include <stdexcept>
#include <thread>

#ifdef _WIN32
#define EXPORTED __declspec(dllexport)
#else
#define EXPORTED __attribute__((visibility("default")))
#endif

extern "C" EXPORTED void begin_thread() {
  std::thread([] { throw std::runtime_error("nobody catches this"); }).detach();
}
