// SPDX-License-Identifier: Apache-2.0
/// A site's floor plan: what was drawn, and where it lies in the site's frame (docs/site.md, "Floor
/// plans").
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "components/log/disk.hpp"
#include "components/site/map_version.hpp"
#include "core/grid/reflection_grid.hpp"
#include "core/plan/plan_registration.hpp"

namespace strata::site {

/// SITE/plan: plan.json, and drawing.yaml and .png as map_server has them.
inline constexpr const char* kPlanFolder = "plan";
inline constexpr const char* kPlanFile = "plan.json";

/// What a picture does not say of itself.
struct DrawingScale {
  double metres_per_pixel = 0.0;  ///< 0: the file is a map_server YAML, which says it
  double dark = 0.5;              ///< what is darker, of 1, is drawn
  bool is_inverted = false;       ///< light lines on dark ground
};

struct Drawing {
  std::string name;      ///< of the file
  std::string sha256;    ///< of the picture's bytes
  ReflectionGrid lines;  ///< 1 where something is drawn, else 0
};

/// Reads a PNG, PGM or BMP, whose lower left corner becomes the origin, or a map_server YAML.
/// Pixels of less than 1 cm are joined to cells of at most 2 cm. Throws InputError for a file that
/// is missing or damaged, a scale that no building has, and a plan in which nothing or most is
/// drawn.
[[nodiscard]] Drawing read_drawing(const std::filesystem::path& file, const DrawingScale& scale);

struct FloorPlan {
  Drawing drawing;
  plan::SiteFromPlan site_from_plan;
  /// How it was found; nothing: the site had no maps, and its frame is the plan's.
  std::optional<plan::PlanPlace> fit;
  std::string version;  ///< hash of the maps that it was registered with; may be empty
  Actor placed;
};

[[nodiscard]] nlohmann::json to_json(const FloorPlan& plan);
/// Throws OutputError.
void write_plan(const std::filesystem::path& folder, const FloorPlan& plan, const log::Disk& disk);
/// Throws InputError where it is missing or damaged.
[[nodiscard]] FloorPlan read_plan(const std::filesystem::path& folder);

}  // namespace strata::site
