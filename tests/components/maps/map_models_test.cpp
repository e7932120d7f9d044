// SPDX-License-Identifier: Apache-2.0
/// A model is there by its registration alone, and only a whole one is taken.
#include "components/maps/map_models.hpp"

#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "tests/components/maps/learned_room.hpp"
#include "tests/components/maps/toy_model.hpp"

namespace strata::maps {
namespace {

using test_room::toy_model;
using test_room::with_toy;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

const auto kEach = [](const MapModelDescriptor&) { return true; };

TEST(MapModels, OfARegistrationAreNamedDescribedAndMade) {
  const MapModels models = with_toy();
  const Maps maps = test_room::make_maps();
  EXPECT_THAT(models.names(kEach), Contains("toy"));
  EXPECT_THAT(models.names(&MapModelDescriptor::is_in_folder), Contains("toy"));
  EXPECT_THAT(models.compared(), Contains("toy"));
  EXPECT_THAT(models.help(kEach), HasSubstr("toy: a grid that only tests know"));
  EXPECT_THAT(model_names(maps, models), Contains("toy"));
  EXPECT_THAT(model_names(Maps{}, models), Not(Contains("toy")));

  const MapModel model = make_map_model(maps, "toy", {}, models);
  EXPECT_EQ(model.name, "toy");
  EXPECT_EQ(model.descriptor, models.at("toy"));
  EXPECT_EQ(grid_of(*model.descriptor, maps), &maps.occupancy);
  EXPECT_NEAR(model.best_prediction({})({-1.5, 0.2, 0.0}, std::numbers::pi), 2.5, 0.15);
  EXPECT_THROW((void)make_map_model(Maps{}, "toy", {}, models), InputError);
  EXPECT_THROW((void)make_likelihood_field_model(maps, "toy", {}, models), ConfigError);
}

TEST(MapModels, OfARegistryAreInNoOther) {
  EXPECT_EQ(with_toy().all().size(), map_models().all().size() + 1);
  EXPECT_EQ(map_models().find("toy"), nullptr);
  EXPECT_THROW((void)make_map_model(test_room::make_maps(), "toy", {}), ConfigError);
}

TEST(MapModels, BuiltInAreInEveryFolderAndOverTopicsButForPlacesCellsAndGivenMaps) {
  const std::vector<std::string> elsewhere{"patch_places", "map"};
  const auto is_elsewhere = [&](const MapModelDescriptor& model) { return !model.is_in_folder(); };
  EXPECT_EQ(map_models().names(is_elsewhere), elsewhere);
  const auto has_no_topic = [&](const MapModelDescriptor& model) {
    return !model.follows_topics();
  };
  EXPECT_THAT(map_models().names(has_no_topic), ElementsAre("patch_places", "cells", "map"));
  EXPECT_THAT(map_models().compared(), ElementsAre("occupancy", "filtered", "patch", "timescale"));
}

/// Why the registry does not take a toy that was changed.
std::string refusal(const std::function<void(MapModelDescriptor&)>& change) {
  MapModelDescriptor model = toy_model();
  change(model);
  MapModels models = map_models();
  try {
    models.add(model);
  } catch (const ConfigError& error) {
    EXPECT_EQ(models.all().size(), map_models().all().size());
    return error.what();
  }
  return "taken";
}

TEST(MapModels, AreRefusedWithoutWhatPeopleOrProgramsNeed) {
  EXPECT_EQ(refusal([](auto&) {}), "taken");
  EXPECT_THAT(refusal([](auto& toy) { toy.description = ""; }), HasSubstr("no description"));
  EXPECT_THAT(refusal([](auto& toy) { toy.description = "two\nlines"; }), HasSubstr("one line"));
  EXPECT_THAT(refusal([](auto& toy) { toy.name = ""; }), HasSubstr("no name"));
  EXPECT_THAT(refusal([](auto& toy) { toy.family = ""; }), HasSubstr("no family"));
  EXPECT_THAT(refusal([](auto& toy) { toy.needs.clear(); }), HasSubstr("needs no part"));
  EXPECT_THAT(refusal([](auto& toy) { toy.make = nullptr; }), HasSubstr("cannot be made"));
  EXPECT_THAT(refusal([](auto& toy) { toy.argument = "SIDE"; }), HasSubstr("argument"));
  EXPECT_THAT(refusal([](auto& toy) { toy.name = "patch_paper"; }), HasSubstr("is there already"));
  EXPECT_THAT(refusal([](auto& toy) { toy.name = "timescale_LEVEL"; }),
              HasSubstr("is there already"));
}

TEST(MapModels, OfAnArgumentTakeWhatTheMapsHoldUnlessTheNameIsAnothers) {
  MapModels models = map_models();
  MapModelDescriptor sided = toy_model();
  sided.name = "toy_";
  sided.argument = "SIDE";
  sided.arguments = [](const Maps&) { return std::vector<std::string>{"left", "right"}; };
  models.add(sided);
  models.add([] {
    MapModelDescriptor model = toy_model();
    model.name = "toy_whole";
    return model;
  }());
  EXPECT_EQ(models.at("toy_left")->shown_name(), "toy_SIDE");
  EXPECT_EQ(models.at("toy_whole")->shown_name(), "toy_whole");
  EXPECT_EQ(models.find("toy_"), nullptr);
  const auto names = model_names(test_room::make_maps(), models);
  EXPECT_THAT(names, Contains("toy_right"));
  EXPECT_THAT(names, Not(Contains("toy_SIDE")));
  EXPECT_EQ(map_models().at("timescale_mid")->shown_name(), "timescale_LEVEL");
  EXPECT_EQ(map_models().at("timescale_frozen")->learns, MapLearning::kLevelWeights);
}

}  // namespace
}  // namespace strata::maps
