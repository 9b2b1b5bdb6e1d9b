// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "c3de/core/background_jobs.h"
#include "c3de/core/vec.h"
#include "c3de/render/renderer.h"
#include "c3de/scene/image_store.h"
#include "c3de/scene/materials.h"
#include "c3de/segmentation/label_checks.h"

namespace c3de::segmentation {

/// What a label is of in the body of a whole scan.
struct LabelUse {
  enum class Kind {
    none,      ///< background, or left out where there is none
    air,       ///< likewise, but only where the image shows tissue
    rigid,     ///< it does not move
    material,  ///< of a preset
  };
  Kind kind = Kind::none;
  std::string preset;  ///< of Kind::material
  friend bool operator==(const LabelUse &, const LabelUse &) = default;
};

/// How the patient lay, which is where gravity pulled.
enum class Posture { supine, prone, leftSide, rightSide, upright };

/// What a person chooses beside the labels.
struct ScanBodySettings {
  bool hasBackground = true;
  std::string background = "fat";  ///< name of a preset
  double from = 0.0, to = 0.0;     ///< values of the image that are background
  bool largestOnly = true;         ///< without what lies apart: the table, a blanket; off where organs lie alone
  double points = 3000.0;
  bool hasGravity = true;  ///< which the scan is in balance with
  Posture posture = Posture::supine;
  /// Corners of a box, LPS in mm: what lies outside is not of the body. None: all is.
  std::optional<std::array<Vec3, 2>> region;
};

/// The way from an image and its labels to one body of all tissues: what each label is of, and the scene that says so.
/// No drawing. Main thread; must outlive no job: jobs may end after it.
class ScanBody {
 public:
  struct Sources {
    std::shared_ptr<const scene::StoredImage> image;
    std::filesystem::path imageFile;
    std::string series;                                              ///< of imageFile
    std::filesystem::path labelFile;                                 ///< that `layers` come from
    std::vector<std::shared_ptr<const scene::StoredLabels>> layers;  ///< all of that file, in its order
  };
  /// @param materials  must outlive this
  /// @param make  begins to make the body of a scene's text; finished() is to be called when that has ended
  ScanBody(BackgroundJobs &jobs, std::string jobOwner, const scene::MaterialLibrary &materials,
           std::function<void(const std::string &sceneText)> make);
  ~ScanBody();
  ScanBody(const ScanBody &) = delete;
  ScanBody &operator=(const ScanBody &) = delete;

  /// Another image or other labels: choices begin anew. Another time point of the image: they stay.
  void setSources(Sources sources);
  [[nodiscard]] const Sources &sources() const { return sources_; }
  /// Whether there are an image and labels over it.
  [[nodiscard]] bool isPossible() const { return sources_.image != nullptr && !sources_.layers.empty(); }

  /// Whether a person is being asked. Nothing is shown where it is not possible.
  void show(bool isShown);
  [[nodiscard]] bool isShown() const { return isShown_; }
  /// While it is shown the dialog can stand aside, for its region to be drawn, until show() is called.
  void stepAside() { isAside_ = isShown_; }
  [[nodiscard]] bool isAside() const { return isAside_; }

  struct Row {
    std::string name;
    render::Colour colour{};
    std::string known;   ///< "kidney", "bone"; empty: the name is not known
    std::string remark;  ///< what is assumed where that has no preset of its own
    bool isAir = false;  ///< by its name
    LabelUse use;
    const scene::MaterialPreset *material = nullptr;  ///< of Kind::material
    std::optional<double> volume_ml;                  ///< none: still being counted
  };
  /// All labels, layer by layer.
  [[nodiscard]] const std::vector<Row> &rows() const { return rows_; }
  /// One step of undo(), also of many rows.
  void setUse(const std::vector<std::size_t> &rows, const LabelUse &use);
  /// A step as well.
  void setRegion(const std::optional<std::array<Vec3, 2>> &region);
  /// What rows and region were before the last step; where there was none, nothing happens.
  void undo();
  [[nodiscard]] bool canUndo() const { return !undo_.empty(); }
  [[nodiscard]] const ScanBodySettings &settings() const { return settings_; }
  /// A region that is another one is a step of undo(); numbers of it that are set one after the other are one together.
  void setSettings(const ScanBodySettings &settings);
  /// Of the image's values: as its file says, or "HU" where they look like it; empty: not known.
  [[nodiscard]] const std::string &unit() const { return unit_; }
  /// The box around the labels' grid, LPS in mm.
  [[nodiscard]] std::array<Vec3, 2> extent_mm() const;
  [[nodiscard]] const scene::MaterialLibrary &materials() const { return materials_; }

  /// What image and labels contradict of the present choices, while it is shown; those before the last choice while
  /// isChecking().
  [[nodiscard]] const std::vector<LabelFinding> &findings() const { return findings_; }
  [[nodiscard]] bool isChecking() const { return !checking_.isNull(); }

  /// Why there is no scene yet, for a person; empty: there is.
  [[nodiscard]] std::string sceneReason() const;
  /// Why no body can be made now: that, or one is being made.
  [[nodiscard]] std::string blockingReason() const;
  /// A scene that makes the body. Labels of one tissue or one preset are one tissue of it, labels without voxels none.
  /// @param folder  where it will be: files in it are named from there; empty: in full
  [[nodiscard]] std::string sceneText(const std::filesystem::path &folder = {}) const;

  /// Nothing while blockingReason() has a reason.
  void make();
  /// What was begun by make() has ended. An error is shown where the person chose, unless another scan has been opened
  /// since; choices stay. True: it is shown, or will be when it stands aside no more.
  bool finished(const Expected<void> &result);
  /// Why the last try has made no body; empty: it has, or there was none.
  [[nodiscard]] const std::string &problem() const { return problem_; }

 private:
  void count();
  /// Begins findings() anew where a choice has changed that they depend on.
  void check();
  void take(Row &row, const LabelUse &use) const;
  void keepStep();
  [[nodiscard]] std::string labelText(std::size_t row) const;

  BackgroundJobs &jobs_;
  std::string jobOwner_;
  const scene::MaterialLibrary &materials_;
  std::function<void(const std::string &)> make_;
  Sources sources_;
  ScanBodySettings settings_;
  std::vector<Row> rows_;
  struct Step {
    std::vector<LabelUse> uses;
    std::optional<std::array<Vec3, 2>> region;
  };
  std::vector<Step> undo_;              ///< what was before each step
  std::vector<LabelUse> byName_;        ///< what each row is without a person's choice
  std::vector<std::uint16_t> numbers_;  ///< of each row
  std::string problem_, unit_;
  Handle counting_, checking_;
  std::vector<LabelFinding> findings_;
  std::string checked_;  ///< the choices that findings_ are of, or are going to be; empty: none
  std::uint64_t serial_ = 0, checkSerial_ = 0;
  bool isShown_ = false, isAside_ = false, isMaking_ = false, isCounted_ = false;
  bool isOfEarlierScan_ = false;  ///< what is being made
  bool isTyped_ = false;          ///< the last step is of numbers of the region
  std::shared_ptr<bool> alive_;
};

}  // namespace c3de::segmentation
