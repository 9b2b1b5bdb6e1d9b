// SPDX-License-Identifier: Apache-2.0
// Programs that were compiled with the header of revision 1.
#include <cstdio>
#include <fstream>

#include "../../cli/program.h"
#include "open_simulation.h"
#include "support/folders.h"

namespace {

std::string hashText(std::uint64_t hash) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

/// What it prints is the hash of the same steps with today's header.
void requireWorks(const std::string &program, const std::string &name) {
  const auto folder = freshFolder(name);
  const std::string scene = writeBoxScene(folder).string();
  const auto library = std::filesystem::path(C3DE_LIBRARY_FILE).parent_path().string();
  const auto ran = c3de::runProcess({"env", "LD_LIBRARY_PATH=" + library, program, scene, folder.string()}, 120.0);
  REQUIRE(ran);
  INFO(ran->output << ran->errorOutput);
  REQUIRE(ran->exitCode == 0);
  CHECK(ran->errorOutput.empty());
  const OpenSimulation sim(scene, {"world.gravity=[0, -5, 0]"});
  REQUIRE_OK(c3de_embed_set(sim.get(), "body.box.youngs_modulus", "2e4"));
  REQUIRE_OK(c3de_embed_step(sim.get(), 20, nullptr));
  CHECK(ran->output == hashText(hashOf(sim.get())) + "\n");
  CHECK(std::filesystem::exists(folder / "client.c3de"));
}

}  // namespace

TEST_CASE("A program that was compiled with revision 1 of the header runs with this library", "[kept]") {
  requireWorks(C3DE_KEPT_CLIENT, "embed-kept-source");
}

TEST_CASE("A binary of revision 1 runs with this library", "[kept]") {
#if !defined(__linux__) || !defined(__x86_64__) || defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  C3DE_SKIP("the kept binary is of another system, or has no sanitizer");
#else
  requireWorks(C3DE_KEPT_FOLDER "/linux-x86_64/client_of_1", "embed-kept-binary");
#endif
}

TEST_CASE("Every function that was published is exported", "[kept]") {
  const auto symbols = c3de::runProcess({"nm", "-D", "--defined-only", C3DE_LIBRARY_FILE}, 60.0);
  if (!symbols || symbols->exitCode != 0) C3DE_SKIP("nm is not installed");
  std::ifstream golden(C3DE_EMBED_GOLDEN);
  int count = 0;
  for (std::string line; std::getline(golden, line);) {
    const auto end = line.find("(). ");
    if (line.rfind("frozen c3de_embed_", 0) != 0 || end == std::string::npos) continue;
    ++count;
    CHECK_THAT(symbols->output, Contains(" T " + line.substr(7, end - 7) + "\n"));
  }
  CHECK(count >= 42);
}
