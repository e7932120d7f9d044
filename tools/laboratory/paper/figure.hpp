// SPDX-License-Identifier: Apache-2.0
/// A figure or table of the papers: what it shows, by which numbers that is said to hold here, and
/// how it is made.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "tools/report/plot.hpp"

namespace strata::paper {

enum class Verdict { kHeld, kNotHeld, kNotMade };
/// "held", "not held", "not made".
[[nodiscard]] std::string word(Verdict verdict);

/// One measure, in the paper's form and in ours; NaN and nothing are shown as missing.
struct Number {
  std::string label;  ///< with unit
  std::optional<double> papers_form;
  std::optional<double> ours;
  int digits = 2;
};

/// PNG bytes, or a plot.
struct Picture {
  std::string name;  ///< of its files, without ending
  std::string caption;
  std::variant<std::string, report::LinePlot> content;
};

struct Outcome {
  Verdict verdict = Verdict::kNotMade;
  std::string reason;  ///< of not held and not made
  std::vector<Number> numbers;
  std::vector<Picture> pictures;
};

/// What every figure is made with.
struct Setting {
  std::filesystem::path scenarios;
  std::filesystem::path data;  ///< the real logs; figures that need them throw without
  std::uint64_t first_seed = 1;
  int seeds = 0;  ///< 0: as many as the figure has by itself
  int threads = 2;

  [[nodiscard]] int seeds_or(int own) const { return seeds > 0 ? seeds : own; }
  /// The i-th, from 0.
  [[nodiscard]] std::uint64_t seed(int i) const {
    return first_seed + static_cast<std::uint64_t>(i);
  }
};

struct Figure {
  std::string id;     ///< such as em-1.7
  std::string paper;  ///< em, patch, kessler or ptm
  std::string title;
  std::string shows;      ///< what the paper shows, in a sentence
  std::string criterion;  ///< the numbers by which that is said to hold, fixed before the run
  std::string material;   ///< what it is made of here
  /// Null: `missing` says why it is not made.
  std::function<Outcome(const Setting&)> make;
  std::string missing;
};

/// Held or not held, as the criterion says; why_not: the reason where it is not.
[[nodiscard]] Outcome judged(bool is_held, std::string why_not, std::vector<Number> numbers,
                             std::vector<Picture> pictures);

/// A file of the real logs. Throws InputError, which names the option, where it is missing.
[[nodiscard]] std::string data_file(const Setting& setting, const std::string& name);

}  // namespace strata::paper
