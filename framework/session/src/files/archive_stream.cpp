// SPDX-License-Identifier: Apache-2.0
#include "files/archive_stream.h"

#include <algorithm>

namespace c3de::session {

PartBuffer::int_type PartBuffer::underflow() {
  const std::uint64_t count = std::min<std::uint64_t>(size_ - read_, buffer_.size());
  whole_.clear();
  whole_.seekg(static_cast<std::streamoff>(begin_ + read_));
  whole_.read(buffer_.data(), static_cast<std::streamsize>(count));
  const auto got = static_cast<std::size_t>(std::max<std::streamsize>(whole_.gcount(), 0));
  read_ += got;
  setg(buffer_.data(), buffer_.data(), buffer_.data() + got);
  return got == 0 ? traits_type::eof() : traits_type::to_int_type(buffer_[0]);
}

PartBuffer::pos_type PartBuffer::seekoff(off_type distance, std::ios_base::seekdir from, std::ios_base::openmode) {
  const auto base = static_cast<off_type>(from == std::ios_base::beg   ? 0
                                          : from == std::ios_base::cur ? position()
                                                                       : size_);
  const off_type to = base + distance;
  if (to < 0 || static_cast<std::uint64_t>(to) > size_) return pos_type(off_type(-1));
  if (static_cast<std::uint64_t>(to) != position()) {
    read_ = static_cast<std::uint64_t>(to);
    setg(nullptr, nullptr, nullptr);
  }
  return to;
}

PartBuffer::pos_type PartBuffer::seekpos(pos_type to, std::ios_base::openmode which) {
  return seekoff(off_type(to), std::ios_base::beg, which);
}

}  // namespace c3de::session
