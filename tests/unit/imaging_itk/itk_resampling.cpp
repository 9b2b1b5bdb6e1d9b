// SPDX-License-Identifier: Apache-2.0
#include "itk_resampling.h"

#include <itkAffineTransform.h>
#include <itkImage.h>
#include <itkLinearInterpolateImageFunction.h>
#include <itkNearestNeighborInterpolateImageFunction.h>
#include <itkResampleImageFilter.h>
#include <itkZeroFluxNeumannPadImageFilter.h>

#include <algorithm>
#include <limits>

namespace itk_truth {
namespace {

using Image = itk::Image<float, 3>;

Image::Pointer imageOf(const c3de::imaging::Volume &volume) {
  const c3de::imaging::VolumeGeometry &g = volume.geometry;
  const c3de::Vec3 spacing = g.spacing();
  auto image = Image::New();
  Image::SizeType size;
  Image::SpacingType steps;
  Image::PointType origin;
  Image::DirectionType direction;
  for (unsigned a = 0; a < 3; ++a) {
    size[a] = g.size[a];
    steps[a] = spacing[a];
    origin[a] = g.indexToWorld[12 + a];
    for (unsigned r = 0; r < 3; ++r) direction(r, a) = g.indexToWorld[4 * a + r] / spacing[a];
  }
  image->SetRegions(size);
  image->SetSpacing(steps);
  image->SetOrigin(origin);
  image->SetDirection(direction);
  image->Allocate();
  std::visit(
      [&](const auto &all) {
        std::transform(all.begin(), all.end(), image->GetBufferPointer(), [](auto v) { return static_cast<float>(v); });
      },
      volume.voxels);
  return image;
}

}  // namespace

std::vector<float> resampled(const c3de::imaging::Volume &volume, const c3de::Mat4 &sourceOf, Sampling sampling,
                             unsigned border) {
  const Image::Pointer image = imageOf(volume);
  auto pad = itk::ZeroFluxNeumannPadImageFilter<Image, Image>::New();
  pad->SetInput(image);
  pad->SetPadBound(Image::SizeType::Filled(border));

  using Affine = itk::AffineTransform<double, 3>;
  auto transform = Affine::New();
  Affine::MatrixType matrix;
  Affine::OutputVectorType offset;
  for (unsigned r = 0; r < 3; ++r) {
    for (unsigned c = 0; c < 3; ++c) matrix(r, c) = sourceOf[4 * c + r];
    offset[r] = sourceOf[12 + r];
  }
  transform->SetMatrix(matrix);
  transform->SetOffset(offset);

  auto filter = itk::ResampleImageFilter<Image, Image>::New();
  filter->SetInput(pad->GetOutput());
  filter->SetTransform(transform);
  if (sampling == Sampling::linear)
    filter->SetInterpolator(itk::LinearInterpolateImageFunction<Image>::New());
  else
    filter->SetInterpolator(itk::NearestNeighborInterpolateImageFunction<Image>::New());
  filter->SetDefaultPixelValue(std::numeric_limits<float>::quiet_NaN());
  filter->SetSize(image->GetLargestPossibleRegion().GetSize());
  filter->SetOutputSpacing(image->GetSpacing());
  filter->SetOutputOrigin(image->GetOrigin());
  filter->SetOutputDirection(image->GetDirection());
  filter->Update();
  const float *voxels = filter->GetOutput()->GetBufferPointer();
  return {voxels, voxels + volume.geometry.voxelCount()};
}

}  // namespace itk_truth
