// SPDX-License-Identifier: Apache-2.0
#include "ordering.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <span>

namespace truth {
namespace {

class Dissection {
 public:
  explicit Dissection(const Model &model) : model_(model), taken_(model.nodes.size(), false), seen_(taken_.size(), 0) {
    for (const Hex27 &element : model.elements) {
      Eigen::Vector3d centre = Eigen::Vector3d::Zero();
      for (const int node : element.nodes) centre += model.nodes[static_cast<std::size_t>(node)];
      centres_.push_back(centre / kNodesPerElement);
      elements_.push_back(static_cast<int>(elements_.size()));
    }
    divide(elements_);
  }

  std::vector<Part> parts() && { return std::move(parts_); }

 private:
  auto lessAlongLongestSide(std::span<const int> elements) const {
    Eigen::AlignedBox3d box;
    for (const int e : elements) box.extend(centres_[static_cast<std::size_t>(e)]);
    Eigen::Index axis = 0;
    box.sizes().maxCoeff(&axis);
    return [this, axis](int a, int b) {
      const double left = centres_[static_cast<std::size_t>(a)][axis];
      const double right = centres_[static_cast<std::size_t>(b)][axis];
      return left != right ? left < right : a < b;
    };
  }

  /// @return index of the part
  int divide(std::span<int> elements) {
    Part part;
    if (elements.size() == 1) {
      part.element = elements.front();
      for (const int node : nodesOf(part.element)) take(node, part);
    } else {
      const auto middle = static_cast<std::ptrdiff_t>(elements.size() / 2);
      std::nth_element(elements.begin(), elements.begin() + middle, elements.end(), lessAlongLongestSide(elements));
      const auto first = elements.first(elements.size() / 2), second = elements.subspan(elements.size() / 2);
      ++stamp_;
      for (const int e : first) {
        for (const int node : nodesOf(e)) seen_[static_cast<std::size_t>(node)] = stamp_;
      }
      for (const int e : second) {
        for (const int node : nodesOf(e)) {
          if (seen_[static_cast<std::size_t>(node)] == stamp_) take(node, part);
        }
      }
      part.first = divide(first);
      part.second = divide(second);
    }
    parts_.push_back(std::move(part));
    return static_cast<int>(parts_.size()) - 1;
  }

  const std::array<int, kNodesPerElement> &nodesOf(int element) const {
    return model_.elements[static_cast<std::size_t>(element)].nodes;
  }

  void take(int node, Part &part) {
    if (taken_[static_cast<std::size_t>(node)]) return;
    taken_[static_cast<std::size_t>(node)] = true;
    part.nodes.push_back(node);
  }

  const Model &model_;
  std::vector<Part> parts_;
  std::vector<Eigen::Vector3d> centres_;
  std::vector<int> elements_;
  std::vector<bool> taken_;
  std::vector<int> seen_;
  int stamp_ = 0;
};

}  // namespace

std::vector<Part> dissect(const Model &model) { return Dissection(model).parts(); }

}  // namespace truth
