// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace c3de {

/// The arguments of main() in UTF-8. On Windows main() receives them in the code page of the system, which lacks most
/// characters; they are read from the command line instead.
class ProgramArguments {
 public:
  ProgramArguments(int argc, char **argv);
  ProgramArguments(const ProgramArguments &) = delete;
  ProgramArguments &operator=(const ProgramArguments &) = delete;

  [[nodiscard]] int count() const { return static_cast<int>(pointers_.size()) - 1; }
  /// count() texts and a null pointer; valid as long as this object.
  [[nodiscard]] char **values() { return pointers_.data(); }

 private:
  std::vector<std::string> texts_;
  std::vector<char *> pointers_;
};

}  // namespace c3de
