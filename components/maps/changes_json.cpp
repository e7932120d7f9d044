// SPDX-License-Identifier: Apache-2.0
#include "components/maps/changes_json.hpp"

namespace strata::maps {

nlohmann::ordered_json to_json(std::span<const memory::ChangedPlace> places) {
  using Json = nlohmann::ordered_json;
  const auto point = [](const Eigen::Vector2d& p) -> Json { return {p.x(), p.y()}; };
  Json json = Json::array();
  for (const memory::ChangedPlace& place : places) {
    json.push_back({{"kind", place.kind == memory::ChangeKind::kAppeared ? "appeared" : "vanished"},
                    {"center", point(place.center_m())},
                    {"min", point(place.min_m)},
                    {"max", point(place.max_m)},
                    {"cells", place.cells}});
  }
  return json;
}

}  // namespace strata::maps
