// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "c3de/render/renderer.h"
#include "c3de/scene/materials.h"
#include "c3de/segmentation/body_request.h"
#include "c3de/segmentation/mask_editor.h"

namespace c3de::segmentation {

/// How finely a body and its surface are divided.
struct SamplingChoice {
  bool isCountAutomatic = true;  ///< by the thickness
  double points = 1000.0;        ///< when it is not automatic
  bool isEdgeAutomatic = true;
  double edge_mm = 4.0;  ///< of the surface, when it is not automatic
};

/// What a person chooses beside the mask.
struct SegmentationSettings {
  bool isFromLabel = false;      ///< labels are picked, else voxels by a threshold
  double low = 0.0, high = 0.0;  ///< threshold, values of the image
  double radius_mm = 3.0;        ///< of closing and opening
  std::string name = "organ";
  std::string material;  ///< name of a preset; empty: none fits, to be chosen
  SamplingChoice sampling;
  Held held = Held::surroundings;
  double surroundings_Pa_m = kSurroundingsStiffness;
  imaging::Mending mend;  ///< of each of several labels
};

/// The path from an image to bodies of a simulation: pick, material, sampling, go. One label or threshold gives a mask
/// that can be mended; of several labels each is taken as it is. No drawing. Main thread; lifetime as MaskEditor.
class SegmentationWorkflow {
 public:
  struct Events {
    std::function<void()> maskChanged;                   ///< or what is known of it
    std::function<void(std::vector<BodyRequest>)> make;  ///< not empty
  };
  /// @param materials  must outlive the workflow
  SegmentationWorkflow(BackgroundJobs &jobs, std::string jobOwner, const scene::MaterialLibrary &materials,
                       Events events);
  ~SegmentationWorkflow();
  SegmentationWorkflow(const SegmentationWorkflow &) = delete;
  SegmentationWorkflow &operator=(const SegmentationWorkflow &) = delete;

  /// Another image: everything starts anew. Another label map over the same image: the choice of labels does.
  void setSources(MaskSources sources);
  /// Another time point of the same image: what is picked stays, later steps look at this one.
  void replaceImage(std::shared_ptr<const scene::StoredImage> image) { mask_.replaceImage(std::move(image)); }

  [[nodiscard]] const SegmentationSettings &settings() const { return settings_; }
  [[nodiscard]] const MaskEditor &mask() const { return mask_; }

  struct LabelRow {
    std::uint16_t value = 0;
    std::string name;
    render::Colour colour{};
    std::optional<double> volume_ml;  ///< none: still being counted
    bool isChosen = false;
  };
  [[nodiscard]] std::vector<LabelRow> labels() const;
  /// In the order they were picked; none: nothing is, or a threshold.
  [[nodiscard]] std::vector<std::uint16_t> pickedLabels() const;
  /// More than one label is picked; there is no mask then.
  [[nodiscard]] bool isSeveral() const { return pickedLabels().size() > 1; }
  void setFromLabel(bool isFromLabel) { settings_.isFromLabel = isFromLabel; }
  /// This one alone. Takes over its name, and the material that fits.
  void chooseLabel(std::uint16_t value);
  /// These alone.
  void chooseLabels(const std::vector<std::uint16_t> &values);
  /// Beside the others.
  void tickLabel(std::uint16_t value, bool isPicked);
  void tickLabelAt(const Vec3 &world);
  /// The limit that was moved takes the other one along.
  void setLow(double low);
  void setHigh(double high);
  void showThreshold();
  void keepComponentAt(const Vec3 &world);
  void carryOut(MaskStep::Kind kind);  ///< largest, fillHoles, close, open
  void setRadius(double radius_mm) { settings_.radius_mm = radius_mm; }
  void undo();
  void redo();
  /// Of what is laid over the slices.
  [[nodiscard]] render::Colour colour() const;
  /// What is wrong with the mask, for a person; empty: nothing.
  [[nodiscard]] std::string maskProblem() const;

  [[nodiscard]] const scene::MaterialLibrary &materials() const { return materials_; }
  /// Null: to be chosen.
  [[nodiscard]] const scene::MaterialPreset *material() const { return materials_.find(settings_.material); }
  /// By a person: the name does not change it any more, until another label or image is chosen.
  void chooseMaterial(const std::string &preset);
  void setName(const std::string &name);
  /// One of several labels; null: to be chosen.
  [[nodiscard]] const scene::MaterialPreset *materialOf(std::uint16_t label) const;
  void chooseMaterialOf(std::uint16_t label, const std::string &preset);
  void setSampling(const SamplingChoice &sampling) { settings_.sampling = sampling; }
  void setHolding(Held held, double surroundings_Pa_m);
  /// Bone is rigid until a person says otherwise: its step would be everybody's.
  [[nodiscard]] bool isRigid() const;
  void setRigid(bool isRigid) { rigid_ = isRigid; }
  /// Of one of several labels.
  [[nodiscard]] bool isRigid(std::uint16_t label) const;
  void setRigid(std::uint16_t label, bool isRigid) { labelRigid_[label] = isRigid; }
  void setMending(const imaging::Mending &mend);

  /// Why no body can be created of it yet, for a person; empty: it can.
  [[nodiscard]] std::string blockingReason() const;
  /// Does nothing while blockingReason() has a reason.
  void createBodies();
  /// What has become a body is picked no more; what could not stays.
  void onBodiesCreated(const std::vector<BodyRequest> &created);
  /// The last step is what was left when bodies were created: a step farther back, and what a body comes from would be
  /// laid over it.
  [[nodiscard]] bool hasJustCreated() const;

 private:
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
  std::vector<double> labelVolumes_ml_;  ///< by position in the map's labels; empty: not counted yet
  Handle counting_;
  std::uint64_t serial_ = 0;
  std::string clickProblem_;                             ///< of tickLabelAt()
  std::map<std::uint16_t, std::string> labelMaterials_;  ///< chosen by a person for one of several
  std::optional<bool> rigid_;                            ///< by a person; none: as the material says
  std::map<std::uint16_t, bool> labelRigid_;
  bool isMaterialChosen_ = false;
  bool followsUndo_ = false;
  std::shared_ptr<bool> alive_;
};

/// "6 kPa (1 kPa … 15 kPa)", of Pa.
[[nodiscard]] std::string stiffnessText(double value, double low, double high);

}  // namespace c3de::segmentation
