#include "harness/whitted.h"

#include <gmock/gmock.h>

#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "harness/truth.h"

namespace raymeter {
namespace {

void brute(const Scene& scene, const WhittedBatch& batch, BatchAnswers& answers) {
  answers = brute_force(scene, batch.rays.rays, batch.rays.query);
}

/// What one eye ray sees, from `from` to `at`, and the batches on the way.
struct Seen {
  WhittedPixel pixel;
  std::map<std::string, RayBatch> batches;
};

Seen look(SceneData data, const Vec3& from, const Vec3& at, unsigned depth = 5) {
  data.camera = Camera{from, at, {0, 1, 0}, 1};
  const Scene scene(std::move(data));
  Seen seen;
  const std::uint32_t pixel = 0;
  trace_whitted(scene, {.size = {1, 1}, .depth = depth}, {&pixel, 1},
                [&](const WhittedBatch& batch, BatchAnswers& answers) {
                  brute(scene, batch, answers);
                  seen.batches[batch.rays.name] = batch.rays;
                },
                {&seen.pixel, 1});
  return seen;
}

void expect_near(const Vec3d& a, const Vec3d& b, double tolerance = 1e-6) {
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(a[axis], b[axis], tolerance) << "axis " << axis;
}

/// Adds a triangle about `centre` in the plane of the unit vectors u and v; its winding's normal is u x v.
void add_plane(SceneData& data, const Vec3& centre, const Vec3& u, const Vec3& v, const Material& material,
               float size = 1) {
  const auto first = static_cast<std::uint32_t>(data.vertices.size());
  data.vertices.push_back(centre - size * u - size * v);
  data.vertices.push_back(centre + 3 * size * u - size * v);
  data.vertices.push_back(centre - size * u + 3 * size * v);
  data.triangles.push_back({first, first + 1, first + 2});
  data.triangle_materials.push_back(static_cast<std::uint32_t>(data.materials.size()));
  data.materials.push_back(material);
}

void add_sphere(SceneData& data, const Vec3& centre, float radius, const Material& material) {
  data.quadrics.push_back({QuadricKind::sphere, centre, radius, {}, 0});
  data.quadric_materials.push_back(static_cast<std::uint32_t>(data.materials.size()));
  data.materials.push_back(material);
}

const Material matt{{1, 0.5f, 0.25f}, 0.5f, 0, 1, 0, 1};
const Material mirror{{1, 1, 1}, 0, 0.75f, 100000, 0, 1};
const Material glass{{1, 1, 1}, 0, 0, 1, 0.5f, 1.5f};

TEST(Whitted, ShadesByCosineAndLightsShareTheirIntensity) {
  SceneData data;
  add_plane(data, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, matt);
  data.lights = {{{3, 0, 4}}};
  expect_near(look(data, {0, 0, 10}, {0, 0, 0}).pixel.colour, {0.4, 0.2, 0.1});  // Kd 0.5 * cosine 0.8
  data.lights.push_back({{0, 0, 7}, {0, 1, 1}});
  const double share = std::sqrt(2.0) / 2;
  expect_near(look(data, {0, 0, 10}, {0, 0, 0}).pixel.colour, {share * 0.4, share * 0.45, share * 0.225});
}

TEST(Whitted, LightsBehindTheSurfaceGetNoShadowRays) {
  SceneData data;
  add_plane(data, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, matt);
  data.lights = {{{0, 0, -4}}};
  const Seen seen = look(data, {0, 0, 10}, {0, 0, 0});
  expect_near(seen.pixel.colour, {0, 0, 0}, 0);
  EXPECT_EQ(seen.batches.count("shadow-1"), 0u);
  // From the other side that light is in front: surfaces have two sides.
  expect_near(look(data, {0, 0, -10}, {0, 0, 0}).pixel.colour, {0.5, 0.25, 0.125});
}

TEST(Whitted, ABallBetweenSurfaceAndLightThrowsAShadow) {
  SceneData data;
  add_plane(data, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, matt, 10);
  data.lights = {{{3, 0, 4}}};
  add_sphere(data, {1.5f, 0, 2}, 0.25f, glass);  // glass blocks too
  // Seen from the other side, where the ball is not in the way of the eye.
  expect_near(look(data, {0, 0, 10}, {0, 0, 0}).pixel.colour, {0, 0, 0}, 0);
  // The ball's shadow is a cone: at 0.25 / 2.5 * 5 = 0.5 across the light's direction it ends.
  expect_near(look(data, {0, 0.49f, 10}, {0, 0.49f, 0}).pixel.colour, {0, 0, 0}, 0);
  EXPECT_GT(look(data, {0, 0.52f, 10}, {0, 0.52f, 0}).pixel.colour.x, 0.39);
  // Behind the light nothing blocks.
  data.quadrics[0].base = {4.5f, 0, 6};
  expect_near(look(data, {0, 0, 10}, {0, 0, 0}).pixel.colour, {0.4, 0.2, 0.1});
}

TEST(Whitted, AHighlightIsThePowerOfTheCosineBetweenMirroredLightAndViewer) {
  SceneData data;
  Material shiny = matt;
  shiny.specular = 0.25f;
  shiny.shine = 3;
  add_plane(data, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, shiny);
  data.lights = {{{3, 0, 4}}};
  const double highlight = 0.25 * 0.8 * 0.8 * 0.8;
  expect_near(look(data, {0, 0, 10}, {0, 0, 0}, 1).pixel.colour,
              {0.4 + highlight, 0.2 + highlight, 0.1 + highlight});
}

TEST(Whitted, AMirrorShowsWhatItMirrors) {
  SceneData data;
  const float half = std::sqrt(0.5f);
  add_plane(data, {0, 0, 0}, {half, 0, -half}, {0, 1, 0}, mirror);  // at 45 degrees
  add_plane(data, {10, 0, 0}, {0, 0, 1}, {0, 1, 0}, matt);
  data.lights = {{{6, 3, 0}}};  // cosine at the wall: 4 / 5
  const Seen seen = look(data, {0, 0, 10}, {0, 0, 0});
  expect_near(seen.pixel.colour, {0.75 * 0.4, 0.75 * 0.2, 0.75 * 0.1});
  expect_near(to_double(seen.batches.at("reflection-2").rays[0].direction), {1, 0, 0});
  EXPECT_EQ(seen.pixel.hit.primitive, 0u);
  // At depth 1 nothing is mirrored.
  expect_near(look(data, {0, 0, 10}, {0, 0, 0}, 1).pixel.colour, {0, 0, 0});
}

TEST(Whitted, AGlassBallRefractsBySnellsLaw) {
  SceneData data;
  data.background = {0.25f, 0.5f, 1};
  data.lights = {{{0, 0, 100}}};
  add_sphere(data, {0, 0, 0}, 1, glass);
  const double height = 0.6;
  const Seen seen = look(data, {0.6f, 0, 10}, {0.6f, 0, 0}, 3);
  // In at asin(h), on at asin(h / n); the same again on the way out.
  const double in = std::asin(height), inside = std::asin(height / 1.5);
  const auto turned = [](double angle) { return Vec3d{-std::sin(angle), 0, -std::cos(angle)}; };
  expect_near(to_double(seen.batches.at("refraction-2").rays[0].direction), turned(in - inside));
  // Rays of depth 3: refracted out of the ball, from the refracted one; nothing goes in a second time.
  ASSERT_EQ(seen.batches.at("refraction-3").rays.size(), 1u);
  expect_near(to_double(seen.batches.at("refraction-3").rays[0].direction), turned(2 * (in - inside)));
  // T^2 of the background; what the ball mirrors counts nothing, for its Ks is 0.
  expect_near(seen.pixel.colour, {0.0625, 0.125, 0.25});
}

TEST(Whitted, TotalReflectionGetsWhatIsNotRefracted) {
  SceneData data;
  data.background = {0.25f, 0.5f, 1};
  data.lights = {{{0, 0, -50}}};
  Material water = glass;
  water.specular = 0.25f;
  water.shine = 1e9f;
  add_plane(data, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, water, 100);  // the medium is below
  const Seen flat = look(data, {-2, 0, -1}, {0, 0, 0}, 2);       // sine 0.89 > 1 / 1.5
  EXPECT_EQ(flat.batches.count("refraction-2"), 0u);
  expect_near(flat.pixel.colour, {0.75 * 0.25, 0.75 * 0.5, 0.75});
  const Seen steep = look(data, {-1, 0, -2}, {0, 0, 0}, 2);  // sine 0.45
  ASSERT_EQ(steep.batches.at("refraction-2").rays.size(), 1u);
  EXPECT_NEAR(steep.batches.at("refraction-2").rays[0].direction.x, 1.5 / std::sqrt(5), 1e-6);
  expect_near(steep.pixel.colour, {0.75 * 0.25, 0.75 * 0.5, 0.75});
  const Seen from_above = look(data, {-2, 0, 1}, {0, 0, 0}, 2);
  EXPECT_NEAR(from_above.batches.at("refraction-2").rays[0].direction.x, 2 / std::sqrt(5) / 1.5, 1e-6);
}

TEST(Whitted, NormalsAreInterpolatedAndMirrorsByThem) {
  SceneData data;
  add_plane(data, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, mirror);
  data.lights = {{{0, 0, 50}}};
  data.normals = {{0, 0, 1}, {0, 0, -1}, {0.6f, 0, 0.8f}};
  data.triangle_normals = {{2, 2, 2}};
  const Seen tilted = look(data, {0, 0, 10}, {0, 0, 0});
  expect_near(to_double(tilted.pixel.normal), {0.6, 0, 0.8});
  expect_near(to_double(tilted.batches.at("reflection-2").rays[0].direction), {0.96, 0, 0.28});
  // From behind it is turned with the surface.
  expect_near(to_double(look(data, {0, 0, -10}, {0, 0, 0}).pixel.normal), {-0.6, 0, -0.8});
  // Corners are at (-1, -1), (3, -1), (-1, 3); their barycentric coordinates at the origin 1/2, 1/4, 1/4.
  data.triangle_normals = {{0, 2, 2}};
  const double size = std::sqrt(0.3 * 0.3 + 0.9 * 0.9);
  expect_near(to_double(look(data, {0, 0, 10}, {0, 0, 0}).pixel.normal), {0.3 / size, 0, 0.9 / size});
  // A normal of no length is none.
  data.triangle_normals = {{0, 1, 1}};
  expect_near(to_double(look(data, {0, 0, 10}, {0, 0, 0}).pixel.normal), {0, 0, 1});
}

/// Balls of glass and mirror over a floor.
Scene balls() {
  SceneData data;
  Material both = glass;
  both.specular = 0.3f;
  constexpr int rows[] = {0, 0, 0, 1, 1, 1, 2, 2, 2};
  for (int i = 0; i < 9; ++i)
    add_sphere(data, {float(i % 3) - 1, float(rows[i]) - 1, 0.3f * float(i % 2)}, 0.45f,
               i % 3 == 0   ? both
               : i % 3 == 1 ? mirror
                            : matt);
  add_plane(data, {0, 0, -1}, {1, 0, 0}, {0, 1, 0}, matt, 5);
  data.lights = {{{3, 4, 5}}, {{-3, 2, 5}}};
  data.camera = Camera{{1, -3, 5}, {0, 0, 0}, {0, 0, 1}, 40};
  return Scene(std::move(data));
}

struct Recorded {
  std::vector<WhittedPixel> picture;
  std::vector<WhittedBatch> batches;
};

Recorded record(const Scene& scene, const WhittedSettings& settings) {
  Recorded recorded;
  const auto pixels = pixel_order(settings.size, RayOrder::tiled, 1);
  recorded.picture.resize(pixels.size());
  trace_whitted(
      scene, settings, pixels,
      [&](const WhittedBatch& batch, BatchAnswers& answers) {
        brute(scene, batch, answers);
        recorded.batches.push_back(batch);
      },
      recorded.picture);
  return recorded;
}

TEST(Whitted, EachGenerationIsOneBatchInOrder) {
  const Scene scene = balls();
  const Recorded recorded = record(scene, {.size = {24, 16}, .depth = 3});
  std::vector<std::string> names;
  for (const WhittedBatch& batch : recorded.batches) {
    names.push_back(batch.rays.name);
    EXPECT_EQ(batch.rays.hash, ray_hash(batch.rays.rays));
    EXPECT_EQ(batch.pixels.size(), batch.rays.rays.size());
    EXPECT_EQ(batch.rays.query, batch.purpose == RayPurpose::shadow ? QueryKind::any : QueryKind::closest);
  }
  EXPECT_THAT(names, testing::ElementsAre("primary", "shadow-1", "reflection-2", "refraction-2", "shadow-2",
                                          "reflection-3", "refraction-3", "shadow-3"));
  EXPECT_EQ(recorded.batches[0].rays.hash, make_primary(scene, {.size = {24, 16}}).hash);
}

TEST(Whitted, PartsMakeTheSamePictureOfTheSameRays) {
  const Scene scene = balls();
  const Recorded whole = record(scene, {.size = {24, 16}, .depth = 5});
  const Recorded parts = record(scene, {.size = {24, 16}, .depth = 5, .batch_rays = 50});
  EXPECT_GT(parts.batches.size(), 4 * whole.batches.size());
  for (const WhittedBatch& batch : parts.batches) EXPECT_LE(batch.rays.rays.size(), 50u);
  for (std::size_t i = 0; i < whole.picture.size(); ++i) {
    expect_near(whole.picture[i].colour, parts.picture[i].colour, 1e-14);
    EXPECT_EQ(whole.picture[i].hit, parts.picture[i].hit);
  }
  using Key = std::tuple<RayPurpose, unsigned, std::uint32_t, float, float, float>;
  const auto rays_of = [](const Recorded& recorded) {
    std::multiset<Key> rays;
    for (const WhittedBatch& batch : recorded.batches)
      for (std::size_t i = 0; i < batch.pixels.size(); ++i) {
        const Vec3& d = batch.rays.rays[i].direction;
        rays.insert({batch.purpose, batch.depth, batch.pixels[i], d.x, d.y, d.z});
      }
    return rays;
  };
  EXPECT_EQ(rays_of(whole), rays_of(parts));
}

}  // namespace
}  // namespace raymeter
