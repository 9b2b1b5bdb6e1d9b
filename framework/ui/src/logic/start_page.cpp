// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/start_page.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "c3de/core/path_text.h"

namespace c3de::ui {

const char *kindText(RecentKind kind) {
  switch (kind) {
    case RecentKind::scan: return "Scan";
    case RecentKind::dicomFolder: return "DICOM folder";
    case RecentKind::scene: return "Scene";
    case RecentKind::mesh: return "Mesh";
    case RecentKind::session: return "Session";
  }
  return "";
}

std::string nameText(const RecentFile &file) {
  if (file.files.empty()) return {};
  const std::filesystem::path &first = file.files.front();
  std::string name = pathText(first.has_filename() ? first.filename() : first.parent_path().filename());
  if (name.empty()) name = pathText(first);
  const std::size_t more = file.files.size() - 1;
  return more == 0 ? name : fmt::format("{} and {} more", name, more);
}

std::string dateText(const RecentFile &file) {
  return fmt::format("{:%Y-%m-%d %H:%M}", fmt::localtime(static_cast<std::time_t>(file.openedAt_s)));
}

std::size_t nextCell(std::size_t marked, std::size_t count, std::size_t columns, GridStep step) {
  switch (step) {
    case GridStep::left: return marked > 0 ? marked - 1 : marked;
    case GridStep::right: return marked + 1 < count ? marked + 1 : marked;
    case GridStep::up: return marked >= columns ? marked - columns : marked;
    case GridStep::down: return marked + columns < count ? marked + columns : marked;
  }
  return marked;
}

}  // namespace c3de::ui
