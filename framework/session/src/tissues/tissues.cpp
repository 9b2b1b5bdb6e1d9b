// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/tissues.h"

#include <algorithm>
#include <map>
#include <utility>

#include "base/placement_matrix.h"
#include "c3de/core/log.h"
#include "c3de/core/text.h"
#include "c3de/imaging/label_names.h"
#include "c3de/imaging/reading.h"
#include "c3de/scene/material_names.h"
#include "c3de/segmentation/label_checks.h"
#include "c3de/session/body_sources.h"
#include "tissues/region_mask.h"
#include "tissues/sliding_interfaces.h"
#include "tissues/tissue_rules.h"

namespace c3de::session {
namespace {

constexpr std::size_t kMaxNames = 12;

std::string listOf(const std::vector<std::string> &names) {
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kMaxNames); ++i) text += (text.empty() ? "" : ", ") + names[i];
  return names.size() > kMaxNames ? text + " and " + std::to_string(names.size() - kMaxNames) + " more" : text;
}

/// Logs which tissues overlap where labels of several layers share voxels.
Expected<void> reportLabelOverlaps(const scene::SceneVolume &volume, const std::vector<imaging::LabelMap> &layers,
                                   const ProgressFn &progress) {
  if (layers.size() < 2) return {};
  std::vector<std::vector<std::uint16_t>> numbers;
  for (std::size_t layer = 0; layer < layers.size(); ++layer)
    numbers.push_back(tissueNumbers(volume, layers[layer], layer));
  const std::size_t background = volume.tissues.size() + 1;
  std::map<std::pair<std::size_t, std::size_t>, std::size_t>
      counts;  // per pair: the tissue that counts, the one hidden
  const std::size_t voxels = layers.front().voxels.size(), slice = std::max<std::size_t>(voxels / 64, 1);
  for (std::size_t v = 0; v < voxels; ++v) {
    if (v % slice == 0 && progress &&
        !progress(static_cast<double>(v) / static_cast<double>(voxels), "finding what overlaps"))
      return fail(ErrorCode::cancelled, "cancelled");
    std::size_t top = 0;
    for (std::size_t layer = layers.size(); layer-- > 0;) {
      if (layers[layer].voxels.size() != voxels || layers[layer].voxels[v] == 0) continue;
      const std::size_t tissue = numbers[layer][layers[layer].voxels[v]];
      if (tissue == 0 || tissue == background) continue;
      if (top == 0)
        top = tissue;
      else if (tissue != top)
        ++counts[{top, tissue}];
    }
  }
  if (counts.empty()) return {};
  std::vector<std::string> all;
  for (const auto &[pair, count] : counts)
    all.push_back(volume.tissues[pair.first - 1].label + " over " + volume.tissues[pair.second - 1].label + " (" +
                  std::to_string(count) + " voxels)");
  log(LogLevel::warn, volume.file.string() + ": tissues overlap, and the later layer counts: " + listOf(all));
  return {};
}

/// A label of the map, and whether it is assigned to a tissue.
struct Candidate {
  scene::SceneLabel label;
  bool isAssigned = false;
};

std::vector<Candidate> candidatesOf(const std::vector<imaging::LabelMap> &layers) {
  std::vector<Candidate> all;
  for (std::size_t layer = 0; layer < layers.size(); ++layer)
    for (const imaging::LabelMap::Label &label : layers[layer].labels)
      all.push_back({{layer, label.value, label.name}, false});
  return all;
}

std::string listOf(const std::vector<Candidate> &labels) {
  std::vector<std::string> names;
  for (const Candidate &one : labels) names.push_back(one.label.name);
  return names.empty() ? "none, all its voxels are 0" : listOf(names);
}

std::string noLabel(const std::string &file, const std::string &wanted, const std::vector<Candidate> &labels) {
  std::vector<std::string> names;
  for (const Candidate &one : labels) names.push_back(one.label.name);
  const std::string nearest = nearestName(wanted, names);
  return file + " has no label '" + wanted + "'; " + (nearest.empty() ? "" : "did you mean '" + nearest + "'? ") +
         "there are: " + listOf(labels);
}

/// Assigns a tissue of the scene its labels, and its properties where it is specified only by name.
Expected<void> assignLabels(scene::SceneTissue &tissue, std::vector<Candidate> &labels,
                            const scene::MaterialLibrary &materials, const std::string &file) {
  const auto matchesLabel = [](const std::string &wanted, const Candidate &one) {
    return imaging::matchesLabel(wanted, {one.label.value, one.label.name, {}});
  };
  for (const std::string &wanted : tissue.wanted) {
    if (std::any_of(labels.begin(), labels.end(), [&](const Candidate &one) { return matchesLabel(wanted, one); }))
      continue;
    return fail(ErrorCode::input, noLabel(file, wanted, labels));
  }
  for (Candidate &one : labels) {
    const bool isOfIt = std::any_of(tissue.wanted.begin(), tissue.wanted.end(),
                                    [&](const std::string &wanted) { return matchesLabel(wanted, one); });
    if (isOfIt && !std::exchange(one.isAssigned, true)) tissue.labels.push_back(one.label);
  }
  if (tissue.labels.empty())
    return fail(ErrorCode::input, "the labels of tissue '" + tissue.label +
                                      "' belong to earlier tissues, to the first that names them; accepted: each label "
                                      "in one tissue, single names before those with '*'");
  if (!tissue.isMaterialByName) return {};
  const auto first = scene::tissueOf(materials, tissue.labels.front().name);
  for (const scene::SceneLabel &label : tissue.labels) {
    const auto named = scene::tissueOf(materials, label.name);
    if (!named) return fail(ErrorCode::input, scene::unknownTissue(label.name));
    if (named->name != first->name)
      return fail(ErrorCode::input, "the labels of tissue '" + tissue.label + "' are known as different tissues: " +
                                        tissue.labels.front().name + " as " + std::string(first->name) + ", " +
                                        label.name + " as " + std::string(named->name) +
                                        "; accepted: an entry for each before it, a material, or tissues = \"known\"");
  }
  (void)scene::setMaterialFromName(tissue, tissue.labels.front().name, materials);
  if (tissue.wanted.size() > 1) tissue.label = first->name;
  return {};
}

/// One tissue for each known tissue name among the labels, in the order of the map.
Expected<std::vector<scene::SceneTissue>> knownTissues(std::vector<Candidate> &labels,
                                                       const scene::MaterialLibrary &materials, int line,
                                                       const std::string &file) {
  std::vector<scene::SceneTissue> tissues;
  for (Candidate &one : labels) {
    const auto named = scene::tissueOf(materials, one.label.name);
    if (!named) continue;
    one.isAssigned = true;
    auto found = std::find_if(tissues.begin(), tissues.end(),
                              [&](const scene::SceneTissue &tissue) { return tissue.label == named->name; });
    if (found == tissues.end()) {
      scene::SceneTissue tissue;
      tissue.label = named->name;
      tissue.line = line;
      (void)scene::setMaterialFromName(tissue, one.label.name, materials);
      found = tissues.insert(tissues.end(), std::move(tissue));
    }
    found->labels.push_back(one.label);
  }
  if (tissues.empty())
    return fail(ErrorCode::input,
                "no label of " + file + " is known by its name; there are: " + listOf(labels) +
                    "; accepted: a map with names such as liver, kidney_left, vertebrae_L1, or a list "
                    "such as tissues = [ { label = 1, material = \"liver\" } ]");
  return tissues;
}

/// Warns how labels without a tissue are treated.
void warnUnassigned(const scene::SceneVolume &volume, const std::vector<Candidate> &labels) {
  std::vector<std::string> names;
  for (const Candidate &one : labels)
    if (!one.isAssigned) names.push_back(one.label.name);
  if (names.empty()) return;
  log(LogLevel::warn,
      volume.file.string() + ": " + std::to_string(names.size()) + (names.size() == 1 ? " label is" : " labels are") +
          " of no " + (volume.usesKnownTissues ? "known tissue" : "tissue") + " and " +
          (volume.background ? "treated as background" : "left out, as there is no background") + ": " + listOf(names));
}

/// Assigns the sliding entries their labels.
Expected<void> assignSlidingLabels(scene::SceneVolume &volume, const std::vector<Candidate> &labels) {
  std::vector<bool> isAssigned(labels.size(), false);
  for (scene::SceneSlidingPart &slide : volume.slides)
    for (const std::string &wanted : slide.names) {
      std::size_t matched = 0, alreadyAssigned = 0;
      for (std::size_t i = 0; i < labels.size(); ++i) {
        const scene::SceneLabel &label = labels[i].label;
        if (!imaging::matchesLabel(wanted, {label.value, label.name, {}})) continue;
        ++matched;
        const auto has = [&](const scene::SceneTissue &tissue) {
          return std::any_of(tissue.labels.begin(), tissue.labels.end(), [&](const scene::SceneLabel &other) {
            return other.layer == label.layer && other.value == label.value;
          });
        };
        const auto tissue = std::find_if(volume.tissues.begin(), volume.tissues.end(), has);
        const bool isOfNone = tissue == volume.tissues.end() || tissue->isEmpty;
        if (isOfNone ? !volume.background : tissue->isRigid)
          return fail(ErrorCode::input, "slides: label '" + label.name + "' " +
                                            (isOfNone ? "is not of the body" : "is rigid and does not move") +
                                            "; accepted: labels of a tissue with a material");
        if (isAssigned[i]) {
          ++alreadyAssigned;
          continue;
        }
        isAssigned[i] = true;
        slide.labels.push_back(label);
      }
      if (matched == 0) return fail(ErrorCode::input, "slides: " + noLabel(volume.file.string(), wanted, labels));
      if (alreadyAssigned == matched)
        return fail(ErrorCode::input, "slides: the labels of '" + wanted +
                                          "' are of names before it; accepted: single names before those with '*'");
    }
  return {};
}

Expected<void> resolveTissue(const scene::SceneFile &scene, scene::SceneBody &body,
                             const std::vector<imaging::LabelMap> &layers, const scene::MaterialLibrary &materials,
                             BodySources &sources, const ProgressFn &progress) {
  scene::SceneVolume &volume = body.volume;
  const std::string file = volume.file.string();
  const bool wasOpen = volume.isOpen();
  std::vector<Candidate> labels = candidatesOf(layers);
  if (volume.usesKnownTissues) {
    auto tissues = knownTissues(labels, materials, body.line, file);
    if (!tissues) return failInScene(tissues.error(), scene, body.line);
    volume.tissues = std::move(*tissues);
  } else {
    for (scene::SceneTissue &tissue : volume.tissues)
      if (tissue.rule) {
        if (tissue.isMaterialByName) (void)scene::setMaterialFromName(tissue, tissue.label, materials);
      } else if (auto assigned = assignLabels(tissue, labels, materials, file); !assigned) {
        return failInScene(assigned.error(), scene, tissue.line);
      }
  }
  warnUnassigned(volume, labels);
  if (auto reported = reportLabelOverlaps(volume, layers, progress); !reported) return reported;
  if (std::any_of(volume.tissues.begin(), volume.tissues.end(), [](const auto &tissue) { return tissue.rule; })) {
    if (auto applied = applyRules(scene, body, layers, sources, progress); !applied) return applied;
    for (const scene::SceneTissue &tissue : volume.tissues)
      if (tissue.rule) labels.push_back({tissue.labels.front(), true});
  }
  if (auto assigned = assignSlidingLabels(volume, labels); !assigned)
    return failInScene(assigned.error(), scene, body.line);
  volume.isSettled = true;
  if (!wasOpen) return {};
  if (auto made = makeTissueParts(body); !made) return failInScene(made.error(), scene, body.line);
  return {};
}

/// Adds notices where grey values contradict the labels. The image is that of the background, otherwise that of the
/// scene.
Expected<void> checkAgainstImage(const scene::SceneFile &scene, const scene::SceneBody &body,
                                 const std::vector<imaging::LabelMap> &layers, BodySources &sources,
                                 const ProgressFn &progress) {
  const scene::SceneVolume &volume = body.volume;
  if (layers.empty() || (!volume.background && !scene.image)) return {};
  const std::filesystem::path file = volume.background ? volume.background->image : scene.image->file;
  imaging::ReadOptions options;
  options.progress = progress;
  options.series = volume.background ? volume.background->series : scene.image->series;
  options.time = volume.background ? volume.background->time : scene.image->time;
  const auto image = sources.volume(file, options);
  if (!image) return failInScene(image.error(), scene, volume.background ? body.line : scene.image->line);
  sources.reportNotices(file);
  segmentation::LabelCheck check;
  check.image = image->get();
  for (std::size_t layer = 0; layer < layers.size(); ++layer) {
    check.layers.push_back(&layers[layer]);
    std::vector<segmentation::LabelRole> &roles = check.roles.emplace_back();
    for (const imaging::LabelMap::Label &label : layers[layer].labels) {
      const auto tissue = std::find_if(volume.tissues.begin(), volume.tissues.end(), [&](const auto &one) {
        return std::any_of(one.labels.begin(), one.labels.end(), [&](const scene::SceneLabel &other) {
          return other.layer == layer && other.value == label.value;
        });
      });
      roles.push_back(tissue == volume.tissues.end() ? segmentation::LabelRole::background
                      : tissue->isEmpty              ? segmentation::LabelRole::empty
                      : tissue->isRigid              ? segmentation::LabelRole::rigid
                                                     : segmentation::LabelRole::soft);
    }
  }
  // Rules select from unlabelled voxels, and what they leave is not known here.
  const bool hasRules =
      std::any_of(volume.tissues.begin(), volume.tissues.end(), [](const auto &tissue) { return tissue.rule; });
  if (volume.background && !hasRules) check.background = {volume.background->from, volume.background->to, "background"};
  imaging::Mask region;
  if (volume.region) {
    region = {layers.front().geometry, std::vector<std::uint8_t>(layers.front().voxels.size(), 1)};
    keepWithin(*volume.region, region);
    check.region = &region;
  }
  const auto findings = segmentation::checkLabels(check, progress);
  if (!findings) return failInScene(findings.error(), scene, body.line);
  for (const segmentation::LabelFinding &finding : *findings)
    sources.addNotice("body '" + body.name + "': " + finding.text + "; accepted: " + finding.advice + ".");
  return {};
}

bool areSame(const scene::ScenePlacement &a, const scene::ScenePlacement &b) {
  const Mat4 x = matrixOf(a), y = matrixOf(b);
  return x == y;
}

/// Warns of bodies that share labels at the same location: contact would press them apart.
void reportSharedLabels(const scene::SceneFile &scene) {
  for (std::size_t b = 1; b < scene.bodies.size(); ++b)
    for (std::size_t a = 0; a < b; ++a) {
      const scene::SceneBody &one = scene.bodies[a], &other = scene.bodies[b];
      if (!one.volume.isSettled || !other.volume.isSettled || one.volume.cut || other.volume.cut) continue;
      if (one.volume.file != other.volume.file || one.volume.series != other.volume.series ||
          one.volume.time != other.volume.time || one.volume.region || other.volume.region ||
          !areSame(one.placement, other.placement))
        continue;
      std::vector<std::string> names;
      for (const scene::SceneTissue &tissue : one.volume.tissues)
        for (const scene::SceneLabel &label : tissue.labels)
          for (const scene::SceneTissue &otherTissue : other.volume.tissues)
            if (!tissue.isEmpty && !otherTissue.isEmpty &&
                std::any_of(otherTissue.labels.begin(), otherTissue.labels.end(), [&](const scene::SceneLabel &same) {
                  return same.layer == label.layer && same.value == label.value;
                }))
              names.push_back(label.name);
      if (one.volume.background && other.volume.background) names.emplace_back("background");
      if (!names.empty())
        log(LogLevel::warn, scene.where(other.line) + ": '" + one.name + "' and '" + other.name +
                                "' lie in the same voxels and press each other apart, both have: " + listOf(names));
    }
}

}  // namespace

Expected<void> resolveTissues(scene::SceneFile &scene, const scene::MaterialLibrary &materials, BodySources &sources,
                              const ProgressFn &progress, Preparation &preparation) {
  std::vector<std::string> overrides;
  for (scene::SceneBody &body : scene.bodies) {
    if (!body.volume.hasTissues() || body.volume.isSettled) continue;
    imaging::ReadOptions options;
    options.progress = progress;
    options.series = body.volume.series;
    options.time = body.volume.time;
    const ScopedTimer reading(preparation.reading_s);
    std::shared_ptr<const BodySources::Layers> layers = std::make_shared<BodySources::Layers>();
    if (body.volume.usesLabels()) {
      const auto read = sources.labels(body.volume.file, options);
      if (!read) return failInScene(read.error(), scene, body.line);
      layers = *read;
    }
    sources.reportNotices(body.volume.file);
    if (auto resolved = resolveTissue(scene, body, *layers, materials, sources, progress); !resolved) return resolved;
    if (auto checked = checkAgainstImage(scene, body, *layers, sources, progress); !checked) return checked;
    sources.reportNotices(body.volume.file);
    const std::vector<std::string> overridesOfBody = std::exchange(body.volume.overridesOfParts, {});
    overrides.insert(overrides.end(), overridesOfBody.begin(), overridesOfBody.end());
  }
  reportSharedLabels(scene);
  for (const std::string &assignment : overrides)
    if (auto applied = scene::applyOverride(scene, assignment, &materials); !applied) return applied;
  return cutSlidingParts(scene, sources, progress, preparation);
}

}  // namespace c3de::session
