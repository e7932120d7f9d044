// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/fit_warning.hpp"

#include "tools/report/plot.hpp"
#include "tools/strata/words.hpp"

namespace strata::tools {

std::string fit_warning(const LocalizedLog& log) {
  using pipeline::FitState;
  const pipeline::LogFit& fit = log.fit;
  const bool is_learned = !log.model.starts_with("timescale");
  const bool is_low = is_learned && log.mean_score && *log.mean_score < kMinMeanScore;
  if (fit.is_explained() && !is_low) return "";
  const auto share = [&](FitState state) {
    return report::fixed(100.0 * fit.share(state), 0) + "%";
  };
  std::string text = "these maps do not explain this log: ";
  if (!fit.scans.empty()) {
    text += "of its " + counted(fit.scans.size(), "weighed scan") + " " +
            share(FitState::kExplained) + " fit them, " + share(FitState::kContradicted) +
            " contradict them, and in " + share(FitState::kUnknown) +
            " they know too little of the place";
  }
  if (log.mean_score) {
    text += std::string(fit.scans.empty() ? "" : "; ") +
            "the score of its poses, as if no other place fitted, is " +
            report::fixed(*log.mean_score, 2) + " in the mean";
  }
  return text + "; is the log of this building" +
         (log.begin.empty() ? "?" : ", and did the robot begin at " + log.begin + "?");
}

std::string start_warning(const nlohmann::json& relocations, const std::string& begin) {
  if (begin.empty() || relocations.empty()) return "";
  const nlohmann::json& first = relocations.front();
  if (first["was_believed"].get<bool>()) return "";
  return "the robot did not begin at " + begin + ": no scan spoke for it, and after " +
         report::fixed(first["after_s"].get<double>(), 1) + " s it was found " +
         report::fixed(first["moved_m"].get<double>(), 1) +
         " m from where it was believed to be; correct " + begin;
}

std::string frame_warning(const pipeline::LogFit& fit, std::optional<double> error_m,
                          bool is_frame_known) {
  constexpr double kFarOff_m = 1.0;
  constexpr double kWellExplained = 0.9;
  const double explained = fit.share(pipeline::FitState::kExplained);
  if (is_frame_known || !error_m || *error_m <= kFarOff_m || explained < kWellExplained) return "";
  return "the maps explain " + report::fixed(100.0 * explained, 0) +
         "% of the drive, and the truth lies " + report::fixed(*error_m, 1) +
         " m off: it is probably in another frame, which maps that were learned without --truth do "
         "not know; learn them with --truth, or let `strata evaluate` align the trajectory with it";
}

}  // namespace strata::tools
