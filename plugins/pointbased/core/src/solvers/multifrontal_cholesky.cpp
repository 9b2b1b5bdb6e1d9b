// SPDX-License-Identifier: Apache-2.0
#include "solvers/multifrontal_cholesky.h"

#include <Eigen/Cholesky>
#include <Eigen/OrderingMethods>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace pointbased::detail {

namespace {

using Sparse = Eigen::SparseMatrix<double>;

// Zeros that a merged front may contain, as a fraction; small fronts may contain more, as their cost is overhead
// anyway.
constexpr double kZeros = 0.05, kZerosSmall = 0.25;
constexpr int kSmallColumns = 6;

// Blocks with a common entry, without the diagonal.
std::vector<std::vector<int>> blockGraph(const Sparse &m) {
  std::vector<std::vector<int>> graph(static_cast<std::size_t>(m.cols() / 3));
  for (std::size_t j = 0; j < graph.size(); ++j) {
    for (int c = 0; c < 3; ++c)
      for (Sparse::InnerIterator it(m, static_cast<Eigen::Index>(3 * j) + c); it; ++it) {
        const int i = static_cast<int>(it.row() / 3);
        if (i != static_cast<int>(j) && (graph[j].empty() || graph[j].back() != i)) graph[j].push_back(i);
      }
    std::sort(graph[j].begin(), graph[j].end());
    graph[j].erase(std::unique(graph[j].begin(), graph[j].end()), graph[j].end());
  }
  return graph;
}

// Elimination tree of the graph in the given order.
std::vector<int> eliminationTree(const std::vector<std::vector<int>> &graph, const std::vector<int> &order,
                                 const std::vector<int> &position) {
  std::vector<int> parent(order.size(), -1), ancestor(order.size(), -1);
  for (int j = 0; j < static_cast<int>(order.size()); ++j)
    for (const int neighbour : graph[static_cast<std::size_t>(order[static_cast<std::size_t>(j)])]) {
      int i = position[static_cast<std::size_t>(neighbour)];
      while (i != -1 && i < j) {
        const auto at = static_cast<std::size_t>(i);
        const int next = ancestor[at];
        ancestor[at] = j;
        if (next == -1) parent[at] = j;
        i = next;
      }
    }
  return parent;
}

std::vector<std::vector<int>> childrenOf(const std::vector<int> &parent) {
  std::vector<std::vector<int>> children(parent.size());
  for (std::size_t i = 0; i < parent.size(); ++i)
    if (parent[i] >= 0) children[static_cast<std::size_t>(parent[i])].push_back(static_cast<int>(i));
  return children;
}

// Children before their parents, whole subtrees contiguous.
std::vector<int> postorder(const std::vector<int> &parent) {
  const std::vector<std::vector<int>> children = childrenOf(parent);
  std::vector<int> out, stack;
  std::vector<std::size_t> next(parent.size(), 0);
  for (std::size_t root = 0; root < parent.size(); ++root) {
    if (parent[root] >= 0) continue;
    stack.push_back(static_cast<int>(root));
    while (!stack.empty()) {
      const auto at = static_cast<std::size_t>(stack.back());
      if (next[at] < children[at].size()) {
        stack.push_back(children[at][next[at]++]);
      } else {
        out.push_back(stack.back());
        stack.pop_back();
      }
    }
  }
  return out;
}

double trapezoid(int columns, int rows) {
  return 0.5 * columns * (columns + 1.0) + static_cast<double>(columns) * rows;
}

}  // namespace

void MultifrontalCholesky::orderColumns(const std::vector<std::vector<int>> &graph) {
  const auto n = static_cast<int>(graph.size());
  Sparse pattern(n, n);
  std::vector<Eigen::Triplet<double>> entries;
  for (int j = 0; j < n; ++j) {
    entries.emplace_back(j, j, 1.0);
    for (const int i : graph[static_cast<std::size_t>(j)]) entries.emplace_back(i, j, 1.0);
  }
  pattern.setFromTriplets(entries.begin(), entries.end());
  Eigen::AMDOrdering<int>::PermutationType permutation;
  Eigen::AMDOrdering<int>()(pattern, permutation);

  order_.assign(permutation.indices().data(), permutation.indices().data() + n);
  position_.resize(order_.size());
  const auto invert = [this] {
    for (std::size_t k = 0; k < order_.size(); ++k)
      position_[static_cast<std::size_t>(order_[k])] = static_cast<int>(k);
  };
  invert();
  const std::vector<int> post = postorder(eliminationTree(graph, order_, position_));
  std::vector<int> sorted(order_.size());
  for (std::size_t k = 0; k < post.size(); ++k) sorted[k] = order_[static_cast<std::size_t>(post[k])];
  order_.swap(sorted);
  invert();
}

void MultifrontalCholesky::findFronts(const std::vector<std::vector<int>> &graph) {
  const std::size_t n = order_.size();
  const std::vector<int> parent = eliminationTree(graph, order_, position_);
  const std::vector<std::vector<int>> children = childrenOf(parent);

  // Rows of every column of L: those of A and of the children.
  std::vector<std::vector<int>> rows(n);
  std::vector<int> seen(n, -1);
  for (std::size_t j = 0; j < n; ++j) {
    const auto column = static_cast<int>(j);
    const auto add = [&](int i) {
      if (i <= column || seen[static_cast<std::size_t>(i)] == column) return;
      seen[static_cast<std::size_t>(i)] = column;
      rows[j].push_back(i);
    };
    for (const int neighbour : graph[static_cast<std::size_t>(order_[j])])
      add(position_[static_cast<std::size_t>(neighbour)]);
    for (const int child : children[j])
      for (const int i : rows[static_cast<std::size_t>(child)]) add(i);
    std::sort(rows[j].begin(), rows[j].end());
  }

  std::vector<Front> fronts;
  for (std::size_t j = 0; j < n; ++j) {
    const bool joins = j > 0 && parent[j - 1] == static_cast<int>(j) && rows[j - 1].size() == rows[j].size() + 1;
    if (!joins) fronts.emplace_back().first = static_cast<int>(j);
    fronts.back().last = static_cast<int>(j) + 1;
  }
  for (Front &front : fronts) front.rows = std::move(rows[static_cast<std::size_t>(front.last - 1)]);
  mergeFronts(fronts, parent);
}

// A front is merged with that of its parent if they are adjacent in the order and few zeros result, from the root
// downwards.
void MultifrontalCholesky::mergeFronts(std::vector<Front> &fronts, const std::vector<int> &parent) {
  std::vector<int> frontOf(order_.size());
  std::vector<double> zeros(fronts.size(), 0.0);
  for (std::size_t s = 0; s < fronts.size(); ++s)
    for (int j = fronts[s].first; j < fronts[s].last; ++j) frontOf[static_cast<std::size_t>(j)] = static_cast<int>(s);
  for (std::size_t s = fronts.size(); s-- > 0;) {
    Front &front = fronts[s];
    const int above = parent[static_cast<std::size_t>(front.last - 1)];
    if (above < 0) continue;
    const auto p = static_cast<std::size_t>(frontOf[static_cast<std::size_t>(above)]);
    Front &into = fronts[p];
    if (into.first != front.last) continue;
    const double empty =
        zeros[p] + static_cast<double>(front.columns()) * (into.size() - static_cast<double>(front.rows.size()));
    const int columns = front.columns() + into.columns();
    const double allowed = columns <= kSmallColumns ? kZerosSmall : kZeros;
    if (empty > allowed * trapezoid(columns, static_cast<int>(into.rows.size()))) continue;
    zeros[p] = empty;
    for (int j = front.first; j < front.last; ++j) frontOf[static_cast<std::size_t>(j)] = static_cast<int>(p);
    into.first = front.first;
    front.last = front.first;  // empty now
  }

  fronts_.clear();
  entries_ = work_ = 0.0;
  std::size_t end = 0;
  Eigen::Index longest = 0;
  std::vector<int> kept(fronts.size(), -1);
  for (std::size_t s = 0; s < fronts.size(); ++s) {
    if (fronts[s].columns() == 0) continue;
    kept[s] = static_cast<int>(fronts_.size());
    Front &front = fronts_.emplace_back(std::move(fronts[s]));
    front.panel = end;
    end += 9 * static_cast<std::size_t>(front.size()) * static_cast<std::size_t>(front.columns());
    longest = std::max(longest, 3 * static_cast<Eigen::Index>(front.rows.size()));
    for (int j = 0; j < front.columns(); ++j) {
      const double rows = 3.0 * (front.size() - j);
      entries_ += 3.0 * rows;
      work_ += 1.5 * rows * rows;
    }
  }
  for (Front &front : fronts_)
    if (!front.rows.empty())
      front.parent = kept[static_cast<std::size_t>(frontOf[static_cast<std::size_t>(front.rows.front())])];
  panels_.resize(static_cast<Eigen::Index>(end));
  gathered_.resize(longest);
}

void MultifrontalCholesky::analyse(const Sparse &matrix) {
  const std::vector<std::vector<int>> graph = blockGraph(matrix);
  orderColumns(graph);
  findFronts(graph);
}

namespace {

constexpr double kUnaskedWork = 1e9;  // multiply-adds between two checks of the stop request: a fraction of a second

// Eliminates the first `inner` columns of a dense front: L11 L11^T = F11, L21 = F21 L11^-T, update F22 - L21 L21^T.
// Large fronts are processed in panels. Returns false if the front is not positive definite.
bool eliminate(Eigen::MatrixXd &dense, Eigen::Index inner, const StopRequest *stop) {
  const double square = static_cast<double>(dense.rows()) * static_cast<double>(dense.rows());
  const double most = std::max(32.0, kUnaskedWork / square);
  const Eigen::Index width = static_cast<double>(inner) <= 2.0 * most ? inner : static_cast<Eigen::Index>(most);
  for (Eigen::Index first = 0; first < inner; first += width) {
    throwIfStopRequested(stop);
    const Eigen::Index columns = std::min(width, inner - first), below = dense.rows() - first - columns;
    Eigen::Ref<Eigen::MatrixXd> F11 = dense.block(first, first, columns, columns);
    const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> llt(F11);
    if (llt.info() != Eigen::Success || !F11.diagonal().allFinite()) return false;
    if (below == 0) break;
    auto F21 = dense.block(first + columns, first, below, columns);
    F11.triangularView<Eigen::Lower>().transpose().solveInPlace<Eigen::OnTheRight>(F21);
    dense.bottomRightCorner(below, below).selfadjointView<Eigen::Lower>().rankUpdate(F21, -1.0);
  }
  return true;
}

}  // namespace

bool MultifrontalCholesky::factorise(const Sparse &matrix, double diagonalShift, const StopRequest *stop) {
  const double added = diagonalShift * matrix.diagonal().cwiseAbs().mean();
  std::vector<int> local(order_.size(), 0);              // row of a block in the current front
  std::vector<Eigen::MatrixXd> updates(fronts_.size());  // contributions of fronts not yet added to their parents
  std::vector<std::vector<std::size_t>> children(fronts_.size());
  for (std::size_t s = 0; s < fronts_.size(); ++s)
    if (fronts_[s].parent >= 0) children[static_cast<std::size_t>(fronts_[s].parent)].push_back(s);

  Eigen::MatrixXd dense;
  for (std::size_t s = 0; s < fronts_.size(); ++s) {
    const Front &front = fronts_[s];
    for (int j = front.first; j < front.last; ++j) local[static_cast<std::size_t>(j)] = j - front.first;
    for (std::size_t k = 0; k < front.rows.size(); ++k)
      local[static_cast<std::size_t>(front.rows[k])] = front.columns() + static_cast<int>(k);
    dense.setZero(3 * front.size(), 3 * front.size());

    // The lower triangle of A's columns.
    for (int j = front.first; j < front.last; ++j)
      for (int c = 0; c < 3; ++c) {
        const Eigen::Index column = 3 * Eigen::Index(local[static_cast<std::size_t>(j)]) + c;
        for (Sparse::InnerIterator it(matrix, 3 * Eigen::Index(order_[static_cast<std::size_t>(j)]) + c); it; ++it) {
          const int i = position_[static_cast<std::size_t>(it.row() / 3)];
          if (i < j) continue;
          dense(3 * Eigen::Index(local[static_cast<std::size_t>(i)]) + it.row() % 3, column) += it.value();
        }
        dense(column, column) += diagonalShift * dense(column, column) + added;
      }
    // Contributions of the children.
    for (const std::size_t child : children[s]) {
      const std::vector<int> &rows = fronts_[child].rows;
      Eigen::MatrixXd &update = updates[child];
      for (std::size_t b = 0; b < rows.size(); ++b)
        for (std::size_t a = b; a < rows.size(); ++a)
          dense.block<3, 3>(3 * Eigen::Index(local[static_cast<std::size_t>(rows[a])]),
                            3 * Eigen::Index(local[static_cast<std::size_t>(rows[b])])) +=
              update.block<3, 3>(3 * static_cast<Eigen::Index>(a), 3 * static_cast<Eigen::Index>(b));
      update.resize(0, 0);
    }

    const Eigen::Index inner = 3 * Eigen::Index(front.columns()), below = dense.rows() - inner;
    if (!eliminate(dense, inner, stop)) return false;
    if (below > 0) updates[s] = dense.bottomRightCorner(below, below);
    Eigen::Map<Eigen::MatrixXf>(panels_.data() + front.panel, dense.rows(), inner) =
        dense.leftCols(inner).cast<float>();
  }
  return true;
}

void MultifrontalCholesky::solve(std::span<const Vec3> b, std::span<Vec3> x) {
  // Scaled so that forces of any magnitude fit into floats.
  double largest = 0.0;
  for (const Vec3 &v : b) largest = std::max(largest, v.cwiseAbs().maxCoeff());
  const double scale = largest > 0.0 && std::isfinite(largest) ? largest : 1.0;
  permuted_.resize(3 * static_cast<Eigen::Index>(b.size()));
  for (std::size_t k = 0; k < order_.size(); ++k)
    permuted_.segment<3>(3 * static_cast<Eigen::Index>(k)) =
        (b[static_cast<std::size_t>(order_[k])] / scale).cast<float>();

  const auto panel = [this](const Front &front) {
    return Eigen::Map<const Eigen::MatrixXf>(panels_.data() + front.panel, 3 * Eigen::Index(front.size()),
                                             3 * Eigen::Index(front.columns()));
  };
  for (const Front &front : fronts_) {
    const auto L = panel(front);
    auto head = permuted_.segment(3 * Eigen::Index(front.first), L.cols());
    L.topRows(L.cols()).triangularView<Eigen::Lower>().solveInPlace(head);
    auto below = gathered_.head(L.rows() - L.cols());
    below.noalias() = L.bottomRows(below.size()) * head;
    for (std::size_t k = 0; k < front.rows.size(); ++k)
      permuted_.segment<3>(3 * Eigen::Index(front.rows[k])) -= below.segment<3>(3 * static_cast<Eigen::Index>(k));
  }
  for (std::size_t s = fronts_.size(); s-- > 0;) {
    const Front &front = fronts_[s];
    const auto L = panel(front);
    auto head = permuted_.segment(3 * Eigen::Index(front.first), L.cols());
    auto below = gathered_.head(L.rows() - L.cols());
    for (std::size_t k = 0; k < front.rows.size(); ++k)
      below.segment<3>(3 * static_cast<Eigen::Index>(k)) = permuted_.segment<3>(3 * Eigen::Index(front.rows[k]));
    head.noalias() -= L.bottomRows(below.size()).transpose() * below;
    L.topRows(L.cols()).triangularView<Eigen::Lower>().transpose().solveInPlace(head);
  }
  for (std::size_t k = 0; k < order_.size(); ++k)
    x[static_cast<std::size_t>(order_[k])] =
        scale * permuted_.segment<3>(3 * static_cast<Eigen::Index>(k)).cast<double>();
}

}  // namespace pointbased::detail
