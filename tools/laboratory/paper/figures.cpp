// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/paper/figures.hpp"

namespace strata::paper {

std::vector<Figure> all_figures() {
  std::vector<Figure> all;
  for (const auto& figures :
       {em_figures(), patch_figures(), kessler_figures(), kessler_turning_figures(), ptm_figures(),
        ptm_cloud_figures(), ptm_building_figures(), ptm_mass_figures()}) {
    all.insert(all.end(), figures.begin(), figures.end());
  }
  return all;
}

}  // namespace strata::paper
