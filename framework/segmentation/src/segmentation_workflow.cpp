// SPDX-License-Identifier: Apache-2.0
#include "c3de/segmentation/segmentation_workflow.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "c3de/core/background_jobs.h"
#include "c3de/core/text.h"
#include "c3de/scene/material_names.h"
#include "label_volumes.h"

namespace c3de::segmentation {
namespace {

constexpr render::Colour kThresholdColour{1.0f, 0.70f, 0.15f, 1.0f};
constexpr double kGrowShare = 0.05;  // initial tolerance, of the range of most values
constexpr const char *kSeveralPicked = "several labels are ticked; painting and growing change one of them at a time";

/// Linear intensity of a component of sRGB (IEC 61966-2-1).
float linear(float component) {
  return component <= 0.04045f ? component / 12.92f : std::pow((component + 0.055f) / 1.055f, 2.4f);
}

std::string modulusText(double pascal) {
  const bool isGiga = pascal >= 1e9, isMega = pascal >= 1e6;
  return fmt::format("{:.4g} {}",
                     pascal / (isGiga   ? 1e9
                               : isMega ? 1e6
                                        : 1e3),
                     isGiga   ? "GPa"
                     : isMega ? "MPa"
                              : "kPa");
}

}  // namespace

Expected<std::vector<double>> volumesOf(const imaging::LabelMap &map, const ProgressFn &progress) {
  const auto counted = imaging::statisticsOfLabels(map, nullptr, progress);
  if (!counted) return tl::unexpected(counted.error());
  std::vector<double> volumes;
  for (const imaging::RegionStatistics &label : *counted)
    volumes.push_back(static_cast<double>(label.voxels) * map.geometry.voxelVolume() / 1000.0);
  return volumes;
}

std::string stiffnessText(double value, double low, double high) {
  return modulusText(value) + " (" + modulusText(low) + " … " + modulusText(high) + ")";
}

SegmentationWorkflow::SegmentationWorkflow(BackgroundJobs &jobs, std::string jobOwner,
                                           const scene::MaterialLibrary &materials, Events events)
    : jobs_(jobs), jobOwner_(std::move(jobOwner)), materials_(materials), events_(std::move(events)),
      mask_(jobs, jobOwner_, [this] { onMaskChanged(); }), alive_(std::make_shared<bool>(true)) {}

SegmentationWorkflow::~SegmentationWorkflow() { *alive_ = false; }

void SegmentationWorkflow::setSources(MaskSources sources) {
  const MaskSources before = mask_.sources();
  if (sources.image != before.image) {
    settings_ = {};
    isMaterialChosen_ = false;
    rigid_.reset();
    if (sources.image) {
      // Initially the upper half of the range, so that a result is visible and the slider shows the direction.
      const imaging::ValueRange &range = sources.image->range;
      settings_.low = 0.5 * (range.low + range.high);
      settings_.high = range.max;
      settings_.brush.values = {settings_.low, settings_.high};
      settings_.growTolerance = kGrowShare * (range.high - range.low);
    }
  }
  const bool hasOtherLabels = sources.labels != before.labels;
  settings_.isFromLabel = sources.labels != nullptr && (hasOtherLabels || settings_.isFromLabel);
  followsUndo_ = false;
  paintedNormal_.reset();
  mask_.setSources(std::move(sources));
  if (!hasOtherLabels) return;
  if (!counting_.isNull()) jobs_.cancel(std::exchange(counting_, {}));
  ++serial_;
  labelVolumes_ml_.clear();
  labelMaterials_.clear();
  labelRigid_.clear();
  if (mask_.sources().labels) countLabels();
}

void SegmentationWorkflow::countLabels() {
  const auto volumes = std::make_shared<std::vector<double>>();
  counting_ = jobs_.submit(
      jobOwner_, "Measuring labels",
      [labels = mask_.sources().labels, volumes](const ProgressFn &progress) -> Expected<void> {
        auto counted = volumesOf(labels->map, progress);
        if (!counted) return tl::unexpected(counted.error());
        *volumes = std::move(*counted);
        return {};
      },
      [this, alive = alive_, serial = serial_, volumes](const Expected<void> &done) {
        if (!*alive || serial != serial_) return;
        counting_ = {};
        if (done) labelVolumes_ml_ = std::move(*volumes);
      });
}

std::vector<SegmentationWorkflow::LabelRow> SegmentationWorkflow::labels() const {
  std::vector<LabelRow> rows;
  const auto &labels = mask_.sources().labels;
  if (!labels) return rows;
  const std::vector<std::uint16_t> picked = pickedLabels();
  for (std::size_t i = 0; i < labels->map.labels.size(); ++i) {
    const imaging::LabelMap::Label &label = labels->map.labels[i];
    const bool isChosen = std::find(picked.begin(), picked.end(), label.value) != picked.end();
    LabelRow row{label.value, label.name, render::displayColour(label.colour), {}, isChosen};
    if (i < labelVolumes_ml_.size()) row.volume_ml = labelVolumes_ml_[i];
    rows.push_back(std::move(row));
  }
  return rows;
}

std::vector<std::uint16_t> SegmentationWorkflow::pickedLabels() const {
  std::vector<std::uint16_t> picked;
  for (const MaskStep &step : mask_.plannedSteps()) {
    if (!step.ignoresPreviousMask()) continue;
    picked = step.labels;
    if (step.kind == MaskStep::Kind::label) picked = {step.label};
  }
  return picked;
}

Selection SegmentationWorkflow::selection() const {
  return {mask_.mask(), pickedLabels(), settings_.name, settings_.low, settings_.high};
}

void SegmentationWorkflow::restore(const Selection &selection) {
  settings_.low = selection.low;
  settings_.high = selection.high;
  settings_.isFromLabel = !selection.labels.empty();
  if (selection.mask) {
    MaskStep step;
    step.kind = MaskStep::Kind::restored;
    step.labels = selection.labels;
    step.low = selection.low;
    step.high = selection.high;
    mask_.restore(selection.mask, step);
  } else {
    chooseLabels(selection.labels);
  }
  setName(selection.name);
}

std::string SegmentationWorkflow::nameOf(std::uint16_t label) const {
  const auto &labels = mask_.sources().labels;
  const std::string name = labels ? labels->nameOf(label) : std::string();
  return name.empty() ? "label " + std::to_string(label) : name;
}

void SegmentationWorkflow::chooseLabels(const std::vector<std::uint16_t> &values) {
  if (!mask_.sources().labels || values == pickedLabels()) return;
  if (values.size() == 1) return chooseLabel(values.front());
  settings_.isFromLabel = true;
  MaskStep step;
  step.kind = MaskStep::Kind::labels;
  step.labels = values;
  mask_.applyStep(step);
}

void SegmentationWorkflow::setLabelPicked(std::uint16_t value, bool isPicked) {
  std::vector<std::uint16_t> picked = pickedLabels();
  std::erase(picked, value);
  if (isPicked) picked.push_back(value);
  chooseLabels(picked);
}

void SegmentationWorkflow::chooseLabel(std::uint16_t value) { chooseLabel(value, {}); }

void SegmentationWorkflow::chooseLabel(std::uint16_t value, MaskStep step) {
  if (!mask_.sources().labels) return;
  settings_.isFromLabel = true;
  settings_.name = nameOf(value);
  isMaterialChosen_ = false;
  rigid_.reset();
  preselectMaterial();
  step.kind = MaskStep::Kind::label;
  step.label = value;
  mask_.applyStep(step);
}

void SegmentationWorkflow::toggleLabelAt(const Vec3 &world) {
  const auto &labels = mask_.sources().labels;
  if (!labels) return;
  if (const std::uint16_t value = labels->at(world); value != 0) return setLabelPicked(value, true);
  clickProblem_ = fmt::format(
      "the click at LPS {:.1f}, {:.1f}, {:.1f} mm is on no label; the line below each view names what is under the "
      "mouse",
      world[0], world[1], world[2]);
}

void SegmentationWorkflow::setLow(double low) {
  settings_.low = low;
  settings_.high = std::max(settings_.high, low);
  showThreshold();
}

void SegmentationWorkflow::setHigh(double high) {
  settings_.high = high;
  settings_.low = std::min(settings_.low, high);
  showThreshold();
}

void SegmentationWorkflow::showThreshold() {
  settings_.isFromLabel = false;
  MaskStep step;
  step.kind = MaskStep::Kind::threshold;
  step.low = settings_.low;
  step.high = settings_.high;
  mask_.applyStep(step);
}

void SegmentationWorkflow::keepComponentAt(const Vec3 &world) {
  MaskStep step;
  step.kind = MaskStep::Kind::component;
  step.world = world;
  mask_.applyStep(step);
}

void SegmentationWorkflow::applyStep(MaskStep::Kind kind) {
  MaskStep step;
  step.kind = kind;
  step.radius_mm = settings_.radius_mm;
  mask_.applyStep(step);
}

void SegmentationWorkflow::paint(std::vector<Vec3> path, const Vec3 &normal) {
  if (isSeveral()) {
    clickProblem_ = kSeveralPicked;
    return;
  }
  MaskStep step;
  step.kind = MaskStep::Kind::paint;
  step.stroke.path = std::move(path);
  step.stroke.radius_mm = settings_.brush.radius_mm;
  step.stroke.isErasing = settings_.brush.isErasing;
  if (!settings_.brush.isBall) step.stroke.normal = normal;
  if (settings_.brush.isLimited) step.stroke.values = settings_.brush.values;
  paintedNormal_ = normal;
  mask_.applyStep(step);
}

void SegmentationWorkflow::setGrowing(double tolerance, double distance_mm) {
  settings_.growTolerance = tolerance;
  settings_.growDistance_mm = distance_mm;
}

void SegmentationWorkflow::growAt(const Vec3 &world) {
  if (isSeveral()) {
    clickProblem_ = kSeveralPicked;
    return;
  }
  MaskStep step;
  step.kind = MaskStep::Kind::grow;
  step.world = world;
  step.tolerance = settings_.growTolerance;
  step.radius_mm = settings_.growDistance_mm;
  mask_.applyStep(step);
}

void SegmentationWorkflow::fillBetween() {
  MaskStep step;
  step.kind = MaskStep::Kind::fillBetween;
  step.stroke.normal = paintedNormal_;
  mask_.applyStep(step);
}

bool SegmentationWorkflow::isMaskSavedAlone() const {
  const auto &labels = mask_.sources().labels;
  return labels && mask_.mask() && !imaging::sameGrid(labels->map.geometry, mask_.mask()->geometry);
}

std::function<Expected<imaging::LabelMap>()> SegmentationWorkflow::labelMapToSave() const {
  const std::vector<std::uint16_t> picked = pickedLabels();
  imaging::LabelMap::Label label;
  if (picked.size() == 1) label.value = picked.front();
  label.name = settings_.name.empty() ? std::string("organ") : settings_.name;
  const render::Colour shown = colour();
  for (std::size_t c = 0; c < 3; ++c) label.colour[c] = linear(shown[c]);
  const std::shared_ptr<const scene::StoredLabels> labels = isMaskSavedAlone() ? nullptr : mask_.sources().labels;
  if (isMaskSavedAlone()) label.value = 1;
  return [label, labels, mask = mask_.mask()]() -> Expected<imaging::LabelMap> {
    if (mask) return imaging::withLabel(labels ? &labels->map : nullptr, *mask, label);
    if (labels) return labels->map;
    return fail(ErrorCode::state, "nothing is picked or painted yet");
  };
}

std::function<Expected<std::string>(const ProgressFn &)> SegmentationWorkflow::statisticsToSave() const {
  return [sources = mask_.sources(), mask = mask_.mask(), picked = mask_.statistics(),
          name = settings_.name](const ProgressFn &progress) -> Expected<std::string> {
    std::vector<imaging::NamedRegion> regions;
    if (mask) regions.push_back({{}, name.empty() ? "organ" : name, picked, mask->geometry.voxelVolume()});
    if (sources.labels) {
      const imaging::LabelMap &map = sources.labels->map;
      const auto measured =
          imaging::statisticsOfLabels(map, sources.image ? &sources.image->volume : nullptr, progress);
      if (!measured) return tl::unexpected(measured.error());
      for (std::size_t i = 0; i < map.labels.size(); ++i)
        regions.push_back(
            {std::to_string(map.labels[i].value), map.labels[i].name, (*measured)[i], map.geometry.voxelVolume()});
    }
    if (regions.empty()) return fail(ErrorCode::state, "nothing is picked or painted yet, and no label map is open");
    return imaging::statisticsCsv(regions, sources.image ? sources.image->volume.unit : std::string());
  };
}

void SegmentationWorkflow::undo() {
  followsUndo_ = true;
  mask_.undo();
}

void SegmentationWorkflow::redo() {
  followsUndo_ = true;
  mask_.redo();
}

/// After undo or redo, sets the controls to the values that the mask was made with.
void SegmentationWorkflow::onMaskChanged() {
  clickProblem_.clear();
  if (followsUndo_ && !mask_.isBusy()) {
    followsUndo_ = false;
    for (const MaskStep &step : mask_.steps()) {
      if (!step.ignoresPreviousMask()) continue;
      settings_.isFromLabel = step.kind != MaskStep::Kind::threshold;
      if (step.kind == MaskStep::Kind::restored) settings_.isFromLabel = !step.labels.empty();
      if (step.kind == MaskStep::Kind::label && settings_.name != nameOf(step.label)) {
        settings_.name = nameOf(step.label);
        isMaterialChosen_ = false;
        rigid_.reset();
        preselectMaterial();
      }
      if (settings_.isFromLabel) continue;
      settings_.low = step.low;
      settings_.high = step.high;
    }
  }
  if (events_.maskChanged) events_.maskChanged();
  if (isUpdatedLive_ && isEditingBody() && mask_.mask() != requested_) updateBody();
}

bool SegmentationWorkflow::isEditingBody() const {
  if (!presentBody() || editedBody_ != settings_.name) return false;
  const std::vector<MaskStep> steps = mask_.steps();
  const auto source =
      std::find_if(steps.rbegin(), steps.rend(), [](const MaskStep &step) { return step.ignoresPreviousMask(); });
  // What it was taken from may have been dropped from a long history.
  return source == steps.rend() || source->kind == MaskStep::Kind::restored;
}

bool SegmentationWorkflow::undoUpdate(const MaskRange &range) {
  if (range.history != mask_.history() || mask_.position() <= range.from || mask_.isBusy()) return false;
  followsUndo_ = true;
  mask_.undo(mask_.position() - range.from);
  bodyPosition_ = range.from;
  return true;
}

bool SegmentationWorkflow::redoUpdate(const MaskRange &range) {
  if (range.history != mask_.history() || mask_.position() >= range.to || mask_.isBusy()) return false;
  followsUndo_ = true;
  mask_.redo(range.to - mask_.position());
  bodyPosition_ = range.to;
  return true;
}

const SegmentationWorkflow::ExistingBody *SegmentationWorkflow::presentBody() const {
  if (isSeveral()) return nullptr;
  const auto found = std::find_if(bodies_.begin(), bodies_.end(),
                                  [this](const ExistingBody &body) { return body.name == settings_.name; });
  return found == bodies_.end() ? nullptr : &*found;
}

void SegmentationWorkflow::editBody(const std::string &name) {
  const auto found =
      std::find_if(bodies_.begin(), bodies_.end(), [&name](const ExistingBody &body) { return body.name == name; });
  if (found == bodies_.end()) return;
  editedBody_ = name;
  bodyPosition_ = 1;
  restore({found->mask, {}, name, settings_.low, settings_.high});
}

std::string SegmentationWorkflow::updateReason() const {
  const ExistingBody *body = presentBody();
  if (!body) return "no body has the name '" + settings_.name + "'";
  if (mask_.isBusy()) return "the mask is being computed";
  if (!mask_.mask() || mask_.voxels() == 0) return "the mask is empty (1)";
  if (areEqual(mask_.mask(), body->mask)) return "the mask is that of the body";
  return {};
}

bool SegmentationWorkflow::areEqual(const std::shared_ptr<const imaging::Mask> &one,
                                    const std::shared_ptr<const imaging::Mask> &other) const {
  if (one == other) return true;
  if (compared_.one != one || compared_.other != other)
    compared_ = {one, other, imaging::sameGrid(one->geometry, other->geometry) && one->voxels == other->voxels};
  return compared_.isEqual;
}

void SegmentationWorkflow::updateBody() {
  if (!events_.update || !updateReason().empty()) return;
  requested_ = mask_.mask();
  const std::size_t position = mask_.position();
  const std::size_t from = isEditingBody() ? std::min(bodyPosition_, position) : position;
  events_.update(settings_.name, mask_.mask(), {mask_.history(), from, position});
}

render::Colour SegmentationWorkflow::colour() const {
  if (!isSeveral())
    for (const LabelRow &row : labels())
      if (row.isChosen) return row.colour;
  return kThresholdColour;
}

std::string SegmentationWorkflow::maskProblem() const {
  if (!clickProblem_.empty()) return clickProblem_;
  if (!mask_.problem().empty() || !mask_.mask() || mask_.voxels() > 0) return mask_.problem();
  const std::vector<MaskStep> steps = mask_.steps();
  const bool isThreshold = !steps.empty() && steps.back().kind == MaskStep::Kind::threshold;
  if (!isThreshold) return "the mask is empty: nothing is left after the last step; Undo goes back";
  const std::string &unit = mask_.sources().image->volume.unit;
  return "the mask is empty: no voxel has a value from " + formatNumber(steps.back().low) + " to " +
         formatNumber(steps.back().high) + (unit.empty() ? "" : " " + unit) + "; widen the limits";
}

void SegmentationWorkflow::preselectMaterial() {
  if (isMaterialChosen_) return;
  const scene::MaterialPreset *preset = scene::presetForOrgan(materials_, settings_.name);
  settings_.material = preset ? preset->name : std::string();
}

void SegmentationWorkflow::chooseMaterial(const std::string &preset) {
  settings_.material = preset;
  isMaterialChosen_ = true;
}

void SegmentationWorkflow::setName(const std::string &name) {
  settings_.name = name;
  preselectMaterial();
}

const scene::MaterialPreset *SegmentationWorkflow::materialOf(std::uint16_t label) const {
  if (const auto chosen = labelMaterials_.find(label); chosen != labelMaterials_.end())
    return materials_.find(chosen->second);
  return scene::presetForOrgan(materials_, nameOf(label));
}

void SegmentationWorkflow::chooseMaterialOf(std::uint16_t label, const std::string &preset) {
  labelMaterials_[label] = preset;
}

void SegmentationWorkflow::setHolding(Held held, double surroundings_Pa_m) {
  settings_.held = held;
  settings_.surroundings_Pa_m = surroundings_Pa_m;
}

bool SegmentationWorkflow::isRigid() const { return rigid_.value_or(material() && material()->isRigid); }

bool SegmentationWorkflow::isRigid(std::uint16_t label) const {
  if (const auto chosen = labelRigid_.find(label); chosen != labelRigid_.end()) return chosen->second;
  const scene::MaterialPreset *preset = materialOf(label);
  return preset && preset->isRigid;
}

void SegmentationWorkflow::setMending(const imaging::MaskCleanUp &mend) { settings_.mend = mend; }

std::string SegmentationWorkflow::blockingReason() const {
  const std::vector<std::uint16_t> picked = pickedLabels();
  if (picked.size() > 1) {
    constexpr std::size_t kMaxNames = 6;
    std::string without;
    std::size_t count = 0;
    for (const std::uint16_t label : picked)
      if (!materialOf(label) && ++count <= kMaxNames) without += (without.empty() ? "" : ", ") + nameOf(label);
    if (count > kMaxNames) without += " and " + std::to_string(count - kMaxNames) + " more";
    return without.empty() ? without : "no material is chosen for " + without + " (2)";
  }
  if (!mask_.mask() && !mask_.isBusy()) return "nothing is picked yet (1)";
  if (mask_.isBusy()) return "the mask is being computed";
  if (mask_.voxels() == 0) return "the mask is empty (1)";
  if (!material()) return "no material is chosen (2)";
  if (settings_.name.empty()) return "the body has no name (2)";
  return {};
}

BodyRequest SegmentationWorkflow::requestOfSettings() const {
  BodyRequest request;
  const SamplingChoice &sampling = settings_.sampling;
  request.points = sampling.isCountAutomatic ? 0 : static_cast<std::size_t>(std::lround(sampling.points));
  request.edge_mm = sampling.isEdgeAutomatic ? 0.0 : sampling.edge_mm;
  request.held = settings_.held;
  request.surroundings_Pa_m = settings_.surroundings_Pa_m;
  return request;
}

void SegmentationWorkflow::createBodies() {
  if (!blockingReason().empty() || !events_.make) return;
  const std::vector<std::uint16_t> picked = pickedLabels();
  std::vector<BodyRequest> requests;
  if (picked.size() < 2) {
    BodyRequest &request = requests.emplace_back(requestOfSettings());
    request.name = settings_.name;
    request.mask = mask_.mask();
    request.material = settings_.material;
    request.isRigid = isRigid();
    if (!picked.empty()) request.label = picked.front(), request.labels = mask_.sources().labels;
    return events_.make(std::move(requests));
  }
  for (const std::uint16_t label : picked) {
    BodyRequest &request = requests.emplace_back(requestOfSettings());
    const std::string name = nameOf(label);
    const bool isUsed = std::any_of(picked.begin(), picked.end(),
                                    [&](std::uint16_t other) { return other != label && nameOf(other) == name; });
    request.name = isUsed ? name + " (" + std::to_string(label) + ")" : name;
    request.labels = mask_.sources().labels;
    request.label = label;
    request.mend = settings_.mend;
    request.material = materialOf(label)->name;
    request.isRigid = isRigid(label);
  }
  events_.make(std::move(requests));
}

void SegmentationWorkflow::onBodiesCreated(const std::vector<BodyRequest> &created) {
  std::vector<std::uint16_t> picked = pickedLabels();
  bool isPickCreated = false;
  for (const BodyRequest &one : created) {
    const bool isOfThisMap = one.labels && one.labels == mask_.sources().labels;
    if (!one.mask && isOfThisMap) isPickCreated = std::erase(picked, one.label) > 0 || isPickCreated;
    if (!one.mask || one.mask != mask_.mask()) continue;
    picked.clear();
    isPickCreated = true;
  }
  if (!isPickCreated) return;
  MaskStep rest;
  rest.isRest = true;
  if (picked.size() == 1) return chooseLabel(picked.front(), rest);
  rest.kind = MaskStep::Kind::labels;
  rest.labels = picked;
  mask_.applyStep(rest);
}

bool SegmentationWorkflow::hasJustCreated() const {
  const std::vector<MaskStep> steps = mask_.steps();
  return !steps.empty() && steps.back().isRest;
}

}  // namespace c3de::segmentation
