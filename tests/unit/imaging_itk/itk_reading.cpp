// SPDX-License-Identifier: Apache-2.0
#include "itk_reading.h"

#include <itkGDCMImageIO.h>
#include <itkGDCMSeriesFileNames.h>
#include <itkImageFileReader.h>
#include <itkImageSeriesReader.h>
#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>

using c3de::ErrorCode;
using c3de::Expected;

namespace itk_truth {
namespace {

using ItkImage = itk::Image<double, 3>;

template <class AnyImage>
Image taken(const AnyImage &image, std::size_t time = 0) {
  Image out;
  const auto size = image.GetLargestPossibleRegion().GetSize();
  const auto &origin = image.GetOrigin();
  const auto &spacing = image.GetSpacing();
  const auto &direction = image.GetDirection();
  out.geometry.size = {size[0], size[1], size[2]};
  for (unsigned c = 0; c < 3; ++c)
    for (unsigned r = 0; r < 3; ++r) out.geometry.indexToWorld[4 * c + r] = direction[r][c] * spacing[c];
  for (unsigned r = 0; r < 3; ++r) out.geometry.indexToWorld[12 + r] = origin[r];
  const double *voxels = image.GetBufferPointer() + time * out.geometry.voxelCount();
  out.values.assign(voxels, voxels + out.geometry.voxelCount());
  return out;
}

}  // namespace

Expected<Image> read(const std::filesystem::path &file, std::size_t time) try {
  const std::string name = file.filename().string();
  itk::ImageIOBase::Pointer io;
  if (name.find(".nrrd") != std::string::npos || name.find(".nhdr") != std::string::npos)
    io = itk::NrrdImageIO::New();
  else if (name.find(".mh") != std::string::npos)
    io = itk::MetaImageIO::New();
  else
    io = itk::NiftiImageIO::New();
  const auto reader = itk::ImageFileReader<ItkImage>::New();
  reader->SetImageIO(io);
  reader->SetFileName(file.string());
  io->SetFileName(file.string());
  io->ReadImageInformation();
  if (io->GetNumberOfDimensions() > 3) {
    // Reading into three dimensions would use a part of the 4 x 4 matrix.
    const auto all = itk::ImageFileReader<itk::Image<double, 4>>::New();
    all->SetImageIO(io);
    all->SetFileName(file.string());
    all->Update();
    return taken(*all->GetOutput(), time);
  }
  reader->Update();
  return taken(*reader->GetOutput());
} catch (const itk::ExceptionObject &e) {
  return c3de::fail(ErrorCode::input, e.GetDescription());
}

Expected<Image> readSeries(const std::filesystem::path &folder) try {
  const auto names = itk::GDCMSeriesFileNames::New();
  names->SetUseSeriesDetails(true);
  names->SetDirectory(folder.string());
  const auto series = names->GetSeriesUIDs();
  if (series.size() != 1) return c3de::fail(ErrorCode::input, std::to_string(series.size()) + " series");
  const auto reader = itk::ImageSeriesReader<ItkImage>::New();
  reader->SetImageIO(itk::GDCMImageIO::New());
  reader->SetFileNames(names->GetFileNames(series.front()));
  reader->ForceOrthogonalDirectionOff();
  reader->Update();
  return taken(*reader->GetOutput());
} catch (const itk::ExceptionObject &e) {
  return c3de::fail(ErrorCode::input, e.GetDescription());
}

}  // namespace itk_truth
