// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/plan_words.hpp"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <vector>

#include "core/base/error.hpp"
#include "core/geometry/angle.hpp"
#include "tools/report/plot.hpp"

namespace fs = std::filesystem;

namespace strata::tools {
namespace {

using report::fixed;

/// "x,y,degrees" of a place, as --near takes it.
std::string place_text(const Pose2& pose) {
  return fixed(pose.x, 2) + "," + fixed(pose.y, 2) + "," + fixed(radians_to_degrees(pose.theta), 1);
}

/// The numbers of "a,b,c"; throws InputError where they are not so many finite ones.
std::vector<double> numbers_of(const std::string& option, const std::string& text,
                               std::size_t count, const char* remedy) {
  std::vector<double> numbers;
  const char* at = text.c_str();
  for (std::size_t i = 0; i < count; ++i) {
    char* end = nullptr;
    numbers.push_back(std::strtod(at, &end));
    const bool is_last = i + 1 == count;
    if (end == at || !std::isfinite(numbers.back()) || *end != (is_last ? '\0' : ',')) {
      throw InputError(option + " " + text, "is not " + std::to_string(count) + " numbers", remedy);
    }
    at = end + 1;
  }
  return numbers;
}

}  // namespace

std::string words_of(const site::FloorPlan& plan) {
  const plan::SiteFromPlan& at = plan.site_from_plan;
  std::string text =
      "plan " + plan.drawing.name + " lies at " + place_text(at.pose) + " (m, m, degrees)";
  if (!plan.fit) return text + ": the site had no maps, its frame is the plan's";
  const double off = 100.0 * (at.scale - 1.0);
  if (std::abs(off) >= 0.05) {
    text += ", " + fixed(std::abs(off), 1) + "% " + (off > 0.0 ? "larger" : "smaller") +
            " than its scale says";
  }
  return text + "; it has " + report::percent(plan.fit->map_share, 0) +
         " of the map's walls, and the map has " + report::percent(plan.fit->plan_share, 0) +
         " of its walls that were looked at";
}

site::DrawingScale scale_of(const PlanOptions& options) {
  site::DrawingScale scale;
  scale.dark = options.dark;
  scale.is_inverted = options.is_inverted;
  const std::string ending = fs::path(options.file).extension().string();
  const bool is_map = ending == ".yaml" || ending == ".yml";
  const bool has_points = !options.between.empty();
  if (is_map ? options.metres_per_pixel || has_points
             : options.metres_per_pixel.has_value() == has_points) {
    throw InputError(options.file,
                     is_map ? "says its scale itself" : "needs its scale, said in one way",
                     is_map ? "leave --metres-per-pixel and --between out"
                            : "give --metres-per-pixel, or --between with --metres");
  }
  if (options.metres_per_pixel) scale.metres_per_pixel = *options.metres_per_pixel;
  if (has_points) {
    const auto p = numbers_of("--between", options.between, 4, "give X0,Y0,X1,Y1 in pixels");
    const double pixels = std::hypot(p[2] - p[0], p[3] - p[1]);
    if (!options.metres || !(pixels > 0.0)) {
      throw InputError("--between " + options.between, "says no scale",
                       "give two points, and with --metres how far they are apart");
    }
    scale.metres_per_pixel = *options.metres / pixels;
  }
  if (!is_map && scale.metres_per_pixel == 0.0) {
    throw InputError(options.file + ": scale", "is 0", "give the metres of a pixel");
  }
  return scale;
}

Pose2 guessed_place(const std::string& near) {
  const auto n = numbers_of("--near", near, 3, "give x,y,degrees, such as 1.5,-2,90");
  return {n[0], n[1], degrees_to_radians(n[2])};
}

void require_one_place(const plan::PlanRegistration& found, const std::string& file) {
  const plan::PlanPlace& best = found.best;
  const auto of = [](const plan::PlanPlace& place) {
    return "--near " + place_text(place.site_from_plan.pose) + " (score " + fixed(place.score, 2) +
           ")";
  };
  switch (found.verdict) {
    case plan::PlanVerdict::kGood:
      return;
    case plan::PlanVerdict::kNothingDrawn:
      throw InputError(file, "shows no walls", "draw them as lines of at least 0.6 m");
    case plan::PlanVerdict::kNothingSeen:
      throw InputError(file, "cannot be compared: the active map has no walls",
                       "activate a version of the building first");
    case plan::PlanVerdict::kPoor:
      if (best.score == 0.0) {
        throw InputError(file, "fits the map nowhere there", "guess again, or leave --near out");
      }
      throw InputError(file,
                       "fits the map nowhere; best at " + place_text(best.site_from_plan.pose) +
                           ", where it has " + report::percent(best.map_share, 0) +
                           " of the map's walls, and the map " +
                           report::percent(best.plan_share, 0) + " of its own",
                       "check that it is this floor, and its scale");
    case plan::PlanVerdict::kWrongScale:
      throw InputError(file,
                       "fits best where its scale is off by " +
                           fixed(100.0 * (best.site_from_plan.scale - 1.0), 1) + "% or more",
                       "measure a long wall, and give --between with --metres");
    case plan::PlanVerdict::kAmbiguous:
      throw InputError(file, "fits in two places alike: " + of(best) + " and " + of(*found.rival),
                       "say which with --near");
  }
}

}  // namespace strata::tools
