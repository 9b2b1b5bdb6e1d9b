// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <mutex>

#include "c3de/core/platform.h"
#include "descriptors.h"

namespace c3de {
namespace {

constexpr int kErrorStream = 2;
constexpr std::size_t kMost = std::size_t{1} << 20;  // bytes of text

}  // namespace

struct ErrorStreamCapture::Impl {
  // The process has one error stream, so captures wait for each other.
  static std::mutex &turn() {
    static std::mutex mutex;
    return mutex;
  }
  std::lock_guard<std::mutex> lock{turn()};
  std::FILE *file = std::tmpfile();
  int saved = -1;

  Impl() {
    std::fflush(stderr);
    if (file) saved = duplicateDescriptor(kErrorStream);
    if (saved >= 0) redirectDescriptor(kErrorStream, descriptorOf(file));
  }
  ~Impl() {
    giveBack();
    if (file) std::fclose(file);
  }
  void giveBack() {
    if (saved < 0) return;
    std::fflush(stderr);
    redirectDescriptor(kErrorStream, saved);
    closeDescriptor(saved);
    saved = -1;
  }
};

ErrorStreamCapture::ErrorStreamCapture() : impl_(std::make_unique<Impl>()) {}
ErrorStreamCapture::~ErrorStreamCapture() = default;

std::string ErrorStreamCapture::text() {
  impl_->giveBack();
  std::string all;
  if (!impl_->file) return all;
  std::rewind(impl_->file);
  for (int c; all.size() < kMost && (c = std::fgetc(impl_->file)) != EOF;) all += static_cast<char>(c);
  return all;
}

}  // namespace c3de
