// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <string>

#include "c3de/core/platform.h"

/// Sets an environment variable for its lifetime, for this process and its child processes; empty: unset.
class ScopedEnvironment {
 public:
  ScopedEnvironment(std::string name, const std::string &value)
      : name_(std::move(name)), before_(c3de::environmentVariable(name_.c_str())) {
    set(value);
  }
  ~ScopedEnvironment() { set(before_); }
  ScopedEnvironment(const ScopedEnvironment &) = delete;
  ScopedEnvironment &operator=(const ScopedEnvironment &) = delete;

 private:
  void set(const std::string &value) const {
#ifdef _WIN32
    _putenv_s(name_.c_str(), value.c_str());
#else
    if (value.empty())
      unsetenv(name_.c_str());
    else
      setenv(name_.c_str(), value.c_str(), 1);
#endif
  }

  std::string name_, before_;
};
