// SPDX-License-Identifier: Apache-2.0
#include "c3de/segmentation/scan_body.h"
#include "c3de/core/file_path.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "c3de/core/path_text.h"
#include "c3de/core/text.h"
#include "c3de/imaging/warp_grid.h"
#include "c3de/scene/material_names.h"
#include "label_volumes.h"

namespace c3de::segmentation {
namespace {

// Range of soft tissue in CT; excludes unlabelled bone.
constexpr double kFrom_HU = -150.0, kTo_HU = 250.0;
constexpr double kGravity_m_s2 = 9.81;

/// LPS: left, posterior and superior increase.
const char *directionOf(Posture posture) {
  switch (posture) {
    case Posture::supine: return "[0, {}, 0]";
    case Posture::prone: return "[0, -{}, 0]";
    case Posture::leftSide: return "[{}, 0, 0]";
    case Posture::rightSide: return "[-{}, 0, 0]";
    case Posture::upright: break;
  }
  return "[0, 0, -{}]";
}

/// A basic string of TOML.
std::string quoted(const std::string &text) {
  std::string out = "\"";
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\')
      out += std::string("\\") + c;
    else if (code < 0x20 || code == 0x7f)
      out += fmt::format("\\u{:04x}", static_cast<unsigned>(code));
    else
      out += c;
  }
  return out + '"';
}

std::string fileText(const std::filesystem::path &file, const std::filesystem::path &folder) {
  const std::filesystem::path whole = normalPath(absolutePath(file)), from = normalPath(absolutePath(folder));
  const std::filesystem::path there = folder.empty() ? whole : relativePath(whole, from);
  const bool isBelow = !there.empty() && *there.begin() != "..";
  return quoted(pathText(isBelow ? there : whole));
}

imaging::Mask boxOnGrid(const imaging::VolumeGeometry &grid, const std::array<Vec3, 2> &box) {
  imaging::Mask out{grid, std::vector<std::uint8_t>(grid.voxelCount(), 0)};
  std::size_t v = 0;
  for (std::size_t k = 0; k < grid.size[2]; ++k)
    for (std::size_t j = 0; j < grid.size[1]; ++j)
      for (std::size_t i = 0; i < grid.size[0]; ++i, ++v) {
        const Vec3 at = grid.worldAt({static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
        bool isInside = true;
        for (std::size_t a = 0; a < 3; ++a) isInside = isInside && at[a] >= box[0][a] && at[a] <= box[1][a];
        out.voxels[v] = isInside ? 1 : 0;
      }
  return out;
}

LabelUse useOf(const scene::NamedTissue &tissue) {
  if (tissue.isEmpty()) return {LabelUse::Kind::air, {}};
  if (tissue.isRigid()) return {LabelUse::Kind::rigid, {}};
  return {LabelUse::Kind::material, tissue.preset->name};
}

}  // namespace

ScanBody::ScanBody(BackgroundJobs &jobs, std::string jobOwner, const scene::MaterialLibrary &materials,
                   std::function<void(const std::string &)> make)
    : jobs_(jobs), jobOwner_(std::move(jobOwner)), materials_(materials), make_(std::move(make)),
      alive_(std::make_shared<bool>(true)) {}

ScanBody::~ScanBody() { *alive_ = false; }

void ScanBody::setSources(Sources sources) {
  const bool isSameScan = sources.imageFile == sources_.imageFile && sources.series == sources_.series &&
                          (sources.image != nullptr) == (sources_.image != nullptr);
  const bool areSameLabels = sources.layers == sources_.layers;
  sources_ = std::move(sources);
  if (!isPossible()) isShown_ = isAside_ = false;
  if (!isSameScan || !areSameLabels) {
    problem_.clear();
    undo_.clear();
    isOfEarlierScan_ = isMaking_;
  }
  if (!isSameScan) {
    settings_ = {};
    unit_.clear();
    if (sources_.image) {
      settings_.hasBackground = imaging::isLikelyHounsfield(sources_.image->volume);
      unit_ = sources_.image->volume.unit.empty() && settings_.hasBackground ? "HU" : sources_.image->volume.unit;
      settings_.largestOnly = settings_.hasBackground;  // organs without background are not connected
      settings_.from = settings_.hasBackground ? kFrom_HU : sources_.image->range.low;
      settings_.to = settings_.hasBackground ? kTo_HU : sources_.image->range.high;
    }
  }
  if (!isSameScan || !areSameLabels) {
    if (!checking_.isNull()) jobs_.cancel(std::exchange(checking_, {}));
    ++checkSerial_;
    findings_.clear();
    checked_.clear();
  }
  if (areSameLabels) return;
  if (!counting_.isNull()) jobs_.cancel(std::exchange(counting_, {}));
  ++serial_;
  isCounted_ = false;
  rows_.clear();
  byName_.clear();
  numbers_.clear();
  for (const auto &layer : sources_.layers)
    for (const imaging::LabelMap::Label &label : layer->map.labels) {
      Row row;
      row.name = label.name.empty() ? "label " + std::to_string(label.value) : label.name;
      row.colour = render::displayColour(label.colour);
      if (const auto tissue = scene::tissueOf(materials_, label.name)) {
        row.known = tissue->name;
        row.remark = tissue->remark;
        row.isAir = tissue->isEmpty();
        row.use = useOf(*tissue);
      }
      row.material = materials_.find(row.use.preset);
      byName_.push_back(row.use);
      numbers_.push_back(label.value);
      rows_.push_back(std::move(row));
    }
}

void ScanBody::show(bool isShown) {
  isShown_ = isShown && isPossible();
  isAside_ = false;
  if (isShown_ && !isCounted_ && counting_.isNull()) count();
  check();
}

void ScanBody::check() {
  if (!isShown_ || !isCounted_) return;
  std::string choices = settings_.hasBackground
                            ? fmt::format("{} {} {}", settings_.from, settings_.to, settings_.background)
                            : std::string("no background");
  if (settings_.region)
    for (const Vec3 &corner : *settings_.region) choices += fmt::format(" {} {} {}", corner[0], corner[1], corner[2]);
  std::vector<LabelRole> roles;
  for (const Row &row : rows_) {
    roles.push_back(row.use.kind == LabelUse::Kind::none    ? LabelRole::background
                    : row.use.kind == LabelUse::Kind::air   ? LabelRole::empty
                    : row.use.kind == LabelUse::Kind::rigid ? LabelRole::rigid
                                                            : LabelRole::soft);
    choices += static_cast<char>('a' + static_cast<int>(roles.back()));
  }
  if (choices == checked_) return;
  checked_ = choices;
  if (!checking_.isNull()) jobs_.cancel(std::exchange(checking_, {}));
  const auto found = std::make_shared<std::vector<LabelFinding>>();
  checking_ = jobs_.submit(
      jobOwner_, "Checking labels",
      [sources = sources_, settings = settings_, roles, found](const ProgressFn &progress) -> Expected<void> {
        LabelCheck wanted;
        auto next = roles.begin();
        for (const auto &layer : sources.layers) {
          wanted.layers.push_back(&layer->map);
          const auto count = static_cast<std::ptrdiff_t>(layer->map.labels.size());
          wanted.roles.emplace_back(next, next + count);
          next += count;
        }
        wanted.image = &sources.image->volume;
        if (settings.hasBackground) wanted.background = {settings.from, settings.to, settings.background};
        imaging::Mask region;
        if (settings.region) {
          region = boxOnGrid(wanted.layers.front()->geometry, *settings.region);
          wanted.region = &region;
        }
        auto findings = checkLabels(wanted, progress);
        if (!findings) return tl::unexpected(findings.error());
        *found = std::move(*findings);
        return {};
      },
      [this, alive = alive_, serial = ++checkSerial_, found](const Expected<void> &done) {
        if (!*alive || serial != checkSerial_) return;
        checking_ = {};
        if (done) findings_ = std::move(*found);
      });
}

void ScanBody::count() {
  const auto volumes = std::make_shared<std::vector<double>>();
  counting_ = jobs_.submit(
      jobOwner_, "Measuring labels",
      [layers = sources_.layers, volumes](const ProgressFn &progress) -> Expected<void> {
        for (const auto &layer : layers) {
          auto counted = volumesOf(layer->map, progress);
          if (!counted) return tl::unexpected(counted.error());
          volumes->insert(volumes->end(), counted->begin(), counted->end());
        }
        return {};
      },
      [this, alive = alive_, serial = serial_, volumes](const Expected<void> &done) {
        if (!*alive || serial != serial_) return;
        counting_ = {};
        isCounted_ = done.has_value();
        for (std::size_t i = 0; isCounted_ && i < rows_.size(); ++i) rows_[i].volume_ml = (*volumes)[i];
        check();
      });
}

void ScanBody::take(Row &row, const LabelUse &use) const {
  row.material = use.kind == LabelUse::Kind::material ? materials_.find(use.preset) : nullptr;
  row.use = use;
}

void ScanBody::keepStep() {
  Step step;
  for (const Row &row : rows_) step.uses.push_back(row.use);
  step.region = settings_.region;
  undo_.push_back(std::move(step));
  isTyped_ = false;
}

void ScanBody::setUse(const std::vector<std::size_t> &rows, const LabelUse &use) {
  keepStep();
  for (const std::size_t row : rows)
    if (row < rows_.size()) take(rows_[row], use);
  check();
}

void ScanBody::setRegion(const std::optional<std::array<Vec3, 2>> &region) {
  if (region == settings_.region) return;
  keepStep();
  settings_.region = region;
  check();
}

void ScanBody::setSettings(const ScanBodySettings &settings) {
  const bool isTyped = settings.region && settings_.region;
  if (settings.region != settings_.region && !(isTyped && isTyped_)) {
    keepStep();
    isTyped_ = isTyped;
  }
  settings_ = settings;
  check();
}

void ScanBody::undo() {
  if (undo_.empty()) return;
  const Step &step = undo_.back();
  for (std::size_t i = 0; i < rows_.size(); ++i) take(rows_[i], step.uses[i]);
  settings_.region = step.region;
  undo_.pop_back();
  isTyped_ = false;
  check();
}

std::array<Vec3, 2> ScanBody::extent_mm() const {
  if (sources_.layers.empty()) return {};
  const imaging::WorldBox box = imaging::boxOf(sources_.layers.front()->map.geometry);
  return {box.low, box.high};
}

std::string ScanBody::blockingReason() const {
  std::string reason = sceneReason();
  return reason.empty() && isMaking_ ? "a body is being made" : reason;
}

std::string ScanBody::sceneReason() const {
  if (!sources_.image) return "no image is open";
  if (sources_.layers.empty()) return "there is no label map for the image";
  if (!isCounted_) return counting_.isNull() ? "the labels have not been measured" : "the labels are being measured";
  if (std::all_of(rows_.begin(), rows_.end(), [](const Row &row) {
        return row.use.kind == LabelUse::Kind::none || row.volume_ml.value_or(0.0) <= 0.0;
      }))
    return "no label is known by its name; choose a material for one, or that it is rigid";
  if (settings_.hasBackground) {
    if (!(settings_.from <= settings_.to))
      return "the background reaches from " + formatNumber(settings_.from) + " to " + formatNumber(settings_.to) +
             ": from has to be below to";
  } else if (std::none_of(rows_.begin(), rows_.end(), [](const Row &row) {
               return row.use.kind == LabelUse::Kind::material && row.volume_ml.value_or(0.0) > 0.0;
             })) {
    return "nothing could move: all labels are rigid, air or left out; choose a material for one, or take a background";
  }
  if (settings_.region)
    for (std::size_t a = 0; a < 3; ++a)
      if (!((*settings_.region)[0][a] < (*settings_.region)[1][a]))
        return fmt::format("the region reaches from {} to {} mm along {}: from has to be below to",
                           formatNumber((*settings_.region)[0][a]), formatNumber((*settings_.region)[1][a]), "xyz"[a]);
  return {};
}

/// By name if it denotes this label alone, otherwise by number.
std::string ScanBody::labelText(std::size_t row) const {
  const std::string &name = rows_[row].name;
  const bool isOne = std::count_if(rows_.begin(), rows_.end(), [&](const Row &r) { return r.name == name; }) == 1;
  const bool isName = name.find('*') == std::string::npos && name.find_first_not_of("0123456789") != std::string::npos;
  // The default name of an unnamed label exists only here.
  const bool hasName = name != "label " + std::to_string(numbers_[row]);
  return isOne && isName && hasName ? quoted(name) : std::to_string(numbers_[row]);
}

std::string ScanBody::sceneText(const std::filesystem::path &folder) const {
  const std::string image = fileText(sources_.imageFile, folder), labels = fileText(sources_.labelFile, folder);
  const std::string series = sources_.series.empty() ? "" : quoted(sources_.series);
  const std::size_t time = sources_.image ? sources_.image->time : 0;
  std::string text = "format = 1\ntitle = " + quoted(sources_.image ? sources_.image->name + ", simulated" : "scan") +
                     "\n\n[image]\n" + "file = " + image + "\n" + (series.empty() ? "" : "series = " + series + "\n") +
                     (time > 0 ? "time = " + std::to_string(time) + "\n" : "") + "labels = " + labels + "\n\n";
  if (settings_.hasGravity) {
    const std::string gravity = fmt::format(fmt::runtime(directionOf(settings_.posture)), kGravity_m_s2);
    text += "[world]\ngravity = " + gravity + "\nscan_gravity = " + gravity + "\n\n";
  }
  // The 3D view should show the tissues.
  text += "[view]\nsurface = \"transparent\"\npoints = \"none\"\n\n";
  text += "[solver]\ndamping = 2.0\n\n[[body]]\nname = \"scan\"\nvolume = " + labels + "\n";

  // One entry for labels with the same tissue name, or with the same choice.
  std::vector<std::pair<std::string, std::string>> entries;  // key, and its labels
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const Row &row = rows_[i];
    if (row.use.kind == LabelUse::Kind::none || row.volume_ml == 0.0) continue;
    const bool isMaterialByName = row.use == byName_[i];
    const std::string key = isMaterialByName                        ? row.known
                            : row.use.kind == LabelUse::Kind::rigid ? std::string(", rigid = true")
                                                                    : ", material = " + quoted(row.use.preset);
    auto entry = std::find_if(entries.begin(), entries.end(), [&](const auto &one) { return one.first == key; });
    if (entry == entries.end()) entry = entries.insert(entries.end(), {key, ""});
    entry->second += (entry->second.empty() ? "" : ", ") + labelText(i);
  }
  text += "tissues = [\n";
  for (const auto &[key, names] : entries)
    text += "  { label = [" + names + "]" + (key.front() == ',' ? key : "") + " }," +
            (key.front() == ',' ? "" : "  # " + key) + "\n";
  text += "]\n";
  if (settings_.hasBackground)
    text += "background = { material = " + quoted(settings_.background) + ", image = " + image +
            (series.empty() ? "" : ", series = " + series) + (time > 0 ? ", time = " + std::to_string(time) : "") +
            ", from = " + formatNumber(settings_.from) + ", to = " + formatNumber(settings_.to) + " }\n";
  if (settings_.region) {
    const auto corner = [&](std::size_t c) {
      const Vec3 &at = (*settings_.region)[c];
      return "[" + formatNumber(1e-3 * at[0]) + ", " + formatNumber(1e-3 * at[1]) + ", " + formatNumber(1e-3 * at[2]) +
             "]";
    };
    text += "region = { box = { min = " + corner(0) + ", max = " + corner(1) + " } }\n";
  }
  if (settings_.largestOnly) text += "mend = { largest = true }\n";
  return text + "sampling = { count = " + formatNumber(settings_.points) + " }\n";
}

void ScanBody::make() {
  if (!blockingReason().empty()) return;
  problem_.clear();
  isMaking_ = true;
  isOfEarlierScan_ = false;
  isShown_ = false;
  make_(sceneText());
}

bool ScanBody::finished(const Expected<void> &result) {
  isMaking_ = false;
  if (result || result.error().code == ErrorCode::cancelled || isOfEarlierScan_ || !isPossible()) return false;
  problem_ = result.error().message;
  if (!isShown_) show(true);
  return true;
}

}  // namespace c3de::segmentation
