// SPDX-License-Identifier: Apache-2.0
// An independent reader for the written files, which shares no code with the writer.
#include "c3de/geometry/vtk_writer.h"

#include <cstdint>
#include <cstring>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>

#include "shapes.h"
#include "support/catch.h"

using namespace c3de;
using namespace c3de::geometry;

namespace {

std::string readAll(const std::filesystem::path &file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

/// Attributes of every element by "Name" or element name; fails the test where the text is not well-formed.
struct Xml {
  explicit Xml(const std::string &text) {
    std::vector<std::string> open;
    std::size_t at = 0;
    while ((at = text.find('<', at)) != std::string::npos) {
      if (text.compare(at, 4, "<!--") == 0) {
        const std::size_t end = text.find("--", at + 4);
        REQUIRE(text.substr(end, 3) == "-->");
        at = end;
        continue;
      }
      const std::size_t end = text.find('>', at);
      REQUIRE(end != std::string::npos);
      std::string tag = text.substr(at + 1, end - at - 1);
      at = end;
      if (tag[0] == '?') continue;
      if (tag[0] == '/') {
        REQUIRE_FALSE(open.empty());
        REQUIRE(open.back() == tag.substr(1));
        open.pop_back();
        continue;
      }
      const bool isSelfClosed = tag.back() == '/';
      if (isSelfClosed) tag.pop_back();
      const std::string name = tag.substr(0, tag.find(' '));
      if (!isSelfClosed) open.push_back(name);
      std::map<std::string, std::string> attributes;
      for (std::size_t i = name.size(); (i = tag.find('=', i)) != std::string::npos;) {
        const std::size_t keyBegin = tag.rfind(' ', i) + 1, valueEnd = tag.find('"', i + 2);
        REQUIRE(tag[i + 1] == '"');
        REQUIRE(valueEnd != std::string::npos);
        const std::string key = tag.substr(keyBegin, i - keyBegin);
        REQUIRE(attributes.emplace(key, tag.substr(i + 2, valueEnd - i - 2)).second);
        i = valueEnd;
      }
      elements.emplace_back(name, attributes);
      if (name == "AppendedData") {
        const std::size_t begin = text.find('_', at) + 1;
        appended = text.substr(begin, text.find('\n', begin) - begin);
      }
    }
    CHECK(open.empty());
  }

  [[nodiscard]] std::map<std::string, std::string> find(const std::string &element, const std::string &name = "",
                                                        int skip = 0) const {
    for (const auto &[e, attributes] : elements)
      if (e == element && (name.empty() || (attributes.contains("Name") && attributes.at("Name") == name)) &&
          skip-- == 0)
        return attributes;
    FAIL("no " << element << " " << name);
    return {};
  }

  template <class T>
  [[nodiscard]] std::vector<T> array(const std::string &name, const std::string &type, int skip = 0) const {
    const auto attributes = find("DataArray", name, skip);
    CHECK(attributes.at("type") == type);
    std::string bits;
    for (std::size_t i = std::stoul(attributes.at("offset")); i < appended.size() && appended[i] != '='; ++i) {
      const std::size_t digit =
          std::string("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/").find(appended[i]);
      REQUIRE(digit < 64);
      for (int k = 5; k >= 0; --k) bits.push_back(digit >> k & 1 ? '1' : '0');
    }
    std::string bytes;
    for (std::size_t i = 0; i + 8 <= bits.size(); i += 8)
      bytes.push_back(static_cast<char>(std::stoi(bits.substr(i, 8), nullptr, 2)));
    std::uint64_t length = 0;
    REQUIRE(bytes.size() >= 8);
    std::memcpy(&length, bytes.data(), 8);
    REQUIRE(bytes.size() >= 8 + length);
    std::vector<T> out(length / sizeof(T));
    if (!out.empty()) std::memcpy(out.data(), bytes.data() + 8, length);
    return out;
  }

  std::vector<std::pair<std::string, std::map<std::string, std::string>>> elements;
  std::string appended;
};

}  // namespace

TEST_CASE("A written point cloud is well-formed XML with the numbers that went in") {
  PointCloud cloud;
  cloud.points = {{1.5, -2.25, 1e3}, {0.1, 0.2, 0.3}, {4, 5, 6}, {-7, 8, 9}, {1e-3, 0, 0}};
  cloud.arrays.push_back({"displacement [mm]", 3, {}});
  for (int i = 0; i < 15; ++i) cloud.arrays[0].values.push_back(0.5 * i);
  cloud.arrays.push_back({"stress <vm> & \"more\" [Pa]", 1, {1, 2, 3, 4, -5}});
  cloud.arrays.push_back({"body", 1, {0, 0, 1, 1, -2}, PointArray::Type::whole});
  const auto path = testOutputFolder() / "cloud.vtu";
  REQUIRE(writeVtu(path, cloud, "a title -- with <tags>"));
  const std::string text = readAll(path);
  CHECK_THAT(text, Contains("SPACE=LPS UNITS=mm"));
  const Xml xml(text);
  CHECK(xml.find("VTKFile").at("type") == "UnstructuredGrid");
  CHECK(xml.find("VTKFile").at("header_type") == "UInt64");
  CHECK(xml.find("Piece").at("NumberOfPoints") == "5");
  CHECK(xml.find("Piece").at("NumberOfCells") == "5");
  const auto points = xml.array<double>("Points", "Float64");
  REQUIRE(points.size() == 15);
  for (std::size_t i = 0; i < 15; ++i) CHECK(points[i] == cloud.points[i / 3][i % 3]);
  CHECK(xml.find("DataArray", "displacement [mm]").at("NumberOfComponents") == "3");
  const auto shifts = xml.array<float>("displacement [mm]", "Float32");
  REQUIRE(shifts.size() == 15);
  for (std::size_t i = 0; i < 15; ++i) CHECK(static_cast<double>(shifts[i]) == 0.5 * static_cast<double>(i));
  CHECK(xml.array<float>("stress &lt;vm&gt; &amp; &quot;more&quot; [Pa]", "Float32") ==
        std::vector<float>{1, 2, 3, 4, -5});
  CHECK(xml.array<std::int32_t>("body", "Int32") == std::vector<std::int32_t>{0, 0, 1, 1, -2});
  CHECK(xml.array<std::int64_t>("connectivity", "Int64") == std::vector<std::int64_t>{0, 1, 2, 3, 4});
  CHECK(xml.array<std::int64_t>("offsets", "Int64") == std::vector<std::int64_t>{1, 2, 3, 4, 5});
  CHECK(xml.array<std::uint8_t>("types", "UInt8") == std::vector<std::uint8_t>(5, 1));  // VTK_VERTEX
}

TEST_CASE("A written surface has its triangles, and its points where it has none") {
  TriangleMesh mesh = shapes::box({0, 0, 0}, {1, 2, 3});
  const auto path = testOutputFolder() / "box.vtp";
  REQUIRE(writeVtp(path, mesh, {}));
  const Xml xml(readAll(path));
  CHECK(xml.find("Piece").at("NumberOfPolys") == "12");
  CHECK(xml.find("Piece").at("NumberOfVerts") == "0");
  // The first is of <Verts>, the second of <Polys>.
  CHECK(xml.array<std::int64_t>("connectivity", "Int64", 0).empty());
  const auto corners = xml.array<std::int64_t>("connectivity", "Int64", 1);
  REQUIRE(corners.size() == 36);
  for (std::size_t i = 0; i < 36; ++i) CHECK(corners[i] == mesh.triangles[i / 3][i % 3]);
  CHECK(xml.array<std::int64_t>("offsets", "Int64", 1).back() == 36);
  mesh.triangles.clear();
  REQUIRE(writeVtp(path, mesh, {}));
  const Xml points(readAll(path));
  CHECK(points.find("Piece").at("NumberOfVerts") == "8");
  CHECK(points.array<std::int64_t>("connectivity", "Int64", 0).size() == 8);
}

TEST_CASE("The list of a sequence names files with times in seconds") {
  const auto path = testOutputFolder() / "out.pvd";
  const std::vector<PvdEntry> entries{{0.0, 0, "out/a & b.vtu"}, {0.04, 1, std::filesystem::path("out") / "b.vtp"}};
  REQUIRE(writePvd(path, entries));
  const Xml xml(readAll(path));
  CHECK(xml.find("VTKFile").at("type") == "Collection");
  CHECK(xml.find("DataSet").at("file") == "out/a &amp; b.vtu");
  CHECK(xml.find("DataSet", "", 1).at("timestep") == "0.04");
  CHECK(xml.find("DataSet", "", 1).at("part") == "1");
  CHECK(xml.find("DataSet", "", 1).at("file") == "out/b.vtp");
  CHECK_FALSE(writePvd(testOutputFolder() / "absent" / "out.pvd", entries));
}
