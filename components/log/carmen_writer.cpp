// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <ostream>
#include <set>
#include <string>

#include "components/log/carmen.hpp"
#include "components/log/gzip_stream.hpp"
#include "components/log/text.hpp"
#include "components/log/whole_file.hpp"

namespace strata::log {
namespace {

bool fits_flaser(const Scan& scan) {
  Scan plain = scan;
  set_flaser_geometry(plain, 180.0);
  return scan.size() > 0 && scan.angle_min_rad == plain.angle_min_rad &&
         scan.angle_increment_rad == plain.angle_increment_rad &&
         scan.range_max_m == plain.range_max_m;
}

void write_poses(std::ostream& out, const Observation& observation) {
  const Pose2 laser = observation.odom_from_robot * observation.scan.robot_from_laser;
  for (const Pose2& pose : {laser, observation.odom_from_robot}) {
    out << ' ' << format_number(pose.x) << ' ' << format_number(pose.y) << ' '
        << format_number(pose.theta);
  }
}

void write_ranges(std::ostream& out, const Scan& scan) {
  out << ' ' << scan.size();
  const std::string no_return = format_number(std::max(81.83F, scan.range_max_m));
  for (const float range : scan.ranges_m) {
    out << ' '
        << (range == std::numeric_limits<float>::infinity() ? no_return : format_number(range));
  }
}

void write_scan(std::ostream& out, const Observation& observation) {
  const Scan& scan = observation.scan;
  const std::string end = " " + format_stamp(scan.stamp) + " strata " + format_stamp(scan.stamp);
  if (fits_flaser(scan)) {
    out << "FLASER";
    write_ranges(out, scan);
    write_poses(out, observation);
  } else {
    const double field = static_cast<double>(scan.angle_increment_rad) *
                         static_cast<double>(scan.size() > 0 ? scan.size() - 1 : 0);
    out << "ROBOTLASER1 0 " << format_number(scan.angle_min_rad) << ' ' << format_number(field)
        << ' ' << format_number(scan.angle_increment_rad) << ' ' << format_number(scan.range_max_m)
        << " 0.01 0";
    write_ranges(out, scan);
    out << " 0";
    write_poses(out, observation);
    out << " 0 0 0 0 0";
  }
  out << end << '\n';
}

}  // namespace

void write_carmen(const std::filesystem::path& path, const LogContent& content) {
  WholeFile file(path);
  std::optional<GzipBuffer> gzip;
  if (path.extension() == ".gz") gzip.emplace(file.stream());
  std::streambuf* const plain = file.stream().rdbuf();
  std::ostream out(gzip ? &*gzip : plain);
  out << "# CARMEN log written by strata; metres and radians\n";
  if (!content.observations.empty()) {
    const Pose2& mounting = content.observations.front().scan.robot_from_laser;
    out << "PARAM robot_frontlaser_offset " << format_number(mounting.x) << " strata 0\n";
  }
  std::size_t next = 0;
  // A sample at a scan's stamp says what the scan's line says; reading would count it twice.
  std::set<std::int64_t> scan_stamps;
  for (const Observation& o : content.observations) scan_stamps.insert(o.scan.stamp.ns);
  const auto write_odometry_until = [&](Stamp stamp) {
    for (; next < content.odometry.size() && content.odometry[next].stamp <= stamp; ++next) {
      const OdometrySample& sample = content.odometry[next];
      if (scan_stamps.contains(sample.stamp.ns)) continue;
      const std::string time = format_stamp(sample.stamp);
      out << "ODOM " << format_number(sample.odom_from_robot.x) << ' '
          << format_number(sample.odom_from_robot.y) << ' '
          << format_number(sample.odom_from_robot.theta) << " 0 0 0 " << time << " strata " << time
          << '\n';
    }
  };
  for (const Observation& observation : content.observations) {
    write_odometry_until(observation.scan.stamp);
    write_scan(out, observation);
  }
  write_odometry_until(Stamp{std::numeric_limits<std::int64_t>::max()});
  out.flush();
  if (gzip) gzip->finish();
  if (!out) file.stream().setstate(std::ios::failbit);
  file.commit();
}

}  // namespace strata::log
