// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/level_life_figures.hpp"

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "memory/levels/level_config.hpp"
#include "tests/memory/decoding/level_life.hpp"
#include "tools/report/plot.hpp"

namespace strata::memory::level_life {
namespace {

using report::LinePlot;
using report::Series;

constexpr int kSeeds = 20;

Series over_half_lives(const std::string& name, const std::vector<double>& share, double half_life,
                       double max_half_lives) {
  Series series{name, {}, {}};
  for (std::size_t t = 0; t < share.size(); ++t) {
    const double x = static_cast<double>(t) / half_life;
    if (x > max_half_lives) break;
    series.x.push_back(x);
    series.y.push_back(share[t]);
  }
  return series;
}

/// Probability that a bin still holds an old sample: of m old ones an observation takes one with
/// probability q m / N.
std::vector<double> holding_in_theory(const Rates& rates, std::size_t observations) {
  std::vector<double> left(static_cast<std::size_t>(rates.samples) + 1, 0.0);
  left.back() = 1.0;
  std::vector<double> holding;
  for (std::size_t t = 0; t < observations; ++t) {
    holding.push_back(1.0 - left.front());
    for (std::size_t m = 0; m + 1 < left.size(); ++m) {
      const auto leaves = [&](std::size_t k) {
        return rates.q * static_cast<double>(k) / rates.samples;
      };
      left[m] = left[m] * (1.0 - leaves(m)) + left[m + 1] * leaves(m + 1);
    }
    left.back() *= 1.0 - rates.q;
  }
  return holding;
}

}  // namespace

void figures(const std::filesystem::path& out) {
  const std::vector<LevelConfig> levels{{"short", 5, 3.1}, {"mid", 20, 27.0}, {"long", 50, 693.0}};
  LinePlot surviving{.title = "Samples that survive",
                     .x_label = "observations / half-life",
                     .y_label = "share",
                     .from_zero = true};
  LinePlot forgetting{.title = "Bins that still hold a sample of the old state",
                      .x_label = "observations / half-life",
                      .y_label = "share",
                      .from_zero = true};
  std::printf(
      "level life [observations]: | level | half-life: theory, measured | new state decoded | last "
      "old sample gone: theory, measured |\n");
  for (const LevelConfig& config : levels) {
    const Rates rates{config.samples, std::min(1.0, config.insertion_probability(1.0))};
    const double theory = half_life_observations(rates.samples, rates.q);
    const Life life = live(rates, kSeeds);
    std::printf("| %s | %.2f, %.2f | %.1f | %.1f, %.1f |\n", config.name.c_str(), theory,
                half_life(life), life.adaptation, rates.forgetting(), life.forgetting);
    surviving.series.push_back(over_half_lives(config.name, life.survival, theory, 3.0));
    forgetting.series.push_back(over_half_lives(config.name, life.holding, theory, 12.0));
    forgetting.series.push_back(over_half_lives(
        config.name + ", theory", holding_in_theory(rates, life.holding.size()), theory, 12.0));
  }
  Series theory{"theory", {}, {}};
  for (int i = 0; i <= 30; ++i) {
    theory.x.push_back(0.1 * i);
    theory.y.push_back(std::exp2(-0.1 * i));
  }
  surviving.series.push_back(std::move(theory));
  report::save_png(surviving, out / "half_lives.png");
  report::save_png(forgetting, out / "forgetting.png");
}

}  // namespace strata::memory::level_life
