#include <string_view>

#include "scenes/generators/families.h"
#include "scenes/generators/paper/chess_pieces.h"

namespace raymeter {
namespace {

constexpr double board_height = 0.25, frame = 0.7;

/// Of the square named by file and rank ("e4"): white sits at +z.
Vec3d square_centre(std::string_view square) {
  return {square[0] - 'a' - 3.5, board_height, 3.5 - (square[1] - '1')};
}

void add_board(MeshBuilder& mesh, std::uint32_t light, std::uint32_t dark, std::uint32_t wood) {
  for (char file = 'a'; file <= 'h'; ++file)
    for (char rank = '1'; rank <= '8'; ++rank) {
      mesh.use_material((file + rank) % 2 ? light : dark);
      const char name[] = {file, rank};
      const Vec3d c = square_centre({name, 2});
      mesh.add_quad(c + Vec3d{-0.5, 0, 0.5}, c + Vec3d{0.5, 0, 0.5}, c + Vec3d{0.5, 0, -0.5},
                    c + Vec3d{-0.5, 0, -0.5});
    }
  mesh.use_material(wood);
  const auto ring = [](double half, double height) {
    return Ring{{{half, height, half}, {half, height, -half}, {-half, height, -half}, {-half, height, half}},
                true};
  };
  mesh.add_loft(std::vector<Ring>{ring(4 + frame, 0), ring(4 + frame, 0.8 * board_height),
                                  ring(4 + 0.8 * frame, 1.15 * board_height), ring(4, 1.15 * board_height),
                                  ring(4, board_height)});
}

SceneData make_chess(const Arguments&) {
  SceneData data;
  MeshBuilder mesh(data);
  const auto table = mesh.add_material({.colour = {0.30f, 0.17f, 0.10f}, .diffuse = 0.9f, .specular = 0});
  const auto wood =
      mesh.add_material({.colour = {0.32f, 0.12f, 0.06f}, .diffuse = 0.7f, .specular = 0.2f, .shine = 40});
  const auto light = mesh.add_material({.colour = {0.88f, 0.78f, 0.58f}, .diffuse = 0.9f, .specular = 0});
  const auto dark = mesh.add_material({.colour = {0.12f, 0.30f, 0.24f}, .diffuse = 0.8f, .specular = 0});
  const auto white =
      mesh.add_material({.colour = {0.95f, 0.88f, 0.72f}, .diffuse = 0.8f, .specular = 0.15f, .shine = 60});
  const auto black =
      mesh.add_material({.colour = {0.40f, 0.06f, 0.05f}, .diffuse = 0.8f, .specular = 0.2f, .shine = 60});

  mesh.use_material(table);
  static constexpr OutlinePoint top[] = {{9.6, -0.6, true}, {10, -0.3}, {9.85, 0, true}, {0, 0}};
  mesh.add_lathe({0, 0, 0}, top, 56);
  add_board(mesh, light, dark, wood);

  // Morphy against the Duke of Brunswick and Count Isouard, Paris 1858, after 17. Rd8 mate.
  for (const std::string_view name : {"Kc1", "Rd8", "Bg5", "Pa2", "Pb2", "Pc2", "Pe4", "Pf2", "Pg2", "Ph2"}) {
    mesh.use_material(white);
    add_chess_piece(mesh, ChessPiece(name[0]), square_centre(name.substr(1)), {0, 0, -1});
  }
  for (const std::string_view name : {"Ke8", "Qe6", "Bf8", "Nb8", "Rh8", "Pa7", "Pe5", "Pf7", "Pg7", "Ph7"}) {
    mesh.use_material(black);
    add_chess_piece(mesh, ChessPiece(name[0]), square_centre(name.substr(1)), {0, 0, 1});
  }

  data.camera = Camera{.from = {-5.5f, 5.4f, 10}, .at = {0.5f, 0.5f, -0.6f}, .angle = 43};
  data.background = {0.02f, 0.05f, 0.07f};
  data.lights = {{{-12, 14, 2}, {1.4f, 1.28f, 1.05f}}, {{30, -1, -24}, {0.5f, 0.6f, 0.9f}}};
  return data;
}

}  // namespace

SceneGenerator paper_chess_generator() {
  return {"paper/3",
          "13,856 triangles, as many as in the paper's third scene, crowded in small bodies on large plain "
          "ones: the end of Morphy's opera game",
          {},
          make_chess};
}

}  // namespace raymeter
