// SPDX-License-Identifier: Apache-2.0
#include "core/periodic/fit_shares.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace strata::periodic {
namespace {

constexpr int kMaxSteps = 30;
constexpr int kMaxHalvings = 20;
constexpr double kTolerance = 1e-9;
/// Of the logits themselves: adding a number to all of them changes nothing, so something must hold
/// them.
constexpr double kLogitStddev = 30.0;

/// Multinomial logistic regression; the coefficients of a state follow each other.
class Regression {
 public:
  Regression(const WeeklySightings& sightings, std::span<const int> cycles, double amplitude)
      : sightings_(sightings),
        states_(static_cast<Eigen::Index>(sightings.states())),
        features_(1 + 2 * static_cast<Eigen::Index>(cycles.size())),
        design_(kHoursAWeek, features_),
        precision_(features_) {
    for (int hour = 0; hour < kHoursAWeek; ++hour) {
      design_(hour, 0) = 1.0;
      for (std::size_t c = 0; c < cycles.size(); ++c) {
        const double phase = 2.0 * std::numbers::pi * cycles[c] * middle_of_hour(hour);
        const auto column = static_cast<Eigen::Index>(1 + 2 * c);
        design_(hour, column) = std::cos(phase);
        design_(hour, column + 1) = std::sin(phase);
      }
    }
    precision_.setConstant(1.0 / (amplitude * amplitude));
    precision_(0) = 1.0 / (kLogitStddev * kLogitStddev);
  }

  [[nodiscard]] Eigen::Index size() const { return states_ * features_; }
  [[nodiscard]] Eigen::Index place(std::size_t state, std::size_t feature) const {
    return static_cast<Eigen::Index>(state) * features_ + static_cast<Eigen::Index>(feature);
  }

  [[nodiscard]] double objective(const Eigen::VectorXd& coefficients) const {
    double sum = -0.5 * penalties().cwiseProduct(coefficients).dot(coefficients);
    for (int hour = 0; hour < kHoursAWeek; ++hour) {
      const auto counts = counts_of(hour);
      if (!(counts.sum() > 0.0)) continue;
      const Eigen::VectorXd logits = logits_at(coefficients, hour);
      const double most = logits.maxCoeff();
      const double log_sum = most + std::log((logits.array() - most).exp().sum());
      sum += counts.dot(logits) - counts.sum() * log_sum;
    }
    return sum;
  }

  /// Newton's step.
  [[nodiscard]] Eigen::VectorXd step(const Eigen::VectorXd& coefficients) const {
    const Eigen::VectorXd penalty = penalties();
    Eigen::VectorXd gradient = -penalty.cwiseProduct(coefficients);
    Eigen::MatrixXd curvature = penalty.asDiagonal();
    for (int hour = 0; hour < kHoursAWeek; ++hour) {
      const auto counts = counts_of(hour);
      const double count = counts.sum();
      if (!(count > 0.0)) continue;
      const Eigen::VectorXd logits = logits_at(coefficients, hour);
      const Eigen::VectorXd weights = (logits.array() - logits.maxCoeff()).exp().matrix();
      const Eigen::VectorXd shares = weights / weights.sum();
      const Eigen::VectorXd x = design_.row(hour).transpose();
      const Eigen::MatrixXd outer = x * x.transpose();
      for (Eigen::Index k = 0; k < states_; ++k) {
        gradient.segment(k * features_, features_) += (counts(k) - count * shares(k)) * x;
        for (Eigen::Index l = 0; l < states_; ++l) {
          const double weight =
              count * (k == l ? shares(k) - shares(k) * shares(l) : -shares(k) * shares(l));
          curvature.block(k * features_, l * features_, features_, features_) += weight * outer;
        }
      }
    }
    return curvature.ldlt().solve(gradient);
  }

 private:
  [[nodiscard]] Eigen::Map<const Eigen::VectorXd> counts_of(int hour) const {
    return {sightings_.of(hour).data(), states_};
  }
  [[nodiscard]] Eigen::VectorXd logits_at(const Eigen::VectorXd& coefficients, int hour) const {
    Eigen::VectorXd logits(states_);
    for (Eigen::Index k = 0; k < states_; ++k) {
      logits(k) = design_.row(hour).dot(coefficients.segment(k * features_, features_));
    }
    return logits;
  }
  [[nodiscard]] Eigen::VectorXd penalties() const { return precision_.replicate(states_, 1); }

  const WeeklySightings& sightings_;
  Eigen::Index states_;
  Eigen::Index features_;
  Eigen::MatrixXd design_;     // a row an hour
  Eigen::VectorXd precision_;  // of the density of each feature's coefficient
};

Eigen::VectorXd coefficients_of(const PeriodicShares& begin, std::span<const int> cycles,
                                const Regression& regression) {
  Eigen::VectorXd coefficients = Eigen::VectorXd::Zero(regression.size());
  for (std::size_t k = 0; k < begin.logit.size(); ++k) {
    coefficients(regression.place(k, 0)) = begin.logit[k];
    for (std::size_t c = 0; c < cycles.size(); ++c) {
      for (const Harmonic& wave : begin.harmonics) {
        if (wave.cycles_a_week != cycles[c]) continue;
        coefficients(regression.place(k, 1 + 2 * c)) = wave.cosine[k];
        coefficients(regression.place(k, 2 + 2 * c)) = wave.sine[k];
      }
    }
  }
  return coefficients;
}

}  // namespace

PeriodicShares fit_shares(const WeeklySightings& sightings, std::span<const int> cycles_a_week,
                          double amplitude, const PeriodicShares& begin) {
  const Regression regression(sightings, cycles_a_week, amplitude);
  Eigen::VectorXd coefficients = coefficients_of(begin, cycles_a_week, regression);
  double value = regression.objective(coefficients);
  for (int i = 0; i < kMaxSteps; ++i) {
    Eigen::VectorXd step = regression.step(coefficients);
    double next = regression.objective(coefficients + step);
    for (int halving = 0; halving < kMaxHalvings && !(next >= value); ++halving) {
      step *= 0.5;
      next = regression.objective(coefficients + step);
    }
    if (!(next >= value)) break;
    coefficients += step;
    const double gained = next - value;
    value = next;
    if (gained < kTolerance) break;
  }
  PeriodicShares fit;
  for (const int cycles : cycles_a_week) fit.harmonics.push_back({cycles, {}, {}});
  for (std::size_t k = 0; k < sightings.states(); ++k) {
    fit.logit.push_back(coefficients(regression.place(k, 0)));
    for (std::size_t c = 0; c < fit.harmonics.size(); ++c) {
      fit.harmonics[c].cosine.push_back(coefficients(regression.place(k, 1 + 2 * c)));
      fit.harmonics[c].sine.push_back(coefficients(regression.place(k, 2 + 2 * c)));
    }
  }
  return fit;
}

}  // namespace strata::periodic
