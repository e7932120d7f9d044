// SPDX-License-Identifier: Apache-2.0
#include "core/localization/patch_states.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

namespace strata::localization {
namespace {
constexpr std::size_t kChunk = 256;
constexpr std::size_t kMaxConfigurations = 64;

/// One row of beliefs after what PatchStates::find_fading says.
void fade(std::span<const double> keep, std::span<const double> add, std::span<float> row) {
  for (std::size_t c = 0; c < row.size(); ++c) {
    row[c] = static_cast<float>(static_cast<double>(row[c]) * keep[c] + add[c]);
  }
}

}  // namespace

double stay_probability(int configurations, double gamma_per_s, double dt_s) {
  const double share = 1.0 / configurations;
  return share + (1.0 - share) * std::exp(-gamma_per_s * std::max(0.0, dt_s));
}

void update_belief(std::span<float> belief, std::span<const double> factor, double least) {
  double sum = 0.0;
  for (std::size_t k = 0; k < belief.size(); ++k) sum += static_cast<double>(belief[k]) * factor[k];
  if (!(sum > 0.0) || !std::isfinite(sum)) return;
  double clamped = 0.0;
  for (std::size_t k = 0; k < belief.size(); ++k) {
    const double b = std::max(least, static_cast<double>(belief[k]) * factor[k] / sum);
    belief[k] = static_cast<float>(b);
    clamped += b;
  }
  for (float& b : belief) b = static_cast<float>(static_cast<double>(b) / clamped);
}

PatchStates::PatchStates(std::shared_ptr<const patch::PatchMap> map,
                         const PatchStatesConfig& config)
    : map_(std::move(map)), config_(config) {
  require_valid(config, "patch_states");
  offsets_.push_back(0);
  for (const patch::Submap& submap : map_->submaps) {
    const std::size_t count = submap.configurations.size();
    if (count == 0 || count > kMaxConfigurations) {
      throw InputError("sub-map " + std::to_string(submap.id),
                       "has " + std::to_string(count) + " configurations",
                       "learn it again with 1 to 64");
    }
    offsets_.push_back(offsets_.back() + count);
    if (config.rates == RateSource::kFixed) {
      usual_.insert(usual_.end(), count, 1.0F / static_cast<float>(count));
      rates_.push_back(config.forgetting_rate_per_s);
      continue;
    }
    FilterChain known = chain_of(submap, config.min_belief);
    for (const double share : known.chain.usual) usual_.push_back(static_cast<float>(share));
    if (known.in_time.is_periodic()) {
      followed_.push_back(rates_.size());
      in_time_.push_back(std::move(known.in_time));
    }
    rates_.push_back(known.chain.rate_per_s);
  }
  something_else_.assign(rates_.size(), 0.0F);
  if (config.memory == PatchMemory::kPerParticle && config.rates == RateSource::kLearned) {
    expect_something_else();
  }
}

void PatchStates::expect_something_else() {
  const std::vector<double> shares = shares_of_something_else(*map_);
  for (std::size_t s = 0; s < shares.size(); ++s) {
    // Its place in the masks of configurations is the one behind them.
    if (!(shares[s] > 0.0) || offsets_[s + 1] - offsets_[s] == kMaxConfigurations) continue;
    something_else_[s] = static_cast<float>(shares[s]);
    expects_something_else_ = true;
    for (std::size_t c = offsets_[s]; c < offsets_[s + 1]; ++c) {
      usual_[c] = static_cast<float>(static_cast<double>(usual_[c]) * (1.0 - shares[s]));
    }
  }
}

int PatchStates::submap_of(const Eigen::Vector2d& point_m, int current) const {
  return config_.memory == PatchMemory::kNone
             ? patch::submap_in_reach(*map_, point_m, map_->entry_margin_m, current)
             : patch::submap_at(*map_, point_m, current);
}

void PatchStates::tell_time(Stamp now, ParticleSet& particles) const {
  particles.time = now;
  particles.usual.clear();
  if (!follows_time()) return;
  particles.usual = usual_;
  const auto pooled = factors_.acquire();
  std::vector<double>& shares = *pooled;
  const double part_of_week = periodic::part_of_week(now);
  for (std::size_t f = 0; f < followed_.size(); ++f) {
    const std::size_t s = followed_[f];
    shares.assign(static_cast<std::size_t>(count(s)), 0.0);
    periodic::shares_at(in_time_[f], part_of_week, shares);
    double sum = 0.0;
    for (double& share : shares) sum += share = std::max(share, config_.min_belief);
    sum /= 1.0 - static_cast<double>(something_else_[s]);
    for (std::size_t k = 0; k < shares.size(); ++k) {
      particles.usual[offsets_[s] + k] = static_cast<float>(shares[k] / sum);
    }
  }
}

void PatchStates::prepare(ParticleSet& particles) const {
  particles.belief_columns = config_.memory == PatchMemory::kNone ? 0 : columns();
  particles.beliefs.assign(particles.size() * particles.belief_columns, 0.0F);
  particles.shared_belief.clear();
  particles.usual.clear();  // of another map
  if (particles.time) tell_time(*particles.time, particles);
  if (config_.memory == PatchMemory::kShared) {
    const std::span<const float> now = usual(particles);
    particles.shared_belief.assign(now.begin(), now.end());
  }
}

void PatchStates::draw(ParticleSet& particles, std::size_t i, RandomStream& random,
                       int current) const {
  particles.submap[i] = submap_of(particles.pose(i).translation(), current);
  particles.configuration[i] = -1;
  if (config_.memory == PatchMemory::kPerParticle) {
    const std::span<const float> now = usual(particles);
    std::copy(now.begin(), now.end(), particles.belief(i).begin());
  } else if (config_.memory == PatchMemory::kNone && particles.submap[i] >= 0) {
    particles.configuration[i] =
        draw_configuration(static_cast<std::size_t>(particles.submap[i]), usual(particles), random);
  }
}

std::int32_t PatchStates::draw_configuration(std::size_t submap, std::span<const float> usual,
                                             RandomStream& random) const {
  const int configurations = count(submap);
  if (config_.rates == RateSource::kFixed) {
    return static_cast<std::int32_t>(random.below(static_cast<std::uint32_t>(configurations)));
  }
  double left = random.uniform();
  for (int k = 0; k + 1 < configurations; ++k) {
    left -= static_cast<double>(usual[offsets_[submap] + static_cast<std::size_t>(k)]);
    if (left < 0.0) return k;
  }
  return configurations - 1;
}

std::int32_t PatchStates::next_configuration(std::size_t submap, std::int32_t now, double dt_s,
                                             std::span<const float> usual,
                                             RandomStream& random) const {
  const int configurations = count(submap);
  if (configurations == 1) return now;
  if (config_.rates == RateSource::kLearned) {
    const bool is_kept = random.bernoulli(std::exp(-rates_[submap] * std::max(0.0, dt_s)));
    return is_kept ? now : draw_configuration(submap, usual, random);
  }
  if (random.bernoulli(stay_probability(configurations, rates_[submap], dt_s))) return now;
  const auto other =
      static_cast<std::int32_t>(random.below(static_cast<std::uint32_t>(configurations - 1)));
  return other < now ? other : other + 1;
}

/// The change of beliefs in dt_s as b keep[c] + add[c], for each column c.
void PatchStates::find_fading(double dt_s, std::span<const float> usual, std::vector<double>& keep,
                              std::vector<double>& add) const {
  keep.assign(columns(), 1.0);
  add.assign(columns(), 0.0);
  for (std::size_t s = 0; s + 1 < offsets_.size(); ++s) {
    if (count(s) == 1) continue;
    const double kept = std::exp(-rates_[s] * std::max(0.0, dt_s));
    for (std::size_t c = offsets_[s]; c < offsets_[s + 1]; ++c) {
      keep[c] = kept;
      add[c] = (1.0 - kept) * static_cast<double>(usual[c]);
    }
  }
}

void PatchStates::predict(double dt_s, std::uint64_t seed, std::uint64_t step,
                          ParticleSet& particles, WorkerPool& pool) const {
  const auto keep = factors_.acquire();
  const auto add = factors_.acquire();
  if (config_.memory != PatchMemory::kNone) find_fading(dt_s, usual(particles), *keep, *add);
  if (config_.memory == PatchMemory::kShared) fade(*keep, *add, particles.shared_belief);
  const auto move_one = [&](std::size_t i) {
    const std::int32_t before = particles.submap[i];
    const int now = submap_of(particles.pose(i).translation(), before);
    particles.submap[i] = now;
    if (config_.memory == PatchMemory::kPerParticle) fade(*keep, *add, particles.belief(i));
    if (config_.memory != PatchMemory::kNone || now < 0) {
      particles.configuration[i] = -1;
      return;
    }
    const auto submap = static_cast<std::size_t>(now);
    RandomStream random(seed, StreamId::kPatchTransition, step, static_cast<std::uint32_t>(i));
    particles.configuration[i] = now != before || particles.configuration[i] < 0
                                     ? draw_configuration(submap, usual(particles), random)
                                     : next_configuration(submap, particles.configuration[i], dt_s,
                                                          usual(particles), random);
  };
  const auto move = [&](std::size_t begin, std::size_t end, std::size_t /*chunk*/) {
    for (std::size_t i = begin; i < end; ++i) move_one(i);
  };
  pool.for_chunks(particles.size(), kChunk, std::cref(move));
}

void PatchStates::absorb(const Pose2Gaussian& pose, ParticleSet& particles) const {
  if (config_.memory != PatchMemory::kShared) return;
  // A cloud with two heaps is wider than this too, so no other gate is needed.
  const double spread = std::sqrt(pose.covariance(0, 0) + pose.covariance(1, 1));
  if (!(spread < config_.shared_max_stddev_m)) return;
  const auto pooled = factors_.acquire();
  std::vector<double>& factor = *pooled;
  factor.assign(columns(), 0.0);
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const std::span<const float> row = particles.belief(i);
    for (std::size_t c = 0; c < row.size(); ++c) {
      factor[c] += particles.weight[i] * static_cast<double>(row[c]);
    }
  }
  for (std::size_t s = 0; s + 1 < offsets_.size(); ++s) {
    const auto configurations = static_cast<std::size_t>(count(s));
    update_belief(std::span<float>(particles.shared_belief).subspan(offsets_[s], configurations),
                  std::span<const double>(factor).subspan(offsets_[s], configurations),
                  config_.min_belief);
  }
}

std::vector<SubmapBelief> PatchStates::posterior(const ParticleSet& particles) const {
  std::vector<SubmapBelief> beliefs;
  posterior(particles, beliefs);
  return beliefs;
}

void PatchStates::posterior(const ParticleSet& particles,
                            std::vector<SubmapBelief>& beliefs) const {
  beliefs.resize(offsets_.size() - 1);
  for (std::size_t s = 0; s < beliefs.size(); ++s) {
    beliefs[s].submap = static_cast<int>(s);
    beliefs[s].mass = 0.0;
    beliefs[s].probability.assign(static_cast<std::size_t>(count(s)), 0.0);
  }
  const bool has_own = config_.memory == PatchMemory::kPerParticle;
  const auto pooled = factors_.acquire();
  std::vector<double>& sums = *pooled;
  sums.assign(columns(), 0.0);
  const auto pooled_left = factors_.acquire();
  std::vector<double>& left = *pooled_left;
  left.assign(beliefs.size(), 0.0);
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const std::int32_t s = particles.submap[i];
    if (s >= 0) {
      SubmapBelief& inside = beliefs[static_cast<std::size_t>(s)];
      inside.mass += particles.weight[i];
      if (particles.configuration[i] >= 0) {
        inside.probability[static_cast<std::size_t>(particles.configuration[i])] +=
            particles.weight[i];
      }
    }
    if (!has_own) continue;
    const std::span<const float> row = particles.belief(i);
    for (std::size_t c = 0; c < row.size(); ++c) {
      sums[c] += particles.weight[i] * static_cast<double>(row[c]);
    }
    for (std::size_t other = 0; other < left.size() && expects_something_else_; ++other) {
      const auto configurations = static_cast<std::size_t>(count(other));
      left[other] += particles.weight[i] * left_of(row.subspan(offsets_[other], configurations));
    }
  }
  for (std::size_t s = 0; s < beliefs.size(); ++s) {
    std::vector<double>& p = beliefs[s].probability;
    for (std::size_t k = 0; k < p.size() && has_own; ++k) p[k] = sums[offsets_[s] + k];
    if (config_.memory == PatchMemory::kShared) {
      for (std::size_t k = 0; k < p.size(); ++k) {
        p[k] = static_cast<double>(particles.shared_belief[offsets_[s] + k]);
      }
    }
    double sum = something_else_[s] > 0.0F ? left[s] : 0.0;
    for (const double value : p) sum += value;
    for (std::size_t k = 0; k < p.size(); ++k) {
      p[k] = sum > 0.0 ? p[k] / sum : static_cast<double>(usual(particles)[offsets_[s] + k]);
    }
  }
}

}  // namespace strata::localization
