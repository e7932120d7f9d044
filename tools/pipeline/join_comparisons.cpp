// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/join_comparisons.hpp"

#include <algorithm>
#include <iterator>
#include <tuple>
#include <utility>

#include "core/base/error.hpp"

namespace strata::pipeline {
namespace {

template <typename T>
void append(const std::vector<T>& from, std::vector<T>& to) {
  to.insert(to.end(), from.begin(), from.end());
}

void append_memory(const std::vector<MemoryPoint>& from, std::vector<MemoryPoint>& to) {
  for (std::size_t i = 0; i < from.size(); ++i) {
    if (i == to.size()) {
      to.push_back(from[i]);
      continue;
    }
    append(from[i].run_means_m, to[i].run_means_m);
    to[i].lost_runs += from[i].lost_runs;
  }
}

[[noreturn]] void refuse(const std::string& place) {
  throw InputError(place, "has shards that do not fit each other", "run all of them again");
}

bool same_drives(const Comparison& a, const Comparison& b) {
  bool same = a.parts.size() == b.parts.size() && a.models.size() == b.models.size();
  for (std::size_t p = 0; same && p < a.parts.size(); ++p) {
    same = a.parts[p].name == b.parts[p].name && a.parts[p].scans == b.parts[p].scans;
  }
  for (std::size_t m = 0; same && m < a.models.size(); ++m) {
    same = a.models[m].model == b.models[m].model;
  }
  return same;
}

}  // namespace

void append_drives(const ModelResult& from, std::size_t first_part, ModelResult& to) {
  for (ModelRun run : from.runs) {
    run.part += first_part;
    to.runs.push_back(std::move(run));
  }
  append(from.scores, to.scores);
  append(from.false_adaptation, to.false_adaptation);
  append(from.planning, to.planning);
  append(from.own_pose, to.own_pose);
}

Comparison join_splits(std::vector<Comparison> splits) {
  Comparison joint = std::move(splits.front());
  for (std::size_t s = 1; s < splits.size(); ++s) {
    const std::size_t first_part = joint.parts.size();
    append(splits[s].parts, joint.parts);
    for (std::size_t m = 0; m < joint.models.size(); ++m) {
      append_drives(splits[s].models[m], first_part, joint.models[m]);
      append_memory(splits[s].models[m].memory, joint.models[m].memory);
    }
    splits[s] = {};
  }
  return joint;
}

Comparison join_seeds(std::vector<Comparison> shares, const std::string& place) {
  const auto scored = [](const Comparison& share) {
    return !share.models.empty() && !share.models.front().scores.empty();
  };
  if (std::count_if(shares.begin(), shares.end(), scored) != 1) refuse(place);
  const auto with_scores = std::find_if(shares.begin(), shares.end(), scored);
  Comparison joint = std::move(*with_scores);
  shares.erase(with_scores);
  for (Comparison& share : shares) {
    if (!same_drives(joint, share)) refuse(place);
    for (std::size_t m = 0; m < joint.models.size(); ++m) {
      std::vector<ModelRun>& runs = share.models[m].runs;
      std::move(runs.begin(), runs.end(), std::back_inserter(joint.models[m].runs));
    }
  }
  for (ModelResult& model : joint.models) {
    const auto order = [](const ModelRun& run) { return std::tuple(run.part, run.seed); };
    std::sort(model.runs.begin(), model.runs.end(),
              [&](const ModelRun& a, const ModelRun& b) { return order(a) < order(b); });
    const auto twice = std::adjacent_find(
        model.runs.begin(), model.runs.end(),
        [&](const ModelRun& a, const ModelRun& b) { return order(a) == order(b); });
    if (twice != model.runs.end() || model.runs.size() != joint.parts.size() * joint.seeds) {
      refuse(place);
    }
  }
  return joint;
}

}  // namespace strata::pipeline
