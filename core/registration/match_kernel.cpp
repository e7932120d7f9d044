// SPDX-License-Identifier: Apache-2.0
// Highway compiles this file once for each SIMD target and picks one at run time.
#include "core/registration/match_kernel.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/registration/match_kernel.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

#ifndef STRATA_MATCH_KERNEL_TASK
#define STRATA_MATCH_KERNEL_TASK
namespace strata::registration {

constexpr std::size_t kSums = 12;

/// What one evaluation reads; plain pointers, so that every target compiles the same.
struct MatchTask {
  const double* x_m;
  const double* y_m;
  const double* weight;
  std::size_t count;  // a whole number of rows of eight
  Pose2 pose;
  double cosine;
  double sine;
  double resolution_m;
  CellRect rect;
  const std::int32_t* nearest;
  const SurfacePoint* points;
  double inverse_variance;
  double hit_weight;
};

}  // namespace strata::registration
#endif

HWY_BEFORE_NAMESPACE();
namespace strata::registration::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
#include "core/base/lane_math.inc"

/// The surfaces nearest to a few points, one a lane.
struct alignas(64) Surfaces {
  double x_m[kParts];
  double y_m[kParts];
  double normal_x[kParts];
  double normal_y[kParts];
  double tangential[kParts];
  double slack_m[kParts];
  double near[kParts];  // 1, or 0 where there is none

  void look_up(const MatchTask& task, const double* cell_x, const double* cell_y,
               std::size_t lanes) {
    static constexpr SurfacePoint kNowhere{0.0, 0.0, 1.0, 0.0, 1.0, 0.0, false};
    const int width = task.rect.width();
    const int height = task.rect.height();
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const double x = cell_x[lane] - task.rect.min.x;
      const double y = cell_y[lane] - task.rect.min.y;
      const SurfacePoint* point = &kNowhere;
      if (x >= 0.0 && y >= 0.0 && x < width && y < height) {
        const std::int32_t index =
            task.nearest[static_cast<std::ptrdiff_t>(y) * width + static_cast<std::ptrdiff_t>(x)];
        if (index >= 0 && task.points[index].occupied) point = &task.points[index];
      }
      x_m[lane] = point->x_m;
      y_m[lane] = point->y_m;
      normal_x[lane] = point->normal_x;
      normal_y[lane] = point->normal_y;
      tangential[lane] = point->tangential;
      slack_m[lane] = point->slack_m;
      near[lane] = point->occupied ? 1.0 : 0.0;
    }
  }
};

template <bool kDerivatives>
void sum_lanes(const MatchTask& task, double (*parts)[kParts]) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  const auto zero = hn::Zero(d);
  const auto c = hn::Set(d, task.cosine);
  const auto s = hn::Set(d, task.sine);
  const auto resolution = hn::Set(d, task.resolution_m);
  const auto inverse_variance = hn::Set(d, task.inverse_variance);
  const auto hit_weight = hn::Set(d, task.hit_weight);
  const auto random_weight = hn::Set(d, 1.0 - task.hit_weight);
  Surfaces near;
  alignas(64) double cell_x[kParts];
  alignas(64) double cell_y[kParts];
  for (std::size_t part = 0; part < kParts; part += lanes) {
    Lanes sum_e = zero, sum_kernel = zero, sum_log = zero;
    Lanes h00 = zero, h01 = zero, h11 = zero, h02 = zero, h12 = zero, h22 = zero;
    Lanes g0 = zero, g1 = zero, g2 = zero;
    for (std::size_t i = part; i < task.count; i += kParts) {
      const auto bx = hn::LoadU(d, task.x_m + i);
      const auto by = hn::LoadU(d, task.y_m + i);
      const auto e = hn::LoadU(d, task.weight + i);
      const auto rx = hn::Sub(hn::Mul(c, bx), hn::Mul(s, by));
      const auto ry = hn::Add(hn::Mul(s, bx), hn::Mul(c, by));
      const auto x = hn::Add(hn::Set(d, task.pose.x), rx);
      const auto y = hn::Add(hn::Set(d, task.pose.y), ry);
      hn::Store(hn::Floor(hn::Div(x, resolution)), d, cell_x);
      hn::Store(hn::Floor(hn::Div(y, resolution)), d, cell_y);
      near.look_up(task, cell_x, cell_y, lanes);
      const auto nx = hn::Load(d, near.normal_x);
      const auto ny = hn::Load(d, near.normal_y);
      const auto lambda = hn::Load(d, near.tangential);
      const auto slack = hn::Load(d, near.slack_m);
      const auto dx = hn::Sub(x, hn::Load(d, near.x_m));
      const auto dy = hn::Sub(y, hn::Load(d, near.y_m));
      const auto across = hn::Add(hn::Mul(nx, dx), hn::Mul(ny, dy));
      const auto slid = hn::Sub(hn::Mul(nx, dy), hn::Mul(ny, dx));
      const auto along = hn::Sub(slid, hn::Min(hn::Max(slid, hn::Neg(slack)), slack));
      const auto squared = hn::Add(hn::Mul(across, across), hn::Mul(lambda, hn::Mul(along, along)));
      const auto exponent = hn::Mul(hn::Set(d, -0.5), hn::Mul(inverse_variance, squared));
      const auto kernel = hn::Mul(hn::Load(d, near.near), exp_of(d, exponent));
      const auto hit = hn::Mul(hit_weight, kernel);
      const auto mixture = hn::Add(hit, random_weight);
      sum_e = hn::Add(sum_e, e);
      sum_kernel = hn::Add(sum_kernel, hn::Mul(e, kernel));
      sum_log = hn::Add(sum_log, hn::Mul(e, log_of(d, mixture)));
      if constexpr (kDerivatives) {
        const auto w = hn::Mul(hn::Mul(e, inverse_variance), hn::Div(hit, mixture));
        const auto wl = hn::IfThenElseZero(hn::Ne(along, zero), hn::Mul(w, lambda));
        const auto across_t = hn::Sub(hn::Mul(ny, rx), hn::Mul(nx, ry));
        const auto along_t = hn::Add(hn::Mul(nx, rx), hn::Mul(ny, ry));
        const auto wx = hn::Mul(w, nx);
        const auto wy = hn::Mul(w, ny);
        const auto lx = hn::Mul(wl, nx);
        const auto ly = hn::Mul(wl, ny);
        h00 = hn::Add(h00, hn::Add(hn::Mul(wx, nx), hn::Mul(ly, ny)));
        h01 = hn::Add(h01, hn::Mul(hn::Sub(wx, lx), ny));
        h11 = hn::Add(h11, hn::Add(hn::Mul(wy, ny), hn::Mul(lx, nx)));
        h02 = hn::Add(h02, hn::Sub(hn::Mul(wx, across_t), hn::Mul(ly, along_t)));
        h12 = hn::Add(h12, hn::Add(hn::Mul(wy, across_t), hn::Mul(lx, along_t)));
        h22 = hn::Add(h22, hn::Add(hn::Mul(hn::Mul(w, across_t), across_t),
                                   hn::Mul(hn::Mul(wl, along_t), along_t)));
        g0 = hn::Add(g0, hn::Sub(hn::Mul(wx, across), hn::Mul(ly, along)));
        g1 = hn::Add(g1, hn::Add(hn::Mul(wy, across), hn::Mul(lx, along)));
        g2 = hn::Add(g2, hn::Add(hn::Mul(hn::Mul(w, across_t), across),
                                 hn::Mul(hn::Mul(wl, along_t), along)));
      }
    }
    const Lanes all[kSums] = {sum_e, sum_kernel, sum_log, g0, g1, g2, h00, h01, h11, h02, h12, h22};
    for (std::size_t k = 0; k < kSums; ++k) hn::StoreU(all[k], d, parts[k] + part);
  }
}

void sum_match_lanes(const MatchTask& task, bool derivatives, double (*parts)[kParts]) {
  derivatives ? sum_lanes<true>(task, parts) : sum_lanes<false>(task, parts);
}

}  // namespace strata::registration::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace strata::registration {

HWY_EXPORT(sum_match_lanes);

MatchBeams::MatchBeams(const Endpoints& endpoints, std::span<const float> beam_weights) {
  constexpr std::size_t kRow = 8;
  const std::size_t rows = (endpoints.size() + kRow - 1) / kRow;
  x_m = endpoints.x_m;
  y_m = endpoints.y_m;
  weight.assign(endpoints.size(), 1.0);
  for (std::size_t i = 0; i < endpoints.size() && !beam_weights.empty(); ++i) {
    weight[i] = static_cast<double>(beam_weights[endpoints.beam[i]]);
  }
  for (std::vector<double>* column : {&x_m, &y_m, &weight}) column->resize(kRow * rows, 0.0);
}

MatchSums sum_match(const MatchBeams& beams, const MatchField& field, const Pose2& pose,
                    double hit_stddev_m, double hit_weight, bool derivatives) {
  const Grid<std::int32_t>& nearest = field.nearest_points();
  const MatchTask task{beams.x_m.data(),
                       beams.y_m.data(),
                       beams.weight.data(),
                       beams.weight.size(),
                       pose,
                       std::cos(pose.theta),
                       std::sin(pose.theta),
                       nearest.resolution_m(),
                       nearest.rect(),
                       nearest.values().data(),
                       field.points().data(),
                       1.0 / (hit_stddev_m * hit_stddev_m),
                       hit_weight};
  double parts[kSums][8];
  HWY_DYNAMIC_DISPATCH(sum_match_lanes)(task, derivatives, parts);
  double sums[kSums];
  for (std::size_t k = 0; k < kSums; ++k) {
    const double* p = parts[k];
    sums[k] = ((p[0] + p[1]) + (p[2] + p[3])) + ((p[4] + p[5]) + (p[6] + p[7]));
  }
  return {sums[0],
          sums[1],
          sums[2],
          {sums[3], sums[4], sums[5]},
          {sums[6], sums[7], sums[8], sums[9], sums[10], sums[11]}};
}

}  // namespace strata::registration
#endif  // HWY_ONCE
