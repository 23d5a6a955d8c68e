#include <cmath>

#include "scenes/generators/families.h"
#include "scenes/geometry/quadric_shapes.h"

namespace raymeter {
namespace {

/// Adds quadrics of one material after the other. y is up.
class Objects {
 public:
  explicit Objects(SceneData& data) : data_(data) {}

  void use(const Material& material) { data_.materials.push_back(material); }

  void add_sphere(const Vec3d& centre, double radius) {
    add({QuadricKind::sphere, to_float(centre), static_cast<float>(radius), {}, 0});
  }
  /// The mantle between two discs.
  void add_cone(const Vec3d& base, double base_radius, const Vec3d& apex, double apex_radius) {
    add({QuadricKind::cone, to_float(base), static_cast<float>(base_radius), to_float(apex),
         static_cast<float>(apex_radius)});
  }
  void add(const Quadric& quadric) {
    data_.quadrics.push_back(quadric);
    data_.quadric_materials.push_back(material());
  }
  void add(const GeneralQuadric& quadric) {
    data_.general_quadrics.push_back(quadric);
    data_.general_quadric_materials.push_back(material());
  }

 private:
  std::uint32_t material() const { return static_cast<std::uint32_t>(data_.materials.size() - 1); }
  SceneData& data_;
};

constexpr Material glass{{0.9f, 1, 0.95f}, 0.05f, 0.2f, 120, 0.8f, 1.5f};
constexpr Material thin_glass{{0.9f, 0.95f, 1}, 0.06f, 0.15f, 120, 0.85f, 1.03f};
constexpr Material wine{{0.75f, 0.02f, 0.06f}, 0.9f, 0.1f, 80, 0.25f, 1.1f};
constexpr Material silver{{0.8f, 0.82f, 0.85f}, 0.2f, 0.65f, 80, 0, 1};
constexpr Material brass{{0.85f, 0.60f, 0.22f}, 0.55f, 0.35f, 50, 0, 1};
constexpr Material lemon{{0.95f, 0.83f, 0.15f}, 0.85f, 0, 1, 0, 1};
constexpr Material ebony{{0.16f, 0.10f, 0.07f}, 0.8f, 0.15f, 40, 0, 1};
constexpr Material porcelain{{0.20f, 0.34f, 0.62f}, 0.75f, 0.2f, 60, 0, 1};

Placement upright(const Vec3d& at) {
  return {at, axes_along({0, 1, 0}, {1, 0, 0})};
}
GeneralQuadric round_ellipsoid(const Vec3d& centre, double radius, double half_height) {
  return ellipsoid(upright(centre), {radius, radius, half_height});
}

void add_goblet(Objects& objects, const Vec3d& foot, double wine_level) {
  const auto at = [&](double height) { return foot + Vec3d{0, height, 0}; };
  objects.use(thin_glass);
  objects.add(round_ellipsoid(at(0.07), 0.55, 0.07));
  objects.add(hyperboloid_of_one_sheet(upright(at(0.8)), {0.065, 0.065, 0.3}, {-0.68, 0.62}));
  objects.add(elliptic_paraboloid(upright(at(1.40)), {0.72, 0.72, 1.6}, {0, 1.6}));
  if (wine_level == 0) return;
  objects.use(wine);
  objects.add(elliptic_paraboloid(upright(at(1.45)), {0.68, 0.68, 1.55}, {0, wine_level}));
  objects.add(round_ellipsoid(at(1.45 + wine_level), 0.68 * std::sqrt(wine_level / 1.55), 0.012));
}

void add_candlestick(Objects& objects, const Vec3d& foot, double height) {
  const auto at = [&](double h) { return foot + Vec3d{0, h, 0}; };
  objects.use(brass);
  objects.add(hyperboloid_of_one_sheet(upright(at(0.5 * height)), {0.10, 0.10, 0.09 * height},
                                       {-0.5 * height, 0.45 * height}));
  objects.add_sphere(at(0.5 * height), 0.2);
  objects.add(elliptic_paraboloid(upright(at(0.93 * height)), {0.42, 0.42, 0.25}, {0, 0.25}));
  objects.use({{0.96f, 0.92f, 0.80f}, 0.85f, 0, 1, 0, 1});
  objects.add_cone(at(0.95 * height), 0.17, at(0.95 * height + 1.6), 0.17);
  objects.add(round_ellipsoid(at(0.95 * height + 1.6), 0.17, 0.05));
  objects.use({{1, 0.75f, 0.25f}, 1, 0, 1, 0.3f, 1});
  objects.add(round_ellipsoid(at(0.95 * height + 1.92), 0.085, 0.24));
}

/// Glass between two plates, and what has run through it.
void add_hourglass(Objects& objects, const Vec3d& foot) {
  const auto at = [&](double x, double h, double z) { return foot + Vec3d{x, h, z}; };
  objects.use(ebony);
  for (const double height : {0.08, 2.72}) objects.add(round_ellipsoid(at(0, height, 0), 0.95, 0.09));
  objects.use(brass);
  for (const double x : {-0.55, 0.55})
    for (const double z : {-0.55, 0.55}) objects.add_cone(at(x, 0.1, z), 0.055, at(x, 2.7, z), 0.055);
  objects.use(thin_glass);
  objects.add(hyperboloid_of_one_sheet(upright(at(0, 1.4, 0)), {0.06, 0.06, 0.115}, {-1.25, 1.25}));
  objects.use({{0.93f, 0.75f, 0.45f}, 0.9f, 0, 1, 0, 1});
  objects.add_cone(at(0, 0.17, 0), 0.52, at(0, 0.75, 0), 0);
  objects.add_cone(at(0, 1.5, 0), 0.03, at(0, 2.05, 0), 0.30);
}

void add_fruit_bowl(Objects& objects, const Vec3d& foot) {
  const auto at = [&](double x, double h, double z) { return foot + Vec3d{x, h, z}; };
  objects.use(silver);
  objects.add(hyperboloid_of_one_sheet(upright(at(0, 0.38, 0)), {0.22, 0.22, 0.16}, {-0.38, 0.25}));
  objects.add(elliptic_paraboloid(upright(at(0, 0.55, 0)), {1.75, 1.75, 0.85}, {0, 0.85}));
  objects.use({{0.95f, 0.45f, 0.08f}, 0.8f, 0.1f, 25, 0, 1});  // oranges
  objects.add_sphere(at(-0.62, 1.22, 0.42), 0.5);
  objects.add_sphere(at(0.42, 1.20, 0.70), 0.5);
  objects.add_sphere(at(0.05, 1.80, 0.02), 0.5);
  objects.use(lemon);
  objects.add(ellipsoid({at(1.02, 1.33, 0.12), axes_along({0.8, 0.3, -0.5}, {0, 1, 0})}, {0.38, 0.38, 0.52}));
  objects.add(ellipsoid({at(-0.5, 1.95, 0.62), axes_along({0.6, 0.1, 0.7}, {0, 1, 0})}, {0.34, 0.34, 0.48}));
  objects.use({{0.62f, 0.08f, 0.09f}, 0.75f, 0.2f, 40, 0, 1});  // apples
  objects.add(round_ellipsoid(at(-1.05, 1.36, -0.35), 0.52, 0.46));
  objects.add(round_ellipsoid(at(0.35, 1.32, -0.72), 0.52, 0.46));
  objects.use({{0.40f, 0.60f, 0.15f}, 0.75f, 0.15f, 40, 0, 1});  // and a green one
  objects.add(round_ellipsoid(at(0.62, 1.86, 0.28), 0.46, 0.42));
}

void add_vase(Objects& objects, const Vec3d& foot) {
  const auto at = [&](double x, double h, double z) { return foot + Vec3d{x, h, z}; };
  objects.use(porcelain);
  objects.add(round_ellipsoid(at(0, 1.05, 0), 0.95, 1.05));
  objects.add_cone(at(0, 0, 0), 0.62, at(0, 0.3, 0), 0.45);
  objects.add(hyperboloid_of_one_sheet(upright(at(0, 2.25, 0)), {0.34, 0.34, 0.42}, {-0.42, 0.55}));
  struct Flower {
    Vec3d head;
    Vec3 colour;
  };
  const Flower flowers[] = {{{-1.2, 4.3, 0.3}, {0.90f, 0.20f, 0.25f}},
                            {{-0.35, 4.9, -0.2}, {0.95f, 0.80f, 0.25f}},
                            {{0.5, 4.6, 0.4}, {0.92f, 0.45f, 0.55f}},
                            {{1.25, 3.9, -0.1}, {0.75f, 0.40f, 0.80f}}};
  for (const auto& [head, colour] : flowers) {
    const Vec3d from = at(0.1 * head.x, 2.3, 0.1 * head.z), to = foot + head;
    objects.use({{0.25f, 0.45f, 0.15f}, 0.85f, 0, 1, 0, 1});
    objects.add_cone(from, 0.05, to, 0.035);
    objects.use({colour, 0.9f, 0, 1, 0, 1});
    objects.add(elliptic_paraboloid(upright(to), {0.42, 0.42, 0.55}, {0, 0.55}));
    objects.use({{0.95f, 0.85f, 0.35f}, 0.9f, 0, 1, 0, 1});
    objects.add_sphere(to + Vec3d{0, 0.5, 0}, 0.17);
  }
}

/// Two shells that face away from each other, and the ball between them.
void add_chalice(Objects& objects, const Vec3d& foot) {
  objects.use(silver);
  objects.add(hyperboloid_of_two_sheets(upright(foot + Vec3d{0, 0.9, 0}), {0.32, 0.32, 0.3}, {-0.9, 0.9}));
  objects.use({{0.75f, 0.08f, 0.10f}, 0.5f, 0.3f, 100, 0.3f, 1.3f});
  objects.add_sphere(foot + Vec3d{0, 0.9, 0}, 0.3);
}

/// Two cones tip to tip, which lie on their rims.
void add_diabolo(Objects& objects, const Vec3d& middle) {
  objects.add(elliptic_cone({middle, axes_along({1, 0, 0}, {0, 1, 0})}, {0.4, 0.4, 0.45}, {-0.45, 0.45}));
}

SceneData make_still_life(const Arguments&) {
  SceneData data;
  Objects objects(data);
  objects.use({{0.34f, 0.17f, 0.10f}, 0.85f, 0.2f, 40, 0, 1});
  objects.add(round_ellipsoid({0, -0.5, -0.3}, 6.6, 0.5));

  add_vase(objects, {-2.7, -0.03, -2.6});
  add_fruit_bowl(objects, {0.1, 0, -1.2});
  add_candlestick(objects, {2.2, -0.03, -3.2}, 2.6);
  add_candlestick(objects, {3.6, -0.03, -2.6}, 1.9);
  add_hourglass(objects, {3.3, -0.01, 0.1});
  add_goblet(objects, {-1.9, 0, 0.6}, 0.8);
  add_goblet(objects, {-4.0, -0.04, 0.5}, 0);
  add_chalice(objects, {1.7, 0, 1.2});

  objects.use(glass);
  objects.add_sphere({-1.1, 0.61, 2.3}, 0.62);
  objects.add_sphere({0.75, 0.35, 2.7}, 0.37);
  objects.use(silver);
  objects.add_sphere({0.25, 0.45, 1.0}, 0.47);
  const Vec3 colours[] = {{0.15f, 0.45f, 0.75f},
                          {0.85f, 0.25f, 0.15f},
                          {0.95f, 0.75f, 0.2f},
                          {0.2f, 0.6f, 0.35f},
                          {0.6f, 0.3f, 0.65f}};
  const Vec3d marbles[] = {
      {-2.7, 0.2, 2.5}, {-2.2, 0.2, 3.0}, {2.2, 0.2, 2.4}, {-0.4, 0.2, 3.5}, {2.75, 0.2, 1.9}};
  for (std::size_t i = 0; i < 5; ++i) {
    objects.use({colours[i], 0.7f, 0.25f, 80, 0, 1});
    objects.add_sphere(marbles[i], 0.22);
  }

  objects.use({{0.80f, 0.16f, 0.10f}, 0.9f, 0, 1, 0, 1});
  add_diabolo(objects, {1.9, 0.4, 3.5});
  objects.use(silver);
  objects.add(
      elliptic_cylinder({{3.3, 0.3, 2.6}, axes_along({0, 0, 1}, {1, 0, 0})}, 0.38, 0.31, {-0.22, 0.22}));
  objects.use(lemon);
  objects.add(ellipsoid({{4.3, 0.33, 1.6}, axes_along({0.7, 0, -0.7}, {0, 1, 0})}, {0.34, 0.34, 0.48}));
  objects.use({{0.50f, 0.32f, 0.18f}, 0.9f, 0, 1, 0, 1});  // walnuts
  objects.add(ellipsoid({{-3.9, 0.22, 1.7}, axes_along({0.3, 0, 1}, {0, 1, 0})}, {0.25, 0.25, 0.32}));
  objects.add(ellipsoid({{-3.3, 0.22, 2.0}, axes_along({1, 0, 0.2}, {0, 1, 0})}, {0.25, 0.25, 0.32}));

  data.camera = Camera{.from = {-0.6f, 4.6f, 12.6f}, .at = {0, 1.85f, -0.6f}, .angle = 46};
  data.background = {0.07f, 0.17f, 0.20f};
  data.lights = {{{-4, 14, 11}, {1.55f, 1.42f, 1.2f}}};
  return data;
}

}  // namespace

SceneGenerator paper_still_life_generator() {
  return {"paper/1",
          "70 quadrics of eight kinds, as many as in the paper's first scene: a still life with glass, "
          "silver, fruit "
          "and candles",
          {},
          make_still_life};
}

}  // namespace raymeter
