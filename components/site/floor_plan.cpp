// SPDX-License-Identifier: Apache-2.0
#include "components/site/floor_plan.hpp"

#include <algorithm>
#include <cmath>
#include <system_error>
#include <utility>

#include <nlohmann/json.hpp>

#include "components/log/json_text.hpp"
#include "components/log/map_file.hpp"
#include "components/log/map_image.hpp"
#include "components/log/sha256.hpp"
#include "components/log/text.hpp"
#include "components/log/whole_file.hpp"
#include "components/log/whole_folder.hpp"
#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::site {
namespace {

using nlohmann::json;

constexpr const char* kDrawing = "drawing.yaml";
constexpr double kCell_m = 0.02;
constexpr double kLeastPixel_m = 1e-4;
constexpr double kLargestPixel_m = 0.5;
constexpr double kLeastSide_m = 1.0;
constexpr double kLargestSide_m = 1000.0;
constexpr std::size_t kMaxCells = 50'000'000;
constexpr double kMostDrawn = 0.5;

log::MapImage picture(const fs::path& file) try {
  return log::read_map_image(file, file.string());
} catch (const InputError& error) {
  std::error_code reason;
  const bool is_there = fs::is_regular_file(file, reason);
  throw InputError(file.string(), is_there ? error.problem() : "is missing or no file",
                   "give a whole PNG, PGM or BMP, or a map_server YAML");
}

bool is_drawn(const log::MapImage& image, std::size_t i, const DrawingScale& scale) {
  double bright = static_cast<double>(image.pixels[i]) / image.white;
  if (scale.is_inverted) bright = 1.0 - bright;
  if (!image.alpha.empty()) {  // paper shines through
    const double opaque = static_cast<double>(image.alpha[i]) / 255.0;
    bright = opaque * bright + 1.0 - opaque;
  }
  return bright < scale.dark;
}

ReflectionGrid lines_of(const log::MapImage& image, const DrawingScale& scale,
                        const std::string& place) {
  const double pixel_m = scale.metres_per_pixel;
  const int joined = std::max(1, static_cast<int>(std::floor(kCell_m / pixel_m + 1e-9)));
  const CellRect rect{{0, 0},
                      {(image.width + joined - 1) / joined, (image.height + joined - 1) / joined}};
  if (rect.area() > kMaxCells) {
    throw InputError(place, "has too many pixels for its scale", "draw it at 1 to 5 cm a pixel");
  }
  ReflectionGrid lines = make_reflection_grid(joined * pixel_m, rect);
  std::fill(lines.values().begin(), lines.values().end(), 0.0F);
  const auto width = static_cast<std::size_t>(image.width);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    if (!is_drawn(image, i, scale)) continue;
    const int up = image.height - 1 - static_cast<int>(i / width);
    lines.at({static_cast<int>(i % width) / joined, up / joined}) = 1.0F;
  }
  return lines;
}

void require_sense(const ReflectionGrid& lines, const std::string& place) {
  const double side_m = lines.resolution_m() * std::max(lines.width(), lines.height());
  if (side_m < kLeastSide_m || side_m > kLargestSide_m) {
    throw InputError(place,
                     "would be " + log::format_number(std::round(side_m * 100.0) / 100.0) +
                         " m wide, which is no building",
                     "check the metres per pixel");
  }
  const auto drawn =
      static_cast<double>(std::count_if(lines.values().begin(), lines.values().end(), is_occupied));
  if (drawn == 0.0) {
    throw InputError(place, "shows nothing: no pixel is dark enough",
                     "draw walls in black on white, or give --dark");
  }
  if (drawn > kMostDrawn * static_cast<double>(lines.size())) {
    throw InputError(place, "is mostly dark", "give --inverted for light lines on dark ground");
  }
}

json json_of(const plan::PlanPlace& fit) {
  return {{"score", fit.score},
          {"map_share", fit.map_share},
          {"plan_share", fit.plan_share},
          {"residual_m", fit.residual_m},
          {"thicker_m", fit.thicker_m}};
}

}  // namespace

Drawing read_drawing(const fs::path& file, const DrawingScale& scale) {
  Drawing drawing;
  drawing.name = file.filename().string();
  const std::string place = file.string();
  if (scale.metres_per_pixel == 0.0) {
    const ReflectionGrid map = log::read_map(file);
    drawing.lines = map;
    for (float& value : drawing.lines.values()) value = is_occupied(value) ? 1.0F : 0.0F;
  } else {
    if (!(scale.metres_per_pixel >= kLeastPixel_m && scale.metres_per_pixel <= kLargestPixel_m)) {
      throw InputError(place + ": scale",
                       "of " + log::format_number(scale.metres_per_pixel) +
                           " m a pixel is that of no floor plan",
                       "give 0.0001 to 0.5");
    }
    drawing.lines = lines_of(picture(file), scale, place);
  }
  require_sense(drawing.lines, place);
  drawing.sha256 = log::sha256_of(log::read_whole_file(file));
  return drawing;
}

json to_json(const FloorPlan& plan) {
  const plan::SiteFromPlan& at = plan.site_from_plan;
  return {
      {"name", plan.drawing.name},
      {"sha256", plan.drawing.sha256},
      {"site_from_plan",
       {{"x_m", at.pose.x}, {"y_m", at.pose.y}, {"theta_rad", at.pose.theta}, {"scale", at.scale}}},
      {"fit", plan.fit ? json_of(*plan.fit) : json(nullptr)},
      {"version", plan.version.empty() ? json(nullptr) : json(plan.version)},
      {"by", plan.placed.by},
      {"at_ns", plan.placed.at_ns}};
}

void write_plan(const fs::path& folder, const FloorPlan& plan, const log::Disk& disk) {
  log::WholeFolder whole(folder, disk);
  std::error_code error;
  fs::create_directories(whole.aside(), error);
  if (error) {
    throw OutputError(folder.string(), "cannot be made: " + error.message(),
                      "check the permissions of the site's folder");
  }
  log::write_map(whole.aside() / kDrawing, plan.drawing.lines,
                 {.image = log::MapImageFormat::kPng});
  log::WholeFile text(whole.aside() / kPlanFile, disk);
  text.stream() << log::json_text(to_json(plan));
  text.commit();
  whole.commit();
}

FloorPlan read_plan(const fs::path& folder) {
  const std::string place = (folder / kPlanFile).string();
  const auto damaged = [&](const std::string& why) {
    return InputError(place, why, "take it away with `strata site plan SITE remove`, and set it");
  };
  std::string bytes;
  try {
    bytes = log::read_whole_file(folder / kPlanFile);
  } catch (const InputError&) {
    throw damaged("is missing or no JSON");
  }
  const json text = json::parse(bytes, nullptr, false);
  if (!text.is_object()) throw damaged("is missing or no JSON");
  FloorPlan plan;
  try {
    plan.drawing.name = text.at("name");
    plan.drawing.sha256 = text.at("sha256");
    const json& at = text.at("site_from_plan");
    plan.site_from_plan = {{at.at("x_m"), at.at("y_m"), at.at("theta_rad")}, at.at("scale")};
    if (const json& fit = text.at("fit"); !fit.is_null()) {
      plan.fit.emplace();
      plan.fit->site_from_plan = plan.site_from_plan;
      plan.fit->score = fit.at("score");
      plan.fit->map_share = fit.at("map_share");
      plan.fit->plan_share = fit.at("plan_share");
      plan.fit->residual_m = fit.at("residual_m");
      plan.fit->thicker_m = fit.at("thicker_m");
    }
    if (!text.at("version").is_null()) plan.version = text.at("version");
    plan.placed = {text.at("by"), text.at("at_ns")};
  } catch (const json::exception&) {
    throw damaged("is damaged");
  }
  if (!is_finite(plan.site_from_plan.pose) || !(plan.site_from_plan.scale > 0.0)) {
    throw damaged("is damaged");
  }
  plan.drawing.lines = log::read_map(folder / kDrawing);
  return plan;
}

}  // namespace strata::site
