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

/// Undo and Redo of the window. They apply to parameters, to the steps of a segmentation or to the steps of plugins.
/// Parameters and steps of plugins are undone and redone in the order in which they were made; an edit of one of them
/// removes what was undone of the other. The segmentation comes first while it was edited last. While a step
/// of the segmentation is being computed, nothing is undone or redone. The selection from which a body was created is
/// not undone here once the body exists: it would cover the body. Main thread.
class EditHistory {
 public:
  /// Called once per frame; null if there is none. The arguments must outlive the calls below.
  void follow(registry::ParameterRegistry *parameters, segmentation::SegmentationWorkflow *workflow,
              registry::EditList *steps = nullptr);
  /// What would be undone or redone; empty if nothing.
  [[nodiscard]] std::string undoLabel() const { return label(source(true), true); }
  [[nodiscard]] std::string redoLabel() const { return label(source(false), false); }
  void undo() { apply(true); }
  void redo() { apply(false); }

 private:
  enum class Source { parameters, segmentation, steps };
  static constexpr std::size_t kSources = 3;
  [[nodiscard]] std::uint64_t editsOf(Source source) const;
  [[nodiscard]] std::string label(Source source, bool isUndo) const;
  /// The source to which the next undo or redo applies.
  [[nodiscard]] Source source(bool isUndo) const;
  void bringForward(Source source);
  /// Parameters or steps, whichever has the step to be undone or redone next.
  [[nodiscard]] Source inOrder(Source source, bool isUndo) const;
  void apply(bool isUndo);

  registry::ParameterRegistry *parameters_ = nullptr;
  segmentation::SegmentationWorkflow *workflow_ = nullptr;
  registry::EditList *steps_ = nullptr;
  std::array<Source, kSources> latestFirst_{Source::parameters, Source::segmentation, Source::steps};
  std::array<std::uint64_t, kSources> edits_{};  ///< last seen edit counts, by Source
};

}  // namespace c3de::ui
