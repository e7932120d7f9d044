// SPDX-License-Identifier: Apache-2.0
/// What the actions of `strata site` share, and those that ask the gate.
#pragma once

#include <optional>
#include <span>
#include <string>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "components/site/site.hpp"
#include "tools/pipeline/runs_input.hpp"
#include "tools/strata/verb_context.hpp"

namespace strata::tools {

/// Of `strata site zones`.
struct ZoneOptions {
  std::string file;
  std::string name;
  std::string kind;
  std::optional<double> base;
  std::optional<double> multiplier;
  double outside_cost = 30.0;
};

/// Of `strata site plan`.
struct PlanOptions {
  std::string file;
  std::optional<double> metres_per_pixel;
  std::string between;
  std::optional<double> metres;
  std::string near;
  double dark = 0.5;
  bool keeps_scale = false;
  bool is_inverted = false;
};

/// Of `strata site levels`.
struct LevelOptions {
  std::string name;
  double elevation_m = 0.0;
  std::string id;
};

struct SiteOptions {
  std::string folder;
  std::string action;  ///< of a group, such as zones
  std::string version;
  std::string other;  ///< of two that are compared, the later one
  std::string maps;
  std::string id;
  std::string frame = "map";
  std::string by;
  std::string note;
  site::Site::Rubbish rubbish;
  std::size_t diary = 0;
  pipeline::RunsInput input;  ///< recordings for the gate
  std::string model;
  std::string log;    ///< to be kept
  std::string truth;  ///< ... with its true poses
  double max_mb = 2000.0;
  std::size_t recordings = 5;  ///< so many kept ones are replayed where no log is named
  std::string out;
  std::string region;  ///< a GeoJSON file
  bool anew = false;   ///< what the active version knows of the region is forgotten
  ZoneOptions zone;
  PlanOptions plan;
  LevelOptions level;
  bool unchecked = false;
  bool json = false;
};

/// Who does it, and when: now.
[[nodiscard]] site::Actor actor(const SiteOptions& options);

/// Waits for others that change it, and says so. Throws InputError where there is none.
[[nodiscard]] site::Site open_site(const SiteOptions& options, VerbContext& context);

/// One line for people, or the JSON.
void answer(const SiteOptions& options, VerbContext& context, const std::string& text,
            const nlohmann::json& as_json);

/// An action of `strata site`, or of one of its groups.
struct SiteAction {
  const char* name;
  const char* description;
  const char* example;
  void (*run)(const SiteOptions&, VerbContext&);
  void (*add_options)(CLI::App&, SiteOptions&);
};

/// --by, for the diary.
void add_who(CLI::App& action, SiteOptions& options);
/// The actions of a group, which outlive it; the chosen one's name becomes options.action.
void add_actions(CLI::App& group, std::span<const SiteAction> actions, SiteOptions& options);
/// What was chosen of them.
void run_chosen(std::span<const SiteAction> actions, const SiteOptions& options,
                VerbContext& context);

// Of site_check.cpp.
void add_gate_options(CLI::App& action, SiteOptions& options);
void check_version(const SiteOptions& options, VerbContext& context);
void compare_versions(const SiteOptions& options, VerbContext& context);
/// Adds maps, and activates them where the gate lets them through.
void take_maps(const SiteOptions& options, VerbContext& context);
void approve_version(const SiteOptions& options, VerbContext& context);

/// Adds the active version with what another one learned in a region. Of site_merge.cpp.
void merge_version(const SiteOptions& options, VerbContext& context);

}  // namespace strata::tools
