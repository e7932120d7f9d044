// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/peers_scenario.hpp"

#include <fstream>
#include <sstream>
#include <string>

#include <zlib.h>

#include "tests/support/test_data.hpp"

namespace strata::bench {
namespace {

ReflectionGrid read_pgm(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string magic;
  int width = 0;
  int height = 0;
  int depth = 0;
  file >> magic >> width >> height >> depth;
  file.get();
  std::vector<char> pixels(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  file.read(pixels.data(), static_cast<std::streamsize>(pixels.size()));
  ReflectionGrid map(0.05, {{0, 0}, {width, height}}, 0.0F);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {  // the first row of the image is the top
      const auto i = static_cast<std::size_t>(height - 1 - y) * static_cast<std::size_t>(width) +
                     static_cast<std::size_t>(x);
      map.at({x, y}) = static_cast<unsigned char>(pixels[i]) < 128 ? 1.0F : 0.0F;
    }
  }
  return map;
}

std::vector<std::vector<double>> read_rows(const std::string& path) {
  std::string text;
  gzFile file = gzopen(path.c_str(), "rb");
  std::vector<char> buffer(1U << 16U);
  for (int n = 0; (n = gzread(file, buffer.data(), 1U << 16U)) > 0;) {
    text.append(buffer.data(), static_cast<std::size_t>(n));
  }
  gzclose(file);
  std::vector<std::vector<double>> rows;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.empty() || line[0] == '#') continue;
    rows.emplace_back();
    std::istringstream fields(line);
    for (std::string field; std::getline(fields, field, ',');) {
      rows.back().push_back(std::stod(field));
    }
  }
  return rows;
}

}  // namespace

const PeersScenario& peers_scenario() {
  static const PeersScenario loaded = [] {
    PeersScenario s;
    const auto folder = test::find_data("peers_scenario");
    if (!folder) return s;
    s.map = read_pgm((*folder / "map.pgm").string());
    for (const auto& row : read_rows((*folder / "steps.csv.gz").string())) {
      Observation observation;
      observation.odom_from_robot = {row[3], row[4], row[5]};
      Scan& scan = observation.scan;
      scan.stamp = Stamp::from_seconds(0.2 * static_cast<double>(s.truth.size()));
      scan.angle_min_rad = -3.14159265F;
      scan.angle_increment_rad = 0.0174532925F;
      scan.range_max_m = 10.0F;
      for (std::size_t k = 6; k < row.size(); ++k) {
        scan.ranges_m.push_back(static_cast<float>(row[k]));
      }
      s.truth.push_back({row[0], row[1], row[2]});
      s.observations.push_back(std::move(observation));
    }
    s.found = true;
    return s;
  }();
  return loaded;
}

localization::LocalizerConfig fixed_particles(int particles) {
  localization::LocalizerConfig config;
  config.particles = particles;
  config.adaptive = false;
  config.resample_below = 1.0;
  config.gating.every_scans = 1;
  config.recovery.inject = false;
  return config;
}

}  // namespace strata::bench
