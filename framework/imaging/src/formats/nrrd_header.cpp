// SPDX-License-Identifier: Apache-2.0
// NRRD 1 to 5 (teem.sourceforge.net/nrrd/format.html), attached and detached.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>

#include "c3de/core/input_file.h"
#include "c3de/core/text.h"
#include "formats/image_header.h"

namespace c3de::imaging {
namespace {

struct Parsed {
  std::map<std::string, std::string> fields;  ///< names in lower case
  std::vector<std::pair<std::string, std::string>> keys;
  std::vector<std::string> list;  ///< file names after `data file: LIST`
  std::vector<std::string> notices;
  std::uint64_t dataOffset = 0;  ///< after the empty line that ends the header; 0: none

  /// Empty if it is missing.
  [[nodiscard]] std::string field(const std::string &name) const {
    const auto found = fields.find(name);
    return found == fields.end() ? std::string() : found->second;
  }
};

/// The fields of the format, version 5, as spelled here, and the alternative spellings that other readers accept.
const std::vector<std::string> kFields{
    "content",   "number",          "type",        "block size",   "dimension",        "sizes",
    "spacings",  "thicknesses",     "axis mins",   "axis maxs",    "centerings",       "labels",
    "units",     "kinds",           "min",         "max",          "old min",          "old max",
    "data file", "endian",          "encoding",    "line skip",    "byte skip",        "sample units",
    "space",     "space dimension", "space units", "space origin", "space directions", "measurement frame"};

std::string fieldOf(const std::string &name) {
  for (const auto &[other, field] : {std::pair{"datafile", "data file"},
                                     {"lineskip", "line skip"},
                                     {"byteskip", "byte skip"},
                                     {"blocksize", "block size"},
                                     {"axismins", "axis mins"},
                                     {"axismaxs", "axis maxs"},
                                     {"oldmin", "old min"},
                                     {"oldmax", "old max"},
                                     {"centers", "centerings"},
                                     {"sampleunits", "sample units"}})
    if (name == other) return field;
  return name;
}

bool isField(const std::string &name) { return std::find(kFields.begin(), kFields.end(), name) != kFields.end(); }

Expected<Parsed> parse(const std::filesystem::path &path) {
  auto opened = openInputFile(path);
  if (!opened) return tl::unexpected(opened.error());
  std::ifstream &file = *opened;
  std::string line;
  const auto next = [&] {
    line.clear();
    int c = EOF;
    while (line.size() < (1u << 22) && (c = file.get()) != EOF && c != '\n') line += static_cast<char>(c);
    if (!line.empty() && line.back() == '\r') line.pop_back();
    return c != EOF || !line.empty();
  };
  if (!next() || !line.starts_with("NRRD000")) return refuse(path, "no NRRD header: it does not begin with NRRD000…");
  Parsed out;
  while (next()) {
    if (line.empty()) {
      out.dataOffset = static_cast<std::uint64_t>(file.tellg());
      return out;
    }
    if (line.front() == '#') continue;
    const std::size_t colon = line.find(':');
    if (colon == std::string::npos)
      return refuse(path, "its header has the line '" + line.substr(0, 40) + "', which is no field");
    if (colon + 1 < line.size() && line[colon + 1] == '=') {
      out.keys.emplace_back(line.substr(0, colon), line.substr(colon + 2));
      if (const std::string name = fieldOf(lowerCase(trimmed(line.substr(0, colon)))); isField(name))
        out.notices.push_back(
            "'" + name + ":=' is a key/value pair, which does not describe the image; the field is '" + name + ": '.");
      continue;
    }
    const std::string written = trimmed(line.substr(0, colon)), name = fieldOf(lowerCase(written));
    if (!isField(name)) {
      const std::string nearest = nearestName(name, kFields);
      return refuse(path, "its header has the field '" + written.substr(0, 40) + "', which NRRD does not know" +
                              (nearest.empty() ? "" : "; did you mean '" + nearest + "'?") +
                              "; accepted: fields of the format, and 'key:=value' for what is one's own");
    }
    const std::string value = trimmed(line.substr(colon + 1));
    if (!out.fields.emplace(name, value).second) return refuse(path, "its header has the field '" + name + "' twice");
    if (name == "data file" && value.starts_with("LIST")) {
      while (next() && !line.empty() && out.list.size() < 100000) out.list.push_back(trimmed(line));
      return out;
    }
  }
  return out;
}

Expected<Scalar> scalarOf(const std::filesystem::path &path, const std::string &type) {
  struct Named {
    Scalar scalar;
    std::vector<const char *> names;
  };
  static const std::vector<Named> kTypes{
      {Scalar::i8, {"signed char", "int8", "int8_t"}},
      {Scalar::u8, {"uchar", "unsigned char", "uint8", "uint8_t"}},
      {Scalar::i16, {"short", "short int", "signed short", "signed short int", "int16", "int16_t"}},
      {Scalar::u16, {"ushort", "unsigned short", "unsigned short int", "uint16", "uint16_t"}},
      {Scalar::i32, {"int", "signed int", "int32", "int32_t"}},
      {Scalar::u32, {"uint", "unsigned int", "uint32", "uint32_t"}},
      {Scalar::i64,
       {"longlong", "long long", "long long int", "signed long long", "signed long long int", "int64", "int64_t"}},
      {Scalar::u64, {"ulonglong", "unsigned long long", "unsigned long long int", "uint64", "uint64_t"}},
      {Scalar::f32, {"float"}},
      {Scalar::f64, {"double"}}};
  for (const Named &known : kTypes)
    for (const char *name : known.names)
      if (type == name) return known.scalar;
  return refuse(path, type.empty()
                          ? "the header gives no type"
                          : "its type '" + type + "' is not read; integers of 8 to 64 bits, float and double are");
}

std::vector<std::string> words(const std::string &text) {
  std::vector<std::string> all;
  std::string word;
  for (const char c : text + " ") {
    if (c != ' ' && c != '\t') {
      word += c;
    } else if (!word.empty()) {
      all.push_back(lowerCase(word));
      word.clear();
    }
  }
  return all;
}

/// "(1,0,0) none (0,1,0)": an empty vector for none.
std::vector<std::vector<double>> vectorsIn(const std::string &text) {
  std::vector<std::vector<double>> all;
  for (std::size_t at = 0; at < text.size();) {
    if (text[at] == '(') {
      const std::size_t end = std::min(text.find(')', at), text.size());
      all.push_back(numbersIn(text.substr(at, end - at)));
      at = end + 1;
    } else if (text[at] == 'n') {
      all.emplace_back();
      at += 4;
    } else {
      ++at;
    }
  }
  return all;
}

/// Factors that convert coordinates of the named space to LPS.
Vec3 toLps(const std::string &space, std::vector<std::string> &notices) {
  const std::string s = lowerCase(space);
  if (s.starts_with("left-posterior-superior") || s == "lps" || s == "lpst") return {1, 1, 1};
  if (s.starts_with("right-anterior-superior") || s == "ras" || s == "rast") return {-1, -1, 1};
  if (s.starts_with("left-anterior-superior") || s == "las" || s == "last") return {1, -1, 1};
  notices.push_back(s.empty() ? "The header does not name its space: left, posterior, superior is taken."
                              : "The space of the header, '" + space +
                                    "', is not that of a patient: left, posterior, superior is taken.");
  return {1, 1, 1};
}

/// Words, each in quotes or not; "" is an empty one.
std::vector<std::string> quotedWords(const std::string &text) {
  std::vector<std::string> all;
  for (std::size_t at = 0; (at = text.find_first_not_of(" \t", at)) != std::string::npos;) {
    const bool isQuoted = text[at] == '"';
    const std::size_t from = at + (isQuoted ? 1 : 0);
    const std::size_t end = std::min(text.find_first_of(isQuoted ? "\"" : " \t", from), text.size());
    all.push_back(trimmed(text.substr(from, end - from)));
    at = end + (isQuoted ? 1 : 0);
  }
  return all;
}

/// Millimetres per unit; 1 for an unknown unit, with a notice.
std::vector<double> millimetresOfAll(const std::vector<std::string> &units, std::vector<std::string> &notices) {
  std::vector<double> all;
  for (const std::string &unit : units) {
    const auto known = millimetresOf(unit);
    all.push_back(known.value_or(1.0));
    std::string notice = "The unit '" + unit.substr(0, 40) + "' of the header is no length that is known: mm is taken.";
    if (!known && !unit.empty() && std::find(notices.begin(), notices.end(), notice) == notices.end())
      notices.push_back(std::move(notice));
  }
  return all;
}

bool isOneOf(const std::string &kind, std::initializer_list<const char *> kinds) {
  return std::any_of(kinds.begin(), kinds.end(), [&](const char *one) { return kind == one; });
}

/// Whether this many adjacent values are a colour: by their kind, or as 8 bits each, which no other vector has.
bool isColour(Scalar scalar, double size, const std::string &kind) {
  if (size != 3.0 && size != 4.0) return false;
  if (isOneOf(kind, {"rgb-color", "rgba-color", "3-color", "4-color"}))
    return scalar == Scalar::u8 || scalar == Scalar::u16;
  return scalar == Scalar::u8 && isOneOf(kind, {"", "vector", "3-vector", "4-vector"});
}

bool isOfSpace(const std::string &kind) { return isOneOf(kind, {"", "domain", "space", "???", "none"}); }

/// The file's axes in space; the others count channels of a colour, or volumes. Axes of a kind other than space are
/// excluded, and so are axes with NaN spacing where other spacings are numbers.
Expected<std::vector<std::size_t>> spatialAxes(ImageHeader &header, const std::vector<double> &sizes,
                                               const std::vector<std::vector<double>> &directions,
                                               const std::vector<std::string> &kinds,
                                               const std::vector<double> &spacings) {
  for (const auto &[name, count] :
       {std::pair{"kinds", kinds.size()}, {"spacings", spacings.size()}, {"space directions", directions.size()}})
    if (count != 0 && count != sizes.size())
      return refuse(header.path, "its " + std::string(name) + " has " + std::to_string(count) + " entries for " +
                                     std::to_string(sizes.size()) + " axes");
  const auto spaced = std::count_if(spacings.begin(), spacings.end(), [](double x) { return std::isfinite(x); });
  if (directions.empty() && kinds.empty() && static_cast<std::size_t>(spaced) == spacings.size() &&
      (sizes.size() > 3 || sizes[0] <= 4.0))
    header.notices.push_back("The header does not say which of its " + std::to_string(sizes.size()) +
                             " axes lie in space (kinds): the first are taken.");
  std::vector<std::size_t> axes;
  for (std::size_t a = 0; a < sizes.size(); ++a) {
    if (!(sizes[a] >= 1.0 && sizes[a] < 1e9))
      return refuse(header.path, "the header says " + formatNumber(sizes[a]) + " along axis " + std::to_string(a + 1));
    const std::string kind = a < kinds.size() ? kinds[a] : "";
    const bool isPlaced = directions.empty() ? !(a < spacings.size() && std::isnan(spacings[a]) &&
                                                 (spaced >= 3 || (a == 0 && spaced == 2)))
                                             : !directions[a].empty();
    const bool inSpace = isOfSpace(kind) && isPlaced;
    if (!isOfSpace(kind) && !directions.empty() && isPlaced)
      header.notices.push_back("Axis " + std::to_string(a + 1) + " has a direction in space and is of kind '" + kind +
                               "', which is not a spatial axis: its direction is ignored.");
    if (inSpace && axes.size() < 3) {
      axes.push_back(a);
      continue;
    }
    if (sizes[a] == 1.0) continue;
    if (a == 0 && isColour(header.scalar, sizes[a], kind)) {
      header.channels = static_cast<std::size_t>(sizes[a]);
      continue;
    }
    const bool isBehind = axes.size() >= std::min<std::size_t>(3, sizes.size() - 1);
    const bool countsVolumes = isOneOf(kind, {"time", "list"}) || (isBehind && isOfSpace(kind));
    if (!countsVolumes)
      return refuse(header.path,
                    "holds " + formatNumber(sizes[a]) + " numbers per voxel (axis " + std::to_string(a + 1) +
                        (kind.empty() ? "" : ", '" + kind + "'") +
                        "): a vector image; read are images of one number per voxel, of 3 or 4 colours of 8 or 16 bits "
                        "(first axis, kind RGB-color or RGBA-color), and time points (kind time or list)");
    const bool isFirst = axes.empty() && header.channels == 1;
    if (!isBehind && !isFirst)
      return refuse(header.path, "has its time points between the axes of space (axis " + std::to_string(a + 1) +
                                     "); they are read as the first or the last axis");
    if (header.volumes > 1 && (isFirst || header.interleaved))
      return refuse(header.path, "has several axes of time points; one, the first or the last, is read");
    header.interleaved = isFirst;
    header.volumes *= static_cast<std::size_t>(sizes[a]);
    if (header.volumes > 1000000) return refuse(header.path, "the header says more than a million volumes");
  }
  return axes;
}

bool isTimed(const std::string &space) {
  const std::string s = lowerCase(space);
  return s.ends_with("-time") || s == "last" || s == "rast" || s == "lpst";
}

/// Millimetres per unit: along the axes of space where there are directions, otherwise along the spatial axes of the
/// image.
Expected<Vec3> unitsOf(ImageHeader &header, const Parsed &parsed, const std::vector<std::size_t> &axes,
                       bool hasDirections) {
  const auto ofSpace = quotedWords(parsed.field("space units")), ofAxes = quotedWords(parsed.field("units"));
  const auto space_mm = millimetresOfAll(ofSpace, header.notices);
  std::vector<std::string> spatial;
  for (const std::size_t a : axes) spatial.push_back(a < ofAxes.size() ? ofAxes[a] : "");
  const auto axes_mm = millimetresOfAll(spatial, header.notices);
  Vec3 units{1.0, 1.0, 1.0};
  if (!ofSpace.empty()) {
    std::copy_n(space_mm.begin(), std::min<std::size_t>(3, space_mm.size()), units.begin());
  } else if (!hasDirections) {
    std::copy_n(axes_mm.begin(), std::min<std::size_t>(3, axes_mm.size()), units.begin());
  } else if (!axes_mm.empty()) {
    if (std::any_of(axes_mm.begin(), axes_mm.end(), [&](double x) { return x != axes_mm[0]; }))
      return refuse(header.path,
                    "its axes have different units, which its space directions cannot have; accepted: "
                    "'space units'");
    units = {axes_mm[0], axes_mm[0], axes_mm[0]};
    if (axes_mm[0] != 1.0)
      header.notices.push_back("The header gives the unit '" + spatial[0] +
                               "' for axes, none for space: it is taken for directions and origin.");
  }
  return units;
}

Expected<void> place(ImageHeader &header, const Parsed &parsed, const std::vector<double> &sizes) {
  const auto directions = vectorsIn(parsed.field("space directions"));
  const auto spacings = numbersIn(parsed.field("spacings"));
  if (hasDecimalComma(parsed.field("spacings"))) header.notices.emplace_back(kDecimalCommaNotice);
  const auto axes = spatialAxes(header, sizes, directions, words(parsed.field("kinds")), spacings);
  if (!axes) return tl::unexpected(axes.error());
  std::vector<double> inSpace;
  for (const std::size_t a : *axes) inSpace.push_back(sizes[a]);
  if (const auto set = setSize(header, inSpace); !set) return set;
  const Vec3 sign = toLps(parsed.field("space"), header.notices);
  const auto units = unitsOf(header, parsed, *axes, !directions.empty());
  if (!units) return tl::unexpected(units.error());

  std::array<Vec3, 3> column{};
  if (directions.empty())
    header.notices.push_back(
        "The header does not state the orientation of the image in the patient: only its spacing is known.");
  for (std::size_t a = 0; a < 3; ++a) {
    column[a][a] = 1.0;
    if (a >= axes->size()) {
      header.notices.push_back("The image is a single slice without a thickness: 1 mm is taken.");
      if (a == 2 && !directions.empty()) {  // along the normal of the slice
        const Vec3 normal = cross(column[0], column[1]);
        if (norm(normal) > 0.0) column[2] = (1.0 / norm(normal)) * normal;
      }
      continue;
    }
    const std::size_t axis = (*axes)[a];
    if (!directions.empty()) {
      column[a] = Vec3{};
      for (std::size_t x = 0; x < 3 && x < directions[axis].size(); ++x)
        column[a][x] = sign[x] * directions[axis][x] * (*units)[x];
    } else if (axis < spacings.size() && std::isfinite(spacings[axis]) && spacings[axis] != 0.0) {
      column[a][a] = sign[a] * spacings[axis] * (*units)[a];
    } else {
      header.notices.push_back("The header gives no spacing along axis " + std::to_string(a + 1) + ": 1 mm is taken.");
      column[a][a] = sign[a];
    }
  }
  const auto origins = vectorsIn(parsed.field("space origin"));
  Vec3 origin{};
  if (!directions.empty() && origins.empty())
    header.notices.push_back(
        "The header does not state the position of the first voxel (space origin): 0, 0, 0 is assumed.");
  const std::size_t most = isTimed(parsed.field("space")) ? 4 : 3;
  for (const auto &direction : directions)
    if (direction.size() > most)
      return refuse(header.path, "a vector of its space directions has " + std::to_string(direction.size()) +
                                     " numbers; accepted are " + std::to_string(most) +
                                     ", with a decimal point (a decimal comma separates numbers)");
  for (const auto &direction : directions)
    if (!origins.empty() && !direction.empty() && direction.size() != origins[0].size())
      return refuse(header.path, "its space origin has " + std::to_string(origins[0].size()) +
                                     " numbers, its space directions have " + std::to_string(direction.size()));
  if (!origins.empty())
    for (std::size_t x = 0; x < 3 && x < origins[0].size(); ++x) origin[x] = sign[x] * origins[0][x] * (*units)[x];
  return setAffine(header, column[0], column[1], column[2], origin);
}

/// Where the voxels of a file begin after this many lines.
Expected<std::uint64_t> afterLines(const std::filesystem::path &path, std::uint64_t offset, double lines) {
  auto opened = openInputFile(path);
  if (!opened) return tl::unexpected(opened.error());
  std::ifstream &file = *opened;
  file.seekg(static_cast<std::streamoff>(offset));
  for (double n = 0.0; n < lines; n += 1.0) {
    int c = EOF;
    while ((c = file.get()) != EOF && c != '\n') ++offset;
    if (c == EOF) return refuse(path, "has fewer lines than the header says to leave out");
    ++offset;
  }
  return offset;
}

Expected<void> readEncoding(ImageHeader &header, const Parsed &parsed) {
  const std::string encoding = lowerCase(parsed.field("encoding"));
  using Encoding = ImageHeader::Encoding;
  if (encoding == "raw")
    header.encoding = Encoding::raw;
  else if (encoding == "gzip" || encoding == "gz")
    header.encoding = Encoding::deflated;
  else if (encoding == "text" || encoding == "txt" || encoding == "ascii")
    header.encoding = Encoding::text;
  else if (encoding == "hex")
    header.encoding = Encoding::hex;
  else
    return refuse(header.path, "its encoding '" + encoding + "' is not read; raw, gzip, text and hex are");
  header.bigEndian = lowerCase(parsed.field("endian")) == "big";
  if (header.encoding == Encoding::raw || header.encoding == Encoding::deflated)
    if (bytesOf(header.scalar) > 1 && parsed.field("endian").empty())
      return refuse(header.path, "the header does not say the byte order (endian)");
  return {};
}

/// The file itself, or the files in "data file": one, a list, or a numbered pattern `name%03d.raw first last step`.
Expected<void> findParts(ImageHeader &header, const Parsed &parsed) {
  const std::string named = parsed.field("data file");
  std::vector<std::string> names;
  if (named.starts_with("LIST")) {
    names = parsed.list;
  } else if (named.find('%') != std::string::npos) {
    const std::size_t blank = named.find(' ', named.find('%'));
    names = numberedNames(named.substr(0, blank),
                          blank == std::string::npos ? std::vector<double>{} : numbersIn(named.substr(blank)));
    if (names.empty()) return refuse(header.path, "data file: " + named + " is no pattern with first, last and step");
  } else if (!named.empty()) {
    names = {named};
  }
  if (named.empty()) {
    if (parsed.dataOffset == 0) return refuse(header.path, "ends with its header: there are no voxels");
    header.parts = {{header.path, parsed.dataOffset}};
  }
  for (const std::string &name : names) header.parts.push_back({namedFile(header.path.parent_path(), name), 0});
  if (header.parts.empty()) return refuse(header.path, "names no file with voxels");
  return {};
}

/// "line skip" and "byte skip": where the voxels of each part begin.
Expected<void> skip(ImageHeader &header, const Parsed &parsed) {
  const auto numberOf = [&](const char *name) {
    const auto all = numbersIn(parsed.field(name));
    return all.empty() ? 0.0 : all[0];
  };
  const double lines = numberOf("line skip"), bytes = numberOf("byte skip");
  if (!(lines >= 0.0 && lines < 1e6) || !(bytes >= -1.0 && bytes < 1e12))
    return refuse(header.path, "its line skip or byte skip is out of range");
  for (ImageHeader::Part &part : header.parts) {
    if (lines > 0.0) {
      const auto at = afterLines(part.path, part.offset, lines);
      if (!at) return tl::unexpected(at.error());
      part.offset = *at;
    }
    if (header.encoding == ImageHeader::Encoding::deflated) {
      if (bytes < 0.0) return refuse(header.path, "a byte skip of -1 cannot be combined with compressed voxels");
      header.skip = static_cast<std::uint64_t>(bytes);
    } else if (bytes < 0.0) {  // -1: the voxels are at the end of the file
      std::error_code code;
      const auto length = static_cast<double>(std::filesystem::file_size(part.path, code));
      const double need = bytesOfAll(header) / static_cast<double>(header.parts.size());
      if (code || length < need) return refuse(part.path, "does not hold the voxels that the header says");
      part.offset = static_cast<std::uint64_t>(length - need);
    } else {
      part.offset += static_cast<std::uint64_t>(bytes);
    }
  }
  return {};
}

Expected<void> findData(ImageHeader &header, const Parsed &parsed) {
  if (auto good = readEncoding(header, parsed); !good) return good;
  if (auto good = findParts(header, parsed); !good) return good;
  return skip(header, parsed);
}

}  // namespace

Expected<ImageHeader> readNrrdHeader(const std::filesystem::path &path) {
  const auto parsed = parse(path);
  if (!parsed) return tl::unexpected(parsed.error());
  ImageHeader header;
  header.path = path;
  header.keys = parsed->keys;
  header.notices = parsed->notices;
  const auto scalar = scalarOf(path, lowerCase(parsed->field("type")));
  if (!scalar) return tl::unexpected(scalar.error());
  header.scalar = *scalar;
  const auto sizes = numbersIn(parsed->field("sizes")), dimension = numbersIn(parsed->field("dimension"));
  if (dimension.empty() || sizes.size() < 2 || sizes.size() > 16 || dimension[0] != static_cast<double>(sizes.size()))
    return refuse(path, "the header says dimension '" + parsed->field("dimension") + "' with " +
                            std::to_string(sizes.size()) + " sizes; 2 to 16 are read");
  if (const auto placed = place(header, *parsed, sizes); !placed) return tl::unexpected(placed.error());
  header.segmented = std::any_of(header.keys.begin(), header.keys.end(),
                                 [](const auto &key) { return key.first.starts_with("Segment0_"); });
  header.layered = header.volumes > 1 && header.segmented;
  if (const auto found = findData(header, *parsed); !found) return tl::unexpected(found.error());
  return header;
}

}  // namespace c3de::imaging
