// SPDX-License-Identifier: Apache-2.0
// main() of the test programs: names of cases are UTF-8, which the arguments of main() are not on Windows.
#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>
// After catch.hpp, which includes windows.h with fewer macros.
#include <windows.h>

#include <shellapi.h>

#include <string>
#include <vector>

int main() {
  int count = 0;
  wchar_t **wide = CommandLineToArgvW(GetCommandLineW(), &count);
  std::vector<std::string> arguments(static_cast<std::size_t>(count));
  std::vector<const char *> pointers;
  for (int i = 0; i < count; ++i) {
    std::string &text = arguments[static_cast<std::size_t>(i)];
    text.resize(static_cast<std::size_t>(WideCharToMultiByte(CP_UTF8, 0, wide[i], -1, nullptr, 0, nullptr, nullptr)));
    WideCharToMultiByte(CP_UTF8, 0, wide[i], -1, text.data(), static_cast<int>(text.size()), nullptr, nullptr);
    pointers.push_back(text.c_str());
  }
  return Catch::Session().run(count, pointers.data());
}
