// Primary hits of meshes, seen by the cameras of a table, against the counts and distances of that table.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "accel/registry.h"
#include "baselines/register_baselines.h"
#include "harness/ray_batch.h"
#include "scenes/open_scene.h"

namespace raymeter {
namespace {

const std::string meshes = std::string(RAYMETER_SHARED_DATA) + "/scenes/meshes/";

/// A line of cameras.csv: what an independent tracer in double saw, and Embree's mean distance of hits.
struct View {
  std::string mesh, name;
  Camera camera;
  std::size_t triangles = 0, hits = 0;
  double mean_distance = 0, relative_error = 1e-5;
};

/// Where the table is not what should be seen.
void correct(View& view) {
  // The table's tracers cut every polygon as a fan, also the 1,417 of this file whose fan folds over itself
  // (1,245 of them by more than a thousandth of their area). Cut as fans by us too, they give the table's
  // numbers to the last ray and digit; cut properly, these.
  if (view.mesh == "peterbilt.obj" && view.name == "outside")
    view.hits = 18397, view.mean_distance = 2043.7567;
  if (view.mesh == "peterbilt.obj" && view.name == "near") view.mean_distance = 108.83096;
  // Floats of 4.7 million are half a metre apart, and the table's camera stands between them. From where it
  // stands in float, a tracer in double and Embree see the distances that we see.
  if (view.mesh == "snake_river.stl") view.relative_error = 1e-3;
}

std::vector<View> views_of(const std::string& mesh) {
  std::ifstream file(meshes + "cameras.csv");
  std::vector<View> views;
  std::string line;
  std::getline(file, line);  // the names of the columns
  while (std::getline(file, line)) {
    std::ranges::replace(line, ',', ' ');
    std::istringstream words(line);
    View view;
    std::size_t embree_hits = 0;
    words >> view.mesh >> view.name;
    for (Vec3* v : {&view.camera.from, &view.camera.at, &view.camera.up}) words >> v->x >> v->y >> v->z;
    words >> view.camera.angle >> view.triangles >> view.hits >> embree_hits >> view.mean_distance;
    EXPECT_TRUE(words) << line;
    if (view.mesh != mesh) continue;
    correct(view);
    views.push_back(view);
  }
  return views;
}

class MeshHits : public testing::TestWithParam<const char*> {};

TEST_P(MeshHits, EqualTheTable) {
  if (!std::filesystem::exists(meshes)) GTEST_SKIP() << "no shared data";
  const std::vector<View> views = views_of(GetParam());
  ASSERT_EQ(views.size(), 2u);
  const Scene scene = open_scene(meshes + GetParam());
  Registry registry;
  register_baselines(registry);
  const auto structure = registry.build(parse_spec("counted-bvh"), {scene});
  for (const View& view : views) {
    EXPECT_EQ(scene.triangle_count(), view.triangles);
    const RayBatch batch = make_primary(scene, {.size = {320, 240}, .camera = view.camera});
    std::vector<Hit> hits(batch.rays.size());
    structure->trace_closest(batch.view(), hits);
    std::size_t count = 0;
    double distance = 0;  // directions are unit vectors
    for (const Hit& hit : hits)
      if (hit.found()) ++count, distance += double(hit.t);
    EXPECT_NEAR(double(count), double(view.hits), 3) << view.name;
    EXPECT_NEAR(distance / double(count) / view.mean_distance, 1, view.relative_error) << view.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Table, MeshHits,
                         testing::Values("buildings.obj", "bunny.ply", "bush.obj", "ficustree.obj",
                                         "furniture_hall_a.ply", "igbt_module.ply", "jacksboro_dem.ply",
                                         "oa_dm1.obj", "oa_minia.obj", "peterbilt.obj", "snake_river.stl",
                                         "spot.obj", "terrarium-robots/scene.gltf", "ultimaker_robot.stl"),
                         [](const auto& test) {
                           std::string name = test.param;
                           std::erase_if(name,
                                         [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); });
                           return name;
                         });

}  // namespace
}  // namespace raymeter
