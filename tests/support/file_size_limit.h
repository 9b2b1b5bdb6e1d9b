// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#if defined(_WIN32)
class FileSizeLimit {
 public:
  explicit FileSizeLimit(std::uint64_t) {}
  [[nodiscard]] bool isSet() const { return false; }
};
#else
#include <signal.h>
#include <sys/resource.h>

/// Limits the file size of this process during its lifetime: simulates a full disk without privileges.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(std::uint64_t bytes) {
    ::signal(SIGXFSZ, SIG_IGN);
    isSet_ = ::getrlimit(RLIMIT_FSIZE, &before_) == 0;
    rlimit now = before_;
    now.rlim_cur = bytes;
    isSet_ = isSet_ && ::setrlimit(RLIMIT_FSIZE, &now) == 0;
  }
  ~FileSizeLimit() {
    if (isSet_) ::setrlimit(RLIMIT_FSIZE, &before_);
  }
  FileSizeLimit(const FileSizeLimit &) = delete;
  FileSizeLimit &operator=(const FileSizeLimit &) = delete;
  [[nodiscard]] bool isSet() const { return isSet_; }

 private:
  rlimit before_{};
  bool isSet_ = false;
};
#endif
