// SPDX-License-Identifier: Apache-2.0
/// Makes figures one by one, and writes what came out: a page, a table, JSON.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "tools/laboratory/paper/figure.hpp"

namespace strata::paper {

struct Row {
  Figure figure;
  Outcome outcome;
  double took_s = 0.0;  ///< wall time
};

/// The figures of these names: ids, papers, `all`; each once, in the order of `known`. Throws
/// InputError, which lists the names, for one that is none.
[[nodiscard]] std::vector<Figure> select(const std::vector<Figure>& known,
                                         const std::vector<std::string>& names);

/// Its row. What it throws is the reason why it is not made. One that says that it holds, or does
/// not, without a finite number in our form is not made either.
[[nodiscard]] Row make(const Figure& figure, const Setting& setting);

/// All of them; `each`, where it is not null, is told of the rows so far whenever one is there.
[[nodiscard]] std::vector<Row> make_all(const std::vector<Figure>& figures, const Setting& setting,
                                        const std::function<void(const std::vector<Row>&)>& each);

}  // namespace strata::paper
