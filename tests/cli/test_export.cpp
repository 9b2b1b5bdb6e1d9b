// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <regex>
#include <sstream>

#include "program.h"

namespace {

/// A second body of the same mesh next to the first.
const char *const kSecondBody = R"(
[[body]]
name = "other: box"
mesh = "box.obj"
mesh_unit = "m"
position = [0, 0, 2]
material = { law = "stvk", youngs_modulus = 1e4, poisson_ratio = 0.3, density = 1000.0 }
sampling = { spacing = 0.1 }
)";

struct Frame {
  double time_s = 0.0;
  std::string file;
};

std::vector<Frame> framesOf(const std::filesystem::path &list) {
  const std::string text = readFile(list);
  const std::regex entry("<DataSet timestep=\"([^\"]+)\" group=\"\" part=\"[01]\" file=\"([^\"]+)\"/>");
  std::vector<Frame> frames;
  for (std::sregex_iterator it(text.begin(), text.end(), entry), end; it != end; ++it)
    frames.push_back({std::stod((*it)[1]), (*it)[2]});
  return frames;
}

/// The numbers of an array of a written file: base64 after the '_', a length of 8 bytes, then the values.
template <class T>
std::vector<T> arrayOf(const std::string &text, const std::string &name) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const std::size_t tag = text.find("Name=\"" + name + "\"");
  REQUIRE(tag != std::string::npos);
  const std::size_t offset = text.find("offset=\"", tag) + 8;
  std::string bytes;
  std::uint32_t bits = 0, count = 0;
  for (std::size_t i = text.find("\n_") + 2 + std::stoul(text.substr(offset)); text[i] != '=' && text[i] != '\n'; ++i) {
    bits = bits << 6 | static_cast<std::uint32_t>(digits.find(text[i]));
    if ((count += 6) >= 8) bytes.push_back(static_cast<char>(bits >> (count -= 8) & 255));
  }
  std::uint64_t length = 0;
  std::memcpy(&length, bytes.data(), 8);
  REQUIRE(bytes.size() >= 8 + length);
  std::vector<T> out(length / sizeof(T));
  std::memcpy(out.data(), bytes.data() + 8, length);
  return out;
}

}  // namespace

TEST_CASE("An exported simulation lists frames with their times, and the phyxels fall as bodies do") {
  const auto folder = freshFolder("export");
  const auto list = folder / "out.pvd";
  const auto result = runC3de({"run", writeBoxScene(folder).string(), "--until", "0.1", "--export", list.string(),
                               "--export-every", "0.03", "--report", (folder / "report.json").string()});
  INFO(result.errorOutput);
  REQUIRE(result.exitCode == 0);
  const auto frames = framesOf(list);
  // 0, 0.03, 0.06, 0.09 and the end, each with phyxels and skin.
  REQUIRE(frames.size() == 10);
  CHECK(frames.front().time_s == 0.0);
  const auto report = readJson(folder / "report.json");
  CHECK_THAT(frames.back().time_s, WithinAbs(report.at("time_s").get<double>(), 1e-12));
  const double dt_s = report.at("dt_s").get<double>();
  for (std::size_t f = 0; f < 8; f += 2) {
    CHECK(frames[f].time_s == frames[f + 1].time_s);
    CHECK(frames[f].time_s >= 0.015 * static_cast<double>(f) - 1e-9);
    CHECK(frames[f].time_s <= 0.015 * static_cast<double>(f) + dt_s);
  }
  for (const Frame &frame : frames) {
    INFO(frame.file);
    CHECK_THAT(readFile(folder / frame.file).substr(0, 200), Contains("SPACE=LPS UNITS=mm"));
  }
  const std::string phyxels = readFile(folder / frames[8].file), skin = readFile(folder / frames[9].file);
  const std::size_t n = report.at("bodies").at(0).at("phyxels").get<std::size_t>();
  CHECK(arrayOf<std::uint8_t>(phyxels, "types") == std::vector<std::uint8_t>(n, 1));
  for (const char *name : {"mass [kg]", "volume [m^3]", "deformation_gradient [1]", "strain_green [1]",
                           "stress_pk2 [Pa]", "stress_vm [Pa]", "body"})
    CHECK_THAT(phyxels, Contains(std::string("Name=\"") + name + "\""));
  // Free fall: every point moves by g t²/2, in mm; the integrator is exact for it.
  const double t = frames.back().time_s, fall_mm = -1000.0 * 0.5 * 9.81 * t * t;
  const auto moved = arrayOf<float>(phyxels, "displacement [mm]"), speed = arrayOf<float>(phyxels, "velocity [m/s]");
  const auto skinMoved = arrayOf<float>(skin, "displacement [mm]");
  REQUIRE(moved.size() == 3 * n);
  REQUIRE(skinMoved.size() == 3 * 8);
  for (std::size_t i = 0; i < moved.size(); i += 3) {
    CHECK_THAT(static_cast<double>(moved[i + 1]), WithinRel(fall_mm, 1e-3));
    CHECK_THAT(static_cast<double>(speed[i + 1]), WithinRel(-9.81 * t, 1e-3));
  }
  for (std::size_t i = 0; i < skinMoved.size(); i += 3)
    CHECK_THAT(static_cast<double>(skinMoved[i + 1]), WithinRel(fall_mm, 1e-3));
  // A box of 1 m x 0.2 m x 0.2 m in mm, moved down.
  const auto corners = arrayOf<double>(skin, "Points");
  REQUIRE(corners.size() == 24);
  double low = 1e9, right = -1e9;
  for (std::size_t i = 0; i < 24; i += 3) {
    right = std::max(right, corners[i]);
    low = std::min(low, corners[i + 1]);
  }
  CHECK_THAT(right, WithinAbs(1000.0, 0.5));
  CHECK_THAT(low, WithinRel(fall_mm, 1e-3));
  CHECK_THAT(skin, Contains("NumberOfPolys=\"12\""));
  for (const auto &entry : std::filesystem::recursive_directory_iterator(folder))
    CHECK(entry.path().extension() != ".part");
}

TEST_CASE("Load steps of a quasi-static solution are frames") {
  const auto folder = freshFolder("export-load-steps");
  const auto scene = writeBoxScene(
      folder, "\n[[fix]]\nbody = \"box\"\nregion = { box = { min = [-0.001, -1, -1], max = [0.001, 1, 1] } }\n");
  const auto result = runC3de({"run", scene.string(), "--set", "solver.integrator=quasistatic", "--set",
                               "solver.load_steps=3", "--export", (folder / "out.pvd").string()});
  INFO(result.errorOutput);
  REQUIRE(result.exitCode == 0);
  const auto frames = framesOf(folder / "out.pvd");
  REQUIRE(frames.size() == 8);
  CHECK(frames[2].time_s == 1.0);
  CHECK(frames.back().time_s == 3.0);
  const auto stress = arrayOf<float>(readFile(folder / frames[6].file), "stress_vm [Pa]");
  CHECK(*std::max_element(stress.begin(), stress.end()) > 100.0f);  // it hangs on one end: rho g L²/h is some 10 kPa
}

TEST_CASE("The skin of the end state is written for every body, in formats that are read again") {
  const auto folder = freshFolder("export-surface");
  const auto scene = writeBoxScene(folder, kSecondBody);
  for (const std::string extension : {"obj", "stl", "ply", "vtp"}) {
    INFO(extension);
    const auto result = runC3de(
        {"run", scene.string(), "--steps", "3", "-q", "--export-surface", (folder / ("end." + extension)).string()});
    INFO(result.errorOutput);
    REQUIRE(result.exitCode == 0);
    CHECK_FALSE(std::filesystem::exists(folder / ("end." + extension)));
    const auto info = runC3de({"info", (folder / ("end-other_ box." + extension)).string(), "--json"});
    REQUIRE(info.exitCode == 0);
    const auto json = nlohmann::json::parse(info.output);
    CHECK(json.at("unit") == "mm");
    CHECK(json.at("closed") == true);
    CHECK_THAT(json.at("volume_mm3").get<double>(), WithinRel(1e9 * 0.04, 1e-3));
    CHECK_THAT(json.at("box_min_mm").at(2).get<double>(), WithinAbs(2000.0, 0.5));
    CHECK(runC3de({"info", (folder / ("end-box." + extension)).string()}).exitCode == 0);
  }
  // One body: the name as specified; simulated again without a unit, it falls unscaled.
  const auto one = folder / "one.stl";
  CHECK(runC3de({"run", writeBoxScene(folder).string(), "--steps", "3", "-q", "--export-surface", one.string()})
            .exitCode == 0);
  CHECK(runC3de({"run", one.string(), "--steps", "2", "-q", "--report", (folder / "again.json").string()}).exitCode ==
        0);
  CHECK_THAT(readJson(folder / "again.json").at("bodies").at(0).at("mesh_volume_m3").get<double>(),
             WithinRel(0.04, 1e-3));
}

TEST_CASE("An export that cannot be written says why before anything is simulated, and leaves nothing") {
  const auto folder = freshFolder("export-refused");
  const auto scene = writeBoxScene(folder, kSecondBody).string();
  // A file where the folder of the frames should be.
  writeFile(folder / "out_frames", "in the way");
  const auto blocked = runC3de({"run", scene, "--until", "1e6", "--export", (folder / "out.pvd").string()});
  CHECK(blocked.exitCode == 7);
  CHECK_THAT(blocked.errorOutput, Contains("out_frames: is a file"));
  CHECK_FALSE(std::filesystem::exists(folder / "out.pvd"));
  // One of several surfaces.
  std::filesystem::create_directories(folder / "end-box.ply");
  const auto surface = runC3de({"run", scene, "--until", "1e6", "--export-surface", (folder / "end.ply").string()});
  CHECK(surface.exitCode == 7);
  CHECK_THAT(surface.errorOutput, Contains("end-box.ply"));
  const auto extension = runC3de({"run", scene, "--until", "1e6", "--export-surface", (folder / "end").string()});
  CHECK(extension.exitCode == 2);
  CHECK_THAT(extension.errorOutput, Contains("accepted: .obj, .stl, .ply, .vtp"));
  // A scene that is refused.
  CHECK(runC3de({"run", (folder / "absent.toml").string(), "--export", (folder / "new.pvd").string()}).exitCode == 3);
  CHECK_FALSE(std::filesystem::exists(folder / "new.pvd"));
  CHECK_FALSE(std::filesystem::exists(folder / "new_frames"));
}

TEST_CASE("A run that ends early still lists its frames") {
  const auto folder = freshFolder("export-early");
  const auto result = runC3de({"run", writeBoxScene(folder).string(), "--until", "1e6", "--time-limit", "1", "--export",
                               (folder / "out.pvd").string(), "--export-every", "1"});
  CHECK(result.exitCode == 124);
  CHECK_THAT(result.errorOutput, Contains("out.pvd"));
  const auto frames = framesOf(folder / "out.pvd");
  REQUIRE(frames.size() >= 4);
  for (const Frame &frame : frames) CHECK(std::filesystem::exists(folder / frame.file));
}
