// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/learn_pictures.hpp"

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "components/log/map_file.hpp"
#include "core/base/error.hpp"
#include "core/beam_filter/beam_filter.hpp"
#include "tools/report/html_report.hpp"
#include "tools/report/map_picture.hpp"

namespace strata::pipeline {
namespace {

using report::HtmlReport;

constexpr int kMapPixels = 1400;
constexpr int kRoundPixels = 700;
constexpr report::Color kDynamic{214, 39, 40};
constexpr report::Color kDriven{213, 94, 0};
constexpr report::Color kChanging{0, 114, 178};

report::Series rounds_of(const std::string& name, const std::vector<double>& values) {
  report::Series series{name, {}, values};
  for (std::size_t i = 0; i < values.size(); ++i) series.x.push_back(static_cast<double>(i));
  return series;
}

report::MapPicture draw_dynamic(const slam::SlamResult& result, const CellRect& rect) {
  report::MapPicture raw = report::draw_map(result.occupancy, rect, kMapPixels);
  report::mark_dynamic_beams(raw, result.scans, kDynamic);
  return raw;
}

/// A line for each run.
void mark_ways(report::MapPicture& picture, const std::vector<PosedScan>& scans) {
  std::vector<Pose2> way;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    way.push_back(scans[i].map_from_robot);
    if (i + 1 < scans.size() && scans[i + 1].run == scans[i].run) continue;
    report::mark_trajectory(picture, way, kDriven);
    way.clear();
  }
}

void add_ghosts(HtmlReport& page, const slam::SlamResult& result, const CellRect& rect) {
  const report::MapPicture raw = draw_dynamic(result, rect);
  const report::MapPicture filtered = report::draw_map(result.filtered, rect, kMapPixels);
  page.heading("The map before and after");
  page.before_after(
      "ghosts", raw.image, filtered.image, "all beams, dynamic ones in red", "static beams",
      report::fixed(100.0 * result.dynamic_fraction, 1) + "% of the hits are held to be dynamic.");
}

void add_trace(HtmlReport& page, const slam::SlamResult& result) {
  page.heading("Likelihood");
  report::LinePlot plot{.title = "Log likelihood of the data",
                        .x_label = "round of labels, poses and map",
                        .y_label = "nats"};
  plot.series.push_back(rounds_of("log likelihood", result.log_likelihood));
  page.plot("log_likelihood", plot,
            "Each round labels all beams, matches every scan to the map of the static ones, and "
            "makes the map anew; round " +
                std::to_string(result.iterations) + " was kept.");
}

void add_rounds(HtmlReport& page, const std::filesystem::path& folder,
                const slam::SlamResult& result, beam_filter::BeamFilterConfig config,
                const CellRect& rect) {
  config.mode = beam_filter::Mode::kIterate;
  config.endpoint_tolerance = false;
  config.min_gain = 0.0;
  page.heading("EM at the poses found");
  beam_filter::CountsResult counts;
  for (int round = 0; round <= kShownRounds; ++round) {
    if (round > 0) {
      config.max_iterations = round;
      counts = beam_filter::filter_counts(result.raw, config);
    }
    const ReflectionGrid& map = round == 0 ? result.occupancy : counts.filtered;
    const std::string name = "round_" + std::to_string(round);
    log::write_map(folder / (name + ".yaml"), map);
    page.picture(name, report::draw_map(map, rect, kRoundPixels).image,
                 "the map after round " + std::to_string(round),
                 round == 0 ? "All beams." : "After round " + std::to_string(round) + ".");
  }
  report::LinePlot plot{
      .title = "Likelihood at fixed poses", .x_label = "round of EM", .y_label = "nats"};
  plot.series.push_back(rounds_of("incomplete data, l", counts.log_likelihood));
  plot.series.push_back(rounds_of("expected, Q", counts.expected_log_likelihood));
  page.plot("log_likelihood_fixed_poses", plot, "l never falls; Q, equation (1.7), may.");
}

}  // namespace

void write_map_pictures(const std::filesystem::path& folder, const slam::SlamResult& result,
                        const patch::PatchMap& patches, report::Drawings& drawings) {
  if (result.scans.empty()) return;
  const CellRect rect = report::known_rect(result.occupancy);
  drawings.add(folder / kMapPicture, [&] {
    report::MapPicture map = report::draw_map(result.filtered, rect, kMapPixels);
    mark_ways(map, result.scans);
    report::mark_submaps(map, patches, kChanging);
    report::write_file(folder / kMapPicture, report::encode_png(map.image));
  });
  drawings.add(folder / kDynamicPicture, [&] {
    report::write_file(folder / kDynamicPicture,
                       report::encode_png(draw_dynamic(result, rect).image));
  });
}

void write_learn_pictures(const std::filesystem::path& folder, const slam::SlamResult& result,
                          const beam_filter::BeamFilterConfig& config) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    throw OutputError(folder.string(), "cannot be created: " + error.message(),
                      "choose another folder or mend its permissions");
  }
  HtmlReport page(folder, "What learning did to the map");
  if (result.scans.empty()) {
    page.paragraph("No scan was mapped.");
  } else {
    const CellRect rect = report::known_rect(result.occupancy);
    add_ghosts(page, result, rect);
    add_trace(page, result);
    add_rounds(page, folder, result, config, rect);
  }
  page.write();
}

}  // namespace strata::pipeline
