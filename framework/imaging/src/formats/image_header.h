// SPDX-License-Identifier: Apache-2.0
// The headers of NIfTI, NRRD and MetaImage in a common form; the voxels are read by voxel_reader.h.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/imaging/volume.h"

namespace c3de::imaging {

enum class Scalar { i8, u8, i16, u16, i32, u32, i64, u64, f32, f64 };
[[nodiscard]] std::size_t bytesOf(Scalar scalar);

struct ImageHeader {
  enum class Encoding { raw, deflated, text, hex };
  struct Part {
    std::filesystem::path path;
    std::uint64_t offset = 0;  ///< where its data begin
  };

  std::filesystem::path path;  ///< the requested file; messages name it
  VolumeGeometry geometry;
  Scalar scalar = Scalar::u8;
  bool bigEndian = false;
  double slope = 1.0, intercept = 0.0;
  std::string unit;
  std::size_t channels = 1;  ///< values per voxel, interleaved: 1, or 3 and 4 for colours
  std::size_t volumes = 1;   ///< time points or layers in the file
  bool interleaved = false;  ///< the volumes of a voxel are adjacent
  bool segmented = false;    ///< the voxels are segment numbers, which the header names
  bool layered = false;      ///< the volumes are layers of a segmentation
  Encoding encoding = Encoding::raw;
  std::vector<Part> parts;  ///< files that hold equal shares of all volumes, one after the other
  std::uint64_t skip = 0;   ///< bytes to skip after inflating, in each part
  std::string modality;
  std::vector<std::pair<std::string, std::string>> keys;  ///< key and value pairs of NRRD
  std::string labelXml;                                   ///< label table in a NIfTI extension; empty: none
  std::vector<std::string> notices;
};

/// Bytes of one volume, and of everything stated in the header (as a double: a header may state any size).
[[nodiscard]] double bytesOfVolume(const ImageHeader &header);
[[nodiscard]] double bytesOfAll(const ImageHeader &header);

[[nodiscard]] Expected<ImageHeader> readNiftiHeader(const std::filesystem::path &path);
[[nodiscard]] Expected<ImageHeader> readNrrdHeader(const std::filesystem::path &path);
[[nodiscard]] Expected<ImageHeader> readMetaHeader(const std::filesystem::path &path);

/// "FILE: what is wrong", as an input error.
[[nodiscard]] tl::unexpected<Error> refuse(const std::filesystem::path &path, const std::string &what);

/// Sets the size; refuses zero and more voxels than any machine holds.
[[nodiscard]] Expected<void> setSize(ImageHeader &header, const std::vector<double> &sizes);
/// Sets the columns of indexToWorld; refuses values that are not finite, not invertible or beyond 1e6 mm.
[[nodiscard]] Expected<void> setAffine(ImageHeader &header, const Vec3 &i, const Vec3 &j, const Vec3 &k,
                                       const Vec3 &origin);

/// One number: "1.5", "+2e-3", or with a decimal comma "1,5"; NaN for anything else.
[[nodiscard]] double numberFrom(const std::string &word);
/// Numbers of a text, separated by blanks or brackets, within brackets by commas; "nan" and non-numeric words become
/// NaN. A single comma between digits is a decimal comma, several separate numbers.
[[nodiscard]] std::vector<double> numbersIn(const std::string &text);
/// Whether a word of the text, outside brackets, has a decimal comma.
[[nodiscard]] bool hasDecimalComma(const std::string &text);
inline constexpr const char *kDecimalCommaNotice =
    "Numbers of the file have a decimal comma, as in '0,5'; they are read with a decimal point.";
/// Millimetres per unit of length, by its symbol or its English name; none for an unknown one.
[[nodiscard]] std::optional<double> millimetresOf(const std::string &unit);
/// The file names of `slice%03d.raw` with {first, last, step}; empty if it is no such pattern.
[[nodiscard]] std::vector<std::string> numberedNames(const std::string &pattern, const std::vector<double> &range);
[[nodiscard]] std::string trimmed(const std::string &text);
[[nodiscard]] std::string lowerCase(std::string text);
/// Whether a file or folder is an artefact of an operating system: "._a.dcm", ".DS_Store", "Thumbs.db", "desktop.ini",
/// "__MACOSX". Includes hidden files.
[[nodiscard]] bool isSystemArtefact(const std::filesystem::path &path);
/// The extension in lower case; ".nii.gz", ".img.gz" and ".hdr.gz" are kept whole.
[[nodiscard]] std::string imageExtension(const std::filesystem::path &path);

}  // namespace c3de::imaging
