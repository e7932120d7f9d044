// SPDX-License-Identifier: Apache-2.0
/// What the papers' presets make of the configs of Strata.
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/beam_filter/config.hpp"
#include "components/localizer/config.hpp"
#include "components/maps/learn_config.hpp"
#include "components/settings/settings.hpp"
#include "components/timescale_memory/config.hpp"
#include "components/topology_mapper/config.hpp"
#include "core/base/error.hpp"

namespace strata::reference {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

template <typename Config>
Config read(const std::string& text) {
  return settings::read_config<Config>(settings::parse_yaml(text, "test.yaml"), "test.yaml");
}

/// "key: value" of what differs from the defaults.
template <typename Config>
std::vector<std::string> changed(const std::string& text) {
  std::istringstream before(settings::write_yaml(Config{}));
  std::istringstream after(settings::write_yaml(read<Config>(text)));
  std::vector<std::string> lines;
  std::string old_line;
  std::string new_line;
  while (std::getline(before, old_line) && std::getline(after, new_line)) {
    if (old_line != new_line) lines.push_back(new_line.substr(new_line.find_first_not_of(' ')));
  }
  return lines;
}

TEST(PaperPresets, OfEmIterateWithoutTolerance) {
  EXPECT_THAT(changed<beam_filter::BeamFilterComponentConfig>("preset: paper-em"),
              ElementsAre("mode: iterate", "endpoint_tolerance: false"));
  EXPECT_THAT(changed<slam::SlamConfig>("preset: paper-em"),
              ElementsAre("mode: iterate", "endpoint_tolerance: false"));
}

TEST(PaperPresets, OfPatchMapsEnterSubMapsCountClustersKeepWhatNeverReturnsAndForget) {
  EXPECT_THAT(changed<patch::PatchLearnerConfig>("preset: paper-patch"),
              ElementsAre("mode: entered", "theta_mode: clusters", "min_probability: 0"));
  EXPECT_THAT(changed<localizer::LocalizerComponentConfig>("preset: paper-patch"),
              ElementsAre("is_used: false", "memory: none", "rates: fixed"));
}

TEST(PaperPresets, OfTheTimescaleMemoryAreItsExperiment) {
  const auto live = read<timescale_memory::TimescaleMemoryConfig>("preset: paper-timescale");
  EXPECT_EQ(live.timescale, memory::paper_timescale_config());
  EXPECT_EQ(live.decoding, memory::paper_decoding());
  EXPECT_THAT(changed<memory::TimescaleConfig>("preset: paper-timescale"),
              ElementsAre("range_bins: 20", "max_range_m: 1.5", "warm_up: false",
                          "coupled_eviction: true", "fill_between_beams: false"));
  EXPECT_EQ(read<localizer::LocalizerComponentConfig>("preset: paper-timescale").decoding,
            memory::paper_decoding());
}

TEST(PaperPresets, OfTopologiesWeighAndDrawAsPrinted) {
  EXPECT_THAT(changed<topology::TopologyMapperConfig>("preset: paper-topology"),
              ElementsAre("weighting: paper", "expansion: particles", "revisit_stddev_m: 0.5",
                          "penalty_radius_m: 10"));
}

TEST(PaperPresets, GoTogetherAndGiveWayToKeys) {
  EXPECT_THAT(
      changed<maps::LearnConfig>("preset: [paper-em, paper-patch]\nslam: {beam_filter: {prior: "
                                 "0.9, endpoint_tolerance: true}}"),
      ElementsAre("mode: iterate", "prior: 0.9", "mode: entered", "theta_mode: clusters",
                  "min_probability: 0"));
  EXPECT_THAT(changed<memory::DecodingConfig>("preset: paper-timescale\nsearch: layered"),
              ElementsAre("edges: joint", "cost: reciprocal", "smoothing: 0", "evidence: 0"));
}

TEST(PaperPresets, OfAnotherAlgorithmAreRefused) {
  try {
    (void)read<beam_filter::BeamFilterComponentConfig>("preset: paper-topology");
    FAIL() << "took a preset that sets nothing";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("known presets are: paper-em"));
  }
}

TEST(Settings, ThatAreGoneAreLeftOutWithANote) {
  settings::Notes notes;
  (void)settings::read_config<topology::TopologyMapperConfig>(
      settings::parse_yaml("refinement: {track_again: true}", "test.yaml"), "test.yaml", {},
      &notes);
  EXPECT_THAT(notes, ElementsAre(HasSubstr("refinement.track_again is gone")));
  notes.clear();
  (void)settings::read_config<localizer::LocalizerComponentConfig>(
      settings::parse_yaml("sensor: {states: {reach_m: 2}}", "test.yaml"), "test.yaml", {}, &notes);
  EXPECT_THAT(notes, ElementsAre(HasSubstr("sensor.states.reach_m is gone")));
}

}  // namespace
}  // namespace strata::reference
