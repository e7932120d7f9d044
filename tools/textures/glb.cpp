// SPDX-License-Identifier: Apache-2.0
#include "tools/textures/glb.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include <nlohmann/json.hpp>

namespace strata::textures {
namespace {

constexpr int kFloat = 5126;
constexpr int kUnsigned = 5125;

void put(std::string& bytes, std::uint32_t value) {
  for (int shift = 0; shift < 32; shift += 8) {
    bytes.push_back(static_cast<char>(value >> shift & 0xFFU));
  }
}

void put(std::string& bytes, double value) {
  put(bytes, std::bit_cast<std::uint32_t>(static_cast<float>(value)));
}

void fill_to_four(std::string& bytes, char with) {
  while (bytes.size() % 4 != 0) bytes.push_back(with);
}

std::string png_of(const volume::ColorImage& texture) {
  report::Image image(texture.width, texture.height);
  for (int y = 0; y < texture.height; ++y) {
    for (int x = 0; x < texture.width; ++x) {
      const volume::Rgb& color = texture.at(x, y);
      image.set(x, y, {color.r, color.g, color.b});
    }
  }
  return report::encode_png(image);
}

/// The parts of the binary chunk, one after the other.
struct Buffer {
  std::string bytes;
  nlohmann::json views = nlohmann::json::array();
  void add(const std::string& part) {
    fill_to_four(bytes, '\0');
    views.push_back({{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", part.size()}});
    bytes += part;
  }
};

nlohmann::json accessor(int view, int component, std::size_t count, const char* type) {
  return {{"bufferView", view}, {"componentType", component}, {"count", count}, {"type", type}};
}

}  // namespace

std::string glb_of(const TexturedMesh& mesh) {
  std::string places;
  std::string in_texture;
  std::string triangles;
  Eigen::Vector3f low = Eigen::Vector3f::Constant(mesh.polygons.empty() ? 0.0F : 1e9F);
  Eigen::Vector3f high = -low;
  std::uint32_t first = 0;
  for (const TexturedPolygon& polygon : mesh.polygons) {
    for (std::size_t i = 0; i < 4; ++i) {
      for (const double value : polygon.corners_m[i]) put(places, value);
      low = low.cwiseMin(polygon.corners_m[i].cast<float>());
      high = high.cwiseMax(polygon.corners_m[i].cast<float>());
      put(in_texture, polygon.corners_texture[i].x() / mesh.texture.width);
      put(in_texture, polygon.corners_texture[i].y() / mesh.texture.height);
    }
    for (const std::uint32_t corner : {0U, 1U, 2U, 0U, 2U, 3U}) put(triangles, first + corner);
    first += 4;
  }
  Buffer buffer;
  for (const std::string& part : {places, in_texture, triangles, png_of(mesh.texture)}) {
    buffer.add(part);
  }
  fill_to_four(buffer.bytes, '\0');
  const std::size_t corners = 4 * mesh.polygons.size();
  nlohmann::json place = accessor(0, kFloat, corners, "VEC3");
  place["min"] = {low.x(), low.y(), low.z()};
  place["max"] = {high.x(), high.y(), high.z()};
  const double half = std::sqrt(0.5);
  nlohmann::json json{
      {"asset", {{"version", "2.0"}, {"generator", "Strata"}}},
      {"scene", 0},
      {"scenes", {{{"nodes", {0}}}}},
      {"nodes", {{{"mesh", 0}, {"rotation", {-half, 0.0, 0.0, half}}}}},
      {"buffers", {{{"byteLength", buffer.bytes.size()}}}},
      {"bufferViews", buffer.views},
      {"accessors",
       {place, accessor(1, kFloat, corners, "VEC2"),
        accessor(2, kUnsigned, 6 * mesh.polygons.size(), "SCALAR")}},
      {"images", {{{"bufferView", 3}, {"mimeType", "image/png"}}}},
      {"samplers", {{{"magFilter", 9728}, {"minFilter", 9728}}}},
      {"textures", {{{"source", 0}, {"sampler", 0}}}},
      {"extensionsUsed", {"KHR_materials_unlit"}},
      {"materials",
       {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}, {"metallicFactor", 0}}},
         {"extensions", {{"KHR_materials_unlit", nlohmann::json::object()}}},
         {"doubleSided", true}}}},
      {"meshes",
       {{{"primitives",
          {{{"attributes", {{"POSITION", 0}, {"TEXCOORD_0", 1}}},
            {"indices", 2},
            {"material", 0}}}}}}}};
  std::string text = json.dump();
  fill_to_four(text, ' ');
  std::string file;
  put(file, 0x46546C67U);  // "glTF"
  put(file, 2U);
  put(file, static_cast<std::uint32_t>(12 + 8 + text.size() + 8 + buffer.bytes.size()));
  put(file, static_cast<std::uint32_t>(text.size()));
  put(file, 0x4E4F534AU);  // "JSON"
  file += text;
  put(file, static_cast<std::uint32_t>(buffer.bytes.size()));
  put(file, 0x004E4942U);  // "BIN"
  return file + buffer.bytes;
}

std::vector<report::ColoredCube> texel_cubes(const TexturedMesh& mesh, double ceiling_m,
                                             std::size_t max_cubes) {
  int texels = 1;
  while (mesh.texels > max_cubes * static_cast<std::size_t>(texels * texels)) ++texels;
  std::vector<report::ColoredCube> cubes;
  for (const TexturedPolygon& polygon : mesh.polygons) {
    const auto& m = polygon.corners_m;
    const auto& t = polygon.corners_texture;
    // In the texture the rectangle lies upright, its first corner below on the left.
    const auto left = static_cast<int>(t[0].x());
    const auto bottom = static_cast<int>(t[0].y());
    const auto width = static_cast<int>(t[1].x()) - left;
    const auto height = bottom - static_cast<int>(t[3].y());
    const double edge_m = (m[1] - m[0]).norm() / width * texels;
    for (int from_y = 0; from_y < height; from_y += texels) {
      const int y = std::min(from_y + texels / 2, height - 1);
      for (int from_x = 0; from_x < width; from_x += texels) {
        const int x = std::min(from_x + texels / 2, width - 1);
        const Eigen::Vector3d middle_m =
            m[0] + (x + 0.5) / width * (m[1] - m[0]) + (y + 0.5) / height * (m[3] - m[0]);
        if (middle_m.z() > ceiling_m) continue;
        const volume::Rgb& color = mesh.texture.at(left + x, bottom - 1 - y);
        cubes.push_back({middle_m - Eigen::Vector3d::Constant(0.5 * edge_m),
                         edge_m,
                         {color.r, color.g, color.b}});
      }
    }
  }
  return cubes;
}

}  // namespace strata::textures
