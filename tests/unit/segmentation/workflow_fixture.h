// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <filesystem>
#include <thread>
#include <vector>

#include "c3de/core/background_jobs.h"
#include "c3de/core/main_queue.h"
#include "c3de/imaging/statistics.h"
#include "c3de/segmentation/scan_body.h"
#include "c3de/segmentation/segmentation_workflow.h"
#include "support/catch.h"
#include "support/folders.h"

namespace c3de::segmentation::test {

using Kind = MaskStep::Kind;

/// 20 x 20 x 20 voxels of 5 mm (an eighth of a millilitre). A box of value 100 with a hole of one voxel, and a separate
/// one; a label map with both.
struct Fixture {
  MainQueue queue;
  BackgroundJobs jobs{queue};
  scene::MaterialLibrary materials = [] {
    auto loaded = scene::MaterialLibrary::load(std::filesystem::path(testResourcesFolder()) / "materials.toml");
    if (!loaded) FAIL(loaded.error().message);
    return std::move(*loaded);
  }();
  std::vector<BodyRequest> made;
  std::vector<std::pair<std::string, std::shared_ptr<const imaging::Mask>>> updated;
  SegmentationWorkflow::MaskRange range;  ///< of the last of them
  int changes = 0;
  SegmentationWorkflow guide{
      jobs,
      "test",
      materials,
      {[this] { ++changes; }, [this](std::vector<BodyRequest> r) { made.insert(made.end(), r.begin(), r.end()); },
       [this](const std::string &body, std::shared_ptr<const imaging::Mask> mask,
              const SegmentationWorkflow::MaskRange &steps) {
         updated.emplace_back(body, std::move(mask));
         range = steps;
       }}};
  std::string scene;  ///< requested by `scan`
  ScanBody scan{jobs, "test", materials, [this](const std::string &text) { scene = text; }};
  MaskSources sources;

  static constexpr std::size_t kLarge = 6 * 6 * 6 - 1, kSmall = 4 * 4 * 4;

  Fixture() {
    auto image = std::make_shared<scene::StoredImage>();
    auto labels = std::make_shared<scene::StoredLabels>();
    image->volume.geometry = {{20, 20, 20}, {5, 0, 0, 0, 0, 5, 0, 0, 0, 0, 5, 0, 0, 0, 0, 1}};
    image->volume.unit = "HU";
    std::vector<std::int16_t> voxels(8000, 0);
    labels->map.geometry = image->volume.geometry;
    labels->map.voxels.resize(8000);
    labels->map.labels = {{3, "kidney_left", {1, 0, 0}}, {8, "thing", {0, 1, 0}}};
    const auto box = [&](std::size_t from, std::size_t to, std::uint16_t label) {
      for (std::size_t k = from; k < to; ++k)
        for (std::size_t j = from; j < to; ++j)
          for (std::size_t i = from; i < to; ++i) {
            voxels[i + 20 * (j + 20 * k)] = 100;
            labels->map.voxels[i + 20 * (j + 20 * k)] = label;
          }
    };
    box(2, 8, 3);
    box(12, 16, 8);
    voxels[4 + 20 * (4 + 20 * 4)] = 0;
    image->volume.voxels = voxels;
    image->range = imaging::robustRange(image->volume, 0.0);
    sources = {image, labels};
    guide.setSources({image, nullptr});
  }

  void settle() {
    const auto start = std::chrono::steady_clock::now();
    while (!jobs.running().empty()) {
      queue.runFrame();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      REQUIRE(std::chrono::steady_clock::now() - start < std::chrono::seconds(20));
    }
  }
  [[nodiscard]] std::size_t voxels() const { return guide.mask().voxels(); }
};

}  // namespace c3de::segmentation::test
