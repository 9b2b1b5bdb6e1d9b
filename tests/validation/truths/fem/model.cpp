// SPDX-License-Identifier: Apache-2.0
#include "model.h"

#include <stdexcept>
#include <string>

namespace truth {
namespace {

template <typename T, typename Read>
void readList(std::istream &in, std::vector<T> &list, Read readOne) {
  std::size_t count = 0;
  in >> count;
  for (std::size_t i = 0; i < count && in; ++i) list.push_back(readOne());
}

Eigen::Vector3d readVector(std::istream &in) {
  Eigen::Vector3d v;
  in >> v.x() >> v.y() >> v.z();
  return v;
}

}  // namespace

Model readModel(std::istream &in) {
  Model model;
  std::string section;
  while (in >> section && section != "end") {
    if (section == "laws") {
      readList(in, model.laws, [&] {
        std::string name;
        double youngsModulus = 0.0, poissonRatio = 0.0, density = 0.0;
        in >> name >> youngsModulus >> poissonRatio >> density;
        return makeLaw(name, youngsModulus, poissonRatio, density);
      });
    } else if (section == "nodes") {
      readList(in, model.nodes, [&] { return readVector(in); });
    } else if (section == "elements") {
      readList(in, model.elements, [&] {
        Hex27 element;
        in >> element.law;
        for (int &node : element.nodes) in >> node;
        return element;
      });
    } else if (section == "stages") {
      readList(in, model.loadFactors, [&] {
        double factor = 0.0;
        in >> factor;
        return factor;
      });
    } else if (section == "held") {
      readList(in, model.held, [&] {
        Held held;
        in >> held.node >> held.axis;
        held.values.resize(model.loadFactors.size());
        for (double &value : held.values) in >> value;
        return held;
      });
    } else if (section == "forces") {
      readList(in, model.forces, [&] {
        NodalForce force;
        in >> force.node;
        force.force = readVector(in);
        return force;
      });
    } else if (section == "pressures") {
      readList(in, model.pressures, [&] {
        PressureFace face;
        in >> face.pressure >> face.element;
        for (int &node : face.nodes) in >> node;
        return face;
      });
    } else if (section == "gravity") {
      model.gravity = readVector(in);
    } else if (section == "increments") {
      in >> model.increments;
    } else {
      throw std::runtime_error("unknown section: " + section);
    }
  }
  if (!in || model.loadFactors.empty()) throw std::runtime_error("the model is cut short");
  return model;
}

}  // namespace truth
