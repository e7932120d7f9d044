// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "tools/laboratory/experiments/cluster_rows.hpp"
#include "tools/laboratory/paper/patch_drawings.hpp"
#include "tools/laboratory/paper/svg_drawing.hpp"

namespace strata::paper {
namespace {

using experiments::ClusterRows;
using experiments::over_base;

constexpr double kCell = 3.0;  // pixels
constexpr double kGap = 10.0;
constexpr double kWords = 130.0;
constexpr double kMembership = 16.0;

std::vector<double> doubles(std::span<const float> values) {
  return {values.begin(), values.end()};
}

/// A row of centroids for each number of clusters, as the paper draws them.
std::vector<Picture> draw_rows(const ClusterRows& rows) {
  const CellRect& rect = rows.submap.rect;
  const double width = kCell * rect.width();
  const double height = kCell * rect.height();
  const double most = static_cast<double>(rows.rows.size());
  SvgDrawing drawing(kWords + most * (width + kGap) + kGap, most * (height + kGap) + kGap);
  for (std::size_t k = 0; k < rows.rows.size(); ++k) {
    const double y = kGap + static_cast<double>(k) * (height + kGap);
    drawing.text(kGap, y + 16.0, 14.0, std::to_string(k + 1) + (k == 0 ? " cluster" : " clusters"));
    drawing.text(kGap, y + 34.0, 12.0, report::fixed(rows.criterion[k], 0) + " nats");
    if (k == rows.best()) drawing.text(kGap, y + 52.0, 12.0, "greatest");
    for (std::size_t c = 0; c <= k; ++c) {
      const double x = kWords + static_cast<double>(c) * (width + kGap);
      drawing.cells(over_base(rows, rows.rows[k].centroids[c]), rect, x, y, kCell);
      drawing.frame(x, y, width, height, "#555");
    }
  }
  return picture_of(drawing, "patch-1.18-rows_centroids",
                    "centroids of one cluster, two, and so on, first seed");
}

/// A line a local map: the map, and how much it belongs to each cluster of the best row.
std::vector<Picture> draw_memberships(const ClusterRows& rows) {
  const CellRect& rect = rows.submap.rect;
  const double cell = kCell / 2.0;
  const double width = cell * rect.width();
  const double height = std::max(cell * rect.height(), kMembership);
  const patch::FuzzyClusters& best = rows.rows[rows.best()];
  const double clusters = static_cast<double>(best.centroids.size());
  const double maps = static_cast<double>(rows.states.size());
  const double left = 2.0 * kGap + width;
  SvgDrawing drawing(left + clusters * (width + kGap), kGap + (maps + 1.0) * (height + kGap));
  for (std::size_t c = 0; c < best.centroids.size(); ++c) {
    const double x = left + static_cast<double>(c) * (width + kGap);
    drawing.cells(over_base(rows, best.centroids[c]), rect, x, kGap, cell);
    drawing.frame(x, kGap, width, height, "#555");
  }
  for (std::size_t i = 0; i < rows.states.size(); ++i) {
    const double y = kGap + static_cast<double>(i + 1) * (height + kGap);
    drawing.cells(over_base(rows, doubles(rows.local_maps.row(i))), rect, kGap, y, cell);
    drawing.frame(kGap, y, width, height, "#bbb");
    for (std::size_t c = 0; c < best.centroids.size(); ++c) {
      const double x = left + static_cast<double>(c) * (width + kGap);
      const double share = best.memberships[i][c];
      drawing.rect(x, y + 0.5 * (height - kMembership), share * width, kMembership, "#56b4e9");
      drawing.frame(x, y + 0.5 * (height - kMembership), width, kMembership, "#999");
      drawing.text(x + 4.0, y + 0.5 * height + 4.5, 12.0, report::fixed(share, 2));
    }
  }
  return picture_of(
      drawing, "patch-1.18-rows_memberships",
      "local maps, the centroids of the best row, and how much each map belongs to each, first "
      "seed");
}

}  // namespace

Outcome rows_of_centroids(const Setting& setting) {
  const int seeds = setting.seeds_or(20);
  int four = 0;
  int redundant = 0;
  int split = 0;
  double nearer = 0.0;
  std::size_t maps = 0;
  std::size_t right = 0;
  double membership = 0.0;
  std::vector<Number> first;
  std::vector<Picture> pictures;
  for (int i = 0; i < seeds; ++i) {
    const auto rows = experiments::cluster_rows((setting.scenarios / "four_states.yaml").string(),
                                                setting.seed(i));
    if (!rows) continue;
    const bool is_four = rows->best() == 3 && rows->rows.size() == 5;
    four += is_four ? 1 : 0;
    redundant += is_four && rows->nearest_centres(4) < 0.5 * rows->nearest_centres(3) ? 1 : 0;
    split += rows->splits_a_state() ? 1 : 0;
    if (is_four) nearer += rows->nearest_centres(4) / rows->nearest_centres(3);
    maps += rows->states.size();
    right += rows->rightly_clustered();
    membership += rows->mean_membership() / seeds;
    if (i > 0) continue;
    for (std::size_t k = 0; k < rows->rows.size(); ++k) {
      first.push_back({"criterion of " + std::to_string(k + 1) + ", first seed [nats]",
                       {},
                       rows->criterion[k],
                       0});
    }
    pictures = draw_rows(*rows);
    for (Picture& picture : draw_memberships(*rows)) pictures.push_back(std::move(picture));
  }
  std::vector<Number> numbers{
      {"seeds", {}, static_cast<double>(seeds), 0},
      {"ended by the fifth, with four", {}, static_cast<double>(four), 0},
      {"in which the fifth is redundant", {}, static_cast<double>(redundant), 0},
      {"in which it splits a state", {}, static_cast<double>(split), 0},
      {"least distance of centroids, five to four", {}, nearer / std::max(1, four), 2},
      {"local maps", {}, static_cast<double>(maps), 0},
      {"in the cluster of their state", {}, static_cast<double>(right), 0},
      {"mean of the greatest membership", {}, membership, 3}};
  numbers.insert(numbers.end(), first.begin(), first.end());
  const bool ends = 10 * four >= 9 * seeds && 2 * redundant > seeds;
  return judged(
      ends && maps > 0 && 20 * right >= 19 * maps,
      ends ? "local maps belong to clusters of other states"
      : 10 * four >= 9 * seeds
          ? "it ends with four, but the fifth, which splits a state, is more than half as "
            "far from another as the four are apart"
          : "the search does not end with four clusters",
      std::move(numbers), std::move(pictures));
}

}  // namespace strata::paper
