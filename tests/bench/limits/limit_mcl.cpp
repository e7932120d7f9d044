// SPDX-License-Identifier: Apache-2.0
// Highway compiles this file once for each SIMD target and picks one at run time.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/bench/limits/limits.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/bench/limits/limit_mcl.cpp"
// clang-format off
#include <hwy/foreach_target.h>  // IWYU pragma: keep
// clang-format on
#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace strata::limit::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;
#include "tests/bench/limits/lanes.inc"
using DU = hn::RebindToUnsigned<D>;
using V = hn::Vec<D>;

/// xorshift32, a state a lane.
V uniform(std::uint32_t* state) {
  const D d;
  const DU du;
  auto s = hn::LoadU(du, state);
  s = hn::Xor(s, hn::ShiftLeft<13>(s));
  s = hn::Xor(s, hn::ShiftRight<17>(s));
  s = hn::Xor(s, hn::ShiftLeft<5>(s));
  hn::StoreU(s, du, state);
  const auto whole = hn::ConvertTo(d, hn::BitCast(DI(), hn::ShiftRight<8>(s)));
  return hn::MulAdd(whole, hn::Set(d, 0x1p-24F), hn::Set(d, 0x1p-25F));
}

void normals(std::uint32_t* state, V& a, V& b) {
  const D d;
  const auto radius = hn::Sqrt(hn::Mul(hn::Set(d, -2.0F), hn::Log(d, uniform(state))));
  const auto angle = hn::Mul(hn::Set(d, 2.0F * std::numbers::pi_v<float>), uniform(state));
  a = hn::Mul(radius, hn::Cos(d, angle));
  b = hn::Mul(radius, hn::Sin(d, angle));
}

}  // namespace

void weigh_gather_lanes(const Field& field, const Points& points, Particles& particles) {
  const D d;
  const DI di;
  const auto zero = hn::Zero(d);
  const auto last_x = hn::Set(d, static_cast<float>(field.width - 1));
  const auto last_y = hn::Set(d, static_cast<float>(field.height - 1));
  const auto width = hn::Set(di, field.width);
  const std::size_t lanes = hn::Lanes(d);
  for (std::size_t i = 0; i + lanes <= particles.size(); i += lanes) {
    const auto x = hn::LoadU(d, &particles.x[i]);
    const auto y = hn::LoadU(d, &particles.y[i]);
    const auto c = hn::LoadU(d, &particles.cosine[i]);
    const auto s = hn::LoadU(d, &particles.sine[i]);
    auto sum = hn::Zero(d);
    for (std::size_t k = 0; k < points.count; ++k) {
      const auto px = hn::Set(d, points.x[k]);
      const auto py = hn::Set(d, points.y[k]);
      auto u = hn::NegMulAdd(s, py, hn::MulAdd(c, px, x));
      auto v = hn::MulAdd(c, py, hn::MulAdd(s, px, y));
      u = hn::Min(hn::Max(u, zero), last_x);
      v = hn::Min(hn::Max(v, zero), last_y);
      const auto index = hn::Add(hn::Mul(hn::ConvertTo(di, v), width), hn::ConvertTo(di, u));
      sum = hn::Add(sum, hn::GatherIndex(d, field.values, index));
    }
    hn::StoreU(sum, d, &particles.sum[i]);
  }
}

void weigh_plain_lanes(const Field& field, const Points& points, Particles& particles) {
  const auto last_x = static_cast<float>(field.width - 1);
  const auto last_y = static_cast<float>(field.height - 1);
  const float* const x = particles.x.data();
  const float* const y = particles.y.data();
  const float* const c = particles.cosine.data();
  const float* const s = particles.sine.data();
  float* const sum = particles.sum.data();
  std::fill(particles.sum.begin(), particles.sum.end(), 0.0F);
  // Particles innermost, in blocks that stay in the first cache, so that the compiler sees lanes.
  constexpr std::size_t kBlock = 256;
  for (std::size_t begin = 0; begin < particles.size(); begin += kBlock) {
    const std::size_t end = std::min(begin + kBlock, particles.size());
    for (std::size_t k = 0; k < points.count; ++k) {
      const float px = points.x[k];
      const float py = points.y[k];
      for (std::size_t i = begin; i < end; ++i) {
        const float u = std::min(std::max(x[i] + c[i] * px - s[i] * py, 0.0F), last_x);
        const float v = std::min(std::max(y[i] + s[i] * px + c[i] * py, 0.0F), last_y);
        sum[i] +=
            field.values[static_cast<std::int32_t>(v) * field.width + static_cast<std::int32_t>(u)];
      }
    }
  }
}

void move_lanes(const Motion& motion, std::uint32_t* state, Particles& now) {
  const D d;
  const std::size_t lanes = hn::Lanes(d);
  const auto r_stddev = hn::Set(d, motion.rotation_stddev);
  const auto t_stddev = hn::Set(d, motion.translation_stddev);
  for (std::size_t i = 0; i + lanes <= now.size(); i += lanes) {
    V n1;
    V n2;
    V n3;
    V unused;
    normals(&state[i], n1, n2);
    normals(&state[i], n3, unused);
    const auto r1 = hn::Add(hn::LoadU(d, &now.theta[i]),
                            hn::MulAdd(r_stddev, n1, hn::Set(d, motion.rotation1)));
    const auto t = hn::MulAdd(t_stddev, n2, hn::Set(d, motion.translation));
    const auto theta = hn::Add(r1, hn::MulAdd(r_stddev, n3, hn::Set(d, motion.rotation2)));
    hn::StoreU(hn::MulAdd(t, hn::Cos(d, r1), hn::LoadU(d, &now.x[i])), d, &now.x[i]);
    hn::StoreU(hn::MulAdd(t, hn::Sin(d, r1), hn::LoadU(d, &now.y[i])), d, &now.y[i]);
    hn::StoreU(theta, d, &now.theta[i]);
    hn::StoreU(hn::Cos(d, theta), d, &now.cosine[i]);
    hn::StoreU(hn::Sin(d, theta), d, &now.sine[i]);
  }
}

Mcl::Mean estimate_lanes(float tempering, Particles& now) {
  const D d;
  const std::size_t lanes = hn::Lanes(d);
  auto most = hn::LoadU(d, &now.sum[0]);
  for (std::size_t i = 0; i + lanes <= now.size(); i += lanes) {
    most = hn::Max(most, hn::LoadU(d, &now.sum[i]));
  }
  most = hn::MaxOfLanes(d, most);
  const auto factor = hn::Set(d, 1.0F / tempering);
  auto w_sum = hn::Zero(d);
  auto x_sum = w_sum;
  auto y_sum = w_sum;
  auto c_sum = w_sum;
  auto s_sum = w_sum;
  for (std::size_t i = 0; i + lanes <= now.size(); i += lanes) {
    const auto w = hn::Exp(d, hn::Mul(hn::Sub(hn::LoadU(d, &now.sum[i]), most), factor));
    hn::StoreU(w, d, &now.weight[i]);
    w_sum = hn::Add(w_sum, w);
    x_sum = hn::MulAdd(w, hn::LoadU(d, &now.x[i]), x_sum);
    y_sum = hn::MulAdd(w, hn::LoadU(d, &now.y[i]), y_sum);
    c_sum = hn::MulAdd(w, hn::LoadU(d, &now.cosine[i]), c_sum);
    s_sum = hn::MulAdd(w, hn::LoadU(d, &now.sine[i]), s_sum);
  }
  const float w = hn::GetLane(hn::SumOfLanes(d, w_sum));
  return {hn::GetLane(hn::SumOfLanes(d, x_sum)) / w, hn::GetLane(hn::SumOfLanes(d, y_sum)) / w,
          hn::GetLane(hn::SumOfLanes(d, c_sum)) / w, hn::GetLane(hn::SumOfLanes(d, s_sum)) / w};
}

void resample_lanes(Particles& now, Particles& next) {
  double total = 0.0;
  for (const float w : now.weight) total += static_cast<double>(w);
  const double step = total / static_cast<double>(now.size());
  double target = 0.5 * step;
  double cumulated = static_cast<double>(now.weight[0]);
  std::size_t i = 0;
  for (std::size_t j = 0; j < now.size(); ++j, target += step) {
    while (cumulated < target && i + 1 < now.size()) {
      cumulated += static_cast<double>(now.weight[++i]);
    }
    next.x[j] = now.x[i];
    next.y[j] = now.y[i];
    next.theta[j] = now.theta[i];
  }
  std::swap(now.x, next.x);
  std::swap(now.y, next.y);
  std::swap(now.theta, next.theta);
}

}  // namespace strata::limit::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace strata::limit {

HWY_EXPORT(weigh_gather_lanes);
HWY_EXPORT(weigh_plain_lanes);
HWY_EXPORT(move_lanes);
HWY_EXPORT(estimate_lanes);
HWY_EXPORT(resample_lanes);

Particles::Particles(std::size_t count)
    : x(count), y(count), theta(count), cosine(count), sine(count), sum(count), weight(count) {}

void weigh_gather(const Field& field, const Points& points, Particles& particles) {
  HWY_DYNAMIC_DISPATCH(weigh_gather_lanes)(field, points, particles);
}

void weigh_plain(const Field& field, const Points& points, Particles& particles) {
  HWY_DYNAMIC_DISPATCH(weigh_plain_lanes)(field, points, particles);
}

Mcl::Mcl(std::size_t count) : now_(count), next_(count), state_(count * 2 + 64) {
  for (std::size_t i = 0; i < state_.size(); ++i) {
    state_[i] = static_cast<std::uint32_t>(i + 1) * 0x9E3779B9U;
  }
}

Mcl::Mean Mcl::update(const Motion& motion, const Field& field, const Points& points,
                      float tempering) {
  HWY_DYNAMIC_DISPATCH(move_lanes)(motion, state_.data(), now_);
  weigh_gather(field, points, now_);
  const Mean mean = HWY_DYNAMIC_DISPATCH(estimate_lanes)(tempering, now_);
  HWY_DYNAMIC_DISPATCH(resample_lanes)(now_, next_);
  return mean;
}

}  // namespace strata::limit
#endif  // HWY_ONCE
