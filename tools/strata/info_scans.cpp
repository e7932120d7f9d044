// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/info_scans.hpp"

#include <algorithm>
#include <cstdio>
#include <iostream>

#include "core/geometry/angle.hpp"

namespace strata::tools {
namespace {

using Json = nlohmann::ordered_json;

}  // namespace

std::string number(double value, const char* format) {
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

std::vector<ScannerOfLog> scanners_of(const std::vector<Observation>& observations,
                                      const std::vector<log::ReadScanner>& scanners) {
  std::vector<log::ReadScanner> places;
  for (const log::ReadScanner& scanner : scanners) {
    const auto known = std::find_if(places.begin(), places.end(), [&](const auto& place) {
      return place.robot_from_laser == scanner.robot_from_laser;
    });
    if (known == places.end()) {
      places.push_back(scanner);
    } else {
      known->topic += ", " + scanner.topic;
    }
  }
  if (places.size() < 2) return {};
  std::vector<ScannerOfLog> result;
  for (const log::ReadScanner& place : places) {
    ScannerOfLog scanner{place.topic, {}};
    for (const Observation& observation : observations) {
      if (observation.scan.robot_from_laser == place.robot_from_laser) {
        scanner.observations.push_back(observation);
      }
    }
    if (!scanner.observations.empty()) result.push_back(std::move(scanner));
  }
  return result;
}

Json describe_scans(const std::vector<Observation>& observations, double duration_s) {
  const Scan& first = observations.front().scan;
  std::size_t least = first.size();
  std::size_t most = first.size();
  BeamCounts beams;
  for (const Observation& observation : observations) {
    least = std::min(least, observation.scan.size());
    most = std::max(most, observation.scan.size());
    const BeamCounts counts = count_beams(observation.scan);
    beams.hits += counts.hits;
    beams.no_returns += counts.no_returns;
    beams.too_close += counts.too_close;
    beams.invalid += counts.invalid;
  }
  const auto intervals = static_cast<double>(observations.size() - 1);
  Json scans;
  scans["count"] = observations.size();
  scans["rate_hz"] = duration_s > 0.0 ? Json(intervals / duration_s) : Json(nullptr);
  scans["beams"] = most;
  scans["beams_min"] = least;
  scans["angle_min_deg"] = radians_to_degrees(static_cast<double>(first.angle_min_rad));
  scans["angle_step_deg"] = radians_to_degrees(static_cast<double>(first.angle_increment_rad));
  scans["field_of_view_deg"] = radians_to_degrees(static_cast<double>(first.angle_increment_rad) *
                                                  static_cast<double>(first.size()));
  scans["range_min_m"] = first.range_min_m;
  scans["range_max_m"] = first.range_max_m;
  const Pose2& mounting = first.robot_from_laser;
  scans["mounting"] = {mounting.x, mounting.y, mounting.theta};
  scans["hits"] = beams.hits;
  scans["no_returns"] = beams.no_returns;
  scans["too_close"] = beams.too_close;
  scans["invalid"] = beams.invalid;
  return scans;
}

std::string beams_of(const Json& scans) {
  return std::to_string(scans["beams"].get<std::size_t>()) + " over " +
         number(scans["field_of_view_deg"], "%.1f deg") + " from " +
         number(scans["angle_min_deg"], "%.2f deg") + ", " + number(scans["range_min_m"], "%.2f") +
         " to " + number(scans["range_max_m"], "%.2f m");
}

std::string mounting_of(const Json& scans) {
  const Json& mounting = scans["mounting"];
  return number(mounting[0], "%.3f m, ") + number(mounting[1], "%.3f m, ") +
         number(mounting[2], "%.4f rad");
}

void print_scanner(const Json& scanner) {
  std::cout << "  scanner    " << scanner["topic"].get<std::string>() << ": " << scanner["count"]
            << " scans";
  if (!scanner["rate_hz"].is_null()) std::cout << ", " << number(scanner["rate_hz"], "%.2f Hz");
  std::cout << ", sits at " << mounting_of(scanner) << "\n             beams " << beams_of(scanner)
            << "\n";
}

}  // namespace strata::tools
