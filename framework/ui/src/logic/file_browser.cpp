// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/file_browser.h"
#include "c3de/core/file_path.h"

#include <algorithm>
#include <cstdio>

#include "c3de/core/platform.h"

namespace c3de::ui {
namespace {

namespace fs = std::filesystem;

std::string lowerCase(std::string text) {
  for (char &c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

fs::path homeDirectory() {
  for (const char *name : {"HOME", "USERPROFILE"})
    if (const std::string home = environmentVariable(name); !home.empty()) return pathFromText(home);
  return {};
}

}  // namespace

void FileBrowser::setExtensions(const std::string &extensions) {
  extensions_.clear();
  for (std::size_t begin = 0; begin <= extensions.size();) {
    const std::size_t end = std::min(extensions.find(';', begin), extensions.size());
    std::string one = lowerCase(extensions.substr(begin, end - begin));
    one.erase(std::remove_if(one.begin(), one.end(), [](char c) { return c == ' ' || c == '*' || c == '.'; }),
              one.end());
    if (!one.empty()) extensions_.push_back(std::move(one));
    begin = end + 1;
  }
}

bool FileBrowser::accepts(const fs::path &file) const {
  if (extensions_.empty()) return true;
  const std::string name = lowerCase(pathText(file.filename()));
  return std::any_of(extensions_.begin(), extensions_.end(),
                     [&](const std::string &extension) { return name.ends_with("." + extension); });
}

Expected<void> FileBrowser::open(const fs::path &folder) {
  std::error_code error;
  const fs::path shown = canonicalPath(folder, error);
  if (error || !fs::is_directory(shown, error)) return fail(ErrorCode::input, pathText(folder) + ": not a folder");
  fs::directory_iterator it(shown, error);
  if (error) return fail(ErrorCode::input, pathText(shown) + ": cannot be read: " + error.message());

  std::vector<Entry> entries;
  for (const fs::directory_iterator end; it != end; it.increment(error)) {
    if (error) break;
    Entry entry;
    entry.name = pathText(it->path().filename());
    if (entry.name.starts_with(".")) continue;
    std::error_code ignored;
    entry.isFolder = it->is_directory(ignored);
    if (!entry.isFolder) {
      if (!it->is_regular_file(ignored) || !accepts(it->path())) continue;
      entry.bytes = it->file_size(ignored);
    }
    entries.push_back(std::move(entry));
  }
  std::sort(entries.begin(), entries.end(), [](const Entry &a, const Entry &b) {
    if (a.isFolder != b.isFolder) return a.isFolder;
    const std::string left = lowerCase(a.name), right = lowerCase(b.name);
    return left != right ? left < right : a.name < b.name;
  });
  folder_ = shown;
  entries_ = std::move(entries);
  return {};
}

fs::path FileBrowser::pathOf(const std::string &typed) const {
  fs::path path = pathFromText(typed);
  if (typed == "~" || typed.starts_with("~/"))
    path = homeDirectory() / pathFromText(typed.substr(std::min<std::size_t>(2, typed.size())));
  return isAbsolutePath(path) ? path : joinedPath(folder_, path);
}

Error FileBrowser::notAccepted(const std::string &typed) const {
  std::string list;
  for (const std::string &extension : extensions_) list += (list.empty() ? "." : ", .") + extension;
  return {ErrorCode::input, typed + ": this kind of file is not accepted here; accepted: " + list};
}

Expected<FileBrowser::Choice> FileBrowser::resolve(const std::string &typed) const {
  if (typed.empty()) return fail(ErrorCode::usage, "no file is chosen");
  std::error_code error;
  const fs::path path = canonicalPath(pathOf(typed), error);
  if (error || !fs::exists(path, error)) return fail(ErrorCode::input, typed + ": there is no such file or folder");
  if (fs::is_directory(path, error)) return Choice{true, path};
  if (!accepts(path)) return tl::unexpected(notAccepted(typed));
  return Choice{false, path};
}

Expected<FileBrowser::Choice> FileBrowser::resolveNew(const std::string &typed) const {
  if (typed.empty()) return fail(ErrorCode::usage, "no file name");
  std::error_code error;
  fs::path path = canonicalPath(pathOf(typed), error);
  if (!error && fs::is_directory(path, error)) return Choice{true, path};
  if (!path.has_extension() && !extensions_.empty()) path += "." + extensions_.front();
  if (!accepts(path)) return tl::unexpected(notAccepted(typed));
  if (!fs::is_directory(path.parent_path(), error))
    return fail(ErrorCode::input, typed + ": there is no folder " + pathText(path.parent_path()));
  return Choice{false, path};
}

std::string freeName(const fs::path &folder, const std::string &name) {
  std::size_t dot = name.rfind('.');
  if (lowerCase(name).ends_with(".nii.gz")) dot = name.size() - 7;
  const std::string stem = name.substr(0, dot), ending = dot == std::string::npos ? "" : name.substr(dot);
  std::error_code ignored;
  std::string proposed = name;
  for (int n = 2; fs::exists(folder / pathFromText(proposed), ignored) && n < 10000; ++n)
    proposed = stem + "-" + std::to_string(n) + ending;
  return proposed;
}

std::string fileNamePart(const std::string &text) {
  std::string part;
  for (const char c : text) {
    const auto u = static_cast<unsigned char>(c);
    const bool isKept =
        u >= 0x80 || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '_';
    if (isKept)
      part += c;
    else if (!part.empty() && part.back() != '-')
      part += '-';
  }
  while (!part.empty() && (part.back() == '-' || part.back() == '.')) part.pop_back();
  part.erase(0, std::min(part.find_first_not_of(".-"), part.size()));
  return part;
}

std::string sizeText(std::uintmax_t bytes) {
  const char *const units[] = {"B", "kB", "MB", "GB", "TB"};
  double value = static_cast<double>(bytes);
  std::size_t unit = 0;
  while (value >= 1000.0 && unit + 1 < std::size(units)) {
    value /= 1000.0;
    ++unit;
  }
  char text[32];
  std::snprintf(text, sizeof text, unit == 0 || value >= 100.0 ? "%.0f %s" : "%.1f %s", value, units[unit]);
  return text;
}

}  // namespace c3de::ui
