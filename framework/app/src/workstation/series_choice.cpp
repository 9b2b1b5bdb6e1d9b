// SPDX-License-Identifier: Apache-2.0
#include "workstation/series_choice.h"

#include "c3de/session/file_kind.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "c3de/core/path_text.h"
#include "c3de/core/text.h"

namespace c3de::app {
namespace {

std::string kindOf(const imaging::SeriesInfo &s) {
  std::string text = (s.isPart ? "Part " + s.id.substr(s.id.rfind('#') + 1) + ": " : "") + s.modality;
  for (const std::string &part : {s.description, s.orientation})
    if (!part.empty()) text += (text.empty() ? "" : ", ") + part;
  return text.empty() ? "Series" : text;
}

std::string sizeOf(const imaging::SeriesInfo &s) {
  return std::to_string(s.size[0]) + " × " + std::to_string(s.size[1]) + " × " + std::to_string(s.size[2]) + ", " +
         std::to_string(s.files) + (s.files == 1 ? " file in " : " files in ") + imageName(s.folder);
}

}  // namespace

SeriesChoice::SeriesChoice(registry::PanelRegistry &panels, const std::filesystem::path &path,
                           std::vector<imaging::SeriesInfo> series, Chosen chosen)
    : panels_(panels), name_(imageName(path)), series_(std::move(series)), chosen_(std::move(chosen)) {
  registry::Panel panel;
  panel.owner = "c3de";
  panel.id = "series";
  panel.title = "Which series?";
  panel.isInView = true;
  panel.self = this;
  panel.onUi = [](void *self, const c3de_ui_v1 *ui) { static_cast<SeriesChoice *>(self)->draw(*ui); };
  panel_ = panels_.add(std::move(panel));
}

SeriesChoice::~SeriesChoice() { panels_.remove(panel_); }

void SeriesChoice::draw(const c3de_ui_v1 &ui) {
  const bool isOne =
      std::count_if(series_.begin(), series_.end(), [](const imaging::SeriesInfo &s) { return !s.isPart; }) == 1;
  const std::string intro = name_ + (isOne ? " can be opened as a whole or in parts:" : " holds several series:");
  ui.text(ui.ctx, toAbi(intro));
  std::optional<std::string> chosen;
  for (std::size_t i = 0; i < series_.size(); ++i) {
    const std::string label = kindOf(series_[i]), id = "series." + std::to_string(i), size = sizeOf(series_[i]);
    if (ui.button(ui.ctx, toAbi(id), toAbi(label), 1) & C3DE_UI_COMMITTED) chosen = series_[i].id;
    ui.text(ui.ctx, toAbi(size));
  }
  const std::string_view none = "None", cancel = "cancel";
  if (ui.button(ui.ctx, toAbi(cancel), toAbi(none), 1) & C3DE_UI_COMMITTED) chosen = "";
  if (!chosen) return;
  const Chosen tell = chosen_;
  tell(*chosen);
}

}  // namespace c3de::app
