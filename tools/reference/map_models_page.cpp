// SPDX-License-Identifier: Apache-2.0
#include "tools/reference/map_models_page.hpp"

#include <vector>

namespace strata::reference {
namespace {

const char* told(maps::MapLearning learns) {
  switch (learns) {
    case maps::MapLearning::kNothing:
      break;
    case maps::MapLearning::kSubmapStates:
      return "the states of its sub-maps";
    case maps::MapLearning::kLevelWeights:
      return "which level to believe";
    case maps::MapLearning::kMemory:
      return "the scans";
    case maps::MapLearning::kCells:
      return "the states of its cells";
  }
  return "nothing";
}

std::string parts_of(const maps::MapModelDescriptor& model) {
  std::vector<std::string> parts;
  for (const maps::MapPart part : model.needs) parts.emplace_back(maps::info_of(part).name);
  return maps::join_names(parts, " and ");
}

/// What brings all that it needs, beside its free space.
std::string topics_of(const maps::MapModelDescriptor& model) {
  if (!model.follows_topics()) return "";
  std::vector<std::string> messages;
  for (const maps::MapPart part : model.needs) messages.emplace_back(maps::info_of(part).message);
  return maps::join_names(messages, " and ");
}

}  // namespace

std::string map_models_page(const maps::MapModels& models) {
  std::string text =
      "# Map models\n\nWhat `localize --model`, `compare --models` and the localizer's `model` "
      "name ([comparing maps](../comparing.md)).\n\nMade by `strata-reference` from the code; do "
      "not edit.\n\n"
      "| model | family | made of | in a MAPS folder | from topics | learns while localizing | "
      "`compare` takes it by default | likelihood field | what it is |\n"
      "|---|---|---|---|---|---|---|---|---|\n";
  for (const auto& model : models.all()) {
    const auto yes = [](bool is_so) { return std::string(is_so ? "yes" : ""); };
    text += "| `" + model->shown_name() + "` | " + model->family + " | " + parts_of(*model) +
            " | " + yes(model->is_in_folder()) + " | " + topics_of(*model) + " | " +
            told(model->learns) + " | " + yes(model->is_compared) + " | " +
            yes(model->has_likelihood_field()) + " | " + model->description + " |\n";
  }
  return text;
}

}  // namespace strata::reference
