// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/paper/make_figures.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>

#include "core/base/error.hpp"

namespace strata::paper {
namespace {

std::string all_names(const std::vector<Figure>& known) {
  std::string names = "all";
  for (const Figure& figure : known) {
    if (names.find(", " + figure.paper + ",") == std::string::npos) names += ", " + figure.paper;
    names += ", " + figure.id;
  }
  return names;
}

bool is_named(const Figure& figure, const std::string& name) {
  return name == "all" || name == figure.id || name == figure.paper;
}

Outcome not_made(std::string why) {
  Outcome outcome;
  outcome.reason = std::move(why);
  return outcome;
}

bool has_a_number(const Outcome& outcome) {
  return std::any_of(outcome.numbers.begin(), outcome.numbers.end(), [](const Number& number) {
    return number.ours && std::isfinite(*number.ours);
  });
}

Outcome outcome_of(const Figure& figure, const Setting& setting) {
  if (!figure.make) return not_made(figure.missing);
  try {
    Outcome outcome = figure.make(setting);
    if (outcome.verdict != Verdict::kNotMade && !has_a_number(outcome)) {
      return not_made("it says \"" + word(outcome.verdict) + "\" without a number");
    }
    return outcome;
  } catch (const std::exception& error) {
    return not_made(error.what());
  }
}

}  // namespace

std::vector<Figure> select(const std::vector<Figure>& known,
                           const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    const bool is_known =
        name == "all" || std::any_of(known.begin(), known.end(),
                                     [&](const Figure& figure) { return is_named(figure, name); });
    if (!is_known) {
      throw InputError(name, "is no figure of the papers", "name one of " + all_names(known));
    }
  }
  std::vector<Figure> selected;
  for (const Figure& figure : known) {
    const bool is_wanted = std::any_of(names.begin(), names.end(), [&](const std::string& name) {
      return is_named(figure, name);
    });
    if (is_wanted) selected.push_back(figure);
  }
  return selected;
}

Row make(const Figure& figure, const Setting& setting) {
  const auto begin = std::chrono::steady_clock::now();
  Row row{figure, outcome_of(figure, setting), 0.0};
  row.took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return row;
}

std::vector<Row> make_all(const std::vector<Figure>& figures, const Setting& setting,
                          const std::function<void(const std::vector<Row>&)>& each) {
  std::vector<Row> rows;
  for (const Figure& figure : figures) {
    rows.push_back(make(figure, setting));
    if (each) each(rows);
  }
  return rows;
}

}  // namespace strata::paper
