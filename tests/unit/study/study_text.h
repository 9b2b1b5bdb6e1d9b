// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include "support/catch.h"

/// A study of one case of an existing scene; `reference` and `grid` are the tables that follow it.
inline std::string studyText(
    const std::string &quantity = "{ probe = \"tip\", component = \"z\" }",
    const std::string &reference = "value = -0.5\nuncertainty = 0.01\nkind = \"formula\"\nsource = \"a book\"",
    const std::string &grid = "[[grid]]\nspacing = [0.1, 0.05]\n") {
  return "format = 1\n[[case]]\nname = \"beam\"\nscene = \"beam.toml\"\nquantity = " + quantity +
         "\n[case.reference]\n" + reference + "\n" + grid;
}

/// The path of a study file, next to which a scene and a table of displacements exist.
inline std::filesystem::path studyPlace() {
  const std::filesystem::path folder = testOutputFolder();
  std::ofstream(folder / "beam.toml") << "format = 1\n";
  std::ofstream(folder / "truth.csv") << "body,x [m],y [m],z [m],ux [m],uy [m],uz [m]\nb,0,0,0,0.1,0,0\n";
  return folder / "study.toml";
}
