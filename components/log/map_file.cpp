// SPDX-License-Identifier: Apache-2.0
#include "components/log/map_file.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "components/log/text.hpp"
#include "components/log/whole_file.hpp"
#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::log {
namespace {

constexpr int kLargestSide = 50'000;

struct Image {
  int width = 0;
  int height = 0;
  int white = 255;
  std::vector<std::uint8_t> pixels;  ///< top row first
};

/// The next number of a PGM header, behind blanks and comments; -1 when there is none.
int header_number(std::istream& in) {
  int c = in.get();
  while (c == '#' || std::isspace(c) != 0) {
    if (c == '#') {
      while (c != '\n' && c != EOF) c = in.get();
    }
    c = in.get();
  }
  if (std::isdigit(c) == 0) return -1;
  int value = 0;
  for (; std::isdigit(c) != 0; c = in.get()) value = std::min(1'000'000, value * 10 + (c - '0'));
  return value;  // the one blank behind it is taken too, as the format wants
}

Image read_pgm(const fs::path& path, const std::string& yaml) {
  const auto refuse = [&](const std::string& why) {
    return InputError(path.string(), why, "the image named in " + yaml + " must be a PGM");
  };
  std::ifstream in(path, std::ios::binary);
  if (!in || fs::is_directory(path)) throw refuse("the map's image is missing");
  char magic[2] = {};
  in.read(magic, 2);
  if (magic[0] != 'P' || (magic[1] != '5' && magic[1] != '2')) throw refuse("is not a PGM image");
  Image image;
  image.width = header_number(in);
  image.height = header_number(in);
  image.white = header_number(in);
  if (image.width < 1 || image.height < 1 || image.width > kLargestSide ||
      image.height > kLargestSide || image.white < 1 || image.white > 255) {
    throw refuse("has a damaged header or more than 8 bits a pixel");
  }
  const auto size = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  // Before memory is taken: a damaged header may promise anything.
  if (fs::file_size(path) < size) throw refuse("is cut: it has fewer pixels than it says");
  image.pixels.resize(size);
  if (magic[1] == '5') {
    in.read(reinterpret_cast<char*>(image.pixels.data()), static_cast<std::streamsize>(size));
    if (static_cast<std::size_t>(in.gcount()) != size) {
      throw refuse("is cut: it has fewer pixels than it says");
    }
  } else {
    for (std::uint8_t& pixel : image.pixels) {
      const int value = header_number(in);
      if (value < 0 || value > image.white) throw refuse("has a damaged pixel");
      pixel = static_cast<std::uint8_t>(value);
    }
  }
  return image;
}

struct MapInfo {
  fs::path image;
  double resolution_m = 0.0;
  double x = 0.0, y = 0.0, yaw = 0.0;
  bool negate = false;
  double occupied = 0.65;
  double free = 0.25;  // nav2's default; files mostly state it
  bool scale = false;
};

MapInfo read_info(const fs::path& path) {
  const std::string place = path.string();
  if (!fs::exists(path)) throw InputError(place, "does not exist", "check the path");
  MapInfo info;
  try {
    const YAML::Node node = YAML::LoadFile(place);
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
    info.occupied = node["occupied_thresh"].as<double>(info.occupied);
    info.free = node["free_thresh"].as<double>(info.free);
    const auto mode = node["mode"].as<std::string>("trinary");
    info.scale = mode == "scale";
    if (mode != "trinary" && mode != "scale") {
      throw InputError(place + ": mode", "is " + mode + ", which is not read here",
                       "use trinary or scale");
    }
  } catch (const YAML::Exception& error) {
    throw InputError(place + ":" + std::to_string(error.mark.line + 1), error.msg,
                     "give a map_server YAML file");
  }
  if (!(info.resolution_m > 0.0) || !std::isfinite(info.x) || !std::isfinite(info.y) ||
      std::abs(info.x / info.resolution_m) > 1e8 || std::abs(info.y / info.resolution_m) > 1e8) {
    throw InputError(place, "its resolution or origin makes no sense", "check the file");
  }
  if (std::abs(info.yaw) > 1e-6) {
    throw InputError(place + ": origin", "is turned", "turn the image instead; yaw must be 0");
  }
  if (info.image.is_relative()) info.image = path.parent_path() / info.image;
  return info;
}

}  // namespace

ReflectionGrid read_map(const fs::path& yaml) {
  const MapInfo info = read_info(yaml);
  const Image image = read_pgm(info.image, yaml.string());
  CellRect rect;
  rect.min = {static_cast<int>(std::lround(info.x / info.resolution_m)),
              static_cast<int>(std::lround(info.y / info.resolution_m))};
  rect.max = {rect.min.x + image.width, rect.min.y + image.height};
  ReflectionGrid grid = make_reflection_grid(info.resolution_m, rect);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    const auto width = static_cast<std::size_t>(image.width);
    const Cell cell{rect.min.x + static_cast<int>(i % width),
                    rect.max.y - 1 - static_cast<int>(i / width)};
    const double bright = static_cast<double>(image.pixels[i]) / image.white;
    const double occupancy = info.negate ? bright : 1.0 - bright;
    if (occupancy > info.occupied) {
      grid.at(cell) = 1.0F;
    } else if (occupancy < info.free) {
      grid.at(cell) = 0.0F;
    } else if (info.scale) {
      grid.at(cell) = static_cast<float>((occupancy - info.free) / (info.occupied - info.free));
    }
  }
  return grid;
}

void write_map(const fs::path& yaml, const ReflectionGrid& grid) {
  CellRect known;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (!is_known(grid.values()[i])) continue;
    const Cell cell = grid.cell(i);
    known = known.united({cell, {cell.x + 1, cell.y + 1}});
  }
  if (known.empty()) known = {grid.rect().min, {grid.rect().min.x + 1, grid.rect().min.y + 1}};
  fs::path image = yaml;
  image.replace_extension(".pgm");
  WholeFile pixels(image);
  pixels.stream() << "P5\n" << known.width() << ' ' << known.height() << "\n255\n";
  for (int y = known.max.y - 1; y >= known.min.y; --y) {
    for (int x = known.min.x; x < known.max.x; ++x) {
      const float value = grid.get({x, y});
      const int pixel = is_occupied(value) ? 0 : (is_free(value) ? 254 : 205);
      pixels.stream().put(static_cast<char>(pixel));
    }
  }
  pixels.commit();
  WholeFile text(yaml);
  // 205 lies between the thresholds: occupancy (255 - 205) / 255 = 0.196.
  text.stream() << "image: " << image.filename().string()
                << "\nmode: trinary\nresolution: " << format_number(grid.resolution_m())
                << "\norigin: [" << format_number(known.min.x * grid.resolution_m()) << ", "
                << format_number(known.min.y * grid.resolution_m())
                << ", 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.19\n";
  text.commit();
}

}  // namespace strata::log
