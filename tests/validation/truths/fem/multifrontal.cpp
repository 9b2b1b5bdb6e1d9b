// SPDX-License-Identifier: Apache-2.0
#include "multifrontal.h"

#include "ordering.h"

#include <algorithm>
#include <cmath>

namespace truth {
namespace {

std::size_t at(int index) { return static_cast<std::size_t>(index); }

/// Eliminates the first `pivots` columns of the lower half of `a` in place: unit L below, D on the diagonal, the Schur
/// complement in the rest. @return number of negative pivots, or -1 if one vanishes
int eliminate(Eigen::MatrixXd &a, Eigen::Index pivots) {
  constexpr Eigen::Index kPanel = 48;
  const Eigen::Index size = a.rows();
  int negative = 0;
  for (Eigen::Index start = 0; start < pivots; start += kPanel) {
    const Eigen::Index width = std::min(kPanel, pivots - start);
    for (Eigen::Index c = start; c < start + width; ++c) {  // the panel, column by column
      const double pivot = a(c, c);
      if (!std::isfinite(pivot) || pivot == 0.0) return -1;
      negative += pivot < 0.0;
      const Eigen::Index below = size - c - 1;
      for (Eigen::Index k = c + 1; k < start + width; ++k) {
        const double multiplier = a(k, c) / pivot;
        a.col(k).tail(size - k) -= multiplier * a.col(c).tail(size - k);
      }
      a.col(c).tail(below) /= pivot;
    }
    const Eigen::Index rest = size - start - width;
    if (rest == 0) continue;
    const auto panel = a.block(start + width, start, rest, width);
    const Eigen::MatrixXd scaled = panel * a.diagonal().segment(start, width).asDiagonal();
    a.bottomRightCorner(rest, rest).triangularView<Eigen::Lower>() -= scaled * panel.transpose();
  }
  return negative;
}

}  // namespace

Multifrontal::Multifrontal(const Model &model, const std::vector<int> &numbers)
    : place_(at(*std::max_element(numbers.begin(), numbers.end()) + 1), -1) {
  for (const Hex27 &element : model.elements) {
    auto &list = elementUnknowns_.emplace_back();
    for (int d = 0; d < kElementDofs; ++d) list[at(d)] = numbers[at(3 * element.nodes[at(d / 3)] + d % 3)];
  }
  std::vector<int> stamp(place_.size(), -1);
  for (const Part &part : dissect(model)) {
    const int index = static_cast<int>(fronts_.size());
    Front front{part.first, part.second, part.element, {}, 0, {}, {}};
    const auto add = [&](int unknown) {
      if (unknown < 0 || stamp[at(unknown)] == index) return;
      stamp[at(unknown)] = index;
      front.unknowns.push_back(unknown);
    };
    for (const int node : part.nodes) {
      for (int i = 0; i < 3; ++i) add(numbers[at(3 * node + i)]);
    }
    front.pivots = static_cast<int>(front.unknowns.size());
    if (part.element >= 0) {
      for (const int unknown : elementUnknowns_[at(part.element)]) add(unknown);
    } else {
      for (const int child : {part.first, part.second}) {
        const auto &of = fronts_[at(child)];
        std::for_each(of.unknowns.begin() + of.pivots, of.unknowns.end(), add);
      }
    }
    fronts_.push_back(std::move(front));
  }
}

void Multifrontal::extend(Front &child, Eigen::MatrixXd &matrix) {
  const auto border = child.unknowns.size() - at(child.pivots);
  for (std::size_t c = 0; c < border; ++c) {
    const int column = place_[at(child.unknowns[at(child.pivots) + c])];
    for (std::size_t r = c; r < border; ++r) {
      const int row = place_[at(child.unknowns[at(child.pivots) + r])];
      matrix(std::max(row, column), std::min(row, column)) +=
          child.complement(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c));
    }
  }
  child.complement.resize(0, 0);
}

bool Multifrontal::factorize(const std::function<const ElementMatrix &(int)> &matrixOf) {
  negativePivots_ = 0;
  for (Front &front : fronts_) {
    const auto size = static_cast<Eigen::Index>(front.unknowns.size());
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(size, size);
    for (std::size_t i = 0; i < front.unknowns.size(); ++i) place_[at(front.unknowns[i])] = static_cast<int>(i);
    if (front.element >= 0) {
      const ElementMatrix &element = matrixOf(front.element);
      const auto &list = elementUnknowns_[at(front.element)];
      for (int c = 0; c < kElementDofs; ++c) {
        if (list[at(c)] < 0) continue;
        const int column = place_[at(list[at(c)])];
        for (int r = 0; r < kElementDofs; ++r) {
          if (list[at(r)] < 0) continue;
          const int row = place_[at(list[at(r)])];
          if (row >= column) matrix(row, column) += element(r, c);
        }
      }
    } else {
      extend(fronts_[at(front.first)], matrix);
      extend(fronts_[at(front.second)], matrix);
    }
    const int negative = eliminate(matrix, front.pivots);
    if (negative < 0) return false;
    negativePivots_ += negative;
    front.factor = matrix.leftCols(front.pivots);
    front.complement = matrix.bottomRightCorner(size - front.pivots, size - front.pivots);
  }
  return true;
}

Eigen::VectorXd Multifrontal::solve(const Eigen::VectorXd &right) const {
  Eigen::VectorXd x = right;
  const auto gather = [&](const Front &front) {
    Eigen::VectorXd out(static_cast<Eigen::Index>(front.unknowns.size()));
    for (Eigen::Index i = 0; i < out.size(); ++i) out(i) = x(front.unknowns[static_cast<std::size_t>(i)]);
    return out;
  };
  for (const Front &front : fronts_) {  // L, halves before the whole
    Eigen::VectorXd local = gather(front);
    const Eigen::Index k = front.pivots, rest = local.size() - k;
    if (k == 0) continue;
    auto head = local.head(k);
    front.factor.topRows(k).triangularView<Eigen::UnitLower>().solveInPlace(head);
    local.tail(rest) -= front.factor.bottomRows(rest) * local.head(k);
    for (Eigen::Index i = 0; i < local.size(); ++i) x(front.unknowns[static_cast<std::size_t>(i)]) = local(i);
  }
  for (auto it = fronts_.rbegin(); it != fronts_.rend(); ++it) {  // D and L^T, the whole before its halves
    const Front &front = *it;
    const Eigen::Index k = front.pivots;
    if (k == 0) continue;
    const Eigen::VectorXd local = gather(front);
    Eigen::VectorXd head = local.head(k).cwiseQuotient(front.factor.topRows(k).diagonal());
    head -= front.factor.bottomRows(local.size() - k).transpose() * local.tail(local.size() - k);
    front.factor.topRows(k).transpose().triangularView<Eigen::UnitUpper>().solveInPlace(head);
    for (Eigen::Index i = 0; i < k; ++i) x(front.unknowns[static_cast<std::size_t>(i)]) = head(i);
  }
  return x;
}

}  // namespace truth
