// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>

#include "c3de/ui/file_browser.h"

namespace c3de::ui {

struct FrameContext;

/// A dialog inside the window to choose one file, to open or to save, or a folder. Only one at a time.
class FileDialog {
 public:
  enum class Folders {
    none,
    accepted,  ///< the marked folder, or the one that is shown, may be chosen, too
    only       ///< no file is shown
  };
  struct Request {
    std::string title;
    std::string extensions;  ///< "obj;stl"
    bool asksMeshUnit = false;
    Folders folders = Folders::none;
    std::string note;       ///< shown above the name
    bool isSaving = false;  ///< the file may be new; an existing one is replaced after a second press
    std::string proposed;   ///< initial name when saving, with its extension; a number is added if it exists
    std::function<void(const std::filesystem::path &file, const std::string &unit)> chosen;
  };
  /// Shows the folder that was last used for these extensions.
  void open(Request request);
  [[nodiscard]] bool isOpen() const { return isOpen_; }
  /// It has just opened, and the field does not have the keyboard focus yet: typed input is meant for it.
  [[nodiscard]] bool awaitsTyping() const { return isOpen_ && framesToFocus_ > 0; }
  /// In which folder a dialog begins whose extensions have not been used yet; empty: that of the last dialog.
  void setFirstFolder(std::filesystem::path folder) { firstFolder_ = std::move(folder); }
  void draw(FrameContext &frame);

 private:
  void openFolder();
  void choose(const std::string &typed);
  void chooseFolder();
  void drawList(FrameContext &frame);
  void drawFolders(FrameContext &frame);
  /// Lists of bookmarks and recent folders.
  void drawPlaces(FrameContext &frame);
  void go(const std::string &folder);
  void drawError(FrameContext &frame);
  void drawUnit(FrameContext &frame);
  /// The field for the name. True if Enter was pressed in it.
  bool drawName(FrameContext &frame);
  bool drawConfirm(FrameContext &frame);
  /// Button or Escape; also shows the accepted extensions.
  bool drawCancel(FrameContext &frame);

  FileBrowser browser_;
  Request request_;
  std::map<std::string, std::filesystem::path> recentFolders_;  ///< by extensions
  std::filesystem::path firstFolder_, usedFolder_;              ///< used: by the choice that has just been made
  std::string error_;
  std::filesystem::path toReplace_;  ///< the user has been asked about it
  char typed_[1024] = "";
  int unit_ = 0, framesToFocus_ = 0;
  bool isOpen_ = false, isNew_ = false, isDone_ = false;
};

}  // namespace c3de::ui
