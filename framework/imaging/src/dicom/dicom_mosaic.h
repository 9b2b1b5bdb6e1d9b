// SPDX-License-Identifier: Apache-2.0
// Mosaics of Siemens: one picture that holds the slices of a volume as tiles, row by row from the upper left, the last
// cells empty. The layout is private to Siemens; its facts are published by the nibabel project in its DICOM notes,
// "Siemens mosaic format" and "Siemens format DICOM with CSA header" (nipy.org/nibabel/dicom):
// - Image Type holds the word MOSAIC; a picture has g x g cells, g = ceil(sqrt(NumberOfImagesInMosaic)).
// - The CSA image header, private element (0029,xx10) behind the creator "SIEMENS CSA HEADER", has
//   NumberOfImagesInMosaic and SliceNormalVector, the direction in which slices follow each other. It is the cross
//   product of Image Orientation or its opposite.
// - Image Position is that of a single picture as large as the mosaic around the centre of the first slice. The first
//   voxel of the first tile lies at
//       position + alongRow * columnStep * (columns - tileColumns) / 2 + alongColumn * rowStep * (rows - tileRows) / 2.
// - Slices lie Spacing Between Slices (0018,0088) apart, gaps included.
#pragma once

#include "dicom/dicom_files.h"
#include "dicom/dicom_parser.h"

namespace c3de::imaging {

/// Whether a picture is said to be a mosaic.
[[nodiscard]] bool isMosaic(const DicomSet &set);

/// Turns the one frame of a mosaic into a frame for each tile: rows, columns, tiles, positions. Sets `refusal` where
/// the header does not say how many there are, where they lie or in which direction they follow each other.
void splitMosaic(const DicomSet &set, DicomFile &file);

/// The tiles of a decoded mosaic, one after the other. @return false: the picture does not have so many
[[nodiscard]] bool takeTilesApart(const DicomFile &file, DicomPixels &pixels);

}  // namespace c3de::imaging
