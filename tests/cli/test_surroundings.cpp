// SPDX-License-Identifier: Apache-2.0
// Bodies held by their surroundings, rigid bodies, and images of which only a part moves.
#include <cmath>

#include "c3de/imaging/reading.h"
#include "c3de/imaging/writing.h"
#include "program.h"

using namespace c3de;

namespace {

std::string box(const std::string &name, const std::string &more) {
  return "[[body]]\nname = \"" + name + "\"\nmesh = \"box.obj\"\nmesh_unit = \"m\"\nsampling = { count = 100 }\n" +
         more;
}

std::filesystem::path scene(const std::filesystem::path &folder, const std::string &text) {
  writeFile(folder / "box.obj", boxObj());
  return writeFile(folder / "scene.toml", "format = 1\n" + text);
}

// A soft ball of 10 mm in the middle of a bony shell with fat between and air around, in HU.
void writeHead(const std::filesystem::path &folder) {
  imaging::Volume image;
  image.unit = "HU";
  image.geometry.size = {40, 40, 40};
  image.geometry.indexToWorld = {1.5, 0, 0, 0, 0, 1.5, 0, 0, 0, 0, 1.5, 0, -29.25, -29.25, -29.25, 1};
  std::vector<std::int16_t> voxels;
  for (int k = 0; k < 40; ++k)
    for (int j = 0; j < 40; ++j)
      for (int i = 0; i < 40; ++i) {
        const double r = norm(image.geometry.worldAt({double(i), double(j), double(k)}));
        voxels.push_back(r < 10.0 ? 60 : r < 14.0 ? -80 : r < 19.0 ? 900 : -1000);
      }
  image.voxels = voxels;
  REQUIRE(imaging::writeVolume(folder / "head.nrrd", image));
}

// The largest changes of the exported image in bone, and in soft tissue behind the ball, after it has flown 3 mm.
std::array<double, 2> largestChanges(const std::filesystem::path &folder, const std::string &still) {
  const auto file =
      writeFile(folder / "scene.toml",
                "format = 1\n[image]\nfile = \"head.nrrd\"\nrim = 8\n" + still +
                    "[[body]]\nname = \"ball\"\nvolume = \"head.nrrd\"\nthreshold = [30, 100]\nmend = { largest = "
                    "true }\nsampling = { count = 400 }\nvelocity = [0, 0, -0.1]\n");
  const auto image = folder / "warped.nrrd";
  const auto ran = runC3de({"run", file.string(), "--until", "0.03", "--export-image", image.string(), "-q"});
  INFO(ran.errorOutput);
  REQUIRE(ran.exitCode == 0);
  const auto before = imaging::readVolume(folder / "head.nrrd");
  REQUIRE(before);
  std::array<double, 2> most{};
  const auto after = imaging::readVolume(image);
  REQUIRE(after);
  for (std::size_t k = 0; k < 40; ++k)
    for (std::size_t j = 0; j < 40; ++j)
      for (std::size_t i = 0; i < 40; ++i) {
        const double was = before->volume.value(i, j, k), is = after->volume.value(i, j, k);
        const Vec3 x = before->volume.geometry.worldAt({double(i), double(j), double(k)});
        // The ball ends 1 mm from the bone. Edges of bodies are known to half a voxel.
        if (was == 900.0) most[0] = std::max(most[0], std::abs(is - was));
        if (was == -80.0 && norm(x) > 10.75 && norm(x) < 12.0 && x[2] > 4.0)
          most[1] = std::max(most[1], std::abs(is - was));
      }
  return most;
}

}  // namespace

TEST_CASE("An attachment to the surroundings carries a body, and the report says with which force") {
  const auto folder = freshFolder("attached");
  const auto report = folder / "report.json";
  const auto file =
      scene(folder, "[world]\ngravity = [0, -9.81, 0]\n[solver]\nintegrator = \"quasistatic\"\n" + box("box", "") +
                        "[[attachment]]\nbodies = [\"box\", \"surroundings\"]\nstiffness = 1e5\n");
  const auto ran = runC3de({"run", file.string(), "--report", report.string(), "-q"});
  INFO(ran.errorOutput);
  REQUIRE(ran.exitCode == 0);
  const auto json = readJson(report);
  REQUIRE(json["attachments"].size() == 1);
  const auto &attachment = json["attachments"][0];
  const double weight = 9.81 * json["bodies"][0]["mass_kg"].get<double>();
  CHECK(attachment["name"] == "box/surroundings");
  CHECK(attachment["stiffness_Pa_m"] == 1e5);
  CHECK(attachment["tangential_Pa_m"] == 1e5);
  CHECK_THAT(attachment["force_N"][1].get<double>(), WithinRel(weight, 1e-6));
  CHECK_THAT(attachment["force_N"][0].get<double>(), WithinAbs(0.0, 1e-6 * weight));
  CHECK(attachment["energy_J"].get<double>() > 0.0);
  CHECK(json["bodies"][0]["energy_J"]["attachment"] == attachment["energy_J"]);
  CHECK_FALSE(json["bodies"][0]["rigid"].get<bool>());

  const auto off = runC3de({"run", file.string(), "--set", "body.box.surroundings.stiffness=0", "--set",
                            "solver.integrator=explicit", "--steps", "5", "--report", report.string(), "-q"});
  REQUIRE(off.exitCode == 0);
  CHECK(readJson(report)["attachments"].empty());
}

TEST_CASE("An attachment carries one body by another, and tears where it bears no more, whatever integrates them") {
  const auto folder = freshFolder("carried");
  const auto report = folder / "report.json";
  const auto file =
      scene(folder,
            "[world]\ngravity = [0, -9.81, 0]\n[solver]\ndamping = 20\n" + box("box", "rigid = true\n") +
                box("hanging", "position = [0, -0.23, 0]\n") +
                "[[attachment]]\nname = \"glue\"\nbodies = [\"hanging\", \"box\"]\nwithin_mm = 40\nstiffness = 1e6\n");
  for (const char *integrator : {"explicit", "implicit", "quasistatic"}) {
    const auto ran = runC3de({"run", file.string(), "--set", std::string("solver.integrator=") + integrator, "--until",
                              "2", "--report", report.string(), "-q"});
    INFO(integrator << ": " << ran.errorOutput);
    REQUIRE(ran.exitCode == 0);
    const auto json = readJson(report);
    REQUIRE(json["attachments"].size() == 1);
    const auto &glue = json["attachments"][0];
    CHECK(glue["name"] == "glue");
    CHECK(glue["bodies"] == nlohmann::json{"hanging", "box"});
    CHECK(glue["torn_part"] == 0.0);
    CHECK_THAT(glue["force_N"][1].get<double>(), WithinRel(9.81 * json["bodies"][1]["mass_kg"].get<double>(), 1e-3));
  }
  const auto torn = runC3de({"run", file.string(), "--set", "attachment.glue.tears_at=1", "--until", "0.3", "--report",
                             report.string(), "-q"});
  REQUIRE(torn.exitCode == 0);
  CHECK(readJson(report)["attachments"][0]["torn_part"] == 1.0);
  const auto nowhere = runC3de({"run", file.string(), "--set", "attachment.glue.within_mm=0.001", "-q"});
  CHECK(nowhere.exitCode == 3);
  CHECK_THAT(nowhere.errorOutput, Contains("'glue'") && Contains("nowhere within") && Contains("apart"));
  const auto info = runC3de({"info", file.string()});
  CHECK_THAT(info.output, Contains("attachment \"glue\": \"hanging\" to \"box\", 1000000 Pa/m, within 40 mm"));
}

TEST_CASE("A held body that is thrown comes back to where it was, the same at any number of threads") {
  const auto folder = freshFolder("thrown");
  const auto file =
      scene(folder, box("box", "velocity = [1, 0.5, 0]\n") +
                        "[[attachment]]\nbodies = [\"box\", \"surroundings\"]\nstiffness = 1e6\ntangential = 4e5\n");
  std::vector<std::string> hashes;
  for (const char *threads : {"1", "3"}) {
    const auto report = folder / "report.json";
    const auto ran =
        runC3de({"run", file.string(), "--until", "0.3", "--threads", threads, "--report", report.string(), "-q"});
    INFO(ran.errorOutput);
    REQUIRE(ran.exitCode == 0);
    hashes.push_back(readJson(report)["state_hash"]);
  }
  CHECK(hashes[0] == hashes[1]);
  const auto report = folder / "rest.json";
  const auto ran = runC3de({"run", file.string(), "--set", "body.box.surroundings.retardation_time=0.2", "--set",
                            "solver.damping=5", "--until", "4", "--report", report.string(), "-q"});
  REQUIRE(ran.exitCode == 0);
  const auto body = readJson(report)["bodies"][0];
  const auto still = scene(folder, box("box", ""));
  const auto reference = folder / "reference.json";
  REQUIRE(runC3de({"run", still.string(), "--steps", "1", "--report", reference.string(), "-q"}).exitCode == 0);
  for (int a = 0; a < 3; ++a)
    CHECK_THAT(body["centre_of_mass_m"][a].get<double>(),
               WithinAbs(readJson(reference)["bodies"][0]["centre_of_mass_m"][a].get<double>(), 1e-4));
}

TEST_CASE("A rigid body leaves the step to the others, and takes neither fix nor load nor velocity") {
  const auto folder = freshFolder("rigid");
  const auto report = folder / "report.json";
  const std::string bone = "material = { youngs_modulus = 100 }\n";
  const auto dtOf = [&](const std::string &more) {
    const auto ran = runC3de({"run",
                              scene(folder, "[solver]\nintegrator = \"explicit\"\n[world]\ngravity = [0, -9.81, 0]\n" +
                                                box("bone", bone + more) + box("soft", ""))
                                  .string(),
                              "--steps", "3", "--report", report.string(), "-q"});
    INFO(ran.errorOutput);
    REQUIRE(ran.exitCode == 0);
    return readJson(report)["dt_s"].get<double>();
  };
  const double together = dtOf("");
  CHECK(dtOf("rigid = true\n") < 0.5 * together);  // which was the softer one's
  const auto json = readJson(report);
  CHECK(json["bodies"][0]["rigid"].get<bool>());
  CHECK(json["bodies"][0]["momentum"] == nlohmann::json({0.0, 0.0, 0.0}));
  CHECK(json["bodies"][1]["momentum"][1].get<double>() < 0.0);

  const auto refused = [&](const std::string &text) {
    const auto ran = runC3de({"run", scene(folder, text).string(), "--steps", "1", "-q"});
    CHECK(ran.exitCode == 3);
    return ran.errorOutput;
  };
  CHECK_THAT(refused(box("bone", "rigid = true\nvelocity = [1, 0, 0]\n")), Contains("rigid and fixed"));
  CHECK_THAT(refused(box("bone", "rigid = true\n") + "[[load]]\nregion = { everywhere = true }\nforce = [1, 0, 0]\n"),
             Contains("scene.toml:8: ") && Contains("rigid and fixed"));
  CHECK_THAT(refused(box("bone", "rigid = 1\n")), Contains("rigid"));
}

TEST_CASE("A free rigid body moves by weight, load and velocity, and takes neither fix nor a static solution",
          "[free]") {
  const auto folder = freshFolder("free");
  const auto report = folder / "report.json";
  const std::string world = "[world]\ngravity = [0, -9.81, 0]\n",
                    plate = box("plate", "rigid = true\nfree = true\nvelocity = [0, 0, 0.5]\n");
  const auto run = [&](const std::string &text, std::vector<std::string> more) {
    std::vector<std::string> arguments{"run", scene(folder, text).string(), "--report", report.string(), "-q"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto ran = runC3de(arguments);
    INFO(ran.errorOutput);
    REQUIRE(ran.exitCode == 0);
    return readJson(report);
  };
  const auto fell =
      run(world + plate + "[[load]]\nregion = { everywhere = true }\nforce = [3, 0, 0]\n", {"--until", "0.1"});
  const auto body = fell["bodies"][0];
  CHECK(body["rigid"].get<bool>());
  CHECK(body["free"].get<bool>());
  CHECK(body["integrator"] == "explicit");
  const double mass = body["mass_kg"].get<double>(), time = fell["time_s"].get<double>();
  const std::array<double, 3> expected{3.0 * time, -9.81 * mass * time, 0.5 * mass};
  for (std::size_t a = 0; a < 3; ++a) CHECK_THAT(body["momentum"][a].get<double>(), WithinRel(expected[a], 1e-9));
  CHECK(body["energy_J"]["elastic"] == 0.0);

  // One on the other, on the floor of the world, whatever the integrator of the others.
  const auto rests =
      run("[world]\ngravity = [0, -9.81, 0]\nbox = { min = [-1, 0, -1], max = [2, 2, 2] }\n[solver]\nintegrator = "
          "\"implicit\"\ndamping = 10\n" +
              box("bed", "material = { youngs_modulus = 2e5 }\n") +
              box("plate", "rigid = true\nfree = true\nscale = 0.5\nposition = [0.2, 0.205, 0.05]\n"),
          {"--until", "1"});
  bool found = false;
  for (const auto &one : rests["contacts"]) {
    if (one["bodies"] != nlohmann::json{"bed", "plate"}) continue;
    found = true;
    CHECK_THAT(one["pressing_N"].get<double>(), WithinRel(9.81 * rests["bodies"][1]["mass_kg"].get<double>(), 0.02));
  }
  CHECK(found);
  CHECK(rests["bodies"][0]["integrator"] == "explicit");

  const auto refused = [&](const std::string &text, std::vector<std::string> more = {}) {
    std::vector<std::string> arguments{"run", scene(folder, text).string(), "--steps", "1", "-q"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto ran = runC3de(arguments);
    CHECK(ran.exitCode == 3);
    return ran.errorOutput;
  };
  CHECK_THAT(refused(plate, {"--set", "solver.integrator=quasistatic"}),
             Contains("'plate' is rigid and free") && Contains("moves no rigid body") && Contains("free = false"));
  CHECK_THAT(refused(plate + "[[fix]]\nregion = { everywhere = true }\n"), Contains("scene.toml:10: ") &&
                                                                               Contains("'plate' is rigid and free") &&
                                                                               Contains("nothing of it is fixed"));
  CHECK_THAT(refused(plate, {"--set", "body.plate.free=false"}), Contains("rigid and fixed"));
  CHECK_THAT(refused(box("plate", "free = 1\n")), Contains("free"));
}

TEST_CASE("Bone and air of an exported CT stay where they are, without that they bend with the body") {
  const auto folder = freshFolder("still");
  writeHead(folder);
  const auto bends = largestChanges(folder, "still = \"nothing\"\n"), stays = largestChanges(folder, ""),
             outside = largestChanges(folder, "still = \"outside\"\n"),
             byValues = largestChanges(folder, "still = { above = 500 }\n");
  CHECK(bends[0] > 300.0);
  CHECK(stays[0] == 0.0);
  CHECK(byValues[0] == 0.0);
  CHECK(outside[0] == 0.0);
  CHECK(outside[1] == 0.0);
}

TEST_CASE("A label that is to stay and does not occur is refused with those that do") {
  const auto folder = freshFolder("still_label");
  writeHead(folder);
  imaging::LabelMap map;
  map.geometry.size = {4, 4, 4};
  map.geometry.indexToWorld = {15, 0, 0, 0, 0, 15, 0, 0, 0, 0, 15, 0, -22.5, -22.5, -22.5, 1};
  map.voxels.assign(64, 3);
  map.labels = {{3, "skull", {0.6F, 0.2F, 0.1F}}};
  REQUIRE(imaging::writeLabelMap(folder / "labels.nrrd", map));
  const auto file = writeFile(
      folder / "scene.toml",
      "format = 1\n[image]\nfile = \"head.nrrd\"\nlabels = \"labels.nrrd\"\nstill = { labels = [\"scull\"] }\n"
      "[[body]]\nvolume = \"head.nrrd\"\nthreshold = [30, 100]\n");
  const auto ran =
      runC3de({"run", file.string(), "--steps", "1", "--export-image", (folder / "w.nrrd").string(), "-q"});
  CHECK(ran.exitCode == 3);
  CHECK_THAT(ran.errorOutput,
             Contains("scene.toml:2: ") && Contains("no label 'scull'") && Contains("did you mean 'skull'"));
}
