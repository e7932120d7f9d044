// SPDX-License-Identifier: Apache-2.0
// Highway compiles this file once for each SIMD target and picks one at run time.
#include "core/localization/motion_kernel.hpp"

#include <algorithm>
#include <numbers>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/localization/motion_kernel.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace strata::localization::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
#include "core/base/lane_math.inc"

using WordLanes = hn::Vec<Words>;

/// One block of Philox4x32-10 [salmon2011parallel] a lane, in the low halves of 64-bit words; the
/// high halves hold rubbish in between, which the multiplication does not see.
HWY_INLINE void philox(const MotionDraw& draw, std::size_t first, WordLanes out[4]) {
  const Words d;
  const auto multiply = [](WordLanes a, WordLanes b) {
#if HWY_TARGET == HWY_SCALAR  // which has no two words in one of twice the width
    return hn::Set(Words(), (hn::GetLane(a) & 0xFFFFFFFFU) * (hn::GetLane(b) & 0xFFFFFFFFU));
#else
    const hn::Repartition<std::uint32_t, Words> d32;
    return hn::MulEven(hn::BitCast(d32, a), hn::BitCast(d32, b));
#endif
  };
  const auto m0 = hn::Set(d, 0xD2511F53U);
  const auto m1 = hn::Set(d, 0xCD9E8D57U);
  auto c0 = hn::Zero(d);
  auto c1 = hn::Iota(d, first);
  auto c2 = hn::Set(d, draw.step & 0xFFFFFFFFU);
  auto c3 = hn::Set(d, draw.step >> 32U);
  std::uint32_t k0 = draw.key[0];
  std::uint32_t k1 = draw.key[1];
  for (int round = 0; round < 10; ++round) {
    const auto p0 = multiply(m0, c0);
    const auto p1 = multiply(m1, c2);
    c0 = hn::Xor(hn::Xor(hn::ShiftRight<32>(p1), c1), hn::Set(d, k0));
    c2 = hn::Xor(hn::Xor(hn::ShiftRight<32>(p0), c3), hn::Set(d, k1));
    c1 = p1;
    c3 = p0;
    k0 += 0x9E3779B9U;
    k1 += 0xBB67AE85U;
  }
  const auto low = hn::Set(d, 0xFFFFFFFFU);
  out[0] = hn::And(c0, low);
  out[1] = hn::And(c1, low);
  out[2] = hn::And(c2, low);
  out[3] = hn::And(c3, low);
}

/// Two independent standard normals from two words below 2^32, after Box and Muller.
HWY_INLINE void normals(WordLanes word0, WordLanes word1, Lanes& a, Lanes& b) {
  const Tag d;
  const Words du;
  const auto whole = [&](WordLanes word) {
    return hn::Sub(hn::BitCast(d, hn::Or(word, hn::Set(du, 0x4330000000000000ULL))),
                   hn::Set(d, 0x1p52));
  };
  const auto u = hn::Mul(hn::Add(whole(word0), hn::Set(d, 0.5)), hn::Set(d, 0x1p-32));
  const auto angle = hn::Mul(whole(word1), hn::Set(d, 0x1p-31 * std::numbers::pi));
  const auto radius = hn::Sqrt(hn::Mul(hn::Set(d, -2.0), log_of(d, u)));
  Lanes sine;
  Lanes cosine;
  sin_cos(d, angle, sine, cosine);
  a = hn::Mul(radius, cosine);
  b = hn::Mul(radius, sine);
}

HWY_INLINE void draw_row(const MotionDraw& draw, bool has_back, std::size_t first, double* x_m,
                         double* y_m, double* theta_rad) {
  const Tag d;
  auto x = hn::LoadU(d, x_m);
  auto y = hn::LoadU(d, y_m);
  auto theta = hn::LoadU(d, theta_rad);
  Lanes s;
  Lanes c;
  const auto go = [&](Lanes along, Lanes across) {
    x = hn::Add(x, hn::Sub(hn::Mul(c, along), hn::Mul(s, across)));
    y = hn::Add(y, hn::Add(hn::Mul(s, along), hn::Mul(c, across)));
  };
  if (has_back) {
    sin_cos(d, theta, s, c);
    go(hn::Set(d, draw.back.x), hn::Set(d, draw.back.y));
    theta = hn::Add(theta, hn::Set(d, draw.back.theta));
  }
  WordLanes words[4];
  philox(draw, first, words);
  Lanes n[4];
  normals(words[0], words[1], n[0], n[1]);
  normals(words[2], words[3], n[2], n[3]);
  const auto noisy = [&](double mean, double stddev, Lanes normal) {
    return hn::Add(hn::Set(d, mean), hn::Mul(hn::Set(d, stddev), normal));
  };
  theta = hn::Add(theta, noisy(draw.rotation1_rad, draw.rotation1_stddev_rad, n[0]));
  sin_cos(d, theta, s, c);
  go(noisy(draw.translation_m, draw.translation_stddev_m, n[1]),
     hn::Mul(hn::Set(d, draw.across_stddev_m), n[2]));
  theta = hn::Add(theta, noisy(draw.rotation2_rad, draw.rotation2_stddev_rad, n[3]));
  hn::StoreU(x, d, x_m);
  hn::StoreU(y, d, y_m);
  hn::StoreU(wrap_lanes(d, theta), d, theta_rad);
}

/// Calls row(i, x, y, theta) for poses i, i + 1, ... of one vector each; the last ones are copied
/// to a row that zeros fill up.
template <class Row>
HWY_INLINE void for_rows(const PoseColumns& poses, Row&& row) {
  const std::size_t lanes = hn::Lanes(Tag());
  std::size_t i = 0;
  for (; i + lanes <= poses.count; i += lanes) {
    row(i, poses.x_m + i, poses.y_m + i, poses.theta_rad + i);
  }
  if (i == poses.count) return;
  double rest[3][kParts] = {};
  std::copy(poses.x_m + i, poses.x_m + poses.count, rest[0]);
  std::copy(poses.y_m + i, poses.y_m + poses.count, rest[1]);
  std::copy(poses.theta_rad + i, poses.theta_rad + poses.count, rest[2]);
  row(i, rest[0], rest[1], rest[2]);
  const std::size_t left = poses.count - i;
  std::copy(rest[0], rest[0] + left, poses.x_m + i);
  std::copy(rest[1], rest[1] + left, poses.y_m + i);
  std::copy(rest[2], rest[2] + left, poses.theta_rad + i);
}

void draw_motions_lanes(const MotionDraw& draw, std::size_t first, const PoseColumns& poses) {
  const bool has_back = !(draw.back == Pose2{});
  for_rows(poses, [&](std::size_t i, double* x_m, double* y_m, double* theta_rad) {
    draw_row(draw, has_back, first + i, x_m, y_m, theta_rad);
  });
}

void move_poses_lanes(const Pose2& motion, const PoseColumns& poses) {
  for_rows(poses, [&](std::size_t, double* x_m, double* y_m, double* theta_rad) {
    const Tag d;
    const auto theta = hn::LoadU(d, theta_rad);
    const auto along = hn::Set(d, motion.x);
    const auto across = hn::Set(d, motion.y);
    Lanes s;
    Lanes c;
    sin_cos(d, theta, s, c);
    const auto x = hn::Sub(hn::Mul(c, along), hn::Mul(s, across));
    const auto y = hn::Add(hn::Mul(s, along), hn::Mul(c, across));
    hn::StoreU(hn::Add(hn::LoadU(d, x_m), x), d, x_m);
    hn::StoreU(hn::Add(hn::LoadU(d, y_m), y), d, y_m);
    hn::StoreU(wrap_lanes(d, hn::Add(theta, hn::Set(d, motion.theta))), d, theta_rad);
  });
}

}  // namespace strata::localization::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace strata::localization {

HWY_EXPORT(draw_motions_lanes);
HWY_EXPORT(move_poses_lanes);

void draw_motions(const MotionDraw& draw, std::size_t first, const PoseColumns& poses) {
  HWY_DYNAMIC_DISPATCH(draw_motions_lanes)(draw, first, poses);
}

void move_poses(const Pose2& before_from_after, const PoseColumns& poses) {
  HWY_DYNAMIC_DISPATCH(move_poses_lanes)(before_from_after, poses);
}

}  // namespace strata::localization
#endif  // HWY_ONCE
