// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/paper/figure.hpp"

#include <utility>

#include "core/base/error.hpp"

namespace strata::paper {

std::string word(Verdict verdict) {
  switch (verdict) {
    case Verdict::kHeld:
      return "held";
    case Verdict::kNotHeld:
      return "not held";
    case Verdict::kNotMade:
      break;
  }
  return "not made";
}

Outcome judged(bool is_held, std::string why_not, std::vector<Number> numbers,
               std::vector<Picture> pictures) {
  Outcome outcome;
  outcome.verdict = is_held ? Verdict::kHeld : Verdict::kNotHeld;
  if (!is_held) outcome.reason = std::move(why_not);
  outcome.numbers = std::move(numbers);
  outcome.pictures = std::move(pictures);
  return outcome;
}

std::string data_file(const Setting& setting, const std::string& name) {
  const std::filesystem::path path = setting.data / name;
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    throw InputError(path.string(), "is missing, and the figure is made of it",
                     "name the folder of the real logs by --data");
  }
  return path.string();
}

}  // namespace strata::paper
