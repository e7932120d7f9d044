// SPDX-License-Identifier: Apache-2.0
/// A floor plan in the words of a command line.
#pragma once

#include <string>

#include "components/site/floor_plan.hpp"
#include "core/geometry/pose2.hpp"
#include "core/plan/plan_registration.hpp"
#include "tools/strata/site_actions.hpp"

namespace strata::tools {

/// Where it lies, and how well it fits.
[[nodiscard]] std::string words_of(const site::FloorPlan& plan);

/// Throws InputError where it is not said in one way.
[[nodiscard]] site::DrawingScale scale_of(const PlanOptions& options);

/// Of --near. Throws InputError.
[[nodiscard]] Pose2 guessed_place(const std::string& near);

/// Throws InputError where the plan has no place, or several.
void require_one_place(const plan::PlanRegistration& found, const std::string& file);

}  // namespace strata::tools
