// SPDX-License-Identifier: Apache-2.0
#include "core/patch_beams/something_else.hpp"

#include <algorithm>
#include <limits>

#include "core/rays/column_math.hpp"

namespace strata::patch_beams {
namespace {

/// How much less a thing that nobody saw explains of a scan than one that is known [nats, after
/// tempering]. With 0 areas whose states return say nothing of the pose any more, with 4 a new box
/// is taken for a known one: chosen on wards and corridors 11 to 22.
constexpr double kSurprise_nats = 2.0;

}  // namespace

/// False where no beam met the sub-map.
bool SomethingElse::find_gains(std::size_t submap, double tempering,
                               std::span<const double> log_likelihood, std::size_t chunk_size,
                               std::span<SubmapRatios> ratios) {
  const double per_tempering = 1.0 / tempering;
  gain_.assign(log_likelihood.size(), 0.0);
  total_.assign(log_likelihood.begin(), log_likelihood.end());
  bool is_met = false;
  for (std::size_t chunk = 0; chunk < ratios.size(); ++chunk) {
    SubmapRatios& of_chunk = ratios[chunk];
    const SubmapRatios::Met* const met = of_chunk.find(submap);
    if (met == nullptr) continue;
    is_met = true;
    const std::size_t begin = chunk * chunk_size;
    const std::size_t count = std::min(chunk_size, gain_.size() - begin);
    double* const gain = gain_.data() + begin;
    const std::size_t last = met->configurations - 1;
    const double* const absent = &of_chunk.at(met->row + last, 0);
    for (std::size_t k = 0; k < last; ++k) {
      const double* const there = &of_chunk.at(met->row + k, 0);
      for (std::size_t n = 0; n < count; ++n) gain[n] = std::max(gain[n], there[n] - absent[n]);
    }
    for (std::size_t n = 0; n < count; ++n) {
      gain[n] *= per_tempering;
      total_[begin + n] += absent[n] * per_tempering + gain[n];
    }
  }
  return is_met;
}

/// The mean of the gains, each weighed by how likely its particle is with it.
double SomethingElse::likely_gain(std::span<const double> weight) {
  double most = -std::numeric_limits<double>::infinity();
  for (const double total : total_) most = std::max(most, total);
  for (double& total : total_) total -= most;
  rays::exp_column(total_.data(), total_.size());
  double sum = 0.0;
  double mean = 0.0;
  for (std::size_t i = 0; i < total_.size(); ++i) {
    const double share = weight[i] * total_[i];
    sum += share;
    mean += share * gain_[i];
  }
  return sum > 0.0 ? mean / sum : 0.0;
}

void SomethingElse::explain(const localization::PatchStates& layout, double tempering,
                            std::span<const double> weight, std::span<const double> log_likelihood,
                            std::size_t chunk_size, std::span<SubmapRatios> ratios) {
  for (std::size_t submap = 0; submap < layout.submaps(); ++submap) {
    if (!(layout.something_else(submap) > 0.0F)) continue;
    if (!find_gains(submap, tempering, log_likelihood, chunk_size, ratios)) continue;
    const double explained = (likely_gain(weight) - kSurprise_nats) * tempering;
    const auto rows = static_cast<std::size_t>(layout.count(submap)) + 1;
    for (std::size_t chunk = 0; chunk < ratios.size(); ++chunk) {
      const std::size_t place = ratios[chunk].place_of(submap, rows);
      const std::size_t row = ratios[chunk].met()[place].row + rows - 1;
      const std::size_t count = std::min(chunk_size, gain_.size() - chunk * chunk_size);
      for (std::size_t n = 0; n < count; ++n) {
        ratios[chunk].at(row, n) += explained;
        ratios[chunk].meet_again(place, n);
      }
    }
  }
}

}  // namespace strata::patch_beams
