// SPDX-License-Identifier: Apache-2.0
// Colours of DICOM, PS3.3 C.7.6.3.1.2: RGB, YBR_FULL, YBR_FULL_422, YBR_ICT and YBR_RCT (JPEG 2000), PALETTE COLOR.
#pragma once

#include "dicom/dicom_files.h"
#include "dicom/dicom_parser.h"

namespace c3de::imaging {

/// Why the colours of a file are not read; empty: they are.
[[nodiscard]] std::string refusalOfColours(const DicomSet &set);

/// Stored values per pixel in uncompressed form: two where pixel pairs share their chroma.
[[nodiscard]] std::size_t samplesStored(const DicomSet &set);

/// Output of decoders: three interleaved values per pixel, of 8 or 16 bits in native byte order.
struct ColourSamples {
  std::vector<char> bytes;
  unsigned allocated = 8, stored = 8;
  bool isDifference = false;  ///< luma and two chroma components (YCbCr, full range) instead of red, green, blue
};
[[nodiscard]] std::vector<Rgba> coloursOf(const ColourSamples &samples);

/// Expands Y Y Cb Cr for two pixels to Y Cb Cr for each. 8 bits.
[[nodiscard]] std::vector<char> unpaired(const std::vector<char> &bytes);
/// Converts planar frames (all first, all second, all third values) to three values for each pixel.
[[nodiscard]] std::vector<char> interleaved(const std::vector<char> &planes, std::size_t pixelsOfFrame,
                                            std::size_t bytesEach);

/// Maps numbers to the colours of the file's palette; empty: its tables are damaged.
[[nodiscard]] std::vector<Rgba> paletteColours(const DicomSet &set, const Voxels &numbers);

/// Luma of encoded colours (Rec. 709), 8 bits.
[[nodiscard]] std::vector<std::uint8_t> lumaOf(const std::vector<Rgba> &colours);

}  // namespace c3de::imaging
