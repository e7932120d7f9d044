// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/place_figures.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/error.hpp"
#include "memory/decoding/decode.hpp"

namespace strata::experiments {
namespace {

using memory::DecodingConfig;
using memory::NodeLevel;

constexpr int kScans = 60;
constexpr double kWhole = 0.95;

NodeLevel filled(const TwoStates& states, bool coupled_eviction, const PlaceFigures& figures,
                 RandomStream& random) {
  NodeLevel level(figures.bins, figures.samples, coupled_eviction);
  for (int t = 0; t < 2 * figures.samples; ++t) level.insert(draw(states.before, random), random);
  return level;
}

double sample_share(const TwoStates& states, const NodeLevel& level) {
  double shown = 0.0;
  double all = 0.0;
  for (const std::size_t bin : states.bins) {
    for (const float range_m : level.samples(static_cast<int>(bin))) {
      shown += states.shows_after(range_m, bin) ? 1.0 : 0.0;
      all += 1.0;
    }
  }
  return all > 0.0 ? shown / all : 0.0;
}

}  // namespace

std::vector<NamedDecoder> paper_decoders() {
  const auto by = [](DecodingConfig config) {
    return [config](const NodeLevel& level) { return memory::decode(level, config).range_m; };
  };
  return {{"scene", false, by(memory::scene_decoding())},
          {"exact", false, by(memory::exact_decoding())},
          {"paper", true, by(memory::paper_decoding())},
          {"literal", true, by(memory::literal_decoding())},
          {"median of each bin", false, memory::decode_per_bin_median}};
}

NamedDecoder decoder_named(const std::string& name) {
  for (const NamedDecoder& decoder : paper_decoders()) {
    if (decoder.name == name) return decoder;
  }
  throw Error(name, "is no decoder", "name one of paper_decoders()");
}

SwitchResult switch_states(const TwoStates& states, const NamedDecoder& decoder,
                           const PlaceFigures& figures) {
  SwitchResult result;
  int switched = 0;
  for (int i = 0; i < figures.seeds; ++i) {
    RandomStream random(figures.first_seed + static_cast<std::uint64_t>(i), StreamId::kTest);
    NodeLevel level = filled(states, decoder.coupled_eviction, figures, random);
    bool has_switched = false;
    for (int t = 1; t <= kScans; ++t) {
      level.insert(draw(states.after, random), random);
      const double shown = states.share_after(decoder.ranges(level), states.bins);
      if (i == 0) result.shown.push_back(shown);
      if (shown > 1.0 - kWhole && shown < kWhole) result.mixed += 1.0 / figures.seeds;
      if (shown < kWhole || has_switched) continue;
      has_switched = true;
      const double share = sample_share(states, level);
      result.first_scan += t;
      result.share += share;
      result.min_share = std::min(result.min_share, share);
      result.greatest_share = std::max(result.greatest_share, share);
    }
    switched += has_switched ? 1 : 0;
  }
  result.never = figures.seeds - switched;
  if (switched > 0) {
    result.first_scan /= switched;
    result.share /= switched;
  }
  return result;
}

CompletionResult complete_half(const TwoStates& states, const NamedDecoder& decoder,
                               const PlaceFigures& figures) {
  const std::span<const std::size_t> hidden =
      std::span(states.bins).subspan(states.bins.size() / 2);
  CompletionResult result;
  for (int i = 0; i < figures.seeds; ++i) {
    RandomStream random(figures.first_seed + static_cast<std::uint64_t>(i), StreamId::kTest);
    NodeLevel level = filled(states, false, figures, random);
    for (int t = 0; t < 5; ++t) level.insert(draw(states.after, random), random);
    for (int t = 0; t < 80; ++t) {
      memory::VirtualScan view = draw(states.after, random);
      for (const std::size_t bin : hidden) view[bin] = std::numeric_limits<float>::quiet_NaN();
      level.insert(view, random);
    }
    const std::vector<float> decoded = decoder.ranges(level);
    result.complete += states.share_after(decoded, hidden) >= kWhole ? 1 : 0;
    if (i == 0) result.decoded_m = decoded;
  }
  return result;
}

double wrong_bins(const TwoStates& states, const NamedDecoder& decoder, double share,
                  const PlaceFigures& figures) {
  double wrong = 0.0;
  for (int i = 0; i < figures.seeds; ++i) {
    RandomStream random(figures.first_seed + static_cast<std::uint64_t>(i), StreamId::kTest);
    NodeLevel level(figures.bins, figures.samples, decoder.coupled_eviction);
    for (int t = 0; t < 100; ++t) {
      level.insert(draw(random.bernoulli(share) ? states.after : states.before, random), random);
    }
    wrong += states.share_after(decoder.ranges(level), states.bins) / figures.seeds;
  }
  return wrong;
}

}  // namespace strata::experiments
