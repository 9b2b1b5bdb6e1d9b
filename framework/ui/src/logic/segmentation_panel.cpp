// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/segmentation_panel.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "c3de/ui/commands.h"
#include "logic/label_list.h"
#include "logic/panel_widgets.h"

namespace c3de::ui {
namespace {

constexpr double kFewestPoints = 50.0, kMaxPoints = 20000.0, kShortestEdge_mm = 0.5, kLongestEdge_mm = 30.0;
constexpr double kStiffestSurroundings = 3e5;  // Pa/m
constexpr const char *kRigid =
    "Stays fixed at its position in the scan, at no cost: for bone, which would otherwise limit every step";
constexpr double kSmallestRadius_mm = 0.5, kLargestRadius_mm = 20.0, kFarthestGrowth_mm = 200.0;

void swatch(const c3de_ui_v1 &ui, const render::Colour &colour) {
  ui.swatch(ui.ctx, colour[0], colour[1], colour[2]);
  sameLine(ui);
}

}  // namespace

SegmentationPanel::SegmentationPanel(registry::PanelRegistry &panels, Parts parts)
    : panels_(panels), views_(parts.views), workflow_(parts.workflow), scanBody_(parts.scanBody), brush_(parts.brush),
      saveLabels_(std::move(parts.saveLabels)) {
  registry::Panel panel;
  panel.owner = "c3de";
  panel.id = "segmentation";
  panel.title = "Segmentation";
  panel.self = this;
  panel.onUi = [](void *self, const c3de_ui_v1 *ui) { static_cast<SegmentationPanel *>(self)->draw(*ui); };
  panel_ = panels_.add(std::move(panel));
}

SegmentationPanel::~SegmentationPanel() {
  views_.cancelPick();
  panels_.remove(panel_);
}

void SegmentationPanel::draw(const c3de_ui_v1 &ui) {
  if (!workflow_.mask().sources().image) return;
  if (scanBody_.isPossible()) {
    if (button(ui, "create_scan_body", commandInfo(Command::createScanBody).label)) scanBody_.show(true);
    tooltip(ui, commandInfo(Command::createScanBody).doc);
    text(ui, "Or one organ of it:");
  }
  heading(ui, "1  Pick it in the image");
  drawSource(ui);
  drawBodies(ui);
  const std::size_t several = workflow_.isSeveral() ? workflow_.pickedLabels().size() : 0;
  if (several > 0) {
    drawSeveral(ui);
  } else {
    drawMask(ui);
    drawPainting(ui);
    drawGrowing(ui);
    drawSteps(ui);
  }
  drawUndo(ui);
  const bool canSave = workflow_.mask().mask() || workflow_.mask().sources().labels;
  if (button(ui, "save_labels", commandInfo(Command::saveLabels).label, canSave) && saveLabels_) saveLabels_();
  tooltip(ui, commandInfo(Command::saveLabels).doc);
  // One step at a time: the others would only fill the panel.
  if (several == 0 && !workflow_.mask().mask()) return text(ui, "Next: material, sampling and simulation.");
  heading(ui, several > 0 ? "2  Materials" : "2  Material");
  if (several > 0)
    drawMaterials(ui);
  else
    drawMaterial(ui);
  heading(ui, several > 0 ? "3  Sampling, of each" : "3  Sampling");
  drawSampling(ui);
  drawHolding(ui);
  heading(ui, "4  Simulate");
  if (workflow_.presentBody()) return drawUpdate(ui);
  const std::string reason = workflow_.blockingReason();
  const std::string create = several > 0 ? fmt::format("Create {} bodies", several) : std::string("Create body");
  if (button(ui, "create", create, reason.empty())) workflow_.createBodies();
  tooltip(ui, "A body of the simulation of each that is picked: its surface, its points, its material");
  if (!reason.empty()) text(ui, "Not yet: " + reason + ".");
}

void SegmentationPanel::drawUpdate(const c3de_ui_v1 &ui) {
  const std::string reason = workflow_.updateReason();
  if (button(ui, "update", "Update body", reason.empty())) workflow_.updateBody();
  tooltip(ui,
          "Replaces the mask of the body. It keeps material, sampling and supports, and continues with its present "
          "deformation");
  if (workflow_.isEditingBody()) {
    bool isLive = workflow_.isUpdatedLive();
    checkbox(ui, "update_live", "After every change of the mask", isLive,
             "Each change updates the body at once; a stroke of the brush when the mouse button is released");
    workflow_.setUpdatedLive(isLive);
  }
  text(ui, reason.empty() ? "The mask differs from that of the body." : "Not yet: " + reason + ".");
  text(ui, "A body of this name exists; another name creates another body.");
}

void SegmentationPanel::drawBodies(const c3de_ui_v1 &ui) {
  if (workflow_.bodies().empty()) return;
  std::vector<std::string> names{"– choose –"};
  for (const auto &body : workflow_.bodies()) names.push_back(body.name);
  std::uint32_t index = 0;
  if (choice(ui, "edit_body", "Edit the mask of a body", index, names) && index > 0) workflow_.editBody(names[index]);
}

void SegmentationPanel::clickButton(const c3de_ui_v1 &ui, const char *id, const char *label, const char *doc,
                                    void (segmentation::SegmentationWorkflow::*clicked)(const Vec3 &)) {
  const bool isAwaited = views_.isPicking() && awaited_ && std::string_view(awaited_) == id;
  const bool isPressed = button(ui, id, isAwaited ? "Click it in a slice…" : label);
  tooltip(ui, doc);
  if (!isPressed) return;
  awaited_ = id;
  if (isAwaited)
    views_.cancelPick();
  else
    views_.pickNext([workflow = &workflow_, clicked](const Vec3 &reference) { (workflow->*clicked)(reference); });
}

void SegmentationPanel::drawSource(const c3de_ui_v1 &ui) {
  if (workflow_.mask().sources().labels) {
    std::uint32_t index = workflow_.settings().isFromLabel ? 0 : 1;
    if (choice(ui, "source", "From", index, {"a label", "values between"})) workflow_.setFromLabel(index == 0);
  }
  if (workflow_.settings().isFromLabel)
    drawLabels(ui);
  else
    drawThreshold(ui);
}

void SegmentationPanel::drawLabels(const c3de_ui_v1 &ui) {
  const std::vector<segmentation::SegmentationWorkflow::LabelRow> rows = workflow_.labels();
  std::vector<const segmentation::SegmentationWorkflow::LabelRow *> listed;
  for (const segmentation::SegmentationWorkflow::LabelRow &row : rows)
    if (rows.size() <= kManyLabels || isListed(row.name, filter_)) listed.push_back(&row);
  clickButton(ui, "label_click", "Tick the label I click",
              "The next click in a slice selects the label there. Esc: cancel",
              &segmentation::SegmentationWorkflow::toggleLabelAt);
  labelList(ui, rows.size(), listed.size(), filter_, [&] {
    for (const segmentation::SegmentationWorkflow::LabelRow *row : listed) {
      swatch(ui, row->colour);
      bool isPicked = row->isChosen;
      const std::string volume = row->volume_ml ? fmt::format("{:.1f} ml", *row->volume_ml) : std::string("… ml");
      if (checkbox(ui, "label." + std::to_string(row->value), row->name + "   " + volume, isPicked, ""))
        workflow_.setLabelPicked(row->value, isPicked);
    }
  });
  if (rows.size() < 2) return;
  if (button(ui, "tick_listed", "Tick the listed", !listed.empty())) {
    std::vector<std::uint16_t> values = workflow_.pickedLabels();
    for (const segmentation::SegmentationWorkflow::LabelRow *row : listed)
      if (!row->isChosen) values.push_back(row->value);
    workflow_.chooseLabels(values);
  }
  tooltip(ui, "Beside those that are ticked already. Each becomes a body of its own");
  sameLine(ui);
  if (button(ui, "untick", "Untick all", !workflow_.pickedLabels().empty())) workflow_.chooseLabels({});
}

void SegmentationPanel::drawThreshold(const c3de_ui_v1 &ui) {
  const scene::StoredImage &image = *workflow_.mask().sources().image;
  double low = workflow_.settings().low, high = workflow_.settings().high;
  const double least = std::min({image.range.min, low}), most = std::max({image.range.max, high});
  drawHistogram(ui, image);
  if (slider(ui, "low", "Lowest", image.volume.unit, low, least, most, "The lowest value that belongs to the body"))
    workflow_.setLow(low);
  if (slider(ui, "high", "Highest", image.volume.unit, high, least, most, "The highest value that belongs to the body"))
    workflow_.setHigh(high);
  bool isShown = false;
  for (const segmentation::MaskStep &step : workflow_.mask().steps())
    if (step.ignoresPreviousMask()) isShown = step.kind == segmentation::MaskStep::Kind::threshold;
  if (!isShown && button(ui, "threshold", "Show what lies between")) workflow_.showThreshold();
}

/// The peaks are tissues; a threshold between two of them separates these.
void SegmentationPanel::drawHistogram(const c3de_ui_v1 &ui, const scene::StoredImage &image) {
  if (image.histogram.empty()) return;
  const double low = workflow_.settings().low, high = workflow_.settings().high;
  const double width = (image.range.max - image.range.min) / static_cast<double>(image.histogram.size());
  std::vector<double> logarithms;
  double inside = 0.0, all = 0.0;
  for (std::size_t i = 0; i < image.histogram.size(); ++i) {
    const auto count = static_cast<double>(image.histogram[i]);
    const double begin = image.range.min + width * static_cast<double>(i);
    // Values are taken to be evenly distributed in an interval.
    inside += count * std::clamp((std::min(high, begin + width) - std::max(low, begin)) / width, 0.0, 1.0);
    all += count;
    logarithms.push_back(std::log10(1.0 + count));
  }
  const std::string label = "log10 of the number of voxels, " + formatNumber(image.range.min) + " … " +
                            formatNumber(image.range.max) + (image.volume.unit.empty() ? "" : " " + image.volume.unit);
  ui.curve(ui.ctx, toAbi(std::string_view("histogram")), toAbi(label), toAbi(std::string_view()), logarithms.data(),
           logarithms.size());
  row(ui, "Between", fmt::format("about {:.3g} % of the voxels", all > 0.0 ? 100.0 * inside / all : 0.0));
}

void SegmentationPanel::drawMask(const c3de_ui_v1 &ui) {
  const segmentation::MaskEditor &mask = workflow_.mask();
  const bool hasMask = mask.mask() != nullptr;
  std::string volume =
      hasMask ? fmt::format("{:.1f} ml, {} voxels", mask.volume_ml(), mask.voxels()) : std::string("nothing yet");
  if (mask.isBusy()) volume += " …";
  row(ui, "Picked", volume);
  if (const std::string problem = workflow_.maskProblem(); !problem.empty()) row(ui, "Problem", problem);
  if (!hasMask) return;
  if (const imaging::RegionStatistics &s = mask.statistics(); s.measured > 0) {
    const std::string &unit = mask.sources().image->volume.unit;
    row(ui, "Values",
        fmt::format("{:.4g} ± {:.3g}{}, {} … {}", s.mean, s.sd, unit.empty() ? "" : " " + unit, formatNumber(s.min),
                    formatNumber(s.max)));
    tooltip(ui, "Mean ± standard deviation, least and largest value of the image in the mask");
  }
  swatch(ui, workflow_.colour());
  ImageOptions options = views_.options();
  if (checkbox(ui, "overlay", "Show it over the slices", options.showsPreview, "Instead of the label map"))
    views_.setOptions(options);
  if (checkbox(ui, "surface", "Show its surface in 3D", options.showsPreviewSurface,
               "Coarse, and as the mask was read"))
    views_.setOptions(options);
  if (mask.preview() && mask.preview()->stride > 1)
    row(ui, "Overlay", fmt::format("every {}. voxel", mask.preview()->stride));
  std::string done;
  for (const segmentation::MaskStep &step : mask.steps())
    done = step.ignoresPreviousMask() ? step.text() : done + (done.empty() ? "" : ", ") + step.text();
  if (!done.empty()) row(ui, "Steps", done);
}

void SegmentationPanel::drawPainting(const c3de_ui_v1 &ui) {
  segmentation::BrushSettings brush = workflow_.settings().brush;
  if (button(ui, "brush", brush_.isActive() ? "Stop painting" : "Brush")) brush_.toggle();
  tooltip(ui, "Paint the mask in the slices with the left mouse button (K). Ctrl+Z undoes a stroke");
  if (!brush_.isActive()) return;
  std::uint32_t isErasing = brush.isErasing ? 1 : 0, isBall = brush.isBall ? 1 : 0;
  choice(ui, "brush_mode", "Brush", isErasing, {"paints", "erases"});
  tooltip(ui, "E switches between them");
  choice(ui, "brush_shape", "Shape", isBall, {"disc in the slice", "ball"});
  slider(ui, "brush_radius", "Brush radius", "mm", brush.radius_mm, MaskBrush::kSmallest_mm, MaskBrush::kLargest_mm,
         "[ and ] change it");
  checkbox(ui, "brush_limited", "Only values between", brush.isLimited, "Other voxels stay as they are");
  if (brush.isLimited) {
    const scene::StoredImage &image = *workflow_.mask().sources().image;
    const double least = std::min(image.range.min, brush.values.low),
                 most = std::max(image.range.max, brush.values.high);
    slider(ui, "brush_low", "From", image.volume.unit, brush.values.low, least, most, "");
    slider(ui, "brush_high", "Up to", image.volume.unit, brush.values.high, least, most, "");
    brush.values.high = std::max(brush.values.low, brush.values.high);
  }
  brush.isErasing = isErasing != 0;
  brush.isBall = isBall != 0;
  workflow_.setBrush(brush);
}

void SegmentationPanel::drawGrowing(const c3de_ui_v1 &ui) {
  clickButton(ui, "grow", "Grow from a click",
              "The next click in a slice adds the connected voxels with similar values. Esc: cancel",
              &segmentation::SegmentationWorkflow::growAt);
  const scene::StoredImage &image = *workflow_.mask().sources().image;
  double tolerance = workflow_.settings().growTolerance, distance = workflow_.settings().growDistance_mm;
  bool isChanged =
      slider(ui, "grow_tolerance", "Tolerance", image.volume.unit, tolerance, 0.0,
             std::max(image.range.high - image.range.low, tolerance), "Largest difference from the value at the click");
  isChanged = slider(ui, "grow_distance", "Maximum distance", "mm", distance, 0.0, kFarthestGrowth_mm,
                     "Distance from the click; 0: unlimited") ||
              isChanged;
  if (isChanged) workflow_.setGrowing(tolerance, distance);
}

void SegmentationPanel::drawSteps(const c3de_ui_v1 &ui) {
  using Kind = segmentation::MaskStep::Kind;
  if (!workflow_.mask().mask()) return;
  if (button(ui, "fill_between", "Fill between slices")) workflow_.fillBetween();
  tooltip(ui, "Interpolates the mask in the empty slices between painted ones");
  clickButton(ui, "component", "Keep only the part I click",
              "The next click in a slice keeps the part connected to that voxel. Esc: cancel",
              &segmentation::SegmentationWorkflow::keepComponentAt);
  if (button(ui, "largest", "Keep the largest part")) workflow_.applyStep(Kind::largest);
  sameLine(ui);
  if (button(ui, "fill_holes", "Fill holes")) workflow_.applyStep(Kind::fillHoles);
  double radius = workflow_.settings().radius_mm;
  if (slider(ui, "radius", "Radius", "mm", radius, kSmallestRadius_mm, kLargestRadius_mm, "Of closing and opening"))
    workflow_.setRadius(radius);
  if (button(ui, "close", "Close gaps")) workflow_.applyStep(Kind::close);
  tooltip(ui, "Closing: gaps and bays narrower than twice the radius are filled");
  sameLine(ui);
  if (button(ui, "open", "Remove bridges")) workflow_.applyStep(Kind::open);
  tooltip(ui, "Opening: bridges and spurs narrower than twice the radius are removed");
}

void SegmentationPanel::drawUndo(const c3de_ui_v1 &ui) {
  const segmentation::MaskEditor &mask = workflow_.mask();
  if (!mask.mask() && !mask.canUndo() && !mask.canRedo()) return;
  const std::string undone = mask.undoLabel(), redone = mask.redoLabel();
  if (button(ui, "undo", "Undo", !undone.empty())) workflow_.undo();
  tooltip(ui, ("Undoes the last step" + (undone.empty() ? "" : ": " + undone) +
               " (Ctrl+Z; not by keys after a body was created: what it comes from is laid over it)")
                  .c_str());
  sameLine(ui);
  if (button(ui, "redo", "Redo", !redone.empty())) workflow_.redo();
  tooltip(ui, ("Redoes the undone step" + (redone.empty() ? "" : ": " + redone) + " (Ctrl+Shift+Z)").c_str());
}

void SegmentationPanel::drawSeveral(const c3de_ui_v1 &ui) {
  double volume_ml = 0.0;
  bool isCounted = true;
  std::string names;
  for (const segmentation::SegmentationWorkflow::LabelRow &row : workflow_.labels()) {
    if (!row.isChosen) continue;
    names += (names.empty() ? "" : ", ") + row.name;
    isCounted = isCounted && row.volume_ml;
    volume_ml += row.volume_ml.value_or(0.0);
  }
  row(ui, "Picked",
      isCounted ? fmt::format("{} labels, {:.1f} ml", workflow_.pickedLabels().size(), volume_ml)
                : fmt::format("{} labels", workflow_.pickedLabels().size()));
  row(ui, "Ticked", names);
  if (const std::string problem = workflow_.maskProblem(); !problem.empty()) row(ui, "Problem", problem);
  imaging::MaskCleanUp mend = workflow_.settings().mend;
  checkbox(ui, "each_largest", "Keep the largest part of each", mend.largest, "Voxels that lie apart are left out");
  checkbox(ui, "each_filled", "Fill the holes of each", mend.fillHoles, "What is enclosed on all sides");
  workflow_.setMending(mend);
}

void SegmentationPanel::drawMaterial(const c3de_ui_v1 &ui) {
  std::string name = workflow_.settings().name;
  if (inputText(ui, "name", "Name", name)) workflow_.setName(name);
  std::vector<std::string> names{"– choose –"};
  std::uint32_t index = 0;
  for (const scene::MaterialPreset &preset : workflow_.materials().presets()) {
    if (preset.name == workflow_.settings().material) index = static_cast<std::uint32_t>(names.size());
    names.push_back(preset.name);
  }
  if (choice(ui, "material", "Material", index, names))
    workflow_.chooseMaterial(index > 0 ? names[index] : std::string());
  const scene::MaterialPreset *preset = workflow_.material();
  if (!preset) return;
  row(ui, "Young's modulus",
      segmentation::stiffnessText(preset->youngsModulus, preset->youngsModulusMin, preset->youngsModulusMax));
  row(ui, "Poisson's ratio",
      fmt::format("{:.4g} ({:.4g} … {:.4g})", preset->poissonRatio, preset->poissonRatioMin, preset->poissonRatioMax));
  row(ui, "Density", fmt::format("{:.4g} kg/m³", preset->density));
  row(ui, "Measured", preset->evidence);
  row(ui, "Source", preset->source);
  if (!preset->note.empty()) row(ui, "Note", preset->note);
}

void SegmentationPanel::drawMaterials(const c3de_ui_v1 &ui) {
  std::vector<std::string> names{"– choose –"};
  for (const scene::MaterialPreset &preset : workflow_.materials().presets()) names.push_back(preset.name);
  for (const segmentation::SegmentationWorkflow::LabelRow &label : workflow_.labels()) {
    if (!label.isChosen) continue;
    const scene::MaterialPreset *preset = workflow_.materialOf(label.value);
    std::uint32_t index = 0;
    for (std::uint32_t i = 1; preset && i < names.size(); ++i)
      if (names[i] == preset->name) index = i;
    swatch(ui, label.colour);
    text(ui, label.name);
    const std::string id = "material." + std::to_string(label.value);
    if (choice(ui, id.c_str(), "Material", index, names))
      workflow_.chooseMaterialOf(label.value, index > 0 ? names[index] : std::string());
    bool isRigid = workflow_.isRigid(label.value);
    if (checkbox(ui, "rigid." + std::to_string(label.value), "Rigid", isRigid, kRigid))
      workflow_.setRigid(label.value, isRigid);
    if (!preset) continue;
    row(ui, "Young's modulus",
        segmentation::stiffnessText(preset->youngsModulus, preset->youngsModulusMin, preset->youngsModulusMax));
    row(ui, "ν, density",
        fmt::format("{:.4g} ({:.4g} … {:.4g}), {:.4g} kg/m³", preset->poissonRatio, preset->poissonRatioMin,
                    preset->poissonRatioMax, preset->density));
    row(ui, "Source", preset->source);
  }
}

void SegmentationPanel::drawSampling(const c3de_ui_v1 &ui) {
  segmentation::SamplingChoice s = workflow_.settings().sampling;
  checkbox(ui, "count_automatic", "Points by the thickness", s.isCountAutomatic,
           "1000, of what is thin up to 4000, so that their distance is at most half of the thickness");
  if (!s.isCountAutomatic)
    slider(ui, "points", "Points", "", s.points, kFewestPoints, kMaxPoints,
           "Approximate number; more points are more accurate and slower");
  checkbox(ui, "edge_automatic", "Edges of the surface by themselves", s.isEdgeAutomatic,
           "One and a half voxels, longer where that makes too many triangles, shorter for what is thin");
  if (!s.isEdgeAutomatic) slider(ui, "edge", "Edge length", "mm", s.edge_mm, kShortestEdge_mm, kLongestEdge_mm, "");
  workflow_.setSampling(s);
}

void SegmentationPanel::drawHolding(const c3de_ui_v1 &ui) {
  if (!workflow_.isSeveral()) {
    bool isRigid = workflow_.isRigid();
    if (checkbox(ui, "rigid", "Rigid", isRigid, kRigid)) workflow_.setRigid(isRigid);
    if (isRigid) return;
  }
  segmentation::SegmentationSettings s = workflow_.settings();
  auto held = static_cast<std::uint32_t>(s.held);
  choice(ui, "held", "Held", held, {"by its surroundings", "the lowest part", "nothing"});
  tooltip(ui, "By its surroundings: elastically at its position in the scan, to which it returns. Nothing: it drifts");
  if (static_cast<segmentation::Held>(held) == segmentation::Held::surroundings)
    slider(ui, "surroundings", "Surroundings", "Pa/m", s.surroundings_Pa_m, 0.0, kStiffestSurroundings,
           "How the tissue around pulls the surface to its place: stress per way. 30 000: an organ sinks some "
           "millimetres under "
           "its own weight; 0: not at all");
  workflow_.setHolding(static_cast<segmentation::Held>(held), s.surroundings_Pa_m);
}

}  // namespace c3de::ui
