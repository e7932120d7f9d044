// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <functional>

#include "tools/laboratory/experiments/among_people.hpp"
#include "tools/laboratory/experiments/simulated_slam.hpp"
#include "tools/laboratory/paper/em_textures.hpp"
#include "tools/laboratory/paper/figures.hpp"
#include "tools/laboratory/paper/pose_error.hpp"
#include "tools/pipeline/runs_input.hpp"
#include "tools/report/map_picture.hpp"

namespace strata::paper {
namespace {

using namespace experiments;

constexpr std::size_t kPeople = 5;
constexpr const char* kCorridor = "the simulated corridor_people.yaml, five people";

std::filesystem::path corridor(const Setting& setting) {
  return setting.scenarios / "corridor_people.yaml";
}

std::string png_of(const ReflectionGrid& map, const CellRect& rect) {
  return report::encode_png(report::draw_map(map, rect, 700).image);
}

Outcome ghosts(const Setting& setting) {
  std::size_t raw = 0;
  std::size_t filtered = 0;
  double precision = 0.0;
  double recall = 0.0;
  const int seeds = setting.seeds_or(3);
  for (int i = 0; i < seeds; ++i) {
    const PeopleOutcome one = learn_among(corridor(setting), kPeople, setting.seed(i));
    raw += one.spurious_raw;
    filtered += one.spurious_filtered;
    precision += one.precision / seeds;
    recall += one.recall / seeds;
  }
  const double left = static_cast<double>(filtered) / static_cast<double>(raw);
  return judged(left <= 0.1 && recall >= 0.9 && precision >= 0.85,
                "a measure misses its bound; see the numbers",
                {{"seeds", {}, static_cast<double>(seeds), 0},
                 {"spurious cells of all beams", {}, static_cast<double>(raw), 0},
                 {"spurious cells of static beams", {}, static_cast<double>(filtered), 0},
                 {"recall of people's beams", {}, recall, 3},
                 {"precision", {}, precision, 3}},
                {});
}

/// Poses after the rounds of EM against those of tracking alone, paired by seed.
Outcome better_poses(const Setting& setting) {
  const int seeds = setting.seeds_or(5);
  int better = 0;
  double with = 0.0;
  double without = 0.0;
  for (int i = 0; i < seeds; ++i) {
    const auto simulation = drive_among(corridor(setting), kPeople, setting.seed(i));
    const auto error = [&](int rounds) {
      slam::SlamConfig config;
      config.em.max_iterations = rounds;
      config.em.track_again = rounds > 0;
      return aligned_error_m(found_poses(learn_first_day(simulation, config)),
                             true_poses(simulation));
    };
    const double one = error(slam::EmConfig{}.max_iterations);
    const double other = error(0);
    with += one / seeds;
    without += other / seeds;
    better += one < other ? 1 : 0;
  }
  return judged(with < without && 2 * better > seeds,
                "the poses are not better in most seeds: tracking alone is about as good here",
                {{"seeds", {}, static_cast<double>(seeds), 0},
                 {"mean pose error without EM [m]", {}, without, 4},
                 {"mean pose error with EM [m]", {}, with, 4},
                 {"seeds in which it is better", {}, static_cast<double>(better), 0}},
                {});
}

/// The map of static beams after so many rounds, at the poses of that round: fewer rounds are a
/// beginning of more, and tracking is not begun anew.
Outcome rounds(const Setting& setting) {
  const auto simulation = drive_among(corridor(setting), kPeople, setting.first_seed);
  std::vector<Number> numbers;
  std::vector<Picture> pictures;
  std::vector<double> errors;
  std::vector<double> dynamic;
  for (const int round : {0, 1, 2, 6}) {
    slam::SlamConfig config;
    config.em.track_again = false;
    config.em.min_gain = 0.0;
    config.em.max_iterations = round;
    const slam::SlamResult result = learn_first_day(simulation, config);
    errors.push_back(aligned_error_m(found_poses(result), true_poses(simulation)));
    dynamic.push_back(result.dynamic_fraction);
    const std::string name = "round " + std::to_string(round);
    numbers.push_back({"mean pose error, " + name + " [m]", {}, errors.back(), 4});
    numbers.push_back({"share of hits held dynamic, " + name, {}, dynamic.back(), 6});
    pictures.push_back({"em-1.7_round_" + std::to_string(round), "at the poses of " + name,
                        png_of(round == 0 ? result.occupancy : result.filtered,
                               report::known_rect(result.occupancy))});
  }
  const auto none = [](const std::vector<double>& values, auto pair) {
    return std::adjacent_find(values.begin(), values.end(), pair) == values.end();
  };
  const bool improve = none(errors, std::less_equal<>());
  const bool fade = none(dynamic, std::greater_equal<>());
  return judged(improve && fade,
                improve ? "poses improve, but the share of dynamic hits does not rise each time"
                        : "poses do not improve each time",
                std::move(numbers), std::move(pictures));
}

Outcome likelihood(const Setting& setting) {
  const int seeds = setting.seeds_or(5);
  int rises = 0;
  report::LinePlot plot{.title = "Log likelihood over the rounds",
                        .x_label = "round",
                        .y_label = "nats above round 0"};
  double gain = 0.0;
  for (int i = 0; i < seeds; ++i) {
    const std::uint64_t seed = setting.seed(i);
    const auto all =
        learn_first_day(drive_among(corridor(setting), kPeople, seed), {}).log_likelihood;
    const double end = *std::max_element(all.begin(), all.end()) - all.front();
    rises += end > 0.0 ? 1 : 0;
    gain += end / seeds;
    report::Series series{"seed " + std::to_string(seed), {}, {}};
    for (std::size_t r = 0; r < all.size(); ++r) {
      series.x.push_back(static_cast<double>(r));
      series.y.push_back(all[r] - all.front());
    }
    plot.series.push_back(std::move(series));
  }
  return judged(rises == seeds, "it does not rise in every seed",
                {{"seeds", {}, static_cast<double>(seeds), 0},
                 {"seeds in which it rises", {}, static_cast<double>(rises), 0},
                 {"mean gain [nats]", {}, gain, 0}},
                {{"em-1.8", "log likelihood, a line a seed", plot}});
}

struct Outdoors {
  slam::SlamResult result;
  std::size_t scans = 0;
  double way_m = 0.0;
  double error_m = 0.0;
};

Outdoors drive_outdoors(const Setting& setting, bool use_odometry) {
  pipeline::RunsInput input;
  input.logs = {data_file(setting, "radish/freiburg-campus/log.clf.gz")};
  input.truths = {data_file(setting, "radish/freiburg-campus/truth.tum")};
  input.use_odometry = use_odometry;
  const pipeline::Runs runs = pipeline::read_runs(input, nullptr);
  slam::Slam slam({}, setting.threads);
  for (const Observation& observation : runs.observations) slam.add(observation);
  const std::vector<log::StampedPose> truth = stamped_truth(runs);
  Outdoors outdoors{slam.finish(), runs.observations.size()};
  for (std::size_t i = 1; i < truth.size(); ++i) {
    outdoors.way_m += translation_distance(truth[i - 1].pose, truth[i].pose);
  }
  outdoors.error_m = pose_error_m(outdoors.result.scans, truth);
  return outdoors;
}

Outcome outdoors(const Setting& setting) {
  const Outdoors without = drive_outdoors(setting, false);
  const Outdoors with = drive_outdoors(setting, true);
  const std::size_t placed = without.result.scans.size();
  const double bound_m = 0.01 * without.way_m;
  const bool all_placed = 10 * placed >= 9 * without.scans;
  std::string why_not = "too few scans are placed";
  if (all_placed) {
    why_not = with.error_m <= bound_m
                  ? "without odometry the way bends; with it the same scans stay within the bound"
                  : "the way bends, with odometry too";
  }
  return judged(without.error_m <= bound_m && all_placed, why_not,
                {{"way [m]", {}, without.way_m, 0},
                 {"scans", {}, static_cast<double>(without.scans), 0},
                 {"scans placed", {}, static_cast<double>(placed), 0},
                 {"mean pose error after alignment, no odometry [m]", {}, without.error_m, 2},
                 {"the same with its odometry [m]", {}, with.error_m, 2}},
                {{"em-1.9", "static beams",
                  png_of(without.result.filtered, report::known_rect(without.result.filtered))}});
}

}  // namespace

std::vector<Figure> em_figures() {
  return {{"em-1.4", "em", "A map without and with people's beams",
           "without the filter people leave many spurious objects; with it almost none.",
           "at most 10% of the spurious cells stay, recall >= 0.90, precision >= 0.85.", kCorridor,
           ghosts, ""},
          {"em-1.5", "em", "Registration among people (figures 1.5 and 1.6)",
           "filtered beams make poses better.",
           "the mean pose error is lower, and lower in more than half of the seeds.", kCorridor,
           better_poses, ""},
          {"em-1.7", "em", "Maps over the rounds, at the poses of each",
           "people fade out round by round, and poses improve.",
           "of rounds 0, 1, 2 and 6 each has a lower pose error and more dynamic hits than the one "
           "before.",
           kCorridor, rounds, ""},
          {"em-1.8", "em", "Log likelihood over the rounds", "it rises, though not always.",
           "its best round is above round 0 in every seed.", kCorridor, likelihood, ""},
          {"em-1.9", "em", "A kilometre outdoors without odometry",
           "a map of streets from the scans of a car alone.",
           "mean pose error <= 1% of the way, and at least 90% of the scans placed.",
           "the real log freiburg-campus without its odometry", outdoors, ""},
          {"em-1.10", "em", "Textured models of a lobby", "no people in the textures.",
           "of the texels that a picture showed at most 0.1% show a person, and at most a tenth of "
           "those that do without filtering; at least 80% of the occupied voxels lie in polygons.",
           "the simulated room_people_3d.yaml, four people", textured_rooms, ""}};
}

}  // namespace strata::paper
