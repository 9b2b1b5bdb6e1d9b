// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "c3de/imaging/painting.h"
#include "c3de/render/renderer.h"
#include "c3de/scene/materials.h"
#include "c3de/segmentation/body_request.h"
#include "c3de/segmentation/mask_editor.h"

namespace c3de::segmentation {

/// Resolution of a body and its surface.
struct SamplingChoice {
  bool isCountAutomatic = true;  ///< by the thickness
  double points = 1000.0;        ///< if not automatic
  bool isEdgeAutomatic = true;
  double edge_mm = 4.0;  ///< of the surface, if not automatic
};

/// How masks are painted.
struct BrushSettings {
  double radius_mm = 5.0;
  bool isErasing = false;
  bool isBall = false;     ///< otherwise a disc in the slice that is painted, one voxel thick
  bool isLimited = false;  ///< only voxels with image values within `values`
  imaging::ValueLimits values;
};

/// The user's choices besides the mask.
struct SegmentationSettings {
  bool isFromLabel = false;      ///< labels are picked, otherwise voxels by a threshold
  double low = 0.0, high = 0.0;  ///< threshold, image values
  double radius_mm = 3.0;        ///< of closing and opening
  BrushSettings brush;
  double growTolerance = 0.0;    ///< of image values
  double growDistance_mm = 0.0;  ///< from the click; 0: unlimited
  std::string name = "organ";
  std::string material;  ///< name of a preset; empty: none matches, to be chosen
  SamplingChoice sampling;
  Held held = Held::surroundings;
  double surroundings_Pa_m = kSurroundingsStiffness;
  imaging::MaskCleanUp mend;  ///< of each of several labels
};

/// What is picked, for storage. Values.
struct Selection {
  std::shared_ptr<const imaging::Mask> mask;  ///< null: none, or several labels
  std::vector<std::uint16_t> labels;          ///< picked of the label map
  std::string name;                           ///< of the organ
  double low = 0.0, high = 0.0;               ///< limits of the threshold

  [[nodiscard]] bool isEmpty() const { return !mask && labels.empty(); }
};

/// The workflow from an image to bodies of a simulation: pick, material, sampling, go. A single label or threshold
/// gives a mask that can be edited; several labels are used unchanged. No drawing. Main thread; lifetime as for
/// MaskEditor.
class SegmentationWorkflow {
 public:
  /// Steps of the mask's undo history: those after `from`, to `to`.
  struct MaskRange {
    std::uint64_t history = 0;  ///< MaskEditor::history()
    std::size_t from = 0, to = 0;
  };
  struct Events {
    std::function<void()> maskChanged;                   ///< or its properties
    std::function<void(std::vector<BodyRequest>)> make;  ///< not empty
    /// A body of the simulation gets another mask.
    std::function<void(const std::string &body, std::shared_ptr<const imaging::Mask>, const MaskRange &)> update;
  };
  /// @param materials  must outlive the workflow
  SegmentationWorkflow(BackgroundJobs &jobs, std::string jobOwner, const scene::MaterialLibrary &materials,
                       Events events);
  ~SegmentationWorkflow();
  SegmentationWorkflow(const SegmentationWorkflow &) = delete;
  SegmentationWorkflow &operator=(const SegmentationWorkflow &) = delete;

  /// Another image resets everything; another label map over the same image resets the choice of labels.
  void setSources(MaskSources sources);
  /// Another time point of the same image: the mask is retained, later steps use the new image.
  void replaceImage(std::shared_ptr<const scene::StoredImage> image) { mask_.replaceImage(std::move(image)); }

  [[nodiscard]] Selection selection() const;
  /// Selects again what was stored for the present sources. Undo does not go back beyond it.
  void restore(const Selection &selection);

  [[nodiscard]] const SegmentationSettings &settings() const { return settings_; }
  [[nodiscard]] const MaskEditor &mask() const { return mask_; }

  struct LabelRow {
    std::uint16_t value = 0;
    std::string name;
    render::Colour colour{};
    std::optional<double> volume_ml;  ///< none: still being computed
    bool isChosen = false;
  };
  [[nodiscard]] std::vector<LabelRow> labels() const;
  /// In the order they were picked; empty: none, or a threshold.
  [[nodiscard]] std::vector<std::uint16_t> pickedLabels() const;
  /// More than one label is picked; there is no mask then.
  [[nodiscard]] bool isSeveral() const { return pickedLabels().size() > 1; }
  void setFromLabel(bool isFromLabel) { settings_.isFromLabel = isFromLabel; }
  /// Picks this label alone. Uses its name, and the matching material.
  void chooseLabel(std::uint16_t value);
  /// Picks these labels alone.
  void chooseLabels(const std::vector<std::uint16_t> &values);
  /// Adds or removes a label.
  void setLabelPicked(std::uint16_t value, bool isPicked);
  void toggleLabelAt(const Vec3 &world);
  /// Moves the other limit as well if they would cross.
  void setLow(double low);
  void setHigh(double high);
  void showThreshold();
  void keepComponentAt(const Vec3 &world);
  void applyStep(MaskStep::Kind kind);  ///< largest, fillHoles, close, open
  void setBrush(const BrushSettings &brush) { settings_.brush = brush; }
  /// A drag of the brush, with the present settings. Without a mask it begins one.
  /// @param normal  of the slice that is painted; not used by balls
  void paint(std::vector<Vec3> path, const Vec3 &normal);
  void setGrowing(double tolerance, double distance_mm);
  /// Adds the connected voxels around a point whose values are similar.
  void growAt(const Vec3 &world);
  /// Fills empty slices between painted ones: along the direction that was painted last, otherwise along the axis of the
  /// grid with the most of them.
  void fillBetween();
  /// The label map to be saved: the open one with the mask as a label of it, or the mask alone. For a background job,
  /// which it may outlive. Errors: nothing is picked.
  [[nodiscard]] std::function<Expected<imaging::LabelMap>()> labelMapToSave() const;
  /// CSV of what is picked and of all labels of the open map: volume and image values. For a background job, which it
  /// may outlive. Errors: nothing is picked and no map is open; cancelled.
  [[nodiscard]] std::function<Expected<std::string>(const ProgressFn &)> statisticsToSave() const;
  /// The open label map has another grid than the mask, which is therefore saved alone.
  [[nodiscard]] bool isMaskSavedAlone() const;
  void setRadius(double radius_mm) { settings_.radius_mm = radius_mm; }
  void undo();
  void redo();
  /// Colour of the overlay on slices.
  [[nodiscard]] render::Colour colour() const;
  /// The error of the mask, for the user; empty: none.
  [[nodiscard]] std::string maskProblem() const;

  [[nodiscard]] const scene::MaterialLibrary &materials() const { return materials_; }
  /// Null: to be chosen.
  [[nodiscard]] const scene::MaterialPreset *material() const { return materials_.find(settings_.material); }
  /// The user's choice: the name no longer changes it, until another label or image is chosen.
  void chooseMaterial(const std::string &preset);
  void setName(const std::string &name);
  /// For one of several labels; null: to be chosen.
  [[nodiscard]] const scene::MaterialPreset *materialOf(std::uint16_t label) const;
  void chooseMaterialOf(std::uint16_t label, const std::string &preset);
  void setSampling(const SamplingChoice &sampling) { settings_.sampling = sampling; }
  void setHolding(Held held, double surroundings_Pa_m);
  /// Bone is rigid unless the user decides otherwise, because its small time step would apply to all bodies.
  [[nodiscard]] bool isRigid() const;
  void setRigid(bool isRigid) { rigid_ = isRigid; }
  /// For one of several labels.
  [[nodiscard]] bool isRigid(std::uint16_t label) const;
  void setRigid(std::uint16_t label, bool isRigid) { labelRigid_[label] = isRigid; }
  void setMending(const imaging::MaskCleanUp &mend);

  /// Why no body can be created yet, for the user; empty: it can.
  [[nodiscard]] std::string blockingReason() const;
  /// No effect while blockingReason() has a reason.
  void createBodies();
  /// A body of the simulation that was created from a mask.
  struct ExistingBody {
    std::string name;
    std::shared_ptr<const imaging::Mask> mask;
    friend bool operator==(const ExistingBody &, const ExistingBody &) = default;
  };
  void setBodies(std::vector<ExistingBody> bodies) { bodies_ = std::move(bodies); }
  [[nodiscard]] const std::vector<ExistingBody> &bodies() const { return bodies_; }
  /// The body that has the present name, and whose mask can therefore be replaced; null: none, or several labels.
  [[nodiscard]] const ExistingBody *presentBody() const;
  /// Selects the mask of a body for editing, which begins a new undo history. No effect without a body of this name.
  void editBody(const std::string &name);
  /// Why the mask of presentBody() cannot be replaced now, for the user; empty: it can.
  [[nodiscard]] std::string updateReason() const;
  /// No effect while updateReason() has a reason.
  void updateBody();
  /// The mask was taken from presentBody() by editBody(), and nothing else was picked since.
  [[nodiscard]] bool isEditingBody() const;
  /// Reverts, or repeats, the changes of the mask that an update had followed. False: they cannot be found any more.
  bool undoUpdate(const MaskRange &range);
  bool redoUpdate(const MaskRange &range);
  /// The body has got the mask at a position of its history.
  void onBodyUpdated(const MaskRange &range) { bodyPosition_ = range.to; }
  /// Whether every change of the mask updates the body that is edited at once.
  [[nodiscard]] bool isUpdatedLive() const { return isUpdatedLive_; }
  void setUpdatedLive(bool isUpdatedLive) { isUpdatedLive_ = isUpdatedLive; }
  /// Deselects what has become a body; failed labels stay selected.
  void onBodiesCreated(const std::vector<BodyRequest> &created);
  /// Whether the last step is the remaining selection after bodies were created. One more undo would show the source of
  /// a body over it.
  [[nodiscard]] bool hasJustCreated() const;

 private:
  [[nodiscard]] bool areEqual(const std::shared_ptr<const imaging::Mask> &one,
                              const std::shared_ptr<const imaging::Mask> &other) const;
  void countLabels();
  void chooseLabel(std::uint16_t value, MaskStep step);
  void preselectMaterial();
  void onMaskChanged();
  [[nodiscard]] std::string nameOf(std::uint16_t label) const;
  [[nodiscard]] BodyRequest requestOfSettings() const;

  BackgroundJobs &jobs_;
  std::string jobOwner_;
  const scene::MaterialLibrary &materials_;
  Events events_;
  MaskEditor mask_;
  SegmentationSettings settings_;
  std::vector<double> labelVolumes_ml_;  ///< in the order of the map's labels; empty: not computed yet
  Handle counting_;
  std::uint64_t serial_ = 0;
  std::string clickProblem_;                             ///< of toggleLabelAt()
  std::map<std::uint16_t, std::string> labelMaterials_;  ///< the user's choice for one of several
  std::optional<bool> rigid_;                            ///< the user's choice; none: as the material specifies
  std::map<std::uint16_t, bool> labelRigid_;
  bool isMaterialChosen_ = false;
  bool followsUndo_ = false;
  std::vector<ExistingBody> bodies_;
  std::string editedBody_;
  std::size_t bodyPosition_ = 0;                    ///< of the mask's history: that of the edited body
  std::shared_ptr<const imaging::Mask> requested_;  ///< by the last update: not again without a change
  bool isUpdatedLive_ = false;
  struct Comparison {
    std::shared_ptr<const imaging::Mask> one, other;
    bool isEqual = false;
  };
  mutable Comparison compared_;        ///< the last one: masks are large
  std::optional<Vec3> paintedNormal_;  ///< of the last slice that was painted
  std::shared_ptr<bool> alive_;
};

/// "6 kPa (1 kPa … 15 kPa)", from values in Pa.
[[nodiscard]] std::string stiffnessText(double value, double low, double high);

}  // namespace c3de::segmentation
