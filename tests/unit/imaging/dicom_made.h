// SPDX-License-Identifier: Apache-2.0
// DICOM files that cases make themselves: a picture with the elements a reader needs, and those that a case is about.
#pragma once

#include <cstring>
#include <functional>
#include <map>

#include "images.h"
#include "support/dicom_series.h"

namespace made {

using namespace images;
using test::DicomElements;

template <class T>
std::string packed(const std::vector<T> &values) {
  std::string bytes(values.size() * sizeof(T), '\0');
  if (!values.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

/// Elements by tag, written in ascending order, so that a case can add, replace and remove them.
class Picture {
 public:
  Picture(std::uint16_t columns, std::uint16_t rows) {
    text(0x00080018, "UI", "2.25.3104.1.1.1");
    text(0x00080060, "CS", "MR");
    text(0x0020000e, "UI", "2.25.3104.1.1");
    text(0x00200013, "IS", "1");
    text(0x00200032, "DS", "0\\0\\0");
    text(0x00200037, "DS", "1\\0\\0\\0\\1\\0");
    number(0x00280002, 1);
    text(0x00280004, "CS", "MONOCHROME2");
    number(0x00280010, rows);
    number(0x00280011, columns);
    text(0x00280030, "DS", "2\\1.5");
    number(0x00280100, 16);
    number(0x00280101, 16);
    number(0x00280102, 15);
    number(0x00280103, 0);
  }
  Picture &text(std::uint32_t tag, const char (&vr)[3], const std::string &value) {
    DicomElements one;
    one.add(static_cast<std::uint16_t>(tag >> 16), static_cast<std::uint16_t>(tag & 0xffff), vr, value);
    elements_[tag] = one.bytes();
    return *this;
  }
  Picture &number(std::uint32_t tag, std::uint16_t value) {
    return text(tag, "US", packed(std::vector<std::uint16_t>{value}));
  }
  Picture &sequence(std::uint32_t tag, const std::vector<std::string> &items) {
    DicomElements one;
    one.add(static_cast<std::uint16_t>(tag >> 16), static_cast<std::uint16_t>(tag & 0xffff), items);
    elements_[tag] = one.bytes();
    return *this;
  }
  Picture &bits(std::uint16_t allocated) {
    return number(0x00280100, allocated)
        .number(0x00280101, allocated)
        .number(0x00280102, static_cast<std::uint16_t>(allocated - 1));
  }
  template <class T>
  Picture &pixels(const std::vector<T> &values) {
    return text(0x7fe00010, "OW", packed(values));
  }
  Picture &without(std::uint32_t tag) {
    elements_.erase(tag);
    return *this;
  }
  [[nodiscard]] std::string elements() const {
    std::string all;
    for (const auto &[tag, bytes] : elements_) all += bytes;
    return all;
  }
  [[nodiscard]] std::string file(const std::string &syntax = "1.2.840.10008.1.2.1") const {
    return test::dicomFile(elements(), syntax);
  }

 private:
  std::map<std::uint32_t, std::string> elements_;
};

/// The elements of an item.
inline std::string item(const std::function<void(DicomElements &)> &fill) {
  DicomElements all;
  fill(all);
  return all.bytes();
}

}  // namespace made
