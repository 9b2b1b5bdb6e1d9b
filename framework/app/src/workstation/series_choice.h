// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "app.h"
#include "c3de/imaging/reading.h"
#include "c3de/registry/panel_registry.h"

namespace c3de::app {

/// Asks in the view which of several series to open; removed with this object. Main thread.
class SeriesChoice {
 public:
  /// Called with the identifier, which is empty if none is wanted; the object may be destroyed in the call.
  using Chosen = std::function<void(const std::string &id)>;
  SeriesChoice(registry::PanelRegistry &panels, const std::filesystem::path &path,
               std::vector<imaging::SeriesInfo> series, Chosen chosen);
  ~SeriesChoice();
  SeriesChoice(const SeriesChoice &) = delete;
  SeriesChoice &operator=(const SeriesChoice &) = delete;

 private:
  void draw(const c3de_ui_v1 &ui);

  registry::PanelRegistry &panels_;
  std::string name_;
  std::vector<imaging::SeriesInfo> series_;
  Chosen chosen_;
  Handle panel_;
};

}  // namespace c3de::app
