// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "c3de/registry/panel_registry.h"
#include "c3de/scene/scene_file.h"

namespace c3de::ui {

enum class MatchSource { points, surface, labels, stream };

/// What is to be matched, and how.
struct MatchForm {
  scene::SceneMatch wanted;  ///< the files of all sources
  MatchSource source = MatchSource::points;
  std::string label;                       ///< number or name
  std::string server = "localhost:18944";  ///< address of a tracking system, for a stream
  std::string tool;                        ///< whose tip is tracked; empty: points are sent together
  std::uint32_t toolPoints = 200;          ///< of a frame, kFewestToolPoints … kMostToolPoints
  static constexpr std::uint32_t kFewestToolPoints = 12, kMostToolPoints = 2000;
  /// With the file of the chosen source only. The label is still a text.
  [[nodiscard]] scene::SceneMatch match() const;
  /// Why no match can begin, as a sentence; empty: one can.
  [[nodiscard]] std::string whyNot() const;
};
/// A form filled with what a scene requests.
[[nodiscard]] MatchForm matchFormOf(const scene::SceneMatch &match);

/// The result of a match, as texts.
struct MatchTexts {
  struct Row {
    std::string name, value;
  };
  struct Section {
    std::string title;
    std::vector<Row> rows;
  };
  std::vector<std::string> warnings;  ///< sentences
  std::vector<Section> sections;
  std::vector<Row> landmarks;
  /// Motions that fit equally well, if there are several, and the one whose points are shown.
  std::vector<std::string> candidates;
  std::size_t shownCandidate = 0;
};

/// What the panel of a match shows besides its form.
struct MatchView {
  std::vector<std::string> bodies;
  std::string meshExtensions;           ///< "obj;stl"
  std::filesystem::path openLabels;     ///< the open label map; empty: none
  std::vector<std::string> labelNames;  ///< of the open label map
  std::string whyNot;                   ///< why no match can begin now, besides the form; empty: one can
  std::optional<std::pair<double, std::string>> progress;  ///< fraction and activity; none: no match is running
  bool isCancelling = false;
  std::string stream;                  ///< state of the running stream, as a clause; empty: none is running
  const MatchTexts *result = nullptr;  ///< null: none
};

/// The panel that matches a body to measurements. It is registered for as long as this object exists. Main thread; what
/// is passed must outlive this.
class MatchPanel {
 public:
  struct Actions {
    std::function<MatchView()> view;
    std::function<void()> begin, cancel;  ///< cancel: the match, or the stream
    std::function<void(std::size_t candidate)> show, deform;
    std::function<void()> close;  ///< must not destroy the panel at once
  };
  MatchPanel(registry::PanelRegistry &panels, MatchForm &form, Actions actions);
  ~MatchPanel();
  MatchPanel(const MatchPanel &) = delete;
  MatchPanel &operator=(const MatchPanel &) = delete;

  [[nodiscard]] Handle handle() const { return panel_; }
  /// By which factor the arrows of the residuals are longer than the residuals.
  [[nodiscard]] double arrowScale() const { return arrowScale_; }

 private:
  /// Path of a file; a panel edits it in place.
  using PathText = std::array<char, 4096>;
  void fileRow(const c3de_ui_v1 &ui, const char *id, const char *label, const std::string &extensions, const char *doc,
               PathText &path, std::filesystem::path &file);
  void draw(const c3de_ui_v1 &ui);
  void drawMeasured(const c3de_ui_v1 &ui, const MatchView &view);
  void drawLabels(const c3de_ui_v1 &ui, const MatchView &view);
  void drawLandmarks(const c3de_ui_v1 &ui);
  void drawTargetFile(const c3de_ui_v1 &ui);
  void drawMotion(const c3de_ui_v1 &ui);
  void drawButtons(const c3de_ui_v1 &ui, const MatchView &view);
  void drawResult(const c3de_ui_v1 &ui, const MatchTexts &result, bool canMatch);
  void drawCandidates(const c3de_ui_v1 &ui, const MatchTexts &result, bool canMatch);

  registry::PanelRegistry &panels_;
  MatchForm &form_;
  Actions actions_;
  PathText points_{}, surface_{}, labels_{}, landmarks_{};
  double arrowScale_ = 1.0;
  Handle panel_;
};

}  // namespace c3de::ui
