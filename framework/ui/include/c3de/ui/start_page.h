// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "c3de/render/renderer.h"
#include "c3de/ui/recent_files.h"

namespace c3de::ui {

/// A recent file as the start page and the menu show it.
struct RecentItem {
  RecentFile file;
  bool isMissing = false;
  std::shared_ptr<const render::Image> picture;  ///< null: there is none yet
};

/// A scene that is delivered with the program.
struct ExampleScene {
  std::string id, label, doc;
  std::filesystem::path file;
};

/// Contents of the page that the window shows while it has nothing else. Main thread.
struct StartPage {
  std::vector<RecentItem> recent;  ///< the newest first
  std::vector<ExampleScene> examples;
};

[[nodiscard]] const char *kindText(RecentKind kind);  ///< "DICOM folder"
/// For example "liver.obj", or "scan.nii.gz and 2 more".
[[nodiscard]] std::string nameText(const RecentFile &file);
/// Local time: "2026-11-28 17:45".
[[nodiscard]] std::string dateText(const RecentFile &file);

enum class GridStep { left, right, up, down };
/// The marked cell after an arrow key; a step out of the grid has no effect.
/// @param columns  at least 1
[[nodiscard]] std::size_t nextCell(std::size_t marked, std::size_t count, std::size_t columns, GridStep step);

}  // namespace c3de::ui
