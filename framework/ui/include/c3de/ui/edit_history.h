// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

namespace c3de::segmentation {
class SegmentationWorkflow;
}  // namespace c3de::segmentation

namespace c3de::registry {
class EditList;
class ParameterRegistry;
}  // namespace c3de::registry

namespace c3de::ui {

/// Undo and Redo of the window: of parameters, of the steps of a segmentation, or of the steps of plugins, whichever a
/// person has edited last; when that one has nothing to offer, the one before it. While a step of the segmentation is
/// computed nothing is. What a body was picked by is not undone here once it has been created: it would be laid over
/// it. Main thread.
class EditHistory {
 public:
  /// Once per frame; null: there is none. They must outlive the calls below.
  void follow(registry::ParameterRegistry *parameters, segmentation::SegmentationWorkflow *workflow,
              registry::EditList *steps = nullptr);
  /// Of what would be undone or redone; empty: nothing.
  [[nodiscard]] std::string undoLabel() const { return label(source(true), true); }
  [[nodiscard]] std::string redoLabel() const { return label(source(false), false); }
  void undo() { carryOut(true); }
  void redo() { carryOut(false); }

 private:
  enum class Source { parameters, segmentation, steps };
  static constexpr std::size_t kSources = 3;
  [[nodiscard]] std::uint64_t editsOf(Source source) const;
  [[nodiscard]] std::string label(Source source, bool isUndo) const;
  /// Whose turn it is.
  [[nodiscard]] Source source(bool isUndo) const;
  void bringForward(Source source);
  void carryOut(bool isUndo);

  registry::ParameterRegistry *parameters_ = nullptr;
  segmentation::SegmentationWorkflow *workflow_ = nullptr;
  registry::EditList *steps_ = nullptr;
  std::array<Source, kSources> latestFirst_{Source::parameters, Source::segmentation, Source::steps};
  std::array<std::uint64_t, kSources> edits_{};  ///< that have been seen, by Source
};

}  // namespace c3de::ui
