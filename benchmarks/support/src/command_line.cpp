// SPDX-License-Identifier: Apache-2.0
#include "bench/command_line.h"

#include <cstdio>
#include <cstdlib>
#include <utility>

namespace bench {

CommandLine::CommandLine(std::string name) : name_(std::move(name)) {}

void CommandLine::add(std::string option, std::string value, std::function<void(const std::string &)> take) {
  added_.push_back({std::move(option), std::move(value), std::move(take)});
}

std::optional<int> CommandLine::parse(int argc, char **argv) {
  options_ = defaults;
  std::vector<Option> known = added_;
  const auto common = [&](const char *option, const char *value, std::function<void(const std::string &)> take) {
    known.push_back({option, value, std::move(take)});
  };
  common("--threads", "N", [this](const std::string &text) {
    options_.threads = static_cast<unsigned>(std::strtoul(text.c_str(), nullptr, 10));
  });
  common("--seconds", "S", [this](const std::string &text) { options_.seconds = std::strtod(text.c_str(), nullptr); });
  common("--json", "FILE", [this](const std::string &text) { options_.json = text; });
  common("--csv", "FILE", [this](const std::string &text) { options_.csv = text; });
  std::string usage = "usage: " + name_;
  for (const Option &option : known) usage += " [" + option.option + " " + option.value + "]";
  for (int i = 1; i < argc; ++i) {
    const std::string given = argv[i];
    if (given == "--help") {
      std::printf("%s\n", usage.c_str());
      return 0;
    }
    const Option *found = nullptr;
    for (const Option &option : known)
      if (option.option == given) found = &option;
    if (!found || i + 1 >= argc) {
      std::fprintf(stderr, "%s\n", usage.c_str());
      return 2;
    }
    found->take(argv[++i]);
  }
  if (options_.threads == 0 || !(options_.seconds > 0.0)) {
    std::fprintf(stderr, "%s: --threads and --seconds are to be above 0\n", name_.c_str());
    return 2;
  }
  return std::nullopt;
}

}  // namespace bench
