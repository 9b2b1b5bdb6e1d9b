// SPDX-License-Identifier: Apache-2.0
#include "bench/report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <thread>
#include <utility>

#include "c3de/core/platform.h"

namespace bench {
namespace {

constexpr int kMinWidth = 9, kMinWidthOfName = 20;

// Characters, not bytes: titles contain signs such as µ.
int lettersOf(const std::string &text) {
  return static_cast<int>(std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xc0) != 0x80; }));
}

std::string padded(const std::string &text, int width) {
  return std::string(static_cast<std::size_t>(std::max(0, width - lettersOf(text))), ' ') + text + "  ";
}

std::string textOf(const Report::Cell &cell, int digits) {
  if (cell.is_null()) return "-";
  if (cell.is_string()) return cell.get<std::string>();
  if (!cell.is_number_float()) return cell.dump();
  if (!std::isfinite(cell.get<double>())) return "-";
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", digits, cell.get<double>());
  return text;
}

}  // namespace

std::string compilerName() { return C3DE_BENCH_COMPILER; }

Report::Report(std::string benchmark, const Options &options) : name_(std::move(benchmark)), options_(options) {
#ifdef NDEBUG
  constexpr bool assertions = false;
#else
  constexpr bool assertions = true;
#endif
  const std::string cpu = c3de::cpuName(), type = C3DE_BENCH_BUILD, sanitizers = C3DE_BENCH_SANITIZERS;
  const unsigned cores = std::thread::hardware_concurrency();
  json_ = {{"benchmark", name_},
           {"machine", {{"cpu", cpu}, {"cores", cores}}},
           {"build",
            {{"version", C3DE_BENCH_VERSION},
             {"compiler", compilerName()},
             {"type", type},
             {"sanitizers", sanitizers},
             {"assertions", assertions}}},
           {"threads", options.threads},
           {"seconds", options.seconds},
           {"facts", nlohmann::ordered_json::object()},
           {"rows", nlohmann::ordered_json::array()}};
  std::printf("%s: %s, %u cores; %s, %s%s%s%s; %u thread%s\n", name_.c_str(), cpu.c_str(), cores,
              compilerName().c_str(), type.c_str(), assertions ? ", with assertions" : "",
              sanitizers.empty() ? "" : ", sanitizers ", sanitizers.c_str(), options.threads,
              options.threads == 1 ? "" : "s");
}

void Report::table(std::string name, const std::string &columns) {
  tableName_ = std::move(name);
  columns_.clear();
  isFirstRow_ = true;
  csv_ += "table";
  std::istringstream in(columns);
  for (std::string text; std::getline(in >> std::ws, text, ';');) {
    Column column;
    if (const std::size_t colon = text.find(':'); colon != std::string::npos) {
      column.digits = std::atoi(text.c_str() + colon + 1);
      text.erase(colon);
    }
    const std::size_t equals = text.find('=');
    column.key = text.substr(0, equals);
    column.title = equals == std::string::npos ? column.key : text.substr(equals + 1);
    csv_ += "," + column.key;
    columns_.push_back(std::move(column));
  }
  csv_ += "\n";
}

void Report::row(std::vector<Cell> cells) {
  nlohmann::ordered_json out = {{"table", tableName_}};
  std::string head, line;
  csv_ += tableName_;
  for (std::size_t i = 0; i < columns_.size() && i < cells.size(); ++i) {
    Column &column = columns_[i];
    const std::string text = textOf(cells[i], column.digits);
    if (isFirstRow_)
      column.width = std::max(
          {lettersOf(column.title), lettersOf(text), i < 2 && cells[i].is_string() ? kMinWidthOfName : kMinWidth});
    if (!column.title.empty()) {
      head += padded(column.title, column.width);
      line += padded(text, column.width);
    }
    csv_ += "," + (cells[i].is_string() ? cells[i].get<std::string>() : cells[i].is_null() ? "" : cells[i].dump());
    out[column.key] = std::move(cells[i]);
  }
  csv_ += "\n";
  json_["rows"].push_back(std::move(out));
  if (std::exchange(isFirstRow_, false)) std::printf("\n%s\n%s\n", tableName_.c_str(), head.c_str());
  note(line);
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
