// SPDX-License-Identifier: Apache-2.0
// Files of several time points: which one is read, and the messages about files that end within them.
#include <zlib.h>

#include <cstring>

#include "images.h"

using namespace images;

namespace {

constexpr std::size_t kVoxels = 5 * 4 * 3, kTimes = 4;

/// Voxel v at time t is 1000 t + v.
std::string shorts(bool areInterleaved) {
  std::vector<std::int16_t> all(kVoxels * kTimes);
  for (std::size_t t = 0; t < kTimes; ++t)
    for (std::size_t v = 0; v < kVoxels; ++v)
      all[areInterleaved ? v * kTimes + t : t * kVoxels + v] = static_cast<std::int16_t>(1000 * t + v);
  return {reinterpret_cast<const char *>(all.data()), all.size() * sizeof all[0]};
}

std::string packed(const std::string &bytes, int windowBits) {
  z_stream z{};
  REQUIRE(deflateInit2(&z, 6, Z_DEFLATED, windowBits, 8, Z_DEFAULT_STRATEGY) == Z_OK);
  std::string out(deflateBound(&z, static_cast<uLong>(bytes.size())) + 64, '\0');
  z.next_in = reinterpret_cast<Bytef *>(const_cast<char *>(bytes.data()));
  z.avail_in = static_cast<uInt>(bytes.size());
  z.next_out = reinterpret_cast<Bytef *>(out.data());
  z.avail_out = static_cast<uInt>(out.size());
  REQUIRE(deflate(&z, Z_FINISH) == Z_STREAM_END);
  out.resize(z.total_out);
  deflateEnd(&z);
  return out;
}
std::string gzip(const std::string &bytes) { return packed(bytes, 15 + 16); }

std::string niftiHead() {
  std::string head(352, '\0');
  const auto put = [&](std::size_t at, auto value) { std::memcpy(head.data() + at, &value, sizeof value); };
  put(0, std::int32_t{348});
  std::memcpy(head.data() + 344, "n+1", 3);
  const std::int16_t dim[8] = {4, 5, 4, 3, kTimes, 1, 1, 1};
  for (std::size_t d = 0; d < 8; ++d) put(40 + 2 * d, dim[d]);
  put(70, std::int16_t{4});
  put(72, std::int16_t{16});
  put(108, 352.0f);
  for (std::size_t a = 0; a < 4; ++a) put(76 + 4 * a, 1.0f);
  put(254, std::int16_t{1});
  for (std::size_t a = 0; a < 3; ++a) put(280 + 20 * a, 1.0f);
  return head;
}

std::string nrrdHead(const std::string &encoding, bool listIsFirst) {
  return "NRRD0004\ntype: short\ndimension: 4\nsizes: " + std::string(listIsFirst ? "4 5 4 3" : "5 4 3 4") +
         "\nendian: little\nencoding: " + encoding + "\nspace: LPS\nspace directions: " +
         (listIsFirst ? "none (1,0,0) (0,1,0) (0,0,1)" : "(1,0,0) (0,1,0) (0,0,1) none") +
         "\nspace origin: (0,0,0)\nkinds: " +
         (listIsFirst ? "list domain domain domain" : "domain domain domain time") + "\n";
}
std::string metaHead(const std::string &more) {
  return "ObjectType = Image\nNDims = 4\nDimSize = 5 4 3 4\nElementType = MET_SHORT\nElementSpacing = 1 1 1 "
         "1\nTransformMatrix = 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\nOffset = 0 0 0 0\n" +
         more + "ElementDataFile = LOCAL\n";
}

struct Form {
  const char *name;
  std::string bytes;
  bool isInterleaved = false;
};
std::vector<Form> forms() {
  const std::string behind = shorts(false), among = shorts(true), zlib = packed(behind, 15);
  return {{"raw.nii", niftiHead() + behind},
          {"packed.nii.gz", gzip(niftiHead() + behind)},
          {"members.nii.gz", gzip(niftiHead() + behind.substr(0, 200)) + gzip(behind.substr(200))},
          {"raw.nrrd", nrrdHead("raw", false) + "\n" + behind},
          {"packed.nrrd", nrrdHead("gzip", false) + "\n" + gzip(behind)},
          {"among.nrrd", nrrdHead("raw", true) + "\n" + among, true},
          {"among_packed.nrrd", nrrdHead("gzip", true) + "\n" + gzip(among), true},
          {"raw.mha", metaHead("") + behind},
          {"packed.mha",
           metaHead("CompressedData = True\nCompressedDataSize = " + std::to_string(zlib.size()) + "\n") + zlib}};
}

ReadOptions at(std::size_t time) {
  ReadOptions options;
  options.time = time;
  return options;
}

}  // namespace

TEST_CASE("Each time point of a file can be read", "[imaging][time]") {
  const auto folder = emptyFolder("times");
  for (const Form &form : forms()) {
    CAPTURE(form.name);
    const auto file = write(folder / form.name, form.bytes);
    const auto list = listSeries(file);
    REQUIRE(list);
    CHECK(list->front().times == kTimes);
    for (std::size_t t = 0; t < kTimes; ++t) {
      const auto loaded = readVolume(file, at(t));
      if (!loaded) FAIL(loaded.error().message);
      CHECK(loaded->times == kTimes);
      CHECK(says(loaded->notices, "4 time points (0 … 3): " + std::to_string(t) + " is read"));
      CHECK_FALSE(says(loaded->notices, "cut"));
      const auto &voxels = std::get<std::vector<std::int16_t>>(loaded->volume.voxels);
      REQUIRE(voxels.size() == kVoxels);
      for (std::size_t v = 0; v < kVoxels; ++v) REQUIRE(voxels[v] == static_cast<std::int16_t>(1000 * t + v));
    }
    const auto beyond = readVolume(file, at(kTimes));
    REQUIRE_FALSE(beyond);
    CHECK_THAT(beyond.error().message, Contains("time 4 is asked for") && Contains("4 time points (0 … 3)"));
  }
  const auto one = write(folder / "one.nrrd",
                         "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 1 1\nencoding: ascii\nspace: LPS\nspace "
                         "directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\n\n1 2");
  REQUIRE(readVolume(one));
  const auto second = readVolume(one, at(1));
  REQUIRE_FALSE(second);
  CHECK_THAT(second.error().message, Contains("one time point"));
}

TEST_CASE("Time points as text are read, and what ends within them is said", "[imaging][time]") {
  std::string words;
  for (std::size_t n = 0; n < kVoxels * kTimes; ++n) words += std::to_string(1000 * (n / kVoxels) + n % kVoxels) + " ";
  const auto file = testOutputFolder() / "times.nrrd";
  write(file, nrrdHead("ascii", false) + "\n" + words);
  const auto third = readVolume(file, at(2));
  REQUIRE(third);
  CHECK(third->volume.value(1, 0, 0) == 2001.0);
  write(file, nrrdHead("ascii", false) + "\n" + words.substr(0, words.find("2000") + 30));
  const auto cut = readVolume(file, at(1));
  REQUIRE(cut);
  CHECK(says(cut->notices, "of 4 time points that its header promises the first 2 are whole"));
  CHECK_FALSE(readVolume(file, at(2)));
}

TEST_CASE("A file that is cut within its time points says how many are whole", "[imaging][time]") {
  const auto folder = emptyFolder("cut");
  const std::size_t each = kVoxels * sizeof(std::int16_t);
  for (const Form &form : forms()) {
    CAPTURE(form.name);
    const std::string name = form.name;
    const bool isPacked = name.find("packed") != std::string::npos || name.find("members") != std::string::npos;
    bool wasSaid = false;
    for (std::size_t length = form.bytes.size() - 1; length > form.bytes.size() / 3; length -= isPacked ? 1 : 7) {
      CAPTURE(length);
      const auto file = write(folder / form.name, form.bytes.substr(0, length));
      for (std::size_t t = 0; t < kTimes; ++t) {
        const auto loaded = readVolume(file, at(t));
        if (!loaded) {
          CHECK_THAT(loaded.error().message, Contains("cut") || Contains("truncated") || Contains("ends"));
          continue;
        }
        CHECK_FALSE((form.isInterleaved && !isPacked));
        // After the last voxel there is only the checksum of the compressed data.
        const bool lacksCheckSum = says(loaded->notices, "checksum");
        const bool isCut = says(loaded->notices, "is cut or damaged: of 4 time points");
        CHECK((isCut || (isPacked && lacksCheckSum) || (isPacked && length + 12 > form.bytes.size())));
        wasSaid = wasSaid || isCut;
        CHECK(loaded->volume.value(0, 0, 0) == 1000.0 * static_cast<double>(t));
      }
    }
    CHECK(wasSaid == !form.isInterleaved);
  }
  // Exact to the byte: one less than two volumes leaves one.
  const std::string whole = niftiHead() + shorts(false);
  const auto file = write(folder / "exact.nii", whole.substr(0, 352 + 2 * each - 1));
  CHECK(says(readVolume(file)->notices, "only the first is whole"));
  const auto second = readVolume(file, at(1));
  REQUIRE_FALSE(second);
  CHECK_THAT(second.error().message, Contains("of 4 time points (0 … 3) that its header promises 1 are whole"));
  CHECK(says(readVolume(write(folder / "exact.nii", whole.substr(0, 352 + 2 * each)), at(1))->notices,
             "the first 2 are whole"));
}

TEST_CASE("Real time series are read at each time", "[imaging][time]") {
  C3DE_DATA_OR_SKIP(file, "volume/nifti/example4d.nii.gz");
  const auto first = readVolume(file), second = readVolume(file, at(1));
  REQUIRE((first && second));
  CHECK(second->times == 2);
  CHECK(second->volume.voxels != first->volume.voxels);
  CHECK(sameGrid(second->volume.geometry, first->volume.geometry));
  CHECK_THAT(readVolume(file, at(2)).error().message, Contains("2 time points (0 … 1)"));
}
