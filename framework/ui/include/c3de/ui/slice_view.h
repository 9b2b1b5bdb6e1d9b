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

/// The frame of a view along the axes of the patient or, where a grid is given, of the image that are nearest to them
/// (made orthogonal, the slices of the image as they are).
[[nodiscard]] SliceFrame sliceFrame(SliceAxis axis, Convention convention, const imaging::VolumeGeometry *alignedWith);

/// How far it is along a unit direction from one voxel to the next, mm: that of the index which changes fastest.
[[nodiscard]] double voxelStep(const imaging::VolumeGeometry &grid, const Vec3 &direction);

/// Where a direction of the world points: L or R, A or P, S or I, the largest part first; a second letter when that
/// part is above a tenth. For example "L", "PS".
[[nodiscard]] std::string orientationLetters(const Vec3 &direction);

/// A round length (1, 2 or 5 times a power of ten, mm) of at most `longest_px` pixels, and its text ("5 cm").
struct ScaleBar {
  double length_mm = 0.0, length_px = 0.0;
  std::string text;
};
[[nodiscard]] ScaleBar scaleBar(double millimetresPerPixel, double longest_px);

/// One flat view of an image: which plane it shows and where its points lie on the screen. Pixels from the view's upper
/// left corner. Value type; any thread.
class SliceView {
 public:
  /// The image whose slices are counted; the view keeps its place in the world.
  void setGrid(const imaging::VolumeGeometry &grid);
  /// Turns the view about its middle.
  void setFrame(const SliceFrame &frame);
  /// A view that shows the whole image goes on doing so.
  void setSize(int width, int height);
  /// Brings the image into the view as a whole; the slice stays.
  void fit();
  /// To the middle slice, the whole image in view.
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

  /// Distance between slices: the way along `forward` from one voxel to the next, mm.
  [[nodiscard]] double step() const { return step_; }
  [[nodiscard]] int sliceCount() const { return count_; }
  [[nodiscard]] int slice() const;  ///< from 0
  /// Stays within the image.
  void scroll(int slices);
  void showSlice(int slice);
  /// To the slice nearest to a point; nothing else moves.
  void showPoint(const Vec3 &world);
  /// Within half a step of the shown plane.
  [[nodiscard]] bool isOnSlice(const Vec3 &world) const;

  /// The point under the pixel stays there. > 0: larger, by a tenth per step.
  void zoom(double steps, double x, double y);
  void pan(double dx_px, double dy_px);

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
