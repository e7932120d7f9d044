// SPDX-License-Identifier: Apache-2.0
// Highway compiles this file once for each SIMD target and picks one at run time.
#include "core/rays/bundle_kernel.hpp"

#include <limits>

#include "core/rays/ray_boxes.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/rays/bundle_kernel.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace strata::rays::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
#include "core/rays/ray_lanes.inc"

/// A vector of bundles from `bundle` on, looking along beam `beam`.
HWY_INLINE Rays rays_of(const RayTable& table, const BeamBundles& bundles, std::size_t beam,
                        std::size_t bundle, Lanes from, Lanes to, bool is_inside) {
  const Tag d;
  const auto hc = hn::LoadU(d, bundles.heading_cosine + bundle);
  const auto hs = hn::LoadU(d, bundles.heading_sine + bundle);
  const auto bc = hn::Set(d, bundles.cosine[beam]);
  const auto bs = hn::Set(d, bundles.sine[beam]);
  const auto c = hn::Sub(hn::Mul(hc, bc), hn::Mul(hs, bs));
  const auto s = hn::Add(hn::Mul(hs, bc), hn::Mul(hc, bs));
  return Rays(Axis(hn::LoadU(d, bundles.column + bundle), c, table.width),
              Axis(hn::LoadU(d, bundles.row + bundle), s, table.height), from, to, is_inside);
}

/// The vectors of all beams of all bundles, one after the other.
class AllBeams {
 public:
  HWY_INLINE AllBeams(const RayTable& table, const BeamBundles& bundles)
      : table_(table), bundles_(bundles), count_(bundles.beams * bundles.count) {}
  /// How many results.
  [[nodiscard]] HWY_INLINE std::size_t count() const { return count_; }
  [[nodiscard]] HWY_INLINE Rays next() {
    const Tag d;
    const Rays rays = rays_of(table_, bundles_, beam_, bundle_, hn::Zero(d),
                              hn::Set(d, bundles_.max_range_m / table_.resolution_m), false);
    bundle_ += hn::Lanes(d);
    if (bundle_ == bundles_.count) {
      bundle_ = 0;
      ++beam_;
    }
    return rays;
  }
  [[nodiscard]] HWY_INLINE Lanes limit(const Rays& rays) const { return rays.end; }
  static HWY_INLINE void step(const RayTable& table, Rays& rays, Lanes /*hidden*/) {
    rays.step(table);
  }
  /// SingleRows::hidden of the vector taken last.
  [[nodiscard]] HWY_INLINE Lanes hidden() const { return hn::Zero(Tag()); }

 private:
  const RayTable& table_;
  const BeamBundles& bundles_;
  std::size_t count_;
  std::size_t beam_ = 0;
  std::size_t bundle_ = 0;
};

/// The vectors of rows.
class AllRows {
 public:
  HWY_INLINE AllRows(const RayTable& table, const BeamBundles& bundles, const SingleRows& rows)
      : table_(table), bundles_(bundles), rows_(rows) {}
  [[nodiscard]] HWY_INLINE std::size_t count() const { return rows_.count * BeamBundles::kVector; }
  [[nodiscard]] HWY_INLINE Rays next() {
    const Tag d;
    const SingleRow& row = rows_.rows[at_ / BeamBundles::kVector];
    const auto per_m = hn::Set(d, 1.0 / table_.resolution_m);
    const Rays rays = rays_of(table_, bundles_, row.beam, row.bundle + at_ % BeamBundles::kVector,
                              hn::Mul(hn::LoadU(d, rows_.from_m + at_), per_m),
                              hn::Mul(hn::LoadU(d, rows_.to_m + at_), per_m), true);
    at_ += hn::Lanes(d);
    return rays;
  }
  /// A range ends with the beam, not with the box.
  [[nodiscard]] HWY_INLINE Lanes limit(const Rays& /*rays*/) const {
    return hn::Set(Tag(), bundles_.max_range_m / table_.resolution_m);
  }
  static HWY_INLINE void step(const RayTable& table, Rays& rays, Lanes hidden) {
    rays.step_past(table, hidden);
  }
  [[nodiscard]] HWY_INLINE Lanes hidden() const {
    return hn::LoadU(Tag(), rows_.hidden + at_ - hn::Lanes(Tag()));
  }

 private:
  const RayTable& table_;
  const BeamBundles& bundles_;
  const SingleRows& rows_;
  std::size_t at_ = 0;
};

/// Three vectors walk abreast, so that one works while another waits for the table; each takes the
/// next when it is done.
template <class Vectors>
HWY_INLINE void walk_all(const RayTable& table, Vectors& vectors, double* range_m) {
  const Tag d;
  if (vectors.count() == 0) return;
  std::size_t taken = 0;
  int walking = 0;
  const auto begin = [&](Rays& rays, Lanes& hidden, double*& out) HWY_ATTR {
    if (taken == vectors.count()) return;
    rays = vectors.next();
    hidden = vectors.hidden();
    out = range_m + taken;
    taken += hn::Lanes(d);
    ++walking;
  };
  double* a_out = range_m;
  double* b_out = nullptr;
  double* c_out = nullptr;
  Rays a = vectors.next();
  taken = hn::Lanes(d);
  walking = 1;
  Lanes a_hidden = vectors.hidden();
  Rays b = a;
  Lanes b_hidden = a_hidden;
  Rays c = a;
  Lanes c_hidden = a_hidden;
  begin(b, b_hidden, b_out);
  begin(c, c_hidden, c_out);
  const auto walk = [&](Rays& rays, Lanes& hidden, double*& out) HWY_ATTR {
    Vectors::step(table, rays, hidden);
    if (!hn::AllFalse(d, rays.is_active) || out == nullptr) return;
    hn::StoreU(rays.ranges(table.resolution_m, vectors.limit(rays)), d, out);
    out = nullptr;
    --walking;
    begin(rays, hidden, out);
  };
  while (walking > 0) {
    walk(a, a_hidden, a_out);
    walk(b, b_hidden, b_out);
    walk(c, c_hidden, c_out);
  }
}

void cast_bundles_lanes(const RayTable& table, const BeamBundles& bundles, double* range_m) {
  AllBeams vectors(table, bundles);
  walk_all(table, vectors, range_m);
}

void cast_rows_lanes(const RayTable& table, const BeamBundles& bundles, const SingleRows& rows,
                     double* range_m) {
  AllRows vectors(table, bundles, rows);
  walk_all(table, vectors, range_m);
}

}  // namespace strata::rays::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace strata::rays {

HWY_EXPORT(cast_bundles_lanes);
HWY_EXPORT(cast_rows_lanes);

void cast_bundles(const RayTable& table, const BeamBundles& bundles, double* range_m) {
  HWY_DYNAMIC_DISPATCH(cast_bundles_lanes)(table, bundles, range_m);
}

void cast_rows(const RayTable& table, const BeamBundles& bundles, const SingleRows& rows,
               double* range_m) {
  HWY_DYNAMIC_DISPATCH(cast_rows_lanes)(table, bundles, rows, range_m);
}

}  // namespace strata::rays
#endif  // HWY_ONCE
