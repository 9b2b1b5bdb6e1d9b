// SPDX-License-Identifier: Apache-2.0
#include "bench/command_line.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>

#include "bench/report.h"

namespace bench {
namespace {

constexpr const char *kCommonOptions = "[--threads N] [--seconds S] [--json FILE] [--csv FILE]";

std::string usageOf(const std::string &name, const std::vector<Question> &questions) {
  std::string usage = "usage: " + name + " [QUESTION] " + kCommonOptions + "\nquestions, all of them by default:";
  for (const Question &question : questions) usage += "\n  " + question.name + " " + question.options;
  return usage;
}

enum class Kind { unknown, flag, value };

// "[--quick]" is a flag, "[--only TEXT]" has a value.
Kind kindOf(const std::string &option, const std::string &usage) {
  if (usage.find("[" + option + "]") != std::string::npos) return Kind::flag;
  return usage.find("[" + option + " ") != std::string::npos ? Kind::value : Kind::unknown;
}

int refuse(const std::string &text, int code) {
  std::fprintf(stderr, "%s\n", text.c_str());
  return code;
}

}  // namespace

std::vector<std::string> Options::texts(const std::string &option) const {
  std::vector<std::string> out;
  for (const auto &[name, value] : given_)
    if (name == option) out.push_back(value);
  return out;
}

std::string Options::text(const std::string &option, const std::string &otherwise) const {
  const std::vector<std::string> all = texts(option);
  return all.empty() ? otherwise : all.back();
}

double Options::number(const std::string &option, double otherwise) const {
  return has(option) ? std::strtod(text(option).c_str(), nullptr) : otherwise;
}

std::size_t Options::count(const std::string &option, std::size_t otherwise) const {
  return has(option) ? std::strtoul(text(option).c_str(), nullptr, 10) : otherwise;
}

int run(const std::string &name, const std::vector<Question> &questions, int argc, char **argv) {
  const std::string usage = usageOf(name, questions);
  std::vector<Question> requested = questions;
  int first = 1;
  if (argc > 1 && argv[1][0] != '-') {
    std::erase_if(requested, [&](const Question &question) { return question.name != argv[1]; });
    first = 2;
  }
  std::string known = kCommonOptions;
  for (const Question &question : requested) known += question.options;
  Options options;
  for (int i = first; i < argc; ++i) {
    const std::string option = argv[i];
    if (option == "--help") return std::printf("%s\n", usage.c_str()) > 0 ? 0 : 7;
    const Kind kind = kindOf(option, known);
    if (kind == Kind::unknown || (kind == Kind::value && i + 1 >= argc)) return refuse(usage, 2);
    options.add(option, kind == Kind::value ? argv[++i] : "");
  }
  if (requested.empty()) return refuse(usage, 2);
  options.threads = static_cast<unsigned>(options.count("--threads", options.threads));
  options.seconds = options.number("--seconds", options.seconds);
  options.json = options.text("--json");
  options.csv = options.text("--csv");
  if (options.threads == 0 || !(options.seconds > 0.0))
    return refuse(name + ": --threads and --seconds are to be above 0", 2);
  Report report(name, options);
  try {
    for (const Question &question : requested) question.measure(options, report);
  } catch (const std::invalid_argument &error) {
    return refuse(name + ": " + error.what(), 2);
  } catch (const std::exception &error) {
    return refuse(name + ": " + error.what(), 1);
  }
  return report.write();
}

}  // namespace bench
