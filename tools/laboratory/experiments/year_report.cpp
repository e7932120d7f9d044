// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/year_report.hpp"

#include <algorithm>
#include <cstdio>
#include <iostream>

#include "tools/report/plot.hpp"

namespace strata::experiments {
namespace {

using report::LinePlot;
using report::Series;

}  // namespace

YearReport::YearReport(std::filesystem::path folder)
    : folder_(std::move(folder)), csv_(folder_ / "year.csv") {
  csv_ << "day,path_m,nodes,store_mb,rss_mb,submaps,patch_mb,wall_s,track,scans,failures,error_m,"
          "worst_m,cpu_s\n";
}

void YearReport::add(const YearDay& day) {
  for (const YearTrack& track : day.tracks) {
    csv_ << day.day << ',' << day.path_m << ',' << day.nodes << ',' << day.store_mb << ','
         << day.rss_mb << ',' << day.submaps << ',' << day.patch_mb << ',' << day.wall_s << ','
         << track.name << ',' << track.scans << ',' << track.failures << ',' << track.error_m << ','
         << track.worst_m << ',' << track.cpu_s << std::endl;
  }
  days_.push_back(day);
  if (day.day % 10 != 0 && day.day > 3) return;
  std::cout << "day " << day.day << ": " << day.nodes << " nodes, " << day.store_mb
            << " MB on disk, " << day.rss_mb << " MB in RAM, " << day.submaps << " sub-maps";
  for (const YearTrack& track : day.tracks) {
    std::cout << "; " << track.name << " " << track.error_m << " m, " << track.failures
              << " failures";
  }
  std::cout << std::endl;
}

void YearReport::finish() const {
  if (days_.empty()) return;
  print_sums();
  draw();
}

void YearReport::print_sums() const {
  std::size_t fewest = days_.front().tracks.front().scans;
  double shortest_m = days_.front().path_m;
  double wall_s = 0.0;
  for (const YearDay& day : days_) {
    fewest = std::min(fewest, day.tracks.front().scans);
    shortest_m = std::min(shortest_m, day.path_m);
    wall_s += day.wall_s;
  }
  std::printf("%zu days, each of at least %zu scans and %.0f m, in %.0f s\n", days_.size(), fewest,
              shortest_m, wall_s);
  std::printf("| robot | mean error | failure rate | days with a failure | CPU a day |\n");
  for (std::size_t t = 0; t < days_.front().tracks.size(); ++t) {
    double error_m = 0.0;
    double scans = 0.0;
    double failures = 0.0;
    double cpu_s = 0.0;
    int bad_days = 0;
    for (const YearDay& day : days_) {
      const YearTrack& track = day.tracks[t];
      error_m += track.error_m / static_cast<double>(days_.size());
      cpu_s += track.cpu_s / static_cast<double>(days_.size());
      scans += static_cast<double>(track.scans);
      failures += static_cast<double>(track.failures);
      bad_days += track.failures > 0 ? 1 : 0;
    }
    std::printf("| %s | %.3f m | %.3f%% | %d | %.2f s |\n", days_.front().tracks[t].name.c_str(),
                error_m, 100.0 * failures / scans, bad_days, cpu_s);
  }
}

void YearReport::draw() const {
  LinePlot error{
      .title = "Mean error of each day", .x_label = "day", .y_label = "m", .from_zero = true};
  LinePlot size{
      .title = "What the memory takes", .x_label = "day", .y_label = "MB", .from_zero = true};
  for (const YearTrack& track : days_.front().tracks) error.series.push_back({track.name, {}, {}});
  size.series = {{"on disk", {}, {}}, {"RAM, all robots", {}, {}}};
  const bool has_patches = days_.front().patch_mb > 0.0;
  if (has_patches) size.series.push_back({"patch learner", {}, {}});
  for (const YearDay& day : days_) {
    for (std::size_t t = 0; t < day.tracks.size(); ++t) {
      error.series[t].x.push_back(day.day);
      error.series[t].y.push_back(day.tracks[t].error_m);
    }
    const double megabytes[] = {day.store_mb, day.rss_mb, day.patch_mb};
    for (std::size_t i = 0; i < size.series.size(); ++i) {
      size.series[i].x.push_back(day.day);
      size.series[i].y.push_back(megabytes[i]);
    }
  }
  report::save_png(error, folder_ / "year_error.png");
  report::save_png(size, folder_ / "year_size.png");
}

}  // namespace strata::experiments
