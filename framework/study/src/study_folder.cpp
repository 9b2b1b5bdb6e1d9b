// SPDX-License-Identifier: Apache-2.0
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "c3de/core/file_path.h"
#include "c3de/core/output_file.h"
#include "c3de/study/study_run.h"

namespace c3de::study {
namespace {

using Json = nlohmann::ordered_json;

std::vector<std::pair<std::string, std::string>> identityIn(const Json &plan) {
  std::vector<std::pair<std::string, std::string>> out;
  for (const Json &one : plan.value("identity", Json::array()))
    if (one.is_array() && one.size() == 2 && one[0].is_string() && one[1].is_string())
      out.emplace_back(one[0].get<std::string>(), one[1].get<std::string>());
  return out;
}

Expected<void> makeFolders(const std::filesystem::path &folder) {
  for (const char *inner : {"", "points", "work"}) {
    std::error_code code;
    std::filesystem::create_directories(folder / inner, code);
    if (code) return fail(ErrorCode::output, (folder / inner).string() + ": cannot be made: " + code.message());
  }
  return {};
}

}  // namespace

Expected<StudyFolder> StudyFolder::open(const std::filesystem::path &folder, const Study &study, const Plan &plan,
                                        bool resume) {
  std::error_code code;
  const std::filesystem::path planFile = folder / "plan.json";
  const bool isThere = std::filesystem::exists(planFile, code);
  if (!isThere && std::filesystem::is_directory(folder, code))
    for (const auto &entry : std::filesystem::directory_iterator(folder, code))
      if (const std::string name = entry.path().filename().string();
          name != "lock" && name != "points" && name != "work")
        return fail(ErrorCode::usage,
                    folder.string() + " holds '" + name + "' and no study; accepted: a new or empty folder");
  if (const auto made = makeFolders(folder); !made) return tl::unexpected(made.error());
  auto lock = FileLock::take(folder / "lock", "process " + std::to_string(processId()) + " on " + hostName());
  if (!lock) {
    if (lock.error().code != ErrorCode::state) return tl::unexpected(lock.error());
    return fail(ErrorCode::usage, folder.string() + " is in use by " +
                                      (lock.error().message.empty() ? "another process" : lock.error().message) +
                                      "; accepted: another folder, or this one when that has ended");
  }
  if (isThere) {
    std::ifstream in(planFile, std::ios::binary);
    const Json before = Json::parse(in, nullptr, false);
    if (!before.is_object())
      return fail(ErrorCode::input, planFile.string() + ": is damaged; accepted: another folder");
    if (const std::string differs = difference(plan.identity, identityIn(before)); !differs.empty())
      return fail(ErrorCode::usage,
                  folder.string() + " holds another study: " + differs + "; accepted: another folder");
    if (!resume)
      return fail(ErrorCode::usage,
                  folder.string() + " contains this study; use --resume to continue it, or another folder");
  } else {
    Json json{
        {"format", 1}, {"title", study.title}, {"study", genericPathText(study.source)}, {"identity", Json::array()}};
    for (const auto &[name, value] : plan.identity) json["identity"].push_back(Json::array({name, value}));
    if (auto written = writeWholeFile(planFile, json.dump(1) + "\n"); !written) return tl::unexpected(written.error());
  }
  return StudyFolder(folder, std::move(*lock));
}

std::map<std::string, Result> StudyFolder::results(const Plan &plan) const {
  std::map<std::string, Result> out;
  for (const Point &point : plan.points) {
    std::ifstream in(path_ / "points" / (point.id + ".json"), std::ios::binary);
    if (!in || out.contains(point.id)) continue;
    std::ostringstream text;
    text << in.rdbuf();
    if (auto result = Result::fromText(text.str()); result && result->id == point.id)
      out.emplace(point.id, std::move(*result));
  }
  return out;
}

Expected<void> StudyFolder::keep(const Result &result) const {
  return writeWholeFile(path_ / "points" / (result.id + ".json"), result.text() + "\n");
}

}  // namespace c3de::study
