// SPDX-License-Identifier: Apache-2.0
#include "components/log/map_file.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>

#include <yaml-cpp/yaml.h>

#include "components/log/map_image.hpp"
#include "components/log/spooled_input.hpp"
#include "components/log/text.hpp"
#include "components/log/whole_file.hpp"
#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::log {
namespace {

struct MapInfo {
  fs::path image;
  double resolution_m = 0.0;
  double x = 0.0, y = 0.0, yaw = 0.0;
  bool negate = false;
  double occupied = 0.65;
  double free = 0.25;  // nav2's default; files mostly state it
  MapMode mode = MapMode::kTrinary;
};

MapInfo read_info(const fs::path& path) {
  const std::string place = path.string();
  require_reachable(path);
  if (fs::is_directory(path)) {
    throw InputError(place, "is a folder, not a file", "name the map's YAML file in it");
  }
  MapInfo info;
  try {
    const YAML::Node node = YAML::LoadFile(readable_path(path).string());
    if (!node.IsMap() || !node["image"] || !node["resolution"] || !node["origin"]) {
      throw InputError(place, "lacks image, resolution or origin", "give a map_server YAML file");
    }
    info.image = node["image"].as<std::string>();
    info.resolution_m = node["resolution"].as<double>();
    info.x = node["origin"][0].as<double>();
    info.y = node["origin"][1].as<double>();
    info.yaw = node["origin"][2].as<double>(0.0);
    const auto negate = node["negate"].as<std::string>("0");
    info.negate = negate == "1" || negate == "true";
    // Without its value: what is there and no number is not overlooked.
    if (node["occupied_thresh"]) info.occupied = node["occupied_thresh"].as<double>();
    if (node["free_thresh"]) info.free = node["free_thresh"].as<double>();
    const auto mode = node["mode"].as<std::string>("trinary");
    const std::optional<MapMode> known = map_mode(mode);
    if (!known) {
      throw InputError(place + ": mode", "is " + mode + ", which is not read here",
                       "use trinary, scale or raw");
    }
    info.mode = *known;
  } catch (const YAML::Exception& error) {
    throw InputError(place + ":" + std::to_string(error.mark.line + 1), error.msg,
                     "give a map_server YAML file");
  }
  if (!(info.resolution_m > 0.0) || !std::isfinite(info.x) || !std::isfinite(info.y) ||
      std::abs(info.x / info.resolution_m) > 1e8 || std::abs(info.y / info.resolution_m) > 1e8) {
    throw InputError(place, "its resolution or origin makes no sense", "check the file");
  }
  if (!(info.free >= 0.0 && info.free <= info.occupied && info.occupied <= 1.0)) {
    throw InputError(place,
                     "free_thresh " + format_number(info.free) + " and occupied_thresh " +
                         format_number(info.occupied) + " leave nothing between them",
                     "give 0 <= free_thresh <= occupied_thresh <= 1, as 0.25 and 0.65");
  }
  if (std::abs(info.yaw) > 1e-6) {
    throw InputError(place + ": origin", "is turned", "turn the image instead; yaw must be 0");
  }
  if (info.image.is_relative()) info.image = path.parent_path() / info.image;
  return info;
}

/// What the pixel at `i` says of its cell; NaN: nothing. As nav2's map_server reads it.
float occupancy_of(const MapImage& image, std::size_t i, const MapInfo& info) {
  constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
  double bright = static_cast<double>(image.pixels[i]) / image.white;
  const bool has_alpha = !image.alpha.empty();
  if (info.mode == MapMode::kRaw) {
    const double percent = std::round(bright * 255.0);
    return percent <= 100.0 ? static_cast<float>(percent) / 100.0F : kUnknown;
  }
  if (info.mode == MapMode::kScale && has_alpha && image.alpha[i] != 255) return kUnknown;
  if (info.mode == MapMode::kTrinary && has_alpha) {
    bright = (3.0 * bright + static_cast<double>(image.alpha[i]) / 255.0) / 4.0;
  }
  const double occupancy = info.negate ? bright : 1.0 - bright;
  if (occupancy > info.occupied) return 1.0F;
  if (occupancy < info.free) return 0.0F;
  if (info.mode == MapMode::kTrinary) return kUnknown;
  return static_cast<float>((occupancy - info.free) / (info.occupied - info.free));
}

/// Between the thresholds: 205, as everybody writes it, where that is. Throws InputError when no
/// pixel is.
int unknown_pixel(const MapFileFormat& format) {
  const auto is_between = [&](int pixel) {
    const double occupancy = 1.0 - static_cast<double>(pixel) / 255.0;
    return occupancy >= format.free && occupancy <= format.occupied;
  };
  const int middle =
      static_cast<int>(std::lround(255.0 * (1.0 - (format.free + format.occupied) / 2.0)));
  for (const int pixel : {205, middle}) {
    if (is_between(pixel)) return pixel;
  }
  throw InputError("map thresholds", "leave no room for the unknown between them",
                   "set them at least 0.01 apart");
}

/// Grey and, where the mode has a place for it, opacity of a cell.
std::pair<int, int> pixel_of(float value, const MapFileFormat& format, int unknown) {
  constexpr int kOpaque = 255;
  const double percent = std::round(100.0 * std::clamp(static_cast<double>(value), 0.0, 1.0));
  switch (format.mode) {
    case MapMode::kTrinary:
      return {is_occupied(value) ? 0 : (is_free(value) ? 254 : unknown), kOpaque};
    case MapMode::kScale:
      if (!is_known(value)) return {128, 0};
      return {static_cast<int>(std::lround((100.0 - percent) / 100.0 * 255.0)), kOpaque};
    case MapMode::kRaw:
      return {is_known(value) ? static_cast<int>(percent) : 255, kOpaque};
  }
  return {unknown, kOpaque};
}

}  // namespace

std::optional<MapMode> map_mode(std::string_view name) {
  if (name == "trinary") return MapMode::kTrinary;
  if (name == "scale") return MapMode::kScale;
  if (name == "raw") return MapMode::kRaw;
  return std::nullopt;
}

ReflectionGrid read_map(const fs::path& yaml) {
  const MapInfo info = read_info(yaml);
  const MapImage image = read_map_image(info.image, yaml.string());
  CellRect rect;
  rect.min = {static_cast<int>(std::lround(info.x / info.resolution_m)),
              static_cast<int>(std::lround(info.y / info.resolution_m))};
  rect.max = {rect.min.x + image.width, rect.min.y + image.height};
  ReflectionGrid grid = make_reflection_grid(info.resolution_m, rect);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    const auto width = static_cast<std::size_t>(image.width);
    const Cell cell{rect.min.x + static_cast<int>(i % width),
                    rect.max.y - 1 - static_cast<int>(i / width)};
    grid.at(cell) = occupancy_of(image, i, info);
  }
  return grid;
}

void write_map(const fs::path& yaml, const ReflectionGrid& grid, const MapFileFormat& format) {
  const bool has_alpha = format.mode == MapMode::kScale;
  if (has_alpha && format.image != MapImageFormat::kPng) {
    throw InputError("map mode scale", "needs transparency, which pgm has not", "ask for png");
  }
  const int unknown = format.mode == MapMode::kTrinary ? unknown_pixel(format) : 0;
  CellRect known;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (!is_known(grid.values()[i])) continue;
    const Cell cell = grid.cell(i);
    known = known.united({cell, {cell.x + 1, cell.y + 1}});
  }
  if (known.empty()) known = {grid.rect().min, {grid.rect().min.x + 1, grid.rect().min.y + 1}};
  MapImage image;
  image.width = known.width();
  image.height = known.height();
  for (int y = known.max.y - 1; y >= known.min.y; --y) {
    for (int x = known.min.x; x < known.max.x; ++x) {
      const auto [grey, opacity] = pixel_of(grid.get({x, y}), format, unknown);
      image.pixels.push_back(static_cast<std::uint8_t>(grey));
      if (has_alpha) image.alpha.push_back(static_cast<std::uint8_t>(opacity));
    }
  }
  fs::path picture = yaml;
  picture.replace_extension(format.image == MapImageFormat::kPng ? ".png" : ".pgm");
  write_map_image(picture, image, format.image);
  constexpr const char* kModes[] = {"trinary", "scale", "raw"};
  WholeFile text(yaml);
  text.stream() << "image: " << picture.filename().string()
                << "\nmode: " << kModes[static_cast<int>(format.mode)]
                << "\nresolution: " << format_number(grid.resolution_m()) << "\norigin: ["
                << format_number(known.min.x * grid.resolution_m()) << ", "
                << format_number(known.min.y * grid.resolution_m())
                << ", 0]\nnegate: 0\noccupied_thresh: " << format_number(format.occupied)
                << "\nfree_thresh: " << format_number(format.free) << "\n";
  text.commit();
}

}  // namespace strata::log
