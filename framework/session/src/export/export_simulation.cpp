// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/export_simulation.h"

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <utility>

#include "c3de/core/output_file.h"
#include "c3de/geometry/mesh_writer.h"

namespace c3de::session {
namespace {

namespace fs = std::filesystem;
using geometry::PointArray;

/// Interval between updates of the unfinished list.
constexpr std::chrono::seconds kListEvery{1};

std::string utf8(const fs::path &path) {
  const std::u8string text = path.u8string();
  return {text.begin(), text.end()};
}

/// A valid file name component on every system.
std::string fileNameOf(const std::string &name) {
  std::string out;
  for (const char c : name) {
    const bool isOdd =
        static_cast<unsigned char>(c) < 0x20 || std::string_view("/\\:*?\"<>|").find(c) != std::string_view::npos;
    out.push_back(isOdd ? '_' : c);
  }
  return out.empty() ? "body" : out;
}

fs::path fromUtf8(const std::string &text) { return fs::path(std::u8string(text.begin(), text.end())); }

std::string numbered(const char *stem, std::size_t frame, const char *extension) {
  char text[64];
  std::snprintf(text, sizeof text, "%s_%06zu%s", stem, frame, extension);
  return text;
}

/// Rows of all bodies concatenated; arrays that not every body has are omitted.
template <class ArraysOf, class CountOf>
std::vector<PointArray> joined(const std::vector<BodyState> &bodies, ArraysOf &&arraysOf, CountOf &&countOf) {
  std::vector<PointArray> out;
  for (const PointArray &first : arraysOf(bodies.front())) {
    PointArray whole{first.name, first.components, {}, first.type};
    const bool isEverywhere = std::all_of(bodies.begin(), bodies.end(), [&](const BodyState &body) {
      const auto &arrays = arraysOf(body);
      const auto it =
          std::find_if(arrays.begin(), arrays.end(), [&](const PointArray &a) { return a.name == first.name; });
      if (it == arrays.end()) return false;
      whole.values.insert(whole.values.end(), it->values.begin(), it->values.end());
      return true;
    });
    if (isEverywhere) out.push_back(std::move(whole));
  }
  PointArray number{"body", 1, {}, PointArray::Type::whole};
  for (std::size_t b = 0; b < bodies.size(); ++b)
    number.values.insert(number.values.end(), countOf(bodies[b]), static_cast<double>(b));
  out.push_back(std::move(number));
  return out;
}

std::string titleOf(const std::vector<BodyState> &bodies) {
  std::string title = "bodies:";
  for (std::size_t b = 0; b < bodies.size(); ++b)
    title += (b ? ", " : " ") + std::to_string(b) + " = " + bodies[b].name;
  return title;
}

}  // namespace

fs::path framesFolder(const fs::path &list) {
  fs::path folder = list;
  folder.replace_extension();
  folder += "_frames";
  return folder;
}

Expected<void> checkSimulationExport(const fs::path &list) {
  if (list.extension() != ".pvd")
    return fail(ErrorCode::usage,
                utf8(list) + ": simulations with the extension '" + utf8(list.extension()) +
                    "' cannot be written; accepted: .pvd (surfaces: --export-surface FILE.{obj,stl,ply,vtp})");
  if (auto ok = checkOutputs({&list, 1}, {}); !ok) return ok;
  const fs::path folder = framesFolder(list);
  std::error_code code;
  if (!fs::exists(folder, code)) {
    // Where the list can be written, its folder can be created.
    return {};
  }
  if (!fs::is_directory(folder, code))
    return fail(ErrorCode::output,
                utf8(folder) + ": is a file, where a folder for the frames of " + utf8(list) + " is needed");
  const fs::path first = folder / numbered("skin", 0, ".vtp");
  return checkOutputs({&first, 1}, {});
}

SimulationExport::~SimulationExport() {
  if (!isListed_) (void)writeList();
}

Expected<void> SimulationExport::writeList() {
  listedAt_ = std::chrono::steady_clock::now();
  isListed_ = true;
  return geometry::writePvd(list_, entries_);
}

Expected<void> SimulationExport::addFrame(double time_s, const std::vector<BodyState> &bodies) {
  if (bodies.empty()) return fail(ErrorCode::state, utf8(list_) + ": not written: there is no body");
  const fs::path folder = framesFolder(list_);
  std::error_code code;
  fs::create_directories(folder, code);
  if (code) return fail(ErrorCode::output, utf8(folder) + ": the folder cannot be made: " + code.message());
  const std::string title = titleOf(bodies);
  geometry::PointCloud cloud;
  geometry::TriangleMesh skin;
  for (const BodyState &body : bodies) {
    const auto first = static_cast<unsigned>(skin.vertices.size());
    cloud.points.insert(cloud.points.end(), body.inside.points.begin(), body.inside.points.end());
    skin.vertices.insert(skin.vertices.end(), body.skin.vertices.begin(), body.skin.vertices.end());
    for (const Triangle &t : body.skin.triangles) skin.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  cloud.arrays = joined(
      bodies, [](const BodyState &b) -> const auto & { return b.inside.arrays; },
      [](const BodyState &b) { return b.inside.points.size(); });
  const auto skinArrays = joined(
      bodies, [](const BodyState &b) -> const auto & { return b.skinArrays; },
      [](const BodyState &b) { return b.skin.vertices.size(); });
  const std::string pointFile = numbered("points", frames_, ".vtu"), skinFile = numbered("skin", frames_, ".vtp");
  if (auto ok = geometry::writeVtu(folder / pointFile, cloud, title); !ok) return ok;
  if (auto ok = geometry::writeVtp(folder / skinFile, skin, skinArrays, title); !ok) {
    fs::remove(folder / pointFile, code);
    return ok;
  }
  entries_.push_back({time_s, 0, folder.filename() / pointFile});
  entries_.push_back({time_s, 1, folder.filename() / skinFile});
  ++frames_;
  isListed_ = false;
  if (std::chrono::steady_clock::now() - listedAt_ >= kListEvery) return writeList();
  return {};
}

Expected<void> SimulationExport::finish() {
  if (isListed_) return {};
  return writeList();
}

std::vector<fs::path> surfaceFiles(const fs::path &file, std::span<const std::string> bodies) {
  if (bodies.size() < 2) return {file};
  std::vector<fs::path> out;
  for (const std::string &body : bodies) {
    const auto named = [&](const std::string &suffix) {
      fs::path one = file.parent_path() / file.stem();
      one += fromUtf8("-" + fileNameOf(body) + suffix);
      one += file.extension();
      return one;
    };
    fs::path one = named("");
    for (int i = 2; std::find(out.begin(), out.end(), one) != out.end(); ++i) one = named("-" + std::to_string(i));
    out.push_back(std::move(one));
  }
  return out;
}

Expected<void> checkSurfaceExport(const geometry::MeshFormats &formats, const fs::path &file,
                                  std::span<const std::string> bodies) {
  if (auto ok = formats.checkWritable(file); !ok) return ok;
  return checkOutputs(surfaceFiles(file, bodies), {});
}

void writeSurfaces(const geometry::MeshFormats &formats, const fs::path &file, const std::vector<BodyState> &bodies,
                   const SurfaceCallback &onWritten) {
  if (bodies.empty()) return onWritten(file, fail(ErrorCode::state, utf8(file) + ": not written: there is no body"));
  std::vector<std::string> names;
  for (const BodyState &body : bodies) names.push_back(body.name);
  const std::vector<fs::path> files = surfaceFiles(file, names);
  for (std::size_t b = 0; b < bodies.size(); ++b)
    onWritten(files[b], formats.write(files[b], bodies[b].skin, {bodies[b].skinArrays, bodies[b].name}));
}

}  // namespace c3de::session
