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

/// The use of a label in the body of a whole scan.
struct LabelUse {
  enum class Kind {
    none,      ///< background, or left out if there is none
    air,       ///< same, but only where the image shows tissue
    rigid,     ///< it is fixed
    material,  ///< of a preset
  };
  Kind kind = Kind::none;
  std::string preset;  ///< of Kind::material
  friend bool operator==(const LabelUse &, const LabelUse &) = default;
};

/// Posture of the patient, which determines the direction of gravity.
enum class Posture { supine, prone, leftSide, rightSide, upright };

/// The user's choices besides the labels.
struct ScanBodySettings {
  bool hasBackground = true;
  std::string background = "fat";  ///< name of a preset
  double from = 0.0, to = 0.0;     ///< image values of the background
  bool largestOnly = true;         ///< removes separate parts: the table, a blanket; off where organs are not connected
  double points = 3000.0;
  bool hasGravity = true;  ///< the scan is in equilibrium with it
  Posture posture = Posture::supine;
  /// Corners of a box, LPS in mm; the body is limited to it. None: no limit.
  std::optional<std::array<Vec3, 2>> region;
};

/// Creates one body of all tissues from an image and its labels: manages the use of each label, and writes the scene.
/// No drawing. Main thread; jobs may end after this object.
class ScanBody {
 public:
  struct Sources {
    std::shared_ptr<const scene::StoredImage> image;
    std::filesystem::path imageFile;
    std::string series;                                              ///< of imageFile
    std::filesystem::path labelFile;                                 ///< source of `layers`
    std::vector<std::shared_ptr<const scene::StoredLabels>> layers;  ///< all of that file, in its order
  };
  /// @param materials  must outlive this
  /// @param make  starts building the body from a scene text; finished() has to be called at its end
  ScanBody(BackgroundJobs &jobs, std::string jobOwner, const scene::MaterialLibrary &materials,
           std::function<void(const std::string &sceneText)> make);
  ~ScanBody();
  ScanBody(const ScanBody &) = delete;
  ScanBody &operator=(const ScanBody &) = delete;

  /// Another image or other labels reset the choices; another time point of the image retains them.
  void setSources(Sources sources);
  [[nodiscard]] const Sources &sources() const { return sources_; }
  /// Whether there are an image and labels for it.
  [[nodiscard]] bool isPossible() const { return sources_.image != nullptr && !sources_.layers.empty(); }

  /// Opens or closes the dialog. Has no effect while no body is possible.
  void show(bool isShown);
  [[nodiscard]] bool isShown() const { return isShown_; }
  /// Hides the open dialog temporarily, to draw its region, until show() is called.
  void hideTemporarily() { isAside_ = isShown_; }
  [[nodiscard]] bool isHiddenTemporarily() const { return isAside_; }

  struct Row {
    std::string name;
    render::Colour colour{};
    std::string known;   ///< "kidney", "bone"; empty: unknown name
    std::string remark;  ///< the assumption where that tissue has no own preset
    bool isAir = false;  ///< according to its name
    LabelUse use;
    const scene::MaterialPreset *material = nullptr;  ///< of Kind::material
    std::optional<double> volume_ml;                  ///< none: still being computed
  };
  /// All labels, layer by layer.
  [[nodiscard]] const std::vector<Row> &rows() const { return rows_; }
  /// One step of undo(), also for several rows.
  void setUse(const std::vector<std::size_t> &rows, const LabelUse &use);
  /// Also one step.
  void setRegion(const std::optional<std::array<Vec3, 2>> &region);
  /// Restores rows and region before the last step; no effect without one.
  void undo();
  [[nodiscard]] bool canUndo() const { return !undo_.empty(); }
  [[nodiscard]] const ScanBodySettings &settings() const { return settings_; }
  /// A changed region is a step of undo(); consecutive numeric edits of it form one step.
  void setSettings(const ScanBodySettings &settings);
  /// Unit of the image's values: as stated in the file, or "HU" if they look like it; empty: unknown.
  [[nodiscard]] const std::string &unit() const { return unit_; }
  /// The box around the labels' grid, LPS in mm.
  [[nodiscard]] std::array<Vec3, 2> extent_mm() const;
  [[nodiscard]] const scene::MaterialLibrary &materials() const { return materials_; }

  /// Contradictions between the present choices, image and labels, while the dialog is shown; those of the previous
  /// choices while isChecking().
  [[nodiscard]] const std::vector<LabelFinding> &findings() const { return findings_; }
  [[nodiscard]] bool isChecking() const { return !checking_.isNull(); }

  /// Why there is no scene yet, for the user; empty: there is one.
  [[nodiscard]] std::string sceneReason() const;
  /// Why no body can be created now: sceneReason(), or one is being created.
  [[nodiscard]] std::string blockingReason() const;
  /// A scene that creates the body. Labels of one tissue or one preset form one tissue; labels without voxels are
  /// omitted.
  /// @param folder  its future location: files in it get relative paths; empty: absolute paths
  [[nodiscard]] std::string sceneText(const std::filesystem::path &folder = {}) const;

  /// No effect while blockingReason() has a reason.
  void make();
  /// To be called at the end of the work started by make(). An error is shown in the dialog, unless another scan has
  /// been opened since; choices are retained. True: it is shown, or will be after the dialog returns.
  bool finished(const Expected<void> &result);
  /// Why the last attempt created no body; empty: it did, or there was none.
  [[nodiscard]] const std::string &problem() const { return problem_; }

 private:
  void count();
  /// Recomputes findings() if a choice that they depend on has changed.
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
  std::vector<Step> undo_;              ///< the state before each step
  std::vector<LabelUse> byName_;        ///< the use of each row by its name, without the user's choice
  std::vector<std::uint16_t> numbers_;  ///< label value of each row
  std::string problem_, unit_;
  Handle counting_, checking_;
  std::vector<LabelFinding> findings_;
  std::string checked_;  ///< the choices that findings_ are, or will be, based on; empty: none
  std::uint64_t serial_ = 0, checkSerial_ = 0;
  bool isShown_ = false, isAside_ = false, isMaking_ = false, isCounted_ = false;
  bool isOfEarlierScan_ = false;  ///< refers to the body being created
  bool isTyped_ = false;          ///< the last step is a numeric edit of the region
  std::shared_ptr<bool> alive_;
};

}  // namespace c3de::segmentation
