// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "formats/byte_stream.h"
#include "formats/image_header.h"

namespace c3de::imaging {

/// The voxels of all volumes of a header as one row of bytes, inflated. Each file holds an equal share of them, so a
/// short one leaves no shift.
class VoxelBytes {
 public:
  explicit VoxelBytes(const ImageHeader &header);

  /// Goes on so many bytes further; of compressed files they are read away with the next read().
  void skip(double bytes);
  [[nodiscard]] Expected<void> read(void *to, std::size_t bytes);
  /// Bytes that were delivered or left out since the beginning.
  [[nodiscard]] double at() const { return at_; }
  /// Looks at the check sum behind the last voxel; what is wrong, empty: nothing.
  [[nodiscard]] std::string faultAtEnd();
  /// Bytes of the files behind the voxels; of compressed ones only after faultAtEnd(), and no more than are looked at.
  [[nodiscard]] double leftOver() const;

 private:
  [[nodiscard]] std::string because() const { return stream_->fault().empty() ? "" : " (" + stream_->fault() + ")"; }
  [[nodiscard]] Expected<void> open();

  const ImageHeader &header_;
  double share_, at_ = 0.0, behind_ = 0.0;
  std::size_t part_ = 0;  ///< that stream_ reads
  std::unique_ptr<ByteStream> stream_;
};

/// A header can say anything; what cannot be in files of this size is refused before memory is taken for it.
/// @param bytes  from the first voxel on that are needed
[[nodiscard]] Expected<void> checkFileSize(const ImageHeader &header, double bytes);

/// How many volumes are whole as far as the sizes of the files say; nothing where only reading to the end can tell.
[[nodiscard]] std::optional<std::size_t> wholeVolumesBySize(const ImageHeader &header);

}  // namespace c3de::imaging
