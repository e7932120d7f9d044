// SPDX-License-Identifier: Apache-2.0
#include "tools/textures/glb.hpp"

#include <cstdint>
#include <cstring>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/textures/painted_wall.hpp"

namespace strata::textures {
namespace {

using test_wall::looking;
using test_wall::Wall;

std::uint32_t number_at(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

TEST(Glb, HoldsPolygonsAndPictureWhereItsJsonSays) {
  const Wall wall;
  TextureMaker maker({}, wall.colors, wall.map.lattice());
  maker.add(0, looking(0.05, wall.first));
  const TexturedMesh mesh = maker.mesh();
  const std::string file = glb_of(mesh);
  ASSERT_EQ(file.substr(0, 4), "glTF");
  EXPECT_EQ(number_at(file, 4), 2U);
  EXPECT_EQ(number_at(file, 8), file.size());
  const std::size_t length = number_at(file, 12);
  ASSERT_EQ(file.substr(16, 4), "JSON");
  const auto json = nlohmann::json::parse(file.substr(20, length));
  const std::size_t binary = 20 + length + 8;
  ASSERT_EQ(file.substr(binary - 4, 3), "BIN");
  EXPECT_EQ(binary + number_at(file, binary - 8), file.size());
  EXPECT_EQ(json["buffers"][0]["byteLength"], file.size() - binary);
  ASSERT_EQ(json["nodes"].size(), 1U);
  EXPECT_EQ(json["nodes"][0]["mesh"], 0);
  EXPECT_EQ(json["scenes"][0]["nodes"][0], 0);
  const auto& primitive = json["meshes"][0]["primitives"][0];
  const auto view = [&](const nlohmann::json& accessor) {
    return json["bufferViews"]
               [json["accessors"][accessor.get<std::size_t>()]["bufferView"].get<std::size_t>()];
  };
  EXPECT_EQ(json["accessors"][primitive["attributes"]["POSITION"].get<std::size_t>()]["count"], 4);
  const std::size_t places = view(primitive["attributes"]["POSITION"])["byteOffset"];
  float x = 0.0F;
  std::memcpy(&x, file.data() + binary + places, sizeof x);
  EXPECT_NEAR(x, 3.05F, 1e-6F);
  const std::size_t indices = view(primitive["indices"])["byteOffset"];
  EXPECT_EQ(number_at(file, binary + indices + 4 * 5), 3U);
  const std::size_t image =
      json["bufferViews"][json["images"][0]["bufferView"].get<std::size_t>()]["byteOffset"];
  EXPECT_EQ(file.substr(binary + image + 1, 3), "PNG");
  EXPECT_EQ(json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["index"], 0);
  EXPECT_EQ(json["textures"][0]["source"], 0);
}

}  // namespace
}  // namespace strata::textures
