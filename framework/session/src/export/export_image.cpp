// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/export_image.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <limits>
#include <string_view>

#include "c3de/core/output_file.h"
#include "c3de/core/path_text.h"
#include "c3de/core/text.h"
#include "c3de/imaging/masks.h"
#include "c3de/imaging/reading.h"
#include "c3de/imaging/warp.h"
#include "c3de/imaging/writing.h"
#include "c3de/session/body_displacement.h"
#include "c3de/session/body_sources.h"
#include "c3de/session/fixed_region_rule.h"

namespace c3de::session {
namespace {

/// Around all bodies in their present positions, within the extent of the image: nothing is written elsewhere.
imaging::VolumeGeometry gridOf(const PresentBodies &bodies, const imaging::VolumeGeometry &image, double rim_mm) {
  // A file has no frame deadline: the grid is finer than the live one, and everything in the image is warped.
  imaging::FollowingGrid grid({.mostPoints = 144, .coarsestStep = std::numeric_limits<double>::infinity()});
  imaging::WorldBox box = bodies.box;
  box.cutTo(imaging::boxOf(image).grown(rim_mm + bodies.spacing_mm));
  grid.follow(box.isEmpty() ? bodies.box : box, bodies.spacing_mm, rim_mm);
  return grid.geometry();
}

/// a.nii.gz -> a-vacated.nii.gz
std::filesystem::path withSuffix(const std::filesystem::path &file, const std::string &suffix) {
  std::filesystem::path ending = file.extension(), stem = file.stem();
  if (ending == ".gz") ending = stem.extension().native() + ending.native(), stem = stem.stem();
  stem += suffix;
  stem += ending;
  return file.parent_path() / stem;
}

bool isSameFile(const std::filesystem::path &a, const std::filesystem::path &b) {
  std::error_code code;
  return a == b || std::filesystem::equivalent(a, b, code);
}

/// Whether a body is made from labels of its volume.
bool isOfLabels(const scene::SceneBody &body) {
  const scene::SceneVolume &volume = body.volume;
  return !volume.file.empty() && !volume.threshold &&
         (volume.hasTissues() ? volume.usesLabels() : volume.label || !volume.labelName.empty());
}

}  // namespace

Expected<void> checkImageFile(const std::filesystem::path &file) {
  std::string name = file.filename().string();
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const auto endsWith = [&](std::string_view end) {
    return name.size() > end.size() && name.compare(name.size() - end.size(), end.size(), end) == 0;
  };
  if (!endsWith(".nrrd") && !endsWith(".nii") && !endsWith(".nii.gz") && !endsWith(".mha"))
    return fail(ErrorCode::usage, file.string() + ": accepted: .nrrd, .nii, .nii.gz, .mha");
  return checkOutputs({&file, 1}, {});
}

Expected<void> checkImageExport(const ImageExport &wanted, const scene::SceneFile &scene) {
  if (!wanted.isWanted()) return {};
  if (!scene.image)
    return fail(
        ErrorCode::usage,
        "--export-image, --export-labels and --export-displacement need a scene with an [image], whose grid they "
        "take; " +
            scene.where(1) + " has none");
  if (!wanted.image.empty())
    if (auto good = checkImageFile(wanted.image); !good) return good;
  if (!wanted.labels.empty()) {
    if (auto good = checkImageFile(wanted.labels); !good) return good;
    if (scene.image->labels.empty() && std::none_of(scene.bodies.begin(), scene.bodies.end(), isOfLabels)) {
      BodySources none;
      return tl::unexpected(labelsToExport(scene, none).error());
    }
  }
  if (!wanted.displacement.empty())
    for (const std::filesystem::path &file : {wanted.displacement, emptiedFile(wanted.displacement)})
      if (auto good = checkImageFile(file); !good) return good;
  return {};
}

Expected<std::shared_ptr<const imaging::Volume>> imageOfScene(const scene::SceneFile &scene, BodySources &sources) {
  imaging::ReadOptions chosen;
  chosen.series = scene.image->series;
  chosen.time = scene.image->time;
  auto image = sources.volume(scene.image->file, chosen);
  if (!image) return failInScene(image.error(), scene, scene.image->line);
  return *image;
}

Expected<ImageWarp> imageWarpOf(const scene::SceneFile &scene, BodySources &sources,
                                const scene::MaterialLibrary &materials, const std::vector<TissueVoxels> &tissues) {
  ImageWarp how;
  if (!tissues.empty()) how.tissues = std::make_shared<const std::vector<TissueVoxels>>(tissues);
  if (!scene.image) return how;
  const scene::SceneImage &asked = *scene.image;
  how.rim_mm = asked.rim_mm;
  const auto image = imageOfScene(scene, sources);
  if (!image) return tl::unexpected(image.error());
  if (!asked.labels.empty()) {
    const auto labels = sources.labels(asked.labels.back(), {});
    if (!labels) return failInScene(labels.error(), scene, asked.line);
    // For segments in several layers the first layer is used.
    how.labels = std::shared_ptr<const imaging::LabelMap>(*labels, &(*labels)->front());
  }
  auto rule = fixedRegionRuleOf(asked.still, **image, how.labels.get(), materials);
  if (!rule) return failInScene(rule.error(), scene, asked.line);
  how.still = std::move(*rule);
  return how;
}

Expected<imaging::DisplacementGrid> presentDisplacement(const c3de_simulator_v1 *table, c3de_object *simulator,
                                                        const imaging::Volume &image, const ImageWarp &how) {
  imaging::DisplacementGrid u;
  u.geometry = gridOf(presentBodies(table, simulator), image.geometry, how.rim_mm);
  if (!readDisplacement(table, simulator, how.rim_mm, u))
    return fail(ErrorCode::state, "the simulator does not say how far its bodies have moved");
  const std::shared_ptr<imaging::Mask> bodies = referenceBodies(simulator, image.geometry, how.tissues.get());
  if (bodies && !how.still.isEmpty())
    if (auto marked = imaging::markFixedRegions(how.still, image, how.labels.get(), *bodies); !marked)
      return tl::unexpected(marked.error());
  u.hasFixedRegions = bodies && imaging::hasFixedVoxels(*bodies);
  u.bodies = bodies;
  return u;
}

std::filesystem::path emptiedFile(const std::filesystem::path &displacement) {
  return displacement.empty() ? displacement : withSuffix(displacement, "-vacated");
}

std::vector<std::filesystem::path> labelFiles(const std::filesystem::path &labels, std::size_t layers) {
  std::vector<std::filesystem::path> files;
  for (std::size_t layer = 0; !labels.empty() && layer < layers; ++layer)
    files.push_back(layer == 0 ? labels : withSuffix(labels, "-" + std::to_string(layer + 1)));
  return files;
}

bool isImageOfLabels(const scene::SceneFile &scene) {
  if (!scene.image) return false;
  const auto isImage = [&](const std::filesystem::path &file) { return isSameFile(file, scene.image->file); };
  return std::any_of(scene.image->labels.begin(), scene.image->labels.end(), isImage) ||
         std::any_of(scene.bodies.begin(), scene.bodies.end(),
                     [&](const scene::SceneBody &body) { return isOfLabels(body) && isImage(body.volume.file); });
}

Expected<std::shared_ptr<const std::vector<imaging::LabelMap>>> labelsToExport(const scene::SceneFile &scene,
                                                                               BodySources &sources) {
  imaging::ReadOptions options;
  std::filesystem::path file;
  int line = 1;
  if (scene.image && !scene.image->labels.empty()) {
    file = scene.image->labels.back();
    line = scene.image->line;
  } else if (const auto body = std::find_if(scene.bodies.begin(), scene.bodies.end(), isOfLabels);
             body != scene.bodies.end()) {
    file = body->volume.file;
    options.series = body->volume.series;
    options.time = body->volume.time;
    line = body->line;
  }
  if (file.empty())
    return fail(ErrorCode::usage, "--export-labels needs a label map, and " + scene.where(line) +
                                      " has none; accepted: [image] with labels = \"…\", or a body with a label or "
                                      "tissues of its volume");
  auto layers = sources.labels(file, options);
  if (!layers) return failInScene(layers.error(), scene, line);
  return *layers;
}

Expected<std::string> writeLabels(const std::filesystem::path &file,
                                  const std::vector<const imaging::LabelMap *> &layers,
                                  const imaging::VolumeGeometry &grid, const imaging::DisplacementGrid &u,
                                  const ProgressFn &progress, ThreadPool *threads) {
  const std::vector<std::filesystem::path> files = labelFiles(file, layers.size());
  std::string text;
  for (std::size_t layer = 0; layer < layers.size(); ++layer) {
    const auto warped = imaging::warped(*layers[layer], u, grid, progress, threads);
    if (!warped) return tl::unexpected(warped.error());
    if (auto written = imaging::writeLabelMap(files[layer], *warped); !written) return tl::unexpected(written.error());
    text += (text.empty() ? "" : "\n") +
            fmt::format("{}: {} {}, each voxel with the label nearest to where its tissue was", pathText(files[layer]),
                        warped->labels.size(), warped->labels.size() == 1 ? "label" : "labels");
  }
  return text;
}

Expected<imaging::Volume> warpedImage(const imaging::Volume &image, bool areLabels, const imaging::DisplacementGrid &u,
                                      const ProgressFn &progress, ThreadPool *threads) {
  const auto sampling = areLabels ? imaging::WarpSampling::nearest : imaging::WarpSampling::linear;
  return imaging::warped(image, u, progress, threads, sampling);
}

Expected<std::string> writeImages(const ImageExport &wanted, const imaging::Volume &image, bool areLabels,
                                  const imaging::DisplacementGrid &u, const ProgressFn &progress, ThreadPool *threads) {
  std::string lines;
  if (!wanted.image.empty()) {
    const auto warped = warpedImage(image, areLabels, u, progress, threads);
    if (!warped) return tl::unexpected(warped.error());
    if (auto written = imaging::writeVolume(wanted.image, *warped); !written) return tl::unexpected(written.error());
    lines = pathText(wanted.image);
    if (areLabels) lines += ": a label map, so each voxel has the label nearest to where its tissue was";
    if (!image.colours.empty()) lines += ": brightness of the colours";
  }
  if (wanted.displacement.empty()) return lines;
  const auto field = imaging::resampled(u, image.geometry, progress, threads);
  if (!field) return tl::unexpected(field.error());
  auto vacated = imaging::emptiedRegions(u, image.geometry, progress, threads);
  if (!vacated) return tl::unexpected(vacated.error());
  if (auto written = imaging::writeVectorField(wanted.displacement, field->geometry, field->xyz_mm); !written)
    return tl::unexpected(written.error());
  const std::size_t voxels = imaging::voxelCount(*vacated);
  const double millilitres = static_cast<double>(voxels) * image.geometry.voxelVolume() / 1000.0;
  const std::filesystem::path mask = emptiedFile(wanted.displacement);
  imaging::Volume marks;
  marks.geometry = vacated->geometry;
  marks.voxels = std::move(vacated->voxels);
  if (auto written = imaging::writeVolume(mask, marks); !written) return tl::unexpected(written.error());
  lines +=
      (lines.empty() ? "" : "\n") + pathText(wanted.displacement) + "\n" + pathText(mask) + ": " +
      (voxels == 0 ? std::string("no voxel is vacated by a body")
                   : fmt::format("{} voxels ({:.2f} ml) are vacated by a body: nothing is known of what is there now",
                                 voxels, millilitres));
  return lines;
}

}  // namespace c3de::session
