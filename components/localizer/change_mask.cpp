// SPDX-License-Identifier: Apache-2.0
#include "components/localizer/change_mask.hpp"

#include <cstddef>
#include <cstdint>

namespace strata::localizer {
namespace {

/// nav2's types of costmap filters.
constexpr std::uint8_t kKeepout = 0;
constexpr std::uint8_t kSpeedLimitInPercent = 1;

constexpr double kPercent = 100.0;
constexpr float kLeastPercent = 0.005F;  // what rounds to 1

}  // namespace

bool has_change_mask(const maps::MapModelDescriptor& model) {
  return model.needs_part(maps::MapPart::kPatches) ||
         model.needs_part(maps::MapPart::kPlacePatches);
}

std::vector<patch::SubmapOutlook> outlook_of(const localization::PatchStates& states,
                                             std::span<const float> usual,
                                             const std::vector<patch::Shares>& beliefs) {
  std::vector<patch::SubmapOutlook> outlook;
  for (std::size_t s = 0; s < beliefs.size(); ++s) {
    const auto own = usual.subspan(states.offset(s), beliefs[s].size());
    outlook.push_back({beliefs[s], patch::Shares(own.begin(), own.end()), states.rate_per_s(s)});
  }
  return outlook;
}

ReflectionGrid mask_of(const Grid<float>& change, const ReflectionGrid& occupied,
                       const ChangeMaskConfig& config) {
  const bool is_penalty = config.kind == ChangeMaskKind::kPenalty;
  const auto scale = is_penalty ? static_cast<float>(config.max_penalty / kPercent) : 1.0F;
  ReflectionGrid mask(change.resolution_m(), change.rect(), kUnknownReflection);
  for (std::size_t i = 0; i < mask.size(); ++i) {
    const float value = scale * change.values()[i];
    const bool is_left = is_penalty && (value < kLeastPercent || !is_known(occupied.values()[i]));
    mask.values()[i] = is_left ? kUnknownReflection : value;
  }
  return mask;
}

site::FilterMeaning meaning_of(const ChangeMaskConfig& config) {
  if (config.kind == ChangeMaskKind::kPenalty) return {kKeepout, 0.0F, 1.0F};
  return {kSpeedLimitInPercent, static_cast<float>(kPercent),
          static_cast<float>((config.min_speed - kPercent) / kPercent)};
}

}  // namespace strata::localizer
