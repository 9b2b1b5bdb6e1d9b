// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "dicom/dicom_series.h"
#include "formats/image_header.h"
#include "formats/voxel_reader.h"

namespace c3de::imaging {
namespace {

/// Equal up to rounding in files; 1e-4 rad moves the edge of a 500 mm picture by 0.05 mm.
bool isSameStack(const DicomFile &a, const DicomFrame &x, const DicomFile &b, const DicomFrame &y) {
  // Pictures without positions form a stack only for modalities with slices and a stated slice distance.
  if (!x.position && &a != &b &&
      !((a.modality == "CT" || a.modality == "MR" || a.modality == "PT") && x.sliceStep > 0.0))
    return false;
  if (&a != &b && (a.isTimeSeries || b.isTimeSeries || a.segmentation || b.segmentation)) return false;
  return a.series == b.series && a.rows == b.rows && a.columns == b.columns && a.refusal == b.refusal &&
         a.modality == b.modality && x.oriented == y.oriented && x.position.has_value() == y.position.has_value() &&
         norm(x.alongRow - y.alongRow) < 1e-4 && norm(x.alongColumn - y.alongColumn) < 1e-4 &&
         std::abs(x.rowStep - y.rowStep) < 1e-4 * x.rowStep &&
         std::abs(x.columnStep - y.columnStep) < 1e-4 * x.columnStep && a.path.parent_path() == b.path.parent_path();
}

std::string planeOf(const DicomFrame &frame) {
  static constexpr const char *kPlanes[] = {"sagittal", "coronal", "axial"};
  const Vec3 normal = cross(frame.alongRow, frame.alongColumn);
  std::size_t most = 0;
  for (std::size_t a = 1; a < 3; ++a)
    if (std::abs(normal[a]) > std::abs(normal[most])) most = a;
  return std::string(std::abs(normal[most]) < 0.9998 ? "oblique " : "") + kPlanes[most];  // within a degree
}

std::vector<std::filesystem::path> filesBelow(const std::filesystem::path &path) {
  std::vector<std::filesystem::path> files;
  std::error_code code;
  const auto take = [&](const std::filesystem::directory_entry &entry) {
    std::error_code ignored;
    if (entry.is_regular_file(ignored) && !isSystemArtefact(entry.path()) && files.size() < 200000)
      files.push_back(entry.path());
  };
  if (std::filesystem::is_directory(path, code)) {
    std::filesystem::recursive_directory_iterator at(path, std::filesystem::directory_options::skip_permission_denied,
                                                     code),
        end;
    for (; !code && at != end; at.increment(code)) {
      if (at.depth() >= 8 || isSystemArtefact(at->path())) at.disable_recursion_pending();
      take(*at);
    }
  } else {
    const auto folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
    for (const auto &entry : std::filesystem::directory_iterator(folder, code)) take(entry);
    if (isSystemArtefact(path)) files.push_back(path);  // requested by name
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// Inserts the blocks after each stack that has several: `ID#1`, `ID#2`, or `ID#2.1`, … where the stack is itself a
/// part.
void addBlocks(DicomFolder &folder) {
  std::vector<DicomStack> all;
  for (DicomStack &stack : folder.stacks) {
    std::vector<DicomStack> blocks;
    if (stack.info.refusal.empty() && !stack.info.isSegmentation) blocks = blocksOf(folder, stack);
    const std::string id = stack.info.id;
    all.push_back(std::move(stack));
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      SeriesInfo &info = blocks[b].info;
      info.id = id + (id.find('#') == std::string::npos ? "#" : ".") + std::to_string(b + 1);
      info.isPart = true;
      info.size[2] = blocks[b].slices.size();
      std::set<std::size_t> files;
      for (const SliceRef &ref : blocks[b].slices) files.insert(ref.file);
      info.files = files.size();
      all.push_back(std::move(blocks[b]));
    }
  }
  folder.stacks = std::move(all);
}

}  // namespace

Expected<DicomFolder> scanDicom(const std::filesystem::path &path, const ProgressFn &progress) {
  DicomFolder out;
  const auto files = filesBelow(path);
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (!shouldContinue(progress, static_cast<double>(i) / static_cast<double>(files.size()), "Scanning files"))
      return cancelled(path);
    if (auto file = readDicomHeader(files[i]))
      out.files.push_back(std::move(*file));
    else
      ++out.others;
  }
  for (std::size_t f = 0; f < out.files.size(); ++f) {
    const DicomFile &file = out.files[f];
    for (std::size_t k = 0; k < file.frames.size(); ++k) {
      const auto found = std::find_if(out.stacks.begin(), out.stacks.end(), [&](const DicomStack &stack) {
        const SliceRef first = stack.slices.front();
        return isSameStack(out.files[first.file], out.files[first.file].frames[first.frame], file, file.frames[k]);
      });
      DicomStack &stack = found != out.stacks.end() ? *found : out.stacks.emplace_back();
      stack.slices.push_back({f, k});
      SeriesInfo &info = stack.info;
      if (k == 0 || info.files == 0) ++info.files;
      info.size = {file.columns, file.rows, stack.slices.size()};
      if (stack.slices.size() > 1) continue;
      info.id = file.series.empty() ? file.path.filename().string() : file.series;
      info.number = file.number;
      info.description = file.description;
      info.isSegmentation = file.segmentation.has_value();
      info.modality = file.modality;
      info.patientName = file.patientName;
      info.refusal = file.refusal;
      info.folder = file.path.parent_path();
      info.orientation = file.frames[k].oriented ? planeOf(file.frames[k]) : "";
    }
  }
  // One series may contain several stacks (mixed orientations, the same series in two folders); their names are
  // numbered.
  std::map<std::string, std::size_t> uses, counted;
  for (const DicomStack &stack : out.stacks) ++uses[stack.info.id];
  for (DicomStack &stack : out.stacks)
    if (const std::string id = stack.info.id; uses[id] > 1) stack.info.id += "#" + std::to_string(++counted[id]);
  addBlocks(out);
  return out;
}

}  // namespace c3de::imaging
