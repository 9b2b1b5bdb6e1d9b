// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "formats/byte_stream.h"
#include "formats/image_header.h"

namespace c3de::imaging {

/// The voxels of all volumes of a header as one sequence of bytes, inflated. Each file holds an equal share of them, so
/// a truncated file does not shift the others.
class VoxelBytes {
 public:
  explicit VoxelBytes(const ImageHeader &header);

  /// Advances by this many bytes; in compressed files they are read and discarded by the next read().
  void skip(double bytes);
  [[nodiscard]] Expected<void> read(void *to, std::size_t bytes);
  /// Bytes read or skipped since the beginning.
  [[nodiscard]] double at() const { return at_; }
  /// Verifies the checksum after the last voxel; returns the fault, empty: none.
  [[nodiscard]] std::string faultAtEnd();
  /// Bytes of the files after the voxels; for compressed files only after faultAtEnd(), and limited to the bytes
  /// examined.
  [[nodiscard]] double leftOver() const;

 private:
  [[nodiscard]] std::string because() const { return stream_->fault().empty() ? "" : " (" + stream_->fault() + ")"; }
  [[nodiscard]] Expected<void> open();

  const ImageHeader &header_;
  double share_, at_ = 0.0, behind_ = 0.0;
  std::size_t part_ = 0;  ///< the file that stream_ reads
  std::unique_ptr<ByteStream> stream_;
};

/// Refuses headers that state more data than files of this size can hold, before memory is allocated.
/// @param bytes  required bytes from the first voxel on
[[nodiscard]] Expected<void> checkFileSize(const ImageHeader &header, double bytes);

/// Number of complete volumes according to the file sizes; none where only reading to the end can determine it.
[[nodiscard]] std::optional<std::size_t> wholeVolumesBySize(const ImageHeader &header);

}  // namespace c3de::imaging
