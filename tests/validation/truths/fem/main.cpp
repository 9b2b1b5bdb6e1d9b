// SPDX-License-Identifier: Apache-2.0
//
// truth_fem MODEL RESULT: solves the model (see model.h) and writes, per node, displacement and internal force.
// Exit status 1 with a message if the model cannot be read or Newton does not converge.
#include "newton.h"

#include <cstdio>
#include <exception>
#include <fstream>
#include <stdexcept>

int main(int argc, char **argv) {
  try {
    if (argc != 3) throw std::runtime_error("usage: truth_fem MODEL RESULT");
    std::ifstream in(argv[1]);
    if (!in) throw std::runtime_error(std::string("cannot read ") + argv[1]);
    const truth::Model model = truth::readModel(in);
    const truth::Solution solution = truth::solve(model);
    std::ofstream out(argv[2]);
    out.precision(12);
    out << "freedoms " << solution.freedoms << " iterations " << solution.iterations << " smallest_J "
        << solution.smallestJacobian << " negative_pivots " << solution.negativePivots << '\n';
    for (std::size_t n = 0; n < model.nodes.size(); ++n) {
      out << solution.displacements[n].transpose() << ' ' << solution.internalForces[n].transpose() << '\n';
    }
    if (!out.flush()) throw std::runtime_error(std::string("cannot write ") + argv[2]);
    return 0;
  } catch (const std::exception &error) {
    std::fprintf(stderr, "truth_fem: %s\n", error.what());
    return 1;
  }
}
