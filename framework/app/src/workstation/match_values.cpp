// SPDX-License-Identifier: Apache-2.0
#include "workstation/match_values.h"

#include <algorithm>
#include <utility>

#include "c3de/core/file_path.h"
#include "c3de/core/path_text.h"
#include "c3de/core/text.h"

namespace c3de::app {
namespace {

constexpr std::pair<ui::MatchSource, const char *> kSources[] = {{ui::MatchSource::points, "points"},
                                                                 {ui::MatchSource::surface, "surface"},
                                                                 {ui::MatchSource::labels, "labels"},
                                                                 {ui::MatchSource::stream, "stream"}};

std::string savedPath(const std::filesystem::path &file) {
  std::error_code failed;
  const std::string text = file.empty() ? std::string() : pathText(absolutePath(file, failed));
  return isUtf8(text) ? text : std::string();
}

std::filesystem::path foundPath(const std::string &text, const std::filesystem::path &folder) {
  const std::filesystem::path file = pathFromText(text), beside = folder / file.filename();
  std::error_code failed;
  const bool isBeside =
      !text.empty() && !std::filesystem::exists(file, failed) && std::filesystem::exists(beside, failed);
  return isBeside ? beside : file;
}

SavedMatch withoutBody(const ui::MatchForm &form) {
  SavedMatch out = savedOf(form);
  out.body.clear();
  return out;
}

}  // namespace

void MatchValues::assign(ui::MatchForm values) {
  form = std::move(values);
  areSet_ = true;
  last_ = withoutBody(form);
  ++assignments_;
}

void MatchValues::clear() {
  form = {};
  areSet_ = false;
  ++assignments_;
}

void MatchValues::countChanges() {
  SavedMatch now = withoutBody(form);
  if (now == last_) return;
  last_ = std::move(now);
  ++revision_;
}

SavedMatch savedOf(const ui::MatchForm &form) {
  const scene::SceneMatch &wanted = form.wanted;
  SavedMatch out;
  out.body = wanted.body;
  out.points = savedPath(wanted.points);
  out.surface = savedPath(wanted.surface);
  out.labels = savedPath(wanted.labels.file);
  out.time = wanted.labels.time;
  out.landmarks = savedPath(wanted.landmarks);
  out.label = form.label;
  out.server = form.server;
  out.tool = form.tool;
  out.toolPoints = form.toolPoints;
  for (const auto &[source, name] : kSources)
    if (form.source == source) out.source = name;
  if (wanted.unit) out.unit = geometry::unitName(*wanted.unit);
  out.noise_mm = wanted.noise_mm;
  out.landmarkWeight = wanted.landmarkWeight;
  out.fitsLandmarks = wanted.fitsLandmarks;
  out.isRigidFirst = wanted.isRigidFirst;
  out.deforms = wanted.deforms;
  return out;
}

ui::MatchForm formOf(const SavedMatch &saved, const std::filesystem::path &folder) {
  ui::MatchForm out;
  scene::SceneMatch &wanted = out.wanted;
  wanted.body = saved.body;
  wanted.points = foundPath(saved.points, folder);
  wanted.surface = foundPath(saved.surface, folder);
  wanted.labels.file = foundPath(saved.labels, folder);
  wanted.labels.time = static_cast<std::size_t>(saved.time);
  wanted.landmarks = foundPath(saved.landmarks, folder);
  out.label = saved.label;
  if (!saved.server.empty()) out.server = saved.server;
  out.tool = saved.tool;
  out.toolPoints = static_cast<std::uint32_t>(
      std::clamp<std::uint64_t>(saved.toolPoints, ui::MatchForm::kFewestToolPoints, ui::MatchForm::kMostToolPoints));
  for (const auto &[source, name] : kSources)
    if (saved.source == name) out.source = source;
  if (!saved.unit.empty())
    if (const auto unit = scene::parseLengthUnit(saved.unit)) wanted.unit = *unit;
  wanted.noise_mm = saved.noise_mm;
  wanted.landmarkWeight = saved.landmarkWeight;
  wanted.fitsLandmarks = saved.fitsLandmarks;
  wanted.isRigidFirst = saved.isRigidFirst;
  wanted.deforms = saved.deforms;
  return out;
}

}  // namespace c3de::app
