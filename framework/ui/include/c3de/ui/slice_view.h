// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "c3de/imaging/volume.h"
#include "c3de/render/image_renderer.h"

namespace c3de::ui {

enum class SliceAxis { axial, sagittal, coronal };
/// Radiological: as if the patient faced the viewer, so that axial and coronal views have the patient's right on the
/// left. Neurological: the patient's right on the right.
enum class Convention { radiological, neurological };

/// Directions of a view in the world, unit and orthogonal.
struct SliceFrame {
  Vec3 right{1, 0, 0}, down{0, 1, 0};
  Vec3 forward{0, 0, 1};  ///< to the next slice: superior, anterior, left
  [[nodiscard]] Vec3 normal() const { return cross(right, down); }
};

/// The frame of a view along the axes of the patient. If a grid is passed, along the nearest axes of the image instead
/// (made orthogonal, with the slices of the image unchanged).
[[nodiscard]] SliceFrame sliceFrame(SliceAxis axis, Convention convention, const imaging::VolumeGeometry *alignedWith);

/// Distance along a unit direction from one voxel to the next, mm, for the index that changes fastest.
[[nodiscard]] double voxelStep(const imaging::VolumeGeometry &grid, const Vec3 &direction);

/// The direction of a world vector: L or R, A or P, S or I, the largest component first. A second letter follows if
/// that component is above a tenth. For example "L", "PS".
[[nodiscard]] std::string orientationLetters(const Vec3 &direction);

/// A round length (1, 2 or 5 times a power of ten, mm) of at most `longest_px` pixels, and its text ("5 cm").
struct ScaleBar {
  double length_mm = 0.0, length_px = 0.0;
  std::string text;
};
[[nodiscard]] ScaleBar scaleBar(double millimetresPerPixel, double longest_px);

/// One flat view of an image: the plane it shows and the mapping of its points to the screen. Pixels are relative to
/// the view's upper left corner. Value type; any thread.
class SliceView {
 public:
  /// The image whose slices are counted; the view keeps its position in the world.
  void setGrid(const imaging::VolumeGeometry &grid);
  /// Rotates the view about its middle.
  void setFrame(const SliceFrame &frame);
  /// A view that shows the whole image continues to show it.
  void setSize(int width, int height);
  /// Fits the whole image into the view; the slice does not change.
  void fit();
  /// The whole image is in view, and stays fitted when the view is resized.
  [[nodiscard]] bool isFitted() const { return isFitted_; }
  /// Shows the middle slice with the whole image in view.
  void reset();

  [[nodiscard]] const SliceFrame &frame() const { return frame_; }
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] Vec3 worldAt(double x, double y) const;
  struct Pixel {
    double x = 0.0, y = 0.0;
  };
  [[nodiscard]] Pixel pixelOf(const Vec3 &world) const;
  [[nodiscard]] render::SlicePlane plane() const;
  [[nodiscard]] double millimetresPerPixel() const { return millimetresPerPixel_; }

  /// Distance between slices: the distance along `forward` from one voxel to the next, mm.
  [[nodiscard]] double step() const { return step_; }
  [[nodiscard]] int sliceCount() const { return count_; }
  [[nodiscard]] int slice() const;  ///< from 0
  /// Limited to the image.
  void scroll(int slices);
  void showSlice(int slice);
  /// Shows the slice nearest to a point; nothing else moves.
  void showPoint(const Vec3 &world);
  /// Whether a point is within half a step of the displayed plane.
  [[nodiscard]] bool isOnSlice(const Vec3 &world) const;

  /// The point under the pixel does not move. > 0: larger, by a tenth per step.
  void zoom(double steps, double x, double y);
  void pan(double dx_px, double dy_px);
  /// About the middle of the view; 2 doubles the size of what is shown.
  void magnify(double factor);

 private:
  void countSlices();
  [[nodiscard]] double position() const { return dot(centre_, frame_.forward); }
  [[nodiscard]] Vec3 gridCentre() const;
  [[nodiscard]] double fittedScale() const;

  imaging::VolumeGeometry grid_{{1, 1, 1}, kIdentity4};
  SliceFrame frame_;
  int width_ = 1, height_ = 1;
  Vec3 centre_{};
  double millimetresPerPixel_ = 1.0, step_ = 1.0, first_ = 0.0;  ///< first_: position of slice 0
  int count_ = 1;
  bool isFitted_ = true;
};

}  // namespace c3de::ui
