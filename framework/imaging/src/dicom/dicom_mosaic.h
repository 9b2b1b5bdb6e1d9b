// SPDX-License-Identifier: Apache-2.0
// Siemens mosaics: one picture that holds the slices of a volume as tiles, row by row from the upper left, the last
// cells empty. The layout is private to Siemens; its facts are published by the nibabel project in its DICOM notes,
// "Siemens mosaic format" and "Siemens format DICOM with CSA header" (nipy.org/nibabel/dicom):
// - Image Type contains the word MOSAIC; a picture has g x g cells, g = ceil(sqrt(NumberOfImagesInMosaic)).
// - The CSA image header, private element (0029,xx10) after the creator "SIEMENS CSA HEADER", has
//   NumberOfImagesInMosaic and SliceNormalVector, the direction of increasing slices. It is the cross product of Image
//   Orientation or its opposite.
// - Image Position is that of a single picture as large as the mosaic, centred on the centre of the first slice. The
//   first voxel of the first tile is at
//       position + alongRow * columnStep * (columns - tileColumns) / 2 + alongColumn * rowStep * (rows - tileRows) / 2.
// - The slice distance is Spacing Between Slices (0018,0088), gaps included.
#pragma once

#include "dicom/dicom_files.h"
#include "dicom/dicom_parser.h"

namespace c3de::imaging {

/// Whether the header declares a mosaic.
[[nodiscard]] bool isMosaic(const DicomSet &set);

/// Splits the single frame of a mosaic into a frame for each tile: rows, columns, tiles, positions. Sets `refusal`
/// where the header does not state their number, their position or their direction.
void splitMosaic(const DicomSet &set, DicomFile &file);

/// Splits a decoded mosaic into its tiles, one after the other. @return false: the picture has too few tiles
[[nodiscard]] bool splitTiles(const DicomFile &file, DicomPixels &pixels);

}  // namespace c3de::imaging
