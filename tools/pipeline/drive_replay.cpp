// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/drive_replay.hpp"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "core/base/error.hpp"
#include "core/scan/endpoints.hpp"
#include "tools/pipeline/localize.hpp"
#include "tools/report/html_report.hpp"
#include "tools/report/map_picture.hpp"

namespace strata::pipeline {
namespace {

using nlohmann::json;

constexpr std::size_t kFewScans = 20;
constexpr std::string_view kPlace = "DRIVE_DATA";

long thousandths(double value) { return std::lround(1000.0 * value); }

json pose_json(const Pose2& pose) {
  if (!is_finite(pose)) return nullptr;
  return {thousandths(pose.x), thousandths(pose.y), thousandths(pose.theta)};
}

/// Ends of hits in the robot's frame [cm], x and y in turn.
json beams_json(const Scan& scan) {
  const Endpoints hits = subsample(endpoints_in_robot(scan), kReplayBeams);
  json ends = json::array();
  for (std::size_t i = 0; i < hits.size(); ++i) {
    ends.push_back(std::lround(100.0 * hits.x_m[i]));
    ends.push_back(std::lround(100.0 * hits.y_m[i]));
  }
  return ends;
}

json map_json(const ReflectionGrid& map) {
  // A pixel a cell: the browser enlarges it.
  const report::MapPicture picture = report::draw_map(map, report::known_rect(map), 1);
  const double m = picture.resolution_m;
  return {{"png", report::base64(report::encode_png(picture.image))},
          {"left_m", picture.rect.min.x * m},
          {"top_m", picture.rect.max.y * m},
          {"width_m", picture.rect.width() * m},
          {"height_m", picture.rect.height() * m}};
}

json areas_json(const patch::PatchMap* patches, double m) {
  json areas = json::array();
  if (patches == nullptr) return areas;
  for (const patch::Submap& submap : patches->submaps) {
    areas.push_back({submap.rect.min.x * m, submap.rect.min.y * m, submap.rect.max.x * m,
                     submap.rect.max.y * m});
  }
  return areas;
}

/// Where each scan's rows begin in `states`, and the end of the last.
std::vector<std::size_t> first_rows(const ReplayTrack& track, std::span<const Observation> scans) {
  std::vector<std::size_t> first{0};
  std::size_t row = 0;
  for (const Observation& observation : scans) {
    while (row < track.states.size() && track.states[row].stamp == observation.scan.stamp) ++row;
    first.push_back(row);
  }
  return first;
}

/// [area, likeliest configuration, its probability in percent] of each area that a scan tells of.
json believed_json(std::span<const maps::StateRow> rows) {
  std::vector<maps::StateRow> best;
  for (const maps::StateRow& row : rows) {
    const auto same = std::find_if(best.begin(), best.end(), [&](const maps::StateRow& other) {
      return other.submap == row.submap;
    });
    if (same == best.end()) {
      best.push_back(row);
    } else if (row.probability > same->probability) {
      *same = row;
    }
  }
  json states = json::array();
  for (const maps::StateRow& row : best) {
    states.push_back({row.submap, row.configuration, std::lround(100.0 * row.probability)});
  }
  return states;
}

/// From the pose [cm], x and y in turn; those that are not finite are left out.
json particles_json(std::span<const float> particles, const Pose2& pose) {
  json shown = json::array();
  for (std::size_t k = 0; k + 1 < particles.size(); k += 2) {
    const double x_cm = 100.0 * (static_cast<double>(particles[k]) - pose.x);
    const double y_cm = 100.0 * (static_cast<double>(particles[k + 1]) - pose.y);
    if (!std::isfinite(x_cm) || !std::isfinite(y_cm)) continue;
    shown.push_back(std::lround(x_cm));
    shown.push_back(std::lround(y_cm));
  }
  return shown;
}

json track_json(const ReplayTrack& track, std::span<const Observation> scans, double resolution_m,
                std::size_t step) {
  json poses = json::array();
  json scores = json::array();
  json states = json::array();
  json particles = json::array();
  constexpr std::size_t kEach = 2 * kShownParticles;
  const bool has_particles = track.particles.size() == kEach * track.trajectory.size();
  const std::vector<std::size_t> rows = first_rows(track, scans);
  for (std::size_t i = 0; i < scans.size(); i += step) {
    poses.push_back(i < track.trajectory.size() ? pose_json(track.trajectory[i].pose)
                                                : json(nullptr));
    scores.push_back(i < track.scores.size() ? json(std::lround(100.0 * track.scores[i]))
                                             : json(nullptr));
    states.push_back(believed_json(track.states.subspan(rows[i], rows[i + 1] - rows[i])));
    if (has_particles && i < track.trajectory.size()) {
      particles.push_back(
          particles_json(track.particles.subspan(i * kEach, kEach), track.trajectory[i].pose));
    }
  }
  return {{"name", track.name}, {"areas", areas_json(track.patches, resolution_m)},
          {"poses", poses},     {"scores", scores},
          {"states", states},   {"particles", particles}};
}

/// Every `step`-th scan.
json drive_json(const DriveReplay& drive, const json& map, std::size_t step) {
  json times = json::array();
  json beams = json::array();
  json truths = json::array();
  const auto scans = drive.observations;
  for (std::size_t i = 0; i < scans.size(); i += step) {
    times.push_back(thousandths((scans[i].scan.stamp - scans.front().scan.stamp).seconds()));
    beams.push_back(beams_json(scans[i].scan));
    const bool is_known = i < drive.truths.size() && drive.truths[i].has_value();
    truths.push_back(is_known ? pose_json(*drive.truths[i]) : json(nullptr));
  }
  json tracks = json::array();
  for (const ReplayTrack& track : drive.tracks) {
    tracks.push_back(track_json(track, scans, drive.map.resolution_m(), step));
  }
  return {{"map", map},     {"step", step},     {"times", times},
          {"beams", beams}, {"truths", truths}, {"tracks", tracks}};
}

std::string page_of(const json& data) {
  std::string text = data.dump(-1, ' ', true, json::error_handler_t::replace);
  // A name must not end the script that the data are in.
  for (std::size_t at = 0; (at = text.find('<', at)) != std::string::npos;) {
    text.replace(at, 1, "\\u003c");
  }
  std::string page(replay_template());
  return page.replace(page.find(kPlace), kPlace.size(), text);
}

}  // namespace

std::string replay_page(const DriveReplay& drive, std::size_t budget) {
  const json map = map_json(drive.map);
  const std::size_t scans = drive.observations.size();
  std::size_t step = std::max<std::size_t>(1, (scans + kReplayScans - 1) / kReplayScans);
  while (true) {
    std::string page = page_of(drive_json(drive, map, step));
    if (page.size() <= budget) return page;
    if (scans / step <= kFewScans) {
      throw OutputError(kReplayPage, "would be larger than " + std::to_string(budget) + " bytes",
                        "nothing else is missing; the map is too large for a page");
    }
    step *= 2;
  }
}

void write_replay(const std::filesystem::path& folder, const DriveReplay& drive) {
  report::write_file(folder / kReplayPage, replay_page(drive));
}

}  // namespace strata::pipeline
