// SPDX-License-Identifier: Apache-2.0
#include "core/patch_beams/single_beams.hpp"

#include "core/rays/bundle_kernel.hpp"

namespace strata::patch_beams {

rays::SingleRows& SingleBeams::rows(std::size_t more) {
  const std::size_t count = rows_.count + more;
  if (row_.size() < count) {
    row_.resize(2 * count);
    for (auto* column : {&from_m_, &to_m_, &hidden_, &range_m_}) {
      column->resize(2 * count * rays::BeamBundles::kVector);
    }
  }
  rows_.rows = row_.data();
  rows_.from_m = from_m_.data();
  rows_.to_m = to_m_.data();
  rows_.hidden = hidden_.data();
  return rows_;
}

void SingleBeams::cast(const rays::RayTable& table, const rays::BeamBundles& bundles) {
  rays::cast_rows(table, bundles, rows_, range_m_.data());
}

}  // namespace strata::patch_beams
