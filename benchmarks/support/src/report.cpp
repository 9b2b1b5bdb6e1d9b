// SPDX-License-Identifier: Apache-2.0
#include "bench/report.h"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <utility>

#include "bench/machine.h"

namespace bench {
namespace {

constexpr int kMinWidth = 9;

// Characters, not bytes: titles contain signs such as µ.
int lettersOf(const std::string &text) {
  return static_cast<int>(std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xc0) != 0x80; }));
}

std::string padded(const std::string &text, int width) {
  return std::string(static_cast<std::size_t>(std::max(0, width - lettersOf(text))), ' ') + text;
}

std::string textOf(const Report::Cell &cell, int digits) {
  if (cell.is_null()) return "-";
  if (cell.is_string()) return cell.get<std::string>();
  if (!cell.is_number_float()) return cell.dump();
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", digits, cell.get<double>());
  return text;
}

}  // namespace

Report::Report(std::string benchmark, const Options &options) : name_(std::move(benchmark)), options_(options) {
  const Machine on = machine();
  const Build by = build();
  json_ = {{"benchmark", name_},
           {"machine", {{"cpu", on.cpu}, {"cores", on.cores}}},
           {"build",
            {{"version", by.version},
             {"compiler", by.compiler},
             {"type", by.type},
             {"sanitizers", by.sanitizers},
             {"assertions", by.assertions}}},
           {"threads", options.threads},
           {"seconds", options.seconds},
           {"facts", nlohmann::ordered_json::object()},
           {"rows", nlohmann::ordered_json::array()}};
  std::printf("%s: %s, %u cores; %s, %s%s%s%s; %u thread%s\n", name_.c_str(), on.cpu.c_str(), on.cores,
              by.compiler.c_str(), by.type.c_str(), by.assertions ? ", with assertions" : "",
              by.sanitizers.empty() ? "" : ", sanitizers ", by.sanitizers.c_str(), options.threads,
              options.threads == 1 ? "" : "s");
}

void Report::table(std::string name, std::vector<Column> columns) {
  tableName_ = std::move(name);
  columns_ = std::move(columns);
  widths_.clear();
  std::string line;
  csv_ += "table";
  for (const Column &column : columns_) {
    widths_.push_back(std::max(kMinWidth, lettersOf(column.title)));
    if (!column.title.empty()) line += padded(column.title, widths_.back()) + "  ";
    csv_ += "," + column.key;
  }
  csv_ += "\n";
  std::printf("\n%s\n%s\n", tableName_.c_str(), line.c_str());
}

void Report::row(std::vector<Cell> cells) {
  nlohmann::ordered_json out = {{"table", tableName_}};
  std::string line;
  csv_ += tableName_;
  for (std::size_t i = 0; i < columns_.size() && i < cells.size(); ++i) {
    const Column &column = columns_[i];
    if (!column.title.empty()) line += padded(textOf(cells[i], column.digits), widths_[i]) + "  ";
    csv_ += "," + (cells[i].is_string() ? cells[i].get<std::string>() : cells[i].is_null() ? "" : cells[i].dump());
    out[column.key] = std::move(cells[i]);
  }
  csv_ += "\n";
  json_["rows"].push_back(std::move(out));
  std::printf("%s\n", line.c_str());
  std::fflush(stdout);
}

void Report::note(const std::string &text) {
  std::printf("%s\n", text.c_str());
  std::fflush(stdout);
}

void Report::fact(const std::string &key, Cell value) { json_["facts"][key] = std::move(value); }

int Report::write() const {
  const std::pair<std::string, std::string> files[] = {{options_.csv, csv_}, {options_.json, json_.dump(2) + "\n"}};
  for (const auto &[path, text] : files) {
    if (path.empty()) continue;
    std::ofstream file(path);
    file << text;
    file.close();
    if (!file) {
      std::fprintf(stderr, "%s: cannot write %s\n", name_.c_str(), path.c_str());
      return 7;
    }
  }
  return 0;
}

}  // namespace bench
