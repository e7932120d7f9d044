// SPDX-License-Identifier: Apache-2.0
#include "components/localizer/filter_mask.hpp"

#include <utility>

#include "components/convert/geometry_messages.hpp"
#include "components/convert/map_messages.hpp"

namespace strata::localizer {

nav2_msgs::msg::CostmapFilterInfo filter_info(const site::FilterMeaning& meaning,
                                              const std::string& mask_topic, Stamp stamp,
                                              const std::string& frame) {
  nav2_msgs::msg::CostmapFilterInfo info;
  info.header(convert::make_header(stamp, frame));
  info.type(meaning.type);
  info.filter_mask_topic(mask_topic);
  info.base(meaning.base);
  info.multiplier(meaning.multiplier);
  return info;
}

FilterMask::FilterMask(std::string topic, SendMask send_mask, SendInfo send_info)
    : topic_(std::move(topic)),
      send_mask_(std::move(send_mask)),
      send_info_(std::move(send_info)) {}

void FilterMask::send(const ReflectionGrid& values, const site::FilterMeaning& meaning, Stamp stamp,
                      const std::string& frame) {
  if (told_ != meaning) send_info_(filter_info(meaning, topic_, stamp, frame));
  told_ = meaning;
  send_mask_(convert::to_occupancy(values, stamp, frame));
}

}  // namespace strata::localizer
