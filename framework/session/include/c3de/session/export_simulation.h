// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/geometry/mesh_formats.h"
#include "c3de/geometry/vtk_writer.h"
#include "c3de/session/body_states.h"

namespace c3de::session {

/// Frames of a simulation for ParaView. FILE.pvd lists, with times in seconds, the files in the folder FILE_frames:
/// points_NNNNNN.vtu and skin_NNNNNN.vtp with all bodies, distinguished by the array "body".
class SimulationExport {
 public:
  explicit SimulationExport(std::filesystem::path list) : list_(std::move(list)) {}
  SimulationExport(const SimulationExport &) = delete;
  SimulationExport &operator=(const SimulationExport &) = delete;
  ~SimulationExport();  ///< lists the frames written so far, as far as possible

  /// The list grows with the frames, so that ParaView can open it while the simulation runs.
  [[nodiscard]] Expected<void> addFrame(double time_s, const std::vector<BodyState> &bodies);
  [[nodiscard]] Expected<void> finish();

 private:
  [[nodiscard]] Expected<void> writeList();
  std::filesystem::path list_;
  std::vector<geometry::PvdEntry> entries_;
  std::size_t frames_ = 0;
  bool isListed_ = true;
  std::chrono::steady_clock::time_point listedAt_{};
};

/// The frames folder of a list.
[[nodiscard]] std::filesystem::path framesFolder(const std::filesystem::path &list);

/// Checks before the simulation starts whether a sequence can be written there; leaves no files behind.
/// ErrorCode::usage for an extension other than .pvd, ErrorCode::output with the reason.
[[nodiscard]] Expected<void> checkSimulationExport(const std::filesystem::path &list);

/// One file per body: FILE itself for a single body, FILE-NAME for several (numbered where two names would coincide).
[[nodiscard]] std::vector<std::filesystem::path> surfaceFiles(const std::filesystem::path &file,
                                                              std::span<const std::string> bodies);
/// Same check for surfaces, before the simulation starts; the error names the accepted extensions.
[[nodiscard]] Expected<void> checkSurfaceExport(const geometry::MeshFormats &formats, const std::filesystem::path &file,
                                                std::span<const std::string> bodies);
/// Called for each file of writeSurfaces() with its result.
using SurfaceCallback = std::function<void(const std::filesystem::path &file, const Expected<void> &result)>;
/// Writes the skins. The failure of one file does not prevent the others. Errors: ErrorCode::output; ErrorCode::state
/// when there is no body, or one without triangles.
void writeSurfaces(const geometry::MeshFormats &formats, const std::filesystem::path &file,
                   const std::vector<BodyState> &bodies, const SurfaceCallback &told);

}  // namespace c3de::session
