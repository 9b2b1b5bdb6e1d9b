// SPDX-License-Identifier: Apache-2.0
// Damaged files return an error or report the missing part; under the preset `asan` also: no leak, no stray access.
#include <random>

#include "dicom_made.h"

using namespace images;

// GDCM 3.0.21 forgets the image of OpenJPEG (112 bytes) when the header of a JPEG 2000 stream is good and its tiles are
// not.
extern "C" const char *__lsan_default_suppressions();
extern "C" const char *__lsan_default_suppressions() { return "leak:libopenjp2\n"; }

namespace {

/// Reads a damaged copy: an error with a reason, or all undamaged voxels, or a notice that the intact file does not
/// produce.
void readDamaged(const std::filesystem::path &copy, const LoadedVolume &whole) {
  INFO(copy.string() << ", " << std::filesystem::file_size(copy) << " bytes");
  const auto loaded = readVolume(copy);
  if (!loaded) {
    CHECK(loaded.error().message.size() > copy.string().size() + 10);
    CHECK(loaded.error().code == ErrorCode::input);
    return;
  }
  const bool same =
      loaded->volume.voxels == whole.volume.voxels && sameGrid(loaded->volume.geometry, whole.volume.geometry);
  const bool said = std::any_of(loaded->notices.begin(), loaded->notices.end(),
                                [&](const std::string &notice) { return !says(whole.notices, notice); });
  CHECK((same || said));
}

/// Small files of kinds that are assembled from private headers, sequences and tables.
std::vector<std::string> hurtable() {
  using made::item;
  using made::packed;
  using test::DicomElements;
  std::vector<std::string> all;
  std::string csa("SV10\4\3\2\1", 8);
  const auto put = [&](std::uint32_t value) { csa += packed(std::vector<std::uint32_t>{value}); };
  put(2), put(77);
  for (const auto &[name, values] : {std::pair{"NumberOfImagesInMosaic", std::vector<std::string>{"7"}},
                                     {"SliceNormalVector", {"0.0", "0.0", "1.0"}}}) {
    csa += name + std::string(64 - std::strlen(name), '\0');
    put(1), csa += std::string("FD\0\0", 4), put(3), put(static_cast<std::uint32_t>(values.size())), put(77);
    for (const std::string &value : values)
      put(4), put(4), put(77), put(4), csa += value + std::string(4 - value.size(), '\0');
  }
  made::Picture mosaic(12, 15);
  mosaic.text(0x00080008, "CS", "ORIGINAL\\MOSAIC")
      .text(0x00180088, "DS", "3")
      .text(0x00290011, "LO", "SIEMENS CSA HEADER")
      .text(0x00291110, "OB", csa);
  all.push_back(mosaic.pixels(std::vector<std::uint16_t>(180, 7)).file());

  made::Picture palette(4, 4);
  palette.bits(8)
      .text(0x00280004, "CS", "PALETTE COLOR")
      .pixels(std::vector<std::uint8_t>(16, 2))
      .text(0x00080005, "CS", "ISO 2022 IR 6\\ISO 2022 IR 87");
  palette.text(0x0008103e, "LO", "\x1b$B;3ED\x1b(B");
  for (std::uint32_t c = 0; c < 3; ++c)
    palette.text(0x00281101 + c, "US", packed(std::vector<std::uint16_t>{4, 0, 16}))
        .text(0x00281201 + c, "OW", packed(std::vector<std::uint16_t>{0, 256, 512, 768}));
  all.push_back(palette.file());

  made::Picture map(3, 2);
  const std::string mapping =
      item([](DicomElements &e) { e.add(0x0040, 0x9225, "FD", packed(std::vector<double>{2.0})); });
  map.text(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.30")
      .number(0x00280100, 32)
      .text(0x7fe00008, "OF", packed(std::vector<float>(6, 1.5f)));
  all.push_back(map.sequence(0x52009229, {item([&](DicomElements &e) {
                               e.add(0x0040, 0x9096, std::vector<std::string>{mapping});
                             })})
                    .file());

  made::Picture segments(8, 4);
  std::vector<std::string> frames;
  for (const double z : {0.0, 1.0, 2.0})
    for (const std::uint16_t number : {1, 2})
      frames.push_back(item([&](DicomElements &e) {
        e.add(0x0020, 0x9113, std::vector<std::string>{item([&](DicomElements &p) {
                p.add(0x0020, 0x0032, {0.0, 0.0, z});
              })});
        e.add(0x0062, 0x000a, std::vector<std::string>{item([&](DicomElements &p) { p.add(0x0062, 0x000b, number); })});
      }));
  const std::string liver =
      item([](DicomElements &e) { e.add(0x0062, 0x0004, std::uint16_t{1}), e.add(0x0062, 0x0005, "LO", "liver"); });
  segments.bits(1)
      .text(0x00080060, "CS", "SEG")
      .text(0x00280008, "IS", "6")
      .text(0x00620001, "CS", "BINARY")
      .sequence(0x00620002, {liver})
      .sequence(0x52009230, frames);
  all.push_back(segments.text(0x7fe00010, "OB", std::string(24, '\x3c')).file());
  return all;
}

}  // namespace

TEST_CASE("Broken DICOM files are refused with a reason", "[imaging]") {
  C3DE_DATA_OR_SKIP(folder, "dicom/broken");
  std::size_t files = 0;
  for (const auto &file : filesOf(folder)) {
    INFO(file.string());
    const auto loaded = readVolume(file);
    REQUIRE_FALSE(loaded);
    CHECK_THAT(loaded.error().message, Contains(file.filename().string()));
    CHECK(loaded.error().message.size() > file.string().size() + 10);
    CHECK_FALSE(readLabelMap(file));
    ++files;
  }
  CHECK(files == 11);
  const auto truncated = readVolume(folder / "MR_truncated.dcm");
  REQUIRE_FALSE(truncated);
  CHECK_THAT(truncated.error().message, Contains("truncated: 8130 of 8192 bytes"));
}

TEST_CASE("Copies of good files cut at fifty lengths never pass for the whole", "[imaging]") {
  struct Good {
    const char *file, *as;
  };
  std::mt19937 random(20261121);
  for (const Good &good :
       {Good{"volume/nifti/standard.nii.gz", "cut.nii.gz"}, Good{"volume/nifti/anatomical.nii", "cut.nii"},
        Good{"volume/nifti/example_nifti2.nii.gz", "cut2.nii.gz"}, Good{"volume/nrrd/breast1_label.nrrd", "cut.nrrd"},
        Good{"volume/nrrd/prostate_phantom_subvolume.nrrd", "cut2.nrrd"},
        Good{"dicom/pydicom_single/CT_small.dcm", "cut.dcm"},
        Good{"dicom/mr_same_volume_5_encodings/compressed_j2k/IM-0001-0001-0001.dcm", "cut.dcm"},
        Good{"dicom/mr_same_volume_5_encodings/compressed_jpeg/IM-0001-0001-0001.dcm", "cut.dcm"},
        Good{"dicom/mr_same_volume_5_encodings/compressed_jpegls/IM-0001-0001-0001.dcm", "cut.dcm"},
        Good{"dicom/mr_same_volume_5_encodings/compressed_rle/IM-0001-0001-0001.dcm", "cut.dcm"},
        Good{"dicom/pydicom_single/image_dfl.dcm", "cut.dcm"}, Good{"dicom/pydicom_single/JPGExtended.dcm", "cut.dcm"},
        Good{"dicom/pydicom_single/rtdose.dcm", "cut.dcm"}, Good{"dicom/seg_tiny_nonsquare/mf.dcm", "cut.dcm"},
        Good{"dicom/seg_tiny_nonsquare/label.seg", "cut.seg"},
        Good{"dicom/pydicom_single/SC_rgb_rle_2frame.dcm", "cut.dcm"},
        Good{"dicom/pydicom_single/examples_jpeg2k.dcm", "cut.dcm"}, Good{"found/siemens_mosaic.dcm", "cut.dcm"}}) {
    C3DE_DATA_OR_SKIP(path, good.file);
    const std::string bytes = bytesOf(path);
    const auto folder = emptyFolder("cut");
    const auto whole = readVolume(write(folder / good.as, bytes));
    REQUIRE(whole);
    for (int cut = 0; cut < 50; ++cut)
      readDamaged(write(folder / good.as,
                        bytes.substr(0, std::uniform_int_distribution<std::size_t>(0, bytes.size() - 1)(random))),
                  *whole);
  }
}

TEST_CASE("Detached voxels cut at fifty lengths never pass for the whole", "[imaging]") {
  C3DE_DATA_OR_SKIP(data, "volume/nrrd_mhd_detached");
  std::mt19937 random(7);
  for (const auto &[header, voxels] :
       {std::pair{"BrainProtonDensitySliceBorder20.mhd", "BrainProtonDensitySliceBorder20.raw"},
        {"BrainProtonDensitySliceBorder20.nhdr", "BrainProtonDensitySliceBorder20.raw"},
        {"BrainProtonDensitySliceShifted13x17yDirectionPlus30.mhd",
         "BrainProtonDensitySliceShifted13x17yDirectionPlus30.zraw"}}) {
    const auto folder = emptyFolder("detached");
    copyFile(data / header, folder / header);
    const std::string bytes = bytesOf(data / voxels);
    write(folder / voxels, bytes);
    const auto whole = readVolume(folder / header);
    REQUIRE(whole);
    for (int cut = 0; cut < 50; ++cut) {
      write(folder / voxels, bytes.substr(0, std::uniform_int_distribution<std::size_t>(0, bytes.size() - 1)(random)));
      readDamaged(folder / header, *whole);
    }
  }
}

TEST_CASE("Headers with bytes changed give an error or an image that is whole in itself", "[imaging]") {
  std::mt19937 random(11);
  for (const auto &[file, as] : {std::pair{"volume/nifti/standard.nii.gz", "hurt.nii.gz"},
                                 {"volume/nifti/anatomical.nii", "hurt.nii"},
                                 {"volume/nrrd/breast1_label.nrrd", "hurt.nrrd"},
                                 {"volume/nrrd/avf_float_32.nrrd", "hurt.nrrd"},
                                 {"volume/nrrd_mhd_detached/BrainProtonDensitySliceBorder20.mhd", "hurt.mhd"},
                                 {"volume/nrrd_mhd_detached/BrainProtonDensitySliceBorder20.nhdr", "hurt.nhdr"},
                                 {"volume/nrrd_mhd_detached/BrainProtonDensity3Slices.mha", "hurt.mha"},
                                 {"dicom/pydicom_single/CT_small.dcm", "hurt.dcm"},
                                 {"dicom/seg_tiny_nonsquare/mf.dcm", "hurt.dcm"},
                                 {"dicom/pydicom_single/MR_small_bigendian.dcm", "hurt.dcm"},
                                 {"dicom/pydicom_single/image_dfl.dcm", "hurt.dcm"},
                                 {"dicom/pydicom_single/SC_rgb_rle_2frame.dcm", "hurt.dcm"},
                                 {"dicom/seg_tiny_nonsquare/label.seg", "hurt.seg"}}) {
    C3DE_DATA_OR_SKIP(path, file);
    const std::string bytes = bytesOf(path);
    const auto folder = emptyFolder("hurt");
    for (const char *voxels : {"BrainProtonDensitySliceBorder20.raw", "BrainProtonDensitySliceBorder20.zraw",
                               "BrainProtonDensity3Slices.raw"})
      if (std::string(file).find("detached") != std::string::npos)
        copyFile(path.parent_path() / voxels, folder / voxels);
    REQUIRE(readVolume(write(folder / as, bytes)));
    ReadOptions options;
    options.memoryLimit = 64u << 20;  // the size claimed by a header is not allocated
    for (int n = 0; n < 100; ++n) {
      std::string hurt = bytes;
      const std::size_t reach = std::min<std::size_t>(hurt.size(), 600);
      for (int changes = 0; changes <= n % 3; ++changes)
        hurt[std::uniform_int_distribution<std::size_t>(0, reach - 1)(random)] = static_cast<char>(random());
      const auto loaded = readVolume(write(folder / as, hurt), options);
      CAPTURE(file, n);
      if (!loaded) {
        CHECK_FALSE(loaded.error().message.empty());
        continue;
      }
      const VolumeGeometry &g = loaded->volume.geometry;
      CHECK(std::visit([](const auto &all) { return all.size(); }, loaded->volume.voxels) == g.voxelCount());
      CHECK(std::all_of(g.indexToWorld.begin(), g.indexToWorld.end(), [](double x) { return std::isfinite(x); }));
      CHECK((g.voxelVolume() > 0.0 && std::isfinite(g.voxelVolume())));
      CHECK((std::isfinite(loaded->volume.slope) && std::isfinite(loaded->volume.intercept)));
    }
  }
}

TEST_CASE("Colours, layers and time points with bytes changed or cut give an error or what is whole in itself",
          "[imaging]") {
  std::mt19937 random(19);
  std::string voxels(6 * 5 * 4 * 4, '\0');
  for (char &voxel : voxels) voxel = static_cast<char>(random() % 3);
  const std::string space = "space: LPS\nspace origin: (0,0,0)\nencoding: raw\n",
                    meta = "ObjectType = Image\nElementType = MET_UCHAR\nElementSpacing = 1 1 1 1\n";
  for (const auto &[as, head] :
       {std::pair{std::string("colours.nrrd"),
                  "NRRD0004\ntype: uchar\ndimension: 4\nsizes: 4 6 5 4\n" + space +
                      "space directions: none (1,0,0) (0,1,0) (0,0,1)\nkinds: RGBA-color domain domain domain\n\n"},
        {"layers.seg.nrrd", "NRRD0004\ntype: uchar\ndimension: 4\nsizes: 4 6 5 4\n" + space +
                                "space directions: none (1,0,0) (0,1,0) (0,0,1)\nkinds: list domain domain domain\n"
                                "Segment0_Layer:=0\nSegment0_LabelValue:=1\nSegment0_Name:=a\nSegment1_Layer:="
                                "3\nSegment1_LabelValue:=2\nSegment1_Name:=b\n\n"},
        {"times.nrrd", "NRRD0004\ntype: uchar\ndimension: 4\nsizes: 6 5 4 4\n" + space +
                           "space directions: (1,0,0) (0,1,0) (0,0,1) none\nkinds: domain domain domain time\n\n"},
        {"colours.mha",
         meta + "NDims = 3\nDimSize = 6 5 4\nElementNumberOfChannels = 4\nOffset = 0 0 0\nElementDataFile = LOCAL\n"},
        {"times.mha", meta + "NDims = 4\nDimSize = 6 5 4 4\nOffset = 0 0 0 0\nElementDataFile = LOCAL\n"}}) {
    const std::string bytes = head + voxels;
    const auto folder = emptyFolder("new");
    REQUIRE(readVolume(write(folder / as, bytes)));
    ReadOptions options;
    options.memoryLimit = 64u << 20;
    for (int n = 0; n < 300; ++n) {
      std::string hurt =
          n % 4 == 0 ? bytes.substr(0, std::uniform_int_distribution<std::size_t>(0, bytes.size() - 1)(random)) : bytes;
      for (int changes = 0; changes <= n % 3 && !hurt.empty(); ++changes)
        hurt[std::uniform_int_distribution<std::size_t>(0, std::min(head.size(), hurt.size()) - 1)(random)] =
            static_cast<char>(random());
      CAPTURE(as, n);
      options.time = static_cast<std::size_t>(n % 5);
      const auto file = write(folder / as, hurt);
      const auto loaded = readVolume(file, options);
      if (loaded) {
        const std::size_t count = loaded->volume.geometry.voxelCount();
        CHECK(std::visit([](const auto &all) { return all.size(); }, loaded->volume.voxels) == count);
        CHECK((loaded->volume.colours.empty() || loaded->volume.colours.size() == count));
        CHECK(options.time < std::max<std::size_t>(loaded->times, 1));
      } else {
        CHECK_FALSE(loaded.error().message.empty());
      }
      options.time = 0;
      const auto labels = readLabelMap(file, options);
      if (!labels) continue;
      for (const LabelMap &layer : labels->layers) CHECK(layer.voxels.size() == labels->labels.voxels.size());
    }
  }
}

TEST_CASE("Compressed pixels with bytes changed crash no decoder", "[imaging]") {
  std::mt19937 random(13);
  for (const char *encoding : {"compressed_j2k", "compressed_jpeg", "compressed_jpegls", "compressed_rle"}) {
    C3DE_DATA_OR_SKIP(path, std::string("dicom/mr_same_volume_5_encodings/") + encoding + "/IM-0001-0001-0001.dcm");
    const std::string bytes = bytesOf(path);
    const auto folder = emptyFolder("hurt");
    for (int n = 0; n < 60; ++n) {
      std::string hurt = bytes;
      for (int changes = 0; changes < 3; ++changes)  // half of them where the stream describes itself
        hurt[std::uniform_int_distribution<std::size_t>(1100, n % 2 == 0 ? 1500 : hurt.size() - 1)(random)] =
            static_cast<char>(random());
      const auto loaded = readVolume(write(folder / "hurt.dcm", hurt));
      CHECK((loaded || !loaded.error().message.empty()));
    }
  }
}

TEST_CASE(
    "Mosaics, segmentations, palettes and maps with bytes changed anywhere crash nothing and take no memory they do "
    "not need",
    "[imaging]") {
  std::mt19937 random(17);
  const auto folder = emptyFolder("hurt");
  ReadOptions options;
  options.memoryLimit = 64u << 20;
  std::size_t readAll = 0;
  for (const std::string &bytes : hurtable()) {
    REQUIRE(readVolume(write(folder / "hurt.dcm", bytes)));
    for (int n = 0; n < 400; ++n) {
      std::string hurt = bytes;
      for (int changes = 0; changes <= n % 4; ++changes)
        hurt[std::uniform_int_distribution<std::size_t>(132, hurt.size() - 1)(random)] = static_cast<char>(random());
      if (n % 5 == 4) hurt.resize(std::uniform_int_distribution<std::size_t>(132, hurt.size())(random));
      const auto path = write(folder / "hurt.dcm", hurt);
      const auto volume = readVolume(path, options);
      CHECK((volume || !volume.error().message.empty()));
      if (volume)
        CHECK(std::visit([](const auto &all) { return all.size(); }, volume->volume.voxels) ==
              volume->volume.geometry.voxelCount());
      const auto labels = readLabelMap(path, options);
      CHECK((labels || !labels.error().message.empty()));
      readAll += volume ? 1 : 0;
    }
  }
  CHECK(readAll > 100);  // most changes are in pixels and names
}

TEST_CASE("Colours of JPEG 2000 with bytes changed crash no decoder", "[imaging]") {
  C3DE_DATA_OR_SKIP(path, "dicom/pydicom_single/examples_jpeg2k.dcm");
  const std::string bytes = bytesOf(path);
  std::mt19937 random(19);
  const auto folder = emptyFolder("hurt");
  const std::size_t stream = bytes.find("\xff\x4f\xff\x51");
  REQUIRE(stream != std::string::npos);
  for (int n = 0; n < 60; ++n) {
    std::string hurt = bytes;
    for (int changes = 0; changes < 3; ++changes)
      hurt[std::uniform_int_distribution<std::size_t>(stream, n % 2 == 0 ? stream + 150 : hurt.size() - 1)(random)] =
          static_cast<char>(random());
    const auto loaded = readVolume(write(folder / "hurt.dcm", hurt));
    CHECK((loaded || !loaded.error().message.empty()));
  }
}

TEST_CASE("JPEG frames with damaged headers are refused where their decoder would end the program", "[imaging]") {
  C3DE_DATA_OR_SKIP(path, "dicom/mr_same_volume_5_encodings/compressed_jpeg/IM-0001-0001-0001.dcm");
  const std::string bytes = bytesOf(path);
  const std::size_t frame = bytes.find("\xff\xd8\xff\xc3");
  REQUIRE(frame != std::string::npos);
  const std::size_t tables = bytes.find("\xff\xc4", frame), scan = bytes.find("\xff\xda", frame);
  REQUIRE((tables < scan && scan < frame + 100));
  const auto folder = emptyFolder("hurt");
  for (const std::size_t marker : {frame, frame + 2, tables, scan})
    for (const char byte : {'\x90', '\0'}) {
      std::string hurt = bytes;
      hurt[marker] = byte;
      CAPTURE(marker);
      const auto loaded = readVolume(write(folder / "hurt.dcm", hurt));
      REQUIRE_FALSE(loaded);
      CHECK_THAT(loaded.error().message, Contains("compressed pixels"));
    }
  std::string hurt = bytes;
  hurt[frame + 6] = 17;  // bits of a value
  const auto loaded = readVolume(write(folder / "hurt.dcm", hurt));
  REQUIRE_FALSE(loaded);
  CHECK_THAT(loaded.error().message, Contains("compressed pixels"));
}

TEST_CASE("A slice that is truncated is left out of its series and said", "[imaging]") {
  C3DE_DATA_OR_SKIP(data, "dicom/ct_head_phantom_philips_5mm");
  const auto folder = emptyFolder("series");
  for (const char *name : {"I10", "I20", "I30", "I40", "I50"}) copyFile(data / name, folder / name);
  write(folder / "I30", bytesOf(data / "I30").substr(0, 300000));
  const auto loaded = readVolume(folder);
  REQUIRE(loaded);
  CHECK(loaded->volume.geometry.size[2] == 5);
  CHECK(says(loaded->notices, "1 slices are missing"));
  CHECK(says(loaded->notices, "cannot be read as a volume"));
}
