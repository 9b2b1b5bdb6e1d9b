// SPDX-License-Identifier: Apache-2.0
// Lines are written to a file per test case, so that ctest, which runs every case in its own process, leaves the whole
// table behind: sort and print the files in <test output>/validation. A program that runs several cases prints theirs
// itself.
#define CATCH_CONFIG_EXTERNAL_INTERFACES
#include "validation_table.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <sstream>
#include <vector>

#include "known_misses.h"
#include "support/catch.h"

namespace validation {

namespace {

std::filesystem::path fileOf(std::string testCase) {
  for (char &c : testCase)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  const auto folder = std::filesystem::path(testOutputRoot()) / "validation";
  std::filesystem::create_directories(folder);
  return folder / (testCase.substr(0, 100) + ".txt");
}

void append(const std::string &line) {
  std::ofstream(fileOf(Catch::getResultCapture().getCurrentTestName()), std::ios::app | std::ios::binary)
      << line << '\n';
}

std::string text(double value, int digits) {
  std::ostringstream out;
  out << std::setprecision(digits) << value;
  return out.str();
}
std::string fixed(double value) {
  std::ostringstream out;
  out << std::fixed << std::setprecision(0) << value;
  return out.str();
}

/// Continuation bytes of a UTF-8 character occupy no column.
std::string padded(const std::string &words, std::size_t columns, bool right = false) {
  std::size_t used = 0;
  for (const char c : words)
    if ((static_cast<unsigned char>(c) & 0xC0u) != 0x80u) ++used;
  const std::string space(columns > used ? columns - used : 1, ' ');
  return right ? space + words : words + space;
}

std::string percent(double value) {
  return std::abs(value) < 1e-4 && value != 0.0 ? text(value, 2) : text(100.0 * value, 3) + " %";
}

std::string line(const std::string &body, const std::string &quantity, const std::string &truth,
                 const std::string &ours, const std::string &error, const std::string &limit, const std::string &time,
                 const std::string &verdict) {
  return padded(body, 58) + padded(quantity, 26) + padded(truth, 24, true) + padded(ours, 14, true) +
         padded(error, 11, true) + padded(limit, 10, true) + padded(time, 9, true) + "  " + verdict;
}

class TablePrinter : public
#if __has_include(<catch2/catch_all.hpp>)
                     Catch::EventListenerBase {
 public:
  using Catch::EventListenerBase::EventListenerBase;
#else
                     Catch::TestEventListenerBase {
 public:
  using Catch::TestEventListenerBase::TestEventListenerBase;
#endif
  void testCaseStarting(const Catch::TestCaseInfo &info) override {
    files_.push_back(fileOf(info.name));
    std::filesystem::remove(files_.back());
  }
  void testRunEnded(const Catch::TestRunStats &) override {
    std::cout << '\n' << line("case", "quantity", "truth", "ours", "error", "limit", "ms", "") << '\n';
    for (const auto &file : files_)
      if (std::ifstream in(file, std::ios::binary); in && in.peek() != std::ifstream::traits_type::eof())
        std::cout << in.rdbuf();
    std::cout << std::endl;
  }

 private:
  std::vector<std::filesystem::path> files_;
};
CATCH_REGISTER_LISTENER(TablePrinter)

}  // namespace

double Row::error() const { return scale > 0.0 ? (ours - truth) / scale : ours / truth - 1.0; }

void judge(const std::string &body, const std::string &quantity, const Row &row) {
  const double error = row.error();
  const bool within = !row.limit || std::abs(error) <= *row.limit;  // false for NaN
  const std::string truth =
      text(row.truth, 6) + (row.uncertainty > 0.0 ? " ± " + text(row.uncertainty, 2) : std::string());
  const char *reason = knownMiss(body, quantity);
  const std::string verdict = !row.limit         ? "for the record"
                              : within && reason ? "ok (known_misses.h says missed)"
                              : within           ? "ok"
                              : reason           ? std::string("MISSED: ") + reason
                                                 : "MISSED";
  append(line(body, quantity, truth, text(row.ours, 6), percent(error), row.limit ? percent(*row.limit) : "-",
              fixed(row.milliseconds), verdict));
  INFO(body << ", " << quantity << ": truth " << truth << ", ours " << row.ours << ", error " << percent(error));
  if (!row.limit) {
    CHECK(std::isfinite(row.ours));
  } else if (!reason) {
    CHECK(std::abs(error) <= *row.limit);
  } else {
    CHECK_NOFAIL(std::abs(error) <= *row.limit);
  }
}

void noSolution(const std::string &body, const std::string &why, bool asked) {
  const char *reason = knownMiss(body, "");
  remark(body, "MISSED: no solution: " + why + (reason ? std::string(" (") + reason + ")" : std::string()));
  if (asked && !reason) FAIL_CHECK(body << ": " << why);
}

void remark(const std::string &body, const std::string &words) { append(padded(body, 58) + words); }

}  // namespace validation
